"""What loops share: a prescribed motion, a load over the driver's coordinate, and signals of what was read."""

from bisect import bisect_right
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def motion_values(motion: Iterable[tuple[float, Any]], times: Array) -> Array:
    """The driver's coordinate, rad or m, at times (n,), s, from polynomials: starts and coefficients, lowest first.

    The first and the last polynomial go on beyond the motion's ends.
    """
    values = np.empty_like(times)
    for number, (start, coefficients) in enumerate(motion):
        later = times >= start if number else np.full(times.shape, True)
        values[later] = np.polynomial.polynomial.polyval(times[later] - start, coefficients)
    return values


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components as a list at an angle, rad, or a travel, m.

    The law is constants, or knots, cubics and a period: they repeat, or with the period 0 keep their end values.
    """
    if isinstance(law, list):
        return law
    knots, pieces, period = law
    angle = knots[0] + (angle - knots[0]) % period if period else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


def signals(rows: list[tuple[float, dict[str, Any]]], channels: list[str], joints: Any) -> dict[str, Any]:  # noqa: ANN401
    """Times and values by channel, forces by joint, from rows of an instant, s, and what was read there.

    A row may lack a channel, but not all rows; ``joints`` are the joints' names, in the order of the forces.
    """
    samples: dict[str, Any] = {}
    for name in channels:
        time, values = zip(*((time, read[name]) for time, read in rows if name in read), strict=True)
        samples[name] = np.array(time), np.array(values)
    if "joint_force" in samples:
        time, forces = samples["joint_force"]
        samples["joint_force"] = {joint: (time, forces[:, number]) for number, joint in enumerate(joints)}
    return samples
