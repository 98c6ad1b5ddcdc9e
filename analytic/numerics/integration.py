"""Integration of φ̈ = ε(φ, φ̇) in windows as long as the motion allows.

All nodes of a window are found at once by fixed-point iteration, so that NumPy evaluates the equation for all of them
together. A window is accepted when the last terms of its series are below the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN
from analytic.errors import AssemblyError, LinkproofError
from analytic.numerics import step_control
from analytic.numerics.collocation import GaussScheme, Windows
from analytic.numerics.step_control import State

Array = NDArray[np.float64]
Acceleration = Callable[[Array, Array], Array]
Push = Callable[[Array, Array], Array]

MOST_WINDOWS: Final = 200_000  # some ten thousand turns
LEAST_TOLERANCE: Final = 64.0 * step_control.EPS  # the last coefficients of a series never fall below a few roundings


class _Path:
    """The windows done so far and the state at their end."""

    def __init__(self, scheme: GaussScheme, angle: float, speed: float, *, repeats: bool) -> None:
        self.scheme = scheme
        self.repeats = repeats
        self.state: State = (angle, 0.0, speed, 0.0, 0.0)
        self.starts = [0.0]
        self.base: list[float] = []
        self.angles: list[Array] = []
        self.speeds: list[Array] = []

    @property
    def angle(self) -> float:
        """φ less its whole turns, rad."""
        return self.state[0]

    @property
    def speed(self) -> float:
        """ω, rad/s."""
        return self.state[2]

    def add(self, found: Array, length: float, end: float) -> None:
        """Append a window of a length, up to the time ``end``, from the accelerations at its nodes."""
        angle, speed = length**2 * (self.scheme.angle @ found), length * (self.scheme.speed @ found)
        speed[0] += self.speed
        angle[:2] += 0.5 * length * self.speed  # the line from 0 to ω·length over [-1, 1]
        self.base.append(self.angle + self.state[4] * FULL_TURN)
        self.angles.append(angle)
        self.speeds.append(speed)
        self.starts.append(end)
        self.state = step_control.at_end(
            self.state, length, float(self.scheme.end_once @ found), float(self.scheme.end_twice @ found)
        )
        if not self.repeats:  # a travel: nothing comes again after 2π
            travel, *others, turns = self.state
            self.state = (travel + turns * FULL_TURN, others[0], others[1], others[2], 0.0)

    def windows(self) -> Windows:
        return Windows(
            np.array(self.starts), np.array(self.base), np.stack(self.angles, axis=1), np.stack(self.speeds, axis=1)
        )


def integrate(
    acceleration: Acceleration,
    start: tuple[float, float],
    duration: float,
    scheme: GaussScheme,
    *,
    tolerance: float,
    rounding: float,
    place: Callable[[float], str] = lambda angle: f"crank angle {degrees(angle)}",
    repeats: bool = True,
    push: Push | None = None,
    knots: Sequence[float] = (),
) -> Windows:
    """Integrate from ``start``, (φ, ω), for ``duration`` seconds; ``tolerance`` is of the speed within a window.

    ``rounding`` is what of an acceleration is noise, rad/s²: no window is made smaller to follow it. ``place`` writes a
    φ for a reader, ``repeats`` says whether the acceleration has period 2π in φ. ``push`` is a part of the
    acceleration that depends on time, s, and φ; at its ``knots``, s, where it has kinks, a window ends and the next one
    begins anew. Raises LinkproofError where the motion cannot be followed.
    """
    tolerance, count = max(tolerance, LEAST_TOLERANCE), len(scheme.nodes)
    path = _Path(scheme, *start, repeats=repeats)
    pushed = _timed(acceleration, push)
    borders = [*sorted(knot for knot in knots if 0.0 < knot < duration), duration]
    guess = _constant(pushed, path)
    length = longest = step_control.first_window(start[1], float(guess[0]), duration)
    while path.starts[-1] < duration:
        rest = borders[0] - path.starts[-1]
        last = length >= step_control.ALL_BUT * rest
        length = rest if last else length
        found = _solve(pushed, path, length, guess, rounding)
        error = np.inf if found is None else _error(path, found, length, rounding)
        factor = step_control.growth(error, tolerance, count)
        if found is not None and error <= tolerance:
            path.add(found, length, borders[0] if last else path.starts[-1] + length)
            guess = _continued(scheme, found, factor)
            longest = max(longest, length)
            if last:
                del borders[0]
                guess = _constant(pushed, path)
        else:
            factor = min(factor, step_control.MOST_RETRY)
            guess = _constant(pushed, path)
        length *= factor
        _check(path, length, longest, duration, place)
    return path.windows()


Timed = Callable[[Array, Array, Array], Array]


def _timed(acceleration: Acceleration, push: Push | None) -> Timed:
    """The whole acceleration over time, φ and ω."""
    if push is None:
        return lambda _time, angle, speed: acceleration(angle, speed)
    return lambda time, angle, speed: acceleration(angle, speed) + push(time, angle)


def _constant(acceleration: Timed, path: _Path) -> Array:
    """The acceleration at the path's end, for every node."""
    count = len(path.scheme.nodes)
    return acceleration(np.full(count, path.starts[-1]), np.full(count, path.angle), np.full(count, path.speed))


def _solve(acceleration: Timed, path: _Path, length: float, guess: Array, rounding: float) -> Array | None:
    """Accelerations at the nodes, or None where the iteration does not settle."""
    scheme, speed = path.scheme, path.speed
    ahead = path.angle + speed * length * scheme.nodes
    once, twice = length * scheme.once, length**2 * scheme.twice
    time = path.starts[-1] + length * scheme.nodes
    found, before, least = guess, np.inf, np.inf
    for _ in range(step_control.MOST_ITERATIONS):
        try:
            following = acceleration(time, ahead + twice @ found, speed + once @ found)
        except AssemblyError:
            return None
        change, peak = float(np.max(np.abs(following - found))), float(np.max(np.abs(following)))
        if not change <= step_control.DIVERGING * least:
            return None
        found, least = following, min(least, change)
        if step_control.has_settled(change, before, peak, rounding):
            return found
        before = change
    return None


def _error(path: _Path, found: Array, length: float, rounding: float) -> float:
    """Error of the speed over the speed in a window, from the last terms of the acceleration's series."""
    tail = max(float(np.abs(path.scheme.series[-2:] @ found).max()) - rounding, 0.0)
    gained, peak = float(path.scheme.end_once @ found), float(np.abs(found).max())
    return step_control.relative_error(tail, path.speed, gained, peak, length)


def _continued(scheme: GaussScheme, found: Array, growth: float) -> Array:
    """The acceleration's polynomial carried on into the next window, without its high terms, which grow outside."""
    kept = max(2, len(found) // 2)
    return np.asarray(legendre.legval(1.0 + 2.0 * growth * scheme.nodes, (scheme.series @ found)[:kept]))


def _check(path: _Path, length: float, longest: float, duration: float, place: Callable[[float], str]) -> None:
    time, done = path.starts[-1], len(path.base)
    if step_control.is_lost(path.starts, done, length, longest):
        raise LinkproofError(
            f"motion: expected one that is smooth, got one that cannot be followed beyond t = {time:.6g} s at "
            f"{place(float(path.angle))}, a dead position or an unbounded speed; shorten the "
            "duration or change the loads"
        )
    if done > MOST_WINDOWS:
        raise LinkproofError(
            f"motion: expected at most {MOST_WINDOWS} windows of integration, got more by t = {time:.4g} s of "
            f"{duration:g} s; shorten the duration"
        )
