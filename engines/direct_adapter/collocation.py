"""Integrating a second-order equation over time by Gauss-Legendre collocation, window by window.

In each window φ̈ is a polynomial through the Gauss points that satisfies the equation there; its order is twice the
number of points (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, section II.7).
A window is as wide as the Legendre series of φ̈ ends in what is tolerated, and no wider than to the next angle at which
the equation is not smooth. Between the points the polynomial is as good as at them, so that the motion can be asked for
at any instant.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from engines.direct_adapter.assembly import UnsolvableError

Array = NDArray[np.floating[Any]]

FULL_TURN = 2.0 * math.pi
POINTS = 24
ITERATIONS = 40
CLOSE = 1e-15  # a change of φ̈ that ends the iteration, over the terms of φ̈
NOISE = 1e-9  # a series may end in this where it is rounding that keeps it from ending in less
TAIL = 3  # coefficients at the end of a series that tell how well it has converged
NARROWEST = 1e-12  # of the duration: a window that has to be narrower than this finds no way on
AT_BREAK = 1e-4  # of a window: a break nearer to its ends than this does not show

_X = legendre.leggauss(POINTS)[0]
_TO_SERIES = np.linalg.inv(legendre.legvander(_X, POINTS - 1))


def _integrals(order: int) -> Array:
    """Values at the points -> Legendre coefficients of their ``order``-fold integral from the window's start."""
    return np.stack([legendre.legint(column, order, lbnd=-1.0) for column in _TO_SERIES.T], axis=1)


_ONCE, _TWICE = _integrals(1), _integrals(2)
_ONCE_AT_POINTS = legendre.legvander(_X, POINTS) @ _ONCE
_TWICE_AT_POINTS = legendre.legvander(_X, POINTS + 1) @ _TWICE


@dataclass(frozen=True)
class Slope:
    """φ̈ at some instants (n,), its derivative over φ̇, and the sum of the magnitudes of the terms it is made of."""

    acceleration: Array
    over_speed: Array
    magnitude: Array


@dataclass(frozen=True)
class Problem:
    """φ̈ = equation(φ, φ̇), raising UnsolvableError out of bounds; ``period`` in φ, inf for none.

    ``breaks`` (n,), rad, of one turn: where the equation is not smooth. ``tolerance``: what a window's series may end
    in, over the terms of φ̈.
    """

    equation: Callable[[Array, Array], Slope]
    tolerance: float
    period: float
    breaks: Array


@dataclass(frozen=True)
class Window:
    """A stretch of the motion: φ and φ̇ at its start, and φ̈ at the points."""

    angle: float
    speed: float
    width: float
    slope: Slope

    def at(self, x: Array) -> tuple[Array, Array]:
        """φ and φ̇ at places (n,) in the window, -1 its start and 1 its end."""
        half, terms = 0.5 * self.width, legendre.legvander(x, POINTS + 1)
        once = terms[:, :-1] @ (_ONCE @ self.slope.acceleration)
        twice = terms @ (_TWICE @ self.slope.acceleration)
        return self.angle + half * (x + 1.0) * self.speed + half * half * twice, self.speed + half * once

    @cached_property
    def tail(self) -> float:
        """What the series of φ̈ ends in, over the terms of φ̈."""
        series = _TO_SERIES[-TAIL:] @ self.slope.acceleration
        return float(np.max(np.abs(series)) / (np.max(self.slope.magnitude) or 1.0))

    def first_break(self, breaks: Array) -> float | None:
        """The part of the window at whose end φ first comes to a break well inside it."""
        if not len(breaks):
            return None
        x = np.concatenate([[-1.0], _X, [1.0]])
        angle = self.at(x)[0]
        levels = breaks + FULL_TURN * np.round((angle[POINTS // 2] - breaks) / FULL_TURN)
        level, before = np.nonzero(np.diff(np.sign(angle - levels[:, None]), axis=1))
        if not len(level):
            return None
        places = self._crossings(levels[level], x[before], x[before + 1])
        parts = 0.5 * (1.0 + places)
        inside = parts[(parts > AT_BREAK) & (parts < 1.0 - AT_BREAK)]
        return float(np.min(inside)) if len(inside) else None

    def _crossings(self, levels: Array, left: Array, right: Array) -> Array:
        """Where φ passes each level between two places, by Newton's method kept between them."""
        places = 0.5 * (left + right)
        for _ in range(6):
            angle, speed = self.at(places)
            step = (levels - angle) / np.where(speed == 0.0, 1.0, 0.5 * self.width * speed)
            places = np.clip(places + step, left, right)
        return places


@dataclass(frozen=True)
class Trajectory:
    """The motion found: window starts (w + 1,), s, the windows, and the turns to add to their angles, (w,), rad.

    Angles are kept within a period, as what depends on them is the noisier the larger they are.
    """

    starts: Array
    windows: list[Window]
    turns: Array

    @property
    def peak_speed(self) -> float:
        """Largest |φ̇| at the windows' starts, rad/s."""
        return max(abs(window.speed) for window in self.windows)

    def __call__(self, time: Array) -> tuple[Array, Array]:
        """φ and φ̇ at instants (n,), increasing, within the motion."""
        borders = np.searchsorted(time, self.starts)
        borders[-1] = len(time)
        parts = []
        for window, turns, start, first, last in zip(
            self.windows, self.turns, self.starts[:-1], borders[:-1], borders[1:], strict=True
        ):
            angle, speed = window.at(2.0 * (time[first:last] - start) / window.width - 1.0)
            parts.append((turns + angle, speed))
        angles, speeds = zip(*parts, strict=True)
        return np.concatenate(angles), np.concatenate(speeds)


def integrate(problem: Problem, angle: float, speed: float, duration: float) -> Trajectory:
    """Follow the motion from φ and φ̇ for ``duration`` seconds; raises UnsolvableError where there is no way on."""
    starts, windows, turns = [0.0], [], [0.0]
    width, uncut, rejected = duration / 16.0, 0.0, math.inf
    while starts[-1] < duration:
        left = duration - starts[-1]
        width = min(width, left)
        window = _solved(problem, angle, speed, width)
        part = None if window is None else window.first_break(problem.breaks)
        if part is not None:
            width, uncut = width * part, max(width, uncut)
            continue
        tail = math.inf if window is None else window.tail
        growth = _growth(problem.tolerance, tail)
        # A narrower window whose series ends in no less than the wider one's has come to rounding.
        if window is not None and (tail <= problem.tolerance or 0.5 * rejected <= tail <= NOISE):
            starts.append(duration if width == left else starts[-1] + width)
            windows.append(window)
            end, speed = (float(values[0]) for values in window.at(np.ones(1)))
            whole = math.copysign(problem.period, end) if abs(end) > problem.period else 0.0
            angle = end - whole
            turns.append(turns[-1] + whole)
            width, uncut, rejected = max(growth * width, uncut), 0.0, math.inf
        elif width > NARROWEST * duration:
            width, uncut, rejected = growth * width, 0.0, tail
        else:
            problem.equation(np.array([angle]), np.array([speed]))  # says why, where the motion has left its bounds
            raise UnsolvableError(
                f"the free crank cannot be followed beyond {starts[-1]:.4g} s: the linkage locks, or all but locks, at "
                f"{math.degrees(angle) % 360.0:.4g}°"
            )
    return Trajectory(np.array(starts), windows, np.array(turns[:-1]))


def _growth(tolerance: float, tail: float) -> float:
    """By how much the next window may be wider than one that ends in ``tail``."""
    if tail <= 1e-3 * tolerance:
        return 2.0  # it has ended long before the last coefficients
    return float(min(2.0, max(0.3, 0.9 * (tolerance / tail) ** (1.0 / POINTS))))


def _solved(problem: Problem, angle: float, speed: float, width: float) -> Window | None:
    """One window by Newton's method with the damping of its start; None if it does not converge."""
    half = 0.5 * width
    once, twice = half * _ONCE_AT_POINTS, half * half * _TWICE_AT_POINTS
    drift = angle + half * (_X + 1.0) * speed
    try:
        slope = problem.equation(np.full(POINTS, angle), np.full(POINTS, speed))
        correct = np.linalg.inv(np.eye(POINTS) - slope.over_speed[:, None] * once)
        acceleration, before = slope.acceleration, math.inf
        for _ in range(ITERATIONS):
            slope = problem.equation(drift + twice @ acceleration, speed + once @ acceleration)
            change = correct @ (slope.acceleration - acceleration)
            acceleration = acceleration + change
            size = float(np.max(np.abs(change)) / (np.max(slope.magnitude) or 1.0))
            if size <= CLOSE or 0.5 * before <= size <= NOISE:
                return Window(angle, speed, width, Slope(acceleration, slope.over_speed, slope.magnitude))
            if not size < 1e3:
                return None
            before = size
    except (UnsolvableError, np.linalg.LinAlgError):
        return None  # a trial beyond the stops, say: a narrower window may turn before them
    return None
