"""Key figures of the closed form that are not as recorded, in a table."""

from __future__ import annotations

from collections.abc import Sequence

from analytic.written import change
from comparisons.campaign.key_figures import KeyFigure
from reports.document.numbers import ABSENT
from reports.document.parts import Table

CAPTION = "Key figures of the closed form, SI, that are not as recorded in the baseline."
HEAD = ("mechanism", "regime", "figure", "recorded", "now", "change")


def changed_figures(figures: Sequence[KeyFigure]) -> tuple[Table, ...]:
    """A row for every key figure that has changed; no table where none has."""
    rows = tuple(_row(figure) for figure in figures if figure.changed)
    return (Table(CAPTION, HEAD, rows, align="lllr"),) if rows else ()


def _row(figure: KeyFigure) -> tuple[str, ...]:
    place = f"{figure.mechanism} ({figure.variant})"
    share = ABSENT if figure.share is None else change(figure.share, ".2g")
    return (place, figure.regime, figure.figure, _number(figure.recorded), _number(figure.now), share)


def _number(value: float | None) -> str:
    return ABSENT if value is None else f"{value:.9g}"
