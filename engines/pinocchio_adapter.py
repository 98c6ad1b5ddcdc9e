"""Pinocchio: a library of algorithms for a tree of joints and the constraints that close its loops; it takes no steps.

**Steps.** Pinocchio's ``constraintDynamics`` has the accelerations and the constraints' forces of one state. The steps
are this adapter's: Runge-Kutta of fourth order; a newcomer's are semi-implicit Euler.

**Loops.** A cut joint is a point constraint in space. Nothing moves along z, so its third row is empty, and without a
proximal term every number is silently NaN. A constraint holds accelerations alone: Baumgarte's terms bring the joint
back within a time constant, where a newcomer lets it drift.

**Drive.** A constraint between crank and ground of all six directions, five of them empty, with a desired acceleration.

**Slots.** A block without a weight to speak of slides in the host, and its pin is a cut joint along the block's axes:
in others the block's lightness would leave few digits of the force across the slot.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from analytic.description.linkage import GROUND, Vector
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.joints import scene_size
from engines.mechanics.spanning_tree import Branch, ends, slots_as_blocks, spanning_tree
from engines.scene import GUIDES, LOADS, Channel, Prescribed, Scene, SliderJoint
from engines.stepping.stepped_engine import LoopEngine, Recipe, plain_law

LIGHT = 1e-9  # of the lightest body: what a block weighs


@dataclass(frozen=True, kw_only=True)
class PinocchioRecipe(Recipe):
    """``settle``: the time constant of Baumgarte's terms in samples; 0 has none, and Euler's steps."""

    settle: float = 20.0


NEWCOMER = PinocchioRecipe(step=1e-3, settle=0.0, in_own_units=False)
EXPERT = PinocchioRecipe(steps_per_turn=200, ratios=(5,))


class PinocchioEngine(LoopEngine[PinocchioRecipe]):
    """Prescribed cranks alone."""

    name = "pinocchio"
    package = "pinocchio"
    distribution = "pin"
    oldest = "4.1"
    loop = "engines.pinocchio_loop"
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("data.oMi; angles of hinges added up"),
            Channel.VELOCITY: ReadOut("getFrameVelocity"),
            Channel.ACCELERATION: ReadOut("getFrameClassicalAcceleration"),
            Channel.TORQUE: ReadOut("contact_force of the drive's constraint", drive="the drive's alone"),
            Channel.JOINT_FORCE: ReadOut("data.f of rnea; of a cut contact_force", "the joint's, turned", drive="none"),
        },
        drives=frozenset({Prescribed}),
        joints=GUIDES,
        loads=LOADS,
        massless=False,
    )
    settings: Mapping[type, Mapping[Setting, PinocchioRecipe]] = {
        Prescribed: dict(zip(Setting, (NEWCOMER, EXPERT, replace(EXPERT, ratios=(20,))), strict=True))
    }
    studied: Mapping[str, tuple[str, PinocchioRecipe]] = {
        "defaults": ("semi-implicit Euler, joints left to drift", NEWCOMER),
        "RK4": ("Runge-Kutta of fourth order with Baumgarte's terms", PinocchioRecipe()),
    }

    def refusal(self, scene: Scene) -> str | None:
        return spanning_tree(slots_as_blocks(scene, 1.0)).obstacle

    def model(self, scene: Scene, recipe: PinocchioRecipe) -> Mapping[str, Any]:
        """A body has its joint's number and frame, which has its x-axis along a slide; the ground is 0."""
        tree = spanning_tree(slots_as_blocks(scene, LIGHT * min(body.mass for body in scene.bodies)))
        frames, size = {GROUND: (0, 0j, 0.0, 0.0)}, scene_size(scene)
        joints, reactions = [], dict[str, tuple[int, float]]()

        def point(body: str, anchor: Vector) -> tuple[int, complex]:
            number, origin, tilt, _ = frames[body]
            return number, (complex(*anchor) - origin) * cmath.rect(1.0, -tilt)

        def carried_by(name: str) -> Iterator[Branch]:
            for branch in tree.branches:
                if branch.parent == name:
                    yield branch
                    yield from carried_by(branch.body.name)

        for number, branch in enumerate(carried_by(GROUND), start=1):
            body, (on_host, on_body), (tilt_on_host, tilt) = branch.body, branch.points, branch.tilts
            slides = isinstance(branch.joint, SliderJoint)
            _, _, host_tilt, host_spin = frames[branch.parent]
            frames[body.name] = number, complex(*on_body), tilt, body.angular_velocity
            joints.append((
                *point(branch.parent, on_host), slides * tilt_on_host - host_tilt, slides,
                body.mass, body.inertia or body.mass * size**2, point(body.name, (0.0, 0.0))[1],
                branch.value, branch.speed if slides else body.angular_velocity - host_spin,
            ))  # what cannot turn has any inertia
            reactions[branch.name] = number, -1.0 if branch.reverse else 1.0
        cuts = [(*point(*second), *point(*first)) for first, second in map(ends, tree.cuts)]
        for number, cut in enumerate(tree.cuts, start=len(frames)):
            reactions[cut.name] = number, -1.0
        return {
            "settle": recipe.settle,
            "gravity": scene.gravity,
            "joints": joints,
            "cuts": cuts,
            "bodies": [(frames[body.name][0], body.angle) for body in scene.bodies],
            "reactions": {joint.name: reactions[joint.name] for joint in (*scene.pins, *scene.guided)},
            "forces": [(*point(load.body, load.anchor), plain_law(load.force)) for load in scene.forces],
            "torques": [(frames[load.body][0], plain_law(load.torque)) for load in scene.torques],
            "springs": [
                (*point(s.first, s.first_anchor), *point(s.second, s.second_anchor), s.stiffness, s.length, s.damping)
                for s in scene.springs
            ],
            "dampers": [(frames[d.first][0], frames[d.second][0], d.coefficient) for d in scene.dampers],
        }  # fmt: skip
