"""Drake: a discrete plant, solved by SAP, in which every body moves freely in the plane and pins are ball constraints.

**Second order.** A step of Drake's solves the constraints at its start and moves the bodies by the velocities after it:
these are those of the step's middle, and the forces those of its start. So the motion is of second order as long as no
force depends on velocities. In a tree of joints forces of inertia do, and it is of first order. Here every body has the
coordinates x, y and angle of its own, a guided one its path alone.

**Drive.** The crank's actuator has a controller, solved with the constraints: without damping, and so stiff that the
crank is where it is to be at the end of every step. Still stiffer, rounding shows in its torque.

**Slots.** Drake has no pin in a slot: the pin stays at its distance from a point of the host, 100,000 times as far as
the scene is large. A circle of that radius leaves the line by some 1e-6 of its size; with a larger one the rounding of
the distance, divided by the square of the step, shows in forces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from analytic.description.linkage import GROUND
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.joints import JointEquations, scene_size
from engines.mechanics.states import pose_of, start_coordinate, start_motion
from engines.scene import GUIDES, AppliedForce, Channel, Prescribed, Scene, SlotJoint, TurnDamper
from engines.stepping.stepped_engine import LoopEngine, Recipe

FAR = 1e5  # sizes of the scene
STIFFNESS = 3.0  # of the drive, in total mass · size² / step²


@dataclass(frozen=True, kw_only=True)
class DrakeRecipe(Recipe):
    """``lead``: steps by which the drive is ahead, as a centred read-out needs it; 0 as a newcomer has it."""

    lead: float = 1.0
    restarted: bool = False


# TUNED takes 6000 steps a turn, and 960 at least for a segment: where a swing turns, its acceleration has a kink, of
# which a step shows the mean. A double rocker that rocks within 0.1 s, torque by the least samples of a segment:
# 8 2.8e-4, 16 7e-5, 32 1.8e-5, 48 8e-6.
# Catalogue, quintic run-up, largest errors of torque, joint forces and Jeq, CPU time of the slowest, by steps per turn:
# 4000 5e-5, 4e-5, 1.9e-5, 8 s; 6000 5e-5, 5e-5, 9e-6, 10 s: rounding shows. Of the slotted take-up at 1000:
# 5e-4, 4e-4, 2 s.
NEWCOMER = DrakeRecipe(step=1e-3, lead=0.0, in_own_units=False)
TUNED = DrakeRecipe(steps_per_turn=100, ratios=(60,), least_steps=16)


class DrakeEngine(LoopEngine[DrakeRecipe]):
    """Prescribed cranks alone: a free one's 160 turns would be a million steps, some two minutes."""

    name = "drake"
    package = "pydrake"
    distribution = "drake"
    oldest = "1.51"
    loop = "engines.drake_loop"
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("GetPositions"),
            Channel.VELOCITY: ReadOut("GetVelocities; mean of half a step before and after"),
            Channel.ACCELERATION: ReadOut("generalized_acceleration port"),
            Channel.TORQUE: ReadOut("net_actuation port", drive="drive only"),
            Channel.JOINT_FORCE: ReadOut("reaction_forces port", "the child frame's, turned", drive="without drive"),
        },
        drives=frozenset({Prescribed}),
        joints=GUIDES,
        loads=frozenset({AppliedForce, TurnDamper}),
        varying_loads=False,
        massless=False,
        settings=frozenset({Setting.NAIVE, Setting.TUNED}),  # rounding and slots leave little to extrapolate
    )
    settings: Mapping[type, Mapping[Setting, DrakeRecipe]] = {
        Prescribed: {Setting.NAIVE: NEWCOMER, Setting.TUNED: TUNED}
    }
    studied: Mapping[str, tuple[str, DrakeRecipe]] = {
        "defaults": ("Drake's defaults, every read-out at face value", NEWCOMER),
        "centred": ("every read-out at its own instant", DrakeRecipe()),
    }

    def refusal(self, scene: Scene) -> str | None:
        """The reason, in a sentence, to refuse a scene with a slider or turn damper not on the ground; else None."""
        ends = [{slider.host} for slider in scene.sliders] + [{damper.first, damper.second} for damper in scene.dampers]
        return None if all(GROUND in each for each in ends) else "it takes no slider or turn damper but on the ground"

    def model(self, scene: Scene, recipe: DrakeRecipe) -> Mapping[str, Any]:
        """The scene of a prescribed crank as plain data by name, arrays among them, for ``engines.drake_loop``."""
        assert isinstance(scene.drive, Prescribed)
        start, segments, far = start_motion(scene), scene.drive.motion.segments, FAR * scene_size(scene)
        joints = [(pin.name, *pin.ends, 0.0) for pin in scene.pins]
        arms = JointEquations(scene, unit=1.0).arms(pose_of(start[0]))
        for slot, gap, along in zip(scene.guided, arms.gap[0, len(scene.pins) :], arms.along[0], strict=True):
            if isinstance(slot, SlotJoint):  # a circle that crosses the line on both sides of where the pin starts
                centre = complex(*slot.through) + (gap @ along + 1j * far * (1.0 - 0.3 / FAR**2)) * complex(*slot.along)
                joints.append((slot.name, slot.ends[0], (slot.host, (centre.real, centre.imag)), far))
        return {
            "lead": recipe.lead,
            "gravity": scene.gravity,
            "crank": scene.crank,
            "stiffness": STIFFNESS * scene_size(scene) ** 2 * sum(body.mass for body in scene.bodies),
            "bodies": [(b.name, b.mass, b.inertia, b.position, b.angle) for b in scene.bodies],
            "start": start,
            "guides": {slider.body: (slider.name, slider.along) for slider in scene.sliders},
            "dampers": [(damper.first, damper.second, damper.coefficient) for damper in scene.dampers],
            "joints": joints,
            "loads": [(load.body, load.anchor, load.force.values) for load in scene.forces],
            "motion": [(s.start, [s.coefficients[0] - start_coordinate(scene), *s.coefficients[1:]]) for s in segments],
        }
