"""MuJoCo: a tree of hinges and slides; what closes its loops, the slots and the drive are equality constraints.

**Constraints.** MuJoCo's are soft: each has a reference acceleration, which brings it back within the time constant of
``solref``, and misses it by its force times a softness, which ``solimp`` limits from below and which goes with the
inverse weights of what is tied. As shipped that is 20 ms, a third of a turn at 1000 rpm, and a tenth of every force.
An expert's time constant is a fraction of a turn, and the inverse weights of the compiled model are made so small that
rounding weighs as much. The cost is quadratic then, and Newton's method needs one iteration, and one for the rounding.

**Drive.** An equality at the hinge of the crank or at the slide of the driven slider; a cylinder is a barrel and a rod
without a weight to speak of, and a slide between them. MuJoCo's own reference takes what is to be followed for
constant, so the control callback, which runs at every stage of the integrator, sets it: ε and the return to φ and ω.
Set once a step instead, the fourth order of RK4 is lost.

**Slots.** A block without a weight to speak of slides in the host and is tied to the pin. **Springs**, like forces, are
set by the callback: before version 4.0 ``cfrc_int`` leaves out what MuJoCo's own springs, its tendons, exert.

**Friction** that follows the force of its joint MuJoCo has not. Where forces are read, the callback applies it to the
bodies and MuJoCo computes the joints' forces anew until both are settled; over the steps between it keeps its size. The
motion is the drive's and does not feel it.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from analytic.description.linkage import GROUND, DriverKind
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.joints import scene_size
from engines.mechanics.spanning_tree import AT_REST, Branch, cylinder_as_links, slots_as_blocks, spanning_tree
from engines.mechanics.states import body_numbers, start_coordinate
from engines.scene import GUIDES, LOADS, Channel, Free, PinJoint, Prescribed, Scene, SliderJoint
from engines.stepping.stepped_engine import LoopEngine, Recipe, plain_law

KINEMATICS = {Channel.POSITION: "framepos", Channel.VELOCITY: "framelinvel", Channel.ACCELERATION: "framelinacc"}


@dataclass(frozen=True, kw_only=True)
class MujocoRecipe(Recipe):
    """``settle``: the constraints' time constant in samples; 0 leaves all as shipped and reads what a step leaves.

    The inverse weights of what is tied are made ``harder`` by this factor.
    """

    at_kinks: bool = True
    integrator: str = "RK4"
    settle: float = 20.0
    harder: float = 1e-7


# Catalogue, quintic run-up, 20 samples to settle; largest torque error, time of the slowest, by steps per turn:
# 100 7e-6 0.05 s, 200 4e-7 0.1 s, 500 1e-8 0.2 s, 1000 2e-9 0.3 s, 2000 3e-10 0.6 s, and no less at 4000. Settling in
# 5, 10, 40 samples instead: 1e-7, 1e-8, 7e-10 at 1000; 40 break near a toggle. In SI the same to all digits.
# Slotted take-up driven for 10 s, φ at 400, 600, 800, 1200 steps per turn: 4e-6, 7e-7, 2e-7, 2e-8 rad, 600 in 2.5 s.
NEWCOMER = MujocoRecipe(step=1e-3, integrator="Euler", settle=0.0, in_own_units=False)
EXPERT = MujocoRecipe(steps_per_turn=200, ratios=(5,))
FREE = MujocoRecipe(steps_per_turn=100, ratios=(6,))


class MujocoModel:
    """A scene in MuJoCo's own language.

    A body and the hinge or slide that carries it have one name. ``driven`` is the body whose hinge or slide is driven.
    """

    def __init__(self, scene: Scene, recipe: MujocoRecipe) -> None:
        """Arrange a scene as a tree for MuJoCo, with light blocks in slots and light links for a cylinder."""
        share = 1e-9 if recipe.settle else 1e-2  # a block's of the lightest body; no mass may be below 1e-15
        light = max(1e-14, share * min(body.mass for body in scene.bodies))
        blocked = cylinder_as_links(slots_as_blocks(scene, light), light)
        self.driven = blocked.crank
        self.scene, self.tree = scene, spanning_tree(blocked)
        self.bodies = {GROUND: AT_REST, **{body.name: body for body in blocked.bodies}}

    def loads(self, numbers: Mapping[str, int]) -> list[tuple[Any, ...]]:
        """Forces and torques as rows: body, anchor, plain law, its ``over`` and ``when``, frame, reaction's body.

        Bodies are given by their ``numbers``, anchors as complex numbers, m; a torque's law has one component.
        """
        ground = numbers[GROUND]
        forces = [
            (
                numbers[load.body], complex(*load.anchor), plain_law(load.force), load.force.over, load.force.when,
                numbers[load.frame], numbers[load.reaction],
            )
            for load in self.scene.forces
        ]  # fmt: skip
        torques = [(load.body, load.torque) for load in self.scene.torques]
        return forces + [
            (numbers[body], 0j, plain_law(law), law.over, law.when, ground, ground) for body, law in torques
        ]

    def friction(self, numbers: Mapping[str, int]) -> Iterator[tuple[Any, ...]]:
        """Yield a row for each joint with friction: name, friction over force, both bodies, anchor and direction.

        Bodies are given by their ``numbers``. Friction over force is a ratio of a guide and a lever, m, of a pin.
        Anchor and direction are complex numbers, in the frames of a guide's body and host; of a pin 0 and None.
        """
        joints = {joint.name: joint for joint in self.scene.joints}
        for rubs in self.scene.friction:
            joint = joints[rubs.name]
            (body, anchor), (host, _) = joint.ends
            bodies = numbers[body], numbers[host]
            if isinstance(joint, PinJoint):
                yield rubs.name, rubs.coefficient * rubs.radius, *bodies, 0j, None
            else:
                yield rubs.name, rubs.coefficient, *bodies, complex(*anchor), complex(*joint.along)

    def as_data(self, recipe: MujocoRecipe) -> dict[str, Any]:
        """The model as plain data by name: its XML as text, and what XML does not have."""
        scene, tree, numbers = self.scene, self.tree, body_numbers(self.scene)
        drive = scene.drive
        timed = drive.over_time if isinstance(drive, Free) else None
        return {
            "xml": tostring(self.xml(recipe), encoding="unicode"),
            "settle": recipe.settle,
            "harder": recipe.harder,
            "driven": self.driven,
            "is_linear": scene.driver_kind is not DriverKind.CRANK,
            "start": start_coordinate(scene),
            "torque": drive.torque if isinstance(drive, Free) else 0.0,
            "torque_over_time": timed and (timed.times, timed.torque),
            "gravity": scene.gravity,
            "bodies": {body.name: (body.angle, sorted(tree.hinges(body.name))) for body in scene.bodies},
            "speeds": {branch.body.name: self.speed(branch) for branch in tree.branches},
            "joints": self.joints(),
            "loads": self.loads(numbers),
            "travel": scene.travel
            and (
                numbers[scene.travel.body], complex(*scene.travel.anchor), complex(*scene.travel.along),
                scene.travel.zero,
            ),
            "friction": [*self.friction(numbers)],
            "springs": [
                (numbers[first], complex(*here), numbers[second], complex(*there), *law)
                for spring in scene.springs
                for (first, here), (second, there) in [spring.ends]
                for law in [(spring.stiffness, spring.length, spring.damping)]
            ],
        }  # fmt: skip

    def speed(self, branch: Branch) -> float:
        """Start rate of a branch's hinge, rad/s, against its parent, or slide, m/s."""
        if isinstance(branch.joint, SliderJoint):
            return branch.speed
        return branch.body.angular_velocity - self.bodies[branch.parent].angular_velocity

    def joints(self) -> dict[str, tuple[str, str, float, tuple[float, float] | None]]:
        """Where the force on each joint's first body is read, by joint: kind, name, sign, direction.

        The kind is "body" or "equality", the sign 1.0 or -1.0. The direction, of a force that has only one, is else
        None. A slot has become the pin of its block; of a driven slider's force, the drive's share is along its guide.
        """
        rows: dict[str, tuple[str, str, float, tuple[float, float] | None]] = {}
        for branch in self.tree.branches:
            rows[branch.name] = ("body", branch.body.name, -1.0 if branch.reverse else 1.0, None)
        rows |= {cut.name: ("equality", cut.name, 1.0, None) for cut in self.tree.cuts}
        if self.scene.driver_kind is DriverKind.SLIDER:
            guide = self.scene.driven_slider
            rows[guide.name] = (*rows[guide.name][:3], (-guide.along[1], guide.along[0]))
        return {joint.name: rows[joint.name] for joint in self.scene.joints}

    def xml(self, recipe: MujocoRecipe) -> Element:
        """The scene as the root element, a new one, of MuJoCo's XML."""
        scene, root = self.scene, Element("mujoco")
        SubElement(root, "compiler", angle="radian")
        option = SubElement(root, "option", gravity=_plane_text(complex(*scene.gravity)), integrator=recipe.integrator)
        SubElement(option, "flag", autoreset="disable")  # a run that breaks is to end as one
        if recipe.settle:
            SubElement(SubElement(root, "default"), "equality", solimp="0.9999 0.9999 1 0.5 2")  # the hardest
        links = {GROUND: SubElement(root, "worldbody")}
        equalities, tendons, sensors = (SubElement(root, kind) for kind in ("equality", "tendon", "sensor"))
        for branch in self.tree.branches:
            links[branch.body.name] = self.add_body(branch, links[branch.parent])
        if isinstance(scene.drive, Prescribed):
            SubElement(equalities, "joint", name="/drive", joint1=self.driven)
        for cut in self.tree.cuts:
            sites = f"{cut.name}/1", f"{cut.name}/2"
            SubElement(equalities, "connect", name=cut.name, site1=sites[0], site2=sites[1])
            for site, (link, anchor) in zip(sites, cut.ends, strict=True):
                SubElement(links[link], "site", name=site, pos=_plane_text(complex(*anchor)))
        for damper in scene.dampers:
            angle = SubElement(tendons, "fixed", damping=f"{damper.coefficient:.17g}")
            ours, theirs = self.tree.hinges(damper.first), self.tree.hinges(damper.second)
            for hinge in sorted(ours ^ theirs):
                SubElement(angle, "joint", joint=hinge, coef="1" if hinge in ours else "-1")
        for body, sensor in product(scene.bodies, KINEMATICS.values()):
            SubElement(sensors, sensor, objtype="body", objname=body.name)
        indent(root)
        return root

    def add_body(self, branch: Branch, parent: Element) -> Element:
        """Add a branch's body with its hinge or slide to its parent's element; returns the body's element."""
        body, host = branch.body, self.bodies[branch.parent]
        place = cmath.rect(1.0, -host.angle) * (complex(*body.position) - complex(*host.position))
        turn, inertia = body.angle - host.angle, body.inertia or body.mass * scene_size(self.scene) ** 2
        link = SubElement(parent, "body", name=body.name, pos=_plane_text(place), euler=f"0 0 {turn:.17g}")
        SubElement(link, "inertial", pos="0 0 0", mass=f"{body.mass:.17g}", diaginertia=f"{inertia:.17g} " * 3)
        slide = {"type": "slide", "axis": _plane_text(cmath.rect(1.0, branch.tilts[1]))}
        hinge = {"type": "hinge", "pos": _plane_text(complex(*branch.points[1]))}
        SubElement(link, "joint", slide if isinstance(branch.joint, SliderJoint) else hinge, name=body.name)
        return link


class MujocoEngine(LoopEngine[MujocoRecipe]):
    """One run through all parts of the motion: the integrators keep nothing of a step that a jump could spoil."""

    name = "mujoco"
    package = "mujoco"
    loop = "engines.mujoco_loop"
    engine_calls = ("mujoco.mj_step", "mujoco.mj_forward", "mujoco.mj_rnePostConstraint")
    callback_calls = ("mujoco.set_mjcb_control",)
    oldest = "3.7"  # the first to count J'q' in a reference acceleration: without it loops bend at every turn
    abilities = Abilities(
        readouts={
            **{c: ReadOut(f"sensor {sensor}; angles of hinges added up") for c, sensor in KINEMATICS.items()},
            Channel.TORQUE: ReadOut("efc_force of the equality at the driver's joint", drive="drive only"),
            Channel.JOINT_FORCE: ReadOut(
                "cfrc_int of the body on it; of a cut efc_force", drive="without drive: a driven slider's is subtracted"
            ),
        },
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS,
        load_states=True,
        friction=True,
        massless=False,
        drivers=frozenset(DriverKind),
    )
    settings: Mapping[type, Mapping[Setting, MujocoRecipe]] = {
        Prescribed: dict(zip(Setting, (NEWCOMER, EXPERT, replace(EXPERT, ratios=(20,))), strict=True)),
        Free: dict(zip(Setting, (NEWCOMER, FREE, replace(FREE, ratios=(12,))), strict=True)),
    }
    studied: Mapping[str, tuple[str, MujocoRecipe]] = {
        "defaults": ("Euler and all else as MuJoCo has it, read as a step leaves it", NEWCOMER),
        "Euler": ("semi-implicit Euler, hard constraints, read at the state", MujocoRecipe(integrator="Euler")),
        "RK4": ("Runge-Kutta of fourth order, hard constraints, read at the state", MujocoRecipe()),
        "RK4 x2": ("RK4 at 1 and 1/2 of the step, extrapolated", MujocoRecipe(ratios=(1, 2), orders=(4, 5))),
    }

    def refusal(self, scene: Scene) -> str | None:
        """The reason, in a sentence, why MuJoCo's tree cannot hold the scene; else None."""
        return spanning_tree(cylinder_as_links(slots_as_blocks(scene, 1.0), 1.0)).obstacle

    def model(self, scene: Scene, recipe: MujocoRecipe) -> Mapping[str, Any]:
        """The scene as plain data by name for ``engines.mujoco_loop``, its XML among them."""
        return MujocoModel(scene, recipe).as_data(recipe)


def _plane_text(vector: complex) -> str:
    """A plane vector, given as a complex number, as MuJoCo's XML writes it: three numbers, the last 0."""
    return f"{vector.real:.17g} {vector.imag:.17g} 0"
