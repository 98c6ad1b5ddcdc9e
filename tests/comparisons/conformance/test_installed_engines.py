"""Every engine that is installed keeps the contract, and mutants of each kind are seen in it; of ``direct`` all are."""

import math

import pytest

from comparisons.conformance import conformance, findings
from comparisons.conformance.conformance import CHECKS, INSTALLED, MUTANT, check_engine
from comparisons.conformance.findings import Finding
from comparisons.conformance.misreadings import MISREADINGS
from comparisons.conformance.mutants import can_be_altered
from comparisons.conformance.mutations import MUTATIONS
from comparisons.runs.workers import Bounds
from engines.registry import engine, engine_names

FEWEST_MUTANTS = 4  # of the world of an engine, whatever it can do
# The first of every sample, and of every channel; what is altered on it is the same for every engine.
KINDS = {mutation.sample: name for name, mutation in reversed(MUTATIONS.items())}
READ_OUTS = {misreading.channel: name for name, misreading in reversed(MISREADINGS.items())}
MUTANTS = {f"{MUTANT}{name}" for name in (*KINDS.values(), *READ_OUTS.values())}


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in engine_names() if name != "direct"])
def test_an_engine_keeps_the_contract_and_no_mutant_of_it_passes_unseen(name, monkeypatch):
    chosen = {check: one for check, one in CHECKS.items() if check in MUTANTS or not check.startswith(MUTANT)}
    monkeypatch.setattr(conformance, "CHECKS", chosen)
    monkeypatch.setattr(findings, "BOUNDS", Bounds(seconds=math.inf))
    adapter = engine(name)
    found = {each.check: each for each in check_engine(adapter, 1)}
    if found[INSTALLED].finding is Finding.NOT_APPLICABLE:
        pytest.skip(found[INSTALLED].detail)
    assert {check: each.detail for check, each in found.items() if each.finding is Finding.FAILED} == {}
    seen = [kind for kind, mutation in KINDS.items() if found[f"{MUTANT}{mutation}"].finding is Finding.PASSED]
    assert len(seen) >= FEWEST_MUTANTS or not can_be_altered(adapter)
