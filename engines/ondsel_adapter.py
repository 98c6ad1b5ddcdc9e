"""Ondsel, the solver of FreeCAD's Assembly, through ``pyondsel``: kinematics and inverse dynamics of a driven linkage.

Ondsel knows parts in space, joints between markers on them, motions over time, and gravity. Other loads and free motion
do not exist in it: a free crank "runs" and comes back at rest. Every body is held in the plane by a joint of its own
to the ground, so that no joint is redundant: a pin is a point on a line square to the plane, a guide is a point in a
plane along it. pyondsel's own reader drops the forces, so the text that the solver writes is read here.

**Slots.** Ondsel's joints that keep a point on a line or in a plane of a turning link have wrong accelerations, and so
wrong forces; docs/finds.md has the error and its cause. ``naive`` shows them. ``tuned`` holds the point by a screw
joint without pitch instead: the distance of the same point from the same plane, of which the solver has the right
second derivatives. Nothing is added to what the engine says, so every number is read.

**A linear drive** is a motion along the third axes of a translational joint: a slider's on the ground, or that between
a barrel and a rod without mass, which are the cylinder.

**A damper on the crank** is a flywheel without mass on the crank's shaft. It is turned by a motion of its own so that
its reaction is the damper's torque: a moment of inertia of c · 1 s, for a coefficient of c, at an angle of ∫φ dt / 1 s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.contract import Abilities, History, ReadOut, Setting, Signal
from engines.installed import own_folder
from engines.mechanics.cylinder_links import cylinder_as_links
from engines.scene import Body, Channel, Prescribed, Scene, SliderJoint, SlotJoint, TurnDamper
from engines.stepping.driver import DivergedError
from engines.stepping.histories import joined
from engines.stepping.intervals import Interval
from engines.stepping.stepped_engine import Course, Recipe, SteppedEngine

if TYPE_CHECKING:
    from pyondsel.model.asmt_model import AsmtModel
    from pyondsel.model.part import Part

Array = NDArray[np.float64]
Matrix = tuple[tuple[float, float, float], ...]  # its columns are the axes of a frame

LINKAGE, DRIVE, FLYWHEEL = "linkage", "drive", "/flywheel"  # the last is a name that no body of a scene has
UPRIGHT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
POSITION, VELOCITY, ACCELERATION = ("X", "Y", "Bryantz"), ("VX", "VY", "OmegaZ"), ("AX", "AY", "AlphaZ")
TIMEOUT = 3600.0  # s, of the solver's process, which pyondsel starts for every solution; the suite has its own limit


@dataclass(frozen=True, kw_only=True)
class OndselRecipe(Recipe):
    """``guide`` is the kind of joint, as pyondsel calls it, that sliders and slots become."""

    guide: str


# Every frame is a solution of its own: more of them bring no accuracy, fewer only coarser curves. Newton's iteration
# ends at a root mean square of 1e-6 over lengths and turns together, which pyondsel cannot change (Ondsel does not pass
# on the tolerance in the text). With lengths of about 1000 that is 1e-9, and after the last step rounding is left.
# Quintic run-up, needle mechanism: torque 5.6e-12 in SI, 2e-14 so, both in 0.9 s.
NEWCOMER = OndselRecipe(steps_per_turn=100, guide="point_in_plane", in_own_units=False)
EXPERT = OndselRecipe(steps_per_turn=100, guide="screw", size=1000.0, graded=True)


@dataclass
class OndselWorld:
    """``parts`` and their ``angles`` at the start by body; ``sources`` by joint: the path of its force, and its sign.

    The sign is that on the joint's first body. ``line`` is a linear drive's: the body it is fixed in and its direction.
    """

    scene: Scene
    model: AsmtModel
    parts: dict[str, Part] = field(default_factory=dict)
    sources: dict[str, tuple[str, float]] = field(default_factory=dict)
    angles: dict[str, float] = field(default_factory=lambda: {GROUND: 0.0})
    line: tuple[str, complex] | None = None

    def add_part(self, body: Body) -> None:
        """A part at a body's mass centre; what its inertia is out of the plane does not matter."""
        from pyondsel.model.part import Part

        inertia = float(body.mass if body.inertia is None else body.inertia)
        part = Part(f"part{len(self.parts)}", mass=float(body.mass), moments_of_inertia=(inertia, inertia, inertia))
        self.parts[body.name], self.angles[body.name] = self.model.add_part(part), body.angle
        _place(part, *body.position, body.angle)

    def marker(self, body: str, place: Vector = (0.0, 0.0), axes: Matrix = UPRIGHT) -> str:
        """The path of a new marker on a body."""
        from pyondsel.model.marker import Marker

        part = self.parts.get(body)  # None is the ground
        markers = part.markers if part else self.model.ground_markers
        markers.append(Marker(f"marker{len(markers)}", (float(place[0]), float(place[1]), 0.0), axes))
        return _path(*([part.name] if part else []), markers[-1].name)

    def join(self, kind: str, first: str, second: str, *, motion: str = "") -> str:
        """The path of a new joint and of its force on the first marker; ``motion`` names one that turns it."""
        from pyondsel.model.joint import Joint
        from pyondsel.model.motion import Motion

        joint = self.model.add_joint(Joint(f"joint{len(self.model.joints)}", kind, first, second, pitch=0.0))
        if motion:
            turns = kind == "revolute"
            self.model.add_motion(Motion(motion, joint.name, "", "rotational" if turns else "translational"))
        return _path(joint.name)


class OndselEngine(SteppedEngine[OndselWorld, OndselRecipe]):
    """One simulation for each part of the motion; each begins in the pose in which the one before ended."""

    name = "ondsel"
    package = "pyondsel"
    oldest = "0.0.3"
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("PartSeries X, Y, Bryantz"),
            Channel.VELOCITY: ReadOut("PartSeries VX, VY, OmegaZ"),
            Channel.ACCELERATION: ReadOut("PartSeries AX, AY, AlphaZ"),
            Channel.TORQUE: ReadOut(
                "RotationalMotionSeries TZonI, on the ground; TranslationalMotionSeries FXonI, FYonI, along the line",
                drive="nothing else is in it",
            ),
            Channel.JOINT_FORCE: ReadOut("JointSeries FXonI and FYonI, on the second body", drive="not included"),
        },
        drives=frozenset({Prescribed}),
        joints=frozenset({SliderJoint, SlotJoint}),
        loads=frozenset({TurnDamper}),
        drivers=frozenset(DriverKind),
        settings=frozenset({Setting.NAIVE, Setting.TUNED}),
    )
    settings: Mapping[type, Mapping[Setting, OndselRecipe]] = {
        Prescribed: {Setting.NAIVE: NEWCOMER, Setting.TUNED: EXPERT}
    }
    studied: Mapping[str, tuple[str, OndselRecipe]] = {
        "point in plane": ("guides as points in a plane, wrong where they turn", NEWCOMER),
        "screw": ("guides as screws without pitch, in units of the scene", EXPERT),
    }

    def refusal(self, scene: Scene) -> str | None:
        if scene.driver_kind is not DriverKind.CRANK:
            return "it takes no turn damper beside a linear drive" if scene.dampers else None
        if all({damper.first, damper.second} == {scene.crank, GROUND} for damper in scene.dampers):
            return None
        return f"it takes no turn damper but one between the crank '{scene.crank}' and the ground"

    def build(self, scene: Scene, recipe: OndselRecipe) -> OndselWorld:
        from pyondsel.model.asmt_model import AsmtModel

        given, scene = scene, cylinder_as_links(scene, 0.0)
        world = OndselWorld(given, AsmtModel(LINKAGE, gravity=(float(scene.gravity[0]), float(scene.gravity[1]), 0.0)))
        for body in scene.bodies:
            world.add_part(body)
            if body.name != scene.crank:
                world.join("planar", world.marker(GROUND), world.marker(body.name))
            if not scene.can_turn(body) and body.name != scene.crank:
                _keep_angle(world, body.name, GROUND)
        for pin in scene.pins:
            ends, sign = [(pin.second, pin.second_anchor), (pin.first, pin.first_anchor)], -1.0
            if pin.first == GROUND:
                ends, sign = ends[::-1], 1.0
            is_shaft = not world.model.motions and {pin.first, pin.second} == {GROUND, scene.crank}
            kind, motion = ("revolute", DRIVE) if is_shaft else ("point_in_line", "")
            world.sources[pin.name] = world.join(kind, *(world.marker(*end) for end in ends), motion=motion), sign
        for joint in scene.guided:
            if joint.body == scene.crank and isinstance(joint, SliderJoint):
                world.sources[joint.name] = _drive_along(world, joint), -1.0
                continue
            host = world.marker(joint.host, joint.through, _along(joint.along))
            point = world.marker(joint.body, joint.anchor, _along((1.0, 0.0)))
            world.sources[joint.name] = world.join(recipe.guide, host, point), -1.0
        for slider in scene.sliders:
            if slider.body != scene.crank and any(
                body.name == slider.body and scene.can_turn(body) for body in scene.bodies
            ):
                _keep_angle(world, slider.body, slider.host)
        if coefficient := sum(damper.coefficient for damper in scene.dampers):
            world.add_part(Body(FLYWHEEL, 0.0, coefficient, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0))
            world.join("revolute", world.marker(scene.crank), world.marker(FLYWHEEL), motion=FLYWHEEL)
        world.sources = {joint.name: world.sources[joint.name] for joint in (*given.pins, *given.guided)}
        return world

    def follow(self, world: OndselWorld, course: Course[OndselRecipe]) -> History:
        history = joined([_followed(world, part, course, part is course.parts[-1]) for part in course.parts])
        if history.position is not None:
            angles = history.position.values[..., 2]
            angles[:] = np.unwrap([[body.angle for body in world.scene.bodies], *angles], axis=0)[1:]
        return history


def _path(*names: str) -> str:
    return "/".join(("", LINKAGE, *names))


def _along(direction: Vector) -> Matrix:
    """A frame whose y axis is along a direction in the plane and whose z axis is across it, in the plane as well."""
    x, y = (float(part) / math.hypot(*direction) for part in direction)
    return ((0.0, x, -y), (0.0, y, x), (1.0, 0.0, 0.0))


def _drive_along(world: OndselWorld, joint: SliderJoint) -> str:
    """The joint of a driven slider, the third axes of whose markers are along its line."""
    (x, y), turn = joint.along, world.angles[joint.host] - world.angles[joint.body]
    c, s = math.cos(turn), math.sin(turn)
    host = world.marker(joint.host, joint.through, _along((y, -x)))
    body = world.marker(joint.body, joint.anchor, _along((s * x + c * y, s * y - c * x)))
    world.line = joint.host, complex(*joint.along)
    return world.join("translational", host, body, motion=DRIVE)


def _keep_angle(world: OndselWorld, body: str, host: str) -> None:
    """Hold a body's angle against its host's: a direction of each stays square to the other's."""
    turn = world.angles[host] - world.angles[body]
    square = world.marker(body, axes=_along((-math.sin(turn), math.cos(turn))))
    world.join("perpendicular", world.marker(host, axes=_along((1.0, 0.0))), square)


def _place(part: Part, x: float, y: float, angle: float) -> None:
    cosine, sine = math.cos(angle), math.sin(angle)
    part.position = (float(x), float(y), 0.0)
    part.rotation = ((cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0))


def _followed(world: OndselWorld, part: Interval, course: Course[OndselRecipe], is_last: bool) -> History:
    """The history of one part of the motion, without its last sample where another part begins; the model moves on."""
    rows = _solved(world, part)
    kept = slice(0, part.samples + is_last)
    # Ondsel adds its steps up: its times differ from whole steps in their last digits, which shows in the torque.
    time = (rows["", "Time"] - rows["", "Time"][0] + part.start)[kept]

    def values(labels: tuple[str, ...]) -> Array:
        table = [[rows[_path(body.name), label] for label in labels] for body in world.parts.values()]
        return np.moveaxis(np.array(table), 2, 0)

    def motion(channel: Channel, labels: tuple[str, ...]) -> Signal | None:
        return Signal(time, values(labels)[kept, : len(world.scene.bodies)]) if channel in course.channels else None

    for body, pose in zip(world.parts.values(), values(POSITION)[part.samples].tolist(), strict=True):
        _place(body, *pose)
    forces = world.sources.items() if Channel.JOINT_FORCE in course.channels else ()
    return History(
        motion(Channel.POSITION, POSITION),
        motion(Channel.VELOCITY, VELOCITY),
        motion(Channel.ACCELERATION, ACCELERATION),
        Signal(time, _driven(world, rows)[kept]) if Channel.TORQUE in course.channels else None,
        {
            name: Signal(time, sign * np.stack([rows[path, "FXonI"], rows[path, "FYonI"]], axis=1)[kept])
            for name, (path, sign) in forces
        },
    )


def _driven(world: OndselWorld, rows: dict[tuple[str, str], Array]) -> Array:
    """What the drive exerts: its moment, or its force along the line of a slider or cylinder."""
    if world.line is None:
        return -rows[_path(DRIVE), "TZonI"]
    host, along = world.line
    turned = rows[_path(world.parts[host].name), "Bryantz"] if host != GROUND else np.zeros(1)
    force = rows[_path(DRIVE), "FXonI"] + 1j * rows[_path(DRIVE), "FYonI"]
    return np.asarray(-(force * (along * np.exp(1j * turned)).conjugate()).real)


def _solved(world: OndselWorld, part: Interval) -> dict[tuple[str, str], Array]:
    """Solve one part of the motion: the rows of all series by path and label, one number a frame."""
    from pyondsel.errors import AsmtError
    from pyondsel.model.simulation import Simulation
    from pyondsel.solve import solve_asmt

    segment = part.segment
    assert segment is not None  # the drive is prescribed
    crank = segment.coefficients
    turned = [0.0, *(each / power for power, each in enumerate(crank, 1))]  # ∫φ dt; its motion is against the crank
    flywheel = [whole - own for whole, own in zip(turned, [*crank, 0.0], strict=True)]
    for motion, coefficients in zip(world.model.motions, (crank, flywheel), strict=False):
        motion.expression = "+time*(".join(repr(float(c)) for c in coefficients) + ")" * (len(coefficients) - 1)
    world.model.simulation = Simulation(part.start - segment.start, part.end - segment.start, part.samples)
    try:
        # pyondsel writes "Pitch" where Ondsel reads "pitch" and gives up otherwise.
        with own_folder():  # its files have the same names in every process
            text = solve_asmt(world.model.to_asmt().replace("\tPitch\n", "\tpitch\n"), timeout=TIMEOUT)
    except AsmtError as error:
        raise DivergedError(f"Ondsel gave up: {error}") from error
    rows: dict[tuple[str, str], Array] = {}
    path = ""
    for line in text.partition("TimeSeries\n")[2].splitlines():
        label, *cells = line.rstrip("\t").split("\t")
        if label.endswith("Series"):
            path = cells[0]
        else:
            rows[path, label] = np.array(cells[1:], dtype=float)  # the first column is the pose that was given
    # Ondsel ends early and says nothing where it finds no solution or does not understand a word.
    frames = min(map(len, rows.values()), default=0)
    if frames <= part.samples:
        raise DivergedError(f"Ondsel solved {frames} of {part.samples + 1} frames")
    return rows
