"""How the engines did on one mechanism: all errors and curves in one chart, tables and costs below it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from comparisons.motion.thinning import extreme_samples
from comparisons.trials.judging.limits import grouped
from comparisons.trials.judging.quantities import JOINT_FORCE
from comparisons.trials.judging.records import CONTROL, Error
from reports.document import numbers
from reports.document.packed import packed
from reports.document.parts import RUNS, Bullets, Fold, Part, Section, Table, TableCell, Widget
from reports.document.templates import plain, sentence
from reports.records import (
    LOOKS,
    Regime,
    Trace,
    View,
    columns,
    computed_or_shared,
    concurrency_note,
    family,
    looks,
    origin_words,
    remedy,
    setting_rank,
    share,
    short_title,
    worst,
)
from reports.records import engines as all_engines

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def engines_section(view: View) -> Section:
    """The section of a mechanism's page on its simulations, or on another tool's file."""
    parts = [errors_section(view, regime) for regime in view.regimes]
    if is_imported(view):
        return Section("engines", "Every error", tuple(parts))
    runs = tuple(_runs_table(view, regime) for regime in view.regimes)
    return Section("engines", "How the engines did", (*parts, Fold("How each run was made, and what it cost", runs)))


def is_imported(view: View) -> bool:
    """Whether the results are those of another tool's file."""
    return "judgement" in view.results.document


def errors_chart(view: View) -> Widget:
    """The widget of all errors and curves; its regime, quantity, engines and settings can be chosen.

    It opens with the curves of the worst signal where a file was judged, else with every error. The first curves are on
    the page, the others loaded when they are chosen.
    """
    further = curves(view)
    first = next(iter(further), "")
    shown = [record for record in view.records if is_imported(view) and record.error_max is not None]
    opens = "/".join((worst(shown).regime, worst(shown).quantity)) if shown else ""
    data = {**chart_data(view), "opens": opens, "first": first, "curves": further.pop(first, None)}
    label = "Errors and curves of every engine"
    return Widget("curves", "curves", label, data, further)


def errors_section(view: View, regime: Regime) -> Fold:
    """The fold with every error of a regime in figures, the reason for each missing one, and remedies.

    Its title names the regime if there are several.
    """
    runs = view.runs(regime)
    shown = [run for run in runs if any(record.error_max is not None for record in run)]
    lost = {run[0].run for run in runs if run not in shown}
    lacking = [record for run in runs for record in run if record.error_max is None]
    lines = [*reasons(lacking, lambda record: "" if record.run in lost else plain(record.quantity)), *remedies(runs)]
    parts: list[Part] = [_errors_table(view, regime, shown)] if shown else []
    under = f" under {regime.name}" if len(view.regimes) > 1 else ""
    return Fold(f"Every error{under} in figures", (*parts, *([Bullets(tuple(lines))] if lines else [])))


def _errors_table(view: View, regime: Regime, runs: Sequence[Sequence[Error]]) -> Table:
    """The table of a regime's errors: quantities, then invariants, down; engines and settings across.

    ``runs`` are the runs with an error, a list of records each.
    """
    groups = tuple((name, len(list(part))) for name, part in groupby(runs, key=lambda run: run[0].engine))
    rows: list[Sequence[TableCell | str]] = []
    for name, records in error_rows(runs, str).items():
        measured = () if name in view.invariants else records
        peak = next((f"{numbers.figure(r.peak)} {r.unit}" for r in measured if r is not None and r.peak), "")
        rows.append((TableCell(view.title(name), note=peak), limit_words(records), *map(error_cell, records)))
    note = sentence("matrix_note", imported=is_imported(view)) if regime == view.regimes[0] else ""
    head = ("quantity", "limit", *(run[0].setting for run in runs))
    caption = f"{regime.name}: {regime.conditions}. Largest error over the closed form's peak."
    return Table(caption, head, rows, note=note, groups=(("", 2), *groups), style="matrix")


def error_rows(runs: Iterable[Iterable[Error]], named: Callable[[str], str]) -> dict[str, list[Error | None]]:
    """The worst error of every run by quantity, or by what ``named`` makes of its name; None where a run has none.

    The rows are in the order in which names occur, a row in the order of ``runs``.
    """
    results = [grouped((named(record.quantity), record) for record in run) for run in runs]
    names = dict.fromkeys(name for result in results for name in result)
    return {name: [worst(result[name]) if name in result else None for result in results] for name in names}


def limit_words(records: Iterable[Error | None]) -> str:
    """The limits of records as text with commas, each once, in the order of the settings; "" without any."""
    limits = {record.setting: record.limit for record in records if record is not None and record.limit}
    return ", ".join(dict.fromkeys(numbers.bound(limits[name]) for name in sorted(limits, key=setting_rank)))


def error_cell(record: Error | None) -> TableCell | str:
    """The cell of an error, or of its verdict's word without one, with the verdict's sign, and the reason as a tooltip.

    For None it is a dash.
    """
    if record is None:
        return numbers.ABSENT
    sign = RUNS[record.outcome]
    words = sign.word if record.error_max is None else f"{numbers.steady_error(record.error_max)} {sign.symbol}"
    return TableCell(words, sign.style, sign.colour, tooltip=record.detail)


def reasons(records: Iterable[Error], place: Callable[[Error], str]) -> list[str]:
    """Details of records as sentences, "drake tuned, phi: it diverged.", each once per engine with settings, places.

    ``place`` names a record's place, "" for none. Records without a detail are left out.
    """
    groups = grouped(((record.engine, record.detail), record) for record in records if record.detail)
    lines = []
    for (engine, detail), alike in groups.items():
        settings = ", ".join(dict.fromkeys(record.setting for record in alike))
        where = ", ".join(dict.fromkeys(filter(None, map(place, alike))))
        lines.append(f"{engine} {settings}{f', {where}' if where else ''}: {detail.removesuffix('.')}.")
    return lines


def remedies(runs: Iterable[Sequence[Error]], place: Callable[[Error], str] = lambda _: "") -> list[str]:
    """Advice on runs over their limits as sentences, each once per engine, with its settings and places.

    A run is its records; ``place`` names the place of its first, by default "", none.
    """
    return reasons([run[0]._replace(detail=remedy(run)) for run in runs if run], place)


def _runs_table(view: View, regime: Regime) -> Table:
    """The table of a regime's runs that made steps: how each was made, what it cost, and the origin of its figures."""
    made = {run.run: run for run in view.results.runs}
    rows = tuple(
        (
            f"{run.engine} {run.setting}",
            str(run.steps),
            numbers.seconds(run.seconds),
            numbers.seconds(run.setup_seconds),
            "; ".join(filter(None, (origin_words(errors, run.runs), computed_or_shared(errors)))),
            settings_words(run.details),
        )
        for errors in view.runs(regime)
        if (run := made[errors[0].run]).steps
    )
    head = ("run", "steps", "stepping", "set-up", "figures of", "as its adapter states it")
    beside = concurrency_note(view.results.document["environment"])
    caption = f"{regime.name}: stepping alone, measured once{f' {beside}' if beside else ''}, and set-up beside it."
    return Table(caption, head, rows, align="lrrrl")


def settings_words(details: Mapping[str, Any]) -> str:
    """The settings of an engine as its adapter states them, by name, in words: "step 1e-4, scheme …"."""
    table = {name: numbers.printed(value) if isinstance(value, float) else value for name, value in details.items()}
    return ", ".join(f"{plain(name)} {value}" for name, value in table.items())


# All errors of one mechanism at a glance: a dot per run and quantity.


ROW, FRAME = 0.22, 1.0  # inches of a row and of all else
MARKERS: Final = {"circle": "o", "square": "s", "diamond": "D", "triangle-up": "^", "triangle-down": "v",
                  "cross": "P", "x": "X"}  # fmt: skip
# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR: Final = 1e-16


def errors_figure(view: View, regime: Regime) -> Figure:
    """The errors under a regime over their limits on a log axis: a row per family, in it a lane per engine.

    A mark is an error of a run that has a limit: naive is open, best outlined. A line is at 1.
    """
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    known = [record for record in view.of(regime) if record.error_max is not None and record.limit]
    families = {family(record.quantity) for record in known}
    rows = [name for part in columns(view.results) for name in part if name in families]
    lanes, looks_of = sorted({record.engine for record in known}), looks(all_engines(view.results))

    def height(record: Error) -> float:
        """The height of a record's mark: its quantity's row and, within it, its engine's lane."""
        return rows.index(family(record.quantity)) + 0.72 * ((lanes.index(record.engine) + 0.5) / len(lanes) - 0.5)

    def place(figure: Figure) -> None:
        """Draw a mark for every record, in its engine's colour and symbol, and the limit at 1 into the figure."""
        axes = figure.subplots()
        for (engine, setting), mine in grouped(((r.engine, r.setting), r) for r in known).items():
            look = looks_of[engine]
            colour = draw.PALETTE[int(look.ink[1:])]
            edge = draw.INK if LOOKS.get(setting) == "outlined" else colour
            axes.plot([max(share(record), LEAST_ERROR) for record in mine], [*map(height, mine)], MARKERS[look.symbol],
                      color=colour, markeredgecolor=edge, label=f"{engine} {setting}",
                      fillstyle="none" if LOOKS.get(setting) == "open" else "full")  # fmt: skip
        axes.axvline(1.0, color=draw.LIMIT)
        axes.set(xscale="log", ylim=(len(rows) - 0.5, -0.5), xlabel="largest error over its limit")
        axes.set_yticks(range(len(rows)), map(plain, rows))
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

    return draw.drawn(draw.FULL_WIDTH, ROW * len(rows) * (1.0 + 0.2 * max(len(lanes) - 1, 0)) + FRAME, place)


# The curves of every run of a mechanism, and all its errors, as the page's chart takes them: few samples, packed.


EXTREMES: Final = 400  # of the closed form: so many stretches of the samples of all runs
# Errors lie between ``LEAST_ERROR`` and this on their scale.
GREATEST_ERROR: Final = 1e8


def chart_data(view: View) -> dict[str, Any]:
    """Data of the chart when the page opens: every regime's quantities and errors, and the engines, JSON-ready.

    Of each error there are the indices of its quantity, engine and setting, its size over the peak and its limit.
    """
    engines = list(all_engines(view.results))  # an engine has its colour by its place among all
    settings = sorted({record.setting for record in view.records}, key=setting_rank)
    regimes = [_regime(view, regime, engines, settings) for regime in view.regimes]
    axis = ["travel of the drive, m", 1.0] if view.linkage.is_linear else ["crank angle φ, °", math.degrees(1.0)]
    controls = {run.engine for run in view.results.runs if any(error.origin == CONTROL for error in run.errors)}
    shown = looks(engines, controls)
    return {"engines": engines, "looks": shown, "settings": settings, "axis": axis, "regimes": regimes}


def curves(view: View) -> dict[str, dict[str, Any]]:
    """The curves that any run gave, JSON-ready, by the indices of regime and quantity: "0-2"."""
    return {
        f"{number}-{place}": _curves(traces)
        for number, regime in enumerate(view.regimes)
        for place, name in enumerate(view.quantities(regime))
        if (traces := view.traces(regime, name))
    }


def _regime(view: View, regime: Regime, engines: Sequence[str], settings: Sequence[str]) -> dict[str, Any]:
    """The data of a regime for the chart: conditions, jumps (s), quantities, errors with limits; JSON-ready.

    ``engines`` and ``settings`` are the names to whose indices errors refer.
    """
    records = view.of(regime)
    names = view.quantities(regime)
    first = {record.quantity: record for record in reversed(records)}
    return {
        "name": regime.name,
        "conditions": regime.conditions,
        "jumps": list(regime.motion.jumps) if regime.motion else [],
        "setting": view.shown_setting(regime),
        "quantities": [
            {
                "name": name,
                "title": view.title(name),
                "short": short_title(name),
                "unit": first[name].unit,
                "curves": bool(view.curved(regime, name)),
                "vector": name.startswith(JOINT_FORCE),
            }
            for name in names
        ],
        "errors": [
            [names.index(r.quantity), engines.index(r.engine), settings.index(r.setting), digits(r.error_max), r.limit]
            for r in records
            if r.error_max is not None and r.limit
        ],
    }


def digits(value: float) -> float:
    """An error over the peak rounded to two digits, as it is printed, and at least that of round-off, 1e-16."""
    return float(f"{max(value, LEAST_ERROR):.1e}")


def _curves(traces: Sequence[Trace]) -> dict[str, Any]:
    """The data of one quantity's curves for the chart, JSON-ready: closed form, "truth", and "runs".

    The closed form has time (s), crank angle (rad) and value, a run its time, value and decade of the error; both
    packed.
    """
    every = np.concatenate([[trace.time, trace.angle, trace.reference] for trace in traces], axis=1)
    every = every[:, np.argsort(every[0], kind="stable")]
    chosen = extreme_samples(every[2], EXTREMES)
    return {"truth": packed(*every[:, chosen]), "runs": [_run(trace) for trace in traces]}


def _run(trace: Trace) -> dict[str, Any]:
    """The data of one run's curve for the chart: engine, setting, limit, largest error, and "samples", packed.

    These are time, s, value, SI, and log10 of the error over the peak, where it was compared.
    """
    compared = ~np.isnan(trace.error)
    decades = np.log10(np.clip(trace.error[compared], LEAST_ERROR, GREATEST_ERROR))
    return {
        "engine": trace.record.engine,
        "setting": trace.record.setting,
        "limit": trace.record.limit,
        "largest": digits(trace.record.error_max or 0.0),
        "samples": packed(trace.time[compared], trace.observed[compared], decades),
    }
