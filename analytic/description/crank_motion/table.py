"""A crank motion through a table of angles over time: a spline with continuous acceleration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion.prescribed import CrankMotion, Segment
from analytic.errors import LinkproofError

JUMP: Final = 8.0  # times the speed of all other steps: what is faster is no motion but a jump
FEWEST: Final = 4

Array = NDArray[np.float64]


def table_motion(regime: str, time: Sequence[float], angle: Sequence[float]) -> CrankMotion:
    """The cubic spline (its end conditions: not a knot) through angles, rad, at times, s, that begin at 0.

    Angle, speed and acceleration are continuous; the pieces meet to rounding. Raises LinkproofError for a table that
    jumps: times that do not increase, steps faster than JUMP times all others, or times that all but coincide.
    """
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - a motion without a table does not pay for it

    check_table(time, angle)
    with np.errstate(over="ignore", invalid="ignore"):
        spline = CubicSpline(time, angle)
    if not np.all(np.isfinite(spline.c)):
        raise LinkproofError(
            f"expected times a motion can have, got some {min(np.diff(time)):.3g} s apart; correct them"
        )
    pieces = spline.c[::-1].T.tolist()
    starts = [float(t) for t in time]
    return CrankMotion(regime, tuple(map(_segment, starts, starts[1:], pieces)))


def _segment(start: float, end: float, coefficients: Sequence[float]) -> Segment:
    return Segment(start, end, tuple(coefficients))


def check_table(time: Sequence[float], angle: Sequence[float]) -> None:
    """Raise LinkproofError for a table that is no motion; names the point at fault, counted from 1."""
    if len(time) != len(angle) or len(time) < FEWEST:
        raise LinkproofError(
            f"expected as many angles as times and {FEWEST} or more of each, got {len(angle)} angles and {len(time)} "
            "times; complete the shorter list"
        )
    t, phi = np.asarray(time, dtype=float), np.asarray(angle, dtype=float)
    if not (np.all(np.isfinite(t)) and np.all(np.isfinite(phi))):
        raise LinkproofError("expected finite times and angles, got nan or infinity; correct them")
    check_times(t)
    _check_steps(t, phi)


def check_times(t: Array) -> None:
    """Raise LinkproofError for times, s, that do not increase from 0 on."""
    if t[0] != 0.0:
        raise LinkproofError(f"expected times from 0 on, got {t[0]:g} s first; subtract it from all of them")
    late = np.flatnonzero(np.diff(t) <= 0.0)
    if late.size:
        number = int(late[0])
        raise LinkproofError(
            f"expected times that increase, got {t[number + 1]:g} s after {t[number]:g} s (point {number + 2}); sort "
            "them, and give every time one angle"
        )


def _check_steps(time: Array, angle: Array) -> None:
    """Refuse one step, or one point off between two, that no speed of the others explains."""
    speeds = np.abs(np.diff(angle) / np.diff(time))
    for width in (1, 2):
        for first in range(len(speeds) - width + 1):
            steps = speeds[first : first + width]
            others = np.delete(speeds, slice(first, first + width))
            if others.size and np.min(steps) > JUMP * np.max(others):
                place = f"between {time[first]:g} s and {time[first + 1]:g} s (points {first + 1} and {first + 2})"
                raise LinkproofError(
                    f"expected a motion without a jump, got {_written(angle[first])} to {_written(angle[first + 1])} "
                    f"{place}, more than {JUMP:g} times as fast as anywhere else; correct the point, or give more "
                    "points where it is fast"
                )


def _written(angle: float) -> str:
    return f"{np.degrees(angle):.6g}°"
