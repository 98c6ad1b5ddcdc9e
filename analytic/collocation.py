"""Integration of φ̈ = ε(φ, φ̇) by Gauss collocation in adaptive windows of time.

In a window the acceleration is a polynomial through its values at Gauss-Legendre nodes; speed and angle are its exact
integrals, and the equation holds at the nodes (Hairer, Lubich, Wanner, *Geometric Numerical Integration*, II.1.3). With n
nodes the window's end is of order 2n. The polynomials *are* the dense output: valid at every instant, not at the steps
only. All nodes are found at once by fixed-point iteration, so that NumPy evaluates the equation for all of them together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from analytic.errors import AssemblyError, LinkproofError

Array = NDArray[np.float64]
Acceleration = Callable[[Array, Array], Array]

MOST_ITERATIONS: Final = 30
MOST_WINDOWS: Final = 200_000  # some ten thousand turns
LEAST_WINDOW: Final = 1e-12  # of the duration
SAFETY, MOST_GROWTH, LEAST_GROWTH, MOST_RETRY = 0.85, 2.0, 0.2, 0.7
ALL_BUT: Final = 0.999  # of the rest of the time: no sliver of a window is left over
TINY: Final = float(np.finfo(float).tiny)
FIRST_ANGLE: Final = 0.3  # rad, the first window's guess
EPS: Final = float(np.finfo(float).eps)
LEAST_TOLERANCE: Final = 64.0 * EPS  # the last coefficients of a series never fall below a few roundings


class Scheme(NamedTuple):
    """Gauss collocation on [0, 1] with n nodes.

    ``series`` (n, n) turns values at the nodes into coefficients of shifted Legendre polynomials, ``once`` and ``twice``
    (n, n) into the first and second integral at the nodes, ``end_once`` and ``end_twice`` (n,) at 1; ``speed`` (n + 1, n)
    and ``angle`` (n + 2, n) into the Legendre coefficients of both integrals.
    """

    nodes: Array
    series: Array
    once: Array
    twice: Array
    end_once: Array
    end_twice: Array
    speed: Array
    angle: Array


@lru_cache
def gauss_scheme(count: int) -> Scheme:
    """The scheme with ``count`` nodes."""
    points, weights = legendre.leggauss(count)
    orders = np.arange(count)
    series = (orders + 0.5)[:, None] * legendre.legvander(points, count - 1).T * weights
    speed = 0.5 * legendre.legint(series, lbnd=-1)
    angle = 0.5 * legendre.legint(speed, lbnd=-1)
    nodes = 0.5 * (points + 1.0)
    return Scheme(
        nodes=nodes,
        series=series,
        once=legendre.legvander(points, count) @ speed,
        twice=legendre.legvander(points, count + 1) @ angle,
        end_once=0.5 * weights,
        end_twice=0.5 * weights * (1.0 - nodes),
        speed=speed,
        angle=angle,
    )


@dataclass(frozen=True)
class Windows:
    """A motion, window after window: ``starts`` (w + 1,), s, the last one its end.

    ``angle`` (n + 2, w), rad, and ``speed`` (n + 1, w), rad/s, are coefficients of Legendre polynomials over [-1, 1]
    across a window, ``base`` (w,) the angle at its start, which the series of the angle leaves out to keep its digits.
    """

    starts: Array
    base: Array
    angle: Array
    speed: Array

    def _place(self, time: Array) -> tuple[NDArray[np.intp], Array]:
        window = np.clip(np.searchsorted(self.starts, time, side="right") - 1, 0, len(self.base) - 1)
        left, right = self.starts[window], self.starts[window + 1]
        return window, ((time - left) - (right - time)) / (right - left)

    def angle_at(self, time: Array) -> Array:
        """φ, rad, at instants (any shape)."""
        window, place = self._place(time)
        return np.asarray(self.base[window] + legendre.legval(place, self.angle[:, window], tensor=False))

    def speed_at(self, time: Array) -> Array:
        """ω, rad/s, at instants (any shape)."""
        window, place = self._place(time)
        return np.asarray(legendre.legval(place, self.speed[:, window], tensor=False))


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
    """The windows done so far and the state at their end."""

    def __init__(self, scheme: Scheme, angle: float, speed: float) -> None:
        self.scheme = scheme
        self.angle, self.speed = _Carried(angle), _Carried(speed)
        self.starts = [0.0]
        self.base: list[float] = []
        self.angles: list[Array] = []
        self.speeds: list[Array] = []

    def add(self, found: Array, length: float, end: float) -> None:
        """Append a window of a length, up to the time ``end``, from the accelerations at its nodes."""
        angle, speed = length**2 * (self.scheme.angle @ found), length * (self.scheme.speed @ found)
        speed[0] += self.speed.value
        angle[:2] += 0.5 * length * self.speed.value  # the line from 0 to ω·length over [-1, 1]
        self.base.append(self.angle.value)
        self.angles.append(angle)
        self.speeds.append(speed)
        self.starts.append(end)
        self.angle.add(length * self.speed.value + length**2 * float(self.scheme.end_twice @ found))
        self.speed.add(length * float(self.scheme.end_once @ found))

    def windows(self) -> Windows:
        return Windows(
            np.array(self.starts), np.array(self.base), np.stack(self.angles, axis=1), np.stack(self.speeds, axis=1)
        )


def integrate(
    acceleration: Acceleration, angle: float, speed: float, duration: float, tolerance: float, count: int
) -> Windows:
    """Integrate from (φ, ω) for ``duration`` seconds; ``tolerance`` is of the speed in a window, ``count`` the nodes.

    Raises LinkproofError where the motion cannot be followed.
    """
    tolerance, scheme = max(tolerance, LEAST_TOLERANCE), gauss_scheme(count)
    path, length = _Path(scheme, angle, speed), _first_window(acceleration, angle, speed, duration)
    guess = _constant(acceleration, path)
    while path.starts[-1] < duration:
        rest = duration - path.starts[-1]
        last = length >= ALL_BUT * rest
        length = rest if last else length
        found = _solve(acceleration, path, length, guess)
        error = np.inf if found is None else _error(path, found, length)
        growth = float(np.clip(SAFETY * (tolerance / max(error, TINY)) ** (1.0 / count), LEAST_GROWTH, MOST_GROWTH))
        if found is not None and error <= tolerance:
            path.add(found, length, duration if last else path.starts[-1] + length)
            guess = _continued(scheme, found, growth)
        else:
            growth = min(growth, MOST_RETRY)
            guess = _constant(acceleration, path)
        length *= growth
        _check(path, length, duration)
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


def _solve(acceleration: Acceleration, path: _Path, length: float, guess: Array) -> Array | None:
    """Accelerations at the nodes, or None where the iteration does not settle."""
    scheme, speed = path.scheme, path.speed.value
    ahead = path.angle.value + speed * length * scheme.nodes
    once, twice = length * scheme.once, length**2 * scheme.twice
    found, before = guess, np.inf
    for _ in range(MOST_ITERATIONS):
        try:
            following = acceleration(ahead + twice @ found, speed + once @ found)
        except AssemblyError:
            return None
        change, peak = float(np.max(np.abs(following - found))), float(np.max(np.abs(following)))
        if not np.isfinite(change):
            return None
        found = following
        # Settled: down to rounding, or no longer shrinking close to it.
        if change <= 4.0 * EPS * peak or (change >= 0.5 * before and change <= 1e4 * EPS * peak):
            return found
        before = change
    return None


def _error(path: _Path, found: Array, length: float) -> float:
    """Error of the speed's polynomial over the speed in the window, from the last terms of the acceleration's series."""
    scheme, speed = path.scheme, path.speed.value
    tail = np.abs(scheme.series[-2:] @ found).max() * length
    scale = max(abs(speed), abs(speed + length * float(scheme.end_once @ found)), length * float(np.abs(found).max()))
    return float(tail / scale) if scale > 0.0 else 0.0


def _continued(scheme: Scheme, found: Array, growth: float) -> Array:
    """The acceleration's polynomial carried on into the next window, without its high terms, which grow outside."""
    kept = max(2, len(found) // 2)
    return np.asarray(legendre.legval(1.0 + 2.0 * growth * scheme.nodes, (scheme.series @ found)[:kept]))


def _check(path: _Path, length: float, duration: float) -> None:
    if length < LEAST_WINDOW * duration:
        raise LinkproofError(
            f"motion: expected one that is smooth, got one that cannot be followed beyond t = {path.starts[-1]:.6g} s at "
            f"crank angle {np.degrees(path.angle.value) % 360.0:.4g}°, a dead position or an unbounded speed; shorten "
            "the duration or change the loads"
        )
    if len(path.base) > MOST_WINDOWS:
        raise LinkproofError(
            f"motion: expected at most {MOST_WINDOWS} windows of integration, got more by t = {path.starts[-1]:.4g} s of "
            f"{duration:g} s; shorten the duration"
        )
