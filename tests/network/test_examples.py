"""The example scripts of the Python client do as they say."""
import re
import signal
import subprocess
import sys

import pytest
from server import ROOT, SCENES

EXAMPLES = ROOT / "clients/python/examples"


@pytest.fixture(name="ball")
def start_ball(start, wire):
    start(SCENES / "ball.sdf")
    wire.next("HEARTBEAT", 10.0)


def run_example(name, *arguments):
    done = subprocess.run([sys.executable, EXAMPLES / name, *arguments], timeout=60, capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_all_examples_are_tested():
    assert {path.name for path in EXAMPLES.glob("*.py")} == {
        "balance.py", "energy.py", "hover.py", "pick.py", "push.py", "watch.py"}


def test_push(free_bodies):
    """Where nothing else acts, both lines show the same change of velocity."""
    velocities = re.findall(r"\[.*\]", run_example("push.py", "ball", "40", "0.25"))
    assert len(velocities) == 2 and velocities[0].split() == velocities[1].split()


def test_hover(ball):
    height = float(re.search(r"is at ([-0-9.]+) m", run_example("hover.py", "ball", "2", "4")).group(1))
    assert height == pytest.approx(2.0, abs=0.05)


def test_watch(ball):
    with subprocess.Popen([sys.executable, EXAMPLES / "watch.py"], stdout=subprocess.PIPE, text=True) as script:
        lines = [script.stdout.readline() for _ in range(3)]
        script.send_signal(signal.SIGINT)
        assert script.wait(10) == 0
    assert "bodies in TUMBLE" in lines[0] and "ball" in lines[2]


def test_pick(ball):
    said = run_example("pick.py", "1.5", "3")
    assert "picked ball" in said
    assert float(re.search(r"hangs at ([-0-9.]+) m", said).group(1)) == pytest.approx(1.5, abs=0.05)


def test_balance(ball):
    """Without the controller the rod would lie after a second; and lock-step ends with time running again."""
    assert float(re.search(r"leans ([-0-9.]+) degrees", run_example("balance.py", "3")).group(1)) < 1.0


def test_energy(start, wire, tmp_path):
    """Of a recording; the picture is one."""
    log, picture = tmp_path / "run.lcm", tmp_path / "energy.png"
    server = start(SCENES / "ball.sdf", "--record", log)
    wire.next("STATE", 10.0, lambda m: m.step > 300)
    assert server.stop() == 0
    said = run_example("energy.py", str(log), str(picture))
    assert int(re.match(r"(\d+) points", said).group(1)) > 10
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 10_000
