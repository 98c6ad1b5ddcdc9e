"""A load over the driver's coordinate, as every loop evaluates it."""

import math
from bisect import bisect_right
from typing import Any


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle or a travel: constants, or cubics that repeat or keep their end values."""
    if isinstance(law, list):
        return law
    knots, pieces, repeats = law
    angle = knots[0] + (angle - knots[0]) % math.tau if repeats else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]
