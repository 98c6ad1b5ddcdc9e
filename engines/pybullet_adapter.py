"""PyBullet: every body moves freely and is tied by constraints, all of which a step closes to first order.

**Second order.** With ``erp`` at 1 a step closes all that has opened, and by the velocities that move the bodies: these
are then those of its middle. A joint within a multibody is closed by itself, but forces of inertia in it are those of
the velocities before the step, and so of first order. So pins are constraints, and nothing with a mass is a link.

**Solver.** As shipped, Gauss-Seidel's iterations begin anew in every step: 200 of them leave 1e-6 of a force of a
four-bar, in thirty times the time in which Dantzig's algorithm, which comes with Bullet, leaves rounding.

**Drive.** The crank's pin is a fixed constraint to the ground, whose frame is turned before every step to where the
crank is to be after it; the torque is the last of its reactions.

**Guides.** A block without a weight to speak of slides in the host, as a link of it. A slot's body is pinned to it, a
slider fixed to it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from analytic.description.linkage import GROUND
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import body_numbers, start_motion
from engines.scene import GUIDES, AppliedForce, AppliedTorque, Channel, Prescribed, Scene, TurnDamper
from engines.stepping.stepped_engine import LoopEngine, Recipe

LEAD = 6  # steps before the start; after four, nothing shows of how the bodies began


@dataclass(frozen=True, kw_only=True)
class PybulletRecipe(Recipe):
    """``centred``: to second order, every read-out at its own instant; else all as shipped and at face value."""

    centred: bool = True
    restarted: bool = False
    orders: tuple[int, ...] = (2, 3, 4, 5)


# Constant speed, fork-takeup, errors of torque and Jeq by steps per turn: 3000 2.8e-5, 1.8e-5; 4200 1.4e-5, 9.1e-6;
# 5000 1.0e-5, 6.4e-6; jansen-leg needs 6000, whitworth-quick-return 8200. Extrapolated from 600, 1000 and 1400: torque
# 7e-9.
# A block's mass, in the lightest body's, shows in a slider's force as it is, and divides the rounding; best, largest
# errors of juki-mf7923d and of the slotted take-up: 1e-7 2.8e-7, 5.5e-8; 1e-8 2.8e-8, 5e-7; 1e-10 8e-5 of the latter.
# Constraints between 1e-8 and 1e-5 in softness leave the same to two digits.
# A swing's acceleration has a kink where it turns, of which a step shows the mean: watt-six-bar, rocking, torque by
# the least samples of a segment: 8 9e-4, 24 3e-4, 48 1.5e-4.
NEWCOMER = PybulletRecipe(step=1e-3, centred=False, in_own_units=False)
TUNED = PybulletRecipe(steps_per_turn=200, ratios=(45,), least_steps=48)
BEST = PybulletRecipe(steps_per_turn=200, ratios=(3, 5, 7), least_steps=48)


class PybulletEngine(LoopEngine[PybulletRecipe]):
    """Prescribed cranks alone: a free one's 160 turns would be a million steps, a minute."""

    name = package = "pybullet"
    oldest = "3.2.7"
    loop = "engines.pybullet_loop"
    engine_calls = ("pybullet.stepSimulation", "pybullet.changeConstraint", "pybullet.getBaseVelocity")
    chatters = True
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("getBasePositionAndOrientation"),
            Channel.VELOCITY: ReadOut("getBaseVelocity", instant="half a step after the positions"),
            Channel.ACCELERATION: ReadOut("difference of getBaseVelocity over the step"),
            Channel.TORQUE: ReadOut("getConstraintState of the crank's pin, its last", drive="drive only"),
            Channel.JOINT_FORCE: ReadOut("getConstraintState", drive="without drive"),
        },
        drives=frozenset({Prescribed}),
        joints=GUIDES,
        loads=frozenset({AppliedForce, AppliedTorque, TurnDamper}),
        varying_loads=False,
        massless=False,
    )
    settings: Mapping[type, Mapping[Setting, PybulletRecipe]] = {
        Prescribed: dict(zip(Setting, (NEWCOMER, TUNED, BEST), strict=True))
    }
    studied: Mapping[str, tuple[str, PybulletRecipe]] = {
        "defaults": ("PyBullet's defaults at a fixed step, every read-out at face value", NEWCOMER),
        "centred": ("all that has opened closed in every step, read-outs at their own instants", PybulletRecipe()),
        "centred x2": ("the same, extrapolated from the step over 1 and 3", PybulletRecipe(ratios=(1, 3))),
    }

    def model(self, scene: Scene, recipe: PybulletRecipe) -> Mapping[str, Any]:
        """The scene of a prescribed crank as plain data by name, arrays among them, for ``engines.pybullet_loop``."""
        assert isinstance(scene.drive, Prescribed)
        equations, numbers, motion = JointEquations(scene, unit=1.0), body_numbers(scene), scene.drive.motion
        pose, (place, rate, _) = equations.start(), start_motion(scene)
        arms = equations.arms(pose)
        drive = next(n for n, pin in enumerate(scene.pins) if {pin.first, pin.second} == {scene.crank, GROUND})
        return {
            "lead": LEAD if recipe.centred else 0,
            "gravity": scene.gravity,
            "motion": [(each.start, each.coefficients) for each in motion.segments],
            # A run that begins before the start has its velocities from the joints and the drive.
            "start": (place, 0.0 * rate if recipe.centred else rate),
            "bodies": [*((body.mass, body.inertia or body.mass) for body in scene.bodies), (0.0, 0.0)],
            "names": equations.joints,
            "ends": (equations.body, arms.body[0], equations.host, arms.host[0]),
            "guides": dict(enumerate(arms.along[0], start=equations.pins)),
            "fixed": [drive, *range(equations.pins, equations.pins + len(scene.sliders))],
            "drive": (drive, 1.0 if scene.pins[drive].second == GROUND else -1.0),
            "forces": [(numbers[f.body], pose.arm(numbers[f.body], f.anchor)[0], f.force.values) for f in scene.forces],
            "torques": [(numbers[torque.body], torque.torque.values[0]) for torque in scene.torques],
            "dampers": [(numbers[each.first], numbers[each.second], each.coefficient) for each in scene.dampers],
        }
