"""From a layout to a pymunk space: bodies, constraints and the loads that pymunk can carry by itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from analytic.description.linkage import GROUND
from engines.pymunk_adapter.layout import Gear, Hold, PartLayout, start_turn
from engines.scene import AppliedForce, Body, PinJoint, PointSpring, Scene

if TYPE_CHECKING:
    import pymunk

Ends: TypeAlias = "Mapping[str, pymunk.Body]"

# Where a spring's far end lies, m or rad: any motion is nothing against it, so that its pull is constant to rounding.
FAR: Final = 1e15


@dataclass(frozen=True)
class Rig:
    """A scene made ready for pymunk: how it is cut into parts, and the solver's iterations per step.

    Where ``checked``, a pass whose motion is not the scene's ends the run; else only one that cannot be read out does.
    """

    scene: Scene
    layout: PartLayout
    iterations: int
    checked: bool


@dataclass(frozen=True)
class World:
    """A built space; ``bodies`` in the order of the layout's parts, ``springs`` in that of the scene's.

    ``ends`` has all bodies by name, the ground among them.
    """

    layout: PartLayout
    space: pymunk.Space
    ends: Ends
    bodies: tuple[pymunk.Body, ...]
    constraints: tuple[pymunk.Constraint, ...]
    springs: tuple[pymunk.DampedSpring, ...]

    @property
    def crank(self) -> pymunk.Body:
        """The driven body."""
        return self.bodies[self.layout.crank]

    @property
    def visits(self) -> int:
        """Constraint visits of a step: in every iteration the solver goes once through all constraints of the space."""
        return int(self.space.iterations * len(self.space.constraints))


def build_world(
    layout: PartLayout, *, iterations: int | None, error_bias: float | None, native_damping: bool = False
) -> World:
    """Build the space in the scene's start state, at rest; None leaves pymunk's default.

    No shapes, hence no collisions; gravity only where there is any. ``native_damping`` lets pymunk's own springs damp,
    which they do to first order; else dampers and dashpots are stepped beside them (see ``loads``).
    """
    import pymunk

    scene, space = layout.scene, pymunk.Space()
    if iterations is not None:
        space.iterations = iterations
    if scene.gravity != (0.0, 0.0):
        space.gravity = scene.gravity
    bodies = {body.name: _body(body) for body in scene.bodies}
    ends = bodies | {GROUND: space.static_body}
    springs = tuple(_spring(ends, spring, native_damping) for spring in scene.springs)
    constraints = tuple(_constraint(ends, layout, hold) for hold in layout.holds)
    if error_bias is not None:
        for constraint in constraints:
            constraint.error_bias = error_bias
    pushes = [_push(ends, load) for load in scene.forces if load.force.is_constant]
    dampers = [
        pymunk.DampedRotarySpring(ends[damper.first], ends[damper.second], 0.0, 0.0, damper.coefficient)
        for damper in scene.dampers
        if native_damping
    ]
    space.add(*bodies.values(), *springs, *pushes, *dampers, *constraints)
    world = World(layout, space, ends, tuple(bodies.values()), constraints, springs)
    for load in scene.torques:
        if load.torque.is_constant and load.body != GROUND:
            add_torque(world, bodies[load.body], float(load.torque.values[0]))
    return world


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


def _spring(ends: Ends, spring: PointSpring, native_damping: bool) -> pymunk.DampedSpring:
    import pymunk

    # A dashpot alone is stepped as a change of rest length, which needs some stiffness to act on.
    stiffness = spring.stiffness if native_damping else spring.stiffness or spring.damping
    return pymunk.DampedSpring(
        ends[spring.first],
        ends[spring.second],
        spring.first_anchor,
        spring.second_anchor,
        spring.length,
        stiffness,
        spring.damping if native_damping else 0.0,
    )


def _push(ends: Ends, load: AppliedForce) -> pymunk.DampedSpring:
    """A constant force, as the pull of a spring whose other end is far away: a force that is set lasts one step."""
    import pymunk

    x, y = (float(v) for v in load.force.values)
    size = math.hypot(x, y) or 1.0
    far, stiffness = (FAR * x / size, FAR * y / size), math.hypot(x, y) / FAR
    return pymunk.DampedSpring(ends[GROUND], ends[load.body], far, load.anchor, 0.0, stiffness, 0.0)


def add_torque(world: World, body: pymunk.Body, torque: float) -> None:
    """A constant torque, as that of a rotary spring wound far up."""
    import pymunk

    wound = math.copysign(FAR, torque)
    world.space.add(pymunk.DampedRotarySpring(world.space.static_body, body, -wound, abs(torque) / FAR, 0.0))


def add_motor(world: World) -> pymunk.SimpleMotor:
    """The drive of the crank; added last, so that an iteration leaves no error in the crank's speed."""
    import pymunk

    motor = pymunk.SimpleMotor(world.space.static_body, world.crank, 0.0)
    world.space.add(motor)
    return motor
