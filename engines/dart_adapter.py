"""DART: a velocity-level engine in which every body moves freely in the plane and joints are constraints on probes.

**Second order.** A step changes velocities by the forces at its start, closes the joints' gaps by these velocities and
moves the bodies by them: they are those of the step's middle, and the forces those of its start. So the motion is of
second order as long as no force depends on velocities. In a tree of joints forces of inertia do, and it is of first
order. Here every body has the coordinates x, y and angle of its own. As shipped a step closes a hundredth of a gap: the
joints open, and the torque is off by a third and more.

**Forces.** The force of a constraint cannot be read. A constraint acts on a probe without weight to speak of, which a
joint of its carrier's holds: the force in that joint is read. A probe that slides on its carrier makes a guide or slot
of the same constraint; DART's own constraint of that kind lets the pair of forces turn the two bodies, as it does not
act on both in one place.

**Drive.** A joint with a velocity as command has it exactly: the crank is where it is to be at the end of every step.
``Joint.getForce`` lacks there what the constraints add; the force on the body has all of the torque. On a hinge of its
own the crank would take no impulse of a constraint at all: it needs x and y beside the angle.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from analytic.description.linkage import GROUND
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import pose_of, start_motion
from engines.scene import GUIDES, AppliedForce, Channel, Prescribed, Scene, SliderJoint, TurnDamper
from engines.stepping.stepped_engine import LoopEngine, Recipe


@dataclass(frozen=True, kw_only=True)
class DartRecipe(Recipe):
    """``centred``: every read-out at its own instant, joints closed in every step; else all as a newcomer has it."""

    centred: bool = True
    restarted: bool = False


# TUNED takes 8000 steps a turn, BEST 4500 in all.
# Catalogue, quintic run-up, largest errors of torque, joint forces and velocities, CPU time of the slowest, by steps a
# turn: 2000 6e-5, 7e-5, 2.2e-5, 2 s; 4000 1.4e-5, 1.7e-5, 5e-6, 5 s; 8000 4e-6, 4e-6, 1.2e-6, 8 s, which quick returns
# need. BEST: 2e-7, 4e-8, 1e-9, 5 s.
# A swing's acceleration has a kink where it turns, of which a step shows the mean: watt-six-bar, rocking, torque by
# the least samples of a segment: 8 5e-4, 20 2e-4, 28 1.4e-4.
NEWCOMER = DartRecipe(step=1e-3, centred=False, in_own_units=False)


class DartEngine(LoopEngine[DartRecipe]):
    """Prescribed cranks alone: a free one's 160 turns would be a million steps."""

    name = "dart"
    package = distribution = "dartpy"
    oldest = "6.20"
    loop = "engines.dart_loop"
    engine_calls = ("dartpy.simulation.World.step",)
    chatters = True
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("Skeleton.getPositions"),
            Channel.VELOCITY: ReadOut("Skeleton.getVelocities; mean of half a step before and after"),
            Channel.ACCELERATION: ReadOut("Skeleton.getAccelerations"),
            Channel.TORQUE: ReadOut("BodyNode.getBodyForce of the crank", drive="drive only"),
            Channel.JOINT_FORCE: ReadOut(
                "BodyNode.getBodyForce of a probe", "the probe's, turned", drive="without drive"
            ),
        },
        drives=frozenset({Prescribed}),
        joints=GUIDES,
        loads=frozenset({AppliedForce, TurnDamper}),
        varying_loads=False,
        massless=False,
    )
    settings: Mapping[type, Mapping[Setting, DartRecipe]] = {
        Prescribed: {
            Setting.NAIVE: NEWCOMER,
            Setting.TUNED: DartRecipe(steps_per_turn=100, ratios=(80,), least_steps=28),
            Setting.BEST: DartRecipe(steps_per_turn=100, ratios=(10, 15, 20), orders=(2, 3), least_steps=28),
        }
    }
    studied: Mapping[str, tuple[str, DartRecipe]] = {
        "defaults": ("DART's defaults, every read-out at face value", NEWCOMER),
        "centred": ("joints closed in every step, every read-out at its own instant", DartRecipe()),
        "centred x2": ("centred at 1 and 1/2 of the step, extrapolated", DartRecipe(ratios=(1, 2), orders=(2, 3))),
    }

    def model(self, scene: Scene, recipe: DartRecipe) -> Mapping[str, Any]:
        """The scene of a prescribed crank as plain data by name, arrays among them, for ``engines.dart_loop``."""
        assert isinstance(scene.drive, Prescribed)
        turning = {body.name for body in scene.bodies if body.inertia is not None}
        start, joints = start_motion(scene), list[Any]()
        for pin in scene.pins:
            ends = (pin.first, pin.first_anchor, pin.second, -1.0), (pin.second, pin.second_anchor, pin.first, 1.0)
            carrier, point, other, sign = ends[pin.first == GROUND]  # on the ground a probe would not move
            joints.append((pin.name, (carrier, other), (point, None), sign, False))
        arms = JointEquations(scene, unit=1.0).arms(pose_of(start[0]))
        for guide, gap, along in zip(scene.guided, arms.gap[0, len(scene.pins) :], arms.along[0], strict=True):
            point = tuple(a + gap @ along * b for a, b in zip(guide.through, guide.along, strict=True))
            keeps_angle = isinstance(guide, SliderJoint) and guide.body in turning
            joints.append((guide.name, (guide.host, guide.body), (point, guide.along), 1.0, keeps_angle))
        return {
            "centred": recipe.centred,
            "gravity": scene.gravity,
            "crank": scene.crank,
            "bodies": [(body.name, body.mass, body.inertia) for body in scene.bodies],
            "start": start,
            "joints": joints,
            "loads": [(load.body, load.anchor, load.force.values) for load in scene.forces],
            "dampers": [(damper.first, damper.second, damper.coefficient) for damper in scene.dampers],
            "motion": [(segment.start, segment.coefficients) for segment in scene.drive.motion.segments],
        }
