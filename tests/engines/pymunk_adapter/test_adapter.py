"""pymunk against the closed form, joint by joint and load by load; what pymunk cannot do comes back as a value."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.linkage import GROUND, RotaryDamper, Spring
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from analytic.kinematics.mechanism import Mechanism
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.start_state import scene
from engines.contract import Origin, Outcome, Setting
from engines.pymunk_adapter import adapter
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.pymunk_adapter.layout import plain_layout
from engines.scene import Channel, Free, Prescribed
from engines.stepping.histories import labelled
from engines.stepping.own_units import own_units
from tests.analytic.linkages import from_text, mechanism
from tests.engines.newton_euler import true_motion

pytest.importorskip("pymunk")
loop = pytest.importorskip("engines.pymunk_adapter.loop")

ENGINE = PymunkEngine()
EVERYTHING = frozenset(Channel)
NO_FORCES = EVERYTHING - {Channel.JOINT_FORCE}

# Errors relative to the peak: torque, joint forces and accelerations; positions and velocities.
LOAD = {Setting.TUNED: 5e-5, Setting.BEST: 5e-7}
MOTION = {Setting.TUNED: 5e-6, Setting.BEST: 5e-7}
NAIVE_ROUGHNESS = 1e-2  # a newcomer's accelerations are further off than this
WRONG_GROOVE = 2e-4  # what a groove off the mass centre's line does to velocities at any step
LOOSE_ORDER = 0.3  # an observed order may be this much below the theoretical one
FREE_ANGLE = {Setting.TUNED: 1e-6, Setting.BEST: 2e-8}  # rad after half a second
SEEN = 1e-2  # of a joint force: what a world of another crank or without a load is off by

NEEDLE = ["juki-mf7923d", "rimoldi-164"]
SLIDING = [
    "moving-guides",  # slots and sliders on links of every kind, two of them on one link
    "ground-pin-in-slot",
    "scotch-yoke",  # a slot in a body that does not turn
    "slot-without-mass",
    "three-on-one-pin",
]

ON_PIVOTS = """
title   = "quick return, no centres given"
source  = "made up for the tests"
units   = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank   = "crank"
slots   = [{ point = "A", on = "lever", through = [0, 0], along = [1, 0] }]
ground  = { O = [0, 0], P = [0, -60] }
[links.crank]
points  = { O = [0, 0], A = [20, 0] }
mass    = 0.2
inertia = 1e-4
[links.lever]
points  = { P = [0, 0], T = [120, 0] }
mass    = 0.2
inertia = 4e-4
[sketch]
angle  = 90
points = { T = [0, 60] }
"""

LIGHT = """
title   = "four-bar of links that are all mass and no inertia"
source  = "made up for the tests"
units   = { length = "mm", mass = "kg", inertia = "kg*mm^2", angle = "deg" }
crank   = "crank"
gravity = [0, -9.81]
ground  = { O = [0, 0], Q = [90, 0] }
[links.crank]
points  = { O = [0, 0], A = [30, 0] }
mass    = 1.0
centre  = [15, 0]
inertia = 1.8
[links.coupler]
points  = { A = [0, 0], B = [80, 0] }
mass    = 0.1
centre  = [30, 10]
inertia = 1.3
[links.rocker]
points  = { Q = [0, 0], B = [70, 0] }
mass    = 2.0
centre  = [35, 0]
inertia = 20
[sketch]
points = { B = [70, 67] }
"""


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.12, "hold_time": 0.037, "start_angle": 0.3, **changes})


def _run(closed, motion, setting=Setting.TUNED, channels=EVERYTHING, engine=ENGINE):
    closed = mechanism(closed) if isinstance(closed, str) else closed
    model = scene(closed, Prescribed(motion), channels)
    run = engine.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    return model, run


def _error(signal, truth):
    """Largest error over the truth's peak, component by component, acceleration jumps included."""
    difference, size = np.abs(signal.values - truth), np.abs(truth)
    axes = tuple(range(truth.ndim - 1)) if truth.ndim > 1 else 0
    floor = 2e-3 * size.max() or 1.0  # what rests, as the sum of its parts, may be off by absolute figures
    return float(np.max(difference.max(axes) / np.maximum(size.max(axes), floor)))


def _true_torque(closed, motion, time):
    return reduced.drive_torque(closed.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time))


def _torque_error(closed, motion, run):
    closed = mechanism(closed) if isinstance(closed, str) else closed
    return _error(run.history.torque, _true_torque(closed, motion, run.history.torque.time))


def _force_errors(closed, motion, run):
    """Of the sizes of joint forces over the largest of each, at least over a millionth of the largest of all."""
    closed = mechanism(closed) if isinstance(closed, str) else closed
    forces = run.history.joint_force
    time = next(iter(forces.values())).time
    sweep = closed.sweep(motion.angle(time))
    truth = {j: np.hypot(*f) for j, f in joint_forces(sweep, motion.speed(time), motion.acceleration(time)).items()}
    assert set(truth) == set(forces)
    largest = max(size.max() for size in truth.values())
    off = {joint: np.abs(forces[joint].values - size).max() for joint, size in truth.items()}
    return {joint: off[joint] / max(size.max(), 1e-6 * largest) for joint, size in truth.items()}


def _errors(closed, motion, model, run):
    """Worst errors of loads and of motion, bodies that cannot turn without their angles."""
    closed = mechanism(closed) if isinstance(closed, str) else closed
    turning = [body.inertia is not None for body in model.bodies]
    errors = []
    for order, channel in enumerate(("position", "velocity", "acceleration")):
        signal = getattr(run.history, channel)
        truth = true_motion(closed, motion, signal.time)[order]
        places = _error(dataclasses.replace(signal, values=signal.values[..., :2]), truth[..., :2])
        angles = dataclasses.replace(signal, values=signal.values[:, turning, 2])
        errors.append(max(places, _error(angles, truth[:, turning, 2])))
    loads = [errors[2], _torque_error(closed, motion, run), *_force_errors(closed, motion, run).values()]
    return max(loads), max(errors[:2])


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize("regime", ["run-up", "run-up-cubic", "run-up-quintic", "constant-speed"])
def test_motion_torque_and_sizes_of_joint_forces_follow_the_closed_form_at_every_sample(setting, regime):
    for name in NEEDLE:
        motion = _motion(regime, clockwise=regime == "run-up-cubic")
        model, run = _run(name, motion, setting)
        load, way = _errors(name, motion, model, run)
        assert (load < LOAD[setting], way < MOTION[setting]) == (True, True), (name, load, way)
        assert run.history.position.time[0] == 0.0
        assert run.history.position.time[-1] == pytest.approx(motion.duration, rel=1e-12)


@pytest.mark.parametrize("name", [*SLIDING, "force-over-angle", "spring-and-damper"])
def test_bodies_joints_and_loads_are_reported_as_themselves_however_they_are_cut(name):
    motion = _motion("run-up")
    model, run = _run(name, motion)
    assert max(_errors(name, motion, model, run)) < LOAD[Setting.TUNED]
    assert set(run.history.joint_force) == {joint.name for joint in (*model.pins, *model.guided)}


@pytest.mark.parametrize("text", [ON_PIVOTS, LIGHT])
def test_masses_on_pivots_and_small_inertias_are_no_trouble(text):
    closed, motion = from_text(text), _motion()
    for setting in (Setting.TUNED, Setting.BEST):
        model, run = _run(closed, motion, setting)
        assert max(_errors(closed, motion, model, run)) < 10.0 * LOAD[setting]


@pytest.mark.parametrize("changes", [{"ramp_time": 1e-3, "hold_time": 1e-3}, {"speed": 20.0, "ramp_time": 0.9}])
def test_best_is_better_than_tuned_however_short_or_slow_the_run(changes):
    motion = _motion(**changes)
    errors = [
        np.array(_errors("slotted-takeup", motion, *_run("slotted-takeup", motion, s))) for s in list(Setting)[1:]
    ]
    assert np.all(errors[1] < errors[0])


@pytest.mark.parametrize(
    ("setting", "origin"),
    [(Setting.NAIVE, Origin.READ), (Setting.TUNED, Origin.READ), (Setting.BEST, Origin.EXTRAPOLATED)],
)
def test_what_is_handed_back_is_the_engines_word(setting, origin):
    _, run = _run("juki-mf7923d", _motion(ramp_time=0.02), setting)
    assert {signal.origin for _, signal in labelled(run.history)} == {origin}
    assert len(run.details["steps"].split()) == (1 if origin is Origin.READ else 4)


def test_the_torque_is_the_motors_impulse_less_what_keeps_its_sign_and_nothing_else(monkeypatch):
    """A term of the adapter's own that grows with the motion would not be the engine's word."""
    told = []
    stepped = loop.stepped
    monkeypatch.setattr(loop, "stepped", lambda *given: told.append((given, stepped(*given))) or told[-1][1])
    _, run = _run("juki-mf7923d", _motion(), channels=frozenset({Channel.TORQUE}))
    (((world, step, *_), (_, impulses)),) = told
    units = own_units(scene(mechanism("juki-mf7923d"), Prescribed(_motion()), ()))
    expected = (world.given["offset"] - impulses[:, 0] / step) * units.unit("torque")
    assert run.history.torque.values == pytest.approx(expected, rel=1e-12, abs=1e-15)


class _Another(PymunkEngine):
    """pymunk in a world of which the adapter knows nothing."""

    def altered(self, scene):
        bodies = tuple(dataclasses.replace(b, mass=2.0 * b.mass) if b.name == "crank" else b for b in scene.bodies)
        return dataclasses.replace(scene, bodies=bodies if not scene.forces else scene.bodies, forces=())


def test_a_crank_of_twice_its_mass_and_a_side_load_that_is_missing_are_seen_in_the_joint_forces():
    """Neither moves anything, nor takes a torque."""
    drawn, motion = mechanism("juki-mf7923d").linkage, _motion()
    balanced = dataclasses.replace(drawn.links["crank"], centre=(0.0, 0.0))
    plain = dataclasses.replace(drawn, links={**drawn.links, "crank": balanced})
    loaded = mechanism("force-over-angle").linkage.forces[0]
    load = dataclasses.replace(loaded, link="needle_bar", point="D", force=Law(np.array([20.0, 0.0])))
    for linkage, joint in ((plain, "O1"), (dataclasses.replace(plain, forces=(load,)), "needle_bar on ground")):
        closed = Mechanism(linkage)
        faithful, other = (_run(closed, motion, engine=engine)[1] for engine in (ENGINE, _Another()))
        assert max(_force_errors(closed, motion, faithful).values()) < LOAD[Setting.TUNED]
        assert _torque_error(closed, motion, other) < LOAD[Setting.TUNED]
        assert _force_errors(closed, motion, other)[joint] > SEEN


def test_a_groove_that_is_not_cut_free_gives_a_wrong_velocity(monkeypatch):
    def worst():
        motion = _motion()
        return _errors("ground-pin-in-slot", motion, *_run("ground-pin-in-slot", motion))[1]

    assert worst() < MOTION[Setting.TUNED]
    monkeypatch.setattr(adapter, "exact_layout", plain_layout)
    assert worst() > WRONG_GROOVE


# -- loads -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "load",
    [
        {"dampers": (RotaryDamper(("rocker", "rod"), 1e-3),)},
        {"springs": (Spring(("A", "O2"), ("rod", GROUND), 0.0, 0.0, 2.0),)},  # a dashpot alone
        {"springs": (Spring(("B", "D"), ("rod", "link"), 300.0, 0.02, 2.0),)},
    ],
)
def test_dampers_and_dashpots_between_links(load):
    closed, motion = Mechanism(dataclasses.replace(mechanism("rimoldi-164").linkage, **load)), _motion("run-up")
    _, run = _run(closed, motion)
    time = run.history.torque.time
    truth, bare = (_true_torque(each, motion, time) for each in (closed, mechanism("rimoldi-164")))
    assert np.abs(truth - bare).max() > 100.0 * LOAD[Setting.TUNED] * np.abs(truth).max()
    assert _error(run.history.torque, truth) < LOAD[Setting.TUNED]


# -- the stepping ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "order"), [("centred", 2), ("centred x2", 3), ("centred x3", 4)])
def test_order_of_convergence(name, order):
    motion = _motion("constant-speed")
    model = scene(mechanism("rimoldi-164"), Prescribed(motion), NO_FORCES)
    method = next(each for each in ENGINE.methods(model) if each.name == name)
    runs = [ENGINE.run_method(model, dataclasses.replace(method, effort=200), step) for step in (1.2e-3, 6e-4)]
    errors = []
    for signal in (run.history.torque for run in runs):
        later = signal.time > 0.02  # than what the start leaves
        truth = _true_torque(mechanism("rimoldi-164"), motion, signal.time[later])
        errors.append(np.abs(signal.values[later] - truth).max())
    assert math.log2(errors[0] / errors[1]) > order - LOOSE_ORDER


def test_a_naive_run_is_as_rough_as_a_newcomers():
    motion = _motion()
    _, run = _run("juki-mf7923d", motion, Setting.NAIVE)
    signal = run.history.acceleration
    assert _error(signal, true_motion(mechanism("juki-mf7923d"), motion, signal.time)[2]) > NAIVE_ROUGHNESS
    assert run.steps == 1200 + 370
    assert len(signal.time) == run.steps
    assert np.all(run.history.torque.values >= 0.0)  # pymunk tells its size alone
    assert run.details["iterations"] == 10


@pytest.mark.nightly
def test_the_last_of_two_hundred_turns_is_as_good_as_the_first():
    closed, motion = mechanism("juki-mf7923d"), _motion("constant-speed", ramp_time=11.9, hold_time=0.1)
    _, run = _run(closed, motion, channels=frozenset({Channel.TORQUE}))
    signal = run.history.torque
    off = np.abs(signal.values - _true_torque(closed, motion, signal.time))
    count = len(off) // 200
    assert off[-count:].max() < 3.0 * off[:count].max()


def test_no_buffer_is_made_for_a_run(monkeypatch):
    """For pymunk never frees one."""
    monkeypatch.delattr("pymunk.batch.Buffer")
    _run("juki-mf7923d", _motion(ramp_time=0.02), Setting.BEST)


# -- a free crank ------------------------------------------------------------------------------------------------------


def _true_end(closed, torque, duration, start_angle):
    def rate(_time, state):
        sweep = closed.sweep(np.asarray(state[0]))
        moment = torque + reduced.generalised_force(sweep) - reduced.damping_coefficient(sweep) * state[1]
        moment -= reduced.half_inertia_derivative(sweep) * state[1] ** 2
        return [state[1], float(moment / reduced.reduced_inertia(sweep))]

    return solve_ivp(rate, (0.0, duration), [start_angle, 0.0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize(
    ("name", "torque", "duration"),
    [("juki-mf7923d", 0.01, 0.4), ("spring-and-damper", 0.0, 0.1), ("force-over-angle", 0.5, 0.04)],
)
def test_a_free_crank_moves_as_the_equation_of_motion_says(name, torque, duration, setting):
    closed = mechanism(name)
    run = ENGINE.run(model := scene(closed, Free(torque, duration), EVERYTHING, start_angle=0.4), setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    angle, _ = _true_end(closed, torque, duration, 0.4)
    assert abs(angle - 0.4) > 0.1  # it does move
    crank = [body.name for body in model.bodies].index(model.crank)
    assert run.history.position.values[-1, crank, 2] == pytest.approx(
        angle, abs=max(1.0, abs(angle)) * FREE_ANGLE[setting]
    )
    assert run.history.torque is None


def test_a_crank_that_nothing_slows_down_keeps_its_energy():
    closed = Mechanism(dataclasses.replace(mechanism("rimoldi-164").linkage, gravity=(0.0, 0.0)))
    wanted = frozenset({Channel.POSITION, Channel.VELOCITY})
    run = ENGINE.run(model := scene(closed, Free(0.0, 2.0, 25.0), wanted, start_angle=0.3, speed=20.0), Setting.TUNED)
    assert run.outcome is Outcome.FINISHED, run.reason
    energy = ObservedMotion(model, run.history).kinetic_energy(run.history.velocity.time)
    assert np.ptp(run.history.position.values[:, [b.name for b in model.bodies].index(model.crank), 2]) > 20.0
    assert np.ptp(energy) < 1e-5 * energy[0]


# -- what cannot be done is a value ------------------------------------------------------------------------------------


def _changed(model, name, **changes):
    bodies = tuple(dataclasses.replace(b, **changes) if b.name == name else b for b in model.bodies)
    return dataclasses.replace(model, bodies=bodies)


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("coupler", {"mass": 0.0}, "mass 0"),  # each of these ends the process if pymunk gets it
        ("coupler", {"mass": -1.0}, "mass -1"),
        ("coupler", {"mass": math.nan}, "mass nan"),
        ("coupler", {"mass": math.inf}, "mass inf"),
        ("coupler", {"inertia": 0.0}, "inertia 0"),
        ("coupler", {"inertia": math.nan}, "inertia nan"),
        ("crank", {"inertia": None}, "no inertia"),
        ("coupler", {"position": (math.nan, 0.0)}, "not finite"),  # and each of these runs on as nonsense
        ("coupler", {"position": (0.001, 0.02)}, "in position"),
        ("coupler", {"velocity": (0.1, 0.0)}, "in velocity"),
    ],
)
def test_bodies_that_pymunk_must_not_get(name, changes, words):
    model = _changed(
        scene(mechanism("juki-mf7923d"), Prescribed(_motion("constant-speed")), NO_FORCES), name, **changes
    )
    for setting in Setting:
        run = ENGINE.run(model, setting)
        assert run.outcome is Outcome.UNSUPPORTED
        assert words in run.reason


def test_joints_that_leave_no_linkage_are_refused():
    model = scene(mechanism("rimoldi-164"), Prescribed(_motion()), NO_FORCES)
    loose = dataclasses.replace(model, pins=tuple(pin for pin in model.pins if GROUND in (pin.first, pin.second)))
    run = ENGINE.run(loose, Setting.TUNED)
    assert run.outcome is Outcome.UNSUPPORTED
    assert "degrees of freedom" in run.reason


def test_a_linkage_with_a_change_point_is_run_away_from_it():
    motion = _motion(speed=10.0)
    assert max(_errors("parallelogram", motion, *_run("parallelogram", motion))) < LOAD[Setting.TUNED]
