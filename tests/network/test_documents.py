"""Every command and every script that the documents for users show does what they say: exit status 0."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest
from server import CLI, ROOT, SCENES, SERVER, Server

PAGES = ["README.md", "clients/README.md", "clients/troubleshooting.md"]
PROGRAMS = {"./run tumble ": [CLI], "./run tumble-server ": [SERVER], "./run python ": [sys.executable]}
NOT_RUN = {"./run": "the server of test_commands", "./run spy": "needs a display; test_spy.py runs it"}
RECORDING = ("--record", "--replay", "--resume")
CXX = ["g++", "-std=c++20", "-fsyntax-only", "-x", "c++", "-"]


def blocks(page, language):
    text = (ROOT / page).read_text(encoding="utf-8")
    return [match.group(2) for match in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.M | re.S)
            if match.group(1) == language]


def shell_lines(page):
    for block in blocks(page, ""):
        for line in block.splitlines():
            if line.startswith("./run"):
                yield re.sub(r"\s+#.*", "", line)


def is_recording(line):
    return any(option in line for option in RECORDING)


def command_of(line):
    for start, program in PROGRAMS.items():
        if (line + " ").startswith(start):
            return [*program, *line[len(start):].split()]
    assert line in NOT_RUN, f"{line}: not known how to run"
    return None


@pytest.mark.parametrize("page", PAGES)
def test_commands(page, tmp_path):
    """In the order of the page, on one server, as a reader would type them."""
    with Server(tmp_path / "server.log", "--demo", "pyramid") as server:
        server.wait_for_output("TUMBLE_STATE", 20.0)
        run = 0
        for line in shell_lines(page):
            # A client that runs until Ctrl-C is for test_examples.py and test_recording.py, servers are for test_recordings.
            if is_recording(line) or line.endswith(("watch.py", "record run.lcm")) or (command := command_of(line)) is None:
                continue
            done = subprocess.run(command, cwd=ROOT, check=False, timeout=60, capture_output=True, text=True)
            assert done.returncode == 0, f"{page}: {line}\n{done.stdout}{done.stderr}"
            run += 1
        assert run > 0


def examples_of(help_text):
    """The commands in the help of a program."""
    shown = help_text.partition("Examples:\n")[2].partition("\n\n")[0]
    return [line.strip() for line in shown.splitlines()]


def run_shell(line, folder):
    done = subprocess.run(["bash", "-c", line], cwd=folder, check=False, timeout=60, capture_output=True, text=True,
                          env=os.environ | {"PATH": f"{CLI.parent}:{SERVER.parent}:{os.environ['PATH']}"})
    assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_examples_in_the_help_of_tumble(start, wire, tmp_path):
    """Of every subcommand, in the order of the list."""
    start(SCENES / "ball.sdf")
    wire.next("STATE", 20.0)
    subcommands = re.findall(r"^  (\w+)  ", run_shell("tumble --help", tmp_path).partition("Subcommands:")[2], re.M)
    assert len(subcommands) == 18
    shown = {name: examples_of(run_shell(f"tumble {name} --help", tmp_path)) for name in subcommands}
    assert [name for name, lines in shown.items() if not lines] == ["pause", "resume", "reset"]
    for name in sorted(subcommands, key=lambda name: (name == "remove", subcommands.index(name))):
        for line in shown[name]:
            run_shell(line, tmp_path)


def test_examples_in_the_help_of_the_server(tmp_path):
    """Those that run on are ended after a while, as a reader would."""
    shutil.copy(SCENES / "ball.sdf", tmp_path / "scene.sdf")
    lines = examples_of(run_shell("tumble-server --help", tmp_path))
    assert len(lines) == 4
    for line in lines:
        run_shell(line if "--steps" in line else f"timeout --preserve-status 3 {line}", tmp_path)


def test_recordings(tmp_path):
    """A server that is told to record or to go on does so until Ctrl-C; a replay ends by itself."""
    lines = [line for line in shell_lines("README.md") if is_recording(line)]
    assert [option for line in lines for option in RECORDING if option in line] == list(RECORDING)
    for line in lines:
        with subprocess.Popen(command_of(line), cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True) as server:
            if "--replay" not in line:
                time.sleep(3.0)
                server.send_signal(signal.SIGINT)
            output = server.communicate(timeout=60)[0]
            assert server.returncode == 0, f"{line}\n{output}"
            if "--replay" in line:
                assert "came out the same" in output


def scripts():
    return [pytest.param(block, id=f"{pathlib.Path(page).stem}-{i}") for page in PAGES
            for i, block in enumerate(blocks(page, "python"))]


@pytest.mark.parametrize("script", scripts())
def test_scripts(script, start, wire, tmp_path):
    """Each with a server of its own, and a recording beside it if it reads one."""
    log = tmp_path / "run.lcm"
    server = start(SCENES / "ball.sdf", "--record", log)
    wire.next("STATE", 20.0, lambda m: m.step > 30)
    if "spawn(\"ball\"" in script and "Refused" not in script:
        command = wire.control(wire.verb("REMOVE"), body=wire.bodies()["ball"][0], generation=1)
        assert wire.ask(command).status == 0
    if "run.lcm" in script:
        assert server.stop() == 0
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, check=False, timeout=60, capture_output=True,
                          text=True)
    assert done.returncode == 0, script + done.stderr


@pytest.mark.parametrize("source", [block for page in PAGES for block in blocks(page, "cpp")])
def test_cpp(source):
    """Compiles against the client library's headers."""
    build = CLI.parents[2]
    folders = [ROOT, ROOT / "clients/cpp", build / "protocol/generated"]
    subprocess.run([*CXX, *(f"-I{folder}" for folder in folders)], input=source, text=True, check=True, timeout=120)
