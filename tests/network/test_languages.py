"""Any language that LCM has: the examples in C and Java, built from the types alone, by the commands in their heads."""
import re
import shutil
import subprocess

import pytest
from server import ROOT, SCENES

LCM_JAR = "/usr/share/java/lcm.jar"


def commands_of(path, start):
    """The lines of a source's first comment that begin with one of `start`, without comment marks."""
    head = path.read_text(encoding="utf-8").split("*/")[0]
    lines = [line.lstrip(" *") for line in head.splitlines()]
    return [line.split(" [BODY")[0] for line in lines if line.startswith(start)]


def build(path, start, folder):
    for name in ("protocol", "clients"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "gen").mkdir()
    (folder / "classes").mkdir()
    *builds, last = commands_of(path, start)
    *more, run = last.split(" && ")
    for command in [*builds, *more]:
        subprocess.run(["bash", "-c", command], cwd=folder, check=True, timeout=120)
    return run


def run_example(run, folder, wire, body):
    index, generation, _ = wire.bodies()[body]
    done = subprocess.run(["bash", "-c", f"{run} {index} {generation}"], cwd=folder, check=False, timeout=60,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    step, velocity = re.search(r"step (\d+): z = .* vz = ([-0-9.]+) m/s", done.stdout).groups()
    assert int(step) > 0 and float(velocity) > 0
    wrong = subprocess.run(["bash", "-c", f"{run} {index} 77"], cwd=folder, check=False, timeout=60, capture_output=True,
                           text=True)
    assert wrong.returncode == 1 and "generation" in wrong.stderr


@pytest.fixture(name="floating")
def start_floating(start, wire):
    start(SCENES / "free.sdf")
    wire.next("HEARTBEAT", 10.0)
    return wire


def test_c(floating, tmp_path):
    run = build(ROOT / "clients/c/push.c", ("lcm-gen", "cc "), tmp_path)
    run_example(run, tmp_path, floating, "ball")


@pytest.mark.skipif(shutil.which("javac") is None, reason="no Java compiler")
def test_java(floating, tmp_path):
    run = build(ROOT / "clients/java/Push.java", ("lcm-gen", "javac ", "java "), tmp_path)
    run_example(run, tmp_path, floating, "ball")
