"""Putting a state back on the joints: exudyn's own constraint equations against the closed form."""

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.start_state import scene
from engines.exudyn_adapter.model import Model
from engines.exudyn_adapter.projection import Constraints, projected_state
from engines.exudyn_adapter.readout import add_sensors
from engines.exudyn_adapter.recipes import TRAPEZOIDAL, Recipe
from engines.exudyn_adapter.stepping import Stepper
from engines.scene import Channel, Prescribed
from engines.stepping.cost import Cost
from engines.stepping.own_units import own_units, scaled
from tests.analytic.linkages import mechanism
from tests.engines.newton_euler import true_motion

exudyn = pytest.importorskip("exudyn")

EXACT = 1e-11  # of the largest coordinate, velocity or acceleration
OFF = 1e-3  # of the unit of length and rad that a state is moved off the joints

NAMES = ["juki-mf7923d", "rimoldi-164", "slotted-takeup", "carried-slider", "moving-guides", "scotch-yoke"]


def _stepper(name, motion):
    wanted = scene(mechanism(name), Prescribed(motion), set(Channel))
    units = own_units(wanted)
    model = Model(scaled(wanted, units))
    stepper = Stepper(model, add_sensors(model), Cost(), checked=True)
    model.mbs.Assemble()
    stepper.prepare(Recipe(rule=TRAPEZOIDAL, step=1e-3))
    return stepper, units


def _true_coordinates(name, motion, stepper, units, time):
    """Displacements from the start and their derivatives in exudyn's order, in the model's units."""
    turning = [body.name in stepper.model.turning for body in stepper.scene.bodies]
    kept = np.array([(True, True, turns) for turns in turning])
    unit = np.array([units.length, units.length, 1.0])
    states = [part / unit for part in true_motion(mechanism(name), motion, np.array([0.0, time]))]
    return (states[0][1] - states[0][0])[kept], states[1][1][kept], states[2][1][kept]


def _meaningful(stepper):
    """Coordinates but the angles of bodies without inertia, which may be anything."""
    bodies = stepper.scene.bodies
    kept = [[True, True] + [b.inertia is not None] * (b.name in stepper.model.turning) for b in bodies]
    return np.array([flag for flags in kept for flag in flags])


def _use(stepper, segment):
    functions = stepper._functions[segment.start]
    for name, function in zip(("offsetUserFunction", "offsetUserFunction_t"), functions, strict=True):
        stepper.model.mbs.SetObjectParameter(stepper.model.driver, name, function)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("part", [0, 1])
def test_a_state_near_the_joints_becomes_the_closed_forms(name, part):
    motion = crank_motion("run-up", ramp_time=0.15, hold_time=0.05, start_angle=0.3)
    segment = motion.segments[part]
    time = segment.start if part else 0.11  # the second begins with a jump of the acceleration, which is then 0
    stepper, units = _stepper(name, motion)
    _use(stepper, segment)
    truth = _true_coordinates(name, motion, stepper, units, time)
    moved = truth[0] + OFF * np.random.default_rng(1).uniform(-1.0, 1.0, len(truth[0]))
    found = projected_state(Constraints(stepper.model), moved, time, motion.peak_speed, strict=True)
    assert found is not None
    moving = _meaningful(stepper)
    for got, wanted in zip((found.position, found.velocity, found.acceleration), truth, strict=True):
        assert np.abs(got - wanted)[moving].max() <= EXACT * max(1.0, np.abs(wanted).max())


def test_no_state_is_found_where_none_is_near():
    motion = crank_motion("run-up", ramp_time=0.15, start_angle=0.3)
    stepper, units = _stepper("rimoldi-164", motion)
    _use(stepper, motion.segments[0])
    truth = _true_coordinates("rimoldi-164", motion, stepper, units, 0.1)[0]
    far = truth + np.random.default_rng(2).uniform(-2.0, 2.0, len(truth))
    assert projected_state(Constraints(stepper.model), far, 0.1, motion.peak_speed, strict=True) is None


def test_the_two_assembly_modes_have_two_sides():
    motion = crank_motion("run-up", ramp_time=0.15, start_angle=0.3)
    stepper, _ = _stepper("rimoldi-164", motion)
    _use(stepper, motion.segments[0])
    constraints = Constraints(stepper.model)
    start = np.zeros(constraints.size)
    rng, sides = np.random.default_rng(3), {constraints.side(start, 0.0)}
    for _ in range(200):
        q = start + rng.uniform(-3.0, 3.0, len(start))
        found = projected_state(constraints, q, 0.0, motion.peak_speed, strict=False)
        if found is not None:
            sides.add(found.side)
    assert sides == {-1.0, 1.0}
