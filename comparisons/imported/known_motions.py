"""Motions that a column of crank angles or speeds may be within its rounding: constant speed, a run-up, a swing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, linprog

from analytic.description.crank_motion import LAWS, RAMPS, CrankMotion, Segment, crank_motion, swing

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
