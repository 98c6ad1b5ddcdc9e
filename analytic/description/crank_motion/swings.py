"""Motions from one crank angle to another: laws of cams and servos, dwells, and sequences of them.

Every law is s(x), from 0 to 1 while x = t / time goes from 0 to 1. Constant speed and the cubic 3x² − 2x³ are single
segments; the polynomial 10x³ − 15x⁴ + 6x⁵ (3-4-5) has two, about x = 0 and ½, where its terms cancel least. The
cycloidal law x − sin(2πx)/2π and the modified sine (Norton, Cam Design and Manufacturing Handbook, chapter 3) are sines
beside a straight line: they are cut where the sine's argument is a multiple of π/4, so that the sines there are 0, √½
and 1 exactly, and expanded about these places to the power ORDER. The remainder of the expansion is (π/4)^19/19! of the
sine, 8e-20, and of its second derivative (π/4)^17/17!, 5e-17: angle, speed and acceleration are exact to their
rounding, and the pieces meet to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from analytic.description.crank_motion.prescribed import (
    CONSTANT_SPEED,
    LARGEST,
    RPM,
    CrankMotion,
    Segment,
    check_number,
)
from analytic.errors import LinkproofError, UnknownNameError

ORDER: Final = 18
SAME_SPEED: Final = 1e-9  # of the faster of two speeds: what they may differ by where they meet
EIGHTH: Final = math.pi / 4.0
# The sine of every multiple of π/4.
SINES: Final = (0.0, math.sqrt(0.5), 1.0, math.sqrt(0.5), 0.0, -math.sqrt(0.5), -1.0, -math.sqrt(0.5))


@dataclass(frozen=True)
class Piece:
    """s(x) = Σ coefficients[k] (x − start)^k for start ≤ x ≤ end."""

    start: float
    end: float
    coefficients: tuple[float, ...]


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

    def pieces(self) -> Iterator[Piece]:
        """The wave in pieces of an eighth of a turn."""
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
            yield Piece(x, self.start + (number + 1) * length, tuple(terms))


@dataclass(frozen=True)
class MotionLaw:
    """A law s(x) in pieces; ``peak`` is its largest ds/dx, ``at_rest`` whether that is 0 at both ends."""

    pieces: tuple[Piece, ...]
    peak: float
    at_rest: bool = True


def _polynomial_law(peak: float, *coefficients: float, at_rest: bool = True) -> MotionLaw:
    """A law that is one polynomial over the whole move."""
    return MotionLaw((Piece(0.0, 1.0, coefficients),), peak, at_rest)


def _sine_law(peak: float, *waves: Wave) -> MotionLaw:
    """A law made of sine waves end to end."""
    return MotionLaw(tuple(piece for wave in waves for piece in wave.pieces()), peak)


_SUM: Final = math.pi + 4.0  # of the modified sine
LAWS: Final[Mapping[str, MotionLaw]] = {
    CONSTANT_SPEED: _polynomial_law(1.0, 0.0, 1.0, at_rest=False),
    "cubic": _polynomial_law(1.5, 0.0, 0.0, 3.0, -2.0),
    "polynomial": MotionLaw(
        (Piece(0.0, 0.5, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0)), Piece(0.5, 1.0, (0.5, 1.875, 0.0, -5.0, 0.0, 6.0))), 1.875
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
    """The motion that makes one move after the other from ``start_angle``, rad.

    Raises LinkproofError where a move cannot be, or where the speed would jump between two of them.
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
    """The pieces of one move from ``angle`` to ``target``, rad, begun at ``begun``, s; one for a dwell."""
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
    """Refuse a motion whose speed jumps between two moves."""
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
    """From one crank angle to another, rad, by a law, with a ``dwell``, s, there, and optionally ``back`` again.

    Either the largest |ω| is given, ``speed``, rad/s, or the ``time`` of one way, s. ``regime`` is the law by default.
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
