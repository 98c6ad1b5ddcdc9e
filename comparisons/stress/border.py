"""Borders of a map's ``within limit``: searched from the easy value outwards, then bisect_borders between two runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

from comparisons.stress.cell_result import Cell, CellResult, StressVerdict
from comparisons.stress.cells import axes, nearest

PRECISE: Final = 1.1  # ratio of the two values that bracket a border
COARSE: Final = 3.0
# A value of zero bounds a logarithm at this share of the smallest other one: a border below it is the same as 0.
NEXT_TO_ZERO: Final = 1e-3
SMALLEST: Final = 1e-15  # a border between this and zero is not narrowed down
# There is no border where the easiest value is not within limit, or where nothing fails.
GOOD: Final = (StressVerdict.WITHIN,)
# Where these begin is a property of the machine, and every run that looks for it costs all that a cell may.
BOUNDED: Final = (StressVerdict.TIMED_OUT, StressVerdict.CRASHED)


@dataclass(frozen=True)
class Border:
    """A border on a line of a map: the last value ``inside`` the limit, the first ``outside``, the verdict there."""

    axis: str
    row: str
    engine: str
    usage: str
    inside: float
    outside: float
    verdict: StressVerdict

    @property
    def line(self) -> tuple[str, str, str, str]:
        """Axis, row, engine and usage of the cells on both sides of the border."""
        return (self.axis, self.row, self.engine, self.usage)

    @property
    def ratio(self) -> float:
        """By what factor the two values differ; infinite next to zero."""
        low, high = sorted((self.inside, self.outside))
        return high / low if low > 0.0 else math.inf

    @property
    def middle(self) -> float:
        """The value between the two, halfway by ratio, to the digits that a cell's name has."""
        low, high = sorted((self.inside, self.outside))
        return float(f"{math.sqrt((low if low > 0.0 else NEXT_TO_ZERO * high) * high):.6g}")

    def cell(self, value: float) -> Cell:
        """The cell of the border's line at a value of its axis."""
        return Cell(self.axis, self.row, value, self.engine, self.usage)

    def narrowed(self, result: CellResult) -> Border:
        """The border between closer values, after a run at a value between its two."""
        if result.verdict in GOOD:
            return replace(self, inside=result.cell.value)
        return replace(self, outside=result.cell.value, verdict=result.verdict)

    @property
    def document(self) -> dict[str, Any]:
        """The border as JSON-ready data."""
        commands = {f"{end}_command": self.cell(getattr(self, end)).command for end in ("inside", "outside")}
        return {**asdict(self), "value": self.middle, **commands}


def borders(results: Iterable[CellResult]) -> list[Border]:
    """On every line of every map, the first run beyond the easy value on either side that is not within limit."""
    ordered = sorted(results, key=lambda result: (*result.cell.line, result.cell.value))
    lines = itertools.groupby(ordered, key=lambda result: result.cell.line)
    return [border for _, line in lines for border in _line_borders(list(line))]


def _line_borders(line: Sequence[CellResult]) -> Iterator[Border]:
    """The first border on either side of a line's easy value."""
    start = nearest([result.cell.value for result in line], axes()[line[0].cell.axis].good)
    for side in (line[start:], line[start::-1]):
        for inside, outside in itertools.pairwise(side):
            if inside.verdict not in GOOD:
                break
            if outside.verdict not in GOOD:
                yield Border(*inside.cell.line, inside.cell.value, outside.cell.value, outside.verdict)
                break


def bisect_borders(
    rough: Sequence[Border], make: Callable[[Sequence[Cell]], Sequence[CellResult]], precision: float = PRECISE
) -> list[Border]:
    """Borders narrowed until the values of each differ by a factor ``precision`` at most; ``make`` runs many cells."""
    narrow = list(rough)
    while wide := [number for number, border in enumerate(narrow) if _is_wide(border, precision)]:
        middles = [narrow[number].cell(narrow[number].middle) for number in wide]
        for number, result in zip(wide, make(middles), strict=True):
            narrow[number] = narrow[number].narrowed(result)
    return narrow


def _is_wide(border: Border, precision: float) -> bool:
    """Whether to halve it once more; a border next to zero is not followed for ever."""
    low, high = sorted((border.inside, border.outside))
    worth = axes()[border.axis].narrow and border.verdict not in BOUNDED
    return worth and border.ratio > precision and (low > 0.0 or high > SMALLEST)
