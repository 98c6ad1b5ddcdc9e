"""``linkproof compare`` in a user's repository: limits, a baseline and an engine from outside the suite."""

import json
import os
import re
from unittest.mock import patch
from xml.etree import ElementTree

import pytest

from analytic.description.loading import read
from comparisons.campaign.results import load
from reports.records.views import limit_table
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
    held = ("--baseline", "held.json")
    done = _compare(folder, *PRESSES, *held, "--record-baseline")
    assert (done.returncode, done.stderr) == (0, "baseline: held.json\n")

    done = _compare(folder, *PRESSES, *held, "--quantity", "joint_force", "--junit", "red.xml", more="0.01")
    assert (done.returncode, "key figures" in done.stdout) == (1, False)
    assert _failed(folder / "red.xml") == {f"{name}-press/as-built/run-up/heavy/tuned" for name in "ab"}

    press = folder / "b" / "press.toml"
    text = press.read_text(encoding="utf-8")
    press.write_text(text.replace("mass    = 0.03\n", "mass    = 0.0303\n"), "utf-8")
    done = _compare(folder, *PRESSES, *held, "--quantity", "Jeq", "--junit", "red.xml")
    assert done.returncode == 1
    assert "b/press.toml has changed since its baseline was recorded" in done.stdout
    assert re.search(r"b-press \(as-built\) +run-up +Mkr.peak", done.stdout)
    assert not re.search(r"a-press .* Mkr.peak", done.stdout)
    assert _failed(folder / "red.xml") == {
        f"b-press/{variant}/run-up/key figures" for variant in ("as-built", "as-printed")
    }

    press.unlink()
    done = _compare(folder, PRESSES[0], *held, "--quantity", "Jeq", "--junit", "red.xml")
    assert (done.returncode, _failed(folder / "red.xml")) == (1, {"baseline"})
    assert "b/press.toml is in the baseline and does not exist any more: " in done.stdout
    assert _compare(folder, PRESSES[0], *held, "--quantity", "Jeq", "--allow-missing").returncode == 0


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
