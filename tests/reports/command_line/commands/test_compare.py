"""`compare` in a project of a user's own: limits, a baseline and an engine that come from outside the suite."""

import json
import os
import re
from unittest.mock import patch
from xml.etree import ElementTree

import pytest

from analytic.description.loading import read
from comparisons.campaign.results import load
from reports.records import matrix
from tests.commands import ROOT, linkproof
from tests.comparisons.faults import announce

PROJECT = """
linkages = ["*/press.toml"]
engines = ["heavy"]
[[limit]]
quantities = ["Mkr"]
value = 0.25
reason = "what the gearbox takes"
"""
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
    (tmp_path / "linkproof.toml").write_text(PROJECT)
    return tmp_path


def _compare(folder, *words, more="0"):
    with patch.dict(os.environ, {"MORE": more}):
        return linkproof("compare", *words, "--jobs", "0", cwd=folder)


def _heavier(path):
    path.write_text(path.read_text(encoding="utf-8").replace("mass    = 0.03\n", "mass    = 0.0303\n"), "utf-8")


def test_a_changed_mass_is_red_by_its_figures_and_in_an_engine_by_its_rows(folder):
    done = _compare(folder, "--record-baseline")
    assert (done.returncode, done.stderr) == (0, "baseline: " + str(folder / "linkproof-baseline.json") + "\n")
    assert _compare(folder).returncode == 0

    done = _compare(folder, "--quantity", "joint_force", "--junit", "red.xml", more="0.01")
    assert done.returncode == 1
    assert "key figures" not in done.stdout
    failed = {case.get("classname") for case in ElementTree.parse(folder / "red.xml").iter("testcase") if len(case)}
    assert failed == {"a-press/as-built/run-up/heavy/tuned", "b-press/as-built/run-up/heavy/tuned"}

    _heavier(folder / "b" / "press.toml")
    done = _compare(folder, "--quantity", "Jeq", "--junit", "red.xml")
    assert done.returncode == 1
    assert "b/press.toml has changed since its baseline was recorded" in done.stdout
    assert re.search(r"b-press \(as-built\) +run-up +Mkr.peak", done.stdout)
    assert re.search(r"b-press \(as-printed\) +run-up +Mkr.peak", done.stdout)
    assert "14 of 96 key figures are not as recorded" in done.stdout
    assert not re.search(r"a-press .* Mkr.peak", done.stdout)
    failed = {case.get("classname") for case in ElementTree.parse(folder / "red.xml").iter("testcase") if len(case)}
    assert failed == {f"b-press/{variant}/run-up/key figures" for variant in ("as-built", "as-printed")}
    assert _compare(folder / "a", "press.toml", "--engine", "direct", "--quantity", "Jeq").returncode == 0

    (folder / "b" / "press.toml").unlink()
    done = _compare(folder, "--quantity", "Jeq", "--junit", "red.xml", "--out", "out")
    assert done.returncode == 1
    assert "b/press.toml is in the baseline and does not exist any more: " in done.stdout
    failed = {case.get("classname") for case in ElementTree.parse(folder / "red.xml").iter("testcase") if len(case)}
    assert failed == {"baseline"}
    for page in ("RESULTS.md", "index.html"):
        text = (folder / "out" / page).read_text(encoding="utf-8")
        assert "Not as in the baseline: b/press.toml is in" in text
        assert "Trust heavy" not in text
    assert _compare(folder, "--quantity", "Jeq", "--allow-missing").returncode == 0


def test_what_is_saved_holds_the_standard(folder):
    _compare(folder, "--record-baseline", "--quantity", "Mkr")
    limits = folder / "tight.toml"
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 0.001\nreason = "my own"\n')
    done = _compare(folder, "a/press.toml", "--limits", limits, "--quantity", "Mkr", "--json", "r.json", "--out", "out")
    assert done.returncode == 0, done.stderr
    document = json.loads((folder / "r.json").read_text(encoding="utf-8"))
    assert document["command"].endswith(f"--quantity Mkr --limits {limits} --out DIR")
    assert document["limits"][0] == {
        "quantities": ["Mkr"], "settings": [], "regimes": [], "mechanisms": [], "value": 0.001, "reason": "my own",
    }  # fmt: skip
    assert {row["changed"] for row in document["figures"]} == {False}
    assert len(document["descriptions"][0]["checksum"]) == 16
    saved = load(folder / "out")
    assert saved.figures
    assert matrix.limit_table(saved).rows[0][3:] == ("1e-3", "my own")
    assert "my own" in (folder / "out" / "RESULTS.md").read_text(encoding="utf-8")


def test_nothing_is_recorded_where_no_file_is_named(tmp_path):
    before = {path: path.stat().st_mtime_ns for path in (ROOT / "comparisons").rglob("*.json")}
    done = _compare(tmp_path, "juki-mf7923d", "--engine", "direct", "--record-baseline")
    assert (done.returncode, done.stdout) == (2, "")
    assert "--record-baseline: expected a file to record into" in done.stderr
    assert {path: path.stat().st_mtime_ns for path in (ROOT / "comparisons").rglob("*.json")} == before
    assert list(tmp_path.iterdir()) == []


def test_an_engine_that_prints_leaves_stdout_to_json(folder, monkeypatch):
    monkeypatch.setenv("WORDS", "free for research")
    done = _compare(folder, "a/press.toml", "--json", "-")
    assert "free for research" in done.stderr
    assert {record["engine"] for record in json.loads(done.stdout)["records"]} == {"heavy"}
