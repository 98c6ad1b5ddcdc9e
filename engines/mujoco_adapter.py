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
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial, reduce
from itertools import product
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from analytic.description.crank_motion import Segment, derivative
from analytic.description.linkage import GROUND, DriverKind
from engines.contract import Abilities, Array, History, ReadOut, Setting
from engines.mechanics.cylinder_links import cylinder_as_links
from engines.mechanics.driver import across_guide
from engines.mechanics.joints import scene_size
from engines.mechanics.loads import instant_pushes
from engines.mechanics.spanning_tree import AT_REST, Branch, ends, slots_as_blocks, spanning_tree
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene, SliderJoint
from engines.stepping.driver import DivergedError, UnsupportedError
from engines.stepping.intervals import Interval
from engines.stepping.recording import State, recorded
from engines.stepping.stepped_engine import Course, Recipe, SteppedEngine

HARDER = 1e-7  # of the inverse weights
PLANE = np.array([1.0, 1j, 0.0])  # vectors of space as complex numbers
KINEMATICS = {Channel.POSITION: "framepos", Channel.VELOCITY: "framelinvel", Channel.ACCELERATION: "framelinacc"}


@dataclass(frozen=True, kw_only=True)
class MujocoRecipe(Recipe):
    """``settle``: the constraints' time constant in samples; 0 leaves all as shipped and reads what a step leaves."""

    at_kinks: bool = True
    integrator: str = "RK4"
    settle: float = 20.0


# Catalogue, quintic run-up, 20 samples to settle; largest torque error, time of the slowest, by steps per turn:
# 100 7e-6 0.05 s, 200 4e-7 0.1 s, 500 1e-8 0.2 s, 1000 2e-9 0.3 s, 2000 3e-10 0.6 s, and no less at 4000. Settling in
# 5, 10, 40 samples instead: 1e-7, 1e-8, 7e-10 at 1000; 40 break near a toggle. In SI the same to all digits.
# Slotted take-up driven for 10 s, φ at 400, 600, 800, 1200 steps per turn: 4e-6, 7e-7, 2e-7, 2e-8 rad, 600 in 2.5 s.
NEWCOMER = MujocoRecipe(step=1e-3, integrator="Euler", settle=0.0, in_own_units=False)
EXPERT = MujocoRecipe(steps_per_turn=200, ratios=(5,))
FREE = MujocoRecipe(steps_per_turn=100, ratios=(6,))


class MujocoWorld:
    """A scene in MuJoCo's own language, compiled, in its start state.

    A body and the hinge or slide that carries it have one name. ``numbers`` are those of the scene's bodies and the
    ground, ``driven`` is the body whose hinge or slide is driven and ``crank`` its number; ``readers`` give a channel
    at the present instant.
    """

    def __init__(self, scene: Scene, recipe: MujocoRecipe) -> None:
        import mujoco

        share = 1e-9 if recipe.settle else 1e-2  # a block's of the lightest body; no mass may be below 1e-15
        light = max(1e-14, share * min(body.mass for body in scene.bodies))
        blocked = cylinder_as_links(slots_as_blocks(scene, light), light)
        self.driven = blocked.crank
        self.scene, self.tree = scene, spanning_tree(blocked)
        self.joints, self.warnings = [joint.name for joint in (*scene.pins, *scene.guided)], list[str]()
        self.bodies = {GROUND: AT_REST, **{body.name: body for body in blocked.bodies}}
        try:
            self.model = model = mujoco.MjModel.from_xml_string(tostring(self.written(recipe), encoding="unicode"))
        except ValueError as error:
            raise UnsupportedError(f"MuJoCo takes no such model: {error}") from error
        self.data = data = mujoco.MjData(model)
        self.crank, self.numbers = model.joint(self.driven).id, [*(model.body(b.name).id for b in scene.bodies), 0]
        if scene.driver_kind is not DriverKind.CRANK:  # a rod without a weight to speak of would make its drive as soft
            model.dof_invweight0[self.crank] = model.body_invweight0[self.numbers[:-1], 0].min()
        if recipe.settle:
            model.opt.tolerance, model.opt.iterations = 0.0, 2  # the second is for the rounding of the first
            lightest = model.body_invweight0[self.numbers].max(axis=0)
            model.body_invweight0[:] = HARDER * np.minimum(model.body_invweight0, lightest)  # blocks weigh nothing
            model.dof_invweight0[:] *= HARDER
        for branch in self.tree.branches:
            turning = branch.body.angular_velocity - self.bodies[branch.parent].angular_velocity
            data.joint(branch.body.name).qvel[:] = branch.speed if isinstance(branch.joint, SliderJoint) else turning
        data.joint(self.driven).qfrc_applied[:] = scene.drive.torque if isinstance(scene.drive, Free) else 0.0
        mujoco.mj_forward(model, data)
        hinges = [self.tree.hinges(body.name) for body in scene.bodies]  # whose angles add up to the body's
        self.turns = np.array([[model.joint(n).name in own for n in range(model.nv)] for own in hinges], dtype=float)
        self.readers: dict[Channel, Any] = {c: partial(self.kinematics, n) for n, c in enumerate(KINEMATICS)}
        self.readers |= {Channel.TORQUE: lambda: float(data.efc_force[0]), Channel.JOINT_FORCE: self.joint_forces}

    def written(self, recipe: MujocoRecipe) -> Element:
        """The scene as MuJoCo's XML."""
        scene, root = self.scene, Element("mujoco")
        SubElement(root, "compiler", angle="radian")
        option = SubElement(root, "option", gravity=_plane(complex(*scene.gravity)), integrator=recipe.integrator)
        SubElement(option, "flag", autoreset="disable")  # a run that breaks is to end as one
        if recipe.settle:
            SubElement(SubElement(root, "default"), "equality", solimp="0.9999 0.9999 1 0.5 2")  # the hardest
        links = {GROUND: SubElement(root, "worldbody")}
        equalities, tendons, sensors = (SubElement(root, kind) for kind in ("equality", "tendon", "sensor"))
        for branch in self.tree.branches:
            links[branch.body.name] = self.hung(branch, links[branch.parent])
        if isinstance(scene.drive, Prescribed):
            SubElement(equalities, "joint", name="/drive", joint1=self.driven)
        for cut in self.tree.cuts:
            sites = f"{cut.name}/1", f"{cut.name}/2"
            SubElement(equalities, "connect", name=cut.name, site1=sites[0], site2=sites[1])
            for site, (link, anchor) in zip(sites, ends(cut), strict=True):
                SubElement(links[link], "site", name=site, pos=_plane(complex(*anchor)))
        for damper in scene.dampers:
            angle = SubElement(tendons, "fixed", damping=f"{damper.coefficient:.17g}")
            ours, theirs = self.tree.hinges(damper.first), self.tree.hinges(damper.second)
            for hinge in sorted(ours ^ theirs):
                SubElement(angle, "joint", joint=hinge, coef="1" if hinge in ours else "-1")
        for body, sensor in product(scene.bodies, KINEMATICS.values()):
            SubElement(sensors, sensor, objtype="body", objname=body.name)
        indent(root)
        return root

    def hung(self, branch: Branch, parent: Element) -> Element:
        """A body inside its parent, with the joint between them; what cannot turn has any inertia."""
        body, host = branch.body, self.bodies[branch.parent]
        place = cmath.rect(1.0, -host.angle) * (complex(*body.position) - complex(*host.position))
        turn, inertia = body.angle - host.angle, body.inertia or body.mass * scene_size(self.scene) ** 2
        link = SubElement(parent, "body", name=body.name, pos=_plane(place), euler=f"0 0 {turn:.17g}")
        SubElement(link, "inertial", pos="0 0 0", mass=f"{body.mass:.17g}", diaginertia=f"{inertia:.17g} " * 3)
        slide = {"type": "slide", "axis": _plane(cmath.rect(1.0, branch.tilts[1]))}
        hinge = {"type": "hinge", "pos": _plane(complex(*branch.points[1]))}
        SubElement(link, "joint", slide if isinstance(branch.joint, SliderJoint) else hinge, name=body.name)
        return link

    def kinematics(self, order: int) -> Array:
        """Rows x, y, angle of the scene's bodies, or their first or second rates."""
        data, bodies = self.data, self.scene.bodies
        frames = data.sensordata.reshape(len(bodies), len(KINEMATICS), 3)[:, order, :2]
        angles = self.turns @ (data.qpos, data.qvel, data.qacc)[order] + [b.angle * (order == 0) for b in bodies]
        return np.column_stack([frames + self.scene.gravity if order == 2 else frames, angles])

    def joint_forces(self) -> Array:
        """On the first bodies of the scene's joints; a slot has become the pin of its block."""
        model, data, forces = self.model, self.data, {}
        for branch in self.tree.branches:
            forces[branch.name] = (1 - 2 * branch.reverse) * data.cfrc_int[model.body(branch.body.name).id, 3:5]
        if self.scene.driver_kind is DriverKind.SLIDER:  # the drive's share is along the guide
            guide = self.scene.driven_slider
            forces[guide.name] = across_guide(guide, forces[guide.name])
        for cut in self.tree.cuts:
            forces[cut.name] = data.efc_force[data.efc_id == model.equality(cut.name).id][:2]
        return np.array([forces[name] for name in self.joints])

    def control(self, segment: Segment | None) -> Callable[[Any, Any], None] | None:
        """What is called at every stage: the drive's reference acceleration and the loads; None where nothing is to do.

        The reference is ε + 2/τ (ω − q') + 1/τ² (φ − q), τ being the constraints' time constant.
        """
        data, crank, numbers, start = self.data, self.crank, self.numbers, self.scene.crank_angle
        pushes, roots = instant_pushes(self.scene), self.model.body_rootid[self.numbers]
        if segment:
            rate = 1.0 / float(self.model.eq_solref[0, 0])
            terms = [np.poly1d(derivative(segment.coefficients, order)) for order in range(3)]
            reference = (terms[2] + 2.0 * rate * terms[1] + rate**2 * (terms[0] - start)).coeffs.tolist()

        drive = self.scene.drive
        timed = drive.torque_at if isinstance(drive, Free) and drive.over_time is not None else None

        def control(_model: object, stage: Any) -> None:  # noqa: ANN401
            if segment:
                x = stage.time - segment.start
                value = reduce(lambda total, coefficient: total * x + coefficient, reference)
                stage.efc_aref[0] = value - 2.0 * rate * data.qvel[crank] - rate**2 * data.qpos[crank]
            if timed:
                data.qfrc_applied[crank] = timed(stage.time)
            if pushes:
                centre, direction = data.xipos[numbers] @ PLANE, data.xmat[numbers][:, [0, 3, 6]] @ PLANE
                spin, arm = data.cvel[numbers, 2], centre - data.subtree_com[roots] @ PLANE
                velocity = data.cvel[numbers, 3:] @ PLANE + 1j * spin * arm  # MuJoCo's is at the tree's mass centre
                state = (each.tolist() for each in (centre, direction, velocity, spin))
                data.xfrc_applied[np.ix_(numbers, (0, 1, 5))] = pushes(start + data.qpos[crank], *state)

        return control if segment or pushes or timed else None


class MujocoEngine(SteppedEngine[MujocoWorld, MujocoRecipe]):
    """One run through all parts of the motion: the integrators keep nothing of a step that a jump could spoil."""

    name = "mujoco"
    package = "mujoco"
    oldest = "3.7"  # the first to count J'q' in a reference acceleration: without it loops bend at every turn
    abilities = Abilities(
        readouts={
            **{c: ReadOut(f"sensor {sensor}; angles of hinges added up") for c, sensor in KINEMATICS.items()},
            Channel.TORQUE: ReadOut("efc_force of the equality at the driver's joint", drive="the drive's alone"),
            Channel.JOINT_FORCE: ReadOut(
                "cfrc_int of the body on it; of a cut efc_force", drive="a slider's, along its guide, is taken out"
            ),
        },
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS,
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
        return spanning_tree(cylinder_as_links(slots_as_blocks(scene, 1.0), 1.0)).obstacle

    def build(self, scene: Scene, recipe: MujocoRecipe) -> MujocoWorld:
        return MujocoWorld(scene, recipe)

    def follow(self, world: MujocoWorld, course: Course[MujocoRecipe]) -> History:
        import mujoco

        mujoco.set_mju_user_warning(world.warnings.append)  # or they go to the terminal and into a file
        try:
            return recorded(course.parts, world.joints, partial(_states, world, course))
        finally:
            mujoco.set_mjcb_control(None)
            mujoco.set_mju_user_warning(None)


def _states(world: MujocoWorld, course: Course[MujocoRecipe], part: Interval, time: Array) -> Iterator[State]:
    import mujoco

    model, data, settle = world.model, world.data, course.recipe.settle
    model.opt.timestep = part.step / course.ratio
    model.eq_solref[:, 0] = settle * part.step or 0.02  # s, as shipped
    mujoco.set_mjcb_control(world.control(part.segment))
    for instant in time.tolist():
        if instant > part.start:
            mujoco.mj_step(model, data, nstep=course.ratio)
        data.time = instant
        if settle:
            mujoco.mj_forward(model, data)  # or forces and accelerations are those of the last step's last stage
        mujoco.mj_rnePostConstraint(model, data)
        if world.warnings:
            raise DivergedError(f"MuJoCo warns: {world.warnings[0]}")
        yield {channel: world.readers[channel]() for channel in course.channels}


def _plane(vector: complex) -> str:
    return f"{vector.real:.17g} {vector.imag:.17g} 0"
