"""A benchmark in words and tables, for the terminal, and as a page: the cheapest engines, error over cost, methods."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Any, TypeAlias

from comparisons.trials.judging.limits import grouped
from comparisons.trials.runs.files import STORE
from comparisons.trials.work_precision.table import (
    LARGE_OVERHEAD,
    PLACE,
    SETTING,
    WANTED,
    Bench,
    Regimes,
    Row,
    by_regime,
    choices,
    engines,
    foremost,
    has_floor,
    large_overheads,
    least,
    places,
    quantities,
    rows,
    sweeps,
)
from reports.document.numbers import ABSENT, bound, error, seconds
from reports.document.parts import (
    Bullets,
    Command,
    Facts,
    Fold,
    Mono,
    Page,
    PageLink,
    Paragraph,
    Part,
    Section,
    Table,
    TableCell,
    Widget,
)
from reports.document.templates import lines, plain, sentence
from reports.document.terminal import Printed, Printout
from reports.records import anchor, blank_repeats, environment_facts, looks

if TYPE_CHECKING:
    from pandas import DataFrame

# Times closer than this are the same time, however quiet the machine.
LEAST_NOISE = 0.05


def way_words(record: Row) -> str:
    """The way to a point in words: method and, after "@", its steps per turn, "RK4 @ 720"; of a setting its name."""
    return " @ ".join(filter(None, (method_words(record), per_turn(record))))


def method_words(record: Row) -> str:
    """The name of a point's setting or method, without its step; of several runs extrapolated with " x3" at its end.

    That stands there once, whether or not the name ends in it already.
    """
    runs = f" x{record.runs}" if record.is_extrapolated else ""
    return str(record.setting).removesuffix(runs) + runs


def effort_words(effort: float | None, unit: str) -> str:
    """A solver's effort with its unit in words: "300 iterations", "tolerance 1e-8".

    For None that it is the engine's own; "" for None without a unit.
    """
    if effort is None:
        return f"the engine's own {unit}" if unit else ""
    return f"{unit} {bound(effort)}" if "tolerance" in unit else f"{effort:g} {unit}"


def per_turn(record: Row) -> str:
    """Steps per turn as a whole number in text; "" for a setting, which has none."""
    return "" if record.steps_per_turn is None else f"{record.steps_per_turn:.0f}"


def least_words(sweep: DataFrame) -> str:
    """The least error of a sweep over the peak, with its steps per turn: "floor 1.2e-9 @ 720".

    It is called a floor if finer steps do not lower it, else least. ``sweep`` has the rows of one method and quantity.
    """
    best = least(sweep)
    return f"{'floor' if has_floor(sweep) else 'least'} {error(best.error_max)} @ {per_turn(best)}"


def noise_share(bench: Bench) -> float:
    """The share by which two times of the same work may differ in this benchmark: its noise, but at least 5 %."""
    return max(LEAST_NOISE, bench.noise)


def noise_note(bench: Bench) -> str:
    """A sentence on how the times were measured: how many repeats, and by what share they scatter."""
    return sentence("machine_noise", noise=bench.noise, repeats=bench.document["extent"]["repeats"])


def engine_labels(bench: Bench) -> dict[str, str]:
    """The labels of all engines of a benchmark, by the engine's name, sorted, those of controls last."""
    known = bench.table.sort_values(["is_control", "engine"])
    return dict(zip(known.engine, known.label, strict=True))


def judged_by(regimes: Regimes) -> str:
    """The quantities by which the places of these regimes are judged, as text: "Mkr or phi"."""
    return " or ".join(dict.fromkeys(plain(foremost(place)) for places in regimes.values() for place in places))


def failed_methods(points: DataFrame) -> tuple[str, ...]:
    """Methods that never finished as texts, "RK4, Euler: diverged: …", one per reason, then what the engine omits.

    ``points`` are the rows of one engine in a place; its name stands where no method was tried. What it omits are
    quantities, as it states them.
    """
    done = points[points.finished]
    first = points[~points.setting.isin(done.setting)].drop_duplicates("setting").itertuples()
    names = grouped((f"{row.outcome}: {row.detail}", row.setting or row.engine) for row in first)
    left_out = dict.fromkeys(filter(None, done.left_out))
    return (*(f"{', '.join(same)}: {reason}" for reason, same in names.items()), *left_out)


def overhead_words(record: Row) -> str:
    """The adapter's own share of the stepping in whole per cent, as text; a dash where it is not known."""
    return ABSENT if record.overhead is None else f"{100.0 * record.overhead:.0f} %"


# One mechanism under one regime, on the terminal and on the page: what each method and setting comes to, what to use.


METHODS = ("engine", "method", "order", "least error", "steps/turn", "time")
CHOICES = ("engine", "to get", "time", "by")
SETTINGS = ("engine", "setting", "error", "time", "overhead")
# Columns of the table of all points that the terminal has if it is verbose.
POINTS = ["mechanism", "regime", "engine", "setting", "runs", "effort", "step", "quantity", "outcome", "error_max",
          "error_rms", "setup_seconds", "seconds", "overhead", "steps", "detail"]  # fmt: skip


def printout(bench: Bench, requested: Sequence[str] = ()) -> Printout:
    """The printed benchmark: a block per mechanism, regime and requested, or else foremost, quantity.

    ``requested`` are names; those that a place has not measured are left out there. All points follow as details.
    """
    blocks: list[Printed] = []
    for place in places(bench):
        for name in [name for name in requested if name in quantities(place)] or [foremost(place)]:
            blocks += _place_printout(place, name)
    known = bench.table[POINTS].map(lambda cell: "" if cell is None else cell)
    every = known.to_string(index=False, float_format="{:.4g}".format)
    return Printout(blocks, [noise_note(bench)], [every, ""])


def _place_printout(place: DataFrame, quantity: str) -> Iterator[Printed]:
    """Yield the printed block of one mechanism and regime in a quantity: heading, tables, and what failed."""
    where = place.iloc[0]
    is_measured = bool(quantities(place))
    what = f"{plain(quantity)}, largest error over the peak" if is_measured else "nothing finished"
    yield Paragraph(f"{where.mechanism} ({where.variant}), {where.regime}: {what}", colour="bold")
    for table in place_tables(place, quantity, {}):
        yield from (table, "")
    for points in engines(place, quantity):
        for reason in failed_methods(points):
            yield Paragraph(f"{points.label.iloc[0]} {reason}", colour="yellow")
    if is_measured:
        yield ""


def place_tables(place: DataFrame, quantity: str, about: Mapping[tuple[str, str], str]) -> list[Table]:
    """Methods, cheapest ways and settings in a quantity of a place, tables in this order; one without rows is left out.

    ``about`` has the descriptions of methods by engine and method's name.
    """
    groups = engines(place, quantity)
    methods = [_method_row(sweep, about) for points in groups for sweep in sweeps(points)]
    ways = [row for points in groups if points.finished.any() for row in _choice_rows(points)]
    settings = [
        (points.label.iloc[0], row.setting, error(row.error_max), seconds(row.total_seconds), overhead_words(row))
        for points in groups
        for row in rows(points[points.finished & (points.kind == SETTING)])
    ]
    tables = ((METHODS, methods, "llrrrr"), (CHOICES, ways, "llrl"), (SETTINGS, settings, "llrrr"))
    return [Table("", head, tuple(lines), align) for head, lines, align in tables if lines]


def _method_row(sweep: DataFrame, about: Mapping[tuple[str, str], str]) -> tuple[TableCell | str, ...]:
    """The row of a sweep's method: engine, method, order, least error over the peak, steps per turn and time of that.

    A note on the method is what ``about`` has of it, by engine and method's name; a dash is an unknown order.
    """
    best = least(sweep)
    name = TableCell(method_words(best), note=about.get((best.engine, best.setting), ""))
    order = ABSENT if best.order is None else f"{best.order:.1f}"
    return best.label, name, order, error(best.error_max), per_turn(best), seconds(best.total_seconds)


def _choice_rows(points: DataFrame) -> Iterator[tuple[str, ...]]:
    """Yield the rows of an engine's cheapest way to each wanted error: label, error, time, way, as texts.

    Neighbouring errors that one point serves share a row; so do those not reached, a dash for their time and the least
    error for the way. ``points`` are the engine's rows in a quantity.
    """
    label, least_error = points.label.iloc[0], points.error_max[points.finished].min()
    for record, part in groupby(zip(choices(points), WANTED, strict=True), key=lambda pair: pair[0]):
        errors = [bound(error) for _, error in part]
        span = errors[0] if len(errors) == 1 else f"{errors[0]} to {errors[-1]}"
        if record:
            yield label, span, seconds(record.total_seconds), way_words(record)
        else:
            yield label, span, ABSENT, f"not reached; least {error(least_error)}"


# Nothing below round-off is worth a decade, and nothing ten times as large as its own peak one more.
LEAST, MOST = 1e-16, 10.0
WHERE = ["mechanism", "regime"]


def drawn_error(record: Row) -> float:
    """The largest error over the peak, raised or cut to 1e-16 … 10, the range of diagrams; the least for none."""
    return min(max(record.error_max or 0.0, LEAST), MOST)


# Of the places of a regime, of their engines, the cheapest way to each error; none where an engine does not reach it.
Ways: TypeAlias = "Sequence[Sequence[Sequence[Row | None]]]"
# Errors that the page begins with, by their places among those wanted.
NAMED = (0, 1, 4)


def verdicts(regimes: Regimes, noise: float) -> tuple[Paragraph, ...]:
    """A paragraph per regime on the cheapest engines for the errors ``NAMED`` of ``WANTED``, controls aside.

    ``regimes`` have, by name, the measured points of each place as rows. Times within a share ``noise`` of the least
    are equal.
    """
    chosen = {
        name: [[choices(points) for points in engines(place) if not points.is_control.any()] for place in places]
        for name, places in regimes.items()
    }
    return tuple(Paragraph(_verdict(name, regimes[name], ways, noise), "verdict") for name, ways in chosen.items())


def _verdict(
    regime: str, group: Sequence[DataFrame], ways: Sequence[Sequence[Sequence[Row | None]]], noise: float
) -> str:
    """A sentence on the cheapest engines under a ``regime``, for a few errors.

    ``group`` has the rows of each of its places, ``ways`` the ``choices`` of every place and engine; times within a
    share ``noise`` of the least are equal.
    """
    wins = [(_error_words(WANTED[column]), _winners(ways, column, noise)) for column in NAMED]
    leaders = {winners[0][0] if len(winners) == 1 and winners[0][2] == len(ways) else "" for _, winners in wins}
    always = leaders.pop() if len(leaders) == 1 else ""
    judged = judged_by({regime: group})
    return sentence(
        "bench_verdict", regime=regime, judged=judged, count=len(ways), noise=noise, wins=wins, always=always
    )


def _error_words(error: float) -> str:
    """An error over the peak as text: in per cent, or with an exponent below a thousandth."""
    return f"{100.0 * error:g} %" if error >= 1e-3 else bound(error)


def _winners(places: Ways, column: int, noise: float) -> list[tuple[str, str, int]]:
    """Each engine that is cheapest somewhere: name, span of its times in words, and in how many places; the most first.

    ``places`` have the choices of every engine, one for each of ``WANTED``, of which ``column`` is the index. All whose
    times are within the share ``noise`` of the least are the cheapest.
    """
    best = []
    for place in places:
        records = [record for ways in place if (record := ways[column]) is not None]
        least = min((record.total_seconds for record in records), default=0.0)
        best += [record for record in records if record.total_seconds <= least * (1.0 + noise)]
    wins = grouped((record.engine, record) for record in best)
    return [(name, _time_span(won), len(won)) for name, won in sorted(wins.items(), key=lambda pair: -len(pair[1]))]


def _time_span(records: Sequence[Row]) -> str:
    """The shortest and longest time of runs in words, "3.1 ms to 2.0 s", set-up included; one where both read alike."""
    times = [record.total_seconds for record in records]
    return " to ".join(dict.fromkeys((seconds(min(times)), seconds(max(times)))))


def choices_section(regimes: Regimes, bench: Bench) -> Section:
    """The section on the cheapest way to an error: over all mechanisms, then each in a fold with all its tables.

    ``regimes`` are the places of ``bench`` by regime.
    """
    about = {(method["engine"], method["name"]): method["about"] for method in bench.document["methods"]}
    head = ("Regime", "Engine", *map(bound, WANTED))
    judged, overheads = judged_by(regimes), large_overheads(bench)
    whole = Table(
        sentence("bench_use", judged=judged), head, tuple(blank_repeats(_regime_rows(regimes))), "l", style="choices"
    )
    slowed = (Paragraph(sentence("bench_overheads", rows=overheads, most=LARGE_OVERHEAD)),) if overheads else ()
    folds = [
        Fold(f"{place.mechanism.iloc[0]}, {name}", tuple(place_tables(place, foremost(place), about)))
        for name, places in regimes.items()
        for place in places
    ]
    reading, note = Paragraph(sentence("bench_places", judged=judged)), Paragraph(noise_note(bench), "small")
    return Section("use", "What to use for an error", (whole, *slowed, reading, *folds, note))


def _regime_rows(groups: Regimes) -> Iterator[tuple[TableCell | str, ...]]:
    """Yield a row per regime and engine, a cell for each of ``WANTED``; neighbouring cells that are equal are one."""
    for name, group in groups.items():
        by_engine = grouped((points.label.iloc[0], points) for place in group for points in engines(place))
        for label, mine in by_engine.items():
            each = (_times_cell(mine, ways) for ways in zip(*map(choices, mine), strict=True))
            cells = [(cell, len(list(same))) for cell, same in groupby(each)]
            yield name, label, *(TableCell(cell.words, cell.style, note=cell.note, span=span) for cell, span in cells)


def _times_cell(engines: Sequence[DataFrame], ways: Sequence[Row | None]) -> TableCell:
    """The cell of an engine and an error: its times over the mechanisms, and the way most of them take as a note.

    Where none gets there it is a dash, with the least error as the note. ``engines`` has the engine's rows in each
    place, ``ways`` its cheapest way there, or None.
    """
    met = [way for way in ways if way is not None]
    if not met:
        errors = [points.error_max[points.finished].min() for points in engines if points.finished.any()]
        return TableCell(ABSENT, "absent", note=f"least {error(min(errors))}" if errors else "nothing finished")
    share = f"; in {len(met)} of {len(engines)}" if len(met) < len(engines) else ""
    taken = Counter(map(way_words, met)).most_common(1)[0][0]
    return TableCell(_time_span(met), note=f"{taken}{share}")


# The diagram of error over cost, as data for its script: any mechanism, quantity and measure of the cost.

LABEL = "Error over cost: a point is a method at one step, or a setting"
# What the points of a sweep share, and what each has of its own: cost, s, and steps.
SHARED = ("engine", "engine_version", "kind", "setting", "runs")
OWN = ("step", "steps_per_turn", "seconds", "seconds_median", "setup_seconds", "steps")


def widget(regimes: Regimes, labels: Mapping[str, str]) -> Widget:
    """The diagram of all places; the first one's data are on the page, the others are loaded when they are chosen.

    ``regimes`` must have a place; ``labels`` are the engines' by name, a control's differing from its name.
    """
    places = {anchor(*place[PLACE].iloc[0]): place for group in regimes.values() for place in group}
    known, (first, *others) = looks(labels, {name for name in labels if labels[name] != name}), places
    data = {
        "places": [[key, "{}, {}".format(*place[WHERE].iloc[0])] for key, place in places.items()],
        "engines": [[name, label, *known[name]] for name, label in labels.items()],
        "first": place_data(places[first]),
    }
    return Widget("bench", "diagram", LABEL, data, {key: place_data(places[key]) for key in others})


def place_data(place: DataFrame) -> dict[str, Any]:
    """Sweeps and settings of one mechanism and regime for the diagram, JSON-ready, under "quantities" and "sweeps".

    A quantity is its name, a reader's, its unit and the closed form's peak; the foremost is the first.
    """
    done, names = place[place.finished], sorted(quantities(place), key=lambda name: name != foremost(place))
    peaks = {record.quantity: [record.unit, _digits(record.peak)] for record in rows(done)}
    sweeps_of = done.groupby(["engine", "kind", "setting"], sort=False)
    return {
        "quantities": [[name, plain(name), *peaks[name]] for name in names],
        "sweeps": [_sweep_data(sweep) for _, sweep in sweeps_of],
    }


def _sweep_data(sweep: DataFrame) -> dict[str, Any]:
    """A method's points, or a setting's one, for the diagram, JSON-ready; ``sweep`` has their rows in every quantity.

    "ends" have by quantity the least error in words, and the order; a point's "errors" are by quantity, over the peak,
    the largest as drawn, the largest and the root mean square.
    """
    first, points = sweep.iloc[0], [rows(point) for _, point in sweep.groupby("key", sort=False)]
    return {
        **{name: first[name] for name in SHARED},
        "way": method_words(first),
        "solver": effort_words(first.effort, first.effort_unit),
        "ends": {each.quantity.iloc[0]: [least_words(each), _digits(each.order.iloc[0])] for each in sweeps(sweep)},
        "points": [
            {
                **{name: _digits(getattr(point[0], name)) for name in OWN},
                "used": ", ".join(f"{plain(name)} {_digits(value)}" for name, value in point[0].details.items()),
                "errors": {
                    each.quantity: [_digits(drawn_error(each)), _digits(each.error_max), _digits(each.error_rms)]
                    for each in point
                },
            }
            for point in points
        ],
    }


def _digits(value: object) -> object:
    """A float rounded to four significant digits; any other value unchanged."""
    return float(f"{value:.4g}") if isinstance(value, float) else value


# The benchmark's page: the cheapest engines, the diagram, what to use for an error.

LINK = PageLink("Work-precision", "bench.html")


def page(bench: Bench) -> Page:
    """The page of a benchmark: verdicts and diagram, choices, failures, how it was measured.

    Where nothing finished a sentence on that stands in place of the first two.
    """
    every, labels = places(bench), engine_labels(bench)
    first: tuple[Part, ...] = (Paragraph("Nothing finished: no engine has an error and a time.", "verdict"),)
    sections: list[Section] = []
    if groups := by_regime(bench):
        reading = Paragraph(sentence("bench_reading"), "small")
        first = (*verdicts(groups, noise_share(bench)), widget(groups, labels), reading)
        sections.append(choices_section(groups, bench))
    if failed := _failures(every):
        sections.append(Section("failed", "What gave nothing", (Fold(f"Failures: {len(failed)}", (Bullets(failed),)),)))
    heading, about = "How accurate is an engine for its cost?", sentence("bench_subtitle")
    sections.append(_measured(bench))
    return Page(LINK.href, LINK.text, heading, about, first, tuple(sections), charts=bool(groups))


def cost(bench: Bench) -> tuple[Paragraph, ...]:
    """Paragraphs for a report's first page, one per regime: the cheapest engines by the benchmark."""
    words = verdicts(by_regime(bench), noise_share(bench))
    return tuple(replace(paragraph, role="lead") for paragraph in words)


def _failures(every: Sequence[DataFrame]) -> tuple[str, ...]:
    """Each reason for runs without a result, once, with the places among ``every`` where it occurred, as sentences.

    ``every`` has the rows of each place.
    """
    groups = grouped(
        (f"{points.label.iloc[0]}, {reason}", "{} in {}".format(*place[WHERE].iloc[0]))
        for place in every
        for points in engines(place)
        for reason in failed_methods(points)
    )
    where = {reason: ", ".join(met) if len(met) < len(every) else "everywhere" for reason, met in groups.items()}
    return tuple(f"{reason} ({place})" for reason, place in where.items())


def _measured(bench: Bench) -> Section:
    """The section on the conditions of the measurement: rounds, environment, number of points, the command."""
    document, repeats = bench.document, sum(len(point.repeats) for point in bench.points)
    sentences = lines("measurement", extent=document["extent"], noise=bench.noise)
    facts = Facts((
        ("Conditions", document["conditions"]),
        *environment_facts(document["environment"]),
        ("Points", f"{len(bench.points)}, timed {repeats} times in all"),
        ("Records", Mono(STORE)),
    ))  # fmt: skip
    rounds = Fold("Rounds, times, errors and orders", (Bullets(tuple(sentences)),))
    return Section("measured", "How it was measured", (rounds, facts, Command(document["command"])))
