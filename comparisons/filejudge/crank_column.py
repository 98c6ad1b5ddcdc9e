"""The crank's motion from a column of a result file: a known one within the column's rounding, else a smooth spline.

A column of angles is rounded, and its differences are far from the crank's acceleration. So a run-up or a swing is
looked for first, whose few numbers the whole column tells; any other motion is a spline with as few knots as the
rounding allows. No judged signal is smoothed, only the angles at which the closed form is evaluated.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Final

import numpy as np
import scipy  # whose parts are loaded where they are used

from analytic.description.crank_motion import LAWS, RAMPS, CrankMotion, Segment, crank_motion, swing
from analytic.numerics.arrays import Array

SLACK: Final = 1.2  # of the rounding: the last bits of the numbers
SPREAD: Final = 3.0  # from the largest of so few trials to a bound
RANDOM_TRIALS: Final = 4  # other columns that would round to the same
WAVES: Final = (0.0, 1.0, 3.0, 7.0)  # half waves of slow ones over the column; none: all samples are off by the same
FINEST_ROUNDING: Final = 0.02  # of the coarsest rounding of a column

# Of known motions.
CONSTANT: Final = "constant-speed"
BACK: Final = " and back"
RUN_UPS: Final = (CONSTANT, *RAMPS)
_AT_REST: Final = [name for name, law in LAWS.items() if law.at_rest]
FAMILIES: Final = (*RUN_UPS, *_AT_REST, *(f"{name}{BACK}" for name in _AT_REST))
TRIED_TIMES: Final = 50  # from which the search of a family's time begins
SHORTEST_TIME: Final = 0.02  # of the duration: the shortest time tried
FEW_SAMPLES: Final = 200  # samples by which a family is ruled out
MOST_SAMPLES: Final = 2000  # samples to which a motion is fitted; all are compared with it
NO_DWELL: Final = 1e-9  # of the duration: no dwell
EVEN_OUT_BELOW: Final = 3.0  # roundings that the nearest motion by squares may leave of a column that is within its own
EVEN: Final = 4  # power of the residuals whose squares are then least: nearly the largest residual
EXACT_SHARE: Final = (
    0.02  # of the rounding: a smaller residual means that the column is printed in full, 1.5° after 1.5°
)
ROUND_MULTIPLE: Final = 200.0  # roundings, 100 last digits, of which the start of such a column is a multiple
LAST_BITS: Final = 1e-6  # of the rounding: the last bits of a number

# Of splines.
DEGREE: Final = 5
MOST_FITTED: Final = 10_000  # samples to which a spline is fitted
MANY_SAMPLES: Final = 1000  # of so many the sixth differences are noise
COLUMN: Final = "column"
CORNERS: Final = "constant accelerations"
CORNER: Final = 0.1  # of the fastest change of the acceleration: where it may jump
MOST_CORNERS: Final = 8
SIXTH_DIFFERENCE: Final = 20.5  # median of the sixth differences of noise, over its root mean square


@dataclass(frozen=True)
class ColumnMotion(CrankMotion):
    """A motion read from a column. Columns that would be printed the same may have the motions ``likewise``."""

    likewise: tuple[CrankMotion, ...] = ()

    @property
    def is_known(self) -> bool:
        """Whether it is a known motion: a run-up, a swing, or constant accelerations; and not any other spline."""
        return self.regime in (*FAMILIES, CORNERS)

    @cached_property
    def doubt(self) -> float:
        """The largest difference of its acceleration, rad/s², from those of columns that would be printed alike.

        Raises ValueError without motions ``likewise``.
        """
        time = np.linspace(0.0, self.duration, 501)
        return max(float(np.max(np.abs(o.acceleration(time) - self.acceleration(time)))) for o in self.likewise)

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s; a spline has none."""
        return CrankMotion(self.regime, self.segments).jumps if self.is_known else ()


@dataclass(frozen=True)
class _Samples:
    """A column (n,) of angles, rad, or speeds, rad/s, at times (n,), s, each within its rounding."""

    time: Array
    values: Array
    rounding: Array
    of_speed: bool

    @property
    def duration(self) -> float:
        """The time of the last sample, s."""
        return float(self.time[-1])

    def thinned(self, most: int) -> _Samples:
        """At most ``most`` of the samples, evenly spread, the first and the last among them."""
        few = np.unique(np.linspace(0, len(self.time) - 1, min(most, len(self.time))).astype(int))
        return replace(self, time=self.time[few], values=self.values[few], rounding=self.rounding[few])

    def trials(self, within: Array) -> list[_Samples]:
        """Columns that would be printed the same: with random errors ``within`` (n,), and with slow errors.

        There are RANDOM_TRIALS, the same every time, and one for each of WAVES. Slow ones are for a crank that goes on
        by the same angle from sample to sample: the last digit is then always off by the same amount, or changes
        slowly.
        """
        random = np.random.default_rng(0).uniform(-1.0, 1.0, (RANDOM_TRIALS, len(within)))
        slow = np.cos(np.outer(WAVES, np.linspace(0.0, math.pi, len(within))))
        return [replace(self, values=self.values + off * within) for off in (*random, *slow)]


def motion_of_angles(time: Array, angle: Array, resolution: Array) -> ColumnMotion:
    """The motion behind a column of crank angles (n,), rad, at times (n,), s, each rounded within its resolution.

    ``resolution`` (n,) is the largest error of each, rad. Angles have no jumps of a turn.
    """
    return _motion(time, angle, resolution, 0.0, of_speed=False)


def motion_of_speeds(time: Array, speed: Array, resolution: Array, start_angle: float = 0.0) -> ColumnMotion:
    """The motion behind crank speeds (n,), rad/s, each within its ``resolution`` (n,); starts at ``start_angle``, rad.

    ``time`` (n,) is in s.
    """
    return _motion(time, speed, resolution, start_angle, of_speed=True)


def _motion(time: Array, values: Array, resolution: Array, start_angle: float, *, of_speed: bool) -> ColumnMotion:
    """The motion of a column: a known one that agrees within the rounding, else a spline.

    ``start_angle``, rad, is for columns of speeds alone.
    """
    coarsest = float(np.max(resolution, initial=1e-12 * (1.0 + np.max(np.abs(values)))))
    rounding = np.maximum(resolution, FINEST_ROUNDING * coarsest)  # a run-up's first have more digits than any fit
    samples = _Samples(time, values, rounding, of_speed)
    known = known_fit(samples)
    if known is None:
        return _splines(samples, start_angle)
    first, *others = (fit.motion(start_angle) for fit in (known, *known.likewise()))
    return ColumnMotion(first.regime, first.segments, tuple(others))


# Known motions: run-ups and swings, which have a time of the ramp or of one way, a size and a start.


@dataclass(frozen=True)
class KnownFit:
    """A motion of a ``family`` fitted to samples: ``start`` plus ``size`` times the family's column of size 1.

    ``time``, s, is that of the ramp or of one way. A run-up of size 1 has the speed 1 rad/s, in a column of angles the
    speed 1 over ``time``; a swing's travel is 1 rad, in a column of speeds ``time``.
    """

    samples: _Samples
    family: str
    time: float
    size: float
    start: float

    @cached_property
    def residual(self) -> Array:
        """Column less fit, over the rounding, (n,)."""
        shape = _shape(self.family, self.samples, self.time)
        return np.asarray((self.samples.values - self.start - self.size * shape) / self.samples.rounding)

    @property
    def largest(self) -> float:
        """The largest magnitude of ``residual``, in roundings."""
        return float(np.max(np.abs(self.residual)))

    @property
    def is_within(self) -> bool:
        """Whether the column is that motion within its rounding."""
        return self.largest <= SLACK

    def likewise(self) -> list[KnownFit]:
        """Fits of this family to trial columns that would be printed as this one, of at most MOST_SAMPLES samples."""
        few = self.samples.thinned(MOST_SAMPLES)
        first = float(self.samples.values[0]) / (ROUND_MULTIPLE * float(np.max(self.samples.rounding)))
        is_exact = self.largest < EXACT_SHARE and abs(first - round(first)) < EXACT_SHARE
        within = few.rounding * (max(self.largest, LAST_BITS) if is_exact else 1.0)
        return [_fit_near(trial, self.family, self.time) for trial in few.trials(within)]

    def motion(self, start_angle: float) -> CrankMotion:
        """The fit as a motion, rad and s.

        One of speeds begins at ``start_angle``, rad, one of angles at its own start.
        """
        duration, runs_up = self.samples.duration, self.family in RUN_UPS  # to speed 1; a swing has travel 1
        law, back = self.family.removesuffix(BACK), self.family.endswith(BACK)
        if runs_up:
            unit = crank_motion(law, speed=1.0, ramp_time=self.time, hold_time=max(duration - self.time, 0.0))
        else:
            dwell = duration - (2.0 if back else 1.0) * self.time
            dwell = dwell if dwell > NO_DWELL * duration else 0.0
            unit = swing(law, 0.0, 1.0, time=self.time, dwell=dwell, back=back)
        of_speed = self.samples.of_speed
        size = self.size * (1.0 if runs_up is of_speed else 1.0 / self.time if runs_up else self.time)
        start = start_angle if of_speed else self.start
        pieces = ((p.start, p.end, [size * c for c in p.coefficients]) for p in unit.segments)
        segments = tuple(Segment(begin, end, (start + first, *rest)) for begin, end, (first, *rest) in pieces)
        return CrankMotion(self.family, segments)


@lru_cache
def _one_way(law: str) -> CrankMotion:
    """The motion of a law that takes 1 s to speed 1 or travel 1, followed by a long time of steady turning or rest.

    It is cached.
    """
    rest = 2.0 / SHORTEST_TIME
    if law in RUN_UPS:
        return crank_motion(law, speed=1.0, ramp_time=1.0, hold_time=rest)
    return swing(law, 0.0, 1.0, time=1.0, dwell=rest)


def _shape(family: str, samples: _Samples, time: float) -> Array:
    """The column (n,) of a family's motion of size 1 with this ramp or swing time, s, at the samples' times."""
    way, clock, order = _one_way(family.removesuffix(BACK)), samples.time, int(samples.of_speed)
    if not family.endswith(BACK):
        return np.asarray(way._evaluate(clock / time, order))
    returns = clock > 0.5 * samples.duration
    shape = way._evaluate(np.where(returns, samples.duration - clock, clock) / time, order)
    return np.asarray(np.where(returns, -shape, shape) if order else shape)


def known_fit(samples: _Samples) -> KnownFit | None:
    """The fit of the first of FAMILIES with a motion from t = 0 that is a column within its rounding.

    None without one, for a column at rest, and for one that begins before t = 0.
    """
    moved = samples.values if samples.of_speed else samples.values - samples.values[0]
    if samples.time[0] < 0.0 or np.max(np.abs(moved)) <= np.max(samples.rounding):
        return None
    fits = (_fit(samples, family) for family in FAMILIES)
    return next((fit for fit in fits if fit is not None), None)


def _fit(samples: _Samples, family: str) -> KnownFit | None:
    """The fit of a family that is within the rounding of all samples; None where there is none.

    Few samples rule a family out, more are fitted, all are compared.
    """
    few, longest = samples.thinned(FEW_SAMPLES), _longest(samples, family)
    tried = np.linspace(SHORTEST_TIME * samples.duration, longest, 1 if family == CONSTANT else TRIED_TIMES)
    coarse = [_fit_with_time(few, family, float(time)) for time in tried]
    near = min(coarse, key=lambda fit: float(fit.residual @ fit.residual)).time
    if not _evened_out(_fit_near(few, family, near)).is_within:
        return None
    fit = replace(_evened_out(_fit_near(samples.thinned(MOST_SAMPLES), family, near)), samples=samples)
    return fit if fit.is_within else None


def _longest(samples: _Samples, family: str) -> float:
    """The longest ramp or time of one way, s, that fits the column: no dwell or hold is left."""
    return (0.5 if family.endswith(BACK) else 1.0) * samples.duration


def _fit_near(samples: _Samples, family: str, guess: float) -> KnownFit:
    """The least-squares fit of a family, its ramp or swing time searched near ``guess``, s.

    "constant-speed" has no such time and keeps the guess.
    """
    if family == CONSTANT:  # which has no such time
        return _fit_with_time(samples, family, guess)
    near = samples.duration / TRIED_TIMES
    lower = max(guess - near, 0.5 * SHORTEST_TIME * samples.duration)
    upper = min(guess + near, _longest(samples, family))
    best = scipy.optimize.least_squares(
        lambda time: _fit_with_time(samples, family, float(time[0])).residual, guess, bounds=(lower, upper),
        x_scale=samples.duration, method="dogbox", xtol=1e-13, ftol=1e-15, gtol=None,
    )  # fmt: skip
    fits = [_fit_with_time(samples, family, time) for time in (float(best.x[0]), upper)]
    return min(fits, key=lambda fit: fit.largest)


def _evened_out(fit: KnownFit) -> KnownFit:
    """The fit, or the one near it with the least residuals to a high power, whichever has the smaller largest residual.

    Where the crank turns steadily every sample is rounded alike, and the squares are least where the others are off by
    that besides their own rounding. A fit within the rounding, or far from it, is returned as it is.
    """
    if fit.is_within or fit.largest >= EVEN_OUT_BELOW:
        return fit
    numbers = np.array([fit.time, fit.size, fit.start])
    free = np.array([fit.family != CONSTANT, True, not fit.samples.of_speed])

    def with_numbers(x: Array) -> KnownFit:
        """The fit with other values of its free numbers: of time, size and start those that its family has."""
        numbers[free] = x
        return KnownFit(fit.samples, fit.family, *numbers.tolist())

    even = scipy.optimize.least_squares(
        lambda x: with_numbers(x).residual ** EVEN, numbers[free], x_scale="jac", max_nfev=100
    )
    return min((fit, with_numbers(even.x)), key=lambda fit: fit.largest)


def _fit_with_time(samples: _Samples, family: str, time: float) -> KnownFit:
    """The least-squares fit of a family's size and start with this ramp or swing ``time``, s; of speeds start is 0."""
    shape, weights, values = _shape(family, samples, time), samples.rounding**-2.0, samples.values
    tip, mean = (0.0, 0.0) if samples.of_speed else (np.average(part, weights=weights) for part in (shape, values))
    arm = shape - tip
    size = float((weights * arm) @ (values - mean)) / (float((weights * arm) @ arm) or 1.0)
    return KnownFit(samples, family, time, size, float(mean - size * tip))


# Any other motion: a spline, of the second degree where accelerations are constant but for jumps, as a servo's.


def _splines(samples: _Samples, start_angle: float) -> ColumnMotion:
    """The motion as a spline, with corners of the acceleration if these suffice, and those of the trial columns.

    One of speeds begins at ``start_angle``, rad; to one of angles it is added. A long column that is rougher than its
    rounding is fitted within its noise.
    """
    noise = samples.rounding
    if len(samples.time) > MANY_SAMPLES:  # of a smooth column so finely sampled these differences are its noise
        differences = float(np.median(np.abs(np.diff(samples.values, 6))))
        noise = np.maximum(noise, math.sqrt(3.0) * differences / SIXTH_DIFFERENCE)
    few = replace(samples, rounding=noise).thinned(MOST_FITTED)
    degree = min(DEGREE, len(few.time) - 1)
    smooth = _smooth(few, degree)
    corners = _corners(few, smooth)
    knots, degree, name = (smooth.t, degree, COLUMN) if corners is None else (corners, 2 - few.of_speed, CORNERS)
    columns = (few, *few.trials(few.rounding))
    curves = [
        scipy.interpolate.make_lsq_spline(few.time, column.values, knots, degree, w=1.0 / few.rounding)
        for column in columns
    ]
    if corners is None:
        curves.append(_smooth(few.thinned(max(len(few.time) // 2, degree + 1)), degree))
    every = [curve.antiderivative() if samples.of_speed else curve for curve in curves]
    first, *others = (_motion_of_spline(curve, start_angle, name) for curve in every)
    return ColumnMotion(name, first.segments, tuple(others))


def _smooth(samples: _Samples, degree: int) -> scipy.interpolate.BSpline:
    """The spline of this degree whose residuals spread as roundings do; the nearest where SciPy reaches none.

    SciPy's warning of that is silenced.
    """
    time, weights = samples.time, math.sqrt(3.0) / samples.rounding
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return scipy.interpolate.make_splrep(time, samples.values, w=weights, k=degree, s=len(time))


def _corners(samples: _Samples, smooth: scipy.interpolate.BSpline) -> Array | None:
    """The knots of constant accelerations, s, that a column is within its rounding; None where there are none.

    They are sought where the acceleration of a ``smooth`` spline changes fastest, at most MOST_CORNERS.
    """
    time, degree = samples.time, 2 - samples.of_speed
    jerk = np.abs(smooth.derivative(degree + 1)(time))
    highest = scipy.ndimage.maximum_filter1d(jerk, 2 * (len(time) // TRIED_TIMES) + 1)
    found = np.flatnonzero((jerk == highest) & (jerk > CORNER * np.max(jerk)))
    found = found[(found > 0) & (found < len(time) - 1)]
    if not 0 < len(found) <= MOST_CORNERS:
        return None

    def knots(corners: Array) -> Array:
        """The knots of a spline with these corners, s, the ends repeated as its degree asks."""
        return np.concatenate([[time[0]] * (degree + 1), np.sort(corners), [time[-1]] * (degree + 1)])

    def residual(corners: Array) -> Array:
        """Least-squares spline with these corners, s, less the column, over the column's rounding, (n,)."""
        curve = scipy.interpolate.make_lsq_spline(
            time, samples.values, knots(corners), degree, w=1.0 / samples.rounding
        )
        return np.asarray((curve(time) - samples.values) / samples.rounding)

    near = (time[-1] - time[0]) / (2.0 * TRIED_TIMES)
    bounds = (np.maximum(time[found] - near, time[0]), np.minimum(time[found] + near, time[-1]))
    try:
        best = scipy.optimize.least_squares(residual, time[found], bounds=bounds, x_scale=near)
    except (ValueError, np.linalg.LinAlgError):  # corners that meet, or with no sample between them
        return None
    return knots(best.x) if np.max(np.abs(best.fun)) <= SLACK else None


def _motion_of_spline(curve: scipy.interpolate.BSpline, start_angle: float, name: str) -> CrankMotion:
    """The motion, named ``name``, with the pieces of a spline of angles, rad, over time, s.

    ``start_angle``, rad, is added to its angles.
    """
    pieces = scipy.interpolate.PPoly.from_spline(curve)
    spans = zip(pieces.x.tolist(), pieces.x[1:].tolist(), pieces.c[::-1].T.tolist(), strict=False)
    every = [(start, end, numbers) for start, end, numbers in spans if end > start]
    return CrankMotion(
        name, tuple(Segment(start, end, (start_angle + first, *rest)) for start, end, (first, *rest) in every)
    )


def unwrap_angles(angle: Array) -> Array:
    """Angles (n,), rad or degrees, without the jumps of a whole turn that a tool makes at ±180° or 360°.

    Which unit it is shows in their range; those that span more than a turn are returned unchanged.
    """
    turn = next((turn for turn in (2.0 * math.pi, 360.0) if np.ptp(angle) <= SLACK * turn), None)
    return np.asarray(np.unwrap(angle, period=turn) if turn else angle)


def even_instants(at: Array, resolution: Array) -> tuple[Array, Array]:
    """Instants or angles (n,) that are evenly spaced but for rounding, now evenly spaced, and their doubt, (n,).

    The ``resolution`` (n,) is the rounding of each, in the same unit. The doubt is then that of a mean of n roundings;
    a step that is printed in full leaves none. Others are returned as they are, with their own ``resolution``.
    """
    number = np.arange(len(at))
    known = np.maximum(resolution, 1e-12 * np.max(np.abs(at)))
    from_zero = float(np.sum(number * at / known**2) / np.sum((number / known) ** 2)) * number
    is_even = bool(np.all(np.abs(from_zero - at) <= SLACK * known))
    even = from_zero if is_even else np.polyval(np.polyfit(number, at, 1, w=1.0 / known), number)
    off = np.abs(even - at)
    if np.any(off > SLACK * known):
        return at, resolution
    return np.asarray(even), np.full(len(at), float(np.max(off)) / math.sqrt(len(at)))
