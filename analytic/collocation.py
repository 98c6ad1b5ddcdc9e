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
SAFETY, MOST_GROWTH, LEAST_GROWTH = 0.85, 2.0, 0.2
FIRST_ANGLE: Final = 0.3  # rad, the first window's guess
EPS: Final = float(np.finfo(float).eps)


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


def integrate(
    acceleration: Acceleration, angle: float, speed: float, duration: float, tolerance: float, count: int
) -> Windows:
    """Integrate from (φ, ω) for ``duration`` seconds; ``tolerance`` is of the speed in a window, ``count`` the nodes."""
    scheme = gauss_scheme(count)
    phi, omega = _Carried(angle), _Carried(speed)
    time, length = 0.0, _first_window(acceleration, angle, speed, duration)
    guess = acceleration(np.full(count, angle), np.full(count, speed))
    starts, base, angles, speeds = [0.0], [], [], []
    while time < duration:
        length, last = (duration - time, True) if length >= 0.999 * (duration - time) else (length, False)
        found = _solve(acceleration, scheme, phi.value, omega.value, length, guess)
        error = np.inf if found is None else _error(scheme, found, omega.value, length)
        growth = np.clip(SAFETY * (tolerance / max(error, 1e-300)) ** (1.0 / count), LEAST_GROWTH, MOST_GROWTH)
        if found is None or error > tolerance:
            length *= min(float(growth), 0.7)
            _check(length, duration, time, phi.value)
            guess = acceleration(np.full(count, phi.value), np.full(count, omega.value))
            continue
        base.append(phi.value)
        angles.append(_plus_line(length**2 * (scheme.angle @ found), length * omega.value))
        speeds.append(length * (scheme.speed @ found))
        speeds[-1][0] += omega.value
        phi.add(length * omega.value + length**2 * float(scheme.end_twice @ found))
        omega.add(length * float(scheme.end_once @ found))
        time = duration if last else time + length
        starts.append(time)
        if len(starts) > MOST_WINDOWS:
            raise LinkproofError(
                f"motion: expected at most {MOST_WINDOWS} windows of integration, got more by t = {time:.4g} s of "
                f"{duration:g} s; shorten the duration"
            )
        guess = _continued(scheme, found, float(growth))
        length *= float(growth)
    return Windows(np.array(starts), np.array(base), np.stack(angles, axis=1), np.stack(speeds, axis=1))


def _first_window(acceleration: Acceleration, angle: float, speed: float, duration: float) -> float:
    """Time in which the crank turns a little."""
    start = abs(float(acceleration(np.array([angle]), np.array([speed]))[0]))
    rate = max(abs(speed), np.sqrt(start * FIRST_ANGLE))
    return min(duration, FIRST_ANGLE / rate) if rate > 0.0 else duration


def _solve(
    acceleration: Acceleration, scheme: Scheme, angle: float, speed: float, length: float, guess: Array
) -> Array | None:
    """Accelerations at the nodes, or None where the iteration does not settle."""
    ahead = angle + speed * length * scheme.nodes
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


def _error(scheme: Scheme, found: Array, speed: float, length: float) -> float:
    """Error of the speed's polynomial over the speed in the window, from the last terms of the acceleration's series."""
    tail = np.abs(scheme.series[-2:] @ found).max() * length
    scale = max(abs(speed), abs(speed + length * float(scheme.end_once @ found)), length * float(np.abs(found).max()))
    return float(tail / scale) if scale > 0.0 else 0.0


def _plus_line(series: Array, rise: float) -> Array:
    """A Legendre series plus the straight line from 0 to ``rise``."""
    series[0] += 0.5 * rise
    series[1] += 0.5 * rise
    return series


def _continued(scheme: Scheme, found: Array, growth: float) -> Array:
    """The acceleration's polynomial carried on into the next window, without its high terms, which grow outside."""
    kept = max(2, len(found) // 2)
    return np.asarray(legendre.legval(1.0 + 2.0 * growth * scheme.nodes, (scheme.series @ found)[:kept]))


def _check(length: float, duration: float, time: float, angle: float) -> None:
    if length < LEAST_WINDOW * duration:
        raise LinkproofError(
            f"motion: expected a smooth motion of the crank, got one that cannot be followed beyond t = {time:.6g} s at "
            f"crank angle {np.degrees(angle) % 360.0:.4g}°, a dead position or an unbounded speed; shorten the duration "
            "or change the loads"
        )
