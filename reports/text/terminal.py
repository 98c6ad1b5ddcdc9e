"""Mechanisms, their thread and their published figures for a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table

from reports.text.numbers import degrees
from reports.text.screen import Cell, line, table
from reports.text.signs import PUBLISHED

if TYPE_CHECKING:
    from analytic.description.linkage import Linkage
    from analytic.turn.required_feed import FeedComparison
    from comparisons.reference.published import PublishedRecord


def catalogue(linkages: Iterable[Linkage]) -> Table:
    """Mechanisms with their variants and sources."""
    rows = [(one.name, one.title, ", ".join(one.variants), one.source) for one in linkages]
    return table(("mechanism", "what", "variants", "source"), rows)


def portrait(facts: Mapping[str, Any]) -> Group:
    """A mechanism's structure and figures."""
    bound = facts["error_bound"]
    lines = {
        "source": facts["source"],
        "variants": ", ".join(facts["variants"]),
        "structure": facts["structure"],
        "Jeq": _inertia(facts["Jeq"]),
        "output": _output(facts.get("output")),
        "rests at": _equilibria(facts.get("equilibria", [])),
        **_thread(facts.get("thread")),
        "closure": f"joints closed to {facts['closure_error']:.1e} m over the whole turn",
        "accuracy": f"closed form within {bound['position']:.0e} of peak, its first derivative within "
        f"{bound['first']:.0e}, its second within {bound['second']:.0e}",
    }
    return Group(
        line(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", "bold"),
        *_labelled(lines),
        line(""),
        table(("link", "mass kg", "inertia kg m²", "mean Jeq kg m²", "points"), list(_links(facts["links"]))),
        *(line(f"note: {note}") for note in facts["notes"]),
    )


def _labelled(facts: Mapping[str, str]) -> list[RenderableType]:
    """One line per fact, those without a text left out."""
    return [line(f"{name:<10} {text}") for name, text in facts.items() if text]


def _inertia(found: Mapping[str, float]) -> str:
    return (
        f"mean {found['mean']:.4g}, max {found['max']:.4g} at {degrees(found['max_at'])}, min {found['min']:.4g} at "
        f"{degrees(found['min_at'])} kg m²; pulsation {found['pulsation']:.2%}"
    )


def _output(found: Mapping[str, Any] | None) -> str:
    if found is None:
        return ""
    return (
        f"{found['point']}, stroke {found['stroke'] * 1e3:.4g} mm, top dead centre "
        f"{degrees(found['top_dead_centre'])}, bottom {degrees(found['bottom_dead_centre'])}"
    )


def _equilibria(found: Sequence[Mapping[str, Any]]) -> str:
    return ", ".join(f"{degrees(e['angle'], 2)} ({'stable' if e['stable'] else 'unstable'})" for e in found)


def _links(links: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[str, ...]]:
    for name, link in links.items():
        inertia = "-" if link["inertia"] is None else f"{link['inertia']:.4g}"
        yield name, f"{link['mass']:.4g}", inertia, f"{link['Jeq_mean']:.4g}", ", ".join(link["points"])


def _thread(thread: Mapping[str, Any] | None) -> dict[str, str]:
    if thread is None:
        return {}
    contour, feed = thread["contour"], thread["feed"]
    eyes = [
        f"{eye} highest at {degrees(at['top'], 2)}, lowest at {degrees(at['bottom'], 2)}"
        for eye, at in thread["eyes"].items()
    ]
    return {
        "thread": f"contour {contour['min'] * 1e3:.2f} to {contour['max'] * 1e3:.2f} mm, feed "
        f"{feed['min'] * 1e3:.2f} to {feed['max'] * 1e3:.2f} mm, {feed['total'] * 1e3:.2f} mm a turn",
        "eyes": "; ".join(eyes),
    }


def thread(facts: Mapping[str, Any], held: FeedComparison | None) -> Group:
    """Contour, feed and eyes of a thread, and how far its feed is from a required one."""
    return Group(*_labelled(_thread(facts)), *(_feed(held) if held else []))


def _feed(comparison: FeedComparison) -> list[RenderableType]:
    """Required beside actual feed, and the largest difference."""
    columns = (comparison.angle, comparison.required, comparison.actual, comparison.difference)
    rows = [
        (f"{math.degrees(angle):.1f}", *(f"{value * 1e3:.3f}" for value in values))
        for angle, *values in zip(*columns, strict=True)
    ]
    worst = int(np.argmax(np.abs(comparison.difference)))
    root_mean_square = float(np.sqrt(np.mean(comparison.difference**2)))
    closing = (
        f"largest difference {comparison.difference[worst] * 1e3:+.3f} mm at "
        f"{math.degrees(comparison.angle[worst]):.1f}°, RMS {root_mean_square * 1e3:.3f} mm"
    )
    return [table(("φ °", "required mm", "actual mm", "difference mm"), rows, "lr"), line(closing)]


def published(records: Sequence[PublishedRecord]) -> Group:
    """Printed figures beside ours, a table per mechanism with a column per variant."""
    blocks: list[RenderableType] = []
    for mechanism, part in groupby(records, key=lambda record: record.mechanism):
        together = list(part)
        noted = dict.fromkeys(
            f"{r.quantity} {r.published:.4g} {r.unit}".rstrip() + f": {r.note}" for r in together if r.note
        )
        blocks += [line(mechanism, "bold"), _published_table(together), *map(line, noted), line("")]
    signs = "; ".join(f"{sign.symbol} {sign.word}" for sign in PUBLISHED.values())
    return Group(*blocks, line(f"{signs} (reproduced: to the printed digits)"))


def _published_table(records: Sequence[PublishedRecord]) -> Table:
    variants = list(dict.fromkeys(record.variant for record in records))
    rows: list[list[Cell]] = []
    for quantity, unit, value, source in dict.fromkeys((r.quantity, r.unit, r.published, r.source) for r in records):
        ours = {r.variant: r for r in records if (r.quantity, r.published, r.source) == (quantity, value, source)}
        cells = [_ours(ours[variant]) if variant in ours else "" for variant in variants]
        rows.append([quantity, f"{value:.4g} {unit}".strip(), *cells, source])
    return table(("quantity", "printed", *variants, "place"), rows)


def _ours(record: PublishedRecord) -> Cell:
    sign = PUBLISHED[record.verdict]
    return f"{record.ours:.4g} {sign.symbol} {record.deviation:+.1%}", sign.colour
