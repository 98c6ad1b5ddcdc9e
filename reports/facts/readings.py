"""Published figures beside ours, one column per variant (reading) of a mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from analytic.description.linkage import Linkage
from analytic.description.loading import parse
from comparisons.campaign.results import Results
from comparisons.reference.published import PublishedRecord, compare_published
from reports.document.signs import PUBLISHED


@dataclass(frozen=True)
class Reading:
    """A printed figure and what every variant gives for it; None where it belongs to another variant."""

    quantity: str
    unit: str
    published: float
    source: str
    note: str
    ours: tuple[PublishedRecord | None, ...]


@dataclass(frozen=True)
class Readings:
    """All printed figures of one mechanism."""

    mechanism: str
    variants: tuple[str, ...]
    rows: tuple[Reading, ...]


def readings(results: Results) -> dict[str, Readings]:
    """The printed figures of every mechanism of a campaign, by its name, in the order of its file."""
    names = dict.fromkeys(linkage.name for linkage in results.linkages)
    return {name: found for name in names if (found := readings_of(results, name))}


def readings_of(results: Results, name: str) -> Readings | None:
    """The printed figures of one mechanism; None where its source prints none."""
    first = next(linkage for linkage in results.linkages if linkage.name == name)
    text = next(entry["text"] for entry in results.document["descriptions"] if entry["name"] == name)
    return _table([parse(text, name, name, variant) for variant in first.variants]) if first.published else None


def _table(linkages: list[Linkage]) -> Readings:
    variants = tuple(linkage.variant for linkage in linkages)
    records = compare_published(linkages)
    keys = dict.fromkeys((r.quantity, r.unit, r.published, r.source, r.note) for r in records)
    rows = []
    for key in keys:
        mine = {r.variant: r for r in records if (r.quantity, r.unit, r.published, r.source, r.note) == key}
        rows.append(Reading(*key, tuple(mine.get(variant) for variant in variants)))
    return Readings(linkages[0].name, variants, tuple(rows))


def met(table: Readings) -> tuple[tuple[str, int, int, int], ...]:
    """Per variant: figures reproduced, figures near, figures compared."""
    counts = []
    for number, variant in enumerate(table.variants):
        verdicts = [row.ours[number].verdict for row in table.rows if row.ours[number] is not None]  # type: ignore[union-attr]
        signs = [PUBLISHED[verdict].style for verdict in verdicts]
        counts.append((variant, signs.count("pass"), signs.count("near"), len(signs)))
    return tuple(counts)
