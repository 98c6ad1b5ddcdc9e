"""A plug-in costs its own rows alone, whatever importing it does, and is imported only on use."""

import json
import sys

import pytest

from comparisons.trials.runs import plugins
from comparisons.trials.runs.run_engine import RunBounds
from engines.contract import Setting
from tests.commands import linkproof
from tests.comparisons.faults import announce
from tests.comparisons.hostile_engines import ENGINES

MODULES = {
    "raising": "import math\nraise ValueError('at import')\n",
    "misspelt": "class Adapter:\n    def (\n",
    "pressing": "raise KeyboardInterrupt\n",
    "leaving": "import sys\nprint('noise')\nsys.exit(3)\n",
    "ending": "import os\nos._exit(0)\n",
    "hanging": "import time\ntime.sleep(1000)\n",
    "partial": "class Adapter:\n    name = 'partial'\n",
    "unused": "import pathlib\npathlib.Path(__file__).with_suffix('.imported').touch()\n",
}
ROWS = {
    "direct": ("passed", ""),
    "faithful": ("passed", ""),
    "interrupting": ("adapter-error", "raised KeyboardInterrupt"),
    "unsendable": ("adapter-error", "texts and finite numbers, got a function"),
    "number": ("adapter-error", "expected a version as text or None, got a float"),
    "unversioned": ("adapter-error", "raised RuntimeError: no version (tests/comparisons/hostile_engines.py, line "),
    "renamed": ("adapter-error", "expected an adapter with the name of its entry point"),
    "nowhere": ("adapter-error", "the adapter of nowhere raised AttributeError"),
    "missing": ("adapter-error", "No module named 'missing' (announced in missing)"),
    "raising": ("adapter-error", "ValueError: at import (FOLDER/raising.py, line 2)"),
    "misspelt": ("adapter-error", "(FOLDER/misspelt.py, line 2)"),
    "pressing": ("adapter-error", "raised KeyboardInterrupt (FOLDER/pressing.py, line 1)"),
    "leaving": ("crashed", "exited with code 3"),
    "ending": ("crashed", "exited with code 0"),
    "partial": ("adapter-error", "expected an adapter with name, abilities, is_control, version, run, got one without"),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder on the path with a package that announces them all."""
    for name, text in MODULES.items():
        (tmp_path / f"{name}.py").write_text(text)
    entries = {name: f"tests.comparisons.hostile_engines:{name}" for name in ENGINES}
    entries |= {name: f"{name}:Adapter" for name in [*MODULES, "missing"]}
    announce(tmp_path, "hostile", {**entries, "nowhere": "no module:?"})
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(plugins, "_ASKED", {})
    return tmp_path


def told_by(folder, *words):
    """Exit code and JSON of a command that has nothing to say on stderr."""
    done = linkproof(*words, "--json", cwd=folder)
    assert (done.stderr, (folder / "unused.imported").exists()) == ("", False)
    return done.returncode, json.loads(done.stdout, parse_constant=pytest.fail)


def test_every_hostile_plugin_fails_in_its_own_row(folder):
    words = [word for name in ROWS for word in ("--engine", name)]
    code, told = told_by(folder, "compare", "juki-mf7923d", *words, "--jobs", "2", "--quantity", "S")
    found = {row["engine"]: (row["outcome"], row["detail"].replace(str(folder), "FOLDER")) for row in told["records"]}
    for name, (outcome, detail) in ROWS.items():
        assert (name, found[name][0]) == (name, outcome)
        assert detail in found[name][1]
    assert code == 1


def test_engines_lists_what_cannot_be_loaded(folder):
    code, told = told_by(folder, "engines", "faithful", "number")
    assert [record["version"] for record in told["records"]] == ["1.0", "1.0"]  # the second is its package's
    assert (code, told["records"][1]["unusable"].count("got a float")) == (0, 1)


def test_the_command_knows_what_a_plugin_expects_to_fail(folder):
    assert plugins.engine("faithful").expected_failures == {"silence": "its licence"}


def test_an_import_that_hangs_costs_its_own_engine(folder, monkeypatch):
    monkeypatch.setattr(plugins, "LONGEST_LOADING", RunBounds(0.5))
    hanging, faithful = plugins.engines(["hanging", "direct"])
    assert (hanging.version(), faithful.name) == ("1.0", "direct")
    with pytest.raises(Exception, match=r"hanging cannot be loaded: its process took longer than 0\.5 s"):
        hanging.run(None, Setting.TUNED)


def test_a_plugin_is_imported_here_only_where_it_is_run_here(folder):
    module = "tests.comparisons.hostile_engines"
    sys.modules.pop(module)
    for jobs in (2, 0):
        assert module not in sys.modules
        words = ("compare", "juki-mf7923d", "--engine", "faithful", "--setting", "all", "--quantity", "S")
        code, told = told_by(folder, *words, "--jobs", str(jobs))
        assert (code, {row["engine_version"] for row in told["records"]}) == (0, {"1.0"})
    assert plugins.engine("faithful").methods(None)
    assert module in sys.modules
