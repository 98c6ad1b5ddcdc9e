"""The page of one mechanism: what its designer wants, then how the engines did."""

from __future__ import annotations

import re
from collections.abc import Iterator

from comparisons.campaign.results import Results
from comparisons.datasheet.sheet import Sheet
from reports.charts.moving import moving_scheme
from reports.document.parts import Bullets, Card, Cards, Drawn, Page, Paragraph, Part, Section
from reports.document.templates import sentence
from reports.live.widget import live, model_of
from reports.mechanism import designer
from reports.mechanism.engines import engines_section
from reports.mechanism.player import player
from reports.mechanism.published import published_section
from reports.mechanism.shown import key_table
from reports.mechanism.special_sections import released_section, thread_section
from reports.records.views import views

FOLDER = "mechanisms"


def file_of(sheet: Sheet) -> str:
    """Where the page is within a report's folder; signs that would need quoting in an address are dashes."""
    name, variant = (re.sub(r"[^\w+-]+", "-", word) for word in (sheet.name, sheet.variant))
    return f"{FOLDER}/{name}.{variant}.html"


def page(sheet: Sheet, results: Results | None = None) -> Page:
    """The page; ``results`` are those of the campaign that its engines ran in, or of a file that was judged."""
    linkage = sheet.linkage
    of = f" (of {', '.join(linkage.variants)})" if len(linkage.variants) > 1 else ""
    source = f" Source: {linkage.source}." if linkage.source else ""
    return Page(
        file=file_of(sheet),
        title=f"{sheet.name} ({sheet.variant})" if len(linkage.variants) > 1 else sheet.name,
        heading=linkage.title or sheet.name,
        subtitle=f"{sheet.name}, variant {sheet.variant}{of}.{source}",
        parts=(*_verdict(results), *_first_look(sheet)),
        sections=tuple(_sections(sheet, results)),
        charts=results is not None,
    )


def _verdict(results: Results | None) -> tuple[Part, ...]:
    """The verdict on a judged file and its causes."""
    words = results.document.get("judgement", []) if results else []
    return (Paragraph(words[0], "verdict"), Bullets(tuple(words[1:]))) if words else ()


def _first_look(sheet: Sheet) -> Iterator[Part]:
    """The linkage in motion beside its key figures; where it can be computed anew, to pull at."""
    if sheet.positions is None:
        yield Cards((Card("The mechanism", (*designer.sentences(sheet, "values"), designer.facts(sheet))),), wide=True)
        return
    drawing, model = moving_scheme(sheet.linkage, sheet.positions, "moving"), model_of(sheet)
    if not isinstance(model, str):
        yield live(sheet, model, (key_table(sheet), Drawn(drawing, "")))
        yield Cards((Card("The mechanism as in its file", (designer.facts(sheet),)),), wide=True)
        return
    fixed = Paragraph(sentence("not_live", reason=model), "small")
    motion = Card("In motion", (player(sheet, sheet.positions, drawing), fixed))
    yield Cards((motion, Card("Key figures", (key_table(sheet), designer.facts(sheet)))), wide=True)


def _sections(sheet: Sheet, results: Results | None) -> Iterator[Section]:
    """The designer's, then the engines'; of a file that was judged its errors first."""
    mine = sheet.name, sheet.variant
    ran = [view for view in views(results) if (view.linkage.name, view.linkage.variant) == mine] if results else []
    engines = [engines_section(view, sheet.printed) for view in ran[:1]]
    is_judged = results is not None and "judgement" in results.document
    yield from engines if is_judged else ()
    yield from designer.sections(sheet)
    if sheet.thread and sheet.positions:
        yield thread_section(sheet, sheet.thread, sheet.positions)
    if sheet.released:
        yield released_section(sheet)
    if sheet.published:
        yield published_section(sheet.published)
    yield from () if is_judged else engines
