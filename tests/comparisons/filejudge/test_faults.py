"""Faults planted in curves of the closed form and in exports of an independent program: each is named, with its cure.

The curves in ``foreign`` come from a solution in absolute coordinates that shares nothing with the closed form.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.linkage import JointFriction
from analytic.description.loading import load
from comparisons.filejudge.columns import Correction
from comparisons.filejudge.fault_ranking import differs
from comparisons.filejudge.hypotheses import of_model, of_motion
from comparisons.filejudge.judge import judge
from comparisons.filejudge.reading import read_results
from comparisons.filejudge.simulation import Simulation
from comparisons.trials.conformance.trial import case
from tests.comparisons.filejudge.layouts import exported

JUKI = load("juki-mf7923d")
QUINTIC = crank_motion("run-up-quintic")
MOTION = crank_motion("run-up-quintic", start_angle=0.4)
TIME = np.linspace(0.0, 0.7, 281)
NAMES = ("Mkr", "shaking_force:x", "shaking_force:y")
SAMPLES = ("four-bar", "slider-crank", "quick return", "force", "torque", "spring", "damper")
PART = 0.03  # of what counts as a change

FOLDER = Path(__file__).with_name("foreign")
RADIAN = 57.29577951308232
DEGREES_PER_SECOND = {"omega": Correction(factor=1 / RADIAN)}
# File: words of the likeliest cause, how many others fit as well, and what the mapping may agree to; a second file of
# the same kind is judged by night.
NAMED = {
    "w_degs_only": ("'Angular Velocity crank (rad/s)' is in deg/s, not in rad/s", 0, DEGREES_PER_SECOND),
    "w_rpm_only": ("'crank.w' is in rpm, not in rad/s", 0, {"omega": Correction(factor=6 / RADIAN)}),
    "mo_degs": ("'crank.w' is in deg/s, not in rad/s", 0, DEGREES_PER_SECOND),
    "phi_deg_as_rad": ("'Crank angle (rad)' is in deg, not in rad", 0, {"phi": Correction(factor=1 / RADIAN)}),
    "phi_rad_as_deg": ("'Crank angle (deg)' is in rad, not in deg", 0, {"phi": Correction(factor=RADIAN)}),
    "l4_49": ("x of 'B' on 'rocker' is 49 mm in place of 50 mm", 0, {}),
    "g8": ("x of 'A' on 'crank' is -25.78 mm in place of -25.28 mm", 0, {}),
    "r_26": ("x of 'A' on 'crank' is 26 mm in place of 25 mm", 0, {}),
    "de_piston066": ("the mass of 'piston' is 0.66 kg in place of 0.6 kg", 0, {}),
    "sw_unitlie": ("Mkr is 1000 times the closed form's: N·mm read as N·m", 1, {"Mkr": Correction(factor=1e-3)}),
    "de_nm_lie": ("Mkr is 0.001 times the closed form's: N·m read as N·mm", 1, {"Mkr": Correction(factor=1e3)}),
    "cw_bothflip": (
        "the motor's axis points the other way", 0, {"phi": Correction(sign=-1), "Mkr": Correction(sign=-1)}
    ),
    "sw_first0": ("Mkr is off in a single sample, at 0 s", 0, {}),
    "de_many": ("S counts the other way, from +64.35 mm", 0, {"S": Correction(sign=-1, offset=0.064347)}),
    "s_bdc": ("S counts the other way, from +64.35 mm", 0, {"S": Correction(sign=-1, offset=0.064347)}),
    "sw_forces": ("joint_force:B:x has the other sign", 0, {"joint_force:B:x": Correction(sign=-1)})
}  # fmt: skip


NIGHTLY = ("w_rpm_only", "mo_degs", "de_piston066", "phi_deg_as_rad", "g8", "r_26", "de_nm_lie", "de_many")


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
    ("given", "planted", "words"),
    [
        ({}, {"A": (0.2, 0.0015)}, "joint friction acts in 'A', μ r = 0.3 mm"),
        pytest.param(
            {}, {"needle_bar": (0.15, 0.0), "O1": (0.1, 0.006), "A": (0.08, 0.004)},
            "joint friction acts in 'A', μ r = 0.32 mm; in 'O1', μ r = 0.6 mm; in 'needle_bar', μ = 0.15",
            marks=pytest.mark.nightly,
        ),
        ({"needle_bar": (0.15, 0.0)}, {}, "the friction of the linkage file is left out"),
        pytest.param(
            {"A": (0.1, 0.004)}, {"A": (0.12, 0.004)}, "the coefficient of friction of 'A' is 0.12 in place of 0.1",
            marks=pytest.mark.nightly,
        ),
    ],
)  # fmt: skip
def test_friction_by_the_joints_own_forces_is_named_with_its_coefficients(given, planted, words):
    own, true = (
        replace(JUKI, friction={k: JointFriction(*v) for k, v in joints.items()}) for joints in (given, planted)
    )
    results = exported(own, MOTION, NAMES, TIME[::2], model=Simulation(true, MOTION))
    assert [finding.likeliest.words for finding in judge(own, results, MOTION).explanation.findings] == [words]


@pytest.mark.parametrize("kind", first(RUNS))
def test_another_motion_than_stated_is_the_likeliest_cause(kind):
    results = exported(JUKI, MOTION, ("Mkr", "S", "v"), TIME[::2], model=Simulation(JUKI, RUNS[kind]))
    explanation = judge(JUKI, results, MOTION).explanation
    (finding,) = explanation.findings
    assert (finding.likeliest.fault.name.partition(":")[0], finding.fully, explanation.unexplained) == (kind, True, ())


def planted(fault, simulation):
    """A simulation with a fault, its numbers a little off or the first usual ones."""
    numbers = [n + PART * size for n, size in zip(fault.start, fault.sizes, strict=False)]
    return simulation.with_values(fault.targets(*(numbers or (np.atleast_1d(fault.usual[0]) if fault.usual else ()))))


def misses(linkage, every=1, first=0):
    simulation, missed = Simulation(linkage, MOTION), []
    faults = [*of_motion(simulation, None, NAMES), *of_model(simulation)]
    for fault in faults[first::every]:
        results = exported(linkage, MOTION, NAMES, TIME[::2], digits=7, model=planted(fault, simulation))
        judgement = judge(linkage, results, MOTION)
        fits = [fit.fault.name for finding in judgement.explanation.findings for fit in finding.every]
        if fault.name not in fits and any(differs(verdict) for verdict in judgement.verdicts):
            missed.append((fault.name, fits[:3]))
    return missed


@pytest.mark.nightly
@pytest.mark.parametrize("number", range(len(SAMPLES)), ids=SAMPLES)
def test_a_fault_is_found_where_it_is_planted(number):
    """Every seventh of one linkage, each linkage beginning with another."""
    assert misses(case(SAMPLES[number]).mechanism.linkage, len(SAMPLES), number) == []


@cache
def judged(name):
    own = FOLDER / f"{name}.toml"
    usual = FOLDER / f"{'slider-crank' if name.startswith(('de_', 's_b')) else 'four-bar'}.toml"
    model = load(str(own if own.exists() else usual))
    return judge(model, read_results([FOLDER / f"{name}.csv"], model, encoding="cp1252" if name == "de_nm_lie" else ""))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.nightly if name in NIGHTLY else ()) for name in NAMED]
)
def test_an_ordinary_fault_is_named_with_its_cure(name):
    words, others, cure = NAMED[name]
    judgement = judged(name)
    (finding,) = judgement.explanation.findings
    assert words in finding.likeliest.words
    assert (len(finding.others), judgement.explanation.unexplained) == (others, ())
    assert judgement.proposals.keys() == cure.keys()
    for signal, correction in judgement.proposals.items():
        assert vars(correction) == pytest.approx(vars(cure[signal]), rel=1e-4, abs=1e-6)


def test_at_a_jump_the_side_that_was_judged_is_shown():
    verdict = next(v for v in judged("sw_forces").verdicts if v.name == "joint_force:O1:y")
    assert verdict.truth_there == pytest.approx(verdict.value_there, rel=1e-5)
    stroke = judged("s_bdc").verdicts[-1]
    assert (stroke.unit, stroke.unit_value) == ("mm", 1e-3)


def test_what_a_cause_leaves_is_a_share_of_the_peak_that_it_makes():
    """The file has five digits, whatever its unit."""
    (finding,) = judged("sw_unitlie").explanation.findings
    assert 1e-6 < finding.left < 1e-5
