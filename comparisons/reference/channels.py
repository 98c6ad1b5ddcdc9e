"""The closed form of what an engine records, channel by channel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from comparisons.reference.case import Case
from engines.scene import Channel

Array = NDArray[np.float64]


def truth(of: Case, channel: Channel, part: str, time: Array) -> Array:
    """The closed form of a channel: of a body (n, 3), of a joint (n, 2), or of the drive (n,)."""
    at = of.at(time)
    if channel is Channel.TORQUE:
        return at.torque
    if channel is Channel.JOINT_FORCE:
        return np.asarray(at.joint_forces[part].T)
    sweep, speed, acceleration = at.sweep, at.speed, at.acceleration
    if channel is Channel.POSITION:
        return np.column_stack(np.broadcast_arrays(*sweep.centre(part), sweep.angles(part), speed)[:3])
    first = np.column_stack(np.broadcast_arrays(*sweep.centre(part, 1), sweep.rates(part)[2], speed)[:3])
    if channel is Channel.VELOCITY:
        return np.asarray(first * speed[:, None])
    second = np.column_stack(np.broadcast_arrays(*sweep.centre(part, 2), sweep.accelerations(part)[2], speed)[:3])
    return np.asarray(second * speed[:, None] ** 2 + first * acceleration[:, None])
