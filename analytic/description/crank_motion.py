"""Crank motions: run-ups, constant speed, swings by the laws of cams and servos, tables; all polynomials of time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Annotated, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.units import Kind
from analytic.errors import LinkproofError, UnknownNameError

Array = NDArray[np.float64]

RPM = np.pi / 30.0


def degrees(angle: float) -> str:
    """A crank angle, rad, in words for a message: in degrees, 4 digits, from 0° to less than 360°."""
    return f"{float(f'{math.degrees(angle) % 360.0:.4g}') % 360.0:g}°"


ROUNDING = 1e-9  # of the accelerations: what two pieces may differ by at a join without a jump
NEGLIGIBLE = 1e-14  # share of the largest term of a polynomial below which its highest terms move no root
NEAR_REAL = 1e-6  # imaginary part of a double root that rounding has split
LARGEST = 1e12  # rad/s, s or rad: beyond it the polynomials of time keep no digit of the crank angle


@dataclass(frozen=True)
class Segment:
    """φ(t) = Σ coefficients[k] (t − start)^k for start ≤ t ≤ end, rad and s; of a law s(x), plain numbers."""

    start: Annotated[float, Kind.TIME]
    end: Annotated[float, Kind.TIME]
    coefficients: Annotated[tuple[float, ...], Kind.COORDINATE]

    def value(self, time: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """φ or its derivative of the given order at ``time``, s, in rad and s; shape of ``time``.

        Times outside the segment continue its polynomial.
        """
        x = np.asarray(time, dtype=float) - self.start
        highest, *lower = derivative(self.coefficients, order)
        total = x * 0.0 + highest
        for coefficient in lower:
            total *= x
            total += coefficient
        return np.asarray(total)

    def extreme_times(self, order: int) -> tuple[float, ...]:
        """Start, end, and the times between at which φ or its derivative of an order may be extreme, s."""
        return (self.start, self.end, *self._zeros(order + 1))

    def _zeros(self, order: int) -> list[float]:
        """Times inside the segment, s, at which a derivative of φ of this order is zero.

        [] without any or where it always is.
        """
        length = self.end - self.start
        terms = np.array(derivative(self.coefficients, order), dtype=float)
        terms *= np.float_power(length, np.arange(len(terms) - 1, -1, -1))
        leading = np.flatnonzero(np.abs(terms) > NEGLIGIBLE * np.max(np.abs(terms)))
        if not leading.size or leading[0] == len(terms) - 1:
            return []
        is_line = leading[0] == len(terms) - 2  # as the acceleration of a cubic: a table has thousands of them
        roots = np.array([-terms[-1] / terms[-2]]) if is_line else np.roots(terms[leading[0] :])
        return [self.start + length * float(x.real) for x in roots if abs(x.imag) < NEAR_REAL and 0.0 < x.real < 1.0]


@lru_cache(maxsize=256)
def derivative(coefficients: tuple[float, ...], order: int) -> tuple[float, ...]:
    """Coefficients of a polynomial's derivative of an order, the highest power first.

    Those given have the lowest first. Results are kept. Stepping engines evaluate single instants, for which NumPy's
    own functions take ten times the time of the arithmetic.
    """
    for _ in range(order):
        coefficients = tuple(power * c for power, c in enumerate(coefficients))[1:] or (0.0,)
    return coefficients[::-1]


@dataclass(frozen=True)
class CrankMotion:
    """A prescribed crank angle, polynomial piece by piece, with continuous angle and speed; ``regime`` is its name.

    Of a driver that is pushed, all is in m in place of rad.
    """

    regime: str
    segments: tuple[Segment, ...]

    @property
    def duration(self) -> float:
        """Time at which the motion ends, s; it starts at 0."""
        return self.segments[-1].end

    @cached_property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s, over the whole motion."""
        return max(abs(float(s.value(t, 1))) for s in self.segments for t in s.extreme_times(1))

    @property
    def reach(self) -> tuple[float, float]:
        """Smallest and largest φ, rad, or m of a driver that is pushed."""
        ends = [float(s.value(t)) for s in self.segments for t in s.extreme_times(0)]
        return min(ends), max(ends)

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s; 0 is one if it does not begin at zero.

        Roundings at joins are none.
        """
        before = [0.0] + [float(s.value(s.end, 2)) for s in self.segments[:-1]]
        after = [float(s.value(s.start, 2)) for s in self.segments]
        scale = max(self.peak_speed / self.duration, *map(abs, before), *map(abs, after))
        pairs = zip(self.segments, before, after, strict=True)
        return tuple(s.start for s, left, right in pairs if abs(left - right) > ROUNDING * scale)

    def _evaluate(self, time: ArrayLike, order: int) -> NDArray[np.float64]:
        """φ or its derivative of ``order``, up to 2, at instants, s; shape of ``time``.

        Before and after the motion the first and the last piece continue.
        """
        time, starts = np.asarray(time, dtype=float), self._starts
        piece = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, len(starts) - 1)
        x = time - starts[piece]
        total = np.zeros(x.shape)
        for coefficients in self._coefficients[order]:
            total = total * x + coefficients[piece]
        return np.asarray(total)

    @cached_property
    def _starts(self) -> NDArray[np.float64]:
        """Times at which the pieces begin, s."""
        return np.array([segment.start for segment in self.segments])

    @cached_property
    def _coefficients(self) -> list[NDArray[np.float64]]:
        """For φ and its two derivatives the coefficients (powers, pieces) of all pieces, highest power first."""
        powers = max(len(segment.coefficients) for segment in self.segments)
        rows = [[derivative(segment.coefficients, order) for segment in self.segments] for order in range(3)]
        return [np.array([(0.0,) * (powers - len(row)) + row for row in pieces]).T for pieces in rows]

    def angle(self, time: ArrayLike) -> NDArray[np.float64]:
        """φ(t), rad, at times, s; shape of ``time``."""
        return self._evaluate(time, 0)

    def speed(self, time: ArrayLike) -> NDArray[np.float64]:
        """ω(t), rad/s, at times, s; shape of ``time``."""
        return self._evaluate(time, 1)

    def acceleration(self, time: ArrayLike) -> NDArray[np.float64]:
        """ε(t), rad/s², at times, s; shape of ``time``; at a jump the value just after it."""
        return self._evaluate(time, 2)


class Standstill(CrankMotion):
    """The crank angles of a motion one after the other, at each of which the crank stands still: for statics."""

    @cached_property
    def peak_speed(self) -> float:
        """Zero, the largest |ω|, rad/s."""
        return 0.0

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps: none."""
        return ()

    def speed(self, time: ArrayLike) -> NDArray[np.float64]:
        """ω(t) at times, s, which is zero, with the sign of the motion before, against which friction acts.

        Shape of ``time``.
        """
        return 0.0 * super().speed(time)

    def acceleration(self, time: ArrayLike) -> NDArray[np.float64]:
        """ε(t) at times, s, zero; shape of ``time``."""
        return np.zeros(np.shape(time))


def check_number(name: str, value: float, unit: str, least: float) -> None:
    """Raise LinkproofError for a number of a motion that is not finite, below ``least`` or beyond LARGEST.

    ``name`` of the quantity and ``unit`` are for the message.
    """
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
    """The prescribed motion of a regime by its name.

    ``run-up`` brings the crank from rest to ``speed`` (rad/s) linearly in ``ramp_time`` (s) and continues at it for
    ``hold_time``; ``run-up-cubic`` and ``run-up-quintic`` do so with continuous acceleration; ``constant-speed`` turns
    at ``speed`` for ``ramp_time + hold_time``; φ falls if ``clockwise``. ``start_angle`` is φ at t = 0, rad. Raises
    UnknownNameError for another regime, LinkproofError for a wrong number.
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

    ``regime`` is its name. Angle, speed and acceleration are continuous; the pieces meet to rounding. Raises
    LinkproofError for a table that is no motion, as ``check_table`` does, or whose times all but coincide.
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
    """Raise LinkproofError for a table, times in s and angles in rad, that is no motion; names the point at fault.

    That is one with lists of other lengths, fewer than LEAST_POINTS points, numbers that are not finite, times that do
    not increase from 0 on, or steps faster than JUMP times all others. Points count from 1.
    """
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
    """Raise LinkproofError for one step, or a point between two steps, over JUMP times as fast as all others."""
    speeds = np.abs(np.diff(angle) / np.diff(time))
    fastest = int(np.argmax(speeds))  # one of the steps at fault, if there are any
    for width in (1, 2):
        for first in range(max(fastest - width + 1, 0), min(fastest, len(speeds) - width) + 1):
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
    """An angle, rad, as text in degrees: "30°"."""
    return f"{np.degrees(angle):.6g}°"


# Motions from one crank angle to another: laws of cams and servos, dwells, and sequences of them.
#
# Every law is s(x), from 0 to 1 while x = t / time goes from 0 to 1. Constant speed and the cubic 3x² − 2x³ are
# single segments; the polynomial 10x³ − 15x⁴ + 6x⁵ (3-4-5) has two, about x = 0 and ½, where its terms cancel least.
# The cycloidal law x − sin(2πx)/2π and the modified sine (Norton, Cam Design and Manufacturing Handbook, chapter 3)
# are sines beside a straight line: they are cut where the sine's argument is a multiple of π/4, so that the sines
# there are 0, √½ and 1 exactly, and expanded about these places to the power ORDER. The remainder of the expansion is
# (π/4)^19/19! of the sine, 8e-20, and of its second derivative (π/4)^17/17!, 5e-17: angle, speed and acceleration are
# exact to their rounding, and the pieces meet to it.


ORDER: Final = 18
SAME_SPEED: Final = 1e-9  # of the faster of two speeds: what they may differ by where they meet
EIGHTH: Final = math.pi / 4.0
# The sine of every multiple of π/4.
SINES: Final = (0.0, math.sqrt(0.5), 1.0, math.sqrt(0.5), 0.0, -math.sqrt(0.5), -1.0, -math.sqrt(0.5))


@dataclass(frozen=True)
class Wave:
    """s(x) = offset + slope x + amplitude sin θ, where θ grows evenly from ``first`` to ``last`` eighths of a turn."""

    start: float
    end: float
    offset: float
    slope: float
    amplitude: float
    first: int
    last: int

    def pieces(self) -> Iterator[Segment]:
        """Yield the wave as polynomials, each over an eighth of a turn of its sine."""
        count = self.last - self.first
        length = (self.end - self.start) / count
        rate = EIGHTH / length
        for number in range(count):
            x = self.start + number * length
            eighth = self.first + number
            terms = [
                self.amplitude * rate**k / math.factorial(k) * SINES[(eighth + 2 * k) % 8] for k in range(ORDER + 1)
            ]
            terms[0] += self.offset + self.slope * x
            terms[1] += self.slope
            yield Segment(x, self.start + (number + 1) * length, tuple(terms))


@dataclass(frozen=True)
class MotionLaw:
    """A law s(x) in pieces; ``peak`` is its largest ds/dx, ``at_rest`` whether that is 0 at both ends."""

    pieces: tuple[Segment, ...]
    peak: float
    at_rest: bool = True


def _polynomial_law(peak: float, *coefficients: float, at_rest: bool = True) -> MotionLaw:
    """A law that is one polynomial on [0, 1], lowest power first; ``peak`` is its largest slope.

    ``at_rest``: it begins and ends at rest.
    """
    return MotionLaw((Segment(0.0, 1.0, coefficients),), peak, at_rest)


def _sine_law(peak: float, *waves: Wave) -> MotionLaw:
    """A law made of sine waves end to end on [0, 1]; ``peak`` is its largest slope."""
    return MotionLaw(tuple(piece for wave in waves for piece in wave.pieces()), peak)


_SUM: Final = math.pi + 4.0  # of the modified sine
LAWS: Final[Mapping[str, MotionLaw]] = {
    CONSTANT_SPEED: _polynomial_law(1.0, 0.0, 1.0, at_rest=False),
    "cubic": _polynomial_law(1.5, 0.0, 0.0, 3.0, -2.0),
    "polynomial": MotionLaw(
        (Segment(0.0, 0.5, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0)), Segment(0.5, 1.0, (0.5, 1.875, 0.0, -5.0, 0.0, 6.0))),
        1.875,
    ),
    "cycloidal": _sine_law(2.0, Wave(0.0, 1.0, 0.0, 1.0, -0.5 / math.pi, 0, 8)),
    "modified-sine": _sine_law(
        4.0 * math.pi / _SUM,
        Wave(0.0, 0.125, 0.0, math.pi / _SUM, -0.25 / _SUM, 0, 2),
        Wave(0.125, 0.875, 2.0 / _SUM, math.pi / _SUM, -2.25 / _SUM, 2, 6),
        Wave(0.875, 1.0, 4.0 / _SUM, math.pi / _SUM, -0.25 / _SUM, 6, 8),
    ),
}


@dataclass(frozen=True)
class Move:
    """A part of a motion: to the crank angle ``to``, rad, by a law in ``time``, s; no angle means a dwell."""

    time: float
    to: float | None = None
    law: str = CONSTANT_SPEED


def sequence(regime: str, start_angle: float, moves: Sequence[Move]) -> CrankMotion:
    """The motion of this name that makes one move after the other from ``start_angle``, rad.

    Raises LinkproofError without a move, where a move cannot be, or where the speed would jump between two of them;
    UnknownNameError for an unknown law.
    """
    check_number("start angle", start_angle, "rad", -LARGEST)
    segments: list[Segment] = []
    begun, angle = 0.0, start_angle
    for move in moves:
        check_number("time of a segment", move.time, "s", 1.0 / LARGEST)
        target = angle if move.to is None else move.to
        check_number("angle of a segment", target, "rad", -LARGEST)
        segments += _segments(move, begun, angle, target)
        begun, angle = segments[-1].end, target
    if not segments:
        raise LinkproofError("expected one segment or more, got none; give a segment with an angle or a dwell")
    motion = CrankMotion(regime, tuple(segments))
    _check_joins(motion)
    return motion


def _segments(move: Move, begun: float, angle: float, target: float) -> list[Segment]:
    """The pieces of a move from ``angle`` to ``target``, rad, that begins at ``begun``, s; a dwell is one piece.

    Raises UnknownNameError for an unknown law.
    """
    if move.law not in LAWS:
        raise UnknownNameError("law", move.law, LAWS)
    if target == angle:
        return [Segment(begun, begun + move.time, (angle,))]
    travel, segments = target - angle, []
    for piece in LAWS[move.law].pieces:
        terms = [travel * c / move.time**k for k, c in enumerate(piece.coefficients)]
        ends = (begun + move.time * piece.start, begun + move.time * piece.end)
        segments.append(Segment(*ends, (angle + terms[0], *terms[1:])))
    return segments


def _check_joins(motion: CrankMotion) -> None:
    """Raise LinkproofError for a motion whose speed jumps between two moves."""
    for before, after in zip(motion.segments, motion.segments[1:], strict=False):
        left, right = float(before.value(before.end, 1)), float(after.value(after.start, 1))
        if abs(left - right) > SAME_SPEED * motion.peak_speed:
            raise LinkproofError(
                f"expected a speed without a jump, got {left / RPM:.4g} rpm before and {right / RPM:.4g} rpm after "
                f"{after.start:g} s: take a law that starts and ends at rest there, "
                f"{', '.join(name for name, law in LAWS.items() if law.at_rest)}"
            )


def swing(
    law: str,
    start: float,
    end: float,
    *,
    speed: float | None = None,
    time: float | None = None,
    dwell: float = 0.0,
    back: bool = False,
    regime: str = "",
) -> CrankMotion:
    """A motion from one crank angle to another, rad, by a law, with a ``dwell``, s, there, and ``back`` if asked for.

    Either the largest |ω| is given, ``speed``, rad/s, or the ``time`` of one way, s. ``regime`` is the motion's name,
    the law by default. Raises UnknownNameError for an unknown law, LinkproofError for numbers that make no motion:
    equal ends, both or neither of speed and time, or a number out of range.
    """
    if law not in LAWS:
        raise UnknownNameError("law", law, LAWS)
    if start == end:
        raise LinkproofError("expected two different crank angles to swing between, got the same twice; correct one")
    if (speed is None) == (time is None):
        raise LinkproofError("expected either a speed or a time of a swing, got both or none; give one of them")
    if speed is not None:
        check_number("speed", speed, "rad/s", 1.0 / LARGEST)
        time = abs(end - start) * LAWS[law].peak / speed
    assert time is not None
    check_number("dwell", dwell, "s", 0.0)
    moves = [Move(time, end, law)] + ([Move(dwell)] if dwell else [])
    return sequence(regime or law, start, [*moves, Move(time, start, law)] if back else moves)
