"""The benchmark's page: the cheapest engines, the diagram, what to use for an error, settings and methods."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from comparisons.judging.limits import grouped
from comparisons.runs.files import RECORDS
from comparisons.work_precision.analysis import EngineFacts, PlaceFacts, Regimes, by_regime, places
from comparisons.work_precision.records import KIND, Bench, BenchRecord
from reports.document.numbers import ABSENT, error, seconds
from reports.document.parts import (
    Bullets,
    Command,
    Facts,
    FigureGroup,
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
from reports.records.origins import environment_facts
from reports.records.views import anchor, blank_repeats
from reports.work_precision import choices
from reports.work_precision.overview import drawn_error, figures, inks
from reports.work_precision.words import (
    comparison_words,
    effort_words,
    engine_labels,
    failed_methods,
    judged_by,
    label_of,
    least_words,
    method_words,
    noise_note,
    noise_share,
)

# The diagram of error over cost, as data for its script: any mechanism, quantity and measure of the cost.

LABEL = "Error over cost: a point is a method at one step, or a setting"
# What the points of a sweep share, and what each has of its own: cost, s, steps and work.
SHARED = ("engine", "engine_version", "kind", "setting", "runs", "work_unit")
OWN = ("step", "steps_per_turn", "seconds", "seconds_median", "setup_seconds", "readout_seconds", "steps",
       "solver_work", "used")  # fmt: skip


def widget(regimes: Regimes, labels: Mapping[str, str]) -> Widget:
    """The diagram of all places; the first one is on the page, the others are loaded when they are chosen."""
    places = {
        anchor(facts.mechanism, facts.variant, facts.regime): facts for factses in regimes.values() for facts in factses
    }
    colours, (first, *others) = inks(labels), places
    data = {
        "places": [[key, f"{place.mechanism}, {place.regime}"] for key, place in places.items()],
        "engines": [[name, label, colours[name]] for name, label in labels.items()],
        "first": place_data(places[first]),
    }
    return Widget("bench", "diagram", LABEL, data, {key: place_data(places[key]) for key in others})


def place_data(place: PlaceFacts) -> dict[str, Any]:
    """Sweeps and settings of one mechanism and regime, JSON-ready.

    A quantity is its name, a reader's, its unit and the closed form's peak; the foremost is the first. A sweep's
    ``ends`` have by quantity the least error in words, and the order; a point's ``errors`` are, over the peak, the
    largest as drawn, the largest and the root mean square.
    """
    names = sorted(place.quantities, key=lambda name: name != place.foremost)
    sweeps: dict[tuple[object, ...], dict[str, Any]] = {}
    peaks = {}
    for facts in (entry for name in names for entry in place.engines(name)):
        for record in facts.records:
            if record.finished and (quantity_record := record.error):
                point = _point_as_dict(sweeps.setdefault(_sweep_key(record), _shared_facts(record)), record)
                errors = (drawn_error(record), quantity_record.error_max, quantity_record.error_rms)
                point["errors"][record.quantity] = [*map(_digits, errors)]
                peaks[record.quantity] = [quantity_record.unit, _digits(quantity_record.peak)]
        for sweep in facts.sweeps:
            sweeps[_sweep_key(sweep.first)]["ends"][sweep.first.quantity] = [least_words(sweep), _digits(sweep.order)]
    tables = [{**sweep, "points": list(sweep["points"].values())} for sweep in sweeps.values()]
    return {"quantities": [[name, plain(name), *peaks[name]] for name in names], "sweeps": tables}


def _sweep_key(record: BenchRecord) -> tuple[object, ...]:
    return (record.engine, record.kind, record.setting)


def _shared_facts(record: BenchRecord) -> dict[str, Any]:
    return {
        **{name: getattr(record, name) for name in SHARED},
        "way": method_words(record),
        "solver": effort_words(record.effort, record.effort_unit),
        "ends": {},
        "points": {},
    }


def _point_as_dict(sweep: dict[str, Any], record: BenchRecord) -> dict[str, Any]:
    words = {name: _digits(getattr(record, name)) for name in OWN}
    table: dict[str, Any] = sweep["points"].setdefault(record.step, {**words, "errors": {}})
    return table


def _digits(value: object) -> object:
    """A number to four digits, which is all that a reader sees; anything else as it is."""
    return float(f"{value:.4g}") if isinstance(value, float) else value


# The settings compared with the methods of their engine, and the methods' orders and least errors.


# Of one engine in one place: a row's head and its cell there.
Rows = Callable[[EngineFacts], Iterator[tuple[TableCell, TableCell]]]


def method_section(regimes: Regimes, methods: Sequence[Mapping[str, Any]], noise: float) -> Section:
    """Settings, orders and least errors; times closer than the share ``noise`` are the same.

    ``methods`` are what the benchmark's document says of each.
    """
    about = {(method["engine"], method["name"]): method["about"] for method in methods}

    def settings(facts: EngineFacts) -> Iterator[tuple[TableCell, TableCell]]:
        for each in facts.setting_comparisons:
            comparison = comparison_words(each, noise).lstrip(":; ") if facts.sweeps else ""
            words = f"{error(each.record.error_max)} in {seconds(each.record.total_seconds)}".replace(" ", "\u00a0")
            cell = TableCell(words, note=comparison.partition(":")[0], tooltip=comparison)
            yield TableCell(each.record.setting), cell

    def sweeps(facts: EngineFacts) -> Iterator[tuple[TableCell, TableCell]]:
        for method in facts.sweeps:
            order = "no order" if method.order is None else f"order {method.order:.1f}"
            row = TableCell(method_words(method.first), note=about[facts.engine, method.first.setting])
            yield row, TableCell(order, note=least_words(method))

    orders = _by_mechanism(regimes, "bench_orders", "Method", sweeps)
    folds = (Fold("The methods: orders and least errors", (orders,)),) if orders.rows else ()
    name = "bench_standings" if folds else "bench_settings"
    table = _by_mechanism(regimes, name, "Setting", settings)
    heading = "The settings against the methods" if folds else "The settings"
    return Section("settings", heading, (table, *folds))


def _by_mechanism(regimes: Regimes, about: str, name: str, rows_of: Rows) -> Table:
    """Engines and their rows down, mechanisms by regime across; an engine is named in its first row."""
    places = [place for part in regimes.values() for place in part]
    table: dict[str, dict[TableCell, dict[int, TableCell]]] = {}
    for column, place in enumerate(places):
        for facts in place.engines(place.foremost):
            for row, cell in rows_of(facts):
                table.setdefault(label_of(facts), {}).setdefault(row, {})[column] = cell
    none = TableCell(ABSENT, "absent")
    rows = blank_repeats(
        (label, row, *(mine.get(column, none) for column in range(len(places))))
        for label, cells in table.items()
        for row, mine in cells.items()
    )
    groups = (("", 2), *((f"regime {regime}", len(part)) for regime, part in regimes.items()))
    head = ("Engine", name, *(place.mechanism for place in places))
    return Table(sentence(about, judged=judged_by(regimes)), head, tuple(rows), "l", groups=groups)


# The benchmark's page: the cheapest engines, the diagram, what to use for an error, settings and methods.

LINK = PageLink("Work-precision", "bench.html")


def page(bench: Bench) -> Page:
    """The page of one benchmark."""
    every, labels = places(bench), engine_labels(bench)
    first: tuple[Part, ...] = (Paragraph("Nothing finished: no engine has an error and a time.", "verdict"),)
    sections: list[Section] = []
    if groups := by_regime(every):
        as_figures = Fold("The same as figures", (FigureGroup(figures(groups, inks(labels))),))
        reading = Paragraph(sentence("bench_reading"), "small")
        first = (*choices.verdicts(groups), widget(groups, labels), reading, as_figures)
        methods = method_section(groups, bench.document["methods"], noise_share(bench))
        sections += [choices.section(groups, noise_note(bench)), methods]
    if failed := _failures(every):
        sections.append(Section("failed", "What gave nothing", (Fold(f"Failures: {len(failed)}", (Bullets(failed),)),)))
    heading, about = "How accurate is an engine for its cost?", sentence("bench_subtitle")
    sections.append(_measured(bench))
    return Page(LINK.href, LINK.text, heading, about, first, tuple(sections), charts=bool(groups))


def _failures(every: Sequence[PlaceFacts]) -> tuple[str, ...]:
    """Runs without a result: each reason once, with its places."""
    groups = grouped(
        (f"{label_of(facts)}, {reason}", f"{place.mechanism} in {place.regime}")
        for place in every
        for facts in place.engines(place.foremost)
        for reason in failed_methods(facts)
    )
    where = {reason: ", ".join(met) if len(met) < len(every) else "everywhere" for reason, met in groups.items()}
    return tuple(f"{reason} ({place})" for reason, place in where.items())


def _measured(bench: Bench) -> Section:
    """The conditions of the measurement, in sentences."""
    document, repeats = bench.document, sum(len(point.repeats) for point in bench.points)
    work, share = document["noise"]["work"], noise_share(bench)
    sentences = lines("measurement", extent=document["extent"], noise=bench.noise, work=work, share=share)
    known = {entry["engine"]: entry["seconds"] for entry in document["first_use"] if entry["seconds"]}
    first = ", ".join(f"{name} {seconds(min(times))}" for name, times in known.items()) or "not measured"
    facts = Facts((
        ("Conditions", document["conditions"]),
        *environment_facts(document["environment"]),
        ("Points", f"{len(bench.points)}, timed {repeats} times in all"),
        ("First use", f"{first}: the first run of a process beyond the second, import included"),
        ("Records", Mono(f"{KIND}/{RECORDS}")),
    ))  # fmt: skip
    rounds = Fold("Rounds, times, errors and orders", (Bullets(tuple(sentences)),))
    return Section("measured", "How it was measured", (rounds, facts, Command(document["command"])))
