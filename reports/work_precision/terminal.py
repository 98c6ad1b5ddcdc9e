"""The benchmark for a terminal: what each method comes to, what to use for an error, how the settings stand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from comparisons.work_precision.analysis import WANTED, PlaceFacts, places
from comparisons.work_precision.records import Bench
from reports.document.numbers import ABSENT, bound, error, seconds
from reports.document.parts import Paragraph, Table
from reports.document.templates import plain
from reports.document.terminal import Printed, Printout
from reports.work_precision import words
from reports.work_precision.words import engine_label, label_of

CHOICES = ("engine", "to get", "time", "by")
METHODS = ("engine", "method", "order", "least error", "steps/turn", "time")
POINTS = (
    *("mechanism", "regime", "engine", "method", "runs", "effort", "step s", "quantity", "outcome", "error", "RMS"),
    *("set-up", "stepping", "steps", "why"),
)


def printout(bench: Bench, quantities: Sequence[str] = ()) -> Printout:
    """A block per mechanism, regime and quantity: the requested ones, else the one each place is judged by."""
    blocks: list[Printed] = []
    for place in places(bench):
        for name in [name for name in quantities if name in place.quantities] or [place.foremost]:
            blocks += _place_printout(place, name, words.noise_share(bench))
    return Printout(blocks, [words.noise_note(bench)], [_points(bench), ""])


def _points(bench: Bench) -> Table:
    """Every point measured."""
    rows = [
        (
            record.mechanism, record.regime, engine_label(record.engine, record.is_control), record.setting,
            f"{record.runs}", "" if record.effort is None else f"{record.effort:g}",
            "" if record.step is None else f"{record.step:.4g}", record.quantity, record.outcome,
            error(record.error_max), error(record.error.error_rms if record.error else None),
            seconds(record.setup_seconds), seconds(record.seconds), f"{record.steps}", record.detail,
        )
        for record in bench.records
    ]  # fmt: skip
    return Table("", POINTS, tuple(rows), "l")


def _place_printout(place: PlaceFacts, quantity: str, noise: float) -> Iterator[Printed]:
    name, engines = f"{place.mechanism} ({place.variant}), {place.regime}", place.engines(quantity)
    measured = plain(quantity) if place.quantities else ""
    sentence = f"{measured}, largest error over the peak" if measured else "nothing finished"
    yield Paragraph(f"{name}: {sentence}", colour="bold")
    if measured:
        yield from (_methods(place, quantity), "", _choices(place, quantity), "")
    for facts in engines if measured else ():
        for comparison in facts.setting_comparisons:
            record, standing = comparison.record, words.comparison_words(comparison, noise)
            cost = f"{error(record.error_max)} in {seconds(record.total_seconds)}"
            yield f"{facts.engine} {record.setting}: {cost}{standing}"
    for facts in engines:
        for reason in words.failed_methods(facts):
            yield Paragraph(f"{label_of(facts)} {reason}", colour="yellow")
    if measured:
        yield ""


def _methods(place: PlaceFacts, quantity: str) -> Table:
    """Order, least error with the step and the time there."""
    rows = []
    for facts, sweep in [(entry, sweep) for entry in place.engines(quantity) for sweep in entry.sweeps]:
        least = sweep.least
        order = ABSENT if sweep.order is None else f"{sweep.order:.1f}"
        names = (error(least.error_max), words.per_turn(least), seconds(least.total_seconds))
        rows.append((label_of(facts), words.method_words(sweep.first), order, *names))
    return Table("", METHODS, tuple(rows), "llrrrr")


def _choices(place: PlaceFacts, quantity: str) -> Table:
    """The cheapest way to an error: a row for all errors that one point of an engine serves."""
    rows = []
    for facts in place.engines(quantity):
        for choice, part in groupby(zip(facts.choices, WANTED, strict=False), key=lambda pair: pair[0]):
            errors = [bound(error) for _, error in part]
            span = errors[0] if len(errors) == 1 else f"{errors[0]} to {errors[-1]}"
            if record := choice.record:
                names = (seconds(record.total_seconds), words.way_words(record))
            else:
                names = (ABSENT, f"not reached; least {error(choice.closest.error_max)}")
            rows.append((label_of(facts), span, *names))
    return Table("", CHOICES, tuple(rows), "llrl")
