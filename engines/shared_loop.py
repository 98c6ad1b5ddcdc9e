"""What loops share: a prescribed motion, a load over the driver's coordinate, and signals of what was read."""

from bisect import bisect_right
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def motion_values(motion: Iterable[tuple[float, Any]], times: Array) -> Array:
    """The driver's coordinate at times, s; the first and the last polynomial go on beyond the motion's ends."""
    values = np.empty_like(times)
    for number, (start, coefficients) in enumerate(motion):
        later = times >= start if number else np.full(times.shape, True)
        values[later] = np.polynomial.polynomial.polyval(times[later] - start, coefficients)
    return values


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle or a travel: constants, or cubics that repeat or keep their end values."""
    if isinstance(law, list):
        return law
    knots, pieces, period = law
    angle = knots[0] + (angle - knots[0]) % period if period else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


def signals(rows: list[tuple[float, dict[str, Any]]], channels: list[str], joints: Any) -> dict[str, Any]:  # noqa: ANN401
    """Times and values by channel, forces by joint, from what was read at instants, s; a row may lack a channel."""
    samples: dict[str, Any] = {}
    for name in channels:
        time, values = zip(*((time, read[name]) for time, read in rows if name in read), strict=True)
        samples[name] = np.array(time), np.array(values)
    if "joint_force" in samples:
        time, forces = samples["joint_force"]
        samples["joint_force"] = {joint: (time, forces[:, number]) for number, joint in enumerate(joints)}
    return samples
