"""The summary in Markdown: verdicts and errors alone, so that two machines' summaries of one version diff cleanly.

Same rows, same order, same digits; no date, machine or time. Those stand on the first page.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from comparisons.campaign.results import Results
from comparisons.datasheet.sheet import Sheet
from reports.campaign.index import families_table
from reports.campaign.verdict import EngineRanking, verdict
from reports.document.markdown import written
from reports.document.numbers import ROUND_OFF, bound
from reports.document.parts import Bullets, Mono, Paragraph, Part, Section
from reports.mechanism.engines import errors_fold
from reports.mechanism.published import published_section
from reports.records import matrix
from reports.records.differences import changed_figures
from reports.records.views import views


def markdown(results: Results, sheets: Sequence[Sheet] = ()) -> str:
    """The summary of a campaign; ``sheets`` have the figures that the mechanisms' sources print."""
    facts = results.document.get("judgement", [])
    trust = EngineRanking(results)
    title = "Results of another tool against the closed form" if facts else "Engines against the closed form"
    words = (
        f"Largest error over the reference's peak, two digits, round-off as < {bound(ROUND_OFF)}. Written by ",
        Mono(results.document["command"]),
        "; the pages beside it have curves, machine and times.",
    )
    lines = facts or verdict(trust, timed=False)
    parts: tuple[Part, ...] = (
        Paragraph(words),
        Section("", "Verdict", (*map(Paragraph, lines), families_table(trust))),
        *_section("Errors", _errors(results)),
        *_section("Key figures", changed_figures(results.figures)),
        *_section("Printed models", _printed_models(results)),
        *_section("Published figures against ours", _published(sheets)),
        Section("", "Limits", (matrix.limit_table(results),)),
    )
    return f"# {title}\n\n{written(parts)}\n"


def _section(heading: str, parts: Iterable[Part]) -> tuple[Section, ...]:
    entries = tuple(parts)
    return (Section("", heading, entries),) if entries else ()


def _errors(results: Results) -> Iterator[Section]:
    for view in views(results):
        for regime in view.regimes:
            title = f"{view.linkage.name} ({view.linkage.variant}), {regime.name}"
            yield Section("", title, errors_fold(view, regime).parts)


def _printed_models(results: Results) -> Iterator[Bullets]:
    """The engines' verdicts on printed models, in the order of the mechanisms."""
    every = results.document.get("errata", [])
    names = dict.fromkeys(linkage.name for linkage in results.linkages if linkage.variant == linkage.variants[0])
    lines = tuple(row["sentence"] for name in names for row in every if row["mechanism"] == name)
    if lines:
        yield Bullets(lines)


def _published(sheets: Sequence[Sheet]) -> Iterator[Section]:
    for name, rows in {sheet.name: sheet.published for sheet in sheets}.items():
        if rows:
            yield Section("", name, published_section(rows).parts)
