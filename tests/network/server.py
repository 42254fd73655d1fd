"""A tumble-server of the build under test, started beside the test."""
import os
import pathlib
import signal
import subprocess
import time

ROOT = pathlib.Path(__file__).parents[2]
BUILD = pathlib.Path(os.environ.get("TUMBLE_BUILD", ROOT / "build"))
SERVER = BUILD / "server/tumble-server"
CLI = BUILD / "clients/cpp/tumble"
SCENES = ROOT / "tests/scenes"
STOP_SECONDS = 10.0  # a server that needs longer to stop hangs


class Server:
    """One process with its output in a file; use as a context manager, so that it never outlives its test."""

    def __init__(self, log, *arguments, wrapper=()):
        self.log = pathlib.Path(log)
        with open(self.log, "wb") as output:
            self.process = subprocess.Popen([*wrapper, SERVER, *map(str, arguments)], stdin=subprocess.DEVNULL,
                                            stdout=output, stderr=subprocess.STDOUT)

    @property
    def output(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    @property
    def running(self):
        return self.process.poll() is None

    def processor_seconds(self):
        """Used so far, by all of its threads."""
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def wait_for_output(self, text, seconds=5.0):
        """Returns when `text` was printed; fails with everything that was, after `seconds` or the process's end."""
        deadline = time.monotonic() + seconds
        while text not in self.output:
            assert self.running and time.monotonic() < deadline, f"no {text!r} in:\n{self.output}"
            time.sleep(0.01)

    def stop(self, sign=signal.SIGINT):
        """Asks it to stop and returns the exit status."""
        if self.running:
            self.process.send_signal(sign)
        try:
            return self.process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired as error:
            self.process.kill()
            self.process.wait()
            raise AssertionError(f"did not stop within {STOP_SECONDS} s:\n{self.output}") from error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.running:
            self.process.kill()
        self.process.wait()


def run_server(*arguments, wrapper=(), seconds=60.0):
    """Runs a server to its end; returns the finished process with its texts."""
    return subprocess.run([*wrapper, SERVER, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=seconds, check=False)


def run_tumble(*arguments, wrapper=(), seconds=30.0):
    """Runs the command-line client to its end."""
    return subprocess.run([*wrapper, CLI, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=seconds, check=False)
