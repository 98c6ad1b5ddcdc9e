"""The summary in Markdown: verdicts and errors alone, so that two machines' summaries of one version diff cleanly.

Same rows, same order, same digits; no date, machine or time. Those stand on the first page.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from comparisons.campaign.results import Results
from comparisons.datasheet.sheet import Sheet
from reports.document.markdown import written
from reports.document.numbers import ABSENT, ROUND_OFF, bound, figure, per_cent, printed, steady_error
from reports.document.parts import Bullets, Mono, Paragraph, Part, Section, Table
from reports.document.templates import plain, worded
from reports.records import matrix
from reports.records.joint_rows import joint_table
from reports.records.matrix import EngineStanding
from reports.records.views import views


def markdown(results: Results, sheets: Sequence[Sheet] = ()) -> str:
    """The summary of a campaign; ``sheets`` have the figures that the mechanisms' sources print."""
    told = results.document.get("judgement", [])
    title = "Results of another tool against the closed form" if told else "Engines against the closed form"
    words = (
        f"Largest error over the reference's peak, two digits, round-off as < {bound(ROUND_OFF)}; ✓ within its limit, "
        "✗ over it. Written by ",
        Mono(results.document["command"]),
        "; the pages beside it have curves, machine and times.",
    )
    standings = Bullets(tuple(map(_standing, matrix.standings(results))))
    parts: tuple[Part, ...] = (
        Paragraph(words),
        Section("", "Verdict", (*map(Paragraph, told), standings)),
        Section("", "Errors", tuple(_matrix(results))),
        *_sections("Joint forces", tuple(_joint_forces(results))),
        *_printed_models(results),
        *_sections("Published figures against ours", tuple(_published(sheets))),
        Section("", "Limits", (matrix.limit_table(results),)),
    )
    return f"# {title}\n\n{written(parts)}\n"


def _sections(heading: str, sections: tuple[Section, ...]) -> tuple[Section, ...]:
    return (Section("", heading, sections),) if sections else ()


def _standing(one: EngineStanding) -> str:
    origin = f" ({one.origin})" if one.origin else ""
    count = f"{one.passed} of {one.total} within limits" if one.total else "nothing judged"
    words = f"{one.engine} {one.setting}{origin}: {count}"
    words += f", {one.computed} computed by the adapter and not judged" if one.computed else ""
    if one.nearest is not None:
        place = "furthest over its limit" if one.share > 1.0 else "closest to its limit"
        largest = f"{steady_error(one.nearest.error_max)} against {bound(one.nearest.limit)}"
        words += f"; {place}: {plain(one.nearest.quantity)} of {one.nearest.mechanism}, {largest}"
    return ". ".join((words, *one.failures)) + "."


def _matrix(results: Results) -> Iterator[Section]:
    for heading, conditions, table in matrix.blocks(results):
        yield Section("", heading, (Paragraph(f"{conditions}."), table))


def _joint_forces(results: Results) -> Iterator[Section]:
    """Peak force of every joint and the error of every run, regime by regime."""
    for view in views(results):
        for regime in view.regimes:
            if found := joint_table(view, regime):
                yield Section("", f"{view.linkage.name} ({view.linkage.variant}), {regime.name}", (found,))


def _printed_models(results: Results) -> tuple[Section, ...]:
    """What the engines say of models as printed, in the order of the mechanisms."""
    every = results.document.get("errata", [])
    names = dict.fromkeys(one.name for one in results.linkages if one.variant == one.variants[0])
    lines = tuple(row["sentence"] for name in names for row in every if row["mechanism"] == name)
    return (Section("", "Printed models", (Bullets(lines),)),) if lines else ()


def _published(sheets: Sequence[Sheet]) -> Iterator[Section]:
    for name, rows in {sheet.name: sheet.published for sheet in sheets}.items():
        if rows:
            yield Section("", name, (_readings(rows),))


def _readings(rows: Sequence[Mapping[str, Any]]) -> Table:
    """A row for every printed figure, a column for every variant."""
    variants = tuple(dict.fromkeys(row["variant"] for row in rows))
    found: dict[tuple[Any, ...], dict[str, str]] = {}
    for row in rows:
        key = tuple(row[name] for name in ("quantity", "unit", "published", "source", "note"))
        ours = f"{figure(row['ours'])} ({per_cent(row['deviation'])}, {row['verdict']})"
        found.setdefault(key, {})[row["variant"]] = ours
    lines = (
        (
            worded(quantity) + (f", {unit}" if unit else ""),
            printed(value),
            *(ours.get(variant, ABSENT) for variant in variants),
            source + (f"; {note}" if note else ""),
        )
        for (quantity, unit, value, source, note), ours in found.items()
    )
    return Table("", ("figure", "published", *variants, "place"), tuple(lines), align="l")
