"""Crank motions: the run-up of the source's validation and its smooth relatives, as exact polynomials of time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError, UnknownNameError

RPM = np.pi / 30.0


def degrees(angle: float) -> str:
    """A crank angle, rad, for a reader: in [0°, 360°) as it is written."""
    return f"{float(f'{math.degrees(angle) % 360.0:.4g}') % 360.0:g}°"


# ω over its final value as a polynomial of x = t / ramp time, lowest power first.
RAMPS: dict[str, tuple[float, ...]] = {
    "run-up": (0.0, 1.0),
    "run-up-cubic": (0.0, 0.0, 3.0, -2.0),
    "run-up-quintic": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
}
LARGEST = 1e12  # rad/s, s or rad: beyond it the polynomials of time keep no digit of the crank angle
REGIMES = (*RAMPS, "constant-speed")


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


@lru_cache(maxsize=256)
def derivative(coefficients: tuple[float, ...], order: int) -> tuple[float, ...]:
    """Coefficients of a polynomial's derivative, highest power first, from those of the polynomial, lowest first.

    Stepping engines ask for one instant at a time: NumPy's own functions take ten times the time of the arithmetic.
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

    @property
    def peak_speed(self) -> float:
        """Largest |ω| at the segments' ends, rad/s; the ramps are monotonic."""
        return max(abs(float(s.value(t, 1))) for s in self.segments for t in (s.start, s.end))

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s, the start from rest included."""
        before = [0.0] + [float(s.value(s.end, 2)) for s in self.segments[:-1]]
        after = [float(s.value(s.start, 2)) for s in self.segments]
        scale = self.peak_speed / self.duration
        pairs = zip(self.segments, before, after, strict=True)
        return tuple(s.start for s, left, right in pairs if abs(left - right) > 1e-9 * scale)

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


def _check(name: str, value: float, unit: str, least: float) -> None:
    if not least <= value <= LARGEST:  # written so that nan fails too
        kind = "finite" if least < 0.0 else "positive finite" if least else "finite, not negative"
        raise LinkproofError(f"{name}: expected a {kind} number of {unit}, got {value:g}; correct it")


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

    ``run-up`` brings the crank from rest to ``speed`` (rad/s) linearly in ``ramp_time`` (s) and holds it for
    ``hold_time``; ``run-up-cubic`` and ``run-up-quintic`` do it with continuous acceleration; ``constant-speed``
    turns at ``speed`` for ``ramp_time + hold_time``. ``start_angle`` is φ at t = 0, rad.
    """
    if regime not in REGIMES:
        raise UnknownNameError("regime", regime, REGIMES)
    _check("speed", speed, "rad/s", 1.0 / LARGEST)
    steady = regime == "constant-speed"
    _check("ramp time", ramp_time, "s", 0.0 if steady else 1.0 / LARGEST)
    _check("hold time", hold_time, "s", 0.0)
    _check("ramp and hold time together", ramp_time + hold_time, "s", 1.0 / LARGEST)
    _check("start angle", start_angle, "rad", -LARGEST)
    signed = -speed if clockwise else speed
    if steady:
        return CrankMotion(regime, (Segment(0.0, ramp_time + hold_time, (start_angle, signed)),))
    scaled = [signed * c / ramp_time**k for k, c in enumerate(RAMPS[regime])]
    ramp = Segment(0.0, ramp_time, (start_angle, *(float(c) / (k + 1) for k, c in enumerate(scaled))))
    if hold_time <= 0.0:
        return CrankMotion(regime, (ramp,))
    hold = Segment(ramp_time, ramp_time + hold_time, (float(ramp.value(ramp_time)), signed))
    return CrankMotion(regime, (ramp, hold))
