"""What a command does not need is not imported, in its own process or in any that it starts.

A module that must not be imported is replaced by one that leaves its name on a list when it is: the replacements come
first on the path that child processes inherit.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from engines.registry import engine, own_names

ROOT = Path(__file__).parents[1]

ENGINES = ("exudyn", "pymunk")
# Which a plain installation lacks; that commands do without them is tested in tests/linkproof/test_in_a_browser.py.
EXTRAS = ("openpyxl", "ezdxf", "dask")
COMMANDS = """
import sys
from reports.command_line.main import main
for line in sys.stdin:
    sys.argv = ["linkproof", *line.split()]
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
"""
HEAVY = (*ENGINES, *EXTRAS, "matplotlib", "xarray", "numba", "pandas")


@pytest.fixture
def imported(tmp_path):
    """Run commands in one process and say which of some modules it or its children asked for."""
    listed = tmp_path / "imported.txt"

    def run(modules, *commands, ends=0):
        for name in modules:
            folder = tmp_path / "path" / name
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "__init__.py").write_text(
                f"with open({str(listed)!r}, 'a') as asked:\n    asked.write('{name}\\n')\n"
                f"raise ModuleNotFoundError('not needed here', name={name!r})\n"
            )
        listed.write_text("")
        environment = {**os.environ, "PYTHONPATH": f"{tmp_path / 'path'}{os.pathsep}{ROOT}"}
        done = subprocess.run(
            [sys.executable, "-c", COMMANDS],
            input="\n".join(commands), capture_output=True, text=True, env=environment, check=False,
        )  # fmt: skip
        assert done.returncode == ends, done.stderr
        return set(listed.read_text().split())

    return run


def test_the_alarm_goes_off(imported):
    command = "compare juki-mf7923d --engine pymunk --quantity Jeq"
    assert imported(("pymunk",), command, ends=1) == {"pymunk"}  # installed, and its import fails


def test_looking_at_mechanisms_imports_no_engine_no_plotting_and_nothing_of_an_extra(imported):
    assert imported(HEAVY, "compare --help", "check juki-mf7923d", "results slotted-takeup") == set()


@pytest.mark.nightly
@pytest.mark.parametrize("name", ENGINES)
def test_an_engine_that_is_not_requested_is_not_imported(imported, name):
    """All others run beside it in one command, so that none of them imports the engine that is left out."""
    others = [f"--engine={other}" for other in own_names() if other != name and engine(other).version() is not None]
    short = "--regime run-up-quintic --ramp-time 0.02 --hold-time 0.01 --quantity Mkr"
    assert imported((name, "matplotlib", "xarray"), f"compare juki-mf7923d {short} {' '.join(others)}") == set()
