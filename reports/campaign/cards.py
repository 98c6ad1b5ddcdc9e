"""A card of a mechanism: its scheme, the figures it is chosen by, and the engine that came nearest to a limit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from comparisons.datasheet.sheet import Sheet
from reports.campaign.verdict import EngineRanking, ratio, share
from reports.charts.moving import moving_scheme
from reports.document.parts import Card, Drawn, Facts, PageLink, Part
from reports.mechanism.page import file_of
from reports.mechanism.shown import key_figures
from reports.records.views import family_title

SIZE: Final = (156, 112)  # of a scheme, points
FRAMES: Final = 60
FIGURES: Final = ("peak torque", "peak force", "peak power", "mean Jeq", "stroke")


def card(sheet: Sheet, trust: EngineRanking | None) -> Card:
    """The card of a mechanism, which leads to its page; without a campaign it tells of no engine."""
    linkage = sheet.linkage
    words = linkage.title + (f", {sheet.variant}" if len(linkage.variants) > 1 else "")
    engine = _engine(sheet, trust) if trust is not None else ""
    rows = (*_key_figures(sheet), *((("worst error", engine),) if engine else ()))
    return Card(PageLink(words, file_of(sheet)), (*_scheme(sheet), Facts(rows)))


def _scheme(sheet: Sheet) -> Iterator[Part]:
    if sheet.positions is not None:
        markup = moving_scheme(
            sheet.linkage, sheet.positions, f"card {sheet.name} {sheet.variant}", size=SIZE, frames=FRAMES
        )
        yield Drawn(markup, f"Moving scheme of {sheet.linkage.title}.")


def _key_figures(sheet: Sheet) -> tuple[tuple[str, str], ...]:
    return tuple((what, value) for what, value, _ in key_figures(sheet) if what in FIGURES)


def _engine(sheet: Sheet, trust: EngineRanking) -> str:
    """The worst engine of a mechanism at the deciding setting, in words."""
    setting = trust.settings[0]
    records = [
        record
        for engine in trust.engines
        for record in trust.records(engine, setting)
        if record.run[:2] == (sheet.name, sheet.variant) and record.error_max is not None and record.limit
    ]
    worst = max(records, key=share, default=None)
    return "" if worst is None else f"{ratio(worst)} of its limit: {worst.engine}, {family_title(worst.quantity)}"
