"""``linkproof.check``, ``check_engine`` and ``judge``: what the commands say, as values."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import linkproof
from comparisons.conformance import conformance
from engines.direct_adapter.adapter import DirectEngine
from engines.registry import Unusable
from reports.command_line.app import app


def test_facts_are_the_commands():
    told = CliRunner().invoke(app, ["check", "rimoldi-164", "--json", "-"]).stdout
    assert json.loads(json.dumps(linkproof.check("rimoldi-164"))) == json.loads(told)


def test_a_fault_is_a_fact(tmp_path):
    text = linkproof.load("juki-mf7923d").text
    assert "D = [54.5, 0]" in text
    (tmp_path / "short.toml").write_text(text.replace("D = [54.5, 0]", "D = [1, 0]"))
    assert "cannot be assembled" in linkproof.check(tmp_path / "short.toml")["fault"]


@pytest.fixture
def curves(tmp_path):
    """The closed form's own torque and stroke as a file of another tool."""
    found = linkproof.results("juki-mf7923d", regime="run-up", time=np.linspace(0.0, 0.7, 141))
    columns = np.column_stack([found["time"], found["Mkr"], found["S"]])
    path = tmp_path / "tool.csv"
    np.savetxt(path, columns, delimiter=",", header="time [s],Mkr [N*m],S [m]", comments="", fmt="%.9g")
    return path


def test_results_of_another_tool_are_judged(curves):
    found = linkproof.judge("juki-mf7923d", curves, regime="run-up")
    assert found.passed
    assert sorted(verdict.name for verdict in found.verdicts) == ["Mkr", "S"]
    heavier = linkproof.judge("juki-mf7923d", curves, regime="run-up", gravity=False, limit=1e-4)
    assert not heavier.passed


def test_a_judgement_takes_the_commands_words(curves):
    with pytest.raises(linkproof.LinkproofError, match="--limit: expected a positive share"):
        linkproof.judge("juki-mf7923d", curves, limit=0.0)
    with pytest.raises(linkproof.LinkproofError, match="crank's motion: expected a column"):
        linkproof.judge("juki-mf7923d", curves)


def test_an_engine_is_checked_by_name_or_as_it_is(monkeypatch):
    monkeypatch.setattr(conformance, "CHECKS", {"identity": conformance.CHECKS["identity"]})
    for engine in ("direct", DirectEngine()):
        assert [(found.check, found.finding) for found in linkproof.check_engine(engine, 1)] == [("identity", "passed")]


def test_an_adapter_that_cannot_be_loaded_is_an_error():
    broken = Unusable("barwork", "linkproof_barwork", error=ImportError("no module named barwork"))
    with pytest.raises(linkproof.LinkproofError, match=r"expected an adapter that can be loaded, but .*barwork"):
        linkproof.check_engine(broken)


def test_an_engine_that_is_not_announced_is_an_error():
    with pytest.raises(linkproof.LinkproofError, match="unknown engine 'barwork'"):
        linkproof.check_engine("barwork")


def test_what_is_no_engine_is_an_error():
    with pytest.raises(linkproof.LinkproofError, match="expected the name of an engine, or an adapter, got 3"):
        linkproof.check_engine(3)
