"""The display of a stress test: signs of verdicts, values of axes, borders, errors beside their limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from comparisons.judging.records import QuantityRecord
from comparisons.stress.axes import axes
from comparisons.stress.border import Border
from comparisons.stress.cell_result import StressVerdict
from comparisons.stress.saved import Stress
from reports.document.numbers import ABSENT, bound, error, printed
from reports.document.signs import TABLES

# An outcome that says nothing of how far an engine goes.
APART = (StressVerdict.UNSUPPORTED, StressVerdict.UNAVAILABLE, StressVerdict.SUITE_ERROR)
SILENT = (StressVerdict.CAUGHT, StressVerdict.MISSED)


class StressSign(NamedTuple):
    """The sign of a verdict, from ``signs.toml``, and its meaning."""

    symbol: str
    fill: str
    ink: str
    meaning: str
    terminal: str = ""


SIGNS: Mapping[StressVerdict, StressSign] = {
    StressVerdict(verdict): StressSign(*row) for verdict, row in TABLES["stress"].items()
}


def axis_title(name: str) -> str:
    """An axis in words."""
    return axes()[name].title


def value_words(value: float | None) -> str:
    """A value of an axis to three digits: 1e-6, 0.0123, 200, 1e4."""
    if value is None:
        return ABSENT
    plain, short = printed(float(f"{value:.3g}")), bound(value)
    return short if len(short) + 1 < len(plain) and float(short) == float(plain) else plain


def border_words(border: Border) -> str:
    """``0.001, over limit at 7.2e-4``."""
    return f"{value_words(border.inside)}, {border.verdict.value} at {value_words(border.outside)}"


def against(record: QuantityRecord | None, name: Callable[[str], str] = str) -> str:
    """An error and its limit, both over the peak, with the name of its quantity; empty without a record."""
    return "" if record is None else f"{name(record.quantity)} {error(record.error_max)}, limit {bound(record.limit)}"


def shown_verdicts(stress: Stress) -> tuple[StressVerdict, ...]:
    """The verdicts with a column: all that occur, and always "missed"."""
    count = stress.count()
    return tuple(verdict for verdict in StressVerdict if count[verdict] or verdict in SILENT)
