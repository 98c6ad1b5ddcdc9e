"""Pinocchio: a library of algorithms for trees of joints and the constraints that close loops; it takes no steps.

**Steps.** Pinocchio's ``constraintDynamics`` has the accelerations and the constraints' forces of one state. The steps
are this adapter's: Runge-Kutta of fourth order; a newcomer's are semi-implicit Euler.

**Joints.** Every body moves freely in the plane, and every joint is a constraint, a *tie*: so every joint force is a
multiplier that Pinocchio returns, and a load is an effort along a coordinate. A tree with as few ties as loops takes
half the time a step, but the forces in its joints have to be had from ``rnea``.

**Ties** are made for space. Nothing moves along z, so some rows are empty, and without a proximal term every number is
silently NaN. They hold accelerations alone: Baumgarte's terms bring a joint back within a time constant, where a
newcomer lets it drift.

**Drive.** The crank is tied, without freedom, to a frame of the ground that turns as the drive does; the moment of this
tie is the drive's torque, its force that of the crank's pin.

**Sliders and slots.** A block without a weight to speak of slides on the host; a slider is tied to it without freedom,
a slot's pin as a point. The tie has the block's axes: in others its lightness would leave few digits of the force.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from dataclasses import astuple, dataclass, replace
from typing import Any

from analytic.description.linkage import GROUND
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.spanning_tree import AT_REST, point_motion
from engines.scene import GUIDES, AppliedForce, AppliedTorque, Channel, Prescribed, Scene, SliderJoint, TurnDamper
from engines.stepping.stepped_engine import LoopEngine, Recipe, plain_law


@dataclass(frozen=True, kw_only=True)
class PinocchioRecipe(Recipe):
    """``settle``: the time constant of Baumgarte's terms in samples; 0 has none, and Euler's steps."""

    settle: float = 10.0


# Catalogue, quintic run-up, 10 samples to settle; largest torque error, CPU time of the slowest, by steps per turn:
# 100 2e-5, 200 1e-6, 400 8e-8 1 s, 1000 2e-9, 2000 3e-10 5 s, and no less at 4000: a slider's force keeps 3e-9, which
# is its block's mass. Settling in 2.5, 5, 20 samples instead: 4e-6, 3e-7, 3e-8 at 400: what a Baumgarte term of so few
# steps leaves, however short they are; near a toggle 40 samples leave ten times as much as 10. In SI the same digits.
NEWCOMER = PinocchioRecipe(step=1e-3, settle=0.0, in_own_units=False)
EXPERT = PinocchioRecipe(steps_per_turn=100, ratios=(4,))


class PinocchioEngine(LoopEngine[PinocchioRecipe]):
    """Prescribed cranks alone."""

    name = "pinocchio"
    package = "pinocchio"
    distribution = "pin"
    oldest = "4.1"
    loop = "engines.pinocchio_loop"
    engine_calls = ("pinocchio.constraintDynamics",)
    abilities = Abilities(
        readouts={
            **dict.fromkeys((Channel.POSITION, Channel.VELOCITY), ReadOut("the adapter's steps of constraintDynamics")),
            Channel.ACCELERATION: ReadOut("constraintDynamics"),
            Channel.TORQUE: ReadOut("contact_force.angular of the drive's constraint", drive="drive only"),
            Channel.JOINT_FORCE: ReadOut("contact_force.linear", "the constraint's, turned", drive="without drive"),
        },
        drives=frozenset({Prescribed}),
        joints=GUIDES,
        loads=frozenset({AppliedForce, AppliedTorque, TurnDamper}),
        massless=False,
    )
    settings: Mapping[type, Mapping[Setting, PinocchioRecipe]] = {
        Prescribed: dict(zip(Setting, (NEWCOMER, EXPERT, replace(EXPERT, ratios=(20,))), strict=True))
    }
    studied: Mapping[str, tuple[str, PinocchioRecipe]] = {
        "defaults": ("semi-implicit Euler, joints left to drift", NEWCOMER),
        "RK4": ("Runge-Kutta of fourth order, joints closed within 40 steps", PinocchioRecipe(settle=40.0)),
    }

    def model(self, scene: Scene, recipe: PinocchioRecipe) -> Mapping[str, Any]:
        """The scene as plain data by name for ``engines.pinocchio_loop``: joints and ties in order, and the loads.

        Each joint comes before the blocks that slide on it, as Pinocchio asks; the drive's tie comes first.

        A joint has its name, what carries it, its place and direction there, mass, inertia, and the start's coordinates
        and their rates; a tie its name, whether it is rigid, the sign of its force on the scene's first body, and the
        frames on two bodies that it holds together: name, place and direction, the crank's the second.
        """
        bodies = {GROUND: AT_REST, **{body.name: body for body in scene.bodies}}
        light, joints, ties = 1e-9 * min(body.mass for body in scene.bodies), list[Any](), list[Any]()
        for pin in sorted(scene.pins, key=lambda pin: {pin.first, pin.second} != {scene.crank, GROUND}):
            ends = (pin.first, pin.first_anchor, 0.0), (pin.second, pin.second_anchor, 0.0)
            row = (1.0, *ends) if pin.first == GROUND else (-1.0, *ends[::-1])
            ties.append((pin.name, not ties, *row))
        for name, body in bodies.items():
            if body is not AT_REST:
                state = (*body.position, body.angle), (*body.velocity, body.angular_velocity)
                inertia = body.inertia or body.mass  # what cannot turn has any
                joints.append((name, GROUND, (0.0, 0.0), 0.0, body.mass, inertia, *state))
            for line in (line for line in scene.guided if line.host == name):
                along, other, block = cmath.phase(complex(*line.along)), bodies[line.body], f"/{line.name}"
                points = zip(point_motion(other, line.anchor), point_motion(body, line.through), strict=True)
                travel = ([((one - two) * cmath.rect(1.0, -along - body.angle)).real] for one, two in points)
                joints.append((block, name, line.through, along, light, light, *travel))
                end = line.body, line.anchor, along + body.angle - other.angle
                ties.append((line.name, isinstance(line, SliderJoint), -1.0, (block, (0.0, 0.0), 0.0), end))
        return {
            "settle": recipe.settle,
            "gravity": scene.gravity,
            "joints": joints,
            "ties": ties,
            "bodies": [body.name for body in scene.bodies],
            "forces": [(load.body, load.anchor, plain_law(load.force)) for load in scene.forces],
            "torques": [(load.body, plain_law(load.torque)) for load in scene.torques],
            "dampers": [astuple(damper) for damper in scene.dampers],
        }
