"""The report as one self-contained page: opens offline, prints on paper, needs no script and no engine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

from comparisons.campaign.results import Results
from comparisons.runs.files import write_text
from reports.campaign.extra_sections import Beside
from reports.campaign.sections import Section, section
from reports.facts import matrix
from reports.facts.readings import OTHERWISE, VERDICT_SIGNS, met, readings, worded
from reports.facts.views import View, columns, family, title, views
from reports.text import numbers

TEMPLATES = Path(__file__).parents[1] / "templates"


@dataclass(frozen=True)
class Used:
    """How one run was made, and what it cost."""

    run: tuple[str, str, str, str, str]
    steps: int
    seconds: str
    setup: str
    settings: str


def write_page(results: Results, path: Path, others: Sequence[Beside] = ()) -> None:
    """Write the report of a campaign to ``path``, in one step; ``others`` are sections on what else was measured."""
    write_text(path, page(results, others))


def page(results: Results, others: Sequence[Beside] = ()) -> str:
    """The report's HTML."""
    every = views(results)
    quantities, invariants = columns(results)
    return _environment().get_template("page.html").render(
        style=Markup((TEMPLATES / "style.css").read_text(encoding="utf-8")),
        results=results,
        facts=_facts(results),
        command=results.document["command"],
        regimes=list(dict.fromkeys((record.regime, record.conditions) for record in matrix.every_record(results))),
        engines=_engine_versions(results),
        quantities=[(name, title(name), _unit(results, name)) for name in quantities],
        invariants=invariants,
        blocks=matrix.blocks(results),
        standings=matrix.standings(results),
        past_baseline=matrix.past_baseline(results),
        sections=list(_sections(results, every)),
        others=others,
        used=_used(results),
        limits=matrix.limit_rows(results),
        left_out=sum(record.left_out for record in results.records),
        samples=sum(record.samples for record in results.records),
        closure=_closure(every),
        released=list(dict.fromkeys(one.name for view in every for one in view.regimes if one.motion is None)),
        notes=[(view.linkage.title, view.linkage.notes) for view in every if view.linkage.notes],
        met=met,
    )  # fmt: skip


def _sections(results: Results, every: tuple[View, ...]) -> Iterator[Section]:
    """Printed figures stand in a mechanism's first section only, whatever variants ran."""
    tables = readings(results)
    for view in every:
        yield section(view, tables.pop(view.linkage.name, None))


def _unit(results: Results, name: str) -> str:
    return next(record.unit for record in results.records if family(record.quantity) == name)


def _closure(every: tuple[View, ...]) -> float:
    """Largest gap of any joint in the closed form over a turn, m."""
    turning = [view.mechanism.turn for view in every if view.makes_full_turn]
    return max((float(np.max(turn.closure_error())) for turn in turning), default=0.0)


def _facts(results: Results) -> list[tuple[str, str]]:
    """Date, machine and commit, then the versions of everything else on one line."""
    told = dict(results.document["environment"])
    engines = {record.engine for record in results.records}
    first = [(name.capitalize(), told.pop(name)) for name in ("date", "machine", "commit") if name in told]
    rest = ", ".join(f"{name} {version}" for name, version in told.items() if name not in engines)
    return [*first, ("Versions", rest)]


def _engine_versions(results: Results) -> list[tuple[str, str]]:
    found = {record.engine: record.engine_version for record in results.records}
    return [(name, found[name] or "not installed") for name in sorted(found)]


def _used(results: Results) -> list[Used]:
    """One row per run that was made, in the matrix's order."""
    firsts = {record.run: record for record in reversed(matrix.every_record(results))}
    details = results.document["details"]
    return [
        Used(
            run,
            one.steps,
            numbers.seconds(one.seconds),
            numbers.seconds(one.setup_seconds),
            told(details.get("/".join(run), {})),
        )
        for run, one in reversed(firsts.items())
        if one.steps
    ]


def told(details: dict[str, Any]) -> str:
    """Settings as an engine's adapter states them: "step 1e-4, scheme …"."""
    return ", ".join(f"{name.replace('_', ' ')} {_value(value)}" for name, value in details.items())


def _value(value: str | int | float) -> str:
    return numbers.printed(value) if isinstance(value, float) else str(value)


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        figure=numbers.figure,
        bound=numbers.bound,
        printed=numbers.printed,
        error=numbers.error,
        per_cent=numbers.per_cent,
        worded=worded,
        plain=lambda name: name.replace("_", " "),
        verdict_sign=lambda verdict: VERDICT_SIGNS.get(verdict, OTHERWISE)[0],
        verdict_style=lambda verdict: VERDICT_SIGNS.get(verdict, OTHERWISE)[1],
    )
    return environment
