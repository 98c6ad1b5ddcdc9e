"""Simbody, through OpenSim's Python package, behind the contract.

Pins and slider joints carry the bodies in a tree; the joints that close its loops are constraints, onto which Simbody
projects positions and velocities. The coordinate of the crank, of the driven slider or of a slide between a cylinder's
barrel and rod, which have next to no mass, is prescribed as a polynomial of time, a segment of the motion at a time, so
that OpenSim's clock starts anew with every segment.

After a step that misses the joints by more than the square root of their tolerance, Simbody's Runge-Kutta methods leave
the projection out, and in steps of fixed length do so silently. So a step is at most as long as a recipe allows, and
Simbody divides it where it must; only the methods for study keep it fixed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.spanning_tree import Branch, SpanningTree, cylinder_as_links, spanning_tree
from engines.scene import (
    GUIDES,
    LOADS,
    Body,
    Channel,
    Free,
    PinJoint,
    Prescribed,
    Scene,
    SliderJoint,
    SlotJoint,
)
from engines.stepping.stepped_engine import LoopEngine, PlainLaw, Recipe, plain_law

READOUTS = {
    Channel.POSITION: ReadOut("Frame.getPositionInGround, Coordinate.getValue"),
    Channel.VELOCITY: ReadOut("Frame.getLinearVelocityInGround, Coordinate.getSpeedValue"),
    Channel.ACCELERATION: ReadOut("Frame.getLinearAccelerationInGround, Coordinate.getAccelerationValue"),
    Channel.TORQUE: ReadOut(
        "Joint.calcReactionOnParentExpressedInGround, moment, or force along the driven slide",
        drive="drive only",
    ),
    Channel.JOINT_FORCE: ReadOut(
        "Joint.calcReactionOnParentExpressedInGround, Constraint.getRecordValues",
        drive="without drive: a driven slider's is subtracted",
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
NAIVE = SimbodyRecipe(steps_per_turn=120, in_own_units=False)
DRIVEN = SimbodyRecipe(steps_per_turn=120, effort=1e-12)
FREE = SimbodyRecipe(steps_per_turn=100, ratios=(2,), effort=1e-6)


class SimbodyModel:
    """A scene as bodies on a tree and constraints that close its loops; bodies are numbers, the ground is -1.

    ``turning`` has the bodies whose coordinates turn each body.
    """

    def __init__(self, scene: Scene) -> None:
        """Arrange a scene as a tree for Simbody; two light links stand for a cylinder.

        Raises ValueError where no body has a mass.
        """
        light = LIGHT * min(body.mass for body in scene.bodies if body.mass)
        self.scene, self.linked = scene, cylinder_as_links(scene, light)
        self.tree = tree = spanning_tree(self.linked)
        self.numbers = {GROUND: -1, **{branch.body.name: number for number, branch in enumerate(tree.branches)}}
        self.turning: dict[str, list[int]] = {GROUND: []}
        for number, branch in enumerate(tree.branches):
            is_hinge = not branch.rigid and not isinstance(branch.joint, SliderJoint)
            self.turning[branch.body.name] = self.turning[branch.parent] + ([number] if is_hinge else [])

    def as_data(self, recipe: SimbodyRecipe) -> dict[str, Any]:
        """The model as plain data by name: gravity, bodies, joints, cuts, springs, dampers, loads, drive and read-outs.

        Of the ``recipe`` it has the joints' tolerance, its ``effort``, and whether its steps are ``fixed``. Units are
        the scene's.
        """
        numbers = self.numbers
        return {
            "gravity": self.scene.gravity,
            "tolerance": recipe.effort,
            "fixed": recipe.fixed,
            "bodies": [self.body_data(branch) for branch in self.tree.branches],
            "cuts": [self.cut_data(cut) for cut in self.tree.cuts],
            "springs": [*self.springs()],
            "dampers": [(numbers[each.first], numbers[each.second], each.coefficient) for each in self.scene.dampers],
            "loads": [*self.loads()],
            "read": [self.readout_data(body) for body in self.scene.bodies],
            "joints": self.joints(),
            "drive": self.drive(),
        }

    def body_data(self, branch: Branch) -> dict[str, Any]:
        """Data, by name, of a body and the joint on its parent; a slider is along the first axis of both its frames."""
        slides = isinstance(branch.joint, SliderJoint)
        return {
            "mass": branch.body.mass,
            "inertia": branch.body.inertia or 0.0,
            "parent": self.numbers[branch.parent],
            "joint": "SliderJoint" if slides else "WeldJoint" if branch.rigid else "PinJoint",
            "points": branch.points,
            "tilts": branch.tilts,
            "value": branch.value,
            "speed": branch.speed,
        }

    def cut_data(self, cut: PinJoint | SliderJoint | SlotJoint) -> dict[str, Any]:
        """The data, by name, of a joint that closes a loop, with the body that carries both of its bodies."""
        return {
            "bodies": [self.numbers[body] for body, _ in cut.ends],
            "anchors": [anchor for _, anchor in cut.ends],
            "along": None if isinstance(cut, PinJoint) else cut.along,
            "carrier": self.numbers[self.tree.carrier(cut)],
        }

    def springs(self) -> Iterator[tuple[int, Vector, int, Vector, str]]:
        """Yield rows of springs, and a free cylinder's push: number and anchor of both ends, and the pull as a text.

        The text is an expression of length and rate, ``d`` and ``ddot``, as OpenSim reads it.
        """
        scene = self.scene
        springs = [
            (each.ends, f"{each.stiffness:.17g} * (d - {each.length:.17g}) + {each.damping:.17g} * ddot")
            for each in scene.springs
        ]
        if isinstance(scene.drive, Free) and scene.cylinder is not None:
            springs.append((scene.cylinder.ends, f"-({scene.drive.torque:.17g})"))
        for ((first, here), (second, there)), law in springs:
            yield self.numbers[first], here, self.numbers[second], there, law

    def loads(self) -> Iterator[tuple[int, Vector, PlainLaw | dict[str, Any]]]:
        """Yield loads as rows: body's number, anchor, and the plain law of a force, a torque or a free driver.

        The law of a free driver's torque over time is a dictionary of ``times``, s, and ``torque``, N m.
        """
        scene, crank = self.scene, self.numbers.get(self.scene.crank, -1)
        for force in scene.forces:
            yield self.numbers[force.body], force.anchor, plain_law(force.force)
        for torque in scene.torques:
            yield self.numbers[torque.body], (0.0, 0.0), plain_law(torque.torque)
        if isinstance(scene.drive, Free) and scene.cylinder is None:
            along = [1.0] if scene.driver_kind is DriverKind.CRANK else scene.driven_slider.along
            yield crank, (0.0, 0.0), [scene.drive.torque * part for part in along]
            if scene.drive.over_time is not None:
                yield crank, (0.0, 0.0), vars(scene.drive.over_time)

    def readout_data(self, body: Body) -> tuple[int, list[int], float]:
        """A body's number, the numbers of the coordinates whose sum is its angle, and a constant to add to it, rad."""
        turning = self.turning[body.name] if body.inertia is not None else []
        return self.numbers[body.name], turning, body.angle - sum(self.tree.branches[n].value for n in turning)

    def joints(self) -> dict[str, tuple[bool, int, float, Vector | None]]:
        """Of each joint by name: whether it is a cut, its number, its force's sign and only direction.

        The number is among the cuts or the branches, the sign 1.0 or -1.0. The direction is None but for a driven
        slider, whose force is across its guide: what is along it is the drive's.
        """
        forces: dict[str, tuple[bool, int, float, Vector | None]] = {}
        for number, branch in enumerate(self.tree.branches):
            guide = branch.joint if branch.body.name == self.linked.crank else None
            normal = (-guide.along[1], guide.along[0]) if isinstance(guide, SliderJoint) else None
            forces[branch.name] = (False, number, _sign_of_branch(branch), normal)
        forces |= {cut.name: (True, number, 1.0, None) for number, cut in enumerate(self.tree.cuts)}
        return {joint.name: forces[joint.name] for joint in self.scene.joints}

    def drive(self) -> tuple[int, float, Vector | None]:
        """Number of the driven body, sign of its joint's force, and the drive's direction; None for a torque.

        The direction is in the frame of the driven slider's host.
        """
        number = self.numbers[self.linked.crank]
        branch = self.tree.branches[number]
        return number, _sign_of_branch(branch), branch.joint.along if isinstance(branch.joint, SliderJoint) else None


def _sign_of_branch(branch: Branch) -> float:
    """The sign, 1 or -1, by which Simbody's force of a branch becomes the one on the joint's first body."""
    return 1.0 if branch.reverse else -1.0


class SimbodyEngine(LoopEngine[SimbodyRecipe]):
    """OpenSim's default integrator, with a tolerance of the joints of its own for each kind of drive."""

    name = "simbody"
    package = "opensim"
    loop = "engines.simbody_loop"
    engine_calls = (
        "opensim.Model.initSystem",
        "opensim.Manager.initialize",
        "opensim.Manager.integrate",
        "opensim.Model.realizeAcceleration",
        "opensim.Joint.calcReactionOnParentExpressedInGround",
        "opensim.Constraint.getRecordValues",
    )
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
        """The reason why Simbody cannot hold a scene; None if it can.

        It takes no loads over φ on a released crank, no linear force over time, no inertia without mass, no body that
        only slots hold, no loop of sliders alone, and at an end of its tree no body without mass or inertia.
        """
        laws = [load.force for load in scene.forces] + [load.torque for load in scene.torques]
        if isinstance(scene.drive, Free):
            if not all(law.is_constant for law in laws):
                return "its forces follow time, so that a free crank can have none that changes with its angle"
            if scene.drive.over_time is not None and scene.driver_kind is not DriverKind.CRANK:
                return "it takes no force of a linear drive that changes with time"
        tree = spanning_tree(cylinder_as_links(scene, 1.0))
        return _lost_inertia(scene) or tree.obstacle or _weightless_end(tree)

    def model(self, scene: Scene, recipe: SimbodyRecipe) -> Mapping[str, Any]:
        """The scene as plain data by name for ``engines.simbody_loop``."""
        return SimbodyModel(scene).as_data(recipe)


def _lost_inertia(scene: Scene) -> str | None:
    """The sentence that OpenSim would drop the inertia of a body without mass; None without such a body."""
    lost = next((body.name for body in scene.bodies if body.inertia and not body.mass), None)
    return lost and f"it takes no inertia of a body without mass, as '{lost}' has"


def _weightless_end(tree: SpanningTree) -> str | None:
    """The sentence that a body without mass or inertia ends Simbody's tree, which it cannot solve; else None."""
    parents = {branch.parent for branch in tree.branches}
    for branch in tree.branches:
        body, joint = branch.body, branch.joint
        if body.name in parents or joint is None:
            continue
        x, y = dict(joint.ends)[body.name]
        turning = (body.inertia or 0.0) + body.mass * (x**2 + y**2)
        if not body.mass or (isinstance(joint, PinJoint) and not branch.rigid and not turning):
            return (
                f"it holds a body without mass or inertia only between the ground and one that has both, and "
                f"'{body.name}' is at an end of its tree of joints"
            )
    return None
