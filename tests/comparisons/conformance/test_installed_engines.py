"""Every engine that is installed keeps the contract, and of its mutants not one passes unseen: a test for each."""

import pytest

from comparisons.conformance.conformance import INSTALLED, MUTANT, check_engine
from comparisons.conformance.findings import Finding
from comparisons.conformance.mutants import can_be_altered
from comparisons.conformance.mutations import MUTATIONS
from engines.registry import engine, engine_names

FEWEST_MUTANTS = 20  # of the world of an engine, whatever it can do


@pytest.mark.slow
@pytest.mark.parametrize("name", engine_names())
def test_an_engine_keeps_the_contract_and_no_mutant_of_it_passes_unseen(name):
    adapter = engine(name)
    findings = {each.check: each for each in check_engine(adapter, 1)}
    if findings[INSTALLED].finding is Finding.NOT_APPLICABLE:
        pytest.skip(findings[INSTALLED].detail)
    assert {check: each.detail for check, each in findings.items() if each.finding is Finding.FAILED} == {}
    seen = [f"{MUTANT}{mutation}" for mutation in MUTATIONS]
    seen = [mutant for mutant in seen if findings[mutant].finding is Finding.PASSED]
    assert len(seen) >= FEWEST_MUTANTS or not can_be_altered(adapter)
