"""Motions that a column of crank angles or speeds may be within its rounding: constant speed, a run-up, a swing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, minimize_scalar

from analytic.description.crank_motion import LAWS, RAMPS, CrankMotion, Segment, crank_motion, swing

Array = NDArray[np.float64]
Family = Callable[
    [float, float], CrankMotion
]  # time of the ramp or of one way, whole duration, s: of speed or travel 1

CONSTANT: Final = "constant-speed"
SLACK: Final = 1.2  # of the rounding: the last bits of the numbers
TIMES: Final = 50  # from which the search of a family's time begins
TWICE: Final = 3.0  # roundings that the nearest motion by squares may leave of a column that is within its own
FEW: Final = 200  # samples by which a family is ruled out
MOST: Final = 2000  # samples to which a motion is fitted; all are compared with it
NOTHING: Final = 1e-9  # of the duration: no dwell
SMALL, NEWTON = 1e-5, 3  # of the duration: a step of the time for its derivative; Newton steps
LEAST: Final = 0.02  # of the duration: the shortest time tried
PARTS: Final = ("time", "values", "rounding")


def _run_up(name: str, time: float, duration: float) -> CrankMotion:
    return crank_motion(name, speed=1.0, ramp_time=time, hold_time=max(duration - time, 0.0))


def _swing(law: str, time: float, duration: float, *, back: bool) -> CrankMotion:
    dwell = duration - (2.0 if back else 1.0) * time
    return swing(law, 0.0, 1.0, time=time, dwell=dwell if dwell > NOTHING * duration else 0.0, back=back)


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
    """A column (n,), at times (n,), s, each sample within its rounding, to which the motions of a family are fitted."""

    name: str
    time: Array
    values: Array
    rounding: Array
    of_speed: bool
    duration: float

    def thinned(self, most: int) -> KnownColumn:
        """At most so many of the samples, equally spread."""
        return replace(self, **{part: getattr(self, part)[:: -(-len(self.time) // most)] for part in PARTS})

    def fitted(self) -> KnownFit | None:
        """The motion of the family that the column is within its rounding, if there is one."""
        thin = self.thinned(FEW)
        coarse = np.linspace(LEAST * self.duration, self._longest, 1 if self.name == CONSTANT else TIMES)
        near = float(coarse[int(np.argmin([thin._cost(time) for time in coarse]))])
        if not thin._within(near).is_within:
            return None
        fit = self.thinned(MOST)._within(near)
        return fit if replace(fit, rest=self._rest(fit.time, fit.size, fit.start), column=self).is_within else None

    def _within(self, about: float) -> KnownFit:
        """The nearest motion by squares, or if the column is not within its rounding of that, by the largest rest.

        Where the crank turns steadily every sample is rounded alike, and the squares are least where the others are
        off by that besides their own rounding.
        """
        fit = self.near(about)
        return self._evened(fit) if not fit.is_within and fit.largest < TWICE else fit

    def _evened(self, fit: KnownFit) -> KnownFit:
        """The motion beside a fit whose largest rest, over the rounding, is least: a linear programme."""
        step, free = SMALL * self.duration, np.array([self.name != CONSTANT, True, not self.of_speed])
        by_time = (self._rest(fit.time + step, fit.size, fit.start) - fit.rest) / step
        slopes = np.column_stack([by_time, -self._shape(fit.time), -np.ones(len(self.time))]) * free
        slopes /= self.rounding[:, None]
        sizes, rest = np.max(np.abs(slopes), axis=0) + ~free, fit.rest / self.rounding
        least = linprog(
            (0.0, 0.0, 0.0, 1.0),
            np.vstack([np.column_stack([side * slopes / sizes, -np.ones(len(rest))]) for side in (1.0, -1.0)]),
            np.concatenate([-rest, rest]),
            bounds=(None, None),
        )
        if not least.success:
            return fit
        time, size, start = np.array([fit.time, fit.size, fit.start]) + free * least.x[:3] / sizes
        return KnownFit(self, float(time), float(size), float(start), self._rest(time, size, start))

    @property
    def _longest(self) -> float:
        """The longest time, s: neither a dwell nor a hold is left."""
        return (0.5 if self.name.endswith(BACK) else 1.0) * self.duration

    def near(self, about: float) -> KnownFit:
        """The nearest motion whose time is about that; constant speed has none."""
        if self.name == CONSTANT:
            return self._of(about)
        bounds = (max(about - self.duration / TIMES, 0.5 * LEAST * self.duration), about + self.duration / TIMES)
        options = {"xatol": 1e-12 * self.duration}
        place = float(minimize_scalar(self._cost, bounds=bounds, method="bounded", options=options).x)
        fits = [self._settled(place)]
        if self._longest < bounds[1]:
            fits.append(self._of(self._longest))
        return min(fits, key=lambda fit: fit.largest)

    def _settled(self, time: float) -> KnownFit:
        """The fit refined by Newton steps: a minimum of a cost alone has half the digits."""
        fit, step = self._of(time), SMALL * self.duration
        for _ in range(NEWTON):
            slope = (self._of(fit.time + step).rest - self._of(fit.time - step).rest) / (2.0 * step * self.rounding)
            change = float(slope @ (fit.rest / self.rounding)) / (float(slope @ slope) or 1.0)
            if abs(change) > step:
                break
            fit = self._of(fit.time - change)
        return fit

    def _cost(self, time: float) -> float:
        return float(np.sum((self._of(time).rest / self.rounding) ** 2))

    def _shape(self, time: float) -> Array:
        """The column of size 1 with that time, (n,): of one motion for all times, on another clock."""
        motion, order = _unit(self.name.removesuffix(BACK)), int(self.of_speed)
        if self.name.endswith(BACK):
            returns = self.time > 0.5 * self.duration
            shape = motion._evaluate(np.where(returns, self.duration - self.time, self.time) / time, order)
            return np.asarray(np.where(returns, -shape, shape) if order else shape)
        return np.asarray(motion._evaluate(self.time / time, order))

    def _rest(self, time: float, size: float, start: float) -> Array:
        return np.asarray(self.values - start - size * self._shape(time))

    def _of(self, time: float) -> KnownFit:
        """The motion with that time that is nearest to the column."""
        shape, weights = self._shape(time), self.rounding**-2.0
        means = (0.0, 0.0) if self.of_speed else (np.average(part, weights=weights) for part in (shape, self.values))
        tip, mean = means
        arm = shape - tip
        size = float((weights * arm) @ (self.values - mean)) / (float((weights * arm) @ arm) or 1.0)
        start = float(mean - size * tip)
        return KnownFit(self, time, size, start, self._rest(time, size, start))


@dataclass(frozen=True)
class KnownFit:
    """A motion of a family with its time, size and start, and the rest (n,) that it leaves of the column."""

    column: KnownColumn
    time: float
    size: float
    start: float
    rest: Array

    @property
    def values(self) -> Array:
        """The fitted column, (n,)."""
        return self.column.values - self.rest

    @property
    def largest(self) -> float:
        """The largest rest over the rounding."""
        return float(np.max(np.abs(self.rest) / self.column.rounding))

    @property
    def is_within(self) -> bool:
        """Whether the column is that motion within its rounding."""
        return self.largest <= SLACK

    @property
    def motion(self) -> CrankMotion:
        """The motion, rad and s; the size is that of a shape in 1 s."""
        column = self.column
        entry = FAMILIES[column.name](self.time, column.duration)
        runs_up = column.name in RUN_UPS  # to speed 1; a swing has travel 1
        size = self.size * (1.0 if runs_up is column.of_speed else 1.0 / self.time if runs_up else self.time)
        pieces = tuple(
            Segment(
                p.start,
                p.end,
                (self.start + size * p.coefficients[0], *(size * c for c in p.coefficients[1:])),
            )
            for p in entry.segments
        )
        return CrankMotion(self.column.name, pieces)


@lru_cache
def _unit(name: str) -> CrankMotion:
    """A run-up or one way of a swing in 1 s, and long enough after it."""
    rest = 2.0 / LEAST
    return _run_up(name, 1.0, rest) if name in RUN_UPS else swing(name, 0.0, 1.0, time=1.0, dwell=rest)


def known_fit(time: Array, values: Array, rounding: Array, *, of_speed: bool) -> KnownFit | None:
    """The first family with a motion from t = 0, before which no file begins, that a column is within its rounding."""
    moved = values if of_speed else values - values[0]
    if time[0] < 0.0 or np.max(np.abs(moved)) <= np.max(rounding):
        return None
    column = KnownColumn("", time, values, rounding, of_speed, float(time[-1]))
    fits = (replace(column, name=name).fitted() for name in FAMILIES)
    return next((fit for fit in fits if fit is not None), None)
