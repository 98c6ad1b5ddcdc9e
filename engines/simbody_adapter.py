"""Simbody, through OpenSim's Python package, behind the contract.

Pins and slider joints carry the bodies in a tree; the joints that close its loops are constraints, onto which Simbody
projects positions and velocities. The crank's coordinate is prescribed as a polynomial of time, a segment of the motion
at a time, so that OpenSim's clock starts anew with every segment.

After a step that misses the joints by more than the square root of their tolerance, Simbody's Runge-Kutta methods leave
the projection out, and in steps of fixed length do so silently. So a step is at most as long as a recipe says, and
Simbody divides it where it must; only the methods for study keep it fixed.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Vector
from engines.contract import Abilities, Array, History, ReadOut, Setting, Signal
from engines.mechanics.spanning_tree import Branch, anchors, spanning_tree
from engines.scene import GUIDES, LOADS, Body, Channel, Free, PinJoint, Prescribed, Scene, SliderJoint, SlotJoint
from engines.stepping.driver import DivergedError, UnsupportedError
from engines.stepping.histories import joined
from engines.stepping.intervals import Interval
from engines.stepping.stepped_engine import Course, Recipe, SteppedEngine

KINEMATICS = {
    Channel.POSITION: ("getPositionInGround", "getValue"),
    Channel.VELOCITY: ("getLinearVelocityInGround", "getSpeedValue"),
    Channel.ACCELERATION: ("getLinearAccelerationInGround", "getAccelerationValue"),
}
REACTION = "Joint.calcReactionOnParentExpressedInGround"
AT_REST = Body(GROUND, 0.0, None, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0)


@dataclass(frozen=True, kw_only=True)
class SimbodyRecipe(Recipe):
    """A recipe whose ``effort`` is the tolerance of the joints; its steps may be divided unless they are ``fixed``."""

    method: str = "RungeKuttaMerson"
    fixed: bool = False


# What a driven linkage does follows from its joints, to their tolerance. Catalogue, quintic run-up, largest Mkr at 120
# steps per turn: tolerance 1e-8 1e-7, 1e-10 4e-10, 1e-12 1e-12, 1e-13 1e-14, each in 0.2 to 0.4 s; 60 steps or 240
# change nothing. Every projection changes a free crank's energy. Slotted take-up driven for 10 s, φ at 100, 200, 300
# steps per turn: tolerance 1e-12 2.9e-4, 5.7e-6, 4e-7 rad; 1e-6 3.0e-5, 3.4e-7, 3.8e-8 rad in 3.0, 5.6, 8.1 s.
NAIVE = SimbodyRecipe(steps_per_turn=120, in_own_units=False)
DRIVEN = SimbodyRecipe(steps_per_turn=120, effort=1e-12)
FREE = SimbodyRecipe(steps_per_turn=100, ratios=(2,), effort=1e-6)
FIXED = replace(DRIVEN, fixed=True)


@dataclass
class World:
    """An OpenSim model and what is read from it in a state.

    By body: its frame, at the mass centre and parallel to the scene's; the body as that frame starts; the bodies from
    it to the ground; the coordinates that turn it. ``links`` are the tree's joints, the crank's first. ``forces`` act
    on the joints' first bodies. ``loads`` take three functions of time each.
    """

    model: Any
    frames: dict[str, Any]
    start: dict[str, Body] = field(default_factory=lambda: {GROUND: AT_REST})
    chains: dict[str, list[str]] = field(default_factory=lambda: {GROUND: [GROUND]})
    turning: dict[str, list[Any]] = field(default_factory=lambda: {GROUND: []})
    links: list[Any] = field(default_factory=list)
    forces: dict[str, Callable[[Any], Vector]] = field(default_factory=dict)
    loads: list[tuple[Callable[..., None], Law]] = field(default_factory=list)
    readers: dict[Channel, Callable[[Any], Any]] = field(default_factory=dict)

    def carry(self, branch: Branch) -> None:
        """Put a body on its parent."""
        osim, number = _opensim(), len(self.frames)
        body, joint, parent = branch.body, branch.joint, self.start[branch.parent]
        if joint is None:
            raise UnsupportedError(f"only slots hold body '{body.name}', and no pin or slider carries it")
        frame = osim.Body(f"body{number}", body.mass, _vector(), osim.Inertia(*[body.inertia or 0.0] * 3))
        self.model.addBody(frame)
        points = anchors(joint) if branch.reverse else anchors(joint)[::-1]  # the parent's and the body's
        kind, tilts = osim.PinJoint, (0.0, 0.0)
        value, speed = body.angle - parent.angle, body.angular_velocity - parent.angular_velocity
        if isinstance(joint, SliderJoint):
            kind = osim.SliderJoint  # along the first axis of both its frames
            along = complex(*joint.along) * cmath.rect(1.0, (body if branch.reverse else parent).angle)
            tilts = cmath.phase(along) - parent.angle, cmath.phase(along) - body.angle
            ends = zip(_moving(parent, points[0]), _moving(body, points[1]), strict=True)
            value, speed = (((own - other) * along.conjugate()).real / abs(along) for other, own in ends)
        elif body.inertia is None:  # a mass on its pin: without an inertia it cannot be left to turn
            kind, tilts = osim.WeldJoint, (value, 0.0)
            body = replace(body, angular_velocity=parent.angular_velocity)
        sides = [(_vector(*point), _vector(0.0, 0.0, tilt)) for point, tilt in zip(points, tilts, strict=True)]
        link = kind(f"joint{number}", self.frames[branch.parent], *sides[0], frame, *sides[1])
        self.model.addJoint(link)
        for coordinate in _coordinates(link):
            coordinate.setDefaultValue(value)
            coordinate.setDefaultSpeedValue(speed)
        self.links.append(link)
        self.frames[body.name], self.start[body.name] = frame, body
        self.chains[body.name] = [body.name, *self.chains[branch.parent]]
        self.turning[body.name] = self.turning[branch.parent] + (_coordinates(link) if kind is osim.PinJoint else [])
        reaction, sign = link.calcReactionOnParentExpressedInGround, 1.0 if branch.reverse else -1.0
        self.forces[joint.name] = lambda state: _plane(reaction(state).get(1), sign)

    def close(self, cut: PinJoint | SliderJoint | SlotJoint) -> None:
        """Hold a joint that closes a loop as a constraint."""
        if isinstance(cut, SliderJoint):
            raise UnsupportedError(f"sliders alone form a loop with '{cut.name}', and no constraint is a slider")
        osim, places = _opensim(), [_vector(*anchor) for anchor in anchors(cut)]
        ends = (cut.first, cut.second) if isinstance(cut, PinJoint) else (cut.body, cut.host)
        first, second = (self.frames[end] for end in ends)
        if isinstance(cut, PinJoint):
            row, constraint = 0, osim.PointConstraint(first, places[0], second, places[1])
        else:  # the first rows are the line's
            row, constraint = 6, osim.PointOnLineConstraint(second, _vector(*cut.along), places[1], first, places[0])
        constraint.setName(f"cut{len(self.forces)}")
        self.model.addConstraint(constraint)
        # It tells minus its forces, in the axes of the nearest body that carries both ends.
        carrier = self.frames[next(name for name in self.chains[ends[0]] if name in self.chains[ends[1]])]

        def force(state: Any) -> Vector:  # noqa: ANN401
            values = constraint.getRecordValues(state)
            return _plane(carrier.expressVectorInGround(state, _vector(values.get(row), values.get(row + 1))), -1.0)

        self.forces[cut.name] = force

    def push(self, body: str, law: Law, anchor: Vector = (0.0, 0.0)) -> None:
        """A force on a point of a body, or a torque if the law has one component."""
        osim = _opensim()
        load = osim.PrescribedForce(f"load{len(self.loads)}", self.frames[body])
        load.set_forceIsGlobal(True)
        load.setPointFunctions(*(osim.Constant(float(place)) for place in (*anchor, 0.0)))
        self.model.addForce(load)
        self.loads.append((load.setForceFunctions if len(law.values.T) > 1 else load.setTorqueFunctions, law))

    def kinematics(self, bodies: Sequence[Body], channel: Channel) -> Callable[[Any], list[tuple[float, ...]]]:
        """What reads a channel of bodies; an angle is a sum of coordinates, and so unwrapped."""
        place, rate = KINEMATICS[channel]
        sources = []
        for body in bodies:
            turns = self.turning[body.name] if body.inertia is not None else []
            offset = body.angle - sum(turn.getDefaultValue() for turn in turns) if channel is Channel.POSITION else 0.0
            sources.append((getattr(self.frames[body.name], place), [getattr(turn, rate) for turn in turns], offset))
        return lambda state: [(*_plane(at(state)), sum((turn(state) for turn in by), base)) for at, by, base in sources]


class SimbodyEngine(SteppedEngine[World, SimbodyRecipe]):
    """OpenSim's default integrator, with a tolerance of the joints of its own for each kind of drive."""

    name = "simbody"
    package = "opensim"
    oldest = "4.6"
    effort_unit = "tolerance of the joints"
    abilities = Abilities(
        readouts={
            **{channel: ReadOut(f"Frame.{place}, Coordinate.{turn}") for channel, (place, turn) in KINEMATICS.items()},
            Channel.TORQUE: ReadOut(f"{REACTION}, moment at the crank's pin", drive="the drive's alone"),
            Channel.JOINT_FORCE: ReadOut(f"{REACTION}, force; Constraint.getRecordValues where a joint closes a loop"),
        },
        drives=frozenset({Prescribed, Free}),
        joints=GUIDES,
        loads=LOADS,
        massless=False,
    )
    settings: Mapping[type, Mapping[Setting, SimbodyRecipe]] = {
        Prescribed: dict(zip(Setting, (NAIVE, DRIVEN, replace(DRIVEN, effort=1e-13)), strict=True)),
        Free: dict(zip(Setting, (NAIVE, FREE, replace(FREE, ratios=(4,), effort=1e-9)), strict=True)),
    }
    studied: Mapping[str, tuple[str, SimbodyRecipe]] = {
        "defaults": ("Runge-Kutta-Merson, all else as OpenSim has it", replace(NAIVE, fixed=True)),
        "merson": ("Runge-Kutta-Merson, projected onto the joints", FIXED),
        "semi-explicit": ("two semi-explicit Euler half steps, projected", replace(FIXED, method="SemiExplicitEuler2")),
    }

    def refusal(self, scene: Scene) -> str | None:
        """Loads over the crank angle become tables over time, which a free crank does not have."""
        laws = [load.force for load in scene.forces] + [load.torque for load in scene.torques]
        if isinstance(scene.drive, Prescribed) or all(law.is_constant for law in laws):
            return None
        return "its forces follow time, so that a free crank can have none that changes with its angle"

    def build(self, scene: Scene, recipe: SimbodyRecipe) -> World:
        """Loads and drive have no functions yet: those of each part of the motion are given to them in turn."""
        osim, tree = _opensim(), spanning_tree(scene)
        model = osim.Model()
        model.setGravity(_vector(*scene.gravity))
        frames = {GROUND: model.getGround()}
        world = World(model, frames)
        for branch in tree.branches:
            world.carry(branch)
        for cut in tree.cuts:
            world.close(cut)
        for spring in scene.springs:
            law = f"{spring.stiffness:.17g} * (d - {spring.length:.17g}) + {spring.damping:.17g} * ddot"
            first = frames[spring.first].getName(), _vector(*spring.first_anchor)
            second = frames[spring.second].getName(), _vector(*spring.second_anchor)
            model.addForce(osim.ExpressionBasedPointToPointForce(*first, *second, law))
        for number, damper in enumerate(scene.dampers):
            ends, drag = (frames[damper.first], frames[damper.second]), _vector(0.0, 0.0, damper.coefficient)
            model.addForce(osim.BushingForce(f"damper{number}", *ends, _vector(), _vector(), _vector(), drag))
        for force in scene.forces:
            world.push(force.body, force.force, force.anchor)
        for torque in scene.torques:
            world.push(torque.body, torque.torque)
        if isinstance(scene.drive, Free):
            world.push(scene.crank, Law(np.array([scene.drive.torque])))
        model.finalizeConnections()
        reaction = world.links[0].calcReactionOnParentExpressedInGround
        world.readers = {channel: world.kinematics(scene.bodies, channel) for channel in KINEMATICS}
        world.readers[Channel.TORQUE] = lambda state: -reaction(state).get(0).get(2)
        world.readers[Channel.JOINT_FORCE] = lambda state: [force(state) for force in world.forces.values()]
        return world

    def follow(self, world: World, course: Course[SimbodyRecipe]) -> History:
        """Part by part; the sample between two parts is the later one's."""
        return joined([_followed(world, course, part) for part in course.parts])


@cache
def _opensim() -> Any:  # noqa: ANN401 - a module without types
    import opensim

    opensim.Logger.setLevelString("Off")  # or it prints, and leaves a log file
    return opensim


def _vector(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:  # noqa: ANN401
    return _opensim().Vec3(float(x), float(y), float(z))


def _plane(vector: Any, factor: float = 1.0) -> Vector:  # noqa: ANN401
    return factor * vector.get(0), factor * vector.get(1)


def _moving(body: Body, anchor: Vector) -> tuple[complex, complex]:
    """Position and velocity of a point of a body at the start."""
    arm = complex(*anchor) * cmath.rect(1.0, body.angle)
    return complex(*body.position) + arm, complex(*body.velocity) + 1j * body.angular_velocity * arm


def _coordinates(link: Any) -> list[Any]:  # noqa: ANN401
    return [link.updCoordinate()] if link.numCoordinates() else []


def _functions(law: Law, time: Array, angle: Array) -> list[Any]:
    """Three functions of time: a force's components, or a torque's, of which there is the third alone."""
    osim, components = _opensim(), law(angle)
    functions = [osim.Constant(0.0) for _ in range(3)]
    for axis, values in enumerate(components, start=0 if len(components) > 1 else 2):
        functions[axis] = osim.Constant(float(values[0])) if law.is_constant else osim.SimmSpline()
        for point in () if law.is_constant else zip(time.tolist(), values.tolist(), strict=True):
            functions[axis].addPoint(*point)
    return functions


def _followed(world: World, course: Course[SimbodyRecipe], part: Interval) -> History:
    osim, model, recipe, segment = _opensim(), world.model, course.recipe, part.segment
    begin = segment.start if segment else 0.0
    time = np.linspace(part.start, part.end, part.samples + 1)
    if segment:
        (crank,) = _coordinates(world.links[0])
        highest_first = osim.Vector.createFromMat(np.array(segment.coefficients[::-1]))
        crank.setPrescribedFunction(osim.PolynomialFunction(highest_first))
        crank.setDefaultIsPrescribed(True)
    for apply, law in world.loads:
        apply(*_functions(law, time - begin, segment.value(time) if segment else time))
    state = model.initSystem()
    state.setTime(part.start - begin)
    manager = osim.Manager(model)
    manager.setIntegratorMethod(getattr(manager, f"IntegratorMethod_{recipe.method}"))
    manager.setWriteToStorage(False)
    if recipe.effort is not None:
        manager.setIntegratorConstraintTolerance(recipe.effort)
    set_step = manager.setIntegratorFixedStepSize if recipe.fixed else manager.setIntegratorMaximumStepSize
    set_step(part.step / course.ratio)
    readers = {channel: world.readers[channel] for channel in course.channels}
    samples: list[list[Any]] = []
    try:
        manager.initialize(state)
        state = manager.getState()
        for instant in (time - begin).tolist():
            if samples:
                manager.setIntegratorFinalTime(instant)  # or it steps beyond and interpolates
                state = manager.integrate(instant)
            model.realizeAcceleration(state)
            samples.append([read(state) for read in readers.values()])
    except RuntimeError as error:
        raise DivergedError(f"Simbody gave up: {str(error).splitlines()[-1].strip()}") from error
    for coordinate in [own for link in world.links for own in _coordinates(link)]:  # where the next part begins
        coordinate.setDefaultValue(coordinate.getValue(state))
        coordinate.setDefaultSpeedValue(coordinate.getSpeedValue(state))
    kept = slice(None if part is course.parts[-1] else -1)
    values = {channel: np.array(column)[kept] for channel, *column in zip(readers, *samples, strict=True)}
    forces = values.pop(Channel.JOINT_FORCE, None)
    named = {} if forces is None else {name: Signal(time[kept], forces[:, n]) for n, name in enumerate(world.forces)}
    return History(**{channel: Signal(time[kept], each) for channel, each in values.items()}, joint_force=named)
