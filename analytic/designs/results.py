"""Figures of many designs at once: peaks, means and single values of any signal, without its curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.changes import design_numbers
from analytic.designs.figures import Figure, Reduction
from analytic.designs.sampled_figures import FigureRequest, is_settled, sampled_source
from analytic.designs.sampled_signals import LEAST_RATIO, checked_parameters, speed_of
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code import LinkageTrace, Result, StraightFunction, in_threads, is_worthwhile
from analytic.numerics.arrays import Array, Booleans
from analytic.operations import Traced
from analytic.signals import is_wrapped

# Figures of many designs reduced where they are computed, in one straight function of machine code, without curves.


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
    """Whether the figures are extremes and means of samples, which need no curve.

    They are not with ``refine``, at an angle, of a link's angle, or of a mean that samples may not give.
    """
    linkage = request.mechanism.linkage
    return not request.refine and not any(
        figure.reduction is Reduction.AT
        or is_wrapped(figure.signal, linkage)
        or (figure.is_mean and not request.may_sample(figure))
        for figure in request.figures
    )


class _DesignSums:
    """Sums and extremes of every design: ``results`` of the straight function, and their ``places`` in it by name."""

    def __init__(self, listed: LinkageTrace, request: FigureRequest) -> None:
        """List the sums and extremes over the angles from which the requested figures follow.

        ``listed`` is the list of operations of the request's signals.
        """
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
        """Request a reduction of a line of the list under this name, unless the name is known.

        ``reduction`` is its formula, in {value}, {so_far} and {next}, and its first value.
        """
        if name not in self.places:
            self.places[name] = len(self.results)
            self.results.append(Result(line, *reduction))

    def _add_mean(self, name: str, value: Any) -> None:  # noqa: ANN401 - a traced number
        """Request the sums from which a signal's mean and mean square follow, over all and over every second sample.

        ``name`` is the signal's.
        """
        trace = self.listed.trace
        for power, number in (("mean", value), ("square", value * value)):
            for share in (SHARE, HALF_SHARE):
                self._add(f"{name} {power} {share}", trace.line(number * trace.input(share)), SUM)

    def figure(self, quantity: Figure, values: Array) -> tuple[Array, Booleans]:
        """A figure of every design (n,) from results (results, n), and which of its means are doubtful (n,).

        Doubtful are those that every second sample gives otherwise.
        """

        def result_of(name: str) -> Array:
            """The results (n,) requested under this name; raises KeyError for another."""
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
    request: FigureRequest, arrays: Mapping[str, Array], listed: LinkageTrace
) -> tuple[Array, Booleans]:
    """The figures, (figures, designs), of designs that differ in ``arrays``, and which designs are doubtful (designs,).

    ``arrays`` are numbers (designs,), SI, by name, ``listed`` is the list of operations of the request's signals. A
    design is doubtful if the samples are too few for its means, or if it may stand in a dead position between two crank
    angles. Figures of a design that cannot move at one of the crank angles are nan. They are computed in threads on all
    cores. Raises ImportError where numba is missing.
    """
    gathered = _DesignSums(listed, request)
    given, of_rows = listed.split_inputs([result.line for result in gathered.results])
    function = StraightFunction(listed.trace, given, of_rows, gathered.results)
    rows = np.stack(_row_numbers(request, listed, of_rows), axis=1)
    arrays = {**arrays, **request.designs(arrays).zero_of_s}
    count = len(next(iter(arrays.values())))
    values, doubtful = np.full((len(request.figures), count), np.nan), np.zeros(count, dtype=bool)
    steep = [place for name, place in gathered.places.items() if name.startswith("steep")]

    def part(start: int) -> None:
        """Fill in figures and doubts of the chunk of designs that begins at number ``start``."""
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

    in_threads(part, range(0, count, CHUNK))
    return values, doubtful


def _row_numbers(request: FigureRequest, listed: LinkageTrace, lines: Sequence[int]) -> list[Array]:
    """For each of ``lines``, which depend on the crank alone, its values at the crank angles and the period's end.

    The shares of samples in means are among their inputs.
    """
    grid, count = request.grid, len(request.crank_angles)
    share = np.where(np.arange(len(grid)) < count, 1.0 / count, 0.0)
    shares = {SHARE: share, HALF_SHARE: 2.0 * share * (np.arange(len(grid)) % 2 == 0)}
    known = listed.values(shares, grid, request.speed)
    return [np.broadcast_to(values, grid.shape) for values in listed.trace.evaluate(lines, known)]


USUAL_LIST, OF_FIGURE = 200, 15  # operations of a six-bar's motion, and of each signal


def design_figures(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    figures: Sequence[Figure],
    angle: Array,
    *,
    speed: float,
    period: float | None,
    refine: bool = False,
    path: str = "auto",
) -> Array:
    """Figures of every design, (figures, designs), SI; the crank turns at a constant ``speed``, rad/s, signed.

    ``parameters`` are arrays (designs,) of numbers of the description, SI, by the names of
    ``analytic.description.changes``, and ``speed``, turned as ``speed``; all else is as described, and the assembly
    modes are those that its sketch picks. Without any it is one design, the file's. A signal is sampled at the crank
    angles ``angle`` (angles,), rad, ascending; S counts from the design's own largest output. With ``refine`` the
    extremes are the true ones between the samples, and S counts from the true top: over a ``period``, rad, which the
    angles divide evenly, its end left out, or over a range, whose ends count, if None. Means are integrals over the
    same, whatever the samples, and of S from the true top.

    The figures of a design that cannot be assembled, or stands in a dead position, at or between any of the angles are
    nan, and so are those of one that passes a change point where the linkage as described passes none. ``path`` is
    "numpy", "compiled" or "auto", which compiles where that saves time. Raises UnknownNameError for an unknown
    parameter or path, LinkproofError for parameters of other lengths or impossible values, and where numba is missing
    for "compiled".
    """
    if not parameters:  # of the file's own numbers one stands for all
        name, (_, value) = next(iter(design_numbers(mechanism.linkage).items()))
        parameters = {name: [value]}
    arrays = checked_parameters(mechanism.linkage, parameters, has_speed=True)
    request = FigureRequest(mechanism, tuple(figures), angle, speed, period, refine, path)
    designs = request.designs(arrays)
    if designs.trace is None or not can_reduce(request) or not designs.is_compiled:
        return request.values_for(arrays)
    reduced, doubtful = reduced_figures(request, arrays, designs.trace)
    if np.any(doubtful):
        some = {name: values[doubtful] for name, values in arrays.items()}
        # They are few: another function rarely pays.
        reduced[:, doubtful] = replace(request, path="auto").values_for(some)
    return reduced


def usual_path(figures: Sequence[Figure], size: int) -> str:
    """The path, "numpy" or "compiled", that "auto" chooses for a linkage of usual size.

    ``size`` is the number of designs times that of crank angles; of ``figures`` only the number counts. It is "numpy"
    where numba is missing.
    """
    return "compiled" if is_worthwhile("auto", USUAL_LIST + OF_FIGURE * len(figures), size) else "numpy"
