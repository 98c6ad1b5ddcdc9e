"""The conformance test on trial: a right engine passes, one wrong in one thing fails the check that names it."""

import re
from dataclasses import replace

import pytest

from comparisons.conformance import conformance
from comparisons.conformance.conformance import (
    CHECKS,
    MUTANT,
    check_engine,
    examine,
    parametrize_engine_checks,
)
from comparisons.conformance.findings import Finding, Found, examined, in_workers, with_expected
from engines.direct_adapter.adapter import DirectEngine
from tests.comparisons.conformance.wrong_engines import (
    WRONG,
    AlterableEngine,
    BlindEngine,
    BrokenEngine,
    DyingEngine,
    NarrowEngine,
    PrintingEngine,
)

pytest_plugins = ["pytester"]
OWN = [name for name in CHECKS if not name.startswith(MUTANT)]
MUTANTS = [name for name in CHECKS if name.startswith(MUTANT)]


def _findings(engine, names=OWN):
    return {name: examined(engine, CHECKS[name]) for name in names}


@pytest.fixture(scope="module")
def right():
    """All findings on a right engine whose world can be altered."""
    return _findings(AlterableEngine(), CHECKS)


def test_a_right_engine_passes_every_check_and_all_its_mutants_are_seen(right):
    assert {f.check: f.detail for f in right.values() if f.finding is not Finding.PASSED} == {
        "refusals": "its abilities cover every sample and setting"
    }
    assert len(MUTANTS) >= 50


def test_of_a_partial_engine_what_it_offers_is_checked():
    found = _findings(NarrowEngine(), CHECKS)
    assert not [f for f in found.values() if f.finding is Finding.FAILED]
    assert [name for name in OWN if found[name].finding is Finding.PASSED] == OWN
    assert found["mutant: spring left out"].finding is Finding.NOT_APPLICABLE
    assert found["mutant: no gravity"].finding is Finding.NOT_TESTED  # no world of its own to alter
    assert found["mutant: a joint's force on its other body"].finding is Finding.NOT_APPLICABLE
    assert found["mutant: two joints' forces exchanged"].finding is Finding.PASSED


@pytest.mark.parametrize("fault", WRONG)
def test_an_engine_wrong_in_one_thing_fails_the_check_that_names_it(fault):
    engine, check, words = WRONG[fault]
    failed = {name: f.detail for name, f in _findings(engine).items() if f.finding is Finding.FAILED}
    assert list(failed) == [check]
    assert re.search(words, failed[check]), failed[check]


def test_a_mutant_that_no_row_sees_is_named():
    found = _findings(BlindEngine(), MUTANTS)
    unseen = {name for name, f in found.items() if f.finding is Finding.FAILED}
    assert "mutant: no gravity" in unseen
    assert "mutant: drive torque reversed" not in unseen
    assert "expected a row over its limit, got none" in found["mutant: no gravity"].detail


def test_an_engine_that_brings_its_process_down_fails_that_check_alone():
    bad, identity = in_workers(examine, DyingEngine(), ["bad data", "identity"], 1)
    assert (bad.finding, identity.finding) == (Finding.FAILED, Finding.PASSED)
    assert "SIGABRT" in bad.detail


def test_a_failure_that_is_expected_is_told_from_one_that_is_not():
    failed, passed = Found("silence", Finding.FAILED, "it prints"), Found("silence", Finding.PASSED)
    expected = {"silence": "its licence banner"}
    assert with_expected(failed, expected) == replace(
        failed, finding=Finding.EXPECTED, detail="its licence banner (it prints)"
    )
    assert with_expected(passed, expected).finding is Finding.FAILED
    assert with_expected(failed, {}) == failed


def test_mutants_wait_until_the_engine_itself_passes(monkeypatch):
    chosen = ("identity", "silence", "mutant: no gravity", "mutant: two joints' forces exchanged")
    monkeypatch.setattr(conformance, "CHECKS", {name: CHECKS[name] for name in chosen})
    found = {each.check: each for each in check_engine(PrintingEngine(), 1)}
    assert found["silence"].finding is Finding.FAILED
    for name in chosen[2:]:
        assert (found[name].finding, found[name].detail) == (
            Finding.NOT_TESTED, "'silence' fails: correct the engine first"
        )  # fmt: skip


def test_all_checks_wait_until_one_run_finishes():
    found = {each.check: each for each in check_engine(BrokenEngine(), 1)}
    assert found["installed"].finding is Finding.FAILED
    assert "the start is not solved" in found["installed"].detail
    assert {found[name].finding for name in CHECKS if name not in ("identity", "installed")} == {Finding.NOT_TESTED}


def test_an_expected_failure_of_no_check_is_named():
    engine = DirectEngine()
    engine.expected_failures = {"slience": "a slip"}
    assert check_engine(engine, 1)[0].finding is Finding.FAILED
    with pytest.raises(KeyError, match="slience"):
        parametrize_engine_checks(engine)


SUITE = """
from comparisons.conformance.conformance import parametrize_engine_checks
from tests.comparisons.conformance.wrong_engines import PrintingEngine

@parametrize_engine_checks(PrintingEngine(), {expected!r})
def test_engine(check):
    check()
"""


@pytest.mark.parametrize(
    ("expected", "outcome"),
    [
        ({}, {"failed": 1}),
        ({"silence": "it prints"}, {"xfailed": 1}),
        ({"silence": "it prints", "repetition": "once"}, {"failed": 1, "xfailed": 1}),
    ],
)
def test_pytest_has_a_case_of_every_check_and_turns_red_when_an_expected_failure_passes(pytester, expected, outcome):
    pytester.makepyfile(SUITE.format(expected=expected))
    done = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-k", "silence or repetition or refusals or gravity")
    counts = done.parseoutcomes()
    assert {name: counts.get(name, 0) for name in ("failed", "xfailed")} == {"failed": 0, "xfailed": 0, **outcome}
    assert counts["skipped"] >= 4  # refusals do not apply, worlds cannot be altered
