"""The crank's motion from a column of a result file: as few polynomials of time as the column's rounding allows.

A column of angles is rounded, and its differences are far from the crank's acceleration. A piece is therefore as long
as one polynomial of low degree stays within the rounding: a constant speed is one piece, a linear run-up two, whatever
the number of samples. No judged signal is smoothed, only the angles at which the closed form is evaluated.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import PPoly, make_lsq_spline

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.errors import LinkproofError
from comparisons.imported.known_motions import FAMILIES, SLACK, known_fit

Array = NDArray[np.float64]
Segments = tuple[Segment, ...]

DEGREES: Final = (1, 2, 4, 7)  # of a piece: constant speed, linear run-up, cubic run-up, anything else
DEGREE_GAIN: Final = 1.3  # a higher degree has to reach so much farther
FEWEST: Final = 4  # samples that tell a motion
MOST_FITTED: Final = 1000  # samples to which a piece is fitted while its end is sought
NOISE_FACTOR: Final = 4.0  # times the rounding: the next noise that is tried
FINEST_ROUNDING: Final = 0.02  # of the coarsest rounding of a column
EXACT_SHARE: Final = 0.02  # of the rounding: a known motion that leaves less is printed in full, 1.5° after 1.5°
ROUND_MULTIPLE: Final = (
    200.0  # roundings: such an angle or speed starts at a multiple of so many, that is, of 100 last digits
)
LAST_BITS: Final = 1e-6  # of the rounding: the last bits of a number
MANY_PIECES: Final = 8  # pieces, from which a column may contain more than rounding
PIECES_SAVED: Final = 0.5  # of the pieces: what a wider noise has to save, since a smooth motion loses few by it
NOISE_BOUND: Final = 5.0  # root mean squares of noise that none of its samples exceeds
SIXTH_DIFFERENCE: Final = 20.5  # median of the sixth differences of noise, over its root mean square
LARGEST_NOISE: Final = 1e-3  # of the largest value
LEAST_JUMP: Final = 0.02  # of the largest acceleration
RANDOM_TRIALS: Final = 4  # other columns that would round to the same
WAVES: Final = (0.0, 1.0, 3.0, 7.0)  # half waves of slow ones over the column; none: all samples are off by the same
SPREAD: Final = 3.0  # from the largest of so few trials to a bound


@dataclass(frozen=True)
class ColumnMotion(CrankMotion):
    """A motion read from a column; ``steps`` are the times at which its acceleration jumps, s.

    Columns that would be printed the same may have the motions ``likewise``.
    """

    steps: tuple[float, ...] = ()
    likewise: tuple[CrankMotion, ...] = ()

    @property
    def is_known(self) -> bool:
        """Whether it is a run-up or a swing, not just any polynomials."""
        return self.regime in FAMILIES

    @cached_property
    def doubt(self) -> float:
        """By how much its acceleration differs from that of columns that would be printed the same, rad/s²."""
        return _derivative_spread(np.linspace(0.0, self.duration, 501), [o.segments for o in (self, *self.likewise)], 2)

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        return self.steps

    @cached_property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        return max(float(np.max(np.abs(p.value(np.linspace(p.start, p.end, 33), 1)))) for p in self.segments)


def motion_of_angles(time: Array, angle: Array, resolution: Array, name: str = "column") -> ColumnMotion:
    """The motion behind a column of crank angles (n,), rad, at times (n,), s, each rounded within its resolution."""
    return _fit_motion(time, angle, resolution, name, of_speed=False)


def motion_of_speeds(
    time: Array, speed: Array, resolution: Array, start_angle: float = 0.0, name: str = "column"
) -> ColumnMotion:
    """The motion behind a column of crank speeds (n,), rad/s, from a start angle, rad."""
    motion = _fit_motion(time, speed, resolution, name, of_speed=True)
    if motion.is_known:  # its pieces are those of the angle
        likewise = tuple(CrankMotion(o.regime, _shift_start(o.segments, start_angle)) for o in motion.likewise)
        return replace(motion, segments=_shift_start(motion.segments, start_angle), likewise=likewise)
    others = tuple(CrankMotion(name, _integrate_pieces(o.segments, start_angle)) for o in motion.likewise)
    return ColumnMotion(name, _integrate_pieces(motion.segments, start_angle), motion.steps, others)


def _shift_start(segments: Segments, angle: float) -> Segments:
    """Pieces of a motion, moved so that it starts at an ``angle``, rad."""
    return tuple(Segment(p.start, p.end, (angle + p.coefficients[0], *p.coefficients[1:])) for p in segments)


def _fit_motion(time: Array, values: Array, resolution: Array, name: str, *, of_speed: bool) -> ColumnMotion:
    """The motion of a column: a known one if there is any within its rounding, else piecewise polynomials."""
    if len(time) < FEWEST:
        raise LinkproofError(f"crank's motion: expected {FEWEST} samples or more, got {len(time)}; export more of them")
    coarsest = float(np.max(resolution, initial=1e-12 * (1.0 + np.max(np.abs(values)))))
    rounding = np.maximum(
        resolution, FINEST_ROUNDING * coarsest
    )  # the first angles of a run-up have more digits than any fit
    known = known_fit(time, values, rounding, of_speed=of_speed)
    if known is not None:
        column = known.column  # of fewer samples than the file, if that has many
        share, start = (
            float(np.max(np.abs(known.residual) / column.rounding)),
            float(known.values[0]) / (ROUND_MULTIPLE * coarsest),
        )
        is_exact = share < EXACT_SHARE and abs(start - round(start)) < EXACT_SHARE
        within = column.rounding * (max(share, LAST_BITS) if is_exact else 1.0)
        trials = (replace(column, values=column.values + trial) for trial in _rounding_trials(within))
        alike = tuple(trial.fit_near(known.time).motion for trial in trials)
        return ColumnMotion(known.column.family, known.motion.segments, known.motion.jumps, alike)
    within, pieces = _noise_and_pieces(time, values, rounding)
    columns = (values, *(values + trial for trial in _rounding_trials(within)))
    order = 1 if of_speed else 2
    loose = [tuple(_fit_piece(time, column, *piece) for piece in pieces) for column in columns]
    steps = _real_jumps(loose[0], loose[1:], order)
    if any(degree == DEGREES[-1] for *_, degree in pieces):
        joined = [_fit_spline(time, column, pieces, steps) for column in columns]
        loose = min((loose, joined), key=lambda curves: _derivative_spread(time, curves, order))
    finer = tuple(_fit_piece(time, values, *piece[:2], _second_degree(piece[2])) for piece in pieces)
    others = tuple(CrankMotion(name, segments) for segments in (*loose[1:], finer))
    return ColumnMotion(name, loose[0], steps, others)


def _second_degree(degree: int) -> int:
    """The degree of a piece's second fit, whose difference shows the doubt: two higher if it may be no polynomial."""
    return degree + 2 if degree == DEGREES[-1] else degree


def _rounding_trials(within: Array) -> Array:
    """Roundings of other columns that would be printed the same, (trials, n): random ones, and slow ones.

    Where every sample goes on by the same angle the last digit is off by the same, or changes slowly.
    """
    random = np.random.default_rng(0).uniform(-1.0, 1.0, (RANDOM_TRIALS, len(within)))
    slow = np.cos(np.outer(WAVES, np.linspace(0.0, math.pi, len(within))))
    return np.asarray(np.concatenate([random, slow]) * within)


def _derivative_spread(time: Array, curves: Sequence[Segments], order: int) -> float:
    """Largest difference of a derivative between the fits of columns that would be printed the same, SI."""
    values = [CrankMotion("", segments)._evaluate(time, order) for segments in curves]
    return float(max(np.max(np.abs(other - values[0])) for other in values[1:]))


def _noise_and_pieces(time: Array, values: Array, rounding: Array) -> tuple[Array, list[tuple[int, int, int]]]:
    """The noise (n,) of a column, and its pieces: the rounding, or more where that makes far fewer pieces."""
    if len(values) > MOST_FITTED:  # of a smooth column so finely sampled these differences are its noise
        noise = float(np.median(np.abs(np.diff(values, 6)))) / SIXTH_DIFFERENCE
        rounding = np.maximum(rounding, NOISE_BOUND * noise)
    pieces = _find_pieces(time, values, SLACK * rounding)
    most = LARGEST_NOISE * float(np.max(np.abs(values)))
    while len(pieces) > MANY_PIECES and float(np.max(rounding)) * NOISE_FACTOR < most:
        fewer = _find_pieces(time, values, SLACK * NOISE_FACTOR * rounding)
        if len(fewer) > PIECES_SAVED * len(pieces):
            break
        rounding, pieces = NOISE_FACTOR * rounding, fewer
    return rounding, pieces


def _fit_spline(time: Array, values: Array, pieces: list[tuple[int, int, int]], steps: tuple[float, ...]) -> Segments:
    """Pieces of one spline: with continuous speed, and continuous acceleration but at its ``steps``."""
    degree, knots, before = DEGREES[-1], [float(time[0])] * (DEGREES[-1] + 1), 0
    for first, *_ in pieces[1:]:
        if first - before > degree and len(time) - 1 - first > degree:
            at = float(time[first])
            knots += [at] * (degree - 1 if at in steps else degree - 3)
            before = first
    knots += [float(time[-1])] * (degree + 1)
    if len(time) < len(knots) - degree - 1:
        return tuple(_fit_piece(time, values, *piece) for piece in pieces)
    curve = PPoly.from_spline(make_lsq_spline(time, values, knots, degree))
    borders = curve.x
    return tuple(
        Segment(float(start), float(end), tuple(float(c) for c in curve.c[::-1, number]))
        for number, (start, end) in enumerate(itertools.pairwise(borders))
        if end > start
    )


def _find_pieces(time: Array, values: Array, within: Array) -> list[tuple[int, int, int]]:
    """First and last sample and degree of every piece; neighbours share a sample."""
    pieces, first, last = [], 0, len(time) - 1
    while first < last:
        reached = {degree: _last_sample_fitted(time, values, within, first, degree) for degree in DEGREES}
        degree = next(d for d in DEGREES if reached[d] - first >= (max(reached.values()) - first) / DEGREE_GAIN)
        pieces.append((first, reached[degree], degree))
        first = reached[degree]
    return _centre_borders(time, values, within, pieces)


def _centre_borders(
    time: Array, values: Array, within: Array, pieces: list[tuple[int, int, int]]
) -> list[tuple[int, int, int]]:
    """The pieces with each border midway between where the one before ends at the latest and the next may begin."""
    borders = [0]
    for (before, end, _), (_, last, degree) in itertools.pairwise(pieces):
        first = (
            len(time) - 1 - _last_sample_fitted(-time[::-1], values[::-1], within[::-1], len(time) - 1 - last, degree)
        )
        borders.append(max((max(first, before) + end) // 2, borders[-1] + 1))
    borders.append(len(time) - 1)
    return [(*pair, degree) for pair, (*_, degree) in zip(itertools.pairwise(borders), pieces, strict=True)]


def _last_sample_fitted(time: Array, values: Array, within: Array, first: int, degree: int) -> int:
    """Number of the last sample up to which one polynomial from the ``first`` stays within the rounding."""

    def fits(last: int) -> bool:
        here = slice(first, last + 1, max(1, (last - first) // MOST_FITTED))
        if last - first <= degree:
            return True
        x = 2.0 * (time[here] - time[first]) / (time[here][-1] - time[first]) - 1.0
        vandermonde = np.polynomial.chebyshev.chebvander(x, degree)
        coefficients = np.linalg.lstsq(vandermonde, values[here], rcond=None)[0]
        rest: Array = np.abs(vandermonde @ coefficients - values[here])
        return bool(np.all(rest <= within[here]))

    end, good, step = len(time) - 1, first + 1, 8
    if fits(end):
        return end
    while good + step < end and fits(good + step):
        good, step = good + step, 2 * step
    further = range(good + 1, min(good + step, end))
    return good + bisect_left(further, True, key=lambda last: not fits(last))


def _fit_piece(time: Array, values: Array, first: int, last: int, degree: int) -> Segment:
    """One piece, its polynomial in powers of the time since its start."""
    here = slice(first, last + 1)
    start, end = float(time[first]), float(time[last])
    fit = np.polynomial.Chebyshev.fit(time[here] - start, values[here], min(degree, last - first), [0.0, end - start])
    power = fit.convert(kind=Polynomial, domain=[-1.0, 1.0], window=[-1.0, 1.0])
    return Segment(start, end, tuple(float(c) for c in power.coef))


def _real_jumps(segments: Segments, others: Sequence[Segments], order: int) -> tuple[float, ...]:
    """Times, s, between two pieces at which the derivative of an ``order`` jumps by more than the rounding explains.

    ``others`` are fits of columns that would be printed the same: what differs among them is rounding.
    """
    scale = max(float(np.max(np.abs(s.value(np.array([s.start, s.end]), order)))) for s in segments)
    sizes = np.array([_border_jumps(pieces, order) for pieces in (segments, *others)]).reshape(len(others) + 1, -1)
    doubt = np.max(np.abs(sizes[1:] - sizes[0]), axis=0, initial=0.0)
    real = np.abs(sizes[0]) > np.maximum(4.0 * doubt, LEAST_JUMP * scale)
    return tuple(piece.start for piece, is_real in zip(segments[1:], real, strict=True) if is_real)


def _border_jumps(segments: Segments, order: int) -> list[float]:
    """By how much a derivative jumps between each piece and the next."""
    pairs = itertools.pairwise(segments)
    return [float(after.value(after.start, order) - before.value(after.start, order)) for before, after in pairs]


def _integrate_pieces(segments: Segments, start_angle: float) -> Segments:
    """Pieces of the angle, rad, from those of the speed, rad/s."""
    angle, result = start_angle, []
    for piece in segments:
        coefficients = (angle, *(c / (power + 1) for power, c in enumerate(piece.coefficients)))
        result.append(Segment(piece.start, piece.end, coefficients))
        angle = float(result[-1].value(piece.end))
    return tuple(result)


def unwrap_angles(angle: Array) -> Array:
    """Angles, rad, without the jumps of a whole turn that a tool makes at ±180° or 360°, even if they are degrees."""
    turn = next((turn for turn in (2.0 * math.pi, 360.0) if np.ptp(angle) <= SLACK * turn), None)
    return np.asarray(np.unwrap(angle, period=turn) if turn else angle)


def even_instants(at: Array, resolution: Array) -> tuple[Array, Array]:
    """Instants or angles (n,) and their doubt: equal steps, where the printed ones are equal but for rounding.

    What is then unknown is the mean of n roundings; a step that is printed in full leaves nothing open.
    """
    number = np.arange(len(at))
    if len(at) < FEWEST:
        return at, resolution
    known = np.maximum(resolution, 1e-12 * np.max(np.abs(at)))
    from_zero = float(np.sum(number * at / known**2) / np.sum((number / known) ** 2)) * number
    for even in (from_zero, np.polyval(np.polyfit(number, at, 1, w=1.0 / known), number)):
        if np.all(np.abs(even - at) <= SLACK * known):
            return np.asarray(even), np.full(
                len(at), float(np.max(np.abs(even - at))) / math.sqrt(len(at)), dtype=float
            )
    return at, resolution
