"""Simbody, through OpenSim's Python package, behind the contract.

Pins and slider joints carry the bodies in a tree; the joints that close its loops are constraints, onto which Simbody
projects positions and velocities. The coordinate of the crank, of the driven slider or of a slide between a cylinder's
barrel and rod, which have next to no mass, is prescribed as a polynomial of time, a segment of the motion at a time, so
that OpenSim's clock starts anew with every segment.

After a step that misses the joints by more than the square root of their tolerance, Simbody's Runge-Kutta methods leave
the projection out, and in steps of fixed length do so silently. So a step is at most as long as a recipe says, and
Simbody divides it where it must; only the methods for study keep it fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any

import numpy as np

from analytic.description.law import Law, TimeLaw
from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.contract import Abilities, Array, History, ReadOut, Setting
from engines.mechanics.cylinder_links import cylinder_as_links
from engines.mechanics.driver import across_guide
from engines.mechanics.spanning_tree import Branch, SpanningTree, anchors, ends, spanning_tree
from engines.scene import GUIDES, LOADS, Body, Channel, Free, PinJoint, Prescribed, Scene, SliderJoint, SlotJoint
from engines.stepping.driver import DivergedError
from engines.stepping.intervals import Interval
from engines.stepping.recording import State, recorded
from engines.stepping.stepped_engine import Course, Recipe, SteppedEngine

KINEMATICS = {
    Channel.POSITION: ("getPositionInGround", "getValue"),
    Channel.VELOCITY: ("getLinearVelocityInGround", "getSpeedValue"),
    Channel.ACCELERATION: ("getLinearAccelerationInGround", "getAccelerationValue"),
}
READOUTS = {
    **{channel: ReadOut(f"Frame.{place}, Coordinate.{turn}") for channel, (place, turn) in KINEMATICS.items()},
    Channel.TORQUE: ReadOut(
        "Joint.calcReactionOnParentExpressedInGround, moment, or force along the driven slide",
        drive="the drive's alone",
    ),
    Channel.JOINT_FORCE: ReadOut(
        "Joint.calcReactionOnParentExpressedInGround, Constraint.getRecordValues",
        drive="a slider's, along its guide, is taken out",
    ),
}


@dataclass(frozen=True, kw_only=True)
class SimbodyRecipe(Recipe):
    """A recipe whose ``effort`` is the tolerance of the joints; its steps may be divided unless they are ``fixed``."""

    at_kinks: bool = True
    fixed: bool = False


# What a driven linkage does follows from its joints, to their tolerance. Catalogue, quintic run-up, largest Mkr at 120
# steps per turn: tolerance 1e-8 1e-7, 1e-10 4e-10, 1e-12 1e-12, 1e-13 1e-14, each in 0.2 to 0.4 s; 60 or 240 steps
# are no better. Every projection changes a free crank's energy. Slotted take-up driven for 10 s, φ at 100, 200, 300
# steps per turn: tolerance 1e-12 2.9e-4, 5.7e-6, 4e-7 rad; 1e-6 3.0e-5, 3.4e-7, 3.8e-8 rad in 3.0, 5.6, 8.1 s.
LIGHT = 1e-6  # of the lightest body, a barrel's or rod's mass; at 1e-9 their rounding shakes what they are pinned to
RAPID = 1e3  # rad/s: a crank's speed beyond which the tolerance grows with it
NAIVE = SimbodyRecipe(steps_per_turn=120, in_own_units=False)
DRIVEN = SimbodyRecipe(steps_per_turn=120, effort=1e-12)
FREE = SimbodyRecipe(steps_per_turn=100, ratios=(2,), effort=1e-6)


@dataclass
class SimbodyWorld:
    """An OpenSim model and what is read from it in a state.

    By body: its frame, at the mass centre and parallel to the scene's, and the coordinates that turn it. ``forces`` act
    on the joints' first bodies. ``loads`` take three functions of time each. ``readers`` give what a history has. The
    body ``driven`` has the coordinate ``driver``.
    """

    model: Any
    frames: dict[str, Any]
    driven: str
    driver: Any = None
    turning: dict[str, list[Any]] = field(default_factory=lambda: {GROUND: []})
    forces: dict[str, Callable[[Any], Any]] = field(default_factory=dict)
    loads: list[tuple[Callable[..., None], Law | TimeLaw]] = field(default_factory=list)
    readers: dict[Channel, Callable[[Any], Any]] = field(default_factory=dict)

    def carry(self, branch: Branch) -> None:
        """Put a body on its parent."""
        osim, body, joint = _opensim(), branch.body, branch.joint
        assert joint is not None  # or it is refused
        frame = osim.Body(f"body{len(self.frames)}", body.mass, _vector(), osim.Inertia(*[body.inertia or 0.0] * 3))
        self.model.addBody(frame)
        sides = zip(branch.points, branch.tilts, strict=True)
        parent, child = ((_vector(*point), _vector(0.0, 0.0, tilt)) for point, tilt in sides)
        slides = isinstance(joint, SliderJoint)  # along the first axis of both its frames
        kind = osim.SliderJoint if slides else osim.WeldJoint if branch.rigid else osim.PinJoint
        link = kind(f"joint{len(self.frames)}", self.frames[branch.parent], *parent, frame, *child)
        self.model.addJoint(link)
        moving = [] if branch.rigid else [link.updCoordinate()]
        for coordinate in moving:
            coordinate.setDefaultValue(branch.value)
            coordinate.setDefaultSpeedValue(branch.speed)
        self.frames[body.name] = frame
        self.turning[body.name] = self.turning[branch.parent] + ([] if slides else moving)
        reaction, sign = link.calcReactionOnParentExpressedInGround, 1.0 if branch.reverse else -1.0
        self.forces[joint.name] = lambda state: _plane(reaction(state).get(1), sign)
        if body.name == self.driven:
            self.read_drive(branch, link)

    def read_drive(self, branch: Branch, link: Any) -> None:  # noqa: ANN401
        """What the joint of the driven body takes up is the drive's if it is a moment or a force along a slide."""
        joint, reaction, host = branch.joint, link.calcReactionOnParentExpressedInGround, self.frames[branch.parent]
        self.driver = link.updCoordinate()
        self.readers[Channel.TORQUE] = lambda state: -reaction(state).get(0).get(2)
        if isinstance(joint, SliderJoint):
            line, whole = _vector(*joint.along), self.forces[joint.name]
            self.readers[Channel.TORQUE] = lambda state: float(
                np.dot(whole(state), _plane(host.expressVectorInGround(state, line)))
            )
            self.forces[joint.name] = lambda state: across_guide(joint, np.array(whole(state)))

    def close(self, cut: PinJoint | SliderJoint | SlotJoint, carrier: str) -> None:
        """Hold a joint that closes a loop as a constraint; it tells minus its forces in the axes of the ``carrier``."""
        osim, (on_first, on_second) = _opensim(), (_vector(*anchor) for anchor in anchors(cut))
        if isinstance(cut, PinJoint):
            first, second = self.frames[cut.first], self.frames[cut.second]
            constraint, row = osim.PointConstraint(first, on_first, second, on_second), 0
        else:  # the first rows are the line's
            line = self.frames[cut.host], _vector(*cut.along), on_second
            constraint, row = osim.PointOnLineConstraint(*line, self.frames[cut.body], on_first), 6
        self.model.addConstraint(constraint)

        def force(state: Any) -> Vector:  # noqa: ANN401
            taken_up = _vector(*map(constraint.getRecordValues(state).get, (row, row + 1)))
            return _plane(self.frames[carrier].expressVectorInGround(state, taken_up), -1.0)

        self.forces[cut.name] = force

    def push(self, body: str, law: Law | TimeLaw, anchor: Vector = (0.0, 0.0)) -> None:
        """A force on a point of a body, or a torque if the law has one component, in ground axes as is the default."""
        load = _opensim().PrescribedForce(f"load{len(self.loads)}", self.frames[body])
        load.setPointFunctions(*(_opensim().Constant(float(place)) for place in (*anchor, 0.0)))
        self.model.addForce(load)
        is_force = isinstance(law, Law) and len(law.values.T) > 1
        self.loads.append((load.setForceFunctions if is_force else load.setTorqueFunctions, law))

    def kinematics(self, bodies: Sequence[Body], channel: Channel) -> Callable[[Any], list[tuple[float, ...]]]:
        """What reads a channel of bodies; an angle is a sum of coordinates, and so unwrapped."""
        place, rate = KINEMATICS[channel]
        sources = []
        for body in bodies:
            turns = self.turning[body.name] if body.inertia is not None else []
            offset = body.angle - sum(turn.getDefaultValue() for turn in turns) if channel is Channel.POSITION else 0.0
            sources.append((getattr(self.frames[body.name], place), [getattr(turn, rate) for turn in turns], offset))
        return lambda state: [(*_plane(at(state)), sum((turn(state) for turn in by), base)) for at, by, base in sources]


class SimbodyEngine(SteppedEngine[SimbodyWorld, SimbodyRecipe]):
    """OpenSim's default integrator, with a tolerance of the joints of its own for each kind of drive."""

    name = "simbody"
    package = "opensim"
    oldest = "4.6"
    effort_unit = "tolerance of the joints"
    abilities = Abilities(
        READOUTS, frozenset({Prescribed, Free}), GUIDES, LOADS, timed_torque=True, drivers=frozenset(DriverKind)
    )
    settings: Mapping[type, Mapping[Setting, SimbodyRecipe]] = {
        Prescribed: dict(zip(Setting, (NAIVE, DRIVEN, replace(DRIVEN, effort=1e-13)), strict=True)),
        Free: dict(zip(Setting, (NAIVE, FREE, replace(FREE, ratios=(4,))), strict=True)),
    }
    studied: Mapping[str, tuple[str, SimbodyRecipe]] = {
        "defaults": ("Runge-Kutta-Merson, all else as OpenSim has it", replace(NAIVE, fixed=True)),
        "projected": ("Runge-Kutta-Merson, projected onto the joints", replace(DRIVEN, fixed=True)),
    }

    def refusal(self, scene: Scene) -> str | None:
        """Loads over the crank angle become tables over time, which a free crank does not have."""
        laws = [load.force for load in scene.forces] + [load.torque for load in scene.torques]
        if isinstance(scene.drive, Free) and not all(law.is_constant for law in laws):
            return "its forces follow time, so that a free crank can have none that changes with its angle"
        if (
            isinstance(scene.drive, Free)
            and scene.drive.over_time is not None
            and scene.driver_kind is not DriverKind.CRANK
        ):
            return "it takes no force of a linear drive that changes with time"
        tree = spanning_tree(cylinder_as_links(scene, 1.0))
        return _lost_inertia(scene) or tree.obstacle or _weightless_end(tree)

    def build(self, scene: Scene, recipe: SimbodyRecipe) -> SimbodyWorld:
        """Loads and drive have no functions yet: those of each part of the motion are given to them in turn."""
        osim, linked = (
            _opensim(),
            cylinder_as_links(scene, LIGHT * min(body.mass for body in scene.bodies if body.mass)),
        )
        tree = spanning_tree(linked)
        model = osim.Model()
        model.setGravity(_vector(*scene.gravity))
        frames = {GROUND: model.getGround()}
        world = SimbodyWorld(model, frames, linked.crank)
        for branch in tree.branches:
            world.carry(branch)
        for cut in tree.cuts:
            world.close(cut, tree.carrier(cut))
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
        if isinstance(scene.drive, Free) and scene.cylinder is not None:
            (one, other), places = (frames[name].getName() for name in scene.driver_ends[:2]), scene.driver_ends[2:]
            here, there = (_vector(*place) for place in places)
            pull = f"-({scene.drive.torque:.17g})"
            model.addForce(osim.ExpressionBasedPointToPointForce(one, here, other, there, pull))
        elif isinstance(scene.drive, Free):
            along = [1.0] if scene.driver_kind is DriverKind.CRANK else scene.driven_slider.along
            world.push(scene.crank, Law(scene.drive.torque * np.array(along)))
            if scene.drive.over_time is not None:
                world.push(scene.crank, scene.drive.over_time)
        world.readers |= {channel: world.kinematics(scene.bodies, channel) for channel in KINEMATICS}
        world.forces = {joint.name: world.forces[joint.name] for joint in (*scene.pins, *scene.guided)}
        world.readers[Channel.JOINT_FORCE] = lambda state: [force(state) for force in world.forces.values()]
        return world

    def follow(self, world: SimbodyWorld, course: Course[SimbodyRecipe]) -> History:
        """Part by part, each from where the one before ends."""
        return recorded(course.parts, world.forces, partial(_states, world, course))


def _lost_inertia(scene: Scene) -> str | None:
    """OpenSim::Body sets the inertia of a body without mass to zero, and says so in its log alone."""
    lost = next((body.name for body in scene.bodies if body.inertia and not body.mass), None)
    return lost and f"it takes no inertia of a body without mass, as '{lost}' has"


def _weightless_end(tree: SpanningTree) -> str | None:
    """Simbody solves its tree from the ends inwards: what moves there has to have a mass of its own."""
    parents = {branch.parent for branch in tree.branches}
    for branch in tree.branches:
        body, joint = branch.body, branch.joint
        if body.name in parents or joint is None:
            continue
        arm = dict(ends(joint))[body.name]
        turning = (body.inertia or 0.0) + body.mass * (arm[0] ** 2 + arm[1] ** 2)
        if not body.mass or (isinstance(joint, PinJoint) and not branch.rigid and not turning):
            return (
                f"it holds a body without mass or inertia only between the ground and one that has both, and "
                f"'{body.name}' is at an end of its tree of joints"
            )
    return None


@cache
def _opensim() -> Any:  # noqa: ANN401 - a module without types
    import opensim

    opensim.Logger.setLevelString("Off")  # or it prints, and leaves a log file
    return opensim


def _vector(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:  # noqa: ANN401
    return _opensim().Vec3(float(x), float(y), float(z))


def _plane(vector: Any, factor: float = 1.0) -> Vector:  # noqa: ANN401
    return factor * vector.get(0), factor * vector.get(1)


def _functions(law: Law | TimeLaw, time: Array, angle: Array) -> list[Any]:
    """Three functions of time: a force's components, or a torque's, of which there is the third alone."""
    osim = _opensim()
    if isinstance(law, TimeLaw):
        lines = osim.PiecewiseLinearFunction()
        for at in (law.times[0] - 1.0, *law.times, law.times[-1] + 1.0):  # it goes on beyond as it does at its end
            lines.addPoint(at, law.at(at))
        return [osim.Constant(0.0), osim.Constant(0.0), lines]
    components = law(angle)
    functions = [osim.Constant(0.0) for _ in range(3)]
    for axis, values in enumerate(components, start=0 if len(components) > 1 else 2):
        functions[axis] = osim.Constant(float(values[0])) if law.is_constant else osim.SimmSpline()
        for point in () if law.is_constant else zip(time.tolist(), values.tolist(), strict=True):
            functions[axis].addPoint(*point)
    return functions


def _states(world: SimbodyWorld, course: Course[SimbodyRecipe], part: Interval, time: Array) -> Iterator[State]:
    osim, model, recipe, segment = _opensim(), world.model, course.recipe, part.segment
    clock = time - (segment.start if segment else 0.0)
    if segment:
        highest_first = osim.Vector.createFromMat(np.array(segment.coefficients[::-1]))
        world.driver.setPrescribedFunction(osim.PolynomialFunction(highest_first))
        world.driver.setDefaultIsPrescribed(True)
    for apply, law in world.loads:
        apply(*_functions(law, clock, segment.value(time) if segment else time))
    state = model.initSystem()
    state.setTime(clock[0])
    manager = osim.Manager(model)
    manager.setWriteToStorage(False)
    speed = np.abs(segment.value(time, 1)).max() if segment else 0.0
    if recipe.effort is not None:  # it holds for velocities too, of which rounding leaves more where they are large
        manager.setIntegratorConstraintTolerance(recipe.effort * max(1.0, speed / RAPID))
    set_step = manager.setIntegratorFixedStepSize if recipe.fixed else manager.setIntegratorMaximumStepSize
    set_step(part.step / course.ratio)
    try:
        manager.initialize(state)
        for instant in clock.tolist():
            manager.setIntegratorFinalTime(instant)  # or it steps beyond and interpolates
            state = manager.integrate(instant) if instant > clock[0] else manager.getState()
            model.realizeAcceleration(state)
            yield {channel: world.readers[channel](state) for channel in course.channels}
    except RuntimeError as error:
        raise DivergedError(f"Simbody gave up: {' '.join(str(error).rpartition('because:')[2].split())}") from error
    model.setPropertiesFromState(state)  # where the next part begins
