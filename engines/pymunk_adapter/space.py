"""From a layout to what the loop makes a pymunk space of: bodies, constraints and loads, in plain data.

Bodies are numbers, the ground is -1.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from analytic.description.linkage import GROUND, DriverKind
from engines.mechanics.driver import driven
from engines.mechanics.states import start_motion
from engines.pymunk_adapter.layout import PartLayout, reach
from engines.scene import Prescribed, Scene
from engines.stepping.loop_engine import plain_law

SHORTEST: Final = 0.01  # of the scene's reach: the lever of a linear drive
# Samples on either side, within which nothing is read: of a jump of the acceleration, and of its slope.
JUMP, KINK = 1.5, 0.5
BEHIND: Final = 4.0  # of the reach: how far behind a slider's line its far end begins


def space_data(scene: Scene, layout: PartLayout, *, centred: bool) -> dict[str, Any]:
    """The space of a layout of a scene, without the iterations of its solver."""
    parts, size = layout.scene, reach(scene)
    numbers = {GROUND: -1, **{body.name: number for number, body in enumerate(parts.bodies)}}
    _, speed, gain = (float(value[0]) for value in driven(scene, *start_motion(scene)))
    pins = [
        ("PivotJoint", numbers[pin.first], numbers[pin.second], pin.first_anchor, pin.second_anchor)
        for pin in parts.pins
    ]
    grooves = []
    for groove in parts.guided:
        (x, y), (along_x, along_y), length = groove.through, groove.along, 2.0 * size / math.hypot(*groove.along)
        ends = (x - length * along_x, y - length * along_y), (x + length * along_x, y + length * along_y)
        grooves.append(("GrooveJoint", numbers[groove.host], numbers[groove.body], *ends, groove.anchor))
    angles = {GROUND: 0.0, **{body.name: body.angle for body in parts.bodies}}
    gears = [
        ("GearJoint", numbers[host], numbers[body], angles[body] - angles[host], 1.0) for body, host in layout.gears
    ]
    of_scene = {joint.name for joint in (*scene.pins, *scene.guided)}
    torques = [(numbers[load.body], (0.0, 0.0), plain_law(load.torque)) for load in parts.torques]
    return {
        "centred": centred,
        "gravity": parts.gravity,
        "bodies": [(body.mass, body.inertia, body.position, body.angle) for body in parts.bodies],
        "offsets": [complex(-part.offset[0], -part.offset[1]) for part in layout.parts[: layout.carried]],
        "tangent": layout.tangent(scene),
        "driver_rates": (speed, gain),
        "start": scene.crank_angle,
        "crank": numbers.get(scene.crank),
        "constraints": [*pins, *grooves, *gears],
        "joints": {
            joint.name: number for number, joint in enumerate((*parts.pins, *parts.guided)) if joint.name in of_scene
        },
        "springs": [
            (numbers[each.first], numbers[each.second], each.first_anchor, each.second_anchor, *rest)
            for each in parts.springs
            for rest in [(each.length, each.stiffness, each.damping)]
        ],
        "dampers": [(numbers[each.first], numbers[each.second], each.coefficient) for each in parts.dampers],
        "loads": torques + [(numbers[load.body], load.anchor, plain_law(load.force)) for load in parts.forces],
        "offset": torque_bound(scene, size) if centred else 0.0,
        **_drive(parts, numbers, size),
    }


def _drive(scene: Scene, numbers: dict[str, int], size: float) -> dict[str, Any]:
    """The drive: its motion, or its torque over time; ``line``, the ends of a linear driver.

    A slider's far end is a point of the ground on its own line, behind all that it can reach: ``base`` farther than
    its travel.
    """
    drive, line, base = scene.drive, None, 0.0
    if scene.driver_kind is not DriverKind.CRANK:
        first, second, here, there = scene.driver_ends
        if scene.cylinder is None:
            base, along = BEHIND * size, scene.driven_slider.along
            there = there[0] - base * along[0], there[1] - base * along[1]
        line = (numbers[first], here), (numbers[second], there)
    given: dict[str, Any] = {"line": line, "base": base, "motion": None, "kinks": (), "push": (0.0, None)}
    if isinstance(drive, Prescribed):
        segments, jumps = drive.motion.segments, drive.motion.jumps
        given["kinks"] = [(each.start, JUMP if each.start in jumps else KINK) for each in segments[1:]]
        given["motion"] = [(each.start, each.coefficients) for each in segments]
    else:
        given["push"] = drive.torque, drive.over_time and (drive.over_time.times, drive.over_time.torque)
    return given


def torque_bound(scene: Scene, size: float) -> float:
    """A torque well above any that a prescribed drive can need, N m: all mass at the scene's size, at its peak.

    A motor works against it, which keeps the sign of what it exerts. Of a linear drive it is a force, N, at a lever of
    a hundredth of that size.
    """
    if not isinstance(scene.drive, Prescribed):
        return 0.0
    motion = scene.drive.motion
    times = np.linspace(0.0, motion.duration, 101)
    arm = 1.0 if scene.driver_kind is DriverKind.CRANK else SHORTEST * size
    speed = motion.peak_speed / arm
    rate = float(np.max(np.abs(motion.acceleration(times)))) / arm + speed**2
    weight = sum(body.mass for body in scene.bodies)
    bound = rate * (weight * size**2 + sum(body.inertia or 0.0 for body in scene.bodies))
    bound += weight * math.hypot(*scene.gravity) * size
    bound += sum(float(np.max(np.abs(load.force.values))) for load in scene.forces) * size
    bound += sum(float(np.max(np.abs(load.torque.values))) for load in scene.torques)
    bound += sum(damper.coefficient for damper in scene.dampers) * speed
    bound += sum(spring.stiffness + spring.damping * speed for spring in scene.springs) * size**2
    return bound / arm
