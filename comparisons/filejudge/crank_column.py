"""The crank's motion from a column of a result file: as few polynomials of time as the column's rounding allows.

A column of angles is rounded, and its differences are far from the crank's acceleration. A piece is therefore as long
as one polynomial of low degree stays within the rounding: a constant speed is one piece, a linear run-up two, whatever
the number of samples. No judged signal is smoothed, only the angles at which the closed form is evaluated.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import Final

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import PPoly, make_lsq_spline
from scipy.optimize import least_squares, linprog

from analytic.description.crank_motion import LAWS, RAMPS, CrankMotion, Segment, crank_motion, swing
from analytic.errors import LinkproofError

Array = NDArray[np.float64]
Family = Callable[
    [float, float], CrankMotion
]  # time of the ramp or of one way, whole duration, s: of speed or travel 1

CONSTANT: Final = "constant-speed"
SLACK: Final = 1.2  # of the rounding: the last bits of the numbers
TRIED_TIMES: Final = 50  # from which the search of a family's time begins
EVEN_OUT_BELOW: Final = 3.0  # roundings that the nearest motion by squares may leave of a column that is within its own
FEW_SAMPLES: Final = 200  # samples by which a family is ruled out
MOST_SAMPLES: Final = 2000  # samples to which a motion is fitted; all are compared with it
NO_DWELL: Final = 1e-9  # of the duration: no dwell
TIME_STEP: Final = 1e-5  # of the duration: a step of the time for its derivative
SHORTEST_TIME: Final = 0.02  # of the duration: the shortest time tried
PARTS: Final = ("time", "values", "rounding")

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


def _run_up(name: str, time: float, duration: float) -> CrankMotion:
    return crank_motion(name, speed=1.0, ramp_time=time, hold_time=max(duration - time, 0.0))


def _swing(law: str, time: float, duration: float, *, back: bool) -> CrankMotion:
    dwell = duration - (2.0 if back else 1.0) * time
    return swing(law, 0.0, 1.0, time=time, dwell=dwell if dwell > NO_DWELL * duration else 0.0, back=back)


RUN_UPS: Final = (CONSTANT, *RAMPS)
BACK: Final = " and back"
_AT_REST: Final = [name for name, law in LAWS.items() if law.at_rest]
FAMILIES: Final[Mapping[str, Family]] = {
    **{name: partial(_run_up, name) for name in RUN_UPS},
    **{name: partial(_swing, name, back=False) for name in _AT_REST},
    **{f"{name}{BACK}": partial(_swing, name, back=True) for name in _AT_REST},
}


@dataclass(frozen=True)
class KnownColumn:
    """A column (n,), at times (n,), s, each sample within its rounding, and the ``family`` of motions fitted to it."""

    family: str
    time: Array
    values: Array
    rounding: Array
    of_speed: bool
    duration: float

    def thinned(self, most: int) -> KnownColumn:
        """At most so many of the samples, equally spread."""
        return replace(self, **{part: getattr(self, part)[:: -(-len(self.time) // most)] for part in PARTS})

    def fit(self) -> KnownFit | None:
        """The motion of the family that the column is within its rounding; None where there is none."""
        thin = self.thinned(FEW_SAMPLES)
        coarse = np.linspace(
            SHORTEST_TIME * self.duration, self._longest, 1 if self.family == CONSTANT else TRIED_TIMES
        )
        near = float(coarse[int(np.argmin([thin._cost(time) for time in coarse]))])
        if not thin._best_fit_near(near).is_within:
            return None
        fit = self.thinned(MOST_SAMPLES)._best_fit_near(near)
        return (
            fit
            if replace(fit, residual=self._residual_of(fit.time, fit.size, fit.start), column=self).is_within
            else None
        )

    def _best_fit_near(self, guess: float) -> KnownFit:
        """The best fit with a time near ``guess``, s: by least squares, or else by the largest residual.

        Where the crank turns steadily every sample is rounded alike, and the squares are least where the others are
        off by that besides their own rounding.
        """
        fit = self.fit_near(guess)
        return self._minimax_fit(fit) if not fit.is_within and fit.largest < EVEN_OUT_BELOW else fit

    def _minimax_fit(self, fit: KnownFit) -> KnownFit:
        """The motion near a fit whose largest residual, over the rounding, is least: a linear programme."""
        step, free = TIME_STEP * self.duration, np.array([self.family != CONSTANT, True, not self.of_speed])
        by_time = (self._residual_of(fit.time + step, fit.size, fit.start) - fit.residual) / step
        slopes = np.column_stack([by_time, -self._shape(fit.time), -np.ones(len(self.time))]) * free
        slopes /= self.rounding[:, None]
        sizes, rest = np.max(np.abs(slopes), axis=0) + ~free, fit.residual / self.rounding
        least = linprog(
            (0.0, 0.0, 0.0, 1.0),
            np.vstack([np.column_stack([side * slopes / sizes, -np.ones(len(rest))]) for side in (1.0, -1.0)]),
            np.concatenate([-rest, rest]),
            bounds=(None, None),
        )
        if not least.success:
            return fit
        time, size, start = np.array([fit.time, fit.size, fit.start]) + free * least.x[:3] / sizes
        return KnownFit(self, float(time), float(size), float(start), self._residual_of(time, size, start))

    @property
    def _longest(self) -> float:
        """The longest time, s: neither a dwell nor a hold is left."""
        return (0.5 if self.family.endswith(BACK) else 1.0) * self.duration

    def fit_near(self, guess: float) -> KnownFit:
        """The least-squares fit of the family, its ramp or swing time searched near ``guess``, s.

        Constant speed has no such time, so that its fit is direct.
        """
        if self.family == CONSTANT:
            return self._fit_with_time(guess)
        near = self.duration / TRIED_TIMES
        bounds = (max(guess - near, 0.5 * SHORTEST_TIME * self.duration), min(guess + near, self._longest))
        options = {"x_scale": self.duration, "xtol": 1e-13, "ftol": 1e-15, "gtol": None}
        place = least_squares(
            lambda time: self._fit_with_time(float(time[0])).residual / self.rounding, guess,
            bounds=[(bound,) for bound in bounds], method="dogbox", **options,
        )  # fmt: skip
        fits = [self._fit_with_time(time) for time in (float(place.x[0]), *bounds[1:])]
        return min(fits, key=lambda fit: fit.largest)

    def _cost(self, time: float) -> float:
        """Sum of the squared residuals over the rounding, with this ramp or swing time, s."""
        return float(np.sum((self._fit_with_time(time).residual / self.rounding) ** 2))

    def _shape(self, time: float) -> Array:
        """The family's column (n,) of size 1 with a ramp or swing time, s: one motion on another clock."""
        motion, order = _unit_motion(self.family.removesuffix(BACK)), int(self.of_speed)
        if self.family.endswith(BACK):
            returns = self.time > 0.5 * self.duration
            shape = motion._evaluate(np.where(returns, self.duration - self.time, self.time) / time, order)
            return np.asarray(np.where(returns, -shape, shape) if order else shape)
        return np.asarray(motion._evaluate(self.time / time, order))

    def _residual_of(self, time: float, size: float, start: float) -> Array:
        """What a motion leaves of the column, (n,)."""
        return np.asarray(self.values - start - size * self._shape(time))

    def _fit_with_time(self, time: float) -> KnownFit:
        """The least-squares fit with this ramp or swing ``time``, s."""
        shape, weights = self._shape(time), self.rounding**-2.0
        means = (0.0, 0.0) if self.of_speed else (np.average(part, weights=weights) for part in (shape, self.values))
        tip, mean = means
        arm = shape - tip
        size = float((weights * arm) @ (self.values - mean)) / (float((weights * arm) @ arm) or 1.0)
        start = float(mean - size * tip)
        return KnownFit(self, time, size, start, self._residual_of(time, size, start))


@dataclass(frozen=True)
class KnownFit:
    """A motion of a family with its time, size and start, and the ``residual`` (n,) that it leaves of the column."""

    column: KnownColumn
    time: float
    size: float
    start: float
    residual: Array

    @property
    def values(self) -> Array:
        """The fitted column, (n,)."""
        return self.column.values - self.residual

    @property
    def largest(self) -> float:
        """The largest residual over the rounding."""
        return float(np.max(np.abs(self.residual) / self.column.rounding))

    @property
    def is_within(self) -> bool:
        """Whether the column is that motion within its rounding."""
        return self.largest <= SLACK

    @property
    def motion(self) -> CrankMotion:
        """The motion, rad and s; the size is that of a shape in 1 s."""
        column = self.column
        entry = FAMILIES[column.family](self.time, column.duration)
        runs_up = column.family in RUN_UPS  # to speed 1; a swing has travel 1
        size = self.size * (1.0 if runs_up is column.of_speed else 1.0 / self.time if runs_up else self.time)
        pieces = tuple(
            Segment(
                p.start,
                p.end,
                (self.start + size * p.coefficients[0], *(size * c for c in p.coefficients[1:])),
            )
            for p in entry.segments
        )
        return CrankMotion(self.column.family, pieces)


@lru_cache
def _unit_motion(name: str) -> CrankMotion:
    """A run-up or one way of a swing in 1 s, and long enough after it."""
    rest = 2.0 / SHORTEST_TIME
    return _run_up(name, 1.0, rest) if name in RUN_UPS else swing(name, 0.0, 1.0, time=1.0, dwell=rest)


def known_fit(time: Array, values: Array, rounding: Array, *, of_speed: bool) -> KnownFit | None:
    """The fit of the first family with a motion from t = 0 that is a column within its rounding; None without one."""
    moved = values if of_speed else values - values[0]
    if time[0] < 0.0 or np.max(np.abs(moved)) <= np.max(rounding):
        return None
    column = KnownColumn("", time, values, rounding, of_speed, float(time[-1]))
    fits = (replace(column, family=name).fit() for name in FAMILIES)
    return next((fit for fit in fits if fit is not None), None)


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
