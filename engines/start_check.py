"""Does a state fit the joints? The check that engines leave out: most run a broken linkage on and report success.

Positions, velocities and accelerations are tried alike, since an acceleration that breaks a joint is enough to make an
undamped integrator ring for the whole run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from engines.mechanics.joints import JointEquations, scene_size
from engines.mechanics.states import Reals, pose_of, start_motion
from engines.scene import Prescribed, Scene

QUANTITIES = ("position", "velocity", "acceleration")
UNITS = ("m", "m/s", "m/s²")


@dataclass(frozen=True)
class Misfit:
    """How far a joint is violated in position, velocity or acceleration (``order`` 0, 1, 2)."""

    joint: str
    order: int
    size: float


def misfits(scene: Scene, *motion: Reals) -> Iterator[Misfit]:
    """Every joint's violation in position and, where given, velocity and acceleration, each (1, bodies, 3), SI.

    The ground is the last body. A slider's turning against its host counts from the velocity on, as its angle is
    whatever it was at the start.
    """
    equations = JointEquations(scene, unit=1.0)
    pose = pose_of(motion[0])
    arms = equations.arms(pose)
    for order, values in enumerate(motion):
        if order == 0:
            residual = equations.residual(pose, arms)
        else:
            residual = (equations.jacobian(arms) @ equations.gather(values)[..., None])[..., 0]
        if order == 2:
            residual = residual - equations.bend(arms, motion[1])
        for joint, size in zip(equations.joints, equations.openings(residual)[0], strict=True):
            yield Misfit(joint, order, float(size))
        for slider in scene.sliders if order else ():
            arm = math.hypot(*slider.anchor) or scene_size(scene)
            turn = values[0, equations.index[slider.body], 2] - values[0, equations.index[slider.host], 2]
            yield Misfit(slider.name, order, arm * abs(float(turn)))


def start_misfit(scene: Scene, tolerance: float = 1e-6) -> str | None:
    """One sentence on the joint the start state fits worst, or on a crank that is not where its drive has it."""
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    if isinstance(scene.drive, Prescribed):
        segment = scene.drive.motion.segments[0]
        driven = [float(segment.value(segment.start, order)) for order in range(3)]
        actual = [crank.angle, crank.angular_velocity, crank.angular_acceleration]
        for name, expected, got in zip(QUANTITIES, driven, actual, strict=True):
            if abs(expected - got) > tolerance * max(1.0, abs(expected)):
                return f"the crank starts with an angular {name} of {got:g}, its drive with {expected:g}"
    size = scene_size(scene)
    fastest = max(math.hypot(*b.velocity) + abs(b.angular_velocity) * size for b in scene.bodies)
    hardest = max(math.hypot(*b.acceleration) + abs(b.angular_acceleration) * size for b in scene.bodies)
    scales = (size, fastest or 1.0, (hardest + fastest**2 / size) or 1.0)
    violated = [
        miss for miss in misfits(scene, *start_motion(scene)) if not miss.size <= tolerance * scales[miss.order]
    ]
    if not violated:
        return None
    worst = max(violated, key=lambda miss: miss.size / scales[miss.order])
    where = f"joint '{worst.joint}' by {worst.size:.3g} {UNITS[worst.order]}"
    return f"the start state violates {where} in {QUANTITIES[worst.order]}; give one that fits every joint"
