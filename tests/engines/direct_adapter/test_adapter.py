"""The second derivation against the closed form and the laws of mechanics, and on scenes that cannot be solved."""

import dataclasses
import math
import re

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, solve_ivp

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from analytic.description.law import Law
from analytic.description.linkage import GROUND
from analytic.dynamics import reduced
from analytic.motion.released import free_motion
from comparisons.invariants import invariants
from comparisons.invariants.inspection import Inspection
from comparisons.judging.deviations import deviation
from comparisons.judging.quantities import chosen_quantities
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import AppliedForce, Body, Channel, Free, PinJoint, Prescribed, Scene, SliderJoint
from tests.analytic.kinematics.test_change_points import four_bar
from tests.analytic.linkages import FULL_TURN, from_text, mechanism
from tests.analytic.loaded_linkages import ODD, on_trial
from tests.analytic.takeups import SLOTTED, TWO_CRANK, takeup

ENGINE = DirectEngine()
EVERYTHING = frozenset(Channel)

# Errors relative to the peak.
SAME = 1e-12  # two derivations of one linkage
ROUNDING = 3e-14  # of mechanisms with moderate transmission angles: a few roundings, times their condition
NEAR_TOGGLE = 1e-9  # one linkage is made to magnify the rounding of its own lengths a millionfold
BALANCE = 1e-12  # of the largest force: Newton's and Euler's laws on the bodies of a run
WORK = 1e-4  # what the quadrature of power leaves of an energy balance at three degrees of crank per sample
SLIGHT = 1e-9  # a change of one mass that has to be noticed
FREE_ANGLE = 1e-11  # rad after half a second
FREE_SPEED = 1e-9  # rad/s after half a second
LONG_ANGLE = 1e-9  # rad after ten seconds and 160 turns
SLOW_CRANK = 1e-9  # rad/s: at rest

SAMPLES = [*FULL_TURN, *((name, None) for name in ODD)]


def _obstacle(model):
    """Why a scene is not run."""
    run = ENGINE.run(model, Setting.TUNED)
    return run.reason if run.outcome is Outcome.UNSUPPORTED else None


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.15, "hold_time": 0.03, "start_angle": 0.3, **changes})


def _run(sample, motion, setting=Setting.TUNED, channels=EVERYTHING):
    model = scene(sample, Prescribed(motion), channels)
    assert _obstacle(model) is None
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    return model, run


def _errors(sample, motion, model, run):
    case, seen = Case(sample, motion), ObservedMotion(model, run.history)
    return {wanted.name: deviation(case, wanted, seen).error_max for wanted in chosen_quantities(case, ())}


def _limit(name):
    return NEAR_TOGGLE if name == "near-toggle" else SAME


@pytest.mark.parametrize(("name", "variant"), SAMPLES)
@pytest.mark.parametrize("is_laden", [False, True])
def test_every_linkage_agrees_with_the_closed_form_in_motion_torque_and_joint_forces(name, variant, is_laden):
    sample, motion = on_trial(name, variant, is_laden), _motion()
    model, run = _run(sample, motion)
    errors = _errors(sample, motion, model, run)
    assert max(errors.values()) <= _limit(name)
    assert {f"joint_force:{joint.name}" for joint in (*model.pins, *model.sliders, *model.slots)} <= set(errors)


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize("name", ["juki-mf7923d", "rimoldi-164", "shaper", "spring-and-damper"])
def test_moderate_transmission_angles_leave_roundings_only(name, setting):
    motion = _motion("run-up")
    assert max(_errors(mechanism(name), motion, *_run(mechanism(name), motion, setting)).values()) <= ROUNDING


@pytest.mark.parametrize("sample", [takeup(SLOTTED), takeup(TWO_CRANK)], ids=["slotted", "two-crank"])
@pytest.mark.parametrize("changes", [{"clockwise": True}, {"start_angle": 4.0}, {"speed": 3.0}, {"hold_time": 3.0}])
def test_direction_start_angle_and_many_turns_cost_no_accuracy(sample, changes):
    motion = _motion(**changes)
    model, run = _run(sample, motion)
    assert max(_errors(sample, motion, model, run).values()) <= SAME


def test_angles_are_unwrapped_over_the_turns():
    motion = _motion()
    run = _run(takeup(TWO_CRANK), motion)[1]
    angles = run.history.position.values[:, :, 2]
    assert np.array_equal(angles[:, 1], motion.angle(run.history.position.time)), "bodies come by name: coupler, crank"
    assert np.max(np.abs(np.diff(angles, axis=0))) < 1.0
    turned = angles[-1, 1] - angles[0, 1]
    assert abs(angles[-1, 2] - angles[0, 2] - turned) < 2.0 * math.pi, "the rocker of a double crank turns with it"


def _energy_out_of_nothing(seen):
    """Largest energy gained beyond the work of drive and loads, J, by Simpson's rule."""
    time = seen.signal(Channel.TORQUE).time
    power = seen.signal(Channel.TORQUE).values * seen.crank(Channel.VELOCITY, time) + seen.load_power(time)
    energy = seen.kinetic_energy(time) + seen.potential_energy(time)
    return np.max(np.abs(energy - energy[0] - cumulative_simpson(power, x=time, initial=0.0)))


@pytest.mark.parametrize("name", ["rimoldi-164", "carried-slider", "ground-pin-in-slot", "shaper"])
def test_the_motion_keeps_the_laws_of_mechanics_by_itself(name):
    sample = on_trial(name, None, name != "shaper")
    model, run = _run(sample, _motion("constant-speed"))
    seen = ObservedMotion(model, run.history)
    gap = np.max(invariants.joint_gaps(seen).values)
    assert gap <= ROUNDING * sample.linkage.extent()
    assert _energy_out_of_nothing(seen) <= WORK * np.max(seen.kinetic_energy(seen.signal(Channel.VELOCITY).time))
    by_power = Inspection(seen).torque_required()
    fast = np.abs(seen.crank(Channel.VELOCITY, by_power.time)) >= SLOW_CRANK
    difference = (by_power.values - seen.on_clock(Channel.TORQUE, by_power.time))[fast]
    assert np.max(np.abs(difference)) <= BALANCE * np.max(np.abs(run.history.torque.values))


def _pull(model, run, name):
    """Sum of all joint forces on a body, N; the ground's is what the linkage does to its frame."""
    total = np.zeros((len(run.history.torque.time), 2))
    for pin in model.pins:
        total += (float(pin.first == name) - float(pin.second == name)) * run.history.joint_force[pin.name].values
    for line in (*model.sliders, *model.slots):
        total += (float(line.body == name) - float(line.host == name)) * run.history.joint_force[line.name].values
    return total


@pytest.mark.parametrize("name", ["rimoldi-164", "moving-guides", "ground-pin-in-slot", "three-on-one-pin"])
def test_joint_forces_move_every_body_and_together_push_the_frame(name):
    model, run = _run(mechanism(name), _motion("run-up"))
    masses = np.array([body.mass for body in model.bodies])[:, None]
    inertia_forces = masses * (run.history.acceleration.values[:, :, :2] - np.asarray(model.gravity))
    scale = max(np.max(np.abs(force.values)) for force in run.history.joint_force.values())
    for number, body in enumerate(model.bodies):
        assert np.max(np.abs(_pull(model, run, body.name) - inertia_forces[:, number])) <= BALANCE * scale
    assert np.max(np.abs(_pull(model, run, GROUND) + inertia_forces.sum(axis=1))) <= BALANCE * scale


def test_a_turning_body_is_turned_by_the_moments_of_its_joint_forces_and_the_drive():
    model, run = _run(mechanism("double-crank"), _motion("run-up"))
    number = [body.name for body in model.bodies].index("crank")
    crank = model.bodies[number]
    angle = run.history.position.values[:, number, 2]
    moment = run.history.torque.values.copy()
    for pin in model.pins:
        for name, anchor, sign in ((pin.first, pin.first_anchor, 1.0), (pin.second, pin.second_anchor, -1.0)):
            if name == crank.name:
                force = sign * run.history.joint_force[pin.name].values
                x = np.cos(angle) * anchor[0] - np.sin(angle) * anchor[1]
                y = np.sin(angle) * anchor[0] + np.cos(angle) * anchor[1]
                moment += x * force[:, 1] - y * force[:, 0]
    turn = crank.inertia * run.history.acceleration.values[:, number, 2]
    assert np.max(np.abs(moment - turn)) <= BALANCE * np.max(np.abs(run.history.torque.values))


def _standing(angle):
    """A crank that stands still."""
    return Prescribed(CrankMotion("constant-speed", (Segment(0.0, 0.1, (angle, 0.0)),)))


def _still(name, mass, inertia, position, angle=0.0):
    return Body(name, mass, inertia, position, angle, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0)


def _slider_crank_of_3_4_5():
    """Crank 3 m upright, rod 5 m, slider 4 m away on the x axis, pressed with 8 N towards the crank; no weight."""
    tilt = math.atan2(-3.0, 4.0)
    bodies = (
        _still("crank", 1.0, 1.0, (0.0, 1.5), math.pi / 2.0),
        _still("rod", 1.0, 1.0, (2.0, 1.5), tilt),
        _still("slider", 1.0, None, (4.0, 0.0)),
    )
    pins = (
        PinJoint("O", "crank", GROUND, (-1.5, 0.0), (0.0, 0.0)),
        PinJoint("A", "rod", "crank", (-2.5, 0.0), (1.5, 0.0)),
        PinJoint("B", "slider", "rod", (0.0, 0.0), (2.5, 0.0)),
    )
    guide = SliderJoint("guide", "slider", (0.0, 0.0), GROUND, (0.0, 0.0), (1.0, 0.0))
    press = AppliedForce("slider", (0.0, 0.0), Law(np.array([-8.0, 0.0])))
    drive = _standing(math.pi / 2.0)
    return Scene("crank", bodies, pins, (guide,), (), (0.0, 0.0), drive, EVERYTHING, forces=(press,))


@pytest.mark.parametrize("setting", list(Setting))
def test_a_slider_crank_that_stands_still_is_held_as_by_hand(setting):
    run = ENGINE.run(_slider_crank_of_3_4_5(), setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    # The rod is a strut along (4, -3)/5: it takes 8·5/4 = 10 N, the guide 8·3/4 = 6 N, the crank 3 m · 8 N.
    forces = {name: signal.values[0] for name, signal in run.history.joint_force.items()}
    assert forces["B"] == pytest.approx([8.0, -6.0], abs=BALANCE)
    assert forces["guide"] == pytest.approx([0.0, 6.0], abs=BALANCE)
    assert forces["A"] == pytest.approx([8.0, -6.0], abs=BALANCE)
    assert forces["O"] == pytest.approx([8.0, -6.0], abs=BALANCE)
    assert run.history.torque.values == pytest.approx(-24.0, abs=BALANCE)


@pytest.mark.parametrize("name", ["juki-mf7923d", "rimoldi-164"])
@pytest.mark.parametrize("number", range(3))
def test_a_scene_with_a_slightly_wrong_mass_is_noticed(name, number):
    sample, motion = mechanism(name), _motion()
    model = scene(sample, Prescribed(motion), EVERYTHING)
    wrong = dataclasses.replace(model.bodies[number], mass=model.bodies[number].mass * (1.0 + SLIGHT))
    bodies = (*model.bodies[:number], wrong, *model.bodies[number + 1 :])
    model = dataclasses.replace(model, bodies=bodies)
    assert _errors(sample, motion, model, ENGINE.run(model, Setting.TUNED))["Mkr"] > SAME


@pytest.mark.parametrize("wanted", [{Channel.POSITION}, {Channel.VELOCITY}, {Channel.ACCELERATION}, {Channel.TORQUE}])
def test_only_what_is_asked_for_comes_back_and_is_the_same(wanted):
    motion = _motion()
    whole = _run(takeup(SLOTTED), motion)[1].history
    history = _run(takeup(SLOTTED), motion, channels=frozenset(wanted))[1].history
    for channel in (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION, Channel.TORQUE):
        signal = getattr(history, channel.value)
        assert (signal is not None) == (channel in wanted)
        assert signal is None or np.array_equal(signal.values, getattr(whole, channel.value).values)
    assert history.joint_force == {}


def _true_free_motion(sample, torque, start, speed, time):
    def law(_, state):
        sweep = sample.sweep(np.asarray(state[0]))
        moment = torque + reduced.generalised_force(sweep) - reduced.damping_coefficient(sweep) * state[1]
        moment -= reduced.half_inertia_derivative(sweep) * state[1] ** 2
        return state[1], moment / reduced.reduced_inertia(sweep)

    return solve_ivp(law, (0.0, time[-1]), (start, speed), "DOP853", time, rtol=3e-14, atol=1e-14).y


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
@pytest.mark.parametrize(
    ("sample", "torque", "degrees"),
    [(takeup(SLOTTED), 0.0, 280.0), (takeup(SLOTTED), 0.025, 269.18), (mechanism("spring-and-damper"), 0.1, 30.0)],
    ids=["slotted, free", "slotted, driven", "spring and damper"],
)
def test_a_free_crank_moves_as_the_equation_of_motion_has_it(sample, torque, degrees, setting):
    model = scene(sample, Free(torque, 0.4), EVERYTHING, start_angle=math.radians(degrees))
    assert _obstacle(model) is None
    run = ENGINE.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    seen = ObservedMotion(model, run.history)
    time = run.history.position.time
    angle, speed = _true_free_motion(sample, torque, math.radians(degrees), 0.0, time[::20])
    assert np.max(np.abs(seen.crank(Channel.POSITION, time)[::20] - angle)) <= FREE_ANGLE
    assert np.max(np.abs(seen.crank(Channel.VELOCITY, time)[::20] - speed)) <= FREE_SPEED
    assert run.history.torque.values == pytest.approx(torque, abs=BALANCE)
    assert _energy_out_of_nothing(seen) <= WORK * np.max(seen.kinetic_energy(seen.signal(Channel.VELOCITY).time))


@pytest.mark.parametrize(("torque", "degrees"), [(0.0, 280.0), (0.025, 269.18)], ids=["free", "driven"])
def test_ten_seconds_of_the_slotted_take_up_are_those_of_the_reference(torque, degrees):
    sample, start = takeup(SLOTTED), math.radians(degrees)
    truth = free_motion(sample, torque=torque, start_angle=start, duration=10.0)
    model = scene(sample, Free(torque, 10.0), {Channel.POSITION}, start_angle=start)
    position = ENGINE.run(model, Setting.TUNED).history.position
    crank = [body.name for body in model.bodies].index(model.crank)
    assert np.max(np.abs(position.values[:, crank, 2] - truth.angle(position.time))) <= LONG_ANGLE


def test_loads_over_the_crank_angle_act_on_a_free_crank():
    sample = on_trial("force-over-angle", None, True)
    model = scene(sample, Free(0.0, 0.05), EVERYTHING, start_angle=0.5, speed=30.0)
    run = ENGINE.run(model, Setting.TUNED)
    time = run.history.position.time
    angle, _ = _true_free_motion(sample, 0.0, 0.5, 30.0, time[::40])
    crank = ObservedMotion(model, run.history).crank(Channel.POSITION, time)
    assert np.max(np.abs(crank[::40] - angle)) <= FREE_ANGLE


DOUBLE_ROCKER = """
title = "double rocker"
source = "made up for the tests"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]
ground = { O1 = [0, 0], O2 = [60, 0] }
[links.crank]
points = { O1 = [0, 0], A = [50, 0] }
mass = 0.3
centre = [20, 0]
inertia = 1e-4
[links.coupler]
points = { A = [0, 0], B = [30, 0] }
mass = 0.1
centre = [15, 0]
inertia = 1e-5
[links.rocker]
points = { O2 = [0, 0], B = [45, 0] }
mass = 0.2
centre = [20, 0]
inertia = 1e-4
[sketch]
angle = 60
points = { B = [55, 45] }
"""


def _locking_angle():
    """Coupler and rocker in line, 75 mm from A to O2, rad: cosine rule with 50 and 60 mm."""
    return math.acos((50.0**2 + 60.0**2 - 75.0**2) / (2.0 * 50.0 * 60.0))


@pytest.mark.parametrize("setting", [Setting.TUNED, Setting.BEST])
def test_a_linkage_that_locks_diverges_with_the_time_and_the_angle(setting):
    motion = _motion(start_angle=1.0)
    run = ENGINE.run(scene(from_text(DOUBLE_ROCKER), Prescribed(motion), EVERYTHING), setting)
    assert run.outcome is Outcome.DIVERGED
    assert run.history is None
    assert f"{math.degrees(_locking_angle()):.4g}" in run.reason
    assert "s: the linkage locks, or passes a change point, at" in run.reason


@pytest.mark.parametrize("share", [0.0, 1e-13, -1e-13, -1e-9])
def test_a_change_point_is_not_passed_nor_one_that_is_just_missed(share):
    length = repr(0.025 * (1.0 + share))
    sample = four_bar((0.06, 0.025, 0.06, length), 1.5, (0.06, 0.025))
    motion = CrankMotion("constant-speed", (Segment(0.0, 0.1, (1.0, 60.0)),))
    run = ENGINE.run(scene(sample, Prescribed(motion), frozenset({Channel.POSITION})), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    (angle,) = re.findall(r"crank angle of (.*)°", run.reason)
    assert float(angle) == pytest.approx(180.0, abs=0.1)


def test_within_its_stops_a_linkage_that_locks_can_be_moved():
    sample = from_text(DOUBLE_ROCKER)
    motion = CrankMotion("constant-speed", (Segment(0.0, 0.1, (0.9, 4.0)),))
    model, run = _run(sample, motion)
    assert max(_errors(sample, motion, model, run).values()) <= SAME


def test_a_free_crank_that_runs_up_against_its_stop_diverges():
    model = scene(from_text(DOUBLE_ROCKER), Free(0.5, 5.0), EVERYTHING, start_angle=1.0)
    run = ENGINE.run(model, Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "locks" in run.reason


def test_a_released_parallelogram_swings_between_its_change_points():
    """Its coupler does not turn: T = ½ (J₁ + J₃ + m₂ r²) ω² and V = m₂ g r sin φ, the other centres being on pivots."""
    inertia, lift = 0.6e-4 + 0.7e-4 + 0.15 * 0.025**2, 0.15 * 9.81 * 0.025
    model = scene(mechanism("parallelogram"), Free(0.0, 0.15), EVERYTHING, start_angle=1.0, speed=3.0)
    history = ENGINE.run(model, Setting.TUNED).history
    angle, speed = history.position.values[:, 1, 2], history.velocity.values[:, 1, 2]
    energy = 0.5 * inertia * speed**2 + lift * np.sin(angle)
    assert np.ptp(energy) <= SAME * energy[0]
    assert np.ptp(angle) > 0.1
    assert np.max(np.abs(history.position.values[:, 0, 2])) <= ROUNDING


def test_a_start_state_with_an_open_joint_diverges_and_names_it():
    model = scene(mechanism("juki-mf7923d"), Prescribed(_motion()), EVERYTHING)
    bar = next(body for body in model.bodies if body.inertia is None)
    moved = dataclasses.replace(bar, position=(bar.position[0], bar.position[1] + 1e-3))
    bodies = tuple(moved if body is bar else body for body in model.bodies)
    run = ENGINE.run(dataclasses.replace(model, bodies=bodies), Setting.TUNED)
    assert run.outcome is Outcome.DIVERGED
    assert "'D'" in run.reason


def _three_cranks():
    """A parallelogram with a third crank that changes nothing."""
    c, s = math.cos(1.0), math.sin(1.0)
    cranks = [_still(f"crank {n}", 1.0, 1.0, (4.0 * n, 0.0), 1.0) for n in range(3)]
    pins = [PinJoint(f"O{n}", f"crank {n}", GROUND, (0.0, 0.0), (4.0 * n, 0.0)) for n in range(3)]
    pins += [PinJoint(f"A{n}", f"crank {n}", "beam", (1.0, 0.0), (4.0 * n - 4.0, 0.0)) for n in range(3)]
    bodies = (*cranks, _still("beam", 1.0, 1.0, (4.0 + c, s)))
    return Scene("crank 0", bodies, tuple(pins), (), (), (0.0, 0.0), _standing(1.0), EVERYTHING)


def test_redundant_joints_and_free_bodies_are_obstacles():
    model = _three_cranks()
    assert "redundant" in _obstacle(model)
    assert "more than the crank can move" in _obstacle(dataclasses.replace(model, pins=model.pins[:-2]))
    assert _obstacle(dataclasses.replace(model, pins=(*model.pins[:2], *model.pins[3:-1]))) is not None


def test_a_crank_that_cannot_turn_is_an_obstacle():
    model = _three_cranks()
    bodies = (dataclasses.replace(model.bodies[0], inertia=None), *model.bodies[1:])
    assert "crank 0" in _obstacle(dataclasses.replace(model, bodies=bodies))


def test_a_dead_point_at_the_start_is_an_obstacle():
    in_line = math.atan2(-4.0, 3.0)  # rod and arm, 2 m and 3 m, from the crank pin (0, 1) to the pivot (3, -3)
    bodies = (
        _still("crank", 1.0, 1.0, (0.0, 0.0), math.pi / 2.0),
        _still("rod", 1.0, 1.0, (0.0, 1.0), in_line),
        _still("arm", 1.0, 1.0, (3.0, -3.0), in_line),
    )
    pins = (
        PinJoint("O", "crank", GROUND, (0.0, 0.0), (0.0, 0.0)),
        PinJoint("A", "rod", "crank", (0.0, 0.0), (1.0, 0.0)),
        PinJoint("B", "rod", "arm", (2.0, 0.0), (-3.0, 0.0)),
        PinJoint("C", "arm", GROUND, (0.0, 0.0), (3.0, -3.0)),
    )
    model = Scene("crank", bodies, pins, (), (), (0.0, 0.0), _standing(math.pi / 2.0), EVERYTHING)
    assert "dead point" in _obstacle(model)


@pytest.mark.parametrize("setting", list(Setting))
@pytest.mark.parametrize("drive", [Prescribed(_motion()), Free(0.0, 0.05)])
def test_a_mass_that_is_no_number_diverges(setting, drive):
    model = scene(mechanism("juki-mf7923d"), drive, EVERYTHING, start_angle=0.3)
    bodies = tuple(dataclasses.replace(body, mass=math.nan) for body in model.bodies)
    run = ENGINE.run(dataclasses.replace(model, bodies=bodies), setting)
    assert run.outcome is Outcome.DIVERGED
    assert run.reason


def test_the_adapter_knows_the_version_of_the_suite():
    assert ENGINE.name == "direct"
    assert ENGINE.version()
