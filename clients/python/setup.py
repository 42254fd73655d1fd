"""Generates tumble/messages from the repository's .lcm files before setuptools looks for packages.

Everything else is in pyproject.toml. This runs for normal and editable installs alike, in the checkout; a source
archive already holds the generated files.
"""

import shutil
import subprocess
import tempfile
from pathlib import Path

from setuptools import setup

HERE = Path(__file__).resolve().parent
PROTOCOL = HERE.parent.parent / "protocol"
MESSAGES = HERE / "tumble" / "messages"


def find_generator() -> str:
    """The lcm-gen of the lcm package, else the one on the path."""
    try:
        from lcm import LCM_BIN_DIR
    except ImportError:
        pass
    else:
        if (own := Path(LCM_BIN_DIR) / "lcm-gen").exists():
            return str(own)
    found = shutil.which("lcm-gen")
    if found is None:
        raise SystemExit("lcm-gen not found: pip install lcm, or apt-get install liblcm-bin")
    return found


def generate_messages() -> None:
    sources = sorted(str(path) for path in PROTOCOL.glob("*.lcm"))
    if not sources:
        if (MESSAGES / "__init__.py").exists():
            return
        raise SystemExit(f"no .lcm files in {PROTOCOL}")
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([find_generator(), "--python", "--ppath", scratch, *sources], check=True)
        shutil.rmtree(MESSAGES, ignore_errors=True)
        shutil.copytree(Path(scratch) / "tumble", MESSAGES)


generate_messages()
setup()
