"""Tables for a terminal; each stands alone at 100 columns."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from analytic.description.linkage import Linkage
from analytic.turn.required_feed import FeedComparison
from comparisons.campaign.campaign import RunResult
from comparisons.judging.quantities import JOINT_FORCE
from comparisons.judging.records import Record, Verdict
from comparisons.reference.published import PublishedRecord
from reports.text.signs import PUBLISHED, RUNS

ACROSS = 4  # runs side by side in a table of 80 columns


def catalogue(linkages: Iterable[Linkage]) -> Table:
    """Mechanisms with their variants and sources."""
    table = Table("mechanism", "what", "variants", "source", box=None, pad_edge=False)
    for linkage in linkages:
        table.add_row(linkage.name, linkage.title, ", ".join(linkage.variants), linkage.source)
    return table


def portrait(facts: Mapping[str, Any]) -> Group:
    """A mechanism's structure and figures."""
    inertia = facts["Jeq"]
    lines = [
        Text(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", style="bold"),
        Text(f"source     {facts['source']}"),
        Text(f"variants   {', '.join(facts['variants'])}"),
        Text(f"structure  {facts['structure']}"),
        Text(f"Jeq        mean {inertia['mean']:.4g}, max {inertia['max']:.4g} at {inertia['max_at']:.1f}°, "
             f"min {inertia['min']:.4g} at {inertia['min_at']:.1f}° kg m²; pulsation {inertia['pulsation']:.2%}"),
    ]  # fmt: skip
    if "output" in facts:
        out = facts["output"]
        lines.append(
            Text(
                f"output     {out['point']}, stroke {out['stroke'] * 1e3:.4g} mm, top dead centre "
                f"{out['top_dead_centre']:.4g}°, bottom {out['bottom_dead_centre']:.4g}°"
            )
        )
    lines += [Text(line) for line in (*_equilibrium_lines(facts), *thread_lines(facts.get("thread")))]
    bound = facts["error_bound"]
    lines += [
        Text(f"closure    joints closed to {facts['closure_error']:.1e} m over the whole turn"),
        Text(
            f"accuracy   closed form within {bound['position']:.0e} of peak, its first derivative within "
            f"{bound['first']:.0e}, its second within {bound['second']:.0e}"
        ),
    ]
    table = Table("link", "mass kg", "inertia kg m²", "mean Jeq kg m²", "points", box=None, pad_edge=False)
    for name, link in facts["links"].items():
        inertia_text = "-" if link["inertia"] is None else f"{link['inertia']:.4g}"
        table.add_row(name, f"{link['mass']:.4g}", inertia_text, f"{link['Jeq_mean']:.4g}", ", ".join(link["points"]))
    notes = [Text(f"note: {note}") for note in facts["notes"]]
    return Group(*lines, Text(""), table, *notes)


def _equilibrium_lines(facts: Mapping[str, Any]) -> list[str]:
    found = [f"{e['angle']:.2f}° ({'stable' if e['stable'] else 'unstable'})" for e in facts.get("equilibria", [])]
    return [f"rests at   {', '.join(found)}"] if found else []


def thread_lines(thread: Mapping[str, Any] | None) -> list[str]:
    """Contour, feed and eyes of a thread in words; nothing without one."""
    if thread is None:
        return []
    contour, feed = thread["contour"], thread["feed"]
    eyes = [f"{eye} highest at {at['top']:.2f}°, lowest at {at['bottom']:.2f}°" for eye, at in thread["eyes"].items()]
    return [
        f"thread     contour {contour['min'] * 1e3:.2f} to {contour['max'] * 1e3:.2f} mm, feed "
        f"{feed['min'] * 1e3:.2f} to {feed['max'] * 1e3:.2f} mm, {feed['total'] * 1e3:.2f} mm a turn",
        f"eyes       {'; '.join(eyes)}",
    ]


def feed_table(comparison: FeedComparison) -> Group:
    """Required against actual feed, and the worst of it."""
    table = Table("φ °", "required mm", "actual mm", "difference mm", box=None, pad_edge=False)
    rows = zip(comparison.angle, comparison.required, comparison.actual, comparison.difference, strict=True)
    for angle, required, actual, difference in rows:
        table.add_row(f"{math.degrees(angle):.1f}", *(f"{value * 1e3:.3f}" for value in (required, actual, difference)))
    for column in table.columns:
        column.justify = "right"
    worst = int(np.argmax(np.abs(comparison.difference)))
    root_mean_square = float(np.sqrt(np.mean(comparison.difference**2)))
    line = (
        f"largest difference {comparison.difference[worst] * 1e3:+.3f} mm at "
        f"{math.degrees(comparison.angle[worst]):.1f}°, RMS {root_mean_square * 1e3:.3f} mm"
    )
    return Group(table, Text(line))


def published(records: Sequence[PublishedRecord]) -> Group:
    """Printed figures beside ours, a table per mechanism with a column per variant."""
    blocks: list[RenderableType] = []
    for mechanism, part in groupby(records, key=lambda record: record.mechanism):
        together = list(part)
        noted = dict.fromkeys(f"{r.quantity} {r.published:.4g} {r.unit}: {r.note}" for r in together if r.note)
        blocks += [Text(mechanism, style="bold"), _published_table(together), *map(Text, noted), Text("")]
    signs = "; ".join(f"{sign.symbol} {sign.word}" for sign in PUBLISHED.values())
    return Group(*blocks, Text(f"{signs} (reproduced: to the printed digits)"))


def _published_table(records: Sequence[PublishedRecord]) -> Table:
    variants = list(dict.fromkeys(record.variant for record in records))
    table = Table("quantity", "printed", *variants, "place", box=None, pad_edge=False)
    figures = list(dict.fromkeys((r.quantity, r.unit, r.published, r.source) for r in records))
    for quantity, unit, value, source in figures:
        ours = {r.variant: r for r in records if (r.quantity, r.published, r.source) == (quantity, value, source)}
        cells = [_ours(ours[variant]) if variant in ours else Text("") for variant in variants]
        table.add_row(quantity, f"{value:.4g} {unit}".strip(), *cells, source)
    return table


def _ours(record: PublishedRecord) -> Text:
    sign = PUBLISHED[record.verdict]
    return Text(f"{record.ours:.4g} {sign.symbol}\n{record.deviation:+.1%}", style=sign.colour)


def campaign(results: Sequence[RunResult]) -> Group:
    """One table per mechanism and regime, quantities down, engines and settings across, and a closing line."""
    blocks: list[RenderableType] = []
    kept = [result for result in results if result.records]
    for _, part in groupby(kept, key=lambda result: result.records[0].run[:3]):
        together = list(part)
        blocks.append(_heading(together[0].records[0]))
        for start in range(0, len(together), ACROSS):
            blocks += [_mechanism_table(together[start : start + ACROSS]), Text("")]
    return Group(*blocks, *_reasons(results), _closing_line(results))


def _heading(record: Record) -> Text:
    return Text(f"{record.mechanism} ({record.variant}), {record.regime}: {record.conditions}", style="bold")


def _mechanism_table(results: Sequence[RunResult]) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column("error over peak")
    table.add_column("limit", justify="right")
    for result in results:
        record = result.records[0]
        table.add_column(f"{record.engine}\n{record.setting}", justify="right")
    rows = list(dict.fromkeys(_row(r) for result in results for r in (*result.records, *result.invariants)))
    for quantity in rows:
        found = [_worst(result, quantity) for result in results]
        table.add_row(quantity, _limits(found), *[_cell(record) for record in found])
    table.add_row("seconds, stepping", "", *[f"{r.records[0].seconds:.3f}" for r in results])
    table.add_row("steps", "", *[f"{r.records[0].steps}" for r in results])
    return table


def _row(record: Record) -> str:
    """The row a record stands in: forces of all joints share one."""
    return JOINT_FORCE.rstrip(":") if record.quantity.startswith(JOINT_FORCE) else record.quantity


def _worst(result: RunResult, row: str) -> Record | None:
    """The record of a run that stands in a row; of several the one nearest to or farthest over its limit."""
    found = [record for record in (*result.records, *result.invariants) if _row(record) == row]
    return max(found, key=lambda record: record.error_max or 0.0, default=None)


def _limits(records: Sequence[Record | None]) -> str:
    limits = sorted({r.limit for r in records if r is not None and r.limit is not None}, reverse=True)
    return ", ".join(f"{limit:.0e}" for limit in limits)


def _cell(record: Record | None) -> Text:
    if record is None:
        return Text("")
    sign = RUNS[record.outcome]
    words = sign.word if record.error_max is None else f"{record.error_max:.1e} {sign.symbol}"
    return Text(words, style=sign.colour)


def _reasons(results: Sequence[RunResult]) -> list[Text]:
    """Why runs gave nothing, and which records the baseline rather than the limit caught; each once."""
    told: dict[str, None] = {}
    for result in results:
        for record in (*result.records, *result.invariants):
            past_baseline = (
                record.error_max is not None and record.limit is not None and record.error_max <= record.limit
            )
            if record.detail and (record.error_max is None or past_baseline):
                told[f"{record.engine} {record.setting}, {record.mechanism}: {record.detail}"] = None
    return [Text(line) for line in told]


def _closing_line(results: Sequence[RunResult]) -> Text:
    records = [record for result in results for record in (*result.records, *result.invariants)]
    counts = {verdict: sum(r.outcome == verdict.value for r in records) for verdict in Verdict}
    left_out = sum(record.left_out for record in records)
    words = [f"{count} {verdict.value}" for verdict, count in counts.items() if count and verdict.judged]
    unjudged = [f"{count} {verdict.value}" for verdict, count in counts.items() if count and not verdict.judged]
    note = f"; {left_out} samples at acceleration jumps or near standstill left out" if left_out else ""
    judged = sum(count for verdict, count in counts.items() if verdict.judged)
    words += [f"{len(records) - judged} not judged ({', '.join(unjudged)})"] if unjudged else []
    return Text(f"{judged} deviations: {', '.join(words)}{note}")
