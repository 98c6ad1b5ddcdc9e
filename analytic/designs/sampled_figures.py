"""Figures of designs from sweeps of many at once: signals sampled at the same crank angles, and reduced."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.designs.figures import SQUARE, Figure, Reduction, SignalExtreme
from analytic.designs.sampled_signals import (
    BLOCK,
    Designs,
    Integers,
    Sampler,
    are_steep,
    designs_stuck,
    divided_steps,
    with_neighbours,
)
from analytic.dynamics.reduced import load_corners
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.arrays import Array, Booleans
from analytic.numerics.averages import SAME, averages
from analytic.numerics.refine import Tops, highest_tops, tops
from analytic.signals import OUTPUT_COORDINATE, is_angle

Curves = Mapping[str, Array]

CELLS: Final = 12  # of the motion, from which a mean is integrated
CHUNK: Final = 2048  # designs a thread takes at a time: their tops are refined together
TOP: Final = Figure(OUTPUT_COORDINATE, Reduction.MAX)
# Between two crank angles a dyad's determinant changes by no more than this share of itself, or the step is divided in
# PARTS, LEVELS times at most: forces go as its inverse.
CHANGE, PARTS, LEVELS = 0.2, 8, 5
TOGETHER: Final = 64  # designs whose means are integrated in one go


@dataclass(frozen=True)
class FigureRequest:
    """Figures of every design at ``crank_angles`` (angles,), ascending, of a driver that moves at a steady ``speed``.

    The angles are in rad, the speed in rad/s, signed. Extremes are true ones with ``refine``; over a ``period``, rad,
    curves close, else their ends count. Means are integrals from the first place to the end of the period, or to the
    last place. ``path`` is "numpy", "compiled" or "auto".
    """

    mechanism: Mechanism
    figures: tuple[Figure, ...]
    crank_angles: Array
    speed: float
    period: float | None
    refine: bool
    path: str = "auto"

    @property
    def grid(self) -> Array:
        """The crank angles, rad, with the end of the period added; unchanged without a period."""
        return (
            self.crank_angles
            if self.period is None
            else np.append(self.crank_angles, self.crank_angles[0] + self.period)
        )

    @property
    def signals(self) -> tuple[str, ...]:
        """Sampled signals, each once; the output's coordinate in place of S."""
        return tuple(dict.fromkeys(sampled_source(figure.signal) for figure in self.figures))

    def designs(self, arrays: Mapping[str, Array]) -> Designs:
        """The designs whose numbers, SI, by name, are the arrays (designs,)."""
        poses = len(next(iter(arrays.values()))) * len(self.crank_angles)
        return Designs(self.mechanism, arrays, self.signals, self.speed, path=self.path, poses=poses)

    def may_sample(self, figure: Figure) -> bool:
        """Whether a mean may come from samples: their even number divides a period evenly, and the signal allows it.

        Angles of links do not, nor does S with ``refine``.
        """
        has_zero_at_sample = is_angle(figure.signal) or (figure.signal == "S" and not self.refine)
        return self.period is not None and len(self.crank_angles) % 2 == 0 and not has_zero_at_sample

    def values_for(self, arrays: Mapping[str, Array]) -> Array:
        """The figures, (figures, designs), of designs that differ in ``arrays`` (designs,) of numbers, SI, by name.

        They are nan where a design cannot be assembled or moved at or between the crank angles; numbers are not
        checked.
        """
        values = np.full((len(self.figures), len(next(iter(arrays.values())))), np.nan)

        def work(rows: Integers, sampler: Sampler) -> None:
            """Fill in the figures of the designs numbered ``rows``."""
            values[:, rows] = _Chunk(self, sampler, rows).figures(self.figures)

        self.designs(arrays).in_blocks(CHUNK, work)
        return values


def sampled_source(name: str) -> str:
    """The signal that is sampled for a signal: the output's coordinate for S, else the signal itself."""
    return OUTPUT_COORDINATE if name == "S" else name


class _Marked(NamedTuple):
    """Sampled tops of a signal's height, and the sign at each (n,), 1 or -1, that makes the signal this height."""

    tops: Tops
    sides: Array


MarkedExtremes = dict[SignalExtreme, list[_Marked]]


class _Chunk:
    """Designs whose tops are searched together; their samples are discarded block by block.

    Designs are numbered within the chunk, ``here``, while ``rows`` has their numbers among all. ``faulty`` are those
    that cannot move, ``doubtful`` those that may pass a dead position between two crank angles; S counts from
    ``farthest``, m.
    """

    def __init__(self, request: FigureRequest, sampler: Sampler, rows: Integers) -> None:
        """Prepare the designs numbered ``rows``, whose signals the ``sampler`` computes."""
        self.request, self.sampler, self.rows = request, sampler, rows
        self.faulty, self.doubtful = np.zeros((2, len(rows)), dtype=bool)
        self.farthest = np.zeros(len(rows))
        self.known: dict[SignalExtreme, Array] = {}  # the highest samples

    def figures(self, figures: Sequence[Figure]) -> Array:
        """The figures, (figures, rows), of the chunk's designs; nan where a design cannot be assembled or moved.

        That is at or between the crank angles.
        """
        if self.request.refine and any(figure.signal == "S" for figure in figures):
            self.farthest = self._highest_output()
        result = self._figures_of_samples(figures)
        means = {row: figure for row, figure in enumerate(figures) if figure.is_mean}
        if means:
            self._integrate(means, result)
        doubtful = np.flatnonzero(self.doubtful & ~self.faulty)
        self.faulty[doubtful] = designs_stuck(self.sampler, self.rows[doubtful], self.request.grid)
        result[:, self.faulty] = np.nan
        return result

    def _figures_of_samples(self, figures: Sequence[Figure]) -> Array:
        """Extremes, values at angles and means of the samples, (figures, rows); means that are not settled are nan.

        Extremes are refined between the samples if the request asks for it.
        """
        result = np.full((len(figures), len(self.rows)), np.nan)
        extremes: MarkedExtremes = (
            {end: [] for quantity in figures for end in quantity.extremes} if self.request.refine else {}
        )
        crank_angles = self.request.crank_angles
        size = max(1, BLOCK // len(crank_angles))
        for start in range(0, len(self.rows), size):
            here = np.arange(start, min(start + size, len(self.rows)))
            phi = np.broadcast_to(crank_angles, (len(here), len(crank_angles)))
            sampled, coarse = self._sampled(here, phi, dict.fromkeys(quantity.signal for quantity in figures))
            for row, figure in enumerate(figures):
                if figure.reduction is Reduction.AT:
                    result[row, here] = sampled[figure.signal][:, np.argmin(np.abs(crank_angles - figure.angle))]
                elif figure.is_mean:
                    result[row, here] = self._mean(figure, sampled[figure.signal])
                elif not extremes:
                    result[row, here] = _reduce_samples(figure, sampled[figure.signal])
            if extremes:
                grid, sampled = self._with_period_end(sampled, len(here))
                self._enter_tops(extremes, sampled, here, grid)
                self._enter_corners(extremes, here)
                self._refine_coarse_steps(extremes, here, grid, coarse)
        heights = {extreme: self._true_extreme(extreme, parts) for extreme, parts in extremes.items()}
        every = np.arange(len(self.rows))
        for row, figure in enumerate(figures):
            if figure.reduction is Reduction.AT:
                angle = np.full((len(every), 1), figure.angle)
                result[row] = self._signal_at(figure.signal, every, angle, result[row])[:, 0]
            elif extremes and figure.extremes:
                result[row] = figure.of([heights[end] for end in figure.extremes])
        return result

    def _highest_output(self) -> Array:
        """The output's highest coordinate of each design, m, (rows,), between the samples too."""
        return np.asarray(
            _Chunk(replace(self.request, refine=True), self.sampler, self.rows)._figures_of_samples([TOP])[0]
        )

    def _mean(self, figure: Figure, values: Array) -> Array:
        """A mean (designs,) of samples (designs, angles); nan where they are too few for it."""
        if not self.request.may_sample(figure):
            return np.full(len(values), np.nan)
        whole, half = (figure.of_mean(np.mean(figure.integrand(part), axis=1)) for part in (values, values[:, ::2]))
        size = np.sqrt(np.mean(np.square(values), axis=1))
        return np.asarray(np.where(is_settled(whole, half, size), whole, np.nan))

    def _integrate(self, figures: Mapping[int, Figure], result: Array) -> None:
        """Replace doubtful means in ``result``, whose rows are the keys of ``figures``, by adaptive integrals.

        Doubtful are means that are nan, and those of designs in which a step may hide a spike beside a dead position.
        The reciprocals of the dyads' determinants are integrated with the signals, for such a spike to be closed in on.
        """
        few = np.isnan(result[[*figures]]).any(axis=0) | self.doubtful
        left, names = np.flatnonzero(few & ~self.faulty), {quantity.signal for quantity in figures.values()}
        if len(left) and "S" in names and not self.request.refine:
            self.farthest = self._highest_output()
        crank_angles, mechanism = self.request.crank_angles, self.request.mechanism
        for start in range(0, len(left), TOGETHER):
            here = left[start : start + TOGETHER]
            grid = np.broadcast_to(crank_angles, (len(here), len(crank_angles)))
            near = {name: curve for name, curve in self._curves(here, grid, names)[0].items() if is_angle(name)}

            def integrands(design: Integers, phi: Array, here: Integers = here, near: Curves = near) -> Array:
                """The integrands (k, n, m) of all figures at φ (n, m), rad, then the determinants' reciprocals.

                Row i of φ is of design ``design[i]``, by number among ``here``.
                """
                curves, determinants = self._curves(here[design], phi, names)
                for name, values in near.items():
                    curves[name] = unwrapped_near(curves[name], phi, crank_angles, values[design])
                return np.stack(
                    [
                        *(quantity.integrand(curves[quantity.signal]) for quantity in figures.values()),
                        *np.divide(1.0, determinants),
                    ]
                )

            for (row, figure), mean in zip(
                figures.items(), averages(integrands, mean_cells(self.request.grid, mechanism), len(here)), strict=False
            ):
                result[row, here] = figure.of_mean(mean)

    def _sampled(self, here: Integers, phi: Array, names: Iterable[str]) -> tuple[dict[str, Array], Booleans]:
        """Signals of the designs ``here``, by name, at crank angles (designs, angles), rad; and coarse steps.

        Steps (designs, angles - 1) are True where a determinant changes too much, and beside these. Marks designs in
        ``doubtful`` that may pass a dead position between; of the output's coordinate alone nothing is marked. Without
        ``refine`` sets where S counts from.
        """
        names = list(names)
        if "S" in names and not self.request.refine:
            self.farthest[here] = np.max(self._curves(here, phi, [OUTPUT_COORDINATE])[0][OUTPUT_COORDINATE], axis=1)
        curves, determinants = self._curves(here, phi, names)
        if names == [OUTPUT_COORDINATE]:
            return curves, np.zeros((phi.shape[0], phi.shape[1] - 1), dtype=bool)
        self.doubtful[here[are_steep(determinants).any(axis=1)]] = True
        change = np.abs(np.diff(determinants, axis=2))
        coarse = np.any(change > CHANGE * np.minimum(determinants[..., 1:], determinants[..., :-1]), axis=0)
        return curves, with_neighbours(coarse)

    def _with_period_end(self, sampled: dict[str, Array], count: int) -> tuple[Array, dict[str, Array]]:
        """Crank angles (count, angles), rad, and signals with the end of the period, as at first.

        Unchanged without one. Angles of links have whole turns added. ``sampled`` itself is changed.
        """
        grid, period = self.request.grid, self.request.period
        if period is not None:
            for name, values in sampled.items():
                turns = np.round((values[:, -1:] - values[:, :1]) / FULL_TURN) if is_angle(name) else 0.0
                sampled[name] = np.concatenate([values, values[:, :1] + FULL_TURN * turns], axis=1)
        return np.broadcast_to(grid, (count, len(grid))), sampled

    def _enter_corners(self, extremes: MarkedExtremes, here: Integers) -> None:
        """Enter in ``extremes`` the corners of loads over φ as tops between the crank angles on either side.

        Angles of links have none.
        """
        grid = self.request.grid
        corners = load_corners(self.request.mechanism, float(grid[0]), float(grid[-1]))
        step = np.searchsorted(grid, corners)
        around = np.stack([grid[step - 1], corners, grid[step]], axis=1)[corners < grid[step]]
        extremes = {extreme: parts for extreme, parts in extremes.items() if not is_angle(extreme.signal)}
        for phi in around if extremes else ():
            every = np.broadcast_to(phi, (len(here), len(phi)))
            sampled, _ = self._sampled(here, every, dict.fromkeys(extreme.signal for extreme in extremes))
            self._enter_tops(extremes, sampled, here, every)

    def _refine_coarse_steps(self, extremes: MarkedExtremes, here: Integers, phi: Array, coarse: Booleans) -> None:
        """Divide the marked steps of crank angle, up to LEVELS times, sample there and enter the tops in ``extremes``.

        ``phi`` (designs, angles) are crank angles, rad, of the designs ``here``, ``coarse`` marks the steps between.
        Angles of links are left out: only forces grow steeply next to a dead position.
        """
        extremes = {extreme: parts for extreme, parts in extremes.items() if not is_angle(extreme.signal)}
        names = dict.fromkeys(extreme.signal for extreme in extremes)
        if coarse.shape[1] < phi.shape[1] - 1:  # the step that ends the period is like those beside it
            coarse = np.concatenate([coarse, coarse[:, :1] | coarse[:, -1:]], axis=1)
        for _ in range(LEVELS if names else 0):
            row, step = np.nonzero(coarse & ~self.faulty[here, None])
            if not len(row):
                return
            here, phi = here[row], divided_steps(phi, row, step, PARTS)
            coarse = np.zeros((len(row), PARTS), dtype=bool)
            for start in range(0, len(row), BLOCK // PARTS):
                some = slice(start, start + BLOCK // PARTS)
                sampled, coarse[some] = self._sampled(here[some], phi[some], names)
                self._enter_tops(extremes, sampled, here[some], phi[some])

    def _curves(self, here: Integers, phi: Array, names: Iterable[str]) -> tuple[dict[str, Array], Array]:
        """Signals of the designs ``here`` at crank angles (designs, angles), rad, by name, and the dyads' determinants.

        These are (dyads, designs, angles). Marks in ``faulty`` designs that cannot move there, unless only the output's
        coordinate is asked for.
        """
        sources = {name: sampled_source(name) for name in names}
        samples = self.sampler(self.rows[here], phi, tuple(dict.fromkeys(sources.values())))
        if list(sources) != [OUTPUT_COORDINATE]:
            self.faulty[here[~samples.moves.all(axis=1)]] = True
        curves = {name: samples.signals[source] for name, source in sources.items()}
        if "S" in curves:
            curves["S"] = self.farthest[here, None] - curves["S"]
        return curves, samples.determinants

    def _signal_at(self, name: str, designs: Integers, phi: Array, near: Array) -> Array:
        """A signal (n, m) of designs (n,), each at its own crank angles (n, m), rad.

        Links' angles are on the branch of the values ``near`` (n,). Marks in ``faulty`` as ``_curves`` does.
        """
        values: Array = np.empty(phi.shape)
        size = max(1, BLOCK // phi.shape[1])
        for start in range(0, len(designs), size):
            here = slice(start, start + size)
            values[here] = self._curves(designs[here], phi[here], [name])[0][name]
        if is_angle(name):
            values += FULL_TURN * np.round((near[:, None] - values) / FULL_TURN)
        return values

    def _enter_tops(self, extremes: MarkedExtremes, sampled: Mapping[str, Array], here: Integers, phi: Array) -> None:
        """Put those sampled tops of the designs ``here`` into ``extremes`` that may exceed the largest so far.

        ``sampled`` are signals by name at crank angles ``phi`` (designs, angles), rad; ``known`` keeps the largest.
        """
        for extreme, parts in extremes.items():
            values = sampled[extreme.signal]
            all_heights = extreme.height(values)
            known = self.known.setdefault(extreme, np.full(len(self.rows), -np.inf))
            top = tops(all_heights, known[here])
            np.maximum.at(known, here, np.max(all_heights, axis=1))
            side = extreme.side(values[top.curve, top.best])
            heights = extreme.height(values[top.curve[:, None], top.near], side[:, None])
            parts.append(_Marked(Tops(here[top.curve], phi[top.curve[:, None], top.near], heights), side))

    def _true_extreme(self, extreme: SignalExtreme, parts: Sequence[_Marked]) -> Array:
        """The extreme of a signal of every design, refined between the samples, (designs,).

        ``parts`` are the tops entered for it.
        """
        result = Tops(*(np.concatenate(columns) for columns in zip(*(part.tops for part in parts), strict=True)))
        sides = np.concatenate([part.sides for part in parts])
        near = extreme.value(np.max(result.heights, axis=1), sides)

        def heights(top: Integers, phi: Array) -> Array:
            """Heights of the extreme's signal at ``phi`` (n, m), rad, on the curves of the tops numbered (n,)."""
            seen = self._signal_at(extreme.signal, result.curve[top], phi, near[top])
            return extreme.height(seen, sides[top, None])

        highest = extreme.value(*highest_tops(result, sides, heights, len(self.rows)))
        return np.where(extreme.is_kink(highest), SQUARE, highest)


def _reduce_samples(figure: Figure, values: Array) -> Array:
    """Reduce samples (designs, angles) of a signal to the figure of each design, (designs,)."""
    best = (np.argmax(end.height(values), axis=1)[:, None] for end in figure.extremes)
    return figure.of([np.take_along_axis(values, place, 1)[:, 0] for place in best])


def is_settled(whole: Array, half: Array, size: Array) -> Booleans:
    """Where means of evenly spaced samples are exact: every second sample gives the same within a tolerance.

    ``whole`` and ``half`` are the means of all and of every second one. The tolerance is a share of the signal's RMS,
    its ``size``; the error for smooth signals is the gap squared.
    """
    return np.abs(whole - half) <= SAME * size


def mean_cells(grid: Array, mechanism: Mechanism) -> Array:
    """The ends, rad, ascending, of the cells from which means over a grid's whole length are integrated.

    There are CELLS equal ones, cut at loads' corners.
    """
    return np.union1d(np.linspace(grid[0], grid[-1], CELLS + 1), load_corners(mechanism, grid[0], grid[-1]))


def unwrapped_near(values: Array, phi: Array, places: Array, samples: Array | None) -> Array:
    """Values at ``phi`` (..., n), rad, with the whole turns that ``samples`` at ``places`` show.

    ``places``, rad, ascend; samples are of one curve (places,) or of one for each row of ``phi``. Without ``samples``,
    for signals that are no angles of links, the values are unchanged.
    """
    if samples is None:
        return values
    here = np.searchsorted(places, phi, "right") - 1
    known = samples[here] if samples.ndim == 1 else np.take_along_axis(samples, here, 1)
    return np.asarray(values + FULL_TURN * np.round((known - values) / FULL_TURN))
