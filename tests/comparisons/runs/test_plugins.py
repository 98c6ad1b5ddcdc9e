"""A plug-in costs its own rows alone: only workers import it, on first use, and its runs are checked."""

import json
import os
import sys
from types import SimpleNamespace

import pytest

from comparisons.runs import plugins
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import Failure, Lost
from comparisons.runs.workers import run_jobs
from engines import registry
from tests.commands import linkproof
from tests.comparisons.faults import announce
from tests.comparisons.hostile_engines import ENTRIES, ROWS

HOSTILE = "tests.comparisons.hostile_engines"
UNUSED = (
    "import pathlib, time\npathlib.Path(__file__).with_suffix('.imported').touch()\nprint('noise')\ntime.sleep(1000)\n"
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder on the path with a package that announces hostile engines, one of which nobody asks for."""
    (tmp_path / "unused.py").write_text(UNUSED)
    announce(tmp_path, "hostile", {**ENTRIES, "unused": "unused:Engine"})
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, HOSTILE)
    return tmp_path


def told_by(folder, *words):
    """Exit code and JSON of a command that has nothing to say on stderr."""
    done = linkproof(*words, "--json", cwd=folder)
    assert (done.stderr, (folder / "unused.imported").exists(), HOSTILE in sys.modules) == ("", False, False)
    return done.returncode, json.loads(done.stdout, parse_constant=pytest.fail)


def test_every_hostile_plugin_fails_in_its_own_row(folder):
    words = [word for name in ("direct", *ROWS) for word in ("--engine", name)]
    code, told = told_by(folder, "compare", "juki-mf7923d", *words, "--jobs", "2", "--quantity", "S")
    rows = {row["engine"]: row for row in told["records"]}
    assert (rows["direct"]["outcome"], rows["direct"]["error_max"] < 1e-12) == ("passed", True)
    for name, (outcome, detail) in ROWS.items():
        assert (name, rows[name]["outcome"]) == (name, outcome)
        assert detail in rows[name]["detail"]
    assert code == 1


def test_a_plugin_that_nobody_asks_for_is_not_imported(folder):
    code, told = told_by(folder, "engines", "faithful", "number")
    assert [record["version"] for record in told["records"]] == ["1.0", "1.0"]  # the second is its package's
    assert (code, told["records"][1]["unusable"].count("got a float")) == (0, 1)


def process_of(name):
    return engine(name).name, os.getpid()


def test_no_engine_runs_where_another_plugin_has_been(folder):
    names = ["direct", "faithful", "faithful", "number", "direct"]
    results = dict(run_jobs(process_of, [(name,) for name in names], processes=1))
    assert [results[number][0] for number in range(5)] == names
    processes = [results[number][1] for number in range(5)]
    assert processes[0] == processes[1] == processes[2]
    assert len(set(processes[2:])) == 3


def test_entry_points_of_importlib_metadata_are_plugins_as_well(monkeypatch):
    """Once that package is imported, all entry points are of its type; a worker looks at a plug-in all the same."""
    point = SimpleNamespace(name="strange", value="strange:Adapter", dist=None)
    monkeypatch.setattr(registry, "announced", lambda: {"strange": [point]})
    monkeypatch.setattr(registry, "engine", lambda name: pytest.fail("imported in this process"))
    monkeypatch.setattr(plugins, "_call_in_workers", lambda function, jobs: [Lost(Failure.CRASHED, "in a worker")])
    (adapter,) = plugins.engines(("strange",))
    assert "in a worker" in str(adapter.error)
