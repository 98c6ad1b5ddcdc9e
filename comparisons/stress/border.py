"""Where a map's verdict leaves ``within limit``: from the easy value outwards, then by bisection between two runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from comparisons.stress.axes import axes, nearest
from comparisons.stress.cells import Cell, CellResult
from comparisons.stress.verdict import StressVerdict

PRECISE: Final = 1.1  # ratio of the two values that bracket a border
COARSE: Final = 3.0
# A value of zero bounds a logarithm at this share of the smallest other one: a border beyond is none to be told from 0.
NEXT_TO_ZERO: Final = 1e-3
SMALLEST: Final = 1e-15  # what is bracketed between this and zero is left there
# Where the easiest value itself is not within limit there is no border; where nothing fails there is none either.
GOOD: Final = (StressVerdict.WITHIN,)
# Where these begin is a property of the machine, and every run that looks for it costs all that a cell may.
BOUNDED: Final = (StressVerdict.TIMED_OUT, StressVerdict.CRASHED)


@dataclass(frozen=True)
class Border:
    """Between ``inside``, within limit, and ``outside``, which is not."""

    inside: CellResult
    outside: CellResult

    @property
    def ratio(self) -> float:
        """By what factor the two values differ; infinite next to zero."""
        low, high = sorted((self.inside.cell.value, self.outside.cell.value))
        return high / low if low > 0.0 else math.inf

    @property
    def middle(self) -> float:
        """The value between the two, halfway by ratio, to the digits that a cell's name has."""
        low, high = sorted((self.inside.cell.value, self.outside.cell.value))
        return float(f"{math.sqrt((low if low > 0.0 else NEXT_TO_ZERO * high) * high):.6g}")

    def narrowed(self, result: CellResult) -> Border:
        """The half of it that has the border, by a run between its ends."""
        return replace(self, inside=result) if result.verdict in GOOD else replace(self, outside=result)

    @property
    def document(self) -> dict[str, Any]:
        """The border as JSON-ready data."""
        axis, row, engine, usage = self.inside.cell.line
        return {
            "axis": axis,
            "row": row,
            "engine": engine,
            "usage": usage,
            "value": self.middle,
            "inside": self.inside.cell.value,
            "outside": self.outside.cell.value,
            "verdict": self.outside.verdict.value,
            "inside_command": self.inside.document["command"],
            "outside_command": self.outside.document["command"],
        }


def borders(results: Iterable[CellResult]) -> list[Border]:
    """On every line of every map, the first run beyond the easy value on either side that is not within limit."""
    ordered = sorted(results, key=lambda result: (*result.cell.line, result.cell.value))
    lines = itertools.groupby(ordered, key=lambda result: result.cell.line)
    return [border for _, line in lines for border in _on(list(line))]


def _on(line: Sequence[CellResult]) -> Iterator[Border]:
    start = nearest([result.cell.value for result in line], axes()[line[0].cell.axis].good)
    for way in (line[start:], line[start::-1]):
        for inside, outside in itertools.pairwise(way):
            if inside.verdict not in GOOD:
                break
            if outside.verdict not in GOOD:
                yield Border(inside, outside)
                break


def bisected(
    rough: Sequence[Border], make: Callable[[Sequence[Cell]], Sequence[CellResult]], precision: float = PRECISE
) -> list[Border]:
    """The same borders between runs that differ by no more than ``precision``; ``make`` makes many cells at once."""
    narrow = list(rough)
    while wide := [number for number, border in enumerate(narrow) if _is_wide(border, precision)]:
        middles = [replace(narrow[number].inside.cell, value=narrow[number].middle) for number in wide]
        for number, result in zip(wide, make(middles), strict=True):
            narrow[number] = narrow[number].narrowed(result)
    return narrow


def _is_wide(border: Border, precision: float) -> bool:
    """Whether halving it once more is worth a run: what lies next to zero is not followed for ever."""
    low, high = sorted((border.inside.cell.value, border.outside.cell.value))
    worth = axes()[border.inside.cell.axis].narrow and border.outside.verdict not in BOUNDED
    return worth and border.ratio > precision and (low > 0.0 or high > SMALLEST)
