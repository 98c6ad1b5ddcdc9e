"""Every engine that is installed keeps the contract, and of its mutants not one passes unseen: a test for each."""

import pytest

from comparisons.conformance.conformance import CHECKS, MUTANT, examine, expected_failures
from comparisons.conformance.findings import Finding, examined, in_workers, with_expected
from comparisons.conformance.mutants import can_be_altered
from comparisons.conformance.mutations import MUTATIONS
from engines.registry import engine, engine_names

FEWEST_MUTANTS = 20  # of the world of an engine, whatever it can do


@pytest.mark.slow
@pytest.mark.parametrize("name", engine_names())
def test_an_engine_keeps_the_contract_and_no_mutant_of_it_passes_unseen(name):
    adapter = engine(name)
    if adapter.version() is None:
        pytest.skip(f"{name} is not installed")
    expected = expected_failures(adapter)
    alone = [check.name for check in CHECKS.values() if check.alone]
    found = in_workers(examine, adapter, alone, 1)
    found += [examined(adapter, check) for check in CHECKS.values() if not check.alone]
    findings = {each.check: with_expected(each, expected) for each in found}
    if findings["installed"].finding is Finding.NOT_APPLICABLE:
        pytest.skip(findings["installed"].detail)
    assert {check: each.detail for check, each in findings.items() if each.finding is Finding.FAILED} == {}
    seen = [f"{MUTANT}{mutation}" for mutation in MUTATIONS]
    seen = [mutant for mutant in seen if findings[mutant].finding is Finding.PASSED]
    assert len(seen) >= FEWEST_MUTANTS or not can_be_altered(adapter)
