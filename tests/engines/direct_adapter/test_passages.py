"""Change points passed without a formula of the closed form: exact motions, torques, releases, and what is none."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import Channel, Free, Prescribed
from tests.analytic.kinematics.test_change_points import CASES, FOUR_BAR, four_bar
from tests.analytic.linkages import FOLDER, from_text, mechanism

ENGINE = DirectEngine()
EVERYTHING = frozenset(Channel)
EXACT = (2e-14, 1e-13, 1e-12)  # poses, rates and accelerations over φ
TORQUE = 1e-12  # of the peak
RELEASED = 1e-10  # rad, and rad/s, after ten seconds and ten passages
ENERGY = 1e-12  # of its swing


def _constant(start, speed):
    return CrankMotion("constant-speed", (Segment(0.0, 0.1, (start, speed)),))


def _run(model, setting=Setting.TUNED):
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    return run.history


def _column(model, name):
    return [body.name for body in model.bodies].index(name)


def _errors(sample, start, speed):
    """Of both links' angles and their first two derivatives over φ, against the closed form."""
    motion = _constant(start, speed)
    model = scene(sample, Prescribed(motion), EVERYTHING)
    history = _run(model)
    sweep = sample.sweep(motion.angle(history.position.time))
    errors = np.zeros(3)
    for name in ("coupler", "rocker"):
        column, pose = _column(model, name), sweep.poses(name)
        angle = history.position.values[:, column, 2]
        found = (history.velocity.values[:, column, 2] / speed, history.acceleration.values[:, column, 2] / speed**2)
        off = (
            np.hypot(np.cos(angle) - pose[2], np.sin(angle) - pose[3]),
            np.abs(found[0] - sweep.rates(name)[2]),
            np.abs(found[1] - sweep.accelerations(name)[2]),
        )
        errors = np.maximum(errors, [np.max(part) for part in off])
    return errors


# Forwards and backwards, over one turn and three, from beside a change point and across 0°.
@pytest.mark.parametrize(("start", "speed"), [(0.5, 60.0), (0.05, -60.0), (math.pi - 0.01, 60.0), (1.5, 200.0)])
@pytest.mark.parametrize("name", CASES)
def test_linkages_pass_their_change_points_as_the_closed_form_does(name, start, speed):
    *lengths, angle, x, y, _ = CASES[name]
    assert np.all(_errors(four_bar(lengths, angle, (x, y)), start, speed) <= EXACT)


TEN = Mechanism(load(str(FOLDER / "change-points" / "ten-four-bars.toml")))
# All rods turn alike and no coupler turns: one pendulum. Uniform rods of 1 m and 1 kg, 11 that turn and 10 that do not.
INERTIA, WEIGHT = 11.0 / 3.0 + 10.0, 9.81 * (11.0 * 0.5 + 10.0)


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
def test_ten_coupled_four_bars_turn_as_one_pendulum(setting):
    motion = _constant(0.5, 60.0)
    model = scene(TEN, Prescribed(motion), EVERYTHING)
    history = _run(model, setting)
    angle = motion.angle(history.position.time)
    rockers = [_column(model, f"rocker{n}") for n in range(1, 11)]
    assert np.max(np.abs(history.position.values[:, rockers, 2] - angle[:, None])) <= EXACT[0]
    assert np.max(np.abs(history.acceleration.values[:, :, 2])) / 60.0**2 <= EXACT[2]
    error = history.torque.values - WEIGHT * np.cos(angle)
    assert np.max(np.abs(error)) / WEIGHT <= 1e3 * TORQUE  # 10⁶ N of inertia forces cancel in it


def test_ten_coupled_four_bars_are_released_as_one_pendulum():
    model = scene(TEN, Free(0.0, 10.0), EVERYTHING - {Channel.JOINT_FORCE}, start_angle=0.5 * np.pi, speed=-1.0)
    history = _run(model)

    def rate(_time, state):
        return [state[1], -WEIGHT / INERTIA * np.cos(state[0])]

    truth = solve_ivp(rate, (0.0, 10.0), [0.5 * np.pi, -1.0], method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    crank = _column(model, "crank")
    assert history.position.values[-1, crank, 2] == pytest.approx(truth[0], rel=0, abs=RELEASED)
    assert history.velocity.values[-1, crank, 2] == pytest.approx(truth[1], rel=0, abs=RELEASED)


def test_a_released_crank_keeps_its_energy_where_the_motion_repeats_after_two_turns():
    """One change point a turn: the rocker is elsewhere every second time."""
    *lengths, angle, x, y, _ = CASES["crank shortest"]
    g, a, b, c = lengths
    heavy = FOUR_BAR.format(g=g, a=a, b=b, c=c, angle=angle, x=x, y=y)
    heavy = heavy.replace("]\npoints = {", "]\nmass = 2\ninertia = 0.5\ncentre = [0.3, 0.1]\npoints = {")  # the links'
    heavy = heavy.replace('crank = "crank"', 'crank = "crank"\ngravity = [0, -9.81]')
    model = scene(from_text(heavy), Free(0.0, 4.0), EVERYTHING - {Channel.JOINT_FORCE}, start_angle=1.5, speed=8.0)
    history = _run(model)
    place, rate = history.position.values, history.velocity.values
    kinetic = 0.5 * (2.0 * (rate[..., 0] ** 2 + rate[..., 1] ** 2) + 0.5 * rate[..., 2] ** 2).sum(axis=1)
    stored = 9.81 * 2.0 * place[..., 1].sum(axis=1)
    assert np.ptp(place[:, _column(model, "crank"), 2]) > 4.0 * np.pi
    assert np.ptp(kinetic + stored) <= ENERGY * np.ptp(stored)


# Of the crank's length; what the closed form takes for rounding of the lengths is passed, what it does not is none.
@pytest.mark.parametrize(("share", "passes"), [(1e-14, True), (1e-13, False), (1e-11, False), (-1e-13, False)])
def test_a_miss_is_no_change_point(share, passes):
    sample = four_bar((0.06, 0.025, 0.06, repr(0.025 * (1.0 + share))), 1.5, (0.06, 0.025))
    run = ENGINE.run(scene(sample, Prescribed(_constant(1.0, 60.0)), frozenset({Channel.POSITION})), Setting.TUNED)
    assert bool(sample.changes) == passes
    assert (run.outcome is Outcome.FINISHED) == passes


def test_joint_forces_are_left_out_beside_change_points_and_nowhere_else():
    motion = _constant(0.5, 60.0)
    history = _run(scene(mechanism("parallelogram"), Prescribed(motion), EVERYTHING))
    for force in history.joint_force.values():
        left = np.isin(history.position.time, force.time, invert=True)
        away = np.abs((motion.angle(history.position.time) + 0.5 * np.pi) % np.pi - 0.5 * np.pi)
        assert np.all(np.isfinite(force.values))
        assert left.any()
        assert np.max(away[left]) < 0.41
