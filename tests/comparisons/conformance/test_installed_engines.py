"""Every engine that is installed keeps the contract, and its mutants are seen; of ``direct`` all are in every run."""

import math

import pytest

from comparisons.conformance import conformance
from comparisons.conformance.conformance import CHECKS, INSTALLED, check_engine
from comparisons.conformance.mutants import MUTANT, MUTANTS
from comparisons.conformance.trial import Finding
from comparisons.runs.workers import Bounds
from engines.registry import engine, engine_names

FEWEST_MUTANTS = 60  # of an engine, whatever it can do
OTHERS = [name for name in engine_names() if name != "direct"]


def findings(name, monkeypatch, checks):
    monkeypatch.setattr(conformance, "CHECKS", {check: CHECKS[check] for check in checks})
    monkeypatch.setattr(conformance, "BOUNDS", Bounds(seconds=math.inf))
    results = {each.check: each for each in check_engine(engine(name), 1)}
    if results[INSTALLED].finding is Finding.NOT_TESTED:
        pytest.skip(results[INSTALLED].detail)
    assert {check: each.detail for check, each in results.items() if each.finding is Finding.FAILED} == {}
    return {check: each.finding for check, each in results.items()}


@pytest.mark.parametrize(
    "name", [name if name == "mujoco" else pytest.param(name, marks=pytest.mark.nightly) for name in OTHERS]
)
def test_an_engine_keeps_the_contract(name, monkeypatch):
    assert Finding.PASSED in findings(name, monkeypatch, [n for n in CHECKS if not n.startswith(MUTANT)]).values()


@pytest.mark.nightly
@pytest.mark.parametrize("name", OTHERS)
def test_no_mutant_of_an_engine_passes_unseen(name, monkeypatch):
    results = findings(name, monkeypatch, CHECKS)
    assert sum(results[f"{MUTANT}{mutant.name}"] is Finding.PASSED for mutant in MUTANTS) >= FEWEST_MUTANTS
