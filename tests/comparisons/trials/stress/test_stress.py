"""Conditions become scenes; a cell is run by its key in any engine, as JSON and back; a map with its borders."""

import dataclasses
import math
import re
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description import changes
from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import reactions
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.invariants.checks import checks
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.runs import environment
from comparisons.trials.runs.run_engine import Failure, Lost
from comparisons.trials.runs.store import save_study, temporary_runs
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.stress import campaign
from comparisons.trials.stress import cells as stress
from comparisons.trials.stress.campaign import KIND, PRECISE, SMALLEST, borders, save
from comparisons.trials.stress.cells import (
    RELEASED,
    WRONG,
    Cell,
    Conditions,
    StressVerdict,
    axes,
    case,
    cell_at,
    cells,
    find_cell,
    lost,
    run_cell,
    scene,
    wrong_signals,
)
from engines.contract import Method, Outcome, Run, Signal
from engines.mechanics.joints import scene_size
from engines.mechanics.start_check import start_misfit
from engines.scene import Channel
from tests.comparisons.scripted import Scripted
from tests.comparisons.true_motions import EVERYTHING, alarms, cell, cut, judgement, true_history, with_signal
from tests.made_up import made_up_cell, made_up_stress

EVERY = [(axis, row) for axis in axes().values() for row in axis.rows]
STRETCH = 1e4  # times the easy value: beyond it a released motion is only slow to integrate


@pytest.mark.parametrize(
    ("axis", "row"),
    [pytest.param(*one, marks=() if one in EVERY[::7] else pytest.mark.nightly) for one in EVERY],
    ids=lambda one: getattr(one, "name", None) or one.label,
)
def test_every_row_is_a_scene_that_fits_its_joints_at_both_ends_and_at_its_easy_value(axis, row):
    values = axis.chosen_values(row, quick=False)
    if row.motion == RELEASED:
        values = tuple(value for value in values if value <= STRETCH)[:3]
    for value in {values[0], values[-1], axis.good}:
        conditions = axis.conditions(row.label, value)
        given = scene(conditions, case(conditions))
        misfit = start_misfit(given)
        assert (misfit is None) or (conditions.disturbed and value > 1e-7), (value, misfit)
        assert all(body.mass > 0.0 for body in given.bodies)


@pytest.mark.parametrize("axis", axes().values(), ids=lambda axis: axis.name)
def test_an_axis_varies_a_field_over_values_that_hold_its_easy_one(axis):
    assert axis.vary in {field.name for field in fields(Conditions)}
    assert axis.good in axis.values
    assert len(set(axis.values)) == len(axis.values)
    assert set(axis.quick) <= set(axis.values)
    assert axis.settings or axis.methods
    assert sum(row.quick for row in axis.rows) >= 1
    assert len({row.label for row in axis.rows}) == len(axis.rows)
    assert all("/" not in row.label for row in axis.rows)  # it separates the words of a cell's name
    for row in axis.rows:
        assert getattr(axis.conditions(row.label, 0.125), axis.vary) == 0.125


JUKI = Conditions("juki-mf7923d")
POWERS = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)
LOADED = ["tests/linkages/spring-and-damper.toml", "tests/linkages/force-over-angle.toml", *catalogue()]


@settings(max_examples=10)
@given(name=st.sampled_from(LOADED), length=POWERS, mass=POWERS, time=POWERS)
def test_the_closed_form_does_not_notice_units(name, length, mass, time):
    """Torque has the unit m l² t⁻², joint forces m l t⁻²; in these all is the same to rounding."""
    plain, scaled = Mechanism(load(name)), Mechanism(changes.scaled(load(name), length=length, mass=mass, time=time))
    angle = np.linspace(0.3, 9.0, 25)
    speed, acceleration = 70.0, 900.0
    found, there = plain.sweep(angle), scaled.sweep(angle)
    torque = reduced.drive_torque(found, speed, acceleration)
    moved = reduced.drive_torque(there, speed / time, acceleration / time**2) * time**2 / (mass * length**2)
    assert np.max(np.abs(torque - moved)) < 1e-10 * np.max(np.abs(torque))
    forces = reactions(found, speed, acceleration).forces
    others = reactions(there, speed / time, acceleration / time**2).forces
    peak = max(np.max(np.abs(force)) for force in forces.values())
    for joint, force in forces.items():
        assert np.max(np.abs(force - others[joint] * time**2 / (mass * length))) < 1e-10 * peak


@pytest.mark.parametrize("what", ["position", "velocity"])
@pytest.mark.parametrize("size", [1e-9, 1e-3])
def test_a_disturbed_start_is_off_by_so_much_and_no_more(what, size):
    conditions = replace(JUKI, motion="constant-speed", disturbed=what, disturbance=size)
    true = case(conditions)
    given, fits = scene(conditions, true), true.scene(frozenset(Channel))
    scale = scene_size(fits) * (conditions.rate if what == "velocity" else 1.0)
    for body, other in zip(given.bodies, fits.bodies, strict=True):
        off = np.hypot(*(np.array(getattr(body, what)) - getattr(other, what)))
        assert off == pytest.approx(size * scale, rel=1e-6)
    assert (start_misfit(given) is None) is (size < 1e-6)


def damped(factor, turns=0.5):
    return Conditions(
        "sprung-crank-rocker", motion="released", start_angle=60.0, spinning=False, turns=turns, torque=0.2,
        load="dampers", load_factor=factor,
    )  # fmt: skip


def test_a_crank_that_is_held_back_for_ever_is_refused_in_a_sentence():
    assert case(damped(1.0)).motion.duration == pytest.approx(0.03)
    with pytest.raises(LinkproofError, match=r"time constant Jeq/b or less, got \de\+\d+; damp less"):
        case(damped(1e8))


METHODS = Method("defaults", "as it comes"), Method("centred", "careful", effort=7.0, effort_unit="iterations")


def perfect(change=lambda history, _: history):
    """An engine that reads the truth off the closed form; ``change(history, scene)`` makes another of it."""

    def act(scene, *_):
        one = case(axes()["mass"].conditions("four-bar, coupler", 1.0))
        heavy = {body.name: body for body in scene.bodies}
        links = {
            name: replace(link, mass=heavy[name].mass, inertia=heavy[name].inertia)
            for name, link in one.mechanism.linkage.links.items()
        }
        true = true_history(one, 601, mechanism=Mechanism(replace(one.mechanism.linkage, links=links)))
        return Run(Outcome.FINISHED, history=change(true, scene), seconds=0.25, steps=12)

    return Scripted(act, name="perfect", methods=METHODS)


def liar():
    """The same, but for velocities, beyond a mass that is too much for it; it never says so."""

    def change(history, scene):
        is_heavy = max(body.mass for body in scene.bodies) > 500.0 * 0.03
        return with_signal(history, "velocity", lambda values, _: (0.9 if is_heavy else 1.0) * values)

    return perfect(change)


@pytest.fixture
def with_engine(monkeypatch):
    def install(one):
        for module in (stress, campaign):
            if hasattr(module, "engine"):
                monkeypatch.setattr(module, "engine", lambda name: one)
        monkeypatch.setattr(environment, "adapters", lambda names: [one for _ in names])
        return one

    return install


COUPLER = cell_at(axes()["mass"], "four-bar, coupler", 100.0, "perfect", "tuned")


@pytest.mark.parametrize(
    ("key", "error", "words"),
    [
        ("mass/four-bar, coupler/100", LinkproofError, "AXIS/ROW/VALUE/ENGINE/USAGE"),
        ("mas/four-bar, coupler/100/perfect/tuned", UnknownNameError, "unknown axis 'mas'"),
        ("mass/four-bar, rod/100/perfect/tuned", UnknownNameError, "row of axis 'mass'"),
        ("mass/four-bar, coupler/100/perfect/tune", UnknownNameError, "usage of 'perfect'"),
        ("mass/four-bar, coupler/heavy/perfect/tuned", LinkproofError, "expected a number"),
    ],
)
def test_a_cell_that_does_not_exist_is_refused(with_engine, key, error, words):
    with_engine(perfect())
    with pytest.raises(error, match=words):
        find_cell(key)


def test_the_truth_is_within_limit_at_any_mass(with_engine):
    engine = with_engine(perfect())
    found = run_cell(COUPLER)
    assert found.verdict is StressVerdict.WITHIN
    assert (found.seconds, found.steps) == (0.25, 12)
    assert found.differing == {"linkage": found.mechanism, "link": "coupler", "mass_factor": 100.0}
    assert engine.asked == ["tuned"]


@pytest.mark.parametrize("engine", [perfect(), liar()])
def test_the_store_holds_all_of_a_cell(with_engine, engine):
    with_engine(engine)
    found, runs = run_cell(dataclasses.replace(COUPLER, value=1e4)), temporary_runs()
    runs.add(found.key, *found.written())
    assert Cell.from_row(*runs.read(found.key)) == found
    assert found.data["command"] == "linkproof stress 'mass/four-bar, coupler/10000/perfect/tuned'"
    for failure in Failure:
        found = lost(Lost(failure, "as tested"), COUPLER).data
        assert found["verdict"] == failure.value


# -- maps --------------------------------------------------------------------------------------------------------------


def stress_test(quick=False, **changes):
    axis = dataclasses.replace(axes()["mass"], rows=(axes()["mass"].row("four-bar, coupler"),))
    chosen = cells((axis,), ("perfect",), ("tuned",), quick=quick)
    return campaign.stress(chosen, quick=quick, pool=LocalPool(0), **changes)


def test_a_wrong_motion_is_caught_in_every_cell_and_its_border_is_bisected(with_engine):
    with_engine(liar())
    heard = []
    found = stress_test(announce=lambda *words: heard.append(words))
    verdicts = {one.value: one.verdict for one in found.cells}
    assert {value: verdicts[value] for value in axes()["mass"].values} == {
        value: StressVerdict.CAUGHT if value > 500.0 else StressVerdict.WITHIN for value in axes()["mass"].values
    }
    (border,) = found.borders
    assert border.inside.value <= 500.0 < border.outside.value <= 1.1 * border.inside.value
    assert found.of(StressVerdict.MISSED) == ()
    told = found.as_dict
    assert told["summary"]["perfect"]["caught"] == sum(one.verdict is StressVerdict.CAUGHT for one in found.cells)
    assert told["borders"][0]["inside_command"].startswith("linkproof stress 'mass/four-bar, coupler/")
    assert heard[-1][1] == heard[-1][2] == len(found.cells)


def test_where_the_closed_form_has_no_motion_no_engine_is_tried(with_engine, monkeypatch):
    engine = with_engine(perfect())

    def nowhere(_):
        raise LinkproofError("it stands in a dead position")

    monkeypatch.setattr(stress, "case", nowhere)
    found = run_cell(COUPLER)
    assert (found.verdict, engine.asked) == (StressVerdict.UNSUPPORTED, [])
    assert found.reason == "the closed form has no motion to hold an engine to: it stands in a dead position"


# The faults of a motion, and the verdict that follows.


@cache
def usual(name="juki-mf7923d", regime="run-up-quintic"):
    return Case(Mechanism(load(name)), crank_motion(regime))


def found(one, history):
    return wrong_signals(one, ObservedMotion(one.scene(EVERYTHING), history))


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize("own", [False, True])
def test_a_joint_force_that_is_off_is_wrong(share, own):
    linkage = load("slotted-takeup")
    one = case_of_file_regime(Mechanism(linkage), linkage.regimes[0]) if own else usual("slotted-takeup")
    history = true_history(one, 3001 if own else 301)
    joint, force = next(iter(history.joint_force.items()))
    values = force.values.copy()
    values[150] += share * WRONG * np.max(np.hypot(*values.T)) * np.array([0.6, 0.8])
    changed = replace(history, joint_force={**history.joint_force, joint: Signal(force.time, values)})
    assert [words.partition(" off by")[0] for words in found(one, changed)] == [f"force in joint '{joint}'"] * (
        share > 1.0
    )


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize(("name", "words"), [("position", "place"), ("velocity", "velocity")])
def test_one_body_off_is_named_beyond_the_limit_alone(name, words, share):
    one = usual()
    history = true_history(one, 301)
    names = [body.name for body in one.scene(EVERYTHING).bodies]

    def change(values, _):
        arm = 0.0416  # the coupler's to its farther pin, m
        peak = arm if name == "position" else np.max(np.hypot(*values[:, :, :2].T))
        values[150, names.index("needle_bar"), 1] += share * WRONG * peak
        return values

    said = found(one, with_signal(history, name, change))
    assert bool(said) is (share > 1.0)
    assert all(sentence.startswith(f"{words} of body 'needle_bar' off by 0.02 of the") for sentence in said)


def test_torque_at_an_acceleration_jump_is_not_judged():
    one = usual(regime="run-up")
    history = true_history(one, 701)
    at = int(np.argmin(np.abs(history.torque.time - 0.6)))

    def spike(values, _):
        values[at - 1 : at + 2] *= 10.0
        return values

    assert found(one, with_signal(history, "torque", spike)) == []


def test_what_is_missing_is_wrong_too():
    one = usual(regime="constant-speed")
    history = true_history(one, 301)
    assert any("no samples" in words for words in found(one, cut(history, lambda t: np.abs(t - 0.35) > 0.05)))
    assert found(one, cut(history, lambda t: (t > 0.0) & (t < t[-1]))) == []


def test_the_angle_of_a_mass_at_a_pin_means_nothing():
    one = usual("slotted-takeup")
    names = [body.name for body in one.scene(EVERYTHING).bodies]
    history = true_history(one, 301)

    def turned(values, _):
        values[:, names.index("slot_slider"), 2] = 17.0
        return values

    assert found(one, with_signal(history, "position", turned)) == []


def scaled(name, factor):
    return with_signal(true_history(usual(), 601), name, lambda values, _: factor * values)


# A signal times a factor: the setting whose limits hold, the verdict, and how its reason begins.
FLAGGED = r"drive torque off by 0\.5 of the peak.*Flagged: .*the torque is 0\.33 of its peak away from what"
SCALED = [
    ("torque", 1.5, "tuned", StressVerdict.CAUGHT, FLAGGED),
    ("torque", 1.001, "tuned", StressVerdict.OVER, r"(Mkr|Peq) off by 0\.001 of its peak"),
    ("torque", 1.00003, "tuned", StressVerdict.WITHIN, "$"),
    ("torque", 1.00003, "best", StressVerdict.OVER, ""),
    ("velocity", 1e200, "tuned", StressVerdict.CAUGHT, ""),
]


@pytest.mark.parametrize(("signal", "factor", "setting", "verdict", "reason"), SCALED)
def test_a_scaled_signal_has_its_verdict_with_the_reason(signal, factor, setting, verdict, reason):
    found = judgement(usual(), scaled(signal, factor), setting)
    assert found.verdict is verdict
    assert re.match(reason, found.reason, re.DOTALL)
    assert ("energy_balance" in alarms(found)) is (verdict is StressVerdict.CAUGHT)
    assert np.isfinite([found.errors[0].error_max, found.invariants[0].error_max]).all()


def test_what_no_invariant_sees_is_missed(monkeypatch):
    true_checks = checks

    def blind(*arguments):
        return tuple(check._replace(outcome="passed", error_max=0.0) for check in true_checks(*arguments))

    monkeypatch.setattr("comparisons.trials.campaign.campaign.checks", blind)
    found = judgement(usual(), scaled("torque", 1.5))
    assert found.verdict is StressVerdict.MISSED
    assert found.reason.endswith("No check flagged it")


def test_an_invariant_that_fails_the_truth_is_an_alarm(monkeypatch):
    true_checks, failed = checks, {"outcome": "over-limit", "error_max": 1.0}

    def nervous(*arguments):
        return tuple(
            check._replace(**failed) if check.quantity == "energy_balance" else check
            for check in true_checks(*arguments)
        )

    monkeypatch.setattr("comparisons.trials.campaign.campaign.checks", nervous)
    found = judgement(usual(), true_history(usual(), 601))
    assert (found.verdict, alarms(found)) == (StressVerdict.ALARM, ("energy_balance",))
    assert found.reason.startswith("right, yet 1 of the energy scale has no source")


def test_a_joint_over_its_limit_is_a_deviation_and_no_false_alarm():
    """Open by 1.3e-4 of the shortest link, and every quantity within its limit."""
    names = [body.name for body in usual().scene(EVERYTHING).bodies]

    def opened(values, _):
        values[:, names.index("coupler"), 0] += 2e-6
        return values

    found = judgement(usual(), with_signal(true_history(usual(), 601), "position", opened))
    assert (found.verdict, alarms(found)) == (StressVerdict.OVER, ("joint_gap",))
    assert found.reason.startswith("joint ")


def test_a_reversal_has_the_limits_of_similar_motions():
    turned = case(Conditions("juki-mf7923d", motion="reversal", hold_turns=0.5))
    assert judgement(turned, true_history(turned, 901), "best").verdict is StressVerdict.WITHIN


# Borders are found to the precision asked for by as few runs as halving takes; a stress test is read back as saved.


MASS = [10.0**power for power in range(-6, 7)]

STRESS = made_up_stress()
PLACE = {"row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}
CELL = made_up_cell(StressVerdict.OVER, axis="mass", value=1.0, **PLACE).data


def result(value, verdict, axis="mass"):
    return cell(value, axis=axis, engine="e", verdict=verdict)


def world(*, above=math.inf, below=0.0, axis="mass"):
    """Cells at values of an engine that is right between two values of the axis."""

    def make(values):
        verdicts = [StressVerdict.WITHIN if below < value < above else StressVerdict.CAUGHT for value in values]
        return [result(value, verdict, axis) for value, verdict in zip(values, verdicts, strict=True)]

    return make


def narrowed(make, cells):
    """The borders among cells, narrowed down, and how many cells that took."""
    asked = 0
    while wide := [border for border in borders(cells) if border.is_wide(PRECISE)]:
        asked += len(wide)
        cells = [*cells, *make([border.middle for border in wide])]
    return borders(cells), asked


@settings(max_examples=20)
@given(above=st.floats(1.5, 9e5), below=st.floats(1.1e-6, 0.7))
def test_both_borders_are_bracketed_to_a_tenth(above, below):
    make = world(above=above, below=below)
    assert len(borders(make(MASS))) == 2
    found, asked = narrowed(make, make(MASS))
    high, low = sorted(found, key=lambda one: -one.middle)
    assert high.inside.value < above <= high.outside.value <= PRECISE * high.inside.value
    assert low.outside.value <= below < low.inside.value <= PRECISE * low.outside.value
    assert asked <= 2 * math.ceil(math.log2(math.log(10.0) / math.log(PRECISE)))


@pytest.mark.parametrize("above", [math.inf, 0.5])
def test_where_nothing_fails_or_the_easiest_value_does_there_is_no_border(above):
    assert borders(world(above=above)(MASS)) == []


def test_only_the_first_border_from_the_easy_value_counts():
    verdicts = dict.fromkeys(MASS, StressVerdict.WITHIN) | {1e2: StressVerdict.OVER, 1e4: StressVerdict.DIVERGED}
    (border,) = borders([result(value, verdict) for value, verdict in verdicts.items()])
    assert border.ends == (1e1, 1e2)
    assert border.document["verdict"] == "over limit"
    assert border.document["value"] == pytest.approx(math.sqrt(1e3))
    assert border.document["outside_command"] == "linkproof stress 'mass/row/100/e/tuned'"


def test_a_border_next_to_zero_is_not_followed_for_ever():
    make = world(below=1e-300, axis="change-point")
    (border,), asked = narrowed(make, make([1e-1, 1e-6, 1e-12, 0.0]))
    assert border.outside.value == 0.0
    assert border.inside.value <= SMALLEST
    assert asked < 10


@pytest.mark.parametrize("verdict", [StressVerdict.TIMED_OUT, StressVerdict.CRASHED])
def test_a_border_that_the_machine_draws_is_not_narrowed_down(verdict):
    (border,) = borders([result(1.0, StressVerdict.WITHIN), result(1e3, verdict)])
    assert not border.is_wide(PRECISE)


def test_what_is_saved_is_read_back(tmp_path):
    save(tmp_path, STRESS)
    found = campaign.load(tmp_path)
    assert found.results == STRESS.results
    assert found.borders == STRESS.borders


@pytest.mark.parametrize(
    ("cells", "changes", "words"),
    [
        ([], {}, "it has no cell"),
        ([CELL], {"quick": "?"}, "quick: Input should be a valid boolean"),
        ([{**CELL, "axis": "gone"}], {}, "'gone'"),
        ([{**CELL, "value": "x"}], {}, "value: Input should be a valid number"),
        ([{name: one for name, one in CELL.items() if name != "value"}], {}, "value: Field required"),
    ],
)
def test_what_is_of_another_form_is_refused_with_the_cure(tmp_path, cells, changes, words):
    rows = ((f"{number}", row, {}) for number, row in enumerate(cells))
    save_study(tmp_path, KIND, {**STRESS.document, **changes}, rows)
    with pytest.raises(LinkproofError, match=rf"{words}.*run stress with --out again"):
        campaign.load(tmp_path)
