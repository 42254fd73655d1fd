"""lcm-spy with our types on a real (virtual) screen: a double-click on STATE or PACKED opens the drawn world."""
import os
import pathlib
import shutil
import subprocess
import time

import pytest
from server import CLI, ROOT

TOOLS = ("Xvfb", "xdotool", "import", "java", "javac", "lcm-gen")
ROW, FIRST = 16, 28  # pixels of lcm-spy's table: the height of a row, and the middle of the first one


@pytest.fixture(name="screen")
def start_screen():
    """An X server with nothing on it; what runs on it gets its DISPLAY."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        pytest.skip(f"not installed: {', '.join(missing)}")
    # The lock file and socket of a display are the whole machine's, also for a network namespace: take an own number.
    number = 100 + os.getpid() % 30000
    socket = pathlib.Path(f"/tmp/.X11-unix/X{number}")
    with subprocess.Popen(["Xvfb", f":{number}", "-screen", "0", "1280x900x24", "-nolisten", "tcp"],
                          stderr=subprocess.DEVNULL) as display:
        deadline = time.monotonic() + 30.0
        while not socket.exists():
            assert display.poll() is None and time.monotonic() < deadline
            time.sleep(0.1)
        yield {**os.environ, "DISPLAY": f":{number}"}
        display.terminate()


def xdotool(screen, *arguments):
    done = subprocess.run(["xdotool", *map(str, arguments)], env=screen, check=False, capture_output=True, text=True,
                          timeout=30)
    return done.stdout.split()


def wait_for_window(screen, title, seconds, retry=lambda: None):
    deadline = time.monotonic() + seconds
    while not (found := xdotool(screen, "search", "--onlyvisible", "--name", title)):
        assert time.monotonic() < deadline, f"no window {title}"
        retry()
        time.sleep(0.5)
    return found[-1]


def colours(picture):
    """{(red, green, blue): share of the pixels}."""
    done = subprocess.run(["convert", picture, "-format", "%c", "histogram:info:-"], check=True, capture_output=True,
                          text=True)
    counts = {}
    for line in done.stdout.splitlines():
        count, _, rest = line.strip().partition(":")
        numbers = rest[rest.index("(") + 1:rest.index(")")].split(",")[:3]
        counts[tuple(int(float(number)) for number in numbers)] = int(count)
    total = sum(counts.values())
    return {colour: count / total for colour, count in counts.items()}


@pytest.fixture(name="jar_folder", scope="module")
def make_jar_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("spy")


@pytest.mark.parametrize("encoding", ["exact", "packed"])
def test_a_double_click_draws_the_world(start, wire, screen, tmp_path, jar_folder, encoding):
    start("--demo", "pyramid", "--encoding", encoding)
    wire.next("HEARTBEAT", 10.0)
    environment = {**screen, "TUMBLE_SPY_BUILD": str(jar_folder)}
    said = tmp_path / "spy.log"
    with open(said, "wb") as output, subprocess.Popen([ROOT / "clients/spy/tumble-spy"], env=environment, stdout=output,
                                                      stderr=subprocess.STDOUT) as spy:
        try:
            window = wait_for_window(screen, "LCM Spy", 180.0)
            time.sleep(3.0)  # its channels come in, sorted by name

            def click_next_row(rows=iter([2, 3, 2, 3, 1, 0] * 20)):
                xdotool(screen, "mousemove", "--window", window, 100, FIRST + ROW * next(rows), "click", "--repeat", 2,
                        "--delay", 60, 1)
                time.sleep(0.7)
            world = wait_for_window(screen, "^TUMBLE$", 60.0, click_next_row)
            subprocess.run([CLI, "push", "row_0_0", "--force", "0", "0", "100", "--seconds", "20"], check=True)
            time.sleep(4.0)
            picture = tmp_path / "world.png"
            subprocess.run(["import", "-window", world, picture], env=screen, check=True, timeout=30)
            keep = os.environ.get("TUMBLE_SPY_PICTURE")
            if keep:
                shutil.copy(picture, keep)
        finally:
            spy.terminate()
    shares = colours(picture)
    background = max(shares.values())
    assert 0.5 < background < 0.97, "drawn, and not all over"
    assert len(shares) > 100
    red = sum(share for (r, g, b), share in shares.items() if r > 170 and g < 90 and b < 80)
    blue = sum(share for (r, g, b), share in shares.items() if r < 60 and 60 < g < 110 and b > 140)
    assert red > 1e-4, "contacts"
    assert blue > 1e-5, "a push"
