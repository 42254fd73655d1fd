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
    assert {path.name for path in EXAMPLES.glob("*.py")} == {"hover.py", "push.py", "watch.py"}


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
