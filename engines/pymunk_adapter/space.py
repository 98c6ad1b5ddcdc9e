"""From a layout to a pymunk space: bodies, constraints and the loads that pymunk can carry by itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion
from analytic.description.linkage import GROUND, DriverKind
from engines.pymunk_adapter.layout import Gear, Hold, PartLayout, start_turn
from engines.pymunk_adapter.linear_drive import Line, line_of
from engines.pymunk_adapter.solver import ANGLES
from engines.scene import AppliedForce, Body, PinJoint, PointSpring, Prescribed, Scene

if TYPE_CHECKING:
    import pymunk

Ends: TypeAlias = "Mapping[str, pymunk.Body]"

# Where a spring's far end lies, m or rad: any motion is nothing against it, so that its pull is constant to rounding.
FAR: Final = 1e15

SHORTEST: Final = 0.01  # of the scene's reach: the lever of a linear drive


@dataclass(frozen=True)
class PymunkWorld:
    """A built space; ``bodies`` in the order of the layout's parts, ``springs`` in that of the scene's.

    ``ends`` has all bodies by name, the ground among them; ``constraints`` are in the order of the layout's holds.
    ``motor`` drives the crank against a torque of ``offset``, N m, that keeps the sign of what it exerts; that of a
    linear drive is between the ends of its ``line``, against such a force.
    ``iterations`` (ANGLES + 1,) are those at even crank angles from the start on (see ``solver.way``).
    """

    layout: PartLayout
    space: pymunk.Space
    ends: Ends
    bodies: tuple[pymunk.Body, ...]
    constraints: tuple[pymunk.Constraint, ...]
    springs: tuple[pymunk.DampedSpring, ...]
    motor: pymunk.SimpleMotor | pymunk.PinJoint | None
    offset: float
    iterations: NDArray[np.float64]
    line: Line | None = None

    @property
    def crank(self) -> pymunk.Body:
        """The driven body."""
        return self.ends[self.layout.scene.crank]

    def travel(self, ahead: float) -> float:
        """φ ``ahead`` seconds from now at the present velocities, rad or m."""
        if self.line is not None:
            return self.line.travel(ahead)
        return float(self.crank.angle + ahead * self.crank.angular_velocity)


def build_world(layout: PartLayout, *, plain: bool) -> PymunkWorld:
    """Build the space in the scene's start state, with the drive on the crank and as many iterations as pymunk has.

    No shapes, hence no collisions; gravity only where there is any. Where ``plain``, everything is as pymunk has it:
    its own springs damp, to first order; else dampers and dashpots are stepped beside them (see ``loads``), joints are
    unbiased, and the motor's torque has an offset.
    """
    import pymunk

    scene, space = layout.scene, pymunk.Space()
    if scene.gravity != (0.0, 0.0):
        space.gravity = scene.gravity
    bodies = {body.name: _body(body) for body in scene.bodies}
    ends = bodies | {GROUND: space.static_body}
    springs = tuple(_spring(ends, spring, plain) for spring in scene.springs)
    constraints = tuple(_constraint(ends, layout, hold) for hold in layout.holds)
    for constraint in () if plain else constraints:
        constraint.error_bias = 0.0
    pushes = [_push(ends, load) for load in scene.forces if load.force.is_constant]
    dampers = [
        pymunk.DampedRotarySpring(ends[damper.first], ends[damper.second], 0.0, 0.0, damper.coefficient)
        for damper in scene.dampers
        if plain
    ]
    space.add(*bodies.values(), *springs, *pushes, *dampers, *constraints)
    for load in scene.torques:
        if load.torque.is_constant and load.body != GROUND:
            _add_torque(space, bodies[load.body], float(load.torque.values[0]))
    motor, offset, line = None, 0.0, None
    if scene.driver_kind is not DriverKind.CRANK:
        line = line_of(scene, ends, layout.reach)
    if isinstance(scene.drive, Prescribed):
        offset = 0.0 if plain else torque_bound(scene, layout, scene.drive.motion)
        motor = line.pin() if line else pymunk.SimpleMotor(space.static_body, bodies[scene.crank], 0.0)
    constant = offset if isinstance(scene.drive, Prescribed) else scene.drive.torque
    if line is None:
        _add_torque(space, bodies[scene.crank], constant)
    elif constant:
        space.add(line.push(constant))
    if motor is not None:
        space.add(motor)  # last, so that an iteration leaves no error in the crank's speed
    iterations = np.full(ANGLES + 1, float(space.iterations))
    return PymunkWorld(
        layout, space, ends, tuple(bodies.values()), constraints, springs, motor, offset, iterations, line
    )


def torque_bound(scene: Scene, layout: PartLayout, motion: CrankMotion) -> float:
    """A torque well above any that the drive can need, N m: all mass at the scene's size, at the peak of the motion.

    Of a linear drive it is a force, N, at a lever of a hundredth of that size.
    """
    times, turns = np.linspace(0.0, motion.duration, 101), scene.driver_kind is DriverKind.CRANK
    size = layout.reach
    arm = 1.0 if turns else SHORTEST * size
    rate = float(np.max(np.abs(motion.acceleration(times)))) / arm + (motion.peak_speed / arm) ** 2
    weight = sum(part.mass for part in layout.parts)
    bound = rate * (weight * size**2 + sum(part.inertia or 0.0 for part in layout.parts))
    bound += weight * math.hypot(*scene.gravity) * size
    bound += sum(float(np.max(np.abs(load.force.values))) for load in scene.forces) * size
    bound += sum(float(np.max(np.abs(load.torque.values))) for load in scene.torques)
    bound += sum(damper.coefficient for damper in scene.dampers) * motion.peak_speed / arm
    bound += sum(spring.stiffness + spring.damping * motion.peak_speed / arm for spring in scene.springs) * size**2
    return bound / arm


def _body(part: Body) -> pymunk.Body:
    import pymunk

    body = pymunk.Body(part.mass, math.inf if part.inertia is None else part.inertia)
    body.position, body.angle = part.position, part.angle
    return body


def _constraint(ends: Ends, layout: PartLayout, hold: Hold) -> pymunk.Constraint:
    import pymunk

    if isinstance(hold, PinJoint):
        return pymunk.PivotJoint(ends[hold.first], ends[hold.second], hold.first_anchor, hold.second_anchor)
    if isinstance(hold, Gear):
        return pymunk.GearJoint(ends[hold.host], ends[hold.body], start_turn(layout.scene, hold), 1.0)
    (x, y), (along_x, along_y), length = hold.through, hold.along, 2.0 * layout.reach
    start, end = (x - length * along_x, y - length * along_y), (x + length * along_x, y + length * along_y)
    return pymunk.GrooveJoint(ends[hold.host], ends[hold.body], start, end, hold.anchor)


def _spring(ends: Ends, spring: PointSpring, plain: bool) -> pymunk.DampedSpring:
    import pymunk

    # A dashpot alone is stepped as a change of rest length, which needs some stiffness to act on.
    stiffness = spring.stiffness if plain else spring.stiffness or spring.damping
    return pymunk.DampedSpring(
        ends[spring.first],
        ends[spring.second],
        spring.first_anchor,
        spring.second_anchor,
        spring.length,
        stiffness,
        spring.damping if plain else 0.0,
    )


def _push(ends: Ends, load: AppliedForce) -> pymunk.DampedSpring:
    """A constant force, as the pull of a spring whose other end is far away: a force that is set lasts one step."""
    import pymunk

    x, y = (float(v) for v in load.force.values)
    size = math.hypot(x, y) or 1.0
    far, stiffness = (FAR * x / size, FAR * y / size), math.hypot(x, y) / FAR
    return pymunk.DampedSpring(ends[GROUND], ends[load.body], far, load.anchor, 0.0, stiffness, 0.0)


def _add_torque(space: pymunk.Space, body: pymunk.Body, torque: float) -> None:
    """A constant torque, as that of a rotary spring wound far up."""
    import pymunk

    if torque:
        wound = math.copysign(FAR, torque)
        space.add(pymunk.DampedRotarySpring(space.static_body, body, -wound, abs(torque) / FAR, 0.0))
