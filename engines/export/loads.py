"""Loads over the crank angle in a script."""

from __future__ import annotations

from typing import Any

from analytic.description.law import Law

AT_ANGLE = '''
def at_angle(law, angle):
    """A load at a crank angle: a constant's components, or those of cubics between knots that repeat after a turn."""
    if len(law) == 1:
        return law[0]
    knots, pieces = law
    angle = knots[0] + (angle - knots[0]) % (2.0 * math.pi)
    piece = int(np.searchsorted(knots, angle, side="right")) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


begin = 0.0  # of the part of the motion that is stepped, s
'''


def law_told(law: Law) -> tuple[Any, ...]:
    """A law as ``at_angle`` has it."""
    return (law.values.tolist(),) if law.is_constant else law.pieces()
