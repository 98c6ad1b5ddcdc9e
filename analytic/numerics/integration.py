"""Integration of φ̈ = ε(φ, φ̇) in windows as long as the motion allows.

All nodes of a window are found at once by fixed-point iteration, so that NumPy evaluates the equation for all of them
together. A window is accepted when the last terms of its series are below the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN
from analytic.errors import AssemblyError, LinkproofError
from analytic.numerics.collocation import GaussScheme, Windows

Array = NDArray[np.float64]
Acceleration = Callable[[Array, Array], Array]

MOST_ITERATIONS: Final = 30
DIVERGING: Final = 30.0  # times the least change so far: the window is too long
MOST_WINDOWS: Final = 200_000  # some ten thousand turns
LEAST_WINDOW: Final = 1e-12  # of the longest one
# Near a dead position the windows shrink without end. A kink in a load takes some 40 small ones to get over.
STUCK: Final = 100
STUCK_SHARE: Final = 0.05
SAFETY, MOST_GROWTH, LEAST_GROWTH, MOST_RETRY = 0.85, 2.0, 0.2, 0.7
ALL_BUT: Final = 0.999  # of the rest of the time: no sliver of a window is left over
TINY: Final = float(np.finfo(float).tiny)
FIRST_ANGLE: Final = 0.3  # rad, the first window's guess
EPS: Final = float(np.finfo(float).eps)
LEAST_TOLERANCE: Final = 64.0 * EPS  # the last coefficients of a series never fall below a few roundings


class _Carried:
    """A number summed up over many windows with the rounding of each sum kept (Kahan)."""

    def __init__(self, value: float) -> None:
        self.value, self.lost = value, 0.0

    def add(self, change: float) -> None:
        change += self.lost
        total = self.value + change
        self.lost = change - (total - self.value)
        self.value = total


class _Path:
    """The windows done so far and the state at their end.

    The angle is carried less its whole turns: their digits would be lost to those that the equation depends on.
    """

    def __init__(self, scheme: GaussScheme, angle: float, speed: float) -> None:
        self.scheme = scheme
        self.angle, self.speed = _Carried(angle), _Carried(speed)
        self.turns = 0
        self.starts = [0.0]
        self.base: list[float] = []
        self.angles: list[Array] = []
        self.speeds: list[Array] = []

    def add(self, found: Array, length: float, end: float) -> None:
        """Append a window of a length, up to the time ``end``, from the accelerations at its nodes."""
        angle, speed = length**2 * (self.scheme.angle @ found), length * (self.scheme.speed @ found)
        speed[0] += self.speed.value
        angle[:2] += 0.5 * length * self.speed.value  # the line from 0 to ω·length over [-1, 1]
        self.base.append(self.angle.value + self.turns * FULL_TURN)
        self.angles.append(angle)
        self.speeds.append(speed)
        self.starts.append(end)
        self.angle.add(length * self.speed.value + length**2 * float(self.scheme.end_twice @ found))
        self.speed.add(length * float(self.scheme.end_once @ found))
        whole = int(self.angle.value / FULL_TURN)
        self.turns += whole
        self.angle.value -= whole * FULL_TURN

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
) -> Windows:
    """Integrate from ``start``, (φ, ω), for ``duration`` seconds; ``tolerance`` is of the speed within a window.

    ``rounding`` is what of an acceleration is noise, rad/s²: no window is made smaller to follow it. Raises
    LinkproofError where the motion cannot be followed.
    """
    tolerance, count = max(tolerance, LEAST_TOLERANCE), len(scheme.nodes)
    path, length = _Path(scheme, *start), _first_window(acceleration, *start, duration)
    longest = length
    guess = _constant(acceleration, path)
    while path.starts[-1] < duration:
        rest = duration - path.starts[-1]
        last = length >= ALL_BUT * rest
        length = rest if last else length
        found = _solve(acceleration, path, length, guess, rounding)
        error = np.inf if found is None else _error(path, found, length, rounding)
        growth = float(np.clip(SAFETY * (tolerance / max(error, TINY)) ** (1.0 / count), LEAST_GROWTH, MOST_GROWTH))
        if found is not None and error <= tolerance:
            path.add(found, length, duration if last else path.starts[-1] + length)
            guess = _continued(scheme, found, growth)
            longest = max(longest, length)
        else:
            growth = min(growth, MOST_RETRY)
            guess = _constant(acceleration, path)
        length *= growth
        _check(path, length, longest, duration)
    return path.windows()


def _constant(acceleration: Acceleration, path: _Path) -> Array:
    """The acceleration at the path's end, for every node."""
    count = len(path.scheme.nodes)
    return acceleration(np.full(count, path.angle.value), np.full(count, path.speed.value))


def _first_window(acceleration: Acceleration, angle: float, speed: float, duration: float) -> float:
    """Time in which the crank turns a little."""
    start = abs(float(acceleration(np.array([angle]), np.array([speed]))[0]))
    rate = max(abs(speed), np.sqrt(start * FIRST_ANGLE))
    return min(duration, FIRST_ANGLE / rate) if rate > 0.0 else duration


def _solve(acceleration: Acceleration, path: _Path, length: float, guess: Array, rounding: float) -> Array | None:
    """Accelerations at the nodes, or None where the iteration does not settle."""
    scheme, speed = path.scheme, path.speed.value
    ahead = path.angle.value + speed * length * scheme.nodes
    once, twice = length * scheme.once, length**2 * scheme.twice
    found, before, least = guess, np.inf, np.inf
    for _ in range(MOST_ITERATIONS):
        try:
            following = acceleration(ahead + twice @ found, speed + once @ found)
        except AssemblyError:
            return None
        change, peak = float(np.max(np.abs(following - found))), float(np.max(np.abs(following)))
        if not change <= DIVERGING * least:
            return None
        found, least = following, min(least, change)
        # Settled: down to rounding, or no longer shrinking close to it.
        if change <= 4.0 * EPS * peak + rounding or (change >= 0.5 * before and change <= 1e4 * EPS * peak):
            return found
        before = change
    return None


def _error(path: _Path, found: Array, length: float, rounding: float) -> float:
    """Error of the speed over the speed in a window, from the last terms of the acceleration's series."""
    scheme, speed = path.scheme, path.speed.value
    tail = max(float(np.abs(scheme.series[-2:] @ found).max()) - rounding, 0.0) * length
    scale = max(abs(speed), abs(speed + length * float(scheme.end_once @ found)), length * float(np.abs(found).max()))
    return tail / scale if scale > 0.0 else 0.0


def _continued(scheme: GaussScheme, found: Array, growth: float) -> Array:
    """The acceleration's polynomial carried on into the next window, without its high terms, which grow outside."""
    kept = max(2, len(found) // 2)
    return np.asarray(legendre.legval(1.0 + 2.0 * growth * scheme.nodes, (scheme.series @ found)[:kept]))


def _check(path: _Path, length: float, longest: float, duration: float) -> None:
    time, done = path.starts[-1], len(path.base)
    if length < LEAST_WINDOW * longest or time + length == time or (done % STUCK == 0 and _is_stuck(path.starts)):
        raise LinkproofError(
            f"motion: expected one that is smooth, got one that cannot be followed beyond t = {time:.6g} s at crank "
            f"angle {degrees(float(path.angle.value))}, a dead position or an unbounded speed; shorten the "
            "duration or change the loads"
        )
    if done > MOST_WINDOWS:
        raise LinkproofError(
            f"motion: expected at most {MOST_WINDOWS} windows of integration, got more by t = {time:.4g} s of "
            f"{duration:g} s; shorten the duration"
        )


def _is_stuck(starts: list[float]) -> bool:
    """Whether the latest windows together are short beside one of those before: the motion is running into a wall."""
    before = np.diff(starts[-2 * STUCK - 1 : -STUCK])
    return len(before) > 0 and starts[-1] - starts[-STUCK - 1] < STUCK_SHARE * float(before.max())
