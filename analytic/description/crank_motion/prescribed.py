"""A prescribed crank motion: polynomials of time, piece by piece, whatever law it follows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError

RPM = np.pi / 30.0


def degrees(angle: float) -> str:
    """A crank angle, rad, for a reader: in [0°, 360°) as it is written."""
    return f"{float(f'{math.degrees(angle) % 360.0:.4g}') % 360.0:g}°"


ROUNDING = 1e-9  # of the accelerations: what two pieces may differ by at a join without a jump
NEGLIGIBLE = 1e-14  # share of the largest term of a polynomial below which its highest terms move no root
NEAR_REAL = 1e-6  # imaginary part of a double root that rounding has split
LARGEST = 1e12  # rad/s, s or rad: beyond it the polynomials of time keep no digit of the crank angle


@dataclass(frozen=True)
class Segment:
    """φ(t) = Σ coefficients[k] (t − start)^k for start ≤ t ≤ end, rad and s."""

    start: float
    end: float
    coefficients: tuple[float, ...]

    def value(self, time: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """The derivative of φ of the given order at ``time``; shape of ``time``."""
        x = np.asarray(time, dtype=float) - self.start
        highest, *lower = derivative(self.coefficients, order)
        total = x * 0.0 + highest
        for coefficient in lower:
            total *= x
            total += coefficient
        return np.asarray(total)

    @property
    def turning_times(self) -> tuple[float, ...]:
        """Start, end, and the times between at which the speed may be largest, s."""
        return (self.start, self.end, *self._zeros(2))

    @property
    def standing_times(self) -> tuple[float, ...]:
        """Start, end, and the times between at which the angle may be largest or smallest, s."""
        return (self.start, self.end, *self._zeros(1))

    def _zeros(self, order: int) -> list[float]:
        """Times inside at which a derivative of φ is zero, s."""
        length = self.end - self.start
        terms = np.array(derivative(self.coefficients, order), dtype=float)
        terms *= np.float_power(length, np.arange(len(terms) - 1, -1, -1))
        leading = np.flatnonzero(np.abs(terms) > NEGLIGIBLE * np.max(np.abs(terms)))
        if not leading.size or leading[0] == len(terms) - 1:
            return []
        roots = np.roots(terms[leading[0] :])
        return [self.start + length * float(x.real) for x in roots if abs(x.imag) < NEAR_REAL and 0.0 < x.real < 1.0]


@lru_cache(maxsize=256)
def derivative(coefficients: tuple[float, ...], order: int) -> tuple[float, ...]:
    """Coefficients of a polynomial's derivative, highest power first, from those of the polynomial, lowest first.

    Stepping engines evaluate single instants, for which NumPy's own functions take ten times the time of the
    arithmetic.
    """
    for _ in range(order):
        coefficients = tuple(power * c for power, c in enumerate(coefficients))[1:] or (0.0,)
    return coefficients[::-1]


@dataclass(frozen=True)
class CrankMotion:
    """A prescribed crank angle, polynomial piece by piece, with continuous angle and speed."""

    regime: str
    segments: tuple[Segment, ...]

    @property
    def duration(self) -> float:
        """Time at which the motion ends, s; it starts at 0."""
        return self.segments[-1].end

    @cached_property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        return max(abs(float(s.value(t, 1))) for s in self.segments for t in s.turning_times)

    @property
    def reach(self) -> tuple[float, float]:
        """Smallest and largest φ, rad."""
        ends = [float(s.value(t)) for s in self.segments for t in s.standing_times]
        return min(ends), max(ends)

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s, the start from rest included, roundings at joins excluded."""
        before = [0.0] + [float(s.value(s.end, 2)) for s in self.segments[:-1]]
        after = [float(s.value(s.start, 2)) for s in self.segments]
        scale = max(self.peak_speed / self.duration, *map(abs, before), *map(abs, after))
        pairs = zip(self.segments, before, after, strict=True)
        return tuple(s.start for s, left, right in pairs if abs(left - right) > ROUNDING * scale)

    def _evaluate(self, time: ArrayLike, order: int) -> NDArray[np.float64]:
        time = np.asarray(time, dtype=float)
        starts = [segment.start for segment in self.segments]
        index = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, len(starts) - 1)
        result = np.empty_like(time)
        for number, segment in enumerate(self.segments):
            here = index == number
            result[here] = segment.value(time[here], order)
        return result

    def angle(self, time: ArrayLike) -> NDArray[np.float64]:
        """φ(t), rad."""
        return self._evaluate(time, 0)

    def speed(self, time: ArrayLike) -> NDArray[np.float64]:
        """ω(t), rad/s."""
        return self._evaluate(time, 1)

    def acceleration(self, time: ArrayLike) -> NDArray[np.float64]:
        """ε(t), rad/s²; at a jump the value just after it."""
        return self._evaluate(time, 2)


def check_number(name: str, value: float, unit: str, least: float) -> None:
    """Raise LinkproofError for a number of a motion that is not finite, below ``least`` or beyond LARGEST."""
    if not least <= value <= LARGEST:  # written so that nan fails too
        kind = "finite" if least < 0.0 else "positive finite" if least else "finite, not negative"
        raise LinkproofError(f"{name}: expected a {kind} number of {unit}, got {value:g}; correct it")
