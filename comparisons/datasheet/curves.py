"""Every signal of a case over its motion, and their peaks, refined beyond the instants of the grid; SI."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic import signals
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.written import finite
from analytic.numerics.averages import averages
from analytic.numerics.refine import highest
from comparisons.datasheet.instants import Instants, refine_near_toggles
from comparisons.reference.case import Case, Truth

Array = NDArray[np.float64]
Measure = Callable[[Truth], Array]
Key = TypeVar("Key", bound=Hashable)

TIME: Final = "time"
TRANSMISSION: Final = "transmission_angle:"
DIRECTION: Final = ":direction"  # of a force in place of its magnitude
BATCH: Final = 48  # curves whose peaks are refined together: more would compute much that none of them needs
CELL: Final = 16  # steps of the grid to a cell of a mean


@dataclass(frozen=True)
class SignalFigure:
    """A number of a designer: ``what`` it is, of a force the link it acts ``on``, its signal, value and SI unit.

    ``time``, s, and ``phi``, rad, of a drive along a line m, are its place; None for a mean. A value that is not
    finite, as a joint's force at a change point, is None. ``joint_force:A:direction``, rad, is no signal of the closed
    form.
    """

    what: str
    signal: str
    value: float | None
    unit: str
    on: str = ""
    time: float | None = None
    phi: float | None = None


@dataclass(frozen=True)
class Curves:
    """The signals of a case by name: those of ``analytic.signals``, the time, and magnitudes of forces.

    A magnitude is ``joint_force:A:magnitude``, or ``shaking_force:magnitude``.
    """

    case: Case

    @cached_property
    def instants(self) -> Instants:
        """The instants at which the motion is looked at."""
        return Instants(self.case.motion, turns=not self.linkage.is_linear)

    @property
    def linkage(self) -> Linkage:
        """The linkage."""
        return self.case.mechanism.linkage

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all signals, the time first, a magnitude after the components of its vector."""
        return (TIME, *signals.names_with_magnitudes(self.case.mechanism))

    def unit(self, name: str) -> str:
        """SI unit of a signal."""
        return "s" if name == TIME else signals.unit(name, self.linkage)

    @cached_property
    def grid(self) -> Array:
        """Instants over the whole motion, s, closer to each other near dead positions."""
        return refine_near_toggles(self.case, self.instants.grid)

    @cached_property
    def on_grid(self) -> Truth:
        """The closed form over the whole motion."""
        return self.truth_at(self.grid)

    def truth_at(self, time: Array) -> Truth:
        """The closed form of the case at instants (n,), s."""
        return Truth(self.case.mechanism, self.case.motion, time)

    def values(self, names: Iterable[str], time: float) -> tuple[float, ...]:
        """Values, SI, of the signals ``names`` at one instant, s."""
        truth = self.truth_at(np.array([time]))
        return tuple(float(self.signal_values(truth, name)[0]) for name in names)

    def signal_values(self, truth: Truth, name: str) -> Array:
        """A signal (n,), SI, of the closed form at n instants; a link's angle on its branch of the motion."""
        if name == TIME:
            return truth.time
        values = signals.signal(truth, name)
        return self._unwrapped(name, truth, values) if signals.is_angle(name) and name != "phi" else values

    def table(self, truth: Truth, names: Iterable[str] = ()) -> dict[str, Array]:
        """Signals (n,), SI, of the closed form at n instants by name, all by default."""
        return {name: self.signal_values(truth, name) for name in names or self.names}

    def _unwrapped(self, name: str, truth: Truth, angle: Array) -> Array:
        """The angle of a link on the branch that it has along the whole motion, whatever the order of the instants."""
        near = np.interp(truth.time, self.grid, signals.signal(self.on_grid, name))
        return np.asarray(angle + FULL_TURN * np.round((near - angle) / FULL_TURN))

    def figure(self, what: str, name: str, value: float, time: float | None = None, on: str = "") -> SignalFigure:
        """A key figure of a signal, or the direction of a force, at an instant."""
        phi = None if time is None else float(self.case.motion.angle(np.array([time]))[0])
        unit = "rad" if name.endswith(DIRECTION) else self.unit(name)
        return SignalFigure(what, name, finite(value), unit, on, time, phi)

    def peaks(self, names: Iterable[str]) -> dict[str, SignalFigure]:
        """The peak of each signal, between instants too: the largest magnitude, of a transmission angle the least."""
        places = self.places({name: self._severity(name) for name in names})
        truth = self.truth_at(np.array([*places.values()]))
        values = [float(self.signal_values(truth, name)[row]) for row, name in enumerate(places)]
        return {n: self.figure("peak", n, value, places[n]) for n, value in zip(places, values, strict=True)}

    def _severity(self, name: str) -> Measure:
        """The measure that is highest at a signal's peak."""
        if name.startswith(TRANSMISSION):
            return lambda at: -self.signal_values(at, name)
        return lambda at: np.abs(self.signal_values(at, name))

    def places(self, measures: Mapping[Key, Measure]) -> dict[Key, float]:
        """The instant, s, at which each measure of the closed form is highest, refined beyond the grid."""
        numbers: dict[Key, float] = {}
        names = list(measures)
        for keys in (names[start : start + BATCH] for start in range(0, len(names), BATCH)):
            chosen = [measures[key] for key in keys]

            def curves(time: Array, chosen: Iterable[Measure] = chosen) -> Array:
                truth = self.truth_at(time)
                return np.stack([measure(truth) for measure in chosen])

            sampled = np.stack([measure(self.on_grid) for measure in chosen])
            _, places = highest(curves, self.grid, sampled)
            numbers |= dict(zip(keys, places.tolist(), strict=True))
        return numbers

    def means(self, *measures: Measure) -> list[float]:
        """Means over time of measures of the closed form."""
        jumps = [jump for jump in self.case.motion.jumps if 0.0 < jump < self.grid[-1]]

        def integrands(_: object, time: Array) -> Array:
            truth = self.truth_at(time.ravel())
            return np.stack([measure(truth).reshape(time.shape) for measure in measures])

        edges = np.unique(np.concatenate([self.grid[::CELL], jumps, self.grid[-1:]]))
        return [float(mean) for (mean,) in averages(integrands, edges)]
