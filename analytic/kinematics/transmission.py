"""Transmission angle of a dyad: how well its links transmit force to each other: 90° at best, 0° in a dead position.

Of two rods (RRR) it is the angle between them at their common pin (Alt). Of a rod and a slide (RRP) it is the angle
between the rod and the slide's normal; of a slide between two pins (RPR) the angle between the line through the pins
and the slide's normal; of two slides (RPP, PRP) the angle between them. It is the acute angle of the two lines, for
130° push as well as 50°, so that it has a kink where they are square to each other. In each case its sine is the
determinant of the dyad's closure equations over the lengths in it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.kinematics import frames
from analytic.kinematics.frames import Pair
from analytic.kinematics.structure import Dyad, Joint, Prismatic, Revolute
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]


def transmission_angle(sweep: Sweep, dyad: Dyad) -> Array:
    """The dyad's transmission angle, rad, in [0, π/2], at every crank angle of the sweep."""
    pair, other = _parallel_when_dead(sweep, dyad)
    angle = np.arctan2(np.abs(frames.cross(pair, other)), np.abs(frames.dot(pair, other)))  # of the two lines, acute
    return np.copy(np.broadcast_to(angle, sweep.angle.shape))


def _parallel_when_dead(sweep: Sweep, dyad: Dyad) -> tuple[Pair, Pair]:
    """The two directions that are parallel in a dead position."""
    for link in dyad.links:
        sweep.poses(link)
    first, inner, second = dyad.joints
    if isinstance(inner, Revolute):
        return _side_direction(sweep, first, inner), _side_direction(
            sweep, second, inner, rods=isinstance(first, Revolute)
        )
    slide = _direction(sweep, inner)
    if isinstance(second, Prismatic):
        return slide, _direction(sweep, second)
    assert isinstance(first, Revolute)
    return frames.minus(_place(sweep, second), _place(sweep, first)), (-slide[1], slide[0])


def _side_direction(sweep: Sweep, outer: Joint, inner: Revolute, *, rods: bool = False) -> Pair:
    """The rod from the inner pin to the outer one; of a slide beside a rod (``rods``) its normal, else its line."""
    if isinstance(outer, Revolute):
        return frames.minus(_place(sweep, outer), _place(sweep, inner))
    x, y = _direction(sweep, outer)
    return (-y, x) if rods else (x, y)


def _place(sweep: Sweep, pin: Revolute) -> Pair:
    return sweep.local_point(pin.near, pin.near_local)


def _direction(sweep: Sweep, slide: Prismatic) -> Pair:
    return frames.arm(sweep.poses(slide.near), slide.along)
