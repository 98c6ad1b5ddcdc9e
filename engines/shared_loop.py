"""What loops share: a prescribed motion, a load over the driver's coordinate, and signals of what was read."""

from bisect import bisect_right
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def motion_values(motion: Iterable[tuple[float, Any]], times: Array) -> Array:
    """The driver's coordinate, rad or m, at times, s, in their shape, from a motion's polynomials in order.

    Each is its start, s, and its coefficients over the time since then, lowest power first; it holds until the next
    begins. The first and the last polynomial go on beyond the motion's ends.
    """
    values = np.empty_like(times)
    for number, (start, coefficients) in enumerate(motion):
        later = times >= start if number else np.full(times.shape, True)
        values[later] = np.polynomial.polynomial.polyval(times[later] - start, coefficients)
    return values


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components, N or N m, as a list at an angle, rad, or a travel, m.

    The law is a list of constants, which itself comes back, or a tuple of knots, rad or m, cubics and a period: for
    each knot and component four coefficients, lowest power first, over the distance from that knot. They repeat, or
    with the period 0 keep their end values.
    """
    if isinstance(law, list):
        return law
    knots, pieces, period = law
    angle = knots[0] + (angle - knots[0]) % period if period else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


def signals(rows: list[tuple[float, dict[str, Any]]], channels: list[str], joints: Any) -> dict[str, Any]:  # noqa: ANN401
    """A pair of arrays, times, s, and values, by channel, and by joint under "joint_force".

    A row is an instant, s, and what was read there by channel. It may lack a channel, but where all rows do ValueError
    is raised. ``joints`` are the joints' names, in the order of the forces.
    """
    samples: dict[str, Any] = {}
    for name in channels:
        time, values = zip(*((time, read[name]) for time, read in rows if name in read), strict=True)
        samples[name] = np.array(time), np.array(values)
    if "joint_force" in samples:
        time, forces = samples["joint_force"]
        samples["joint_force"] = {joint: (time, forces[:, number]) for number, joint in enumerate(joints)}
    return samples
