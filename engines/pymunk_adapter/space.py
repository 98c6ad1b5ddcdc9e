"""From a layout to a pymunk space: bodies, constraints and the loads that pymunk can carry by itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from analytic.description.linkage import GROUND, Vector
from engines.pymunk_adapter.layout import STILL, Hold, Kind, Layout
from engines.scene import AppliedForce, PointSpring, Scene, TurnDamper

if TYPE_CHECKING:
    import pymunk

# Where a spring's far end lies, m or rad: any motion is nothing against it, so that its pull is constant to rounding.
FAR: Final = 1e15


@dataclass(frozen=True)
class Rig:
    """A scene made ready for pymunk: how it is cut into parts, and the solver's iterations per step.

    Where ``checked``, a pass whose motion is not the scene's ends the run; else only one that cannot be read out does.
    """

    scene: Scene
    layout: Layout
    iterations: int
    checked: bool


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

    @property
    def visits(self) -> int:
        """Constraint visits of a step: in every iteration the solver goes once through all constraints of the space."""
        return int(self.space.iterations * len(self.space.constraints))

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

    No shapes, hence no collisions; gravity only where there is any. ``native_damping`` lets pymunk's own springs damp,
    which they do to first order; else dampers and dashpots are stepped beside them (see ``loads``).
    """
    import pymunk

    space = pymunk.Space()
    if iterations is not None:
        space.iterations = iterations
    if scene.gravity != (0.0, 0.0):
        space.gravity = scene.gravity
    bodies = tuple(_body(scene, layout, number) for number in range(len(layout.parts)))
    bare = World(layout, space, bodies, (), ())
    springs = tuple(_spring(bare, scene, spring, native_damping) for spring in scene.springs)
    constraints = tuple(_constraint(bare, hold) for hold in layout.holds)
    if error_bias is not None:
        for constraint in constraints:
            constraint.error_bias = error_bias
    pushes = [_push(bare, scene, load) for load in scene.forces if load.force.is_constant]
    dampers = [_damper(bare, scene, damper) for damper in scene.dampers if native_damping]
    space.add(*bodies, *springs, *pushes, *dampers, *constraints)
    for load in scene.torques:
        if load.torque.is_constant and load.body != GROUND:
            add_torque(bare, bodies[part_number(scene, load.body)], float(load.torque.values[0]))
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


def _body(scene: Scene, layout: Layout, number: int) -> pymunk.Body:
    import pymunk

    part = layout.parts[number]
    owner = scene.bodies[part.owner]
    body = pymunk.Body(part.mass, math.inf if part.inertia is None else part.inertia)
    c, s = math.cos(owner.angle), math.sin(owner.angle)
    x, y = part.offset
    body.position = (owner.position[0] + c * x - s * y, owner.position[1] + s * x + c * y)
    body.angle = owner.angle
    return body


def _constraint(world: World, hold: Hold) -> pymunk.Constraint:
    import pymunk

    first, second = world.part(hold.first), world.part(hold.second)
    if hold.kind is Kind.PIN:
        return pymunk.PivotJoint(first, second, hold.first_anchor, hold.second_anchor)
    if hold.kind is Kind.GEAR:
        return pymunk.GearJoint(second, first, hold.turn, 1.0)
    (x, y), (along_x, along_y), length = hold.second_anchor, hold.along, 2.0 * world.layout.reach
    start, end = (x - length * along_x, y - length * along_y), (x + length * along_x, y + length * along_y)
    return pymunk.GrooveJoint(second, first, start, end, hold.first_anchor)


def _spring(world: World, scene: Scene, spring: PointSpring, native_damping: bool) -> pymunk.DampedSpring:
    import pymunk

    first, second = part_number(scene, spring.first), part_number(scene, spring.second)
    # A dashpot alone is stepped as a change of rest length, which needs some stiffness to act on.
    stiffness = spring.stiffness if native_damping else spring.stiffness or spring.damping
    return pymunk.DampedSpring(
        world.part(first),
        world.part(second),
        carried_anchor(world.layout, first, spring.first_anchor),
        carried_anchor(world.layout, second, spring.second_anchor),
        spring.length,
        stiffness,
        spring.damping if native_damping else 0.0,
    )


def _damper(world: World, scene: Scene, damper: TurnDamper) -> pymunk.DampedRotarySpring:
    import pymunk

    ends = (world.part(part_number(scene, name)) for name in (damper.first, damper.second))
    return pymunk.DampedRotarySpring(*ends, 0.0, 0.0, damper.coefficient)


def _push(world: World, scene: Scene, load: AppliedForce) -> pymunk.DampedSpring:
    """A constant force, as the pull of a spring whose other end is far away: a force that is set lasts one step."""
    import pymunk

    x, y = (float(v) for v in load.force.values)
    size = math.hypot(x, y) or 1.0
    number = part_number(scene, load.body)
    ends = (FAR * x / size, FAR * y / size), carried_anchor(world.layout, number, load.anchor)
    return pymunk.DampedSpring(world.space.static_body, world.part(number), *ends, 0.0, math.hypot(x, y) / FAR, 0.0)


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
