"""How the engines did on one mechanism: all errors and curves in one chart, tables and costs below it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from comparisons.motion.thinning import extreme_samples
from comparisons.trials.judging.limits import grouped
from comparisons.trials.judging.quantities import JOINT_FORCE
from comparisons.trials.judging.records import CONTROL, Error, Verdict
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


def errors_chart_widget(view: View) -> tuple[Widget, ...]:
    """The chart of a mechanism as the only member; () where no run gave an error."""
    return (chart(view),) if any(map(view.shown_setting, view.regimes)) else ()


def is_imported(view: View) -> bool:
    """Whether the results are those of another tool's file."""
    return "judgement" in view.results.document


def chart(view: View) -> Widget:
    """The widget of all errors and curves; its regime, quantity, engines and settings can be chosen.

    It opens with the curves of the worst signal of a judged file, with every error of engines.
    """
    further = curves(view)
    first = next(iter(further), "")
    shown = [record for record in view.records if is_imported(view) and record.error_max is not None]
    opens = "/".join((worst(shown).regime, worst(shown).quantity)) if shown else ""
    data = {**chart_data(view), "opens": opens, "first": first, "curves": further.pop(first, None)}
    label = "Errors and curves of every engine"
    return Widget("curves", "curves", label, data, further)


def errors_section(view: View, regime: Regime) -> Fold:
    """The part with every error of a regime in figures, and the reason for each missing one."""
    runs = view.runs(regime)
    shown = [run for run in runs if any(record.error_max is not None for record in run)]
    parts: list[Part] = [_errors_table(view, regime, shown)] if shown else []
    remedies = (f"{run[0].engine} {run[0].setting} – {words}." for run in runs if (words := remedy(run)))
    reasons = (*_reasons(runs), *remedies)
    under = f" under {regime.name}" if len(view.regimes) > 1 else ""
    return Fold(f"Every error{under} in figures", (*parts, *([Bullets(reasons)] if reasons else [])))


def _errors_table(view: View, regime: Regime, runs: Sequence[Sequence[Error]]) -> Table:
    """The table of a regime's errors: quantities, then invariants, down; engines and settings across."""
    groups = tuple((name, len(list(part))) for name, part in groupby(runs, key=lambda run: run[0].engine))
    result = [{record.quantity: record for record in run} for run in runs]
    rows = tuple(
        (
            *_row_head(view, [run[name] for run in result if name in run]),
            *(_error_cell(run.get(name)) for run in result),
        )
        for name in view.quantities(regime)
        if any(name in run for run in result)
    )
    note = sentence("matrix_note", imported=is_imported(view)) if regime == view.regimes[0] else ""
    head = ("quantity", "limit", *(run[0].setting for run in runs))
    caption = f"{regime.name}: {regime.conditions}. Largest error over the closed form's peak."
    return Table(caption, head, rows, note=note, groups=(("", 2), *groups), style="matrix")


def _row_head(view: View, records: Sequence[Error]) -> tuple[TableCell, str]:
    """The first cells of a row: the quantity with its peak, and its limits by setting."""
    quantity = records[0].quantity
    measured = records if quantity not in view.invariants else ()
    peak = next((f"{numbers.figure(record.peak)} {record.unit}" for record in measured if record.peak), "")
    limits = {r.setting: r.limit for r in records if r.limit}
    words = dict.fromkeys(numbers.bound(limits[name]) for name in sorted(limits, key=setting_rank))
    return TableCell(view.title(quantity), note=peak), ", ".join(words)


def _error_cell(record: Error | None) -> TableCell | str:
    """The cell of an error, with a sign if it is over its limit and the reason as a tooltip if it failed."""
    if record is None:
        return numbers.ABSENT
    sign = RUNS[record.outcome]
    if record.outcome == Verdict.PASSED.value:
        return TableCell(numbers.steady_error(record.error_max), style=sign.style)
    words = sign.symbol if record.error_max is None else f"{numbers.steady_error(record.error_max)} {sign.symbol}"
    return TableCell(words, style=sign.style, tooltip=record.detail or sign.word)


def _reasons(runs: Sequence[Sequence[Error]]) -> tuple[str, ...]:
    """Reasons why runs or quantities have no error, each once, with engine and setting."""
    rows = []
    for run in runs:
        without = [record for record in run if record.error_max is None]
        for record in without:
            names = "" if len(without) == len(run) else f", {plain(record.quantity)}"
            reason = f"{RUNS[record.outcome].word}: {record.detail}".removesuffix(": ")
            rows.append(((record.engine, reason), record.setting + names))
    groups = grouped(dict.fromkeys(rows))
    return tuple(f"{engine} {'; '.join(who)} – {reason}." for (engine, reason), who in groups.items())


def _runs_table(view: View, regime: Regime) -> Table:
    """The table of a regime's runs: how each was made, what it cost, and the origin of its figures."""
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
    """The settings of an engine as its adapter states them, in words: "step 1e-4, scheme …"."""
    table = {name: numbers.printed(value) if isinstance(value, float) else value for name, value in details.items()}
    return ", ".join(f"{plain(name)} {value}" for name, value in table.items())


# All errors of one mechanism at a glance: a dot per run and quantity, the limits as strokes.


ROW, FRAME = 0.22, 1.0  # inches of a row and of all else
MARKERS: Final = {"circle": "o", "square": "s", "diamond": "D", "triangle-up": "^", "triangle-down": "v",
                  "cross": "P", "x": "X"}  # fmt: skip
# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR: Final = 1e-16


def errors_figure(view: View, regime: Regime) -> Figure:
    """The errors under a regime, shares of the peak on a log axis: a row per family, in it a lane per engine.

    A mark is the worst of its family in a run: naive is open, best outlined. Ticks are the limits of the setting shown.
    """
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    known = [record for record in view.of(regime) if record.error_max is not None]
    groups = grouped(((*record.run, family(record.quantity)), record) for record in known)
    records = [worst(group) for group in groups.values()]
    families = {family(record.quantity) for record in records}
    rows = [name for part in columns(view.results) for name in part if name in families]
    lanes, looks_of = sorted({record.engine for record in records}), looks(all_engines(view.results))

    def height(record: Error) -> float:
        """The height of a record's mark: its quantity's row and, within it, its engine's lane."""
        return rows.index(family(record.quantity)) + 0.72 * ((lanes.index(record.engine) + 0.5) / len(lanes) - 0.5)

    def place(figure: Figure) -> None:
        """Draw a mark for every record, in its engine's colour and symbol."""
        axes = figure.subplots()
        for (engine, setting), mine in grouped(((r.engine, r.setting), r) for r in records).items():
            look = looks_of[engine]
            colour = draw.PALETTE[int(look.ink[1:])]
            edge = draw.INK if LOOKS.get(setting) == "outlined" else colour
            axes.plot([max(r.error_max or 0.0, LEAST_ERROR) for r in mine], [*map(height, mine)], MARKERS[look.symbol],
                      color=colour, markeredgecolor=edge, label=f"{engine} {setting}",
                      fillstyle="none" if LOOKS.get(setting) == "open" else "full")  # fmt: skip
        limits = [(r.limit, height(r)) for r in records if r.setting == view.shown_setting(regime) and r.limit]
        axes.plot(*np.array(limits, dtype=float).reshape(-1, 2).T, "|", color=draw.LIMIT, label="limit")
        axes.set(xscale="log", ylim=(len(rows) - 0.5, -0.5), xlabel="largest |error| / peak")
        axes.xaxis.set_major_formatter("{x:.0e}")
        axes.set_yticks(range(len(rows)), map(plain, rows))
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

    return draw.drawn(draw.FULL_WIDTH, ROW * len(rows) * (1.0 + 0.2 * max(len(lanes) - 1, 0)) + FRAME, place)


# The curves of every run of a mechanism, and all its errors, as the page's chart takes them: few samples, packed.


EXTREMES: Final = 400  # of the closed form: so many stretches of the samples of all runs
# Errors lie between ``LEAST_ERROR`` and this on their scale.
GREATEST_ERROR: Final = 1e8


def chart_data(view: View) -> dict[str, Any]:
    """Data of the chart when the page opens: every regime's quantities and errors, and the engines, JSON-ready.

    Of each error there are the numbers of its quantity, engine and setting, its size and its limit.
    """
    engines = list(all_engines(view.results))  # an engine has its colour by its place among all
    settings = sorted({record.setting for record in view.records}, key=setting_rank)
    regimes = [_regime(view, regime, engines, settings) for regime in view.regimes]
    axis = ["travel of the drive, m", 1.0] if view.linkage.is_linear else ["crank angle φ, °", math.degrees(1.0)]
    controls = {run.engine for run in view.results.runs if any(error.origin == CONTROL for error in run.errors)}
    shown = looks(engines, controls)
    return {"engines": engines, "looks": shown, "settings": settings, "axis": axis, "regimes": regimes}


def curves(view: View) -> dict[str, dict[str, Any]]:
    """The curves that any run gave, by regime and quantity, JSON-ready."""
    return {
        f"{number}-{place}": _curves(traces)
        for number, regime in enumerate(view.regimes)
        for place, name in enumerate(view.quantities(regime))
        if (traces := view.traces(regime, name))
    }


def _regime(view: View, regime: Regime, engines: Sequence[str], settings: Sequence[str]) -> dict[str, Any]:
    """The data of a regime for the chart: quantities, errors, limits and jumps, JSON-ready."""
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
    """An error rounded to two digits, as it is printed."""
    return float(f"{max(value, LEAST_ERROR):.1e}")


def _curves(traces: Sequence[Trace]) -> dict[str, Any]:
    """The data of one quantity's curves for the chart, JSON-ready: closed form and runs.

    The closed form has time (s), crank angle (rad) and value, a run its time, value and decade of the error.
    """
    every = np.concatenate([[trace.time, trace.angle, trace.reference] for trace in traces], axis=1)
    every = every[:, np.argsort(every[0], kind="stable")]
    chosen = extreme_samples(every[2], EXTREMES)
    return {"truth": packed(*every[:, chosen]), "runs": [_run(trace) for trace in traces]}


def _run(trace: Trace) -> dict[str, Any]:
    """The data of one run's curve for the chart, packed."""
    compared = ~np.isnan(trace.error)
    decades = np.log10(np.clip(trace.error[compared], LEAST_ERROR, GREATEST_ERROR))
    return {
        "engine": trace.record.engine,
        "setting": trace.record.setting,
        "limit": trace.record.limit,
        "largest": digits(trace.record.error_max or 0.0),
        "samples": packed(trace.time[compared], trace.observed[compared], decades),
    }
