"""The conformance test on trial: a right engine passes, one wrong in one thing fails the check that names it."""

import math
import re
from dataclasses import replace

import pytest

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import usual_case
from comparisons.trials.conformance import conformance
from comparisons.trials.conformance.conformance import (
    CHECKS,
    FIRST,
    check_engine,
    run_in_workers,
    with_expected,
)
from comparisons.trials.conformance.slips import MUTANT, MUTANTS, likeliest_misreading
from comparisons.trials.conformance.trial import CheckResult, EngineTrial, Finding, NotTestedError
from comparisons.trials.judging.signal_errors import readings
from comparisons.trials.runs.run_engine import RunBounds
from engines.direct_adapter.adapter import DirectEngine
from engines.registry import own_names
from engines.scene import Channel
from tests.comparisons.trials.conformance.wrong_engines import (
    WRONG,
    AlterableEngine,
    BlindEngine,
    BrokenEngine,
    DyingEngine,
    NarrowEngine,
    PrintingEngine,
)
from tests.comparisons.true_motions import true_history
from tests.engines.closed_form import installed

OWN = [name for name in CHECKS if not name.startswith(MUTANT)]

FEWEST_MUTANTS = 6  # of an engine, whatever it can do
OTHERS = [name for name in own_names() if name != "direct"]


def _failed(engine, names):
    trial = EngineTrial(engine)
    results = {name: CHECKS[name].result(trial) for name in names}
    return {name: each.detail for name, each in results.items() if each.finding is Finding.FAILED}


@pytest.fixture(scope="module")
def right():
    """A right engine whose world can be altered, and what it has run."""
    return EngineTrial(AlterableEngine())


def test_a_right_engine_passes_every_check(right):
    results = {name: CHECKS[name].result(right) for name in OWN}
    assert {name: each.detail for name, each in results.items() if each.finding is not Finding.PASSED} == {
        "refusals": "its abilities cover every sample and setting"
    }


def test_every_mutant_of_a_right_engine_fails_a_row(right):
    assert len(MUTANTS) == len({mutant.name for mutant in MUTANTS})
    not_tested = {}
    for mutant in MUTANTS:
        try:
            mutant.check(right)
        except NotTestedError as reason:
            not_tested[mutant.name] = str(reason)
    middle = "start velocities of the middle of the first step"
    assert not_tested == {
        "best: a weight off by 1e-6": "'best' of direct is one run",
        **{
            f"{linkage} at speed: {middle}": "start velocities change nothing in a run of direct"
            for linkage in ("four-bar", "slider-crank")
        },
    }


def test_of_a_partial_engine_what_it_offers_is_checked():
    trial, details = EngineTrial(NarrowEngine()), {
        "slider-crank at speed: starts at rest": (
            "slider-crank at speed: it has no slider joint, which slider joint 'slider on ground' asks for"
        ),
        "four-bar: the coupler's mass 1 % too large": "direct has no 'altered' to replace, as a SteppedEngine has",
        "best: a weight off by 1e-6": "four-bar: direct offers no setting 'best'",
        "joint_force: wrong sign": "",
    }  # fmt: skip
    assert {CHECKS[name].result(trial).finding for name in OWN} == {Finding.PASSED}
    assert {name: CHECKS[f"{MUTANT}{name}"].result(trial).detail for name in details} == details


@pytest.mark.parametrize("fault", WRONG)
def test_an_engine_wrong_in_one_thing_fails_the_check_that_names_it(fault):
    engine, check, words = WRONG[fault]
    failed = _failed(engine, {*FIRST, check})
    assert list(failed) == [check]
    assert re.search(words, failed[check]), failed[check]


@pytest.mark.nightly
@pytest.mark.parametrize("fault", [fault for fault, (_, check, _) in WRONG.items() if check not in FIRST])
def test_an_engine_wrong_in_one_thing_passes_the_other_checks(fault):
    engine, check, _ = WRONG[fault]
    assert list(_failed(engine, OWN)) == [check]


def test_a_mutant_that_no_row_sees_is_named():
    trial = EngineTrial(BlindEngine())
    unseen = CHECKS[f"{MUTANT}four-bar: the coupler's mass 1 % too large"].result(trial)
    assert unseen.finding is Finding.FAILED
    assert unseen.detail.endswith("expected a row over its limit, got none; return what the engine's own model does")
    assert CHECKS[f"{MUTANT}torque: wrong sign"].result(trial).finding is Finding.PASSED


def test_an_engine_that_brings_its_process_down_fails_that_check_alone():
    bad, identity = run_in_workers(DyingEngine(), ["bad data", "identity"], 1)
    assert (bad.finding, identity.finding) == (Finding.FAILED, Finding.PASSED)
    assert "SIGABRT" in bad.detail


def test_a_failure_that_is_expected_differs_from_one_that_is_not():
    failed, passed = CheckResult("silence", Finding.FAILED, "it prints"), CheckResult("silence", Finding.PASSED)
    expected = {"silence": "its licence banner"}
    assert with_expected(failed, expected) == replace(
        failed, finding=Finding.EXPECTED, detail="its licence banner (it prints)"
    )
    assert with_expected(passed, expected).finding is Finding.FAILED
    assert with_expected(failed, {}) == failed


@pytest.mark.parametrize(
    ("engine", "first", "words", "others"),
    [
        (PrintingEngine(), "silence", "stepping", (f"{MUTANT}four-bar: the coupler's mass 1 % too large",)),
        (BrokenEngine(), "installed", "the start is not solved", tuple(set(CHECKS) - {*FIRST})),
    ],
)
def test_all_that_rests_on_a_failing_check_waits_and_one_cause_is_named_once(monkeypatch, engine, first, words, others):
    chosen = {name: check for name, check in CHECKS.items() if name in {*FIRST, first, *others}}
    monkeypatch.setattr(conformance, "CHECKS", chosen)
    results = {each.check: each for each in check_engine(engine, 1)}
    assert [name for name, each in results.items() if each.finding is Finding.FAILED] == [first]
    assert words in results[first].detail
    for name in others:
        assert (results[name].finding, results[name].detail) == (
            Finding.NOT_TESTED, f"'{first}' fails: correct the engine first"
        )  # fmt: skip


def test_an_expected_failure_of_no_check_is_named(monkeypatch):
    monkeypatch.setattr(conformance, "CHECKS", {"identity": CHECKS["identity"]})
    engine = DirectEngine()
    engine.expected_failures = {"slience": "a slip"}
    assert check_engine(engine, 1)[0].finding is Finding.FAILED


def findings(name, monkeypatch, checks):
    monkeypatch.setattr(conformance, "CHECKS", {check: CHECKS[check] for check in checks})
    monkeypatch.setattr(conformance, "BOUNDS", RunBounds(seconds=math.inf))
    results = {each.check: each for each in check_engine(installed(name), 1)}
    assert {check: each.detail for check, each in results.items() if each.finding is Finding.FAILED} == {}
    return {check: each.finding for check, each in results.items()}


@pytest.mark.nightly
@pytest.mark.parametrize("name", OTHERS)
def test_no_mutant_of_an_engine_passes_unseen(name, monkeypatch):
    results = findings(name, monkeypatch, CHECKS)
    assert sum(results[f"{MUTANT}{mutant.name}"] is Finding.PASSED for mutant in MUTANTS) >= FEWEST_MUTANTS


@pytest.mark.parametrize("samples", [6, 7, 8, 30])
def test_a_slip_is_named_of_few_samples_too(samples):
    case = usual_case(Mechanism(load("juki-mf7923d")))
    history = true_history(case, samples)
    right = next(one for one in readings(case.scene(frozenset(Channel)), history) if one.channel is Channel.TORQUE)
    assert likeliest_misreading(right, -right.values) == "it has the wrong sign"
