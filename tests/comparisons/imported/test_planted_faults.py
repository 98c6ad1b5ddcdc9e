"""Faults planted in curves of the closed form: each is the likeliest cause, or among those that fit."""

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import load
from comparisons.conformance.trial import case
from comparisons.faults.fault import Simulation
from comparisons.faults.ranking import differs, model_faults
from comparisons.faults.settings import motion_settings
from comparisons.imported.judge import judge
from tests.comparisons.imported.exported import exported

JUKI = load("juki-mf7923d")
QUINTIC = crank_motion("run-up-quintic")
MOTION = crank_motion("run-up-quintic", start_angle=0.4)
TIME = np.linspace(0.0, 0.7, 281)
NAMES = ("Mkr", "shaking_force:x", "shaking_force:y")
SAMPLES = ("four-bar", "slider-crank", "quick return", "force", "torque", "spring", "damper")
PART = 0.03  # of what counts as a change


def kinds(judgement):
    """The likeliest causes without the names of their columns; they explain everything."""
    assert not judgement.explanation.unexplained
    assert all(finding.fully for finding in judgement.explanation.findings)
    return [finding.likeliest.fault.name.partition(":")[0] for finding in judgement.explanation.findings]


def first(kinds):
    """One kind in every run of the tests, the others by night."""
    one, *others = kinds
    return [one, *(pytest.param(kind, marks=pytest.mark.nightly) for kind in others)]


RUNS = {
    "speed": crank_motion("run-up-quintic", speed=960.0 * RPM, start_angle=0.4),
    "ramp": crank_motion("run-up-cubic", start_angle=0.4),
    "start angle": crank_motion("run-up-quintic", start_angle=0.7),
    "direction": crank_motion("run-up-quintic", start_angle=0.4, clockwise=True),
}


@pytest.mark.parametrize(
    ("change", "words"), [(-1.0, "has the other sign in 2 single samples"), (1.5, "is off in 2 single samples")]
)
def test_single_samples_with_the_other_sign_are_called_so(change, words):
    stray = np.isin(np.arange(len(TIME)), (50, 170))
    results = exported(
        JUKI, QUINTIC, ("Mkr",), TIME, change=lambda v, _: {"Mkr": np.where(stray, change, 1.0) * v["Mkr"]}
    )
    (finding,) = judge(JUKI, results, QUINTIC).explanation.findings
    assert words in finding.likeliest.words


def test_a_column_of_another_quantity_is_recognised():
    results = exported(JUKI, QUINTIC, ("Mkr", "Peq"), TIME, change=lambda v, _: {"Mkr": v["Peq"], "Peq": v["Peq"]})
    assert kinds(judge(JUKI, results, QUINTIC)) == ["is Peq"]


@pytest.mark.parametrize("kind", first(RUNS))
def test_another_motion_than_stated_is_the_likeliest_cause(kind):
    results = exported(JUKI, MOTION, ("Mkr", "S", "v"), TIME, model=Simulation(JUKI, RUNS[kind]))
    assert set(kinds(judge(JUKI, results, MOTION))) == {kind}


def planted(fault, simulation):
    """A simulation with a fault, its numbers a little off or the first usual ones."""
    numbers = [n + PART * size for n, size in zip(fault.start, fault.sizes, strict=False)]
    return fault.plant(simulation, *(numbers or (fault.usual[0] if fault.usual else ())))


def misses(linkage, every=1, first=0):
    simulation, missed = Simulation(linkage, MOTION), []
    faults = [*motion_settings(MOTION), *model_faults(simulation)]
    for fault in faults[first::every]:
        results = exported(linkage, MOTION, NAMES, TIME[::2], digits=7, model=planted(fault, simulation))
        judgement = judge(linkage, results, MOTION)
        fits = [fit.fault.name for finding in judgement.explanation.findings for fit in finding.every]
        if fault.name not in fits and any(differs(verdict.evidence) for verdict in judgement.verdicts):
            missed.append((fault.name, fits[:3]))
    return missed


@pytest.mark.nightly
@pytest.mark.parametrize("number", range(len(SAMPLES)), ids=SAMPLES)
def test_a_fault_is_found_where_it_is_planted(number):
    """Every seventh of one linkage, each linkage beginning with another."""
    assert misses(case(SAMPLES[number]).mechanism.linkage, len(SAMPLES), number) == []
