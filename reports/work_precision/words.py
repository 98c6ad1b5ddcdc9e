"""A benchmark in words and tables: orders, steps, comparisons of settings, and what the terminal shows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from comparisons.trials.judging.limits import grouped
from comparisons.trials.work_precision.table import (
    SATURATED,
    WANTED,
    Bench,
    Regimes,
    Row,
    Standing,
    choices,
    engines,
    foremost,
    has_floor,
    least,
    places,
    quantities,
    standings,
    sweeps,
)
from engines.contract import Setting
from reports.document.numbers import ABSENT, bound, error, figure, seconds
from reports.document.parts import Paragraph, Table
from reports.document.templates import plain, sentence
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    from pandas import DataFrame

# Times closer than this are the same time, however quiet the machine.
LEAST_NOISE = 0.05


def comparison_words(comparison: Standing, noise: float) -> str:
    """A setting's distance from the methods' front, as the end of a sentence.

    ``best`` is compared with all methods, the others with those of a single run; a share ``noise`` of its time is
    nothing.
    """
    record, ratio, whole = comparison.record, comparison.ratio, comparison.record.setting == Setting.BEST
    if (record.error_max or 0.0) > SATURATED:
        return ": no solution"
    if ratio is None or comparison.rival is None or comparison.rival_seconds is None:
        return f"; no {'method' if whole else 'single run'} measured gets there"
    front = "the front" if whole else "the front of single runs"
    beside = f"{method_words(comparison.rival)} takes {seconds(comparison.rival_seconds)} to the same error"
    if ratio <= 1.0 / (1.0 + noise):
        return f"; ahead of {front}: {beside}, {figure(1.0 / ratio, 2)} × as long"
    return f"; {'on' if ratio <= 1.0 + noise else f'{figure(ratio, 2)} ×'} {front}: {beside}"


def way_words(record: Row) -> str:
    """A point's way and, behind an @, its steps a turn, which a setting's adapter fixes: "trapezoidal x4 @ 48"."""
    return " @ ".join(filter(None, (method_words(record), per_turn(record))))


def method_words(record: Row) -> str:
    """The name of a point's setting or method, without its step.

    Of several runs extrapolated it ends in "x3", with which the name of a method may end already.
    """
    runs = f" x{record.runs}" if record.is_extrapolated else ""
    return str(record.setting).removesuffix(runs) + runs


def effort_words(effort: float | None, unit: str) -> str:
    """A solver effort: "300 iterations", "relative tolerance 1e-6"; of an engine's own, that it is."""
    if effort is None:
        return f"the engine's own {unit}" if unit else ""
    return f"{unit} {bound(effort)}" if "tolerance" in unit else f"{effort:g} {unit}"


def per_turn(record: Row) -> str:
    """Steps a turn; nothing for a setting."""
    return "" if record.steps_per_turn is None else f"{record.steps_per_turn:.0f}"


def least_words(sweep: DataFrame) -> str:
    """The least error of a sweep, called a floor where a finer step does not lower it, and its steps a turn."""
    best = least(sweep)
    return f"{'floor' if has_floor(sweep) else 'least'} {error(best.error_max)} @ {per_turn(best)}"


def noise_share(bench: Bench) -> float:
    """The share by which two times of one thing may differ here."""
    return max(LEAST_NOISE, bench.noise)


def noise_note(bench: Bench) -> str:
    """How the times were measured, in small print."""
    return sentence("machine_noise", noise=bench.noise, repeats=bench.document["extent"]["repeats"])


def engine_label(name: str, is_control: bool) -> str:
    """An engine's name for a reader; the reference's control is marked."""
    return f"{name} (control)" if is_control else name


def label_of(points: DataFrame) -> str:
    """The label of the engine of rows."""
    first = points.iloc[0]
    return engine_label(first.engine, first.is_control)


def engine_labels(bench: Bench) -> dict[str, str]:
    """The labels of all engines of a benchmark, by name, the control last."""
    controls = {record.engine: record.is_control for record in bench.points}
    return {name: engine_label(name, controls[name]) for name in sorted(controls, key=lambda own: (controls[own], own))}


def judged_by(regimes: Regimes) -> str:
    """The quantities that places are judged by, for a reader."""
    return " or ".join(dict.fromkeys(plain(foremost(place)) for places in regimes.values() for place in places))


def failed_methods(points: DataFrame) -> tuple[str, ...]:
    """Methods and settings of an engine that never finished anything, by reason; then what was left out of the rest."""
    done = points[points.finished]
    first = points[~points.setting.isin(done.setting)].drop_duplicates("setting").itertuples()
    names = grouped((f"{row.outcome}: {row.detail}", row.setting or row.engine) for row in first)
    left_out = dict.fromkeys(filter(None, done.left_out))
    return (*(f"{', '.join(same)}: {reason}" for reason, same in names.items()), *left_out)


def overhead_words(record: Row) -> str:
    """The adapter's own share of the stepping."""
    return ABSENT if record.overhead is None else f"{100.0 * record.overhead:.0f} %"


def setting_words(record: Row) -> str:
    """Error and time of a setting, with the adapter's share where it is known."""
    share = "" if record.overhead is None else f", overhead {overhead_words(record)}"
    return f"{error(record.error_max)} in {seconds(record.total_seconds)}{share}"


# The benchmark for a terminal: what each method comes to, what to use for an error, how the settings stand.


CHOICES = ("engine", "to get", "time", "by")
METHODS = ("engine", "method", "order", "least error", "steps/turn", "time")
POINTS = (
    *("mechanism", "regime", "engine", "method", "runs", "effort", "step s", "quantity", "outcome", "error", "RMS"),
    *("set-up", "stepping", "overhead", "steps", "why"),
)


def printout(bench: Bench, requested: Sequence[str] = ()) -> Printout:
    """A block per mechanism, regime and quantity: the requested ones, else the one each place is judged by."""
    blocks: list[Printed] = []
    for place in places(bench):
        for name in [name for name in requested if name in quantities(place)] or [foremost(place)]:
            blocks += _place_printout(place, name, noise_share(bench))
    return Printout(blocks, [noise_note(bench)], [_points(bench), ""])


def _points(bench: Bench) -> Table:
    """Every point measured."""
    rows = [
        (
            record.mechanism, record.regime, engine_label(record.engine, record.is_control), record.setting,
            f"{record.runs}", "" if record.effort is None else f"{record.effort:g}",
            "" if record.step is None else f"{record.step:.4g}", record.quantity, record.outcome,
            error(record.error_max), error(record.error_rms),
            seconds(record.setup_seconds), seconds(record.seconds), overhead_words(record), f"{record.steps}",
            record.detail,
        )
        for record in bench.table.itertuples()
    ]  # fmt: skip
    return Table("", POINTS, tuple(rows), "l")


def _place_printout(place: DataFrame, quantity: str, noise: float) -> Iterator[Printed]:
    where = place.iloc[0]
    name = f"{where.mechanism} ({where.variant}), {where.regime}"
    measured = plain(quantity) if quantities(place) else ""
    sentence = f"{measured}, largest error over the peak" if measured else "nothing finished"
    yield Paragraph(f"{name}: {sentence}", colour="bold")
    if measured:
        yield from (_methods(place, quantity), "", _choices(place, quantity), "")
    for points in engines(place, quantity):
        for standing in standings(points):
            record, words = standing.record, comparison_words(standing, noise)
            yield f"{record.engine} {record.setting}: {setting_words(record)}{words}"
    for points in engines(place, quantity):
        for reason in failed_methods(points):
            yield Paragraph(f"{label_of(points)} {reason}", colour="yellow")
    if measured:
        yield ""


def _methods(place: DataFrame, quantity: str) -> Table:
    """Order, least error with the step and the time there."""
    rows = []
    for sweep in [sweep for points in engines(place, quantity) for sweep in sweeps(points)]:
        best = least(sweep)
        order = ABSENT if best.order is None else f"{best.order:.1f}"
        names = (error(best.error_max), per_turn(best), seconds(best.total_seconds))
        rows.append((label_of(sweep), method_words(best), order, *names))
    return Table("", METHODS, tuple(rows), "llrrrr")


def _choices(place: DataFrame, quantity: str) -> Table:
    """The cheapest way to an error: a row for all errors that one point of an engine serves."""
    rows = []
    for points in [points for points in engines(place, quantity) if points.finished.any()]:
        for record, part in groupby(zip(choices(points), WANTED, strict=True), key=lambda pair: pair[0]):
            errors = [bound(error) for _, error in part]
            span = errors[0] if len(errors) == 1 else f"{errors[0]} to {errors[-1]}"
            if record:
                names = (seconds(record.total_seconds), way_words(record))
            else:
                names = (ABSENT, f"not reached; least {error(points.error_max[points.finished].min())}")
            rows.append((label_of(points), span, *names))
    return Table("", CHOICES, tuple(rows), "llrl")
