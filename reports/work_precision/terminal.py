"""The benchmark for a terminal: what each method comes to, what to use for an error, how the settings stand."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.records import Bench
from reports.document.numbers import bound, error, seconds
from reports.document.screen import Printout, line, table
from reports.work_precision.cost_section import cost_tables
from reports.work_precision.facts import PlaceFacts, engine_label, failed_methods, places
from reports.work_precision.words import choice_words, method_row, noise_note, noise_share, standing_words

CHOICES = ("engine", "to get", "time", "by")
METHODS = ("engine", "method", "order", "least error", "steps/turn", "time", "what limits it")
POINTS = (
    *("mechanism", "regime", "engine", "method", "runs", "effort", "step s", "quantity", "outcome", "error", "RMS"),
    *("stepping", "steps", "why"),
)


def printout(bench: Bench, quantities: Sequence[str] = ()) -> Printout:
    """A block per mechanism, regime and quantity: those asked for, else the one each place is judged by."""
    blocks: list[RenderableType] = []
    for place in places(bench):
        for name in [name for name in quantities if name in place.quantities] or [place.foremost]:
            blocks += _block(place, name, noise_share(bench))
    for costs in cost_tables(bench.costs):
        blocks += [costs, line("")]
    return Printout(blocks, [line(noise_note(bench))], [_points(bench), line("")])


def _points(bench: Bench) -> Table:
    """Every point measured."""
    rows = [
        (
            one.mechanism, one.regime, engine_label(one.engine, one.is_control), one.setting, f"{one.runs}",
            "" if one.effort is None else f"{one.effort:g}",
            "" if one.step is None else f"{one.step:.4g}", one.quantity, one.outcome, error(one.error_max),
            error(one.error.error_rms if one.error else None), seconds(one.seconds_min or 0.0),
            f"{one.steps}", one.detail,
        )
        for one in bench.records
    ]  # fmt: skip
    return table(POINTS, rows)


def _block(place: PlaceFacts, quantity: str, noise: float) -> list[RenderableType]:
    words = f"{place.mechanism} ({place.variant}), {place.regime}"
    if not place.quantities:
        return [line(f"{words}: nothing finished", "bold"), *_failures(place, quantity)]
    title = line(f"{words}: {quantity.replace('_', ' ')}, largest error over the peak", "bold")
    parts: list[RenderableType] = [title, _methods(place, quantity), line(""), _choices(place, quantity), line("")]
    for facts in place.engines(quantity):
        parts += map(line, standing_words(facts, noise))
    return [*parts, *_failures(place, quantity), line("")]


def _failures(place: PlaceFacts, quantity: str) -> list[Text]:
    return [
        line(f"{facts.label} {reason}", "yellow")
        for facts in place.engines(quantity)
        for reason in failed_methods(facts)
    ]


def _methods(place: PlaceFacts, quantity: str) -> Table:
    rows = [method_row(facts, sweep) for facts in place.engines(quantity) for sweep in facts.methods]
    return table(METHODS, rows, align="llrrrrl")


def _choices(place: PlaceFacts, quantity: str) -> Table:
    """What to use for an error: a row for all errors that one point of an engine serves."""
    rows = []
    for facts in place.engines(quantity):
        wanted = zip(WANTED, facts.choices, strict=False)
        for choice, part in groupby(wanted, key=lambda pair: pair[1]):
            errors = [bound(error) for error, _ in part]
            span = errors[0] if len(errors) == 1 else f"{errors[0]} to {errors[-1]}"
            cost, way, step, _ = choice_words(choice, facts)
            turn = f" @ {step}" if step else ""
            rows.append((facts.label, span, cost or "–", f"{way}{turn}" if cost else f"not reached; {way}"))
    return table(CHOICES, rows, align="llrl")
