"""Commands in a Python as a browser has it: without processes, threads, SQLite and machine code."""

import subprocess
import sys

from tests.sources import ROOT

# Of Pyodide: modules that it lacks, or has on demand alone; a thread and a process cannot start.
RUNNING = f"""
import sys
sys.path.insert(0, {str(ROOT)!r})
for name in ("_multiprocessing", "_posixshmem", "_sqlite3", "curses", "dask", "distributed", "ezdxf", "fcntl", "grp",
             "llvmlite", "numba", "openpyxl", "pebble", "pwd", "resource", "sqlite3", "termios"):
    sys.modules[name] = None
import os, subprocess, threading

class CannotStart(OSError, RuntimeError):
    pass

def fail(*_, **__):
    raise CannotStart

os.fork = os.posix_spawn = subprocess.Popen.__init__ = threading.Thread.start = fail
from reports.command_line.main import main
for line in sys.stdin:
    if line.startswith("compare"):  # of what a browser has on demand it takes SQLite
        del sys.modules["sqlite3"], sys.modules["_sqlite3"]
    sys.argv = ["linkproof", *line.split()]
    try:
        main()
    except SystemExit as end:
        if end.code:
            sys.exit(f"{{line}} ended with {{end.code}}")
"""
COMMANDS = """check toggle-press
results toggle-press --speed 40 --save motor.csv
judge toggle-press motor.csv --speed 40
sweep rimoldi-164 --vary rod.B.x=165:175:3 --save designs.nc
optimise rimoldi-164 --minimise Mkr.peak --over rod.B.x=170:180 --save best.toml
tolerance rimoldi-164 tolerances.toml --samples 100
compare juki-mf7923d --regime run-up --regime run-up-cubic --engine direct --quantity S
"""


def test_every_command_for_which_a_browser_is_enough(tmp_path):
    (tmp_path / "tolerances.toml").write_text(
        'results = ["stroke"]\n[tolerances]\n"rod.B.x" = 0.05\n', encoding="utf-8"
    )
    command = [sys.executable, "-c", RUNNING]
    done = subprocess.run(command, input=COMMANDS, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "2 deviations: 2 passed" in done.stdout
    assert "Right" in done.stdout
    assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".nc", ".toml"}
