"""Exported curves judged: planted faults named, clean ones passed, corrections said and never hidden."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion, table_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import names as signal_names
from comparisons.filejudge.columns import Correction, SignalTimes
from comparisons.filejudge.judge import judge
from comparisons.filejudge.reading import read_results
from comparisons.filejudge.simulation import Simulation
from comparisons.motion.case import case_of_file_regime
from comparisons.trials.judging.records import Verdict
from tests.comparisons.filejudge.layouts import exported, with_link

JUKI = load("juki-mf7923d")
QUINTIC = crank_motion("run-up-quintic")
TIME = np.linspace(0.0, 0.7, 176)


def test_errors_worst_places_and_left_out_samples_are_those_of_the_columns():
    linear = crank_motion("run-up")

    def change(values, time):
        wrong = values["Mkr"].copy()
        wrong[[0, 50]] += np.array([0.4, 0.5]) * np.max(np.abs(wrong))  # the first one at a jump
        return {**values, "Mkr": wrong}

    names = ("Mkr", "S")
    judgement = judge(JUKI, exported(JUKI, linear, names, TIME, change=change), linear)
    torque, stroke = judgement.verdicts
    assert (torque.outcome, stroke.outcome) == (Verdict.OVER_LIMIT, Verdict.PASSED)
    assert torque.error_max == pytest.approx(0.5, rel=0.02)
    assert torque.error_rms == pytest.approx(torque.error_max / np.sqrt(len(TIME) - 2), rel=1e-3)  # of what is counted
    assert torque.worst_time == pytest.approx(TIME[50])
    assert torque.worst_angle == pytest.approx(float(linear.angle(TIME[50])))
    assert torque.value_there - torque.truth_there == pytest.approx(0.5 * torque.scale, rel=0.02)
    assert torque.left_out == 2  # one at the start of the ramp, one at its end
    assert stroke.left_out == 0


def test_at_a_jump_of_the_acceleration_a_torque_may_be_off_by_the_jump_and_no_more():
    linear, time, at = crank_motion("run-up"), np.linspace(0.0, 0.7, 351), 300
    sides = [np.array([np.nextafter(0.6, 0.0)]), np.array([0.6])]
    before, after = (Simulation(JUKI, linear).predict([SignalTimes("Mkr", side)])[0][0] for side in sides)
    outcomes, worst = {}, 0.0
    for factor in (-1.0, 0.5, 3.0):

        def change(values, _, factor=factor):
            torque = values["Mkr"].copy()
            torque[at] = after + factor * (before - after)
            return {**values, "Mkr": torque}

        torque = judge(JUKI, exported(JUKI, linear, ("Mkr", "S"), time, change=change), linear).verdicts[0]
        outcomes[factor], worst = torque.outcome, torque.error_max * torque.scale
    passed, over = Verdict.PASSED, Verdict.OVER_LIMIT
    assert outcomes == {-1.0: passed, 0.5: passed, 3.0: over}
    assert worst == pytest.approx(2.0 * abs(before - after), rel=1e-3)


def test_what_the_rounding_of_the_crank_leaves_open_has_not_passed():
    time = np.linspace(0.0, 1.0, 401)
    wandering = table_motion("wandering", time[::25], 3.0 * time[::25] + 0.2 * np.sin(40.0 * time[::25]))
    judgement = judge(JUKI, exported(JUKI, wandering, ("phi", "Mkr", "S"), time, digits=3))
    outcomes = {verdict.name: verdict.outcome for verdict in judgement.verdicts}
    assert outcomes == {"Mkr": Verdict.UNDEFINED, "S": Verdict.PASSED}
    assert not judgement.passed
    by_speed = judge(JUKI, exported(JUKI, wandering, ("phi", "omega", "S"), time, digits=3))  # which leaves less open
    assert by_speed.passed
    assert by_speed.motion_source == "column 'omega'"


@pytest.mark.parametrize(
    ("path", "regime", "body"),
    [
        ("comparisons/trials/conformance/linkages/driven-slider.toml", "stroke", "rod"),
        pytest.param("tests/linkages/parallelogram.toml", "", "coupler", marks=pytest.mark.nightly),
        pytest.param(
            "comparisons/trials/conformance/linkages/cylinder.toml", "raise", "boom", marks=pytest.mark.nightly
        ),
        pytest.param("andrews-squeezer", "squeezing", "K4", marks=pytest.mark.nightly),
    ],
)
def test_pushed_linkages_change_points_and_released_cranks_are_judged(path, regime, body):
    linkage = load(path)
    mechanism = Mechanism(linkage)
    case = next((case_of_file_regime(mechanism, own) for own in linkage.regimes if own.name == regime), None)
    motion = case.motion if case else crank_motion("constant-speed")
    time = np.linspace(0.0, motion.duration, 201)
    told = motion if regime == "squeezing" else None
    names = [name for name in signal_names(mechanism) if "force" not in name and "shaking" not in name]
    assert judge(linkage, exported(linkage, motion, names, time), told).passed
    heavier = with_link(linkage, body, mass=1.5 * linkage.links[body].mass)
    torque = ("phi", "Peq" if regime == "squeezing" else "Mkr", "Teq")
    wrong = exported(linkage, motion, torque, time, model=Simulation(heavier, motion))
    (finding,) = judge(linkage, wrong, told).explanation.findings
    assert f"{body}.mass" in {fit.fault.name for fit in finding.every}


def test_a_reaction_that_is_zero_has_the_natural_scale_of_forces():
    steady = crank_motion("constant-speed")
    name = "joint_force:needle_bar on ground:y"  # the guide is vertical: it takes no force along itself
    judgement = judge(
        JUKI,
        exported(JUKI, steady, (name, "joint_force:A:x"), TIME, change=lambda v, _: {**v, name: v[name] + 1e-5}),
        steady,
    )
    near_zero, other = judgement.verdicts
    assert near_zero.near_zero
    assert not other.near_zero
    assert near_zero.outcome is Verdict.PASSED


def test_a_fault_behind_a_sign_is_named_with_the_sign_said():
    heavier = replace(JUKI.links["coupler"], mass=1.4 * JUKI.links["coupler"].mass)
    other = replace(JUKI, links={**JUKI.links, "coupler": heavier})
    results = exported(other, QUINTIC, ("Mkr",), TIME, change=lambda v, _: {"Mkr": -v["Mkr"]})
    (finding,) = judge(JUKI, results, QUINTIC).explanation.findings
    assert finding.likeliest.fault.name == "coupler.mass"
    assert finding.likeliest.numbers[0] == pytest.approx(heavier.mass, rel=1e-3)
    assert finding.corrections == {"Mkr": Correction(sign=-1)}


def test_signals_over_the_crank_angle_need_a_speed_where_they_move():
    steady = crank_motion("constant-speed", speed=500.0 * RPM)
    results = exported(JUKI, steady, ("S", "Mkr"), TIME)
    over_angle = replace(
        results,
        signals=tuple(
            replace(s, axis="phi", time=steady.angle(s.time), time_rounding=0.0 * s.time) for s in results.signals
        ),
    )
    assert judge(JUKI, over_angle, steady).passed
    with pytest.raises(LinkproofError, match=r"Mkr over the crank angle: .* say it with --speed"):
        judge(JUKI, over_angle, steady, gives_speed=False)
    still = replace(over_angle, signals=over_angle.signals[:1])
    assert judge(JUKI, still, crank_motion("constant-speed"), gives_speed=False).passed


def test_an_obtuse_transmission_angle_is_the_acute_one():
    steady, name = crank_motion("constant-speed"), "transmission_angle:" + Mechanism(JUKI).structure.dyads[0].name

    def obtuse(values, _):
        return {name: np.where(np.arange(len(TIME)) % 3, np.pi - values[name], values[name])}

    judgement = judge(JUKI, exported(JUKI, steady, (name,), TIME, change=obtuse), steady)
    assert judgement.passed
    assert judgement.verdicts[0].error_max < 1e-5


def test_a_narrow_peak_between_few_samples_is_seen():
    time = np.linspace(0.0, 0.06, 11)  # 36° a sample: the torque's peaks lie between them
    steady = crank_motion("constant-speed", speed=1000 * RPM, ramp_time=0.06, hold_time=0.0)
    judgement = judge(JUKI, exported(JUKI, steady, ("Mkr",), time), steady)
    dense = judge(JUKI, exported(JUKI, steady, ("Mkr",), np.linspace(0.0, 0.06, 20_001)), steady)
    (verdict,), (every,) = judgement.verdicts, dense.verdicts
    lost = 1.0 - np.max(np.abs(verdict.truth)) / np.max(np.abs(every.truth))
    assert dict(judgement.missed)["Mkr"] == pytest.approx(lost, rel=1e-3)


def test_a_short_curve_that_no_cause_explains_is_over_its_limit():
    steady = crank_motion("constant-speed")
    wrong = exported(JUKI, steady, ("Mkr",), TIME[:4], change=lambda v, t: {"Mkr": v["Mkr"] + np.sin(1e4 * t) + 1.0})
    assert judge(JUKI, wrong, steady).verdicts[0].outcome is Verdict.OVER_LIMIT


@pytest.mark.parametrize(("columns", "cause"), [(("Mkr",), "delay:Mkr"), (("Mkr", "S"), "time shift")])
def test_late_columns_may_have_anything_where_the_run_has_no_instants(columns, cause):
    motion, late = crank_motion("run-up"), -0.002
    within = np.clip(TIME - late, 0.0, TIME[-1])  # a tool that repeats the first or the last value there
    curves = Simulation(JUKI, motion).predict([SignalTimes(name, within) for name in columns])
    shifted = dict(zip(columns, curves, strict=True))
    results = exported(JUKI, motion, ("phi", "Mkr", "S"), TIME, change=lambda v, _: {**v, **shifted})
    (finding,) = judge(JUKI, results).explanation.findings
    assert (finding.likeliest.fault.name, finding.fully) == (cause, True)
    assert finding.likeliest.numbers == pytest.approx([-late], abs=1e-6)


STRAY = np.isin(np.arange(len(TIME)), (50, 120))
# By the one cause that is named: columns, and what is changed of them.
CHANGED = {
    "Mkr has the other sign in 2 single samples": (["Mkr"], lambda v: {"Mkr": np.where(STRAY, -1.0, 1.0) * v["Mkr"]}),
    "Mkr is off in 2 single samples": (["Mkr"], lambda v: {"Mkr": np.where(STRAY, 1.5, 1.0) * v["Mkr"]}),
    "is Peq:Mkr": (["Mkr", "Peq"], lambda v: {"Mkr": v["Peq"]}),
    "sign of rotary": (
        ["Mkr", "S", "link:crank:angle"], lambda v: {name: -v[name] for name in ("Mkr", "link:crank:angle")}
    ),
    "link:coupler:angle is 57.2958 times the closed form's: deg read as rad": (
        ["link:coupler:angle", "S"], lambda v: {"link:coupler:angle": np.degrees(v["link:coupler:angle"])}
    ),
}  # fmt: skip


@pytest.mark.parametrize("cause", CHANGED)
def test_what_is_changed_of_columns_is_one_cause(cause):
    motion, (columns, change) = crank_motion("run-up-quintic", start_angle=7.0), CHANGED[cause]
    results = exported(JUKI, motion, columns, TIME, change=lambda v, _: {**v, **change(v)})
    explanation = judge(JUKI, results, motion).explanation
    (finding,) = explanation.findings
    assert finding.likeliest.fault.name == cause or finding.likeliest.words.startswith(cause)
    assert (finding.fully, explanation.unexplained) == (True, ())


def test_a_mass_centre_measured_the_other_way_is_among_the_causes_that_fit_alike():
    linkage, steady = load("fork-takeup"), crank_motion("constant-speed")
    x, y = linkage.links["rocker"].centre
    turned = with_link(linkage, "rocker", centre=(-x, -y))  # as if its pin 'P3' were on the other side
    results = exported(linkage, steady, ("Mkr", "joint_force:P2:y"), TIME, model=Simulation(turned, steady))
    (finding,) = judge(linkage, results, steady).explanation.findings
    assert {fit.fault.name for fit in finding.every} == {"rocker.P3.x", "rocker.centre"}


def test_a_travel_is_no_angle_that_may_be_whole_turns_off():
    linkage = load("comparisons/trials/conformance/linkages/driven-slider.toml")
    (motion,) = (case_of_file_regime(Mechanism(linkage), own).motion for own in linkage.regimes if own.name == "stroke")
    time = np.linspace(0.0, motion.duration, 101)
    off = exported(linkage, motion, ("phi", "S"), time, change=lambda v, _: {**v, "phi": v["phi"] + 2.0 * np.pi})
    assert judge(linkage, off, motion).verdicts[0].outcome is Verdict.OVER_LIMIT


def test_noise_is_told_from_a_trend():
    steady, noise = crank_motion("constant-speed"), np.random.default_rng(0).normal(size=len(TIME))

    def noisy(values, _):
        return {"Mkr": values["Mkr"] + 0.005 * np.max(np.abs(values["Mkr"])) * noise, "S": 1.02 * values["S"] ** 1.1}

    judgement = judge(JUKI, exported(JUKI, steady, ("Mkr", "S"), TIME, change=noisy), steady)
    assert [verdict.is_noise for verdict in judgement.verdicts] == [True, False]
    assert "Mkr" in judgement.explanation.unexplained


PAIRS = {  # of independent columns, each with its own fault
    "sign:Mkr": lambda v: -v["Mkr"],
    "unit:v": lambda v: 1e3 * v["v"],
    "counted back:S": lambda v: np.max(v["S"]) - v["S"],
}


FIRST, *OTHERS = combinations(PAIRS, 2)


@pytest.mark.parametrize("pair", [FIRST, *(pytest.param(pair, marks=pytest.mark.nightly) for pair in OTHERS)])
def test_faults_of_two_columns_are_both_named(pair):
    steady = crank_motion("constant-speed")

    def change(values, _):
        return {**values, **{kind.partition(":")[2]: PAIRS[kind](values) for kind in pair}}

    judgement = judge(JUKI, exported(JUKI, steady, ("Mkr", "S", "v"), TIME, change=change), steady)
    assert {finding.likeliest.fault.name for finding in judgement.explanation.findings} == set(pair)


def test_an_inverse_dynamics_without_centrifugal_forces_is_told_so():
    """A curve of another program as it was published, ``foreign/inverse.toml`` says of which."""
    linkage, file = (Path(__file__).with_name("foreign") / f"inverse.{suffix}" for suffix in ("toml", "csv"))
    model = load(str(linkage))
    judgement = judge(model, read_results([file], model), crank_motion("constant-speed", speed=1.0))
    (finding,) = judgement.explanation.findings
    assert "centrifugal forces, a velocity-quadratic part that grows as ω²" in finding.likeliest.words
    assert (finding.fully, judgement.passed) == (True, False)
