"""The summary in Markdown: the same rows in the same order with the same digits, so that two of them diff cleanly.

What changes from run to run although no result did (date, machine, times) stands in one section at the end.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress

from analytic.errors import LinkproofError
from comparisons.campaign.results import Results
from reports.campaign.extra_sections import Beside
from reports.facts import forces, matrix, thread
from reports.facts.forces import TurnForces
from reports.facts.joint_rows import joint_rows
from reports.facts.matrix import Block, Row
from reports.facts.printed_models import judgements
from reports.facts.readings import Readings, readings, worded
from reports.facts.released import released, sentences
from reports.facts.views import View, columns, views
from reports.text.numbers import ROUND_OFF, bound, figure, per_cent, printed, seconds, steady_error


def markdown(results: Results, others: Sequence[Beside] = ()) -> str:
    """The summary of a campaign; ``others`` are sections on what else was measured."""
    parts = [
        "# Engines against the closed form",
        f"Largest error over the reference's peak, two digits, round-off as < {bound(ROUND_OFF)}; ✓ within its limit, "
        "✗ over it. Written by "
        f"`{results.document['command']}`; the page beside it has the curves.",
        *_matrix(results),
        *_models(results),
        *_published(results),
        *(other.markdown.rstrip() for other in others),
        *_limits(results),
        *_environment(results),
    ]
    return "\n\n".join(parts) + "\n"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; bars inside a cell are escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _matrix(results: Results) -> list[str]:
    names = [name for part in columns(results) for name in part]
    parts = ["## Deviations"]
    for block in matrix.blocks(results):
        parts += [
            f"### {block.mechanism} ({block.variant}), {block.regime}",
            f"{block.conditions}.",
            _block(block, names),
        ]
    return parts


def _block(block: Block, names: Sequence[str]) -> str:
    head = ["engine", "setting", *(name.replace("_", " ") for name in names)]
    return table(head, [_row(row, len(names)) for row in block.rows])


def _row(row: Row, count: int) -> list[str]:
    if row.failure:
        return [row.engine, row.setting, row.failure, *[""] * (count - 1)]
    return [
        row.engine,
        row.setting,
        *(f"{cell.sign} {steady_error(cell.error)}" if cell else "–" for cell in row.cells),
    ]


def _models(results: Results) -> list[str]:
    """What the page says of every mechanism's own forces, thread, released crank and printed models."""
    parts = ["## Mechanisms"]
    for view in views(results):
        told = [*_model_lines(view), *(row["sentence"] for row in judgements(view))]
        parts += [f"### {view.linkage.name} ({view.linkage.variant})"]
        parts += ["\n".join(f"- {line}" for line in told)] if told else []
        parts += _joints(view)
    return parts


def _model_lines(view: View) -> list[str]:
    """A sentence or a few per part; a dead position leaves some of them unsaid."""
    lines = []
    if view.makes_full_turn:
        with suppress(LinkproofError):
            lines.append(forces.lead(TurnForces(view)))
    if view.linkage.thread is not None and view.makes_full_turn:
        with suppress(LinkproofError):
            lines.append(thread.lead(view))
    for regime in view.regimes:
        found = released(view, regime)
        lines += [f"{regime.name}: {line}" for line in sentences(found)] if found else []
    return lines


def _joints(view: View) -> list[str]:
    """Peak force of every joint and the error of every run, regime by regime."""
    parts = []
    for regime in view.regimes:
        rows = joint_rows(view, regime)
        parts += [f"Joint forces, {regime.name}:", table(*rows)] if rows else []
    return parts


def _published(results: Results) -> list[str]:
    tables = readings(results)
    parts = ["## Published figures against ours"] if tables else []
    for name, found in tables.items():
        parts += [f"### {name}", _readings(found)]
    return parts


def _readings(found: Readings) -> str:
    head = ["figure", "published", *found.variants, "place"]
    rows = []
    for row in found.rows:
        ours = [f"{figure(one.ours)} ({per_cent(one.deviation)}, {one.verdict})" if one else "–" for one in row.ours]
        unit = f", {row.unit}" if row.unit else ""
        place = row.source + (f"; {row.note}" if row.note else "")
        rows.append([worded(row.quantity) + unit, printed(row.published), *ours, place])
    return table(head, rows)


def _limits(results: Results) -> list[str]:
    rows = [
        [row.quantities.replace("_", " "), row.settings, row.regimes, row.value, row.reason]
        for row in matrix.limit_rows(results)
    ]
    return ["## Limits", table(["quantities", "settings", "regimes", "limit", "reason"], rows)]


def _environment(results: Results) -> list[str]:
    """Everything that may differ between two runs of the same results."""
    facts = [[name, value] for name, value in results.document["environment"].items()]
    seen = {record.run: record for record in reversed(matrix.every_record(results))}
    costs = [
        [f"{run[0]} ({run[1]})", *run[2:], str(one.steps), seconds(one.seconds), seconds(one.setup_seconds)]
        for run, one in reversed(seen.items())
        if one.steps
    ]
    head = ["mechanism", "regime", "engine", "setting", "steps", "stepping", "set-up"]
    return ["## Environment and times", table(["what", "value"], facts), *([table(head, costs)] if costs else [])]
