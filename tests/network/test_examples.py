"""The example scripts of the Python client run as they are."""
import subprocess
import sys

import pytest
from server import ROOT, SCENES

EXAMPLES = sorted((ROOT / "clients/python/examples").glob("*.py"))


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_example(start, wire, script):
    start(SCENES / "free.sdf")
    wire.next("HEARTBEAT", 10.0)
    done = subprocess.run([sys.executable, script], timeout=60, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout


def test_there_are_examples():
    assert {"watch", "push", "hover"} <= {path.stem for path in EXAMPLES}
