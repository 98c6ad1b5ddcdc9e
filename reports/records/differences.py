"""Key figures that have changed, in a table."""

from __future__ import annotations

from collections.abc import Sequence

from analytic.written import change
from comparisons.campaign.key_figures import KeyFigure
from reports.document.numbers import ABSENT
from reports.document.parts import Table

CHANGED = "Key figures of the closed form, SI, that are not as recorded in the baseline."
CHANGED_HEAD = ("mechanism", "regime", "figure", "recorded", "now", "unit", "change")


def changed_figures(figures: Sequence[KeyFigure]) -> tuple[Table, ...]:
    """A table with a row for every key figure that has changed; no table without changes."""
    rows = tuple(_changed_row(figure) for figure in figures if figure.changed)
    return (Table(CHANGED, CHANGED_HEAD, rows, align="lllrrlr"),) if rows else ()


def _changed_row(figure: KeyFigure) -> tuple[str, ...]:
    """The row of a changed key figure: its place, both values, unit and relative change."""
    place = f"{figure.mechanism} ({figure.variant})"
    share = ABSENT if figure.share is None else change(figure.share, ".2g")
    recorded, now = (ABSENT if value is None else f"{value:.9g}" for value in (figure.recorded, figure.now))
    return (place, figure.regime, figure.figure, recorded, now, figure.unit, share)
