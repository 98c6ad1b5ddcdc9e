"""Keeping engines quiet: nothing of theirs is written, then or later, and nothing else is lost."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCRIPT = """
import ctypes, os, sys
from engines.installed import silenced
sys.stdout.write("before ")
with silenced():
    sys.stdout.write("of Python ")
    sys.stderr.write("of Python ")
    os.write(1, b"of the system ")
    ctypes.CDLL(None).printf(b"of C ")
sys.stdout.write("after")
"""


def test_what_an_engine_writes_is_written_nowhere():
    held_back = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=held_back, check=True)
    assert (done.stdout, done.stderr) == ("before after", "")
