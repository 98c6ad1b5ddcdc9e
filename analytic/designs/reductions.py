"""Figures of many designs reduced where they are computed, in one straight function of machine code, without curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.designs.figures import Figure, Reduction
from analytic.designs.sampled_figures import FigureRequest, is_settled, sampled_source
from analytic.designs.sampled_signals import LEAST_RATIO, speed_of
from analytic.machine_code.compiling import Result, StraightFunction, in_threads
from analytic.machine_code.tracing import LinkageTrace, Traced
from analytic.signals import is_wrapped

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]

CHUNK: Final = 2048  # designs a thread takes at a time
# Shares of the samples in a mean over all of them, and over every second: the end of the period has none.
SHARE, HALF_SHARE = "share of a sample", "share of every second sample"

HIGHEST: Final = ("{value} if {value} > {so_far} else {so_far}", -np.inf)
LOWEST: Final = ("{value} if {value} < {so_far} else {so_far}", np.inf)
SUM: Final = ("{so_far} + {value}", 0.0)
ALL: Final = ("{so_far} if {value} else 0.0", 1.0)
# Of a magnitude, which the next result has of the row before: nothing is less than nan, the first one's.
STEEP: Final = (
    f"1.0 if ({{value}} < {LEAST_RATIO} * {{next}}) | ({{next}} < {LEAST_RATIO} * {{value}}) else {{so_far}}",
    0.0,
)
LAST: Final = ("{value}", np.nan)


def can_reduce(request: FigureRequest) -> bool:
    """Whether the figures are peaks and means of samples, which need no curve."""
    linkage = request.mechanism.linkage
    return not request.refine and not any(
        figure.reduction is Reduction.AT
        or is_wrapped(figure.signal, linkage)
        or (figure.is_mean and not request.may_sample(figure))
        for figure in request.figures
    )


class _DesignSums:
    """Sums and extremes of every design: results of the straight function by name."""

    def __init__(self, listed: LinkageTrace, request: FigureRequest) -> None:
        self.listed = listed
        self.results: list[Result] = []
        self.places: dict[str, int] = {}
        lines = dict(zip(request.signals, listed.signals, strict=True))
        for quantity in request.figures:
            name = sampled_source(quantity.signal)
            if quantity.is_mean:
                self._add_mean(name, Traced(listed.trace, lines[name]))
            else:
                self._add(f"{name} highest", lines[name], HIGHEST)
                self._add(f"{name} lowest", lines[name], LOWEST)
        self._add("moves", listed.moves, ALL)
        for number, line in enumerate(listed.determinants):
            self._add(f"steep {number}", line, STEEP)
            self._add(f"last {number}", line, LAST)

    def _add(self, name: str, line: int, reduction: tuple[str, float]) -> None:
        if name not in self.places:
            self.places[name] = len(self.results)
            self.results.append(Result(line, *reduction))

    def _add_mean(self, name: str, value: Any) -> None:  # noqa: ANN401 - a traced number
        """Add the sums from which a signal's mean and mean square follow, over all and over every second sample."""
        trace = self.listed.trace
        for power, number in (("mean", value), ("square", value * value)):
            for share in (SHARE, HALF_SHARE):
                self._add(f"{name} {power} {share}", trace.line(number * trace.input(share)), SUM)

    def figure(self, quantity: Figure, values: Array) -> tuple[Array, Booleans]:
        """A figure of every design from results (results, n), and which of its means are doubtful."""

        def result_of(name: str) -> Array:
            return np.asarray(values[self.places[name]])

        name = sampled_source(quantity.signal)
        if quantity.is_mean:
            power = "square" if quantity.reduction is Reduction.RMS else "mean"
            whole, half = (quantity.of_mean(result_of(f"{name} {power} {share}")) for share in (SHARE, HALF_SHARE))
            return whole, ~is_settled(whole, half, np.sqrt(result_of(f"{name} square {SHARE}")))
        high, low = result_of(f"{name} highest"), result_of(f"{name} lowest")
        if quantity.signal == "S":  # counts from the highest
            high, low = high - low, np.zeros(low.shape)
        ends = {Reduction.PEAK: (np.maximum(np.abs(high), np.abs(low)),), Reduction.RANGE: (high, low)}
        ends |= {Reduction.MAX: (high,), Reduction.MIN: (low,)}
        return quantity.of(ends[quantity.reduction]), np.zeros(high.shape, dtype=bool)


def reduced_figures(
    request: FigureRequest, arrays: Mapping[str, Array], listed: LinkageTrace, cores: int | None
) -> tuple[Array, Booleans]:
    """The figures, (figures, designs), of designs that differ in ``arrays`` (designs,), and which are doubtful.

    A design is doubtful if the samples are too few for its means, or if it may stand in a dead position between two
    crank angles. Figures of a design that cannot move at one of the crank angles are nan.
    """
    gathered = _DesignSums(listed, request)
    given, of_rows = listed.split_inputs([result.line for result in gathered.results])
    function = StraightFunction(listed.trace, given, of_rows, gathered.results)
    rows = np.stack(_row_numbers(request, listed, of_rows), axis=1)
    count = len(next(iter(arrays.values())))
    values, doubtful = np.full((len(request.figures), count), np.nan), np.zeros(count, dtype=bool)
    steep = [place for name, place in gathered.places.items() if name.startswith("steep")]

    def part(start: int) -> None:
        here = slice(start, min(start + CHUNK, count))
        chunk = {name: numbers[here] for name, numbers in arrays.items()}
        lanes = listed.trace.evaluate(given, listed.values(chunk, speed=speed_of(chunk, request.speed)))
        reduced = function(lanes, rows, here.stop - start)
        doubtful[here] = reduced[steep].any(axis=0)
        moves = reduced[gathered.places["moves"]] > 0.0
        for row, quantity in enumerate(request.figures):
            figure, unsettled = gathered.figure(quantity, reduced)
            values[row, here] = np.where(moves, figure, np.nan)
            doubtful[here] |= unsettled
        doubtful[here] &= moves

    in_threads(part, range(0, count, CHUNK), cores)
    return values, doubtful


def _row_numbers(request: FigureRequest, listed: LinkageTrace, lines: Sequence[int]) -> list[Array]:
    """Values at the crank angles and at the end of the period, (rows,), of the lines that depend on the crank alone."""
    grid, count = request.grid, len(request.crank_angles)
    share = np.where(np.arange(len(grid)) < count, 1.0 / count, 0.0)
    shares = {SHARE: share, HALF_SHARE: 2.0 * share * (np.arange(len(grid)) % 2 == 0)}
    known = listed.values(shares, grid, request.speed)
    return [np.broadcast_to(values, grid.shape) for values in listed.trace.evaluate(lines, known)]
