"""The summary in Markdown: verdicts and errors alone, so that two machines' summaries of one version diff cleanly.

Same rows, same order, same digits; no date, machine or time. Those stand on the page.
"""

from __future__ import annotations

from comparisons.campaign.results import Results
from reports.document.numbers import ROUND_OFF, bound, figure, per_cent, printed, steady_error
from reports.document.tables import ReportTable
from reports.document.tables import markdown as table
from reports.document.templates import plain, worded
from reports.facts.printed_models import judgements
from reports.facts.readings import Readings, readings
from reports.records import matrix
from reports.records.joint_rows import joint_table
from reports.records.matrix import EngineStanding, MatrixBlock, MatrixRow
from reports.records.views import columns, views


def markdown(results: Results) -> str:
    """The summary of a campaign."""
    told = results.document.get("judgement", [])
    parts = [
        "# Results of another tool against the closed form" if told else "# Engines against the closed form",
        f"Largest error over the reference's peak, two digits, round-off as < {bound(ROUND_OFF)}; ✓ within its limit, "
        f"✗ over it. Written by `{results.document['command']}`; the page beside it has curves, machine and times.",
        "## Verdict",
        *told,
        "\n".join(f"- {_standing(one)}" for one in matrix.standings(results)),
        *_matrix(results),
        *_joint_forces(results),
        *_printed_models(results),
        *_published(results),
        "## Limits",
        table(matrix.limit_table(results)),
    ]
    return "\n\n".join(parts) + "\n"


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


def _matrix(results: Results) -> list[str]:
    names = tuple(name for part in columns(results) for name in part)
    parts = ["## Errors"]
    for block in matrix.blocks(results):
        parts += [
            f"### {block.mechanism} ({block.variant}), {block.regime}",
            f"{block.conditions}.",
            _block(block, names),
        ]
    return parts


def _block(block: MatrixBlock, names: tuple[str, ...]) -> str:
    head = ("engine", "setting", "figures of", *map(plain, names))
    return table(ReportTable("", head, tuple(_row(row, len(names)) for row in block.rows), align="l"))


def _row(row: MatrixRow, count: int) -> tuple[str, ...]:
    if row.failure:
        return (row.engine, row.setting, "", row.failure, *[""] * (count - 1))
    cells = (f"{cell.sign} {steady_error(cell.error)}" if cell else "–" for cell in row.cells)
    return (row.engine, row.setting, row.origin, *cells)


def _joint_forces(results: Results) -> list[str]:
    """Peak force of every joint and the error of every run, regime by regime."""
    parts = [
        f"### {view.linkage.name} ({view.linkage.variant}), {regime.name}\n\n{table(found)}"
        for view in views(results)
        for regime in view.regimes
        if (found := joint_table(view, regime))
    ]
    return ["## Joint forces", *parts] if parts else []


def _printed_models(results: Results) -> list[str]:
    """What the engines say of models as printed."""
    lines = [f"- {row['sentence']}" for view in views(results) for row in judgements(view)]
    return ["## Printed models", "\n".join(lines)] if lines else []


def _published(results: Results) -> list[str]:
    tables = readings(results)
    parts = ["## Published figures against ours"] if tables else []
    for name, found in tables.items():
        parts += [f"### {name}", table(_readings(found))]
    return parts


def _readings(found: Readings) -> ReportTable:
    rows = []
    for row in found.rows:
        ours = (f"{figure(one.ours)} ({per_cent(one.deviation)}, {one.verdict})" if one else "–" for one in row.ours)
        unit = f", {row.unit}" if row.unit else ""
        place = row.source + (f"; {row.note}" if row.note else "")
        rows.append((worded(row.quantity) + unit, printed(row.published), *ours, place))
    return ReportTable("", ("figure", "published", *found.variants, "place"), tuple(rows), align="l")
