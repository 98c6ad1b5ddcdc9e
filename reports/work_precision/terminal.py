"""The benchmark for a terminal: what each method comes to, what to use for an error, how the settings stand."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from comparisons.work_precision.analysis import WANTED
from comparisons.work_precision.records import Bench
from reports.text.numbers import bound, error, seconds
from reports.text.screen import Printout, line, table
from reports.work_precision.cost_section import cost_tables
from reports.work_precision.facts import PlaceFacts, engine_label, failed_methods, places
from reports.work_precision.words import choice_words, method_row, noise_note, noise_share, standing_words

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
    """What to use for an error: errors down, engines across."""
    engines = [facts for facts in place.engines(quantity) if facts.choices]
    rows = [
        (bound(wanted), *(_choice(*choice_words(facts.choices[number], facts)) for facts in engines))
        for number, wanted in enumerate(WANTED)
    ]
    return table(("to get", *(facts.label for facts in engines)), rows)


def _choice(cost: str, way: str, step: str, _: str) -> str:
    return f"{cost}: {way}{f' @ {step}' if step else ''}" if cost else f"not reached; {way}"
