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
PLOTTING = ("matplotlib",)
# Which a plain installation lacks; that ``engines --try`` does without them is tested with it.
EXTRAS = ("openpyxl", "ezdxf", "dask")
HEAVY = (*ENGINES, *PLOTTING, *EXTRAS, "xarray", "numba", "pandas")


@pytest.fixture
def imported(tmp_path):
    """Run a command and say which of some modules it or its children asked for."""
    listed = tmp_path / "imported.txt"

    def run(modules, *command, ends=(0, 1)):
        for name in modules:
            folder = tmp_path / "path" / name
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "__init__.py").write_text(
                f"with open({str(listed)!r}, 'a') as asked:\n    asked.write('{name}\\n')\n"
                f"raise ModuleNotFoundError('not needed here', name={name!r})\n"
            )
        listed.write_text("")
        environment = {**os.environ, "PYTHONPATH": str(tmp_path / "path"), "PYTHONSAFEPATH": ""}
        done = subprocess.run(
            [sys.executable, "-m", "reports.command_line.main", *command],
            capture_output=True,
            text=True,
            cwd=ROOT,
            env=environment,
            check=False,
        )
        assert done.returncode in ends, done.stderr
        return set(listed.read_text().split())

    return run


def test_the_alarm_goes_off(imported):
    command = ("compare", "juki-mf7923d", "--engine", "pymunk", "--quantity", "Jeq")
    assert imported(("pymunk",), *command, ends=(2,)) == {"pymunk"}  # absent, so nothing is judged


@pytest.mark.parametrize(
    "command",
    [
        ("compare", "--help"),
        ("check", "juki-mf7923d"),
        ("results", "slotted-takeup"),
    ],
    ids=" ".join,
)
def test_looking_at_mechanisms_imports_no_engine_and_no_plotting(imported, command):
    assert imported(HEAVY, *command) == set()


@pytest.mark.parametrize(
    "command",
    [
        ("compare", "juki-mf7923d", "--engine", "direct", "--quantity", "Jeq"),
        ("sweep", "rimoldi-164", "--vary", "rod.B.x=174:176:3", "--quantity", "Mkr.peak"),
    ],
    ids=" ".join,
)
def test_a_plain_installation_does_without_the_packages_of_extras(imported, command):
    assert imported(EXTRAS, *command, ends=(0,)) == set()


@pytest.mark.parametrize("name", ENGINES)
def test_an_engine_that_is_not_requested_is_not_imported(imported, name):
    """All others run beside it in one command, so that none of them imports the engine that is left out."""
    others = [f"--engine={other}" for other in own_names() if other != name and engine(other).version() is not None]
    short = ("--regime", "run-up-quintic", "--ramp-time", "0.02", "--hold-time", "0.01")
    command = ("compare", "juki-mf7923d", *short, *others, "--quantity", "Jeq")
    assert imported((name, *PLOTTING, "xarray"), *command) == set()
