"""Figures of designs from sweeps of many at once: signals sampled at the same crank angles, and reduced."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.designs.batches import BLOCK, Integers, Sweeps, faults_of
from analytic.designs.figures import Figure, Reduction
from analytic.designs.tops import Tops, summits, tops
from analytic.evaluation import MovingSweep
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import signal

Array = NDArray[np.float64]
Extreme = tuple[str, Reduction]  # a signal and MAX, MIN or PEAK

MAGNITUDE: Final = ":magnitude"
OUTPUT: Final = "output"  # the output's coordinate; no signal, for what is seen of it is S
FULL_TURN: Final = 2.0 * np.pi
EXTREMES: Final = {
    Reduction.PEAK: (Reduction.PEAK,),
    Reduction.MAX: (Reduction.MAX,),
    Reduction.MIN: (Reduction.MIN,),
    Reduction.RANGE: (Reduction.MAX, Reduction.MIN),
}


@dataclass(frozen=True)
class Asked:
    """What is asked of every design: ``places`` (angles,) of the driver, ascending, its ``speed``, ``share`` of means.

    Extremes are true ones with ``refine``; over a ``period``, rad, curves close, else their ends count.
    """

    mechanism: Mechanism
    figures: tuple[Figure, ...]
    places: Array
    speed: float
    share: Array
    period: float | None
    refine: bool

    def of(self, sweeps: Sweeps, rows: Integers) -> Array:
        """The figures of the designs of some rows, (figures, rows)."""
        return _Chunk(self, sweeps, rows).all(self.figures)


class _Marked(NamedTuple):
    """Sampled tops of a signal, with its sign at each (n,): heights are the sign times the signal less its middle."""

    tops: Tops
    signs: Array


class _Chunk:
    """Designs whose tops are looked for together; their samples are forgotten block by block."""

    def __init__(self, asked: Asked, sweeps: Sweeps, rows: Integers) -> None:
        self.asked, self.sweeps, self.rows = asked, sweeps, rows
        self.faulty = np.zeros(len(rows), dtype=bool)
        self.farthest = np.zeros(len(rows))
        self.refined = EXTREMES if asked.refine else {}

    def all(self, figures: Sequence[Figure]) -> Array:
        """The figures, (figures, rows)."""
        if self.asked.refine and any(one.signal == "S" for one in figures):
            self.farthest = self._figures([Figure(OUTPUT, Reduction.MAX)])[0]
        result = self._figures(figures)
        result[:, self.faulty] = np.nan
        return result

    def _figures(self, figures: Sequence[Figure]) -> Array:
        result = np.full((len(figures), len(self.rows)), np.nan)
        extremes = [(one.signal, sense) for one in figures for sense in self.refined.get(one.reduction, ())]
        found: dict[Extreme, list[_Marked]] = {extreme: [] for extreme in extremes}
        places = self.asked.places
        size = max(1, BLOCK // len(places))
        for start in range(0, len(self.rows), size):
            here = np.arange(start, min(start + size, len(self.rows)))
            sampled = self._sampled(here, dict.fromkeys(one.signal for one in figures))
            for row, one in enumerate(figures):
                if one.reduction is Reduction.AT:
                    result[row, here] = sampled[one.signal][:, np.argmin(np.abs(places - one.angle))]
                elif one.reduction not in self.refined:
                    result[row, here] = _reduced(one, sampled[one.signal], self.asked.share)
            for extreme, parts in found.items():
                parts.append(self._marked(extreme, sampled[extreme[0]], start))
        heights = {extreme: self._highest(extreme, parts) for extreme, parts in found.items()}
        every = np.arange(len(self.rows))
        for row, one in enumerate(figures):
            if one.reduction is Reduction.AT:
                angle = np.full((len(every), 1), one.angle)
                result[row] = self._seen(one.signal, every, angle, result[row])[:, 0]
            elif one.reduction in self.refined:
                ends = [heights[one.signal, sense] for sense in self.refined[one.reduction]]
                result[row] = ends[0] if len(ends) == 1 else ends[0] - ends[1]
        return result

    def _sampled(self, here: Integers, names: Iterable[str]) -> dict[str, Array]:
        """Signals of some of the designs at the crank angles all are sampled at, (designs, angles)."""
        places, names = self.asked.places, list(names)
        at = self._at(here, np.broadcast_to(places, (len(here), len(places))), only_output=names == [OUTPUT])
        if "S" in names and not self.asked.refine:
            self.farthest[here] = np.max(at.sweep.output(), axis=1)
            at = replace(at, farthest=self.farthest[here, None])
        return {name: curve(at, name) for name in names}

    def _at(self, here: Integers, phi: Array, *, only_output: bool = False) -> MovingSweep:
        """Some of the designs at crank angles, (designs, angles), with all groups solved; faults are noted."""
        sweep = self.sweeps(self.rows[here], phi)
        if not only_output:
            for body in sweep.structure.bodies:
                sweep.rates(body)
            self.faulty[here[faults_of(sweep).any(axis=1)]] = True
        return MovingSweep(
            self.asked.mechanism, sweep, np.asarray(self.asked.speed), np.asarray(0.0), self.farthest[here, None]
        )

    def _seen(self, name: str, designs: Integers, phi: Array, near: Array) -> Array:
        """A signal of designs (n,), each at its own crank angles (n, m); links' angles on the branch ``near`` (n,)."""
        every, flat = np.repeat(designs, phi.shape[1]), phi.ravel()
        values: Array = np.empty(phi.size)
        for start in range(0, len(every), BLOCK):
            here = slice(start, start + BLOCK)
            at = self._at(every[here], flat[here, None], only_output=name == OUTPUT)
            values[here] = curve(at, name)[:, 0]
        values = values.reshape(phi.shape)
        if _is_angle(name):
            values += FULL_TURN * np.round((near[:, None] - values) / FULL_TURN)
        return values

    def _marked(self, extreme: Extreme, values: Array, start: int) -> _Marked:
        """The sampled tops of some designs, of which ``start`` is the first; a period ends where it began."""
        grid, period = self.asked.places, self.asked.period
        if period is not None:
            grid = np.append(grid, grid[0] + period)
            turns = np.round((values[:, -1:] - values[:, :1]) / period) if _is_angle(extreme[0]) else 0.0
            values = np.concatenate([values, values[:, :1] + period * turns], axis=1)
        signs = _signs(extreme, values)
        found = tops(signs * (values - middle(extreme[0])))
        own = signs[found.curve, found.best]
        heights = own[:, None] * (values[found.curve[:, None], found.near] - middle(extreme[0]))
        return _Marked(Tops(found.curve + start, grid[found.near], heights), own)

    def _highest(self, extreme: Extreme, parts: Sequence[_Marked]) -> Array:
        """The true extreme of a signal of every design, (designs,)."""
        name, level = extreme[0], middle(extreme[0])
        found = Tops(*(np.concatenate(columns) for columns in zip(*(part.tops for part in parts), strict=True)))
        signs = np.concatenate([part.signs for part in parts])
        near = signs * np.max(found.heights, axis=1) + level

        def heights(top: Integers, phi: Array) -> Array:
            seen = self._seen(name, found.curve[top], phi, near[top])
            return np.asarray(signs[top, None] * (seen - level))

        top, sign = summits(found, signs, heights, len(self.rows))
        return np.asarray(sign * top + level)


def curve(at: MovingSweep, name: str) -> Array:
    """A signal, the magnitude of a vector, or the output's coordinate."""
    if name == OUTPUT:
        return at.sweep.output()
    if name.endswith(MAGNITUDE):
        vector = name.removesuffix(MAGNITUDE)
        return np.hypot(signal(at, f"{vector}:x"), signal(at, f"{vector}:y"))
    return signal(at, name)


def _is_angle(name: str) -> bool:
    return name == "phi" or (name.startswith("link:") and name.endswith(":angle"))


def middle(name: str) -> float:
    """What a peak is farthest from."""
    return 0.5 * np.pi if name.startswith("transmission_angle:") else 0.0


def _signs(extreme: Extreme, values: Array) -> Array:
    """What a signal is multiplied by so that its extreme is its highest value."""
    name, sense = extreme
    if sense is Reduction.PEAK:
        return np.where(values < middle(name), -1.0, 1.0)
    return np.full(values.shape, -1.0 if sense is Reduction.MIN else 1.0)


def _reduced(figure: Figure, values: Array, share: Array) -> Array:
    """A signal (designs, angles) brought down to a number for each design."""
    reductions: dict[Reduction, Callable[[], Any]] = {
        Reduction.PEAK: lambda: np.take_along_axis(
            values, np.argmax(np.abs(values - middle(figure.signal)), axis=1)[:, None], 1
        )[:, 0],
        Reduction.MEAN: lambda: np.sum(values * share, axis=1),
        Reduction.RMS: lambda: np.sqrt(np.sum(np.square(values) * share, axis=1)),
        Reduction.MAX: lambda: np.max(values, axis=1),
        Reduction.MIN: lambda: np.min(values, axis=1),
        Reduction.RANGE: lambda: np.max(values, axis=1) - np.min(values, axis=1),
    }
    return np.asarray(reductions[figure.reduction]())
