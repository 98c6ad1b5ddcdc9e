"""``linkproof compare`` in a user's repository: limits, earlier results and an engine from outside the suite."""

import json
import os
import re
from pathlib import Path
from unittest.mock import patch
from xml.etree import ElementTree

import pytest

from analytic.description.loading import read
from comparisons.campaign.results import load
from reports.records import limit_table
from tests.commands import linkproof
from tests.comparisons.faults import announce

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
    assert (done.returncode, done.stderr) == (0, f"report: {Path('held/index.html')}\n")
    recorded = (folder / "held.csv").read_bytes()
    assert linkproof("compare", "--out", "held", "--record", "held.csv", cwd=folder).returncode == 0
    assert (folder / "held.csv").read_bytes() == recorded

    for held in (("--against", "held.csv"), ("--against", "held")):
        words = (*PRESSES, *held, "--quantity", "joint_force", "--junit", "red.xml")
        assert _compare(folder, *words).returncode == 0
        done = _compare(folder, *words, more="0.001")
        assert done.returncode == 1
        assert re.search(
            r"a-press \(as-built\) +run-up +heavy tuned +joint_force:.+ +newly failing: over-limit", done.stdout
        )
        changed = {f"changes/{name}-press/as-built/run-up/heavy/tuned" for name in "ab"}
        assert changed <= _failed(folder / "red.xml")

    press = folder / "b" / "press.toml"
    text = press.read_text(encoding="utf-8")
    press.write_text(text.replace("mass    = 0.03\n", "mass    = 0.0303\n"), "utf-8")
    done = _compare(folder, *PRESSES, *held, "--quantity", "Jeq", "--junit", "red.xml")
    assert done.returncode == 1
    assert re.search(r"b-press \(as-built\) +run-up +closed form +Mkr.peak +changed", done.stdout)
    assert "a-press" not in done.stdout.partition("not as it was recorded")[2]
    places = {f"changes/b-press/{variant}/run-up/closed form" for variant in ("as-built", "as-printed")}
    assert _failed(folder / "red.xml") == places
    assert _compare(folder, PRESSES[0], *held, "--quantity", "Jeq").returncode == 0  # of what is asked for


def test_limits_of_a_file_are_saved_with_the_results(folder):
    limits = folder / "tight.toml"
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 0.001\nreason = "my own"\n')
    done = _compare(folder, "a/press.toml", "--limits", limits, "--quantity", "Mkr", "--save", "r.json", "--out", "out")
    assert done.returncode == 0, done.stderr
    document = json.loads((folder / "r.json").read_text(encoding="utf-8"))
    assert document["command"].endswith(f"--quantity Mkr --limits {limits} --out DIR")
    assert document["limits"][0] == {
        "quantities": ["Mkr"], "settings": [], "regimes": [], "mechanisms": [], "value": 0.001, "reason": "my own",
    }  # fmt: skip
    assert len(document["descriptions"][0]["checksum"]) == 16
    assert limit_table(load(folder / "out")).rows[0][3:] == ("1e-3", "my own")
    assert "my own" in (folder / "out" / "RESULTS.md").read_text(encoding="utf-8")


def test_an_engine_that_prints_leaves_stdout_to_json(folder, monkeypatch):
    monkeypatch.setenv("WORDS", "free for research")
    done = _compare(folder, "a/press.toml", "--quantity", "Jeq", "--json")
    assert "free for research" in done.stderr
    assert {record["engine"] for record in json.loads(done.stdout)["records"]} == {"heavy"}
