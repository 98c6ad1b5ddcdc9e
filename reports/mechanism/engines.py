"""How the engines did on one mechanism: all errors and curves in one chart, tables and costs below it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any, Final

from comparisons.datasheet.instants import extreme_samples
from comparisons.datasheet.sheet import ByName
from comparisons.faults.symptoms import probable_faults
from comparisons.judging.limits import grouped
from comparisons.judging.records import Record, Verdict
from reports.charts.judged import JudgedCurve, errors_chart, judged_chart
from reports.document import numbers
from reports.document.chart import Chart, Curve, Panel
from reports.document.parts import RUNS, Bullets, Fold, PageFigure, Part, Section, Table, TableCell, Widget
from reports.document.templates import plain, sentence
from reports.mechanism.curves import chart_data, curves
from reports.records.origins import computed_or_shared, concurrency_note, origin_words
from reports.records.views import Regime, View, anchor, engines, setting_rank

SHOWN: Final = 300  # stretches of a curve, of which the extremes are drawn


def engines_section(view: View, printed: Mapping[str, ByName]) -> Section:
    """The half of a mechanism's page that shows what was simulated, or the curves of another tool's file.

    ``printed`` are the motions of models as printed, by erratum.
    """
    judged = [JudgedCurve(**row) for row in view.results.document.get("judged_curves", ())]
    parts: list[Part] = [PageFigure(anchor("judged", c.name), c.caption, c.caption, judged_chart([c])) for c in judged]
    parts += [chart(view)] if any(map(view.shown_setting, view.regimes)) else []
    parts += [errors_section(view, regime) for regime in view.regimes]
    parts += _printed_models(view, printed)
    if is_imported(view):
        return Section("engines", "Every error", tuple(parts))
    runs = tuple(_runs_table(view, regime) for regime in view.regimes)
    return Section("engines", "How the engines did", (*parts, Fold("How each run was made, and what it cost", runs)))


def is_imported(view: View) -> bool:
    """Whether the results are those of another tool's file."""
    return "judgement" in view.results.document


def chart(view: View) -> Widget:
    """All errors and all curves: regime, quantity, engines and settings are chosen; curves are loaded when they are."""
    further = curves(view)
    first = next(iter(further), "")
    data = {**chart_data(view), "first": first, "curves": further.pop(first, None)}
    label = "Errors and curves of every engine"
    figures = tuple(errors_figure(view, regime) for regime in view.regimes if view.shown_setting(regime))
    return Widget("curves", "curves", label, data, further, instead=figures)


def errors_figure(view: View, regime: Regime) -> PageFigure:
    """Every error of a regime as a figure."""
    caption = sentence("errors", regime=regime, setting=view.shown_setting(regime))
    alt = f"{view.linkage.title} ({view.linkage.variant}): errors of every quantity and engine under {regime.name}"
    return PageFigure(anchor("errors", regime.name), caption, alt, errors_chart(view, regime))


def errors_section(view: View, regime: Regime) -> Fold:
    """Every error of a regime in figures, and the reason for each missing one."""
    runs = view.runs(regime)
    shown = [run for run in runs if any(record.error_max is not None for record in run)]
    parts: list[Part] = [_errors_table(view, regime, shown)] if shown else []
    reasons = (*_reasons(runs), *_probable_faults(runs))
    under = f" under {regime.name}" if len(view.regimes) > 1 else ""
    return Fold(f"Every error{under} in figures", (*parts, *([Bullets(reasons)] if reasons else [])))


def _errors_table(view: View, regime: Regime, runs: Sequence[Sequence[Record]]) -> Table:
    """Quantities, then invariants, down; engines and settings across."""
    groups = tuple((name, len(list(part))) for name, part in groupby(runs, key=lambda run: run[0].engine))
    result = [{record.quantity: record for record in run} for run in runs]
    rows = tuple(
        (*_row_head(view, [run[name] for run in result if name in run]), *(_cell(run.get(name)) for run in result))
        for name in view.quantities(regime)
        if any(name in run for run in result)
    )
    note = sentence("matrix_note", imported=is_imported(view)) if regime == view.regimes[0] else ""
    head = ("quantity", "limit", *(run[0].setting for run in runs))
    caption = f"{regime.name}: {regime.conditions}. Largest error over the closed form's peak."
    return Table(caption, head, rows, note=note, groups=(("", 2), *groups), style="matrix")


def _row_head(view: View, records: Sequence[Record]) -> tuple[TableCell, str]:
    """The quantity with its peak, and the limits in the order of the settings."""
    quantity = records[0].quantity
    measured = records if quantity not in view.invariants else ()
    peak = next((f"{numbers.figure(record.peak)} {record.unit}" for record in measured if record.peak), "")
    limits = {r.setting: r.limit for r in records if r.limit}
    words = dict.fromkeys(numbers.bound(limits[name]) for name in sorted(limits, key=setting_rank))
    return TableCell(view.title(quantity), note=peak), ", ".join(words)


def _cell(record: Record | None) -> TableCell | str:
    """An error, with a sign where it is over its limit; a failed one has its reason as a tooltip."""
    if record is None:
        return numbers.ABSENT
    sign = RUNS[record.outcome]
    if record.outcome == Verdict.PASSED.value:
        return TableCell(numbers.steady_error(record.error_max), style=sign.style)
    words = sign.symbol if record.error_max is None else f"{numbers.steady_error(record.error_max)} {sign.symbol}"
    return TableCell(words, style=sign.style, tooltip=record.detail or sign.word)


def _reasons(runs: Sequence[Sequence[Record]]) -> tuple[str, ...]:
    """Why there is no error of a run or of a quantity of it, each reason once."""
    rows = []
    for run in runs:
        without = [record for record in run if record.error_max is None]
        for record in without:
            names = "" if len(without) == len(run) else f", {plain(record.quantity)}"
            reason = f"{RUNS[record.outcome].word}: {record.detail}".removesuffix(": ")
            rows.append(((record.engine, reason), record.setting + names))
    groups = grouped(dict.fromkeys(rows))
    return tuple(f"{engine} {'; '.join(who)} – {reason}." for (engine, reason), who in groups.items())


def _probable_faults(runs: Sequence[Sequence[Record]]) -> list[str]:
    """The probable fault behind the failing rows of a run, in a sentence."""
    return [f"{run[0].engine} {run[0].setting} – {words}." for run in runs if (words := probable_faults(run))]


def _printed_models(view: View, printed: Mapping[str, ByName]) -> list[Part]:
    """Simulations of the models that the source prints, compared with those of the file's own values."""
    if view.linkage.variant != view.linkage.variants[0]:
        return []
    rows = [row for row in view.results.document.get("errata", []) if row["mechanism"] == view.linkage.name]
    parts: list[Part] = []
    for (name, regime), part in groupby(rows, key=lambda row: (row["erratum"], row["regime"])):
        parts.append(_printed_model_table(list(part)))
        if name in printed:
            parts.append(_printed_figure(view, regime, name, printed[name]))
    return [Fold("Printed models put to the engines", tuple(parts))] if parts else []


def _printed_figure(view: View, regime: str, name: str, motion: ByName) -> PageFigure:
    """The crank's speed by both models and by the engines."""
    at = next((entry for entry in view.regimes if entry.name == regime), None)
    traces = (
        [trace for trace in view.traces(at, "omega") if trace.record.setting == view.shown_setting(at)] if at else []
    )
    names = engines(view.results)
    curves = [Curve(motion["time"], motion["corrected"], "corrected", "reference", width=3.4)]
    for trace in traces:
        few = extreme_samples(trace.observed, SHOWN)
        ink = names.index(trace.record.engine)
        curves.append(Curve(trace.time[few], trace.observed[few], trace.record.engine, ink, "--", 1.0))
    curves.append(Curve(motion["time"], motion["printed"], "as printed", "limit"))
    panel = Panel(tuple(curves), "time, s", "ω, rad/s", names="key")
    caption = f"Crank speed by the corrected model, by the engines and as printed: {name}."
    return PageFigure(anchor("printed", name), caption, caption, Chart((panel,), height=2.8, wide=True))


def _printed_model_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """One model as printed: by how much every engine's crank speed is off it, and off the corrected one."""
    head = ("engine", "off the corrected model", "off the printed model", "supports")
    cells = tuple(
        (
            row["engine"],
            numbers.error(row["deviation_corrected"]),
            numbers.error(row["deviation_printed"]),
            row["reason"] or row["supports"],
        )
        for row in rows
    )
    return Table(sentence("printed_model", row=rows[0]), head, cells, align="lrrl")


def _runs_table(view: View, regime: Regime) -> Table:
    """How every run was made, what it cost and where its figures come from."""
    details = {run.run: run.details for run in view.results.runs}
    rows = tuple(
        (
            f"{run[0].engine} {run[0].setting}",
            str(run[0].steps),
            numbers.seconds(run[0].seconds),
            numbers.seconds(run[0].setup_seconds),
            "; ".join(filter(None, (origin_words(run), computed_or_shared(run)))),
            settings_words(details.get(run[0].run, {})),
        )
        for run in view.runs(regime)
        if run[0].steps
    )
    head = ("run", "steps", "stepping", "set-up", "figures of", "as its adapter states it")
    beside = concurrency_note(view.results.document["environment"])
    caption = f"{regime.name}: stepping alone, measured once{f' {beside}' if beside else ''}, and set-up beside it."
    return Table(caption, head, rows, align="lrrrl")


def settings_words(details: Mapping[str, Any]) -> str:
    """Settings as an engine's adapter states them: "step 1e-4, scheme …"."""
    table = {name: numbers.printed(value) if isinstance(value, float) else value for name, value in details.items()}
    return ", ".join(f"{plain(name)} {value}" for name, value in table.items())
