"""``compare`` in a user's repository, ``bench``, ``stress``: limits, earlier results, refusals, files, exit codes."""

import json
import os
import re
from pathlib import Path
from unittest.mock import patch
from xml.etree import ElementTree

import pytest

from analytic.description.loading import read
from comparisons.trials.campaign import results
from comparisons.trials.runs.files import STORE
from comparisons.trials.runs.store import unfinished_command
from comparisons.trials.stress import campaign
from comparisons.trials.work_precision.study import Extent
from comparisons.trials.work_precision.table import load
from reports.api import campaign as made
from reports.api.options import Motion
from reports.records import limit_table
from tests.commands import linkproof, refused
from tests.comparisons.faults import PATIENCE, announce

PRESSES = ("a/press.toml", "b/press.toml")
HEAVY = """
import os
from dataclasses import replace
from engines.direct_adapter.adapter import DirectEngine

class HeavyEngine(DirectEngine):
    name, is_control = "heavy", False

    def run(self, scene, setting):
        more = float(os.environ.get("MORE", "0"))
        print(os.environ.get("WORDS", ""), end="")
        bodies = tuple(replace(body, mass=body.mass * (1.0 + more)) for body in scene.bodies)
        return super().run(replace(scene, bodies=bodies), setting)
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A stranger's repository: two linkages of one name, limits, and an engine that makes its parts heavier."""
    (tmp_path / "heavy_engine.py").write_text(HEAVY)
    announce(tmp_path, "heavy-engine", {"heavy": "heavy_engine:HeavyEngine"})
    monkeypatch.syspath_prepend(tmp_path)
    text = read("juki-mf7923d").text
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "press.toml").write_text(text, encoding="utf-8")
    return tmp_path


def _compare(folder, *words, more="0"):
    with patch.dict(os.environ, {"MORE": more}):
        return linkproof("compare", *words, "--engine", "heavy", "--jobs", "0", cwd=folder)


def _failed(file):
    """The classes of the failed test cases in a JUnit file."""
    return {case.get("classname") for case in ElementTree.parse(file).iter("testcase") if len(case)}


def test_a_changed_mass_is_red_by_its_figures_and_in_an_engine_by_its_rows(folder):
    done = _compare(folder, *PRESSES, "--out", "held", "--record", "held.csv")
    assert (done.returncode, done.stderr) == (0, f"wrote held.csv\nwrote {Path('held/index.html')}\n")
    recorded = (folder / "held.csv").read_bytes()
    assert linkproof("compare", "--out", "held", "--record", "held.csv", cwd=folder).returncode == 0
    assert (folder / "held.csv").read_bytes() == recorded

    words = (*PRESSES, "--against", "held.csv", "--quantity", "joint_force", "--junit", "red.xml")
    assert _compare(folder, *words).returncode == 0
    done = _compare(folder, *words, more="0.001")
    assert done.returncode == 1
    assert re.search(
        r"a-press \(as-built\) +run-up +heavy tuned +joint_force:.+ +newly failing: over-limit", done.stdout
    )
    assert {f"changes/{name}-press/as-built/run-up/heavy/tuned" for name in "ab"} <= _failed(folder / "red.xml")

    press = folder / "b" / "press.toml"
    text = press.read_text(encoding="utf-8")
    press.write_text(text.replace("mass    = 0.03\n", "mass    = 0.0303\n"), "utf-8")
    done = _compare(folder, *PRESSES, "--against", "held", "--quantity", "Jeq", "--junit", "red.xml")
    assert done.returncode == 1
    assert re.search(r"b-press \(as-built\) +run-up +closed form +Mkr.peak +changed", done.stdout)
    assert "a-press" not in done.stdout.partition("not as it was recorded")[2]
    places = {f"changes/b-press/{variant}/run-up/closed form" for variant in ("as-built", "as-printed")}
    assert _failed(folder / "red.xml") == places
    done = _compare(folder, PRESSES[0], "--against", "held", "--quantity", "Jeq")
    assert (done.returncode, "b-press" in done.stdout) == (1, True)  # which may be deleted


def test_limits_of_a_file_are_saved_with_the_results(folder):
    limits = folder / "tight.toml"
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 0.001\nreason = "my own"\n')
    done = _compare(folder, "a/press.toml", "--limits", limits, "--quantity", "Mkr", "--save", "r.json", "--out", "out")
    assert done.returncode == 0, done.stderr
    document = json.loads((folder / "r.json").read_text(encoding="utf-8"))
    assert document["command"].endswith(f"--quantity Mkr --limits {limits} --out DIR")
    assert document["limits"][0] == {
        "quantities": ["Mkr"], "settings": [], "regimes": [], "mechanisms": [], "engines": [], "value": 0.001,
        "reason": "my own",
    }  # fmt: skip
    assert limit_table(results.load(folder / "out")).rows[0][3:] == ("1e-3", "my own")
    assert "my own" in (folder / "out" / "RESULTS.md").read_text(encoding="utf-8")


def test_an_engine_that_prints_leaves_stdout_to_json(folder, monkeypatch):
    monkeypatch.setenv("WORDS", "free for research")
    done = _compare(folder, "a/press.toml", "--quantity", "Jeq", "--json")
    assert "free for research" in done.stderr
    assert {record["engine"] for record in json.loads(done.stdout)["records"]} == {"heavy"}


SHORT = Extent((12.0, 24.0, 48.0), budget=PATIENCE, repeats=2, patience=PATIENCE)
BENCH = ("bench", "juki-mf7923d", "--engine", "direct", "--quantity", "Mkr", "--quick")


@pytest.fixture
def short(monkeypatch):
    """A benchmark of seconds: a short run-up, three steps."""
    monkeypatch.setattr(made, "QUICK", SHORT)
    hurried = Motion(regime="run-up-quintic", ramp_time=0.1, hold_time=0.0)
    monkeypatch.setattr(made, "usual_motion", lambda *_, **__: hurried)


def test_a_benchmark_is_printed_written_and_read_back(short, tmp_path):
    done = linkproof(*BENCH, "--out", tmp_path / "out")
    assert done.returncode == 0
    for words in ("juki-mf7923d (as-built), run-up-quintic: Mkr", "to get"):
        assert words in done.stdout
    saved = load(tmp_path / "out").as_dict
    assert {row["setting"] for row in saved["records"]} >= {"naive", "tuned", "best", "exact"}
    assert saved["command"] == " ".join(("linkproof", *BENCH))
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names >= {STORE, "bench.html", "assets"}
    assert unfinished_command(tmp_path / "out") == ""
    assert len(load(tmp_path / "out").points) == len(saved["records"])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--quantity", "torqe"), "did you mean 'Mkr'"),
        (("slotted-takeup", "--regime", "own", "--quantity", "Mkr"), "none of Mkr is a result"),
    ],
)
def test_bad_input_of_a_benchmark_is_refused_before_any_run(options, words, monkeypatch):
    monkeypatch.setattr(made, "measure_all", lambda *_: pytest.fail("something was run"))
    assert words in refused("bench", *options)


CELL = "start/positions/1e-08/direct/tuned"


@pytest.fixture(autouse=True)
def _unhurried(monkeypatch):
    """A cell may take minutes unless its time is given."""
    monkeypatch.setattr(campaign, "_cell_seconds", lambda *_, **__: PATIENCE)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("start", CELL), "either axes or cells"),
        (("--jobs", "0"), "--jobs"),
        (("start", "--engine", "direct", "--setting", "no such", "--quick"), "no stability run matches no such"),
        ((CELL, "--out", "out"), "--out takes whole maps"),
        ((CELL, "--setting", "tuned"), "--setting takes whole maps"),
    ],
)
def test_bad_input_is_refused_before_any_cell_is_made(options, words, monkeypatch, tmp_path):
    monkeypatch.setattr(made, "make_maps", lambda *_: pytest.fail("cells were made"))
    assert words in refused("stress", *options, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_cell_alone_is_printed_in_full_and_written_as_json():
    text = " ".join(linkproof("stress", CELL).stdout.split())
    assert text.startswith(f"{CELL}: within limit")
    assert "Worst invariant:" in text
    (cell,) = json.loads(linkproof("stress", CELL, "--json").stdout)["cells"]
    assert (cell["verdict"], cell["command"]) == ("within limit", f"linkproof stress '{CELL}'")


def test_maps_are_written_and_read_back(tmp_path):
    done = linkproof("stress", "start", "--engine", "direct", "--setting", "tuned", "--quick", "--out", tmp_path)
    assert done.returncode == 0
    files = {path.name for path in tmp_path.iterdir()}
    assert files == {STORE, "stress.html", "index.html", "assets"}
    assert "missed 0" in " ".join(done.stdout.split())
    assert linkproof("stress", "--out", tmp_path).stdout == done.stdout
