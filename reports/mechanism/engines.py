"""How the engines did on one mechanism: all errors and curves in one chart, tables and costs below it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

from comparisons.judging.limits import grouped
from comparisons.judging.records import Record, Verdict
from reports.charts.judged import JudgedCurve, errors_chart, judged_chart
from reports.document import numbers
from reports.document.parts import RUNS, Bullets, Fold, PageFigure, Part, Section, Table, TableCell, Widget
from reports.document.templates import plain, sentence
from reports.mechanism.curves import chart_data, curves
from reports.records.origins import computed_or_shared, concurrency_note, origin_words
from reports.records.views import Regime, View, anchor, remedy, setting_rank


def engines_section(view: View) -> Section:
    """The half of a mechanism's page that shows what was simulated, or the curves of another tool's file."""
    judged = [JudgedCurve(**row) for row in view.results.document.get("judged_curves", ())]
    parts: list[Part] = [PageFigure(anchor("judged", c.name), c.caption, c.caption, judged_chart([c])) for c in judged]
    parts += [chart(view)] if any(map(view.shown_setting, view.regimes)) else []
    parts += [errors_section(view, regime) for regime in view.regimes]
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
    remedies = (f"{run[0].engine} {run[0].setting} – {words}." for run in runs if (words := remedy(run)))
    reasons = (*_reasons(runs), *remedies)
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
