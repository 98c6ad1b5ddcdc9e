"""What is judged of an engine's motion, and with which verdict."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import REGIMES, CrankMotion, Segment, crank_motion
from analytic.description.linkage import ThreadEye, ThreadGuide, ThreadPath
from analytic.description.loading import load
from analytic.description.schema import EyeReference
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.invariants.checks import INVARIANTS, checks
from comparisons.trials.judging import quantities
from comparisons.trials.judging.limits import (
    USER_REASON,
    Limit,
    LimitTable,
    judge,
    limit,
    read_limits,
    shipped_limits,
    with_rows,
)
from comparisons.trials.judging.quantities import (
    QUANTITIES,
    NoSampleError,
    all_quantities,
    chosen_quantities,
)
from comparisons.trials.judging.records import Error, Verdict, run_of
from comparisons.trials.observed_motion import ObservedMotion
from engines.contract import Origin, Setting, Signal
from tests.comparisons.true_motions import perfect_motion

GIVEN = {"Mkr", "Peq"}  # by the drive of a released crank, not results


def test_the_table_is_complete():
    for quantity in (*QUANTITIES, *INVARIANTS, "joint_force:A"):
        for setting, regime in itertools.product(Setting, [*REGIMES, "a-regime-of-its-own"]):
            if quantity in GIVEN and regime not in REGIMES:
                continue
            row = limit(quantity, setting, regime)
            least_strict = 0.06 if setting is Setting.NAIVE else 0.02  # no looser than what the sources claim
            assert 0.0 < row.value <= least_strict, (quantity, setting, regime)
            assert len(row.reason.split()) > 4, (quantity, setting, regime)


def test_rows_of_a_user_go_before_the_table(tmp_path):
    path = tmp_path / "limits.toml"
    names = 'quantities = ["Mkr"]\nmechanisms = ["press"]\nregimes = ["own"]\nengines = ["mujoco"]'
    path.write_text(f"[[limit]]\n{names}\nvalue = 0.5\n")
    table = read_limits(path)
    own = table.limit("Mkr", "tuned", "a-regime-of-its-own", "press", "mujoco")
    assert (own.value, own.reason) == (0.5, USER_REASON)
    others = "Jeq free press mujoco", "Mkr run-up press mujoco", "Mkr free other mujoco", "Mkr free press drake"
    for quantity, regime, *names in map(str.split, others):
        assert table.limit(quantity, "tuned", regime, *names) == limit(quantity, "tuned", regime)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[limit", "limits.toml:1: not valid TOML"),
        ("", "limit is missing: expected tables [[limit]]"),
        ("limits = 3", "limits.toml:1: limits: unknown key 'limits': did you mean 'limit'"),
        ("limit = [3]", "limit #1: expected tables [[limit]]"),
        ('[[limit]]\nquantities = ["Mkr"]', "limit #1.value is missing: expected a positive share"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = nan', "limits.toml:3: limit #1.value"),
        ('[[limit]]\nquantities = "Mkr"\nvalue = 1', "limit #1.quantities: expected a list of quantities"),
        (
            '[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nsettings = ["tune"]',
            "unknown setting of .*limit 1 'tune': .*tuned",
        ),
        (
            '[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nengines = ["mujoko"]',
            "unknown engine of .*1 'mujoko': .*mujoco",
        ),
        ('[[limit]]\nquantities = ["Mrk"]\nvalue = 1', "unknown quantity of .*limit 1 'Mrk': .*Mkr"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nreasons = ""', "limit #1.reasons: unknown key 'reasons'"),
    ],
)
def test_a_wrong_table_is_refused_in_one_sentence(tmp_path, text, words):
    (tmp_path / "limits.toml").write_text(text)
    with pytest.raises(LinkproofError, match=words.replace("[[limit]]", r"\[\[limit\]\]")):
        read_limits(tmp_path / "limits.toml")


RECORD = Error(
    mechanism="m", variant="v", regime="r", conditions="c", engine="e", setting="tuned",
    quantity="Mkr", unit="N m", error_max=1.23456e-5, limit=1e-4, peak=1.0,
)  # fmt: skip

JUDGED = Error("m", "v", "run-up", "c", "e", "tuned", quantity="Mkr", error_max=1e-5)
LIMIT = shipped_limits().limit("Mkr", "tuned", "run-up").value


def deviation(case, quantity, motion):
    """The error of a quantity of a motion."""
    return quantities.deviation(case, quantity, motion, JUDGED)[0]


def _loose(value: float) -> LimitTable:
    return with_rows([Limit(quantities=["Mkr"], value=value)], "limits.toml")


@pytest.mark.parametrize(
    ("change", "outcome", "words"),
    [
        ({}, Verdict.PASSED, ""),
        ({"error_max": 1.01 * LIMIT}, Verdict.OVER_LIMIT, "is over its limit"),
        ({"error_max": float("nan")}, Verdict.OVER_LIMIT, "is over its limit"),
        ({"error_at_jumps": 1.01 * LIMIT}, Verdict.OVER_LIMIT, "at an acceleration jump"),
        ({"origin": Origin.COMPUTED}, Verdict.COMPUTED, "computed by the adapter"),
        ({"outcome": Verdict.DIVERGED, "error_max": None, "detail": "why"}, Verdict.DIVERGED, "why"),
        ({"outcome": Verdict.UNDEFINED, "detail": "why"}, Verdict.UNDEFINED, "why"),
    ],
)
def test_a_record_is_judged_by_its_limit(change, outcome, words):
    found = judge(JUDGED._replace(**change))
    assert found.outcome == outcome
    assert words in found.detail
    assert judge(found).outcome == outcome


def test_another_standard_gives_another_verdict_of_the_same_error():
    failed = judge(JUDGED._replace(error_max=2.0 * LIMIT))
    passed = _loose(3.0 * LIMIT).judge(failed)
    assert (passed.outcome, passed.detail, passed.limit) == (Verdict.PASSED, "", pytest.approx(3.0 * LIMIT))
    assert shipped_limits().judge(passed) == failed


@pytest.fixture(scope="module", params=["juki-mf7923d", "rimoldi-164"])
def case(request):
    return Case(Mechanism(load(request.param)), crank_motion("run-up-quintic"))


@pytest.fixture(scope="module")
def motion(case):
    return perfect_motion(case.mechanism, case.motion)


def test_a_perfect_motion_has_no_deviation(case, motion):
    errors = {name: deviation(case, q, motion).error_max for name, q in all_quantities(case).items()}
    assert {"Jeq", "Teq", "Mkr", "Peq", "S", "v", "a"} <= set(errors)
    assert {f"joint_force:{joint}" for joint in case.joint_names()} <= set(errors)
    assert max(errors.values()) < 1e-12


def test_velocities_on_a_clock_of_their_own_are_compared_at_their_own_times(case):
    shifted = perfect_motion(case.mechanism, case.motion, shift=0.5)
    for name in ("Jeq", "Teq", "v"):
        assert deviation(case, QUANTITIES[name], shifted).error_max < 1e-12


def test_an_unknown_quantity_names_the_nearest(case):
    with pytest.raises(UnknownNameError, match="did you mean 'Jeq'"):
        chosen_quantities(case, ["jeq"])


def test_what_the_drive_gives_is_no_result(case):
    with pytest.raises(LinkproofError, match="phi is given, not a result"):
        chosen_quantities(case, ["phi"])


@pytest.mark.parametrize("samples", [141, 1401])
def test_zeros_come_from_the_engines_own_motion_where_its_samples_show_them(samples):
    """An output moved as a whole is the same to it; read between few samples it would not be."""
    case = Case(Mechanism(load("slotted-takeup")), crank_motion("run-up-quintic"))
    motion = perfect_motion(case.mechanism, case.motion, samples)
    own = motion.last_turn is not None
    assert own == (samples == 1401)
    for name in ("S", "thread_feed"):
        quantity = QUANTITIES[name]
        assert bool(quantity.shared(case, motion)) != own
        assert deviation(case, quantity, motion).error_max < 1e-11
    moved = replace(motion.history.position, values=motion.history.position.values + np.array([0.0, 1e-3, 0.0]))
    shifted = ObservedMotion(motion.scene, replace(motion.history, position=moved))
    error = deviation(case, QUANTITIES["S"], shifted).error_max
    assert (error < 1e-11) == own


@pytest.fixture(scope="module")
def abrupt_case():
    return Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up"))


@pytest.fixture(scope="module")
def abrupt_motion(abrupt_case):
    return perfect_motion(abrupt_case.mechanism, abrupt_case.motion)


def _with_torque(motion, torque):
    history = replace(motion.history, torque=Signal(motion.history.torque.time, torque))
    return ObservedMotion(motion.scene, history)


def test_a_thread_whose_feed_takes_a_full_turn_is_not_judged_on_a_swing():
    """The eye's lowest place is told by a full turn, which Watt's six-bar cannot make."""
    watt = load("watt-six-bar")
    guide = ThreadGuide("N", (0.0, 0.0, 0.0))
    thread = ThreadPath((guide, ThreadEye("E")), 0.0, "lengthening", EyeReference(eye="E", extreme="lowest"))
    abrupt_case = Case(Mechanism(replace(watt, thread=thread)), watt.regimes[0].motion)
    with pytest.raises(NoSampleError, match="which it cannot make; give a crank angle as the reference"):
        deviation(abrupt_case, QUANTITIES["thread_feed"], perfect_motion(abrupt_case.mechanism, abrupt_case.motion))


def test_a_known_error_is_found_where_it_is(abrupt_case, abrupt_motion):
    torque = abrupt_motion.history.torque.values.copy()
    torque[700] += 1e-3
    found = deviation(abrupt_case, QUANTITIES["Mkr"], _with_torque(abrupt_motion, torque))
    assert found.error_max == pytest.approx(1e-3 / found.peak)
    assert found.worst_time == abrupt_motion.history.torque.time[700]
    assert found.error_rms == pytest.approx(1e-3 / found.peak / np.sqrt(found.samples))


def _at_jump(motion, change, jump=0.6):
    torque = motion.history.torque.values.copy()
    kink = int(np.argmin(np.abs(motion.history.torque.time - jump)))
    torque[kink] = change(torque, kink)
    return _with_torque(motion, torque)


def test_samples_at_an_acceleration_jump_may_lie_between_its_two_values(abrupt_case, abrupt_motion):
    between = _at_jump(abrupt_motion, lambda torque, kink: 0.5 * (torque[kink - 1] + torque[kink + 1]))
    found = deviation(abrupt_case, QUANTITIES["Mkr"], between)
    assert found.error_max < 1e-12
    assert found.error_at_jumps < 1e-12
    assert found.left_out == 3 + 5  # a millisecond on either side, the hundredth of the shortest piece


def test_the_window_at_a_jump_is_the_regimes_and_not_the_engines(abrupt_case):
    """A sample outside it is judged like any other, however long the engine's steps are."""
    coarse = perfect_motion(abrupt_case.mechanism, abrupt_case.motion, 141)  # steps of 5 ms
    found = deviation(abrupt_case, QUANTITIES["Mkr"], _at_jump(coarse, lambda torque, kink: torque[kink], 0.6))
    assert found.left_out == 2
    late = deviation(abrupt_case, QUANTITIES["Mkr"], _at_jump(coarse, lambda torque, kink: 3.0 * torque[kink], 0.605))
    assert late.error_max > 0.1


@pytest.mark.parametrize("jump", [0.0, 0.6])
def test_a_torque_three_times_too_large_at_a_jump_is_over_the_limit(abrupt_case, abrupt_motion, jump):
    found = deviation(
        abrupt_case, QUANTITIES["Mkr"], _at_jump(abrupt_motion, lambda torque, kink: 3.0 * torque[kink], jump)
    )
    assert found.error_max < 1e-12
    assert found.error_at_jumps > 0.1
    record = run_of(abrupt_case, "tuned").blank._replace(quantity="Mkr", error_max=found.error_max)
    assert judge(record).outcome == Verdict.PASSED
    judged = judge(record._replace(error_at_jumps=found.error_at_jumps))
    assert (judged.outcome, judged.error_max) == (Verdict.OVER_LIMIT, found.error_at_jumps)


def test_at_the_start_the_torque_may_be_that_of_a_crank_at_rest(abrupt_case, abrupt_motion):
    still = Case(
        abrupt_case.mechanism, CrankMotion("rest", (Segment(0.0, 1.0, (float(abrupt_case.motion.angle(0.0)),)),))
    )
    resting = _at_jump(abrupt_motion, lambda *_: float(still.at(np.zeros(1)).torque[0]), 0.0)
    assert deviation(abrupt_case, QUANTITIES["Mkr"], resting).error_at_jumps < 1e-12


def test_interpolation_across_a_jump_is_no_error_of_an_engine():
    """A power from a torque and a speed that have clocks of their own."""
    abrupt = Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up", ramp_time=1e-3, hold_time=0.05))
    shifted = perfect_motion(abrupt.mechanism, abrupt.motion, 202, shift=0.5)
    found = deviation(abrupt, QUANTITIES["Peq"], shifted)
    assert found.error_max < 1e-4
    assert found.error_at_jumps < 1e-4
    assert deviation(abrupt, QUANTITIES["Mkr"], shifted).error_at_jumps < 1e-12


def test_what_is_zero_for_want_of_any_mass_is_not_judged(abrupt_case, abrupt_motion):
    links = {name: replace(link, mass=0.0) for name, link in abrupt_case.mechanism.linkage.links.items()}
    for name, link in links.items():
        links[name] = replace(link, inertia=None if link.inertia is None else 0.0)
    bare = Case(Mechanism(replace(abrupt_case.mechanism.linkage, links=links)), abrupt_case.motion)
    still = perfect_motion(bare.mechanism, bare.motion)
    for name in ("Jeq", "Teq", "Mkr", "Peq"):
        with pytest.raises(NoSampleError, match="is zero throughout, as no link has a mass"):
            deviation(bare, QUANTITIES[name], still)
    assert deviation(bare, QUANTITIES["S"], still).error_max < 1e-9
    records = {record.quantity: record for record in checks(bare, still, run_of(bare, "tuned").blank)}
    undefined = {name for name, record in records.items() if record.outcome == Verdict.UNDEFINED}
    assert undefined == {"energy_balance", "torque_two_routes", "force_balance"}
