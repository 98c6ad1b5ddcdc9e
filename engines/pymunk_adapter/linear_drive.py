"""A slider of the ground or a cylinder as the driver: a ``PinJoint`` whose distance is set before every step.

pymunk closes a pin joint as it does any other: after the step to come its ends are as far apart as has been set. A
slider's far end is a point of the ground on its own line, behind all that it can reach.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from engines.scene import Scene

if TYPE_CHECKING:
    import pymunk

BEHIND: Final = 4.0  # of the reach: how far behind a slider's line begins
FAR: Final = 1e15  # m: a spring of that length pulls or pushes with a constant force, to rounding


@dataclass(frozen=True)
class Line:
    """The two ends of a linear driver; ``base``, m, is how much farther apart they are than its travel."""

    first: pymunk.Body
    second: pymunk.Body
    first_anchor: tuple[float, float]
    second_anchor: tuple[float, float]
    base: float = 0.0

    @property
    def ends(self) -> tuple[pymunk.Body, pymunk.Body, tuple[float, float], tuple[float, float]]:
        """As constraints take them."""
        return self.first, self.second, self.first_anchor, self.second_anchor

    def pin(self) -> pymunk.PinJoint:
        """What prescribes the distance; without a bias it is off by no more than the step makes it."""
        import pymunk

        joint = pymunk.PinJoint(*self.ends)
        joint.error_bias = 0.0
        return joint

    def push(self, force: float) -> pymunk.DampedSpring:
        """A constant force that pushes the ends apart, N."""
        import pymunk

        spring = pymunk.DampedSpring(*self.ends, FAR, 0.0, 0.0)
        set_push(spring, force)
        return spring

    def travel(self, ahead: float) -> float:
        """φ, m, ``ahead`` seconds from now at the present velocities."""
        places = []
        for body, (x, y) in ((self.first, self.first_anchor), (self.second, self.second_anchor)):
            (px, py), (vx, vy), turn = body.position, body.velocity, body.angle + ahead * body.angular_velocity
            c, s = math.cos(turn), math.sin(turn)
            places.append((px + ahead * vx + c * x - s * y, py + ahead * vy + s * x + c * y))
        return math.dist(*places) - self.base


def set_push(spring: pymunk.DampedSpring, force: float) -> None:
    """Let a spring of FAR push its ends apart by a force, N."""
    spring.rest_length, spring.stiffness = math.copysign(FAR, force), abs(force) / FAR


def line_of(scene: Scene, ends: Mapping[str, pymunk.Body], reach: float) -> Line:
    """The ends of a scene's linear driver."""
    first, second, here, there = scene.driver_ends
    if scene.cylinder is not None:
        return Line(ends[first], ends[second], here, there)
    base, along = BEHIND * reach, scene.driven_slider.along
    return Line(ends[first], ends[second], here, (there[0] - base * along[0], there[1] - base * along[1]), base)
