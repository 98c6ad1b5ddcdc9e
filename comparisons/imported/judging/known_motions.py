"""Motions that a column of crank angles or speeds may be within its rounding: a run-up, a swing, there and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from analytic.description.crank_motion import LAWS, RAMPS, CrankMotion, Segment, crank_motion, swing

Array = NDArray[np.float64]
Family = Callable[
    [float, float], CrankMotion
]  # time of the ramp or of one way, whole duration, s: of speed or travel 1

SLACK: Final = 1.2  # of the rounding: the last bits of the numbers
TIMES: Final = 50  # from which the search of a family's time begins
FEW: Final = 200  # samples by which a family is ruled out
SMALL, NEWTON = 1e-5, 3  # of the duration: a change of the time by which its slope is found; steps to rounding
LEAST: Final = 0.02  # of the duration: the shortest time tried


def _run_up(name: str, time: float, duration: float) -> CrankMotion:
    return crank_motion(name, speed=1.0, ramp_time=time, hold_time=max(duration - time, 0.0))


def _swing(law: str, time: float, duration: float, *, back: bool) -> CrankMotion:
    ways = 2.0 if back else 1.0
    return swing(law, 0.0, 1.0, time=time, dwell=max(duration - ways * time, 0.0), back=back)


_AT_REST: Final = [name for name, law in LAWS.items() if law.at_rest]
FAMILIES: Final[Mapping[str, Family]] = {
    **{name: partial(_run_up, name) for name in RAMPS},
    **{name: partial(_swing, name, back=False) for name in _AT_REST},
    **{f"{name} and back": partial(_swing, name, back=True) for name in _AT_REST},
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

    def fitted(self) -> KnownFit | None:
        """The motion of the family that the column is within its rounding, if there is one."""
        thin = replace(self, **{part: getattr(self, part)[:: -(-len(self.time) // FEW)] for part in PARTS})
        coarse = np.linspace(LEAST * self.duration, self._longest, TIMES)
        near = float(coarse[int(np.argmin([thin._cost(time) for time in coarse]))])
        if not thin.near(near).is_within:
            return None
        fit = self.near(near)
        return fit if fit.is_within else None

    @property
    def _longest(self) -> float:
        """The longest time, s: neither a dwell nor a hold is left."""
        return (0.5 if self.name.endswith("back") else 1.0) * self.duration

    def near(self, about: float) -> KnownFit:
        """The nearest motion whose time is about that."""
        bounds = (max(about - self.duration / TIMES, 0.5 * LEAST * self.duration), about + self.duration / TIMES)
        options = {"xatol": 1e-12 * self.duration}
        place = float(minimize_scalar(self._cost, bounds=bounds, method="bounded", options=options).x)
        fits = [self._settled(place)]
        if self._longest < bounds[1]:
            fits.append(self._of(self._longest))
        return min(fits, key=lambda fit: float(np.max(np.abs(fit.rest / self.rounding))))

    def _settled(self, time: float) -> KnownFit:
        """The fit at a time to rounding: the least of a cost tells its place to the root of rounding only."""
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

    def _of(self, time: float) -> KnownFit:
        """The motion with that time that is nearest to the column."""
        one = FAMILIES[self.name](time, self.duration)
        shape = one.speed(self.time) if self.of_speed else one.angle(self.time)
        weights = self.rounding**-2.0
        means = (0.0, 0.0) if self.of_speed else (np.average(part, weights=weights) for part in (shape, self.values))
        tip, mean = means
        arm = shape - tip
        size = float((weights * arm) @ (self.values - mean)) / (float((weights * arm) @ arm) or 1.0)
        start = float(mean - size * tip)
        return KnownFit(self, time, one, size, start, np.asarray(self.values - start - size * shape))


PARTS: Final = ("time", "values", "rounding")


@dataclass(frozen=True)
class KnownFit:
    """A motion of a family with its time, size and start, and the rest (n,) that it leaves of the column."""

    column: KnownColumn
    time: float
    one: CrankMotion
    size: float
    start: float
    rest: Array

    @property
    def is_within(self) -> bool:
        """Whether the column is that motion within its rounding."""
        return bool(np.all(np.abs(self.rest) <= SLACK * self.column.rounding))

    @property
    def motion(self) -> CrankMotion:
        """The motion, rad and s."""
        pieces = tuple(
            Segment(
                p.start,
                p.end,
                (self.start + self.size * p.coefficients[0], *(self.size * c for c in p.coefficients[1:])),
            )
            for p in self.one.segments
        )
        return CrankMotion(self.column.name, pieces)


def known_fit(time: Array, values: Array, rounding: Array, *, of_speed: bool) -> KnownFit | None:
    """The first family with a motion from t = 0, before which no file begins, that a column is within its rounding."""
    if time[0] < 0.0 or np.ptp(values) <= np.max(rounding):
        return None
    column = KnownColumn("", time, values, rounding, of_speed, float(time[-1]))
    fits = (replace(column, name=name).fitted() for name in FAMILIES)
    return next((fit for fit in fits if fit is not None), None)
