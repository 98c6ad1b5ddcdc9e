"""Ondsel, the solver of FreeCAD's Assembly, through ``pyondsel``: kinematics and inverse dynamics of a driven linkage.

Ondsel knows parts in space, joints between markers on them, motions over time, and gravity. Other loads and free motion
do not exist in it: a free crank "runs" and comes back at rest. A joint with the ground keeps every body in the plane,
so that no other joint is redundant: a pin is a point on a line square to the plane, a guide is a point in a plane along
it. pyondsel's own reader drops the forces, so the text that the solver writes is read here.

**Slots.** Ondsel's joints that keep a point on a line or in a plane of a turning link have wrong accelerations, and so
wrong forces; docs/finds.md has the error and its cause. ``naive`` shows them. ``tuned`` holds the point by a screw
joint without pitch instead: the distance of the same point from the same plane, of which the solver has the right
second derivatives. Nothing is added to the engine's results, so every number is read.

**A linear drive** is a motion along the third axes of a translational joint: a slider's on the ground, or that between
a barrel and a rod without mass, which are the cylinder.

**A damper on the crank** is a flywheel without mass on the crank's shaft. It is turned by a motion of its own so that
its reaction is the damper's torque: a moment of inertia of c · 1 s, for a coefficient of c, at an angle of ∫φ dt / 1 s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.spanning_tree import cylinder_as_links
from engines.scene import Body, Channel, Prescribed, Scene, SliderJoint, SlotJoint, TurnDamper
from engines.stepping.stepped_engine import LoopEngine, Recipe

Matrix = tuple[tuple[float, float, float], ...]  # its columns are the axes of a frame

DRIVE, FLYWHEEL = "drive", "/flywheel"  # the latter is a name that no body of a scene has
UPRIGHT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


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
class OndselModel:
    """Parts, joints and motions as pyondsel calls them, for the loop to make.

    ``numbers`` and ``angles`` at the start are by body; ``sources`` by joint: the name of its force, and its sign on
    the joint's first body. ``line`` is a linear drive's: the part it is fixed in, None for the ground, and its
    direction.
    """

    parts: list[dict[str, Any]] = field(default_factory=list)
    ground: list[tuple[tuple[float, float, float], Matrix]] = field(default_factory=list)
    joints: list[tuple[str, str, str]] = field(default_factory=list)
    motions: list[tuple[str, int, str]] = field(default_factory=list)
    numbers: dict[str, int] = field(default_factory=dict)
    sources: dict[str, tuple[str, float]] = field(default_factory=dict)
    angles: dict[str, float] = field(default_factory=lambda: {GROUND: 0.0})
    line: tuple[int | None, complex] | None = None

    def add_part(self, body: Body) -> None:
        """Add a part at a body's mass centre, and its number and angle; its inertia out of the plane has no effect."""
        inertia = float(body.mass if body.inertia is None else body.inertia)
        self.numbers[body.name], self.angles[body.name] = len(self.parts), body.angle
        pose = [float(number) for number in (*body.position, body.angle)]
        self.parts.append({"mass": float(body.mass), "inertia": inertia, "pose": pose, "markers": []})

    def add_marker(self, body: str, place: Vector = (0.0, 0.0), axes: Matrix = UPRIGHT) -> str:
        """Add a marker to a body, or to the ground, by name, at a place in its frame, m; returns the marker's path.

        ``axes`` are the marker's in the body's frame. A body that is no part counts as the ground.
        """
        number = self.numbers.get(body)  # None is the ground
        markers = self.ground if number is None else self.parts[number]["markers"]
        markers.append(((float(place[0]), float(place[1]), 0.0), axes))
        return ("" if number is None else f"part{number}/") + f"marker{len(markers) - 1}"

    def add_joint(self, kind: str, first: str, second: str, *, motion: str = "") -> str:
        """Add a joint of a ``kind``, in pyondsel's word, between two markers, by their paths; returns its name.

        That is also the name of its force on the first marker. ``motion`` names a motion to prescribe in it, none if
        empty: a rotation in a "revolute" joint, else a translation.
        """
        if motion:
            self.motions.append((motion, len(self.joints), "rotational" if kind == "revolute" else "translational"))
        self.joints.append((kind, first, second))
        return f"joint{len(self.joints) - 1}"


class OndselEngine(LoopEngine[OndselRecipe]):
    """One simulation for each part of the motion; each begins in the pose in which the one before ended."""

    name = "ondsel"
    package = "pyondsel"
    loop = "engines.ondsel_loop"
    engine_calls = ("engines.ondsel_loop.solve_asmt",)  # which is pyondsel's
    oldest = "0.0.3"
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("PartSeries X, Y, Bryantz"),
            Channel.VELOCITY: ReadOut("PartSeries VX, VY, OmegaZ"),
            Channel.ACCELERATION: ReadOut("PartSeries AX, AY, AlphaZ"),
            Channel.TORQUE: ReadOut(
                "RotationalMotionSeries TZonI, on the ground; TranslationalMotionSeries FXonI, FYonI, along the line",
                drive="drive only",
            ),
            Channel.JOINT_FORCE: ReadOut("JointSeries FXonI and FYonI, on the second body", drive="without drive"),
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
        """The reason, in a sentence, to refuse a turn damper but of a driven crank and the ground; else None."""
        if scene.driver_kind is not DriverKind.CRANK:
            return "it takes no turn damper beside a linear drive" if scene.dampers else None
        if all({damper.first, damper.second} == {scene.crank, GROUND} for damper in scene.dampers):
            return None
        return f"it takes no turn damper but one between the crank '{scene.crank}' and the ground"

    def model(self, scene: Scene, recipe: OndselRecipe) -> Mapping[str, Any]:
        """The scene as plain data by name for ``engines.ondsel_loop``."""
        given, scene, world = scene, cylinder_as_links(scene, 0.0), OndselModel()
        for body in scene.bodies:
            world.add_part(body)
            if body.name != scene.crank:
                world.add_joint("planar", world.add_marker(GROUND), world.add_marker(body.name))
            if not scene.can_turn(body) and body.name != scene.crank:
                _add_angle_constraint(world, body.name, GROUND)
        for pin in scene.pins:
            ends, sign = (pin.ends, 1.0) if pin.first == GROUND else (pin.ends[::-1], -1.0)
            is_shaft = not world.motions and {pin.first, pin.second} == {GROUND, scene.crank}
            kind, motion = ("revolute", DRIVE) if is_shaft else ("point_in_line", "")
            world.sources[pin.name] = (
                world.add_joint(kind, *(world.add_marker(*end) for end in ends), motion=motion),
                sign,
            )
        for joint in scene.guided:
            if joint.body == scene.crank and isinstance(joint, SliderJoint):
                world.sources[joint.name] = _add_driven_slider(world, joint), -1.0
                continue
            host = world.add_marker(joint.host, joint.through, _axes_along(joint.along))
            point = world.add_marker(joint.body, joint.anchor, _axes_along((1.0, 0.0)))
            world.sources[joint.name] = world.add_joint(recipe.guide, host, point), -1.0
        for slider in scene.sliders:
            if slider.body != scene.crank and any(
                body.name == slider.body and scene.can_turn(body) for body in scene.bodies
            ):
                _add_angle_constraint(world, slider.body, slider.host)
        if coefficient := sum(damper.coefficient for damper in scene.dampers):
            world.add_part(Body(FLYWHEEL, 0.0, coefficient, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0))
            world.add_joint("revolute", world.add_marker(scene.crank), world.add_marker(FLYWHEEL), motion=FLYWHEEL)
        return {
            "gravity": (float(scene.gravity[0]), float(scene.gravity[1]), 0.0),
            "parts": world.parts,
            "ground": world.ground,
            "joints": world.joints,
            "motions": world.motions,
            "angles": [body.angle for body in given.bodies],
            "forces": {joint.name: world.sources[joint.name] for joint in given.joints},
            "line": world.line,
        }


def _axes_along(direction: Vector) -> Matrix:
    """A frame whose y axis is along a direction in the plane and whose z axis is across it, in the plane as well."""
    x, y = (float(part) / math.hypot(*direction) for part in direction)
    return ((0.0, x, -y), (0.0, y, x), (1.0, 0.0, 0.0))


def _add_driven_slider(world: OndselModel, joint: SliderJoint) -> str:
    """Add a driven slider to ``world``, its markers' third axes along its line, and note the line; returns its name."""
    (x, y), turn = joint.along, world.angles[joint.host] - world.angles[joint.body]
    c, s = math.cos(turn), math.sin(turn)
    host = world.add_marker(joint.host, joint.through, _axes_along((y, -x)))
    body = world.add_marker(joint.body, joint.anchor, _axes_along((s * x + c * y, s * y - c * x)))
    world.line = world.numbers.get(joint.host), complex(*joint.along)
    return world.add_joint("translational", host, body, motion=DRIVE)


def _add_angle_constraint(world: OndselModel, body: str, host: str) -> None:
    """Add a joint that holds a body's angle against its host's: a direction of each stays square to the other's."""
    turn = world.angles[host] - world.angles[body]
    square = world.add_marker(body, axes=_axes_along((-math.sin(turn), math.cos(turn))))
    world.add_joint("perpendicular", world.add_marker(host, axes=_axes_along((1.0, 0.0))), square)
