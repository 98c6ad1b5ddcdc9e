"""Integrating a second-order equation over time by Gauss-Legendre collocation, window by window.

In each window φ̈ is a polynomial through the Gauss points that satisfies the equation there; its order is twice the
number of points (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, section II.7).
A window is as wide as the Legendre series of φ̈ ends in what is tolerated. Between the points the polynomial is as good
as at them, so that the motion can be asked for at any instant.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from engines.direct_assembly import UnsolvableError

Array = NDArray[np.float64]

POINTS = 24
ITERATIONS = 40
NARROWEST = 1e-12  # of the duration: a window that has to be narrower than this finds no way on
TAIL = 3  # coefficients at the end of a series that tell how well it has converged

_X, _WEIGHTS = legendre.leggauss(POINTS)
_TO_SERIES = np.linalg.inv(legendre.legvander(_X, POINTS - 1))


def _integrals(order: int) -> Array:
    """Values at the points -> Legendre coefficients of their ``order``-fold integral from the window's start."""
    return np.stack([legendre.legint(column, order, lbnd=-1.0) for column in _TO_SERIES.T], axis=1)


_FIRST, _SECOND = _integrals(1), _integrals(2)
_AT_POINTS = tuple(legendre.legvander(_X, POINTS - 1 + order) @ part for order, part in ((1, _FIRST), (2, _SECOND)))
_AT_END = tuple(np.sum(part, axis=0) for part in (_FIRST, _SECOND))


@dataclass(frozen=True)
class Slope:
    """φ̈ at some instants (n,), its derivative over φ̇, and the sum of the magnitudes of the terms it is made of."""

    acceleration: Array
    over_speed: Array
    magnitude: Array


Equation = Callable[[Array, Array], Slope]


@dataclass(frozen=True)
class Trajectory:
    """The motion found: window starts (w + 1,), φ and φ̇ there (w,), φ̈ at the windows' points (w, points).

    ``turns`` (w,), rad, is to be added to φ: it is kept small, as what depends on it is the noisier the larger it is.
    """

    starts: Array
    turns: Array
    angle: Array
    speed: Array
    acceleration: Array

    def __call__(self, time: Array) -> tuple[Array, Array]:
        """φ and φ̇ at any instants within the motion."""
        window = np.clip(np.searchsorted(self.starts, time, side="right") - 1, 0, len(self.angle) - 1)
        width = np.diff(self.starts)[window]
        elapsed = time - self.starts[window]
        x = 2.0 * elapsed / width - 1.0
        once, twice = (
            np.sum(legendre.legvander(x, POINTS - 1 + order) * (self.acceleration @ part.T)[window], axis=1)
            for order, part in ((1, _FIRST), (2, _SECOND))
        )
        speed = self.speed[window]
        angle = self.angle[window] + elapsed * speed + 0.25 * width**2 * twice
        return self.turns[window] + angle, speed + 0.5 * width * once


def integrate(
    equation: Equation, angle: float, speed: float, duration: float, tolerance: float, period: float = np.inf
) -> Trajectory:
    """Follow φ̈ = equation(φ, φ̇) from a start for ``duration`` seconds; raises UnsolvableError where there is no way on.

    ``tolerance`` is what a window's series may end in, relative to the terms of φ̈; ``period`` is the equation's in φ.
    """
    starts, found = [0.0], []
    turns, width = 0.0, duration / 16.0
    while starts[-1] < duration:
        left = duration - starts[-1]
        width = min(width, left)
        attempt = _window(equation, angle, speed, width)
        tail = np.inf if attempt is None else _tail(attempt)
        if attempt is not None and tail <= tolerance:
            starts.append(duration if width == left else starts[-1] + width)
            found.append((turns, angle, speed, attempt.acceleration))
            angle += width * speed + 0.25 * width**2 * float(_AT_END[1] @ attempt.acceleration)
            speed += 0.5 * width * float(_AT_END[0] @ attempt.acceleration)
            if abs(angle) > period:
                turns, angle = turns + math.copysign(period, angle), angle - math.copysign(period, angle)
        elif width <= NARROWEST * duration:
            equation(np.array([angle]), np.array([speed]))  # says why, where the motion has left its bounds
            raise UnsolvableError(f"the free crank's motion cannot be followed beyond {starts[-1]:.4g} s")
        width *= min(2.0, max(0.3, 0.9 * (tolerance / max(tail, 1e-300)) ** (1.0 / POINTS)))
    return Trajectory(np.array(starts), *(np.array(part) for part in zip(*found, strict=True)))


def _tail(slope: Slope) -> float:
    series = _TO_SERIES[-TAIL:] @ slope.acceleration
    return float(np.max(np.abs(series)) / (np.max(slope.magnitude) or 1.0))


def _window(equation: Equation, angle: float, speed: float, width: float) -> Slope | None:
    """φ̈ at the points of one window by Newton's method with the damping of its start; None if it does not converge."""
    first, second = 0.5 * width * _AT_POINTS[0], 0.25 * width**2 * _AT_POINTS[1]
    drift = angle + 0.5 * width * (_X + 1.0) * speed
    try:
        slope = equation(np.full(POINTS, angle), np.full(POINTS, speed))
        correct = np.linalg.inv(np.eye(POINTS) - slope.over_speed[:, None] * first)
        acceleration, before = slope.acceleration, np.inf
        for _ in range(ITERATIONS):
            slope = equation(drift + second @ acceleration, speed + first @ acceleration)
            change = correct @ (slope.acceleration - acceleration)
            acceleration = acceleration + change
            size = float(np.max(np.abs(change)) / (np.max(slope.magnitude) or 1.0))
            if size <= 1e-15 or before <= 1e-13 and size >= 0.5 * before:
                return Slope(acceleration, slope.over_speed, slope.magnitude)
            if not size < 1e3:
                return None
            before = size
    except UnsolvableError:
        return None  # a trial beyond the stops: a narrower window may turn before them
    return None
