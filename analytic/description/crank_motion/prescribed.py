"""A prescribed crank motion: polynomials of time, piece by piece, whatever law it follows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError, UnknownNameError

Array = NDArray[np.float64]

RPM = np.pi / 30.0


def degrees(angle: float) -> str:
    """A crank angle, rad, in words for a message: in degrees, 0° to 360°."""
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
        """φ or its derivative of the given order at ``time``, s, in rad and s; shape of ``time``."""
        x = np.asarray(time, dtype=float) - self.start
        highest, *lower = derivative(self.coefficients, order)
        total = x * 0.0 + highest
        for coefficient in lower:
            total *= x
            total += coefficient
        return np.asarray(total)

    def extreme_times(self, order: int) -> tuple[float, ...]:
        """Start, end, and the times between at which the derivative of φ of an order may be largest or smallest, s."""
        return (self.start, self.end, *self._zeros(order + 1))

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
        return max(abs(float(s.value(t, 1))) for s in self.segments for t in s.extreme_times(1))

    @property
    def reach(self) -> tuple[float, float]:
        """Smallest and largest φ, rad."""
        ends = [float(s.value(t)) for s in self.segments for t in s.extreme_times(0)]
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
        """φ or a derivative of it at instants, s; shape of ``time``."""
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


# The run-up of the source's validation and its smooth relatives, and constant speed, as exact polynomials of time.


# ω over its final value as a polynomial of x = t / ramp time, lowest power first.
RAMPS: dict[str, tuple[float, ...]] = {
    "run-up": (0.0, 1.0),
    "run-up-cubic": (0.0, 0.0, 3.0, -2.0),
    "run-up-quintic": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
}
CONSTANT_SPEED = "constant-speed"
REGIMES = (*RAMPS, CONSTANT_SPEED)


def crank_motion(
    regime: str = "run-up",
    *,
    speed: float = 1000.0 * RPM,
    ramp_time: float = 0.6,
    hold_time: float = 0.1,
    clockwise: bool = False,
    start_angle: float = 0.0,
) -> CrankMotion:
    """Build a regime by name.

    ``run-up`` brings the crank from rest to ``speed`` (rad/s) linearly in ``ramp_time`` (s) and continues at
    it for ``hold_time``; ``run-up-cubic`` and ``run-up-quintic`` do so with continuous acceleration; ``constant-speed``
    turns at ``speed`` for ``ramp_time + hold_time``. ``start_angle`` is φ at t = 0, rad.
    """
    if regime not in REGIMES:
        raise UnknownNameError("regime", regime, REGIMES)
    check_number("speed", speed, "rad/s", 1.0 / LARGEST)
    steady = regime == CONSTANT_SPEED
    check_number("ramp time", ramp_time, "s", 0.0 if steady else 1.0 / LARGEST)
    check_number("hold time", hold_time, "s", 0.0)
    check_number("ramp and hold time together", ramp_time + hold_time, "s", 1.0 / LARGEST)
    check_number("start angle", start_angle, "rad", -LARGEST)
    signed = -speed if clockwise else speed
    if steady:
        return CrankMotion(regime, (Segment(0.0, ramp_time + hold_time, (start_angle, signed)),))
    scaled = [signed * c / ramp_time**k for k, c in enumerate(RAMPS[regime])]
    ramp = Segment(0.0, ramp_time, (start_angle, *(float(c) / (k + 1) for k, c in enumerate(scaled))))
    if hold_time <= 0.0:
        return CrankMotion(regime, (ramp,))
    hold = Segment(ramp_time, ramp_time + hold_time, (float(ramp.value(ramp_time)), signed))
    return CrankMotion(regime, (ramp, hold))


# A crank motion through a table of angles over time: a spline with continuous acceleration.

JUMP: Final = 8.0  # times the speed of all other steps: what is faster is no motion but a jump
LEAST_POINTS: Final = 4


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
    return CrankMotion(regime, tuple(map(Segment, starts, starts[1:], map(tuple, pieces))))


def check_table(time: Sequence[float], angle: Sequence[float]) -> None:
    """Raise LinkproofError for a table that is no motion; names the point at fault, counted from 1."""
    if len(time) != len(angle) or len(time) < LEAST_POINTS:
        raise LinkproofError(
            f"expected as many angles as times and {LEAST_POINTS} or more of each, got {len(angle)} angles and "
            f"{len(time)} times; complete the shorter list"
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
                    f"expected a motion without a jump, got {_angle_text(angle[first])} to "
                    f"{_angle_text(angle[first + 1])} {place}, more than {JUMP:g} times as fast as anywhere else; "
                    "correct the point, or give more "
                    "points where it is fast"
                )


def _angle_text(angle: float) -> str:
    return f"{np.degrees(angle):.6g}°"
