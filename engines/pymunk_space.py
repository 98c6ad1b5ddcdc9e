"""From a layout to a pymunk space: bodies, constraints and the loads that pymunk can carry by itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from analytic.linkage import GROUND, Vector
from engines.contract import Scene
from engines.pymunk_layout import STILL, Hold, Kind, Layout

if TYPE_CHECKING:
    import pymunk

# Where a spring's far end lies, m or rad: any motion is nothing against it, so that its pull is constant to rounding.
FAR: Final = 1e15


@dataclass(frozen=True)
class World:
    """A built space; ``bodies`` in the order of the layout's parts, ``springs`` in that of the scene's."""

    layout: Layout
    space: pymunk.Space
    bodies: tuple[pymunk.Body, ...]
    constraints: tuple[pymunk.Constraint, ...]
    springs: tuple[pymunk.DampedSpring, ...]

    @property
    def crank(self) -> pymunk.Body:
        """The driven body."""
        return self.bodies[self.layout.crank]

    def part(self, number: int) -> pymunk.Body:
        """Body of a part, the static body for the ground."""
        return self.space.static_body if number == STILL else self.bodies[number]


def build_world(
    scene: Scene,
    layout: Layout,
    *,
    iterations: int | None,
    error_bias: float | None,
    native_damping: bool = False,
) -> World:
    """Build the space in the scene's start state, at rest; None leaves pymunk's default.

    ``native_damping`` lets pymunk's springs damp, which they do to first order; else dashpots are stepped beside them.

    No shapes, hence no collisions. Gravity is set only where there is any.
    """
    import pymunk

    space = pymunk.Space()
    if iterations is not None:
        space.iterations = iterations
    if scene.gravity != (0.0, 0.0):
        space.gravity = scene.gravity
    bodies = tuple(_body(pymunk, scene, layout, number) for number in layout.names)
    world = World(layout, space, bodies, (), ())
    springs = tuple(_spring(pymunk, world, scene, number, native_damping) for number in range(len(scene.springs)))
    constraints = tuple(_constraint(pymunk, world, hold) for hold in layout.holds)
    if error_bias is not None:
        for constraint in constraints:
            constraint.error_bias = error_bias
    pushes = [_push(pymunk, world, scene, number) for number, f in enumerate(scene.forces) if f.force.is_constant]
    space.add(*bodies, *springs, *pushes, *constraints)
    if native_damping:
        space.add(*(_damper(pymunk, world, scene, number) for number in range(len(scene.dampers))))
    for torque in scene.torques:
        if torque.torque.is_constant and torque.body != GROUND:
            add_torque(world, world.bodies[part_number(scene, torque.body)], float(torque.torque.values[0]))
    return World(layout, space, bodies, constraints, springs)


def part_number(scene: Scene, name: str) -> int:
    """Number of the part that carries a body; STILL for the ground."""
    return STILL if name == GROUND else next(k for k, body in enumerate(scene.bodies) if body.name == name)


def carried_anchor(layout: Layout, number: int, anchor: Vector) -> Vector:
    """An anchor from the centre of the part that carries its body."""
    if number == STILL:
        return anchor
    offset = layout.parts[number].offset
    return (anchor[0] - offset[0], anchor[1] - offset[1])


def _body(pymunk: Any, scene: Scene, layout: Layout, number: int) -> pymunk.Body:
    part = layout.parts[number]
    owner = scene.bodies[part.owner]
    body = pymunk.Body(part.mass, math.inf if part.inertia is None else part.inertia)
    c, s = math.cos(owner.angle), math.sin(owner.angle)
    x, y = part.offset
    body.position = (owner.position[0] + c * x - s * y, owner.position[1] + s * x + c * y)
    body.angle = owner.angle
    return body


def _constraint(pymunk: Any, world: World, hold: Hold) -> pymunk.Constraint:
    first, second = world.part(hold.first), world.part(hold.second)
    if hold.kind is Kind.PIN:
        return pymunk.PivotJoint(first, second, hold.first_anchor, hold.second_anchor)
    if hold.kind is Kind.GEAR:
        return pymunk.GearJoint(second, first, hold.turn, 1.0)
    (x, y), (along_x, along_y), length = hold.second_anchor, hold.along, 2.0 * world.layout.reach
    start, end = (x - length * along_x, y - length * along_y), (x + length * along_x, y + length * along_y)
    return pymunk.GrooveJoint(second, first, start, end, hold.first_anchor)


def _spring(pymunk: Any, world: World, scene: Scene, number: int, native_damping: bool) -> pymunk.DampedSpring:
    spring = scene.springs[number]
    first, second = part_number(scene, spring.first), part_number(scene, spring.second)
    return pymunk.DampedSpring(
        world.part(first),
        world.part(second),
        carried_anchor(world.layout, first, spring.first_anchor),
        carried_anchor(world.layout, second, spring.second_anchor),
        spring.length,
        spring.stiffness if native_damping else spring.stiffness or spring.damping,
        spring.damping if native_damping else 0.0,
    )


def _damper(pymunk: Any, world: World, scene: Scene, number: int) -> pymunk.DampedRotarySpring:
    damper = scene.dampers[number]
    ends = (world.part(part_number(scene, name)) for name in (damper.first, damper.second))
    return pymunk.DampedRotarySpring(*ends, 0.0, 0.0, damper.coefficient)


def _push(pymunk: Any, world: World, scene: Scene, number: int) -> pymunk.DampedSpring:
    """A constant force, as the pull of a spring whose other end is far away: pymunk forgets set forces at every step."""
    load = scene.forces[number]
    x, y = (float(v) for v in load.force.values)
    size = math.hypot(x, y) or 1.0
    body = part_number(scene, load.body)
    far = (FAR * x / size, FAR * y / size)
    anchor = carried_anchor(world.layout, body, load.anchor)
    return pymunk.DampedSpring(world.space.static_body, world.part(body), far, anchor, 0.0, math.hypot(x, y) / FAR, 0.0)


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
