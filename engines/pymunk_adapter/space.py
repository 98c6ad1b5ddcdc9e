"""From a layout to what the loop makes a pymunk space of: bodies, constraints and loads, in plain data.

Bodies are numbers, the ground is -1. Where the run is not centred everything is as pymunk has it: its own springs damp,
to first order; else dampers and dashpots are stepped beside them.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.description.linkage import GROUND, DriverKind
from engines.mechanics.driver import driven
from engines.mechanics.states import start_motion
from engines.pymunk_adapter.layout import Gear, Hold, PartLayout, start_turn
from engines.scene import Free, PinJoint, Prescribed, Scene
from engines.stepping.loop_engine import plain_law

SHORTEST: Final = 0.01  # of the scene's reach: the lever of a linear drive
BEHIND: Final = 4.0  # of the reach: how far behind a slider's line its far end begins


def described(layout: PartLayout, *, centred: bool) -> dict[str, Any]:
    """The space of a layout, without the iterations of its solver."""
    scene, drive = layout.scene, layout.scene.drive
    numbers = {GROUND: -1, **{body.name: number for number, body in enumerate(scene.bodies)}}
    _, speed, gain = (float(value[0]) for value in driven(scene, *start_motion(scene)))
    return {
        "centred": centred,
        "gravity": scene.gravity,
        "bodies": [(body.mass, body.inertia, body.position, body.angle) for body in scene.bodies],
        "velocity": [(*body.velocity, body.angular_velocity) for body in scene.bodies],
        "acceleration": [(*body.acceleration, body.angular_acceleration) for body in scene.bodies],
        "driver_rates": (speed, gain),
        "start": scene.crank_angle,
        "crank": numbers.get(scene.crank),
        "holds": [_hold(numbers, layout, hold) for hold in layout.holds],
        "joints": {
            hold.name: number for number, hold in enumerate(layout.holds)
            if not isinstance(hold, Gear) and hold.name not in layout.inner
        },
        "offsets": [(-part.offset[0], -part.offset[1]) for part in layout.parts[: layout.carried]],
        "flywheel": layout.flywheel,
        "is_driven": isinstance(drive, Prescribed),
        **_loads(scene, numbers, centred=centred),
        **_drive(scene, numbers, layout, centred=centred),
    }  # fmt: skip


def _hold(numbers: dict[str, int], layout: PartLayout, hold: Hold) -> tuple[Any, ...]:
    """A constraint as pymunk calls it, its bodies, and what it takes besides."""
    if isinstance(hold, PinJoint):
        return "PivotJoint", numbers[hold.first], numbers[hold.second], hold.first_anchor, hold.second_anchor
    ends = numbers[hold.host], numbers[hold.body]
    if isinstance(hold, Gear):
        return "GearJoint", *ends, start_turn(layout.scene, hold), 1.0
    (x, y), (along_x, along_y), length = hold.through, hold.along, 2.0 * layout.reach
    start, end = (x - length * along_x, y - length * along_y), (x + length * along_x, y + length * along_y)
    return "GrooveJoint", *ends, start, end, hold.anchor


def _loads(scene: Scene, numbers: dict[str, int], *, centred: bool) -> dict[str, Any]:
    """Springs; constant forces, which pymunk carries by itself; loads over the angle; dampers and dashpots."""
    springs, dashpots = [], []
    for number, spring in enumerate(scene.springs):
        # A dashpot alone is stepped as a change of rest length, which needs some stiffness to act on.
        stiffness = spring.stiffness or spring.damping if centred else spring.stiffness
        ends = numbers[spring.first], numbers[spring.second], spring.first_anchor, spring.second_anchor
        springs.append((*ends, spring.length, stiffness, 0.0 if centred else spring.damping))
        if centred and spring.damping:
            dashpots.append((number, spring.damping / stiffness, spring.length if spring.stiffness else None))
    over_angle = [
        (numbers[load.body], load.anchor, plain_law(load.force))
        for load in scene.forces if not load.force.is_constant
    ] + [
        (numbers[load.body], (0.0, 0.0), plain_law(load.torque))
        for load in scene.torques if not load.torque.is_constant and load.body != GROUND
    ]  # fmt: skip
    constant = [load for load in scene.forces if load.force.is_constant]
    return {
        "springs": springs,
        "dashpots": dashpots,
        "dampers": [(numbers[each.first], numbers[each.second], each.coefficient) for each in scene.dampers],
        "pushes": [(numbers[load.body], load.anchor, load.force.values) for load in constant],
        "over_angle": over_angle,
    }


def _drive(scene: Scene, numbers: dict[str, int], layout: PartLayout, *, centred: bool) -> dict[str, Any]:
    """The drive: constant torques; ``line``, the ends of a linear driver, ``base`` farther apart than its travel.

    A slider's far end is a point of the ground on its own line, behind all that it can reach. A motor works against a
    torque, the ``offset``, which keeps the sign of what it exerts.
    """
    drive, line, base = scene.drive, None, 0.0
    if scene.driver_kind is not DriverKind.CRANK:
        first, second, here, there = scene.driver_ends
        if scene.cylinder is None:
            base, along = BEHIND * layout.reach, scene.driven_slider.along
            there = there[0] - base * along[0], there[1] - base * along[1]
        line = (numbers[first], here), (numbers[second], there)
    offset = torque_bound(scene, layout, drive.motion) if isinstance(drive, Prescribed) and centred else 0.0
    constant = drive.torque if isinstance(drive, Free) else offset
    torques = [
        (numbers[load.body], load.torque.values[0])
        for load in scene.torques if load.torque.is_constant and load.body != GROUND
    ]  # fmt: skip
    timed = drive.over_time if isinstance(drive, Free) else None
    return {
        "torques": torques if line else [*torques, (numbers[scene.crank], constant)],
        "linear_push": constant if line else 0.0,
        "over_time": timed and (timed.times, timed.torque),
        "offset": offset,
        "line": line,
        "base": base,
    }


def torque_bound(scene: Scene, layout: PartLayout, motion: CrankMotion) -> float:
    """A torque well above any that the drive can need, N m: all mass at the scene's size, at the peak of the motion.

    Of a linear drive it is a force, N, at a lever of a hundredth of that size.
    """
    times, turns = np.linspace(0.0, motion.duration, 101), scene.driver_kind is DriverKind.CRANK
    size = layout.reach
    arm = 1.0 if turns else SHORTEST * size
    rate = float(np.max(np.abs(motion.acceleration(times)))) / arm + (motion.peak_speed / arm) ** 2
    weight = sum(part.mass for part in layout.parts)
    bound = rate * (weight * size**2 + sum(part.inertia or 0.0 for part in layout.parts))
    bound += weight * math.hypot(*scene.gravity) * size
    bound += sum(float(np.max(np.abs(load.force.values))) for load in scene.forces) * size
    bound += sum(float(np.max(np.abs(load.torque.values))) for load in scene.torques)
    bound += sum(damper.coefficient for damper in scene.dampers) * motion.peak_speed / arm
    bound += sum(spring.stiffness + spring.damping * motion.peak_speed / arm for spring in scene.springs) * size**2
    return bound / arm
