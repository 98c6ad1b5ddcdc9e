"""Every engine that is installed keeps the contract, and mutants of each kind are seen in it; of ``direct`` all are."""

import math

import pytest

from comparisons.conformance import conformance
from comparisons.conformance.conformance import CHECKS, INSTALLED, check_engine
from comparisons.conformance.mutants import MUTANT, MUTANTS
from comparisons.conformance.results import Finding
from comparisons.runs.workers import Bounds
from engines.registry import engine, engine_names

FEWEST_MUTANTS = 8  # of an engine, whatever it can do
# The first of every sample, of every channel, and of extrapolations.
KINDS = {one.name.partition(": ")[0]: f"{MUTANT}{one.name}" for one in reversed(MUTANTS)}


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in engine_names() if name != "direct"])
def test_an_engine_keeps_the_contract_and_no_mutant_of_it_passes_unseen(name, monkeypatch):
    chosen = {n: one for n, one in CHECKS.items() if n in KINDS.values() or not n.startswith(MUTANT)}
    monkeypatch.setattr(conformance, "CHECKS", chosen)
    monkeypatch.setattr(conformance, "BOUNDS", Bounds(seconds=math.inf))
    results = {each.check: each for each in check_engine(engine(name), 1)}
    if results[INSTALLED].finding is Finding.NOT_TESTED:
        pytest.skip(results[INSTALLED].detail)
    assert {check: each.detail for check, each in results.items() if each.finding is Finding.FAILED} == {}
    assert sum(results[mutant].finding is Finding.PASSED for mutant in KINDS.values()) >= FEWEST_MUTANTS
