"""The report as one self-contained page: opens offline, prints on paper, needs no script and no engine."""

from __future__ import annotations

import gc
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from analytic.errors import LinkproofError
from comparisons.campaign.results import Results
from comparisons.runs.failures import Lost
from comparisons.runs.files import write_text
from comparisons.runs.workers import run_jobs, usual_processes
from reports.campaign.extra_sections import ExtraSection
from reports.campaign.sections import mechanism_section
from reports.document import numbers
from reports.document.signs import PUBLISHED
from reports.document.tables import ReportTable
from reports.document.templates import plain, render
from reports.facts.readings import Readings, met, readings_of
from reports.records import matrix
from reports.records.environment import environment_facts
from reports.records.readouts import readout_table
from reports.records.views import View, columns, family, title, views


def write_page(
    results: Results, path: Path, others: Sequence[ExtraSection] = (), *, processes: int | None = None
) -> None:
    """Write the report of a campaign to ``path``, in one step; arguments as for ``page``."""
    write_text(path, page(results, others, processes=processes))


def page(results: Results, others: Sequence[ExtraSection] = (), *, processes: int | None = None) -> str:
    """The report's HTML; ``others`` are sections on what else was measured.

    Its figures are drawn in ``processes`` worker processes, by default one per core; with 0, or where no process can be
    started, they are drawn here.
    """
    every = views(results)
    quantities, invariants = columns(results)
    return render(
        "page.html",
        results=results,
        facts=_facts(results),
        command=results.document["command"],
        judgement=results.document.get("judgement", []),
        quantities=[(name, title(name), _unit(results, name)) for name in quantities],
        invariants=invariants,
        blocks=matrix.blocks(results),
        standings=matrix.standings(results),
        past_baseline=matrix.past_baseline(results),
        views=every,
        sections=_sections(results, processes),
        others=others,
        settings=_settings(results),
        readouts=[readout_table(name, told) for name, told in results.document["readouts"].items()],
        limits=matrix.limit_table(results),
        left_out=sum(record.left_out for record in results.records),
        samples=sum(record.samples for record in results.records),
        closure=_closure(every),
        released=list(dict.fromkeys(one.name for view in every for one in view.regimes if one.motion is None)),
        notes=[(view.linkage.title, view.linkage.notes) for view in every if view.linkage.notes],
    )


def _sections(results: Results, processes: int | None) -> list[Markup]:
    """The mechanisms' sections in order, the longest begun first: drawing figures is most of a report's work."""
    every = views(results)
    order = sorted(range(len(every)), key=lambda number: -len(every[number].records))
    jobs = [(number,) for number in order]
    count = usual_processes(len(jobs)) if processes is None else processes
    drawn: dict[int, Markup] = {}
    with suppress(LinkproofError):
        for job, html in run_jobs(partial(section, results), jobs, processes=count):
            if not isinstance(html, Lost):
                drawn[order[job]] = html
    return [drawn[n] if n in drawn else section(results, n) for n in range(len(every))]


def section(results: Results, number: int) -> Markup:
    """The section of one mechanism; printed figures stand in its first one only, whatever variants ran.

    The garbage collector waits meanwhile: its walks through the parts of every figure take an eighth of the time.
    """
    gc.disable()
    try:
        found = mechanism_section(views(results)[number], _readings(results, number))
        return render("section.html", **found, met=met, signs=PUBLISHED)
    finally:
        gc.enable()


def _readings(results: Results, number: int) -> Readings | None:
    names = [linkage.name for linkage in results.linkages]
    return readings_of(results, names[number]) if names.index(names[number]) == number else None


def _unit(results: Results, name: str) -> str:
    return next(record.unit for record in results.records if family(record.quantity) == name)


def _closure(every: tuple[View, ...]) -> float:
    """Largest gap of any joint in the closed form over a turn, m."""
    turning = [view.mechanism.turn for view in every if view.makes_full_turn]
    return max((float(np.max(turn.closure_error())) for turn in turning), default=0.0)


def _facts(results: Results) -> list[tuple[str, str]]:
    """Everything that decides a figure or a time of the report."""
    engines = {record.engine: record.engine_version or "not installed" for record in results.records}
    regimes = dict.fromkeys((record.regime, record.conditions) for record in matrix.every_record(results))
    return [
        ("Command", Markup("<code>{}</code>").format(results.document["command"])),
        ("Mechanisms", ", ".join(f"{linkage.name} ({linkage.variant})" for linkage in results.linkages)),
        ("Regimes", Markup("<br>").join(f"{name}: {conditions}" for name, conditions in regimes)),
        ("Results of", ", ".join(sorted(engines)))
        if "judgement" in results.document
        else ("Engines", ", ".join(f"{name} {engines[name]}" for name in sorted(engines))),
        *environment_facts(results.document["environment"], leave_out=engines),
    ]


def _settings(results: Results) -> ReportTable:
    """How each run was made, and what it cost; in the matrix's order."""
    firsts = {record.run: record for record in matrix.every_record(results) if record.steps}
    details = results.document["details"]
    rows = tuple(
        (
            f"{run[0]} ({run[1]})",
            *run[2:],
            str(one.steps),
            numbers.seconds(one.seconds),
            numbers.seconds(one.setup_seconds),
            words_of(details.get("/".join(run), {})),
        )
        for run, one in firsts.items()
    )
    caption = "How each run was made and what it cost: stepping alone, measured once, and set-up beside it."
    head = ("Mechanism", "Regime", "Engine", "Setting", "Steps", "Stepping", "Set-up", "As the adapter states it")
    return ReportTable(caption, head, rows or (("No run was made.", *[""] * 7),), align="llllrrrl")


def words_of(details: dict[str, Any]) -> str:
    """Settings as an engine's adapter states them: "step 1e-4, scheme …"."""
    return ", ".join(f"{plain(name)} {_value(value)}" for name, value in details.items())


def _value(value: str | int | float) -> str:
    return numbers.printed(value) if isinstance(value, float) else str(value)
