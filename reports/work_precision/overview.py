"""Error over time as a chart, a panel for each mechanism: sweeps thin, each engine's front bold, settings marked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from comparisons.work_precision.analysis import EngineFacts, MethodSweep, PlaceFacts, Regimes, on_front, split_by_runs
from comparisons.work_precision.records import METHOD, SETTING, BenchRecord
from reports.document.chart import Array, Chart, Curve, Ink, Note, Panel
from reports.document.parts import PageFigure
from reports.document.templates import plain, sentence

# Nothing below round-off is worth a decade, and nothing ten times as large as its own peak one more.
LEAST, MOST = 1e-16, 10.0
COLUMNS, PANEL = 3, 3.2
COLOURS = 6  # of the palette
MARKERS = {"naive": "o", "tuned": "s", "best": "*"}
LINES = ("-", "--")  # of single runs, and of several extrapolated


def inks(labels: Mapping[str, str]) -> dict[str, Ink]:
    """The colours of engines: by name order, as in all of a report, and the control's, which its label names, muted."""
    order = sorted(labels)
    return {name: order.index(name) % COLOURS if labels[name] == name else "muted" for name in labels}


def figures(regimes: Regimes, colours: Mapping[str, Ink]) -> tuple[PageFigure, ...]:
    """A figure for every regime."""
    alt = "error over the time of set-up and stepping, {}, every engine, {} mechanisms"
    return tuple(
        PageFigure(name, sentence("bench_overview", regime=name), alt.format(name, len(places)), chart(places, colours))
        for name, places in regimes.items()
    )


def chart(places: Sequence[PlaceFacts], colours: Mapping[str, Ink]) -> Chart:
    """Work and precision of one regime over its mechanisms, in the quantity each is judged by."""
    panels = tuple(_panel(place, colours) for place in places)
    columns = min(COLUMNS, math.ceil(math.sqrt(len(panels))))
    return Chart(panels, height=PANEL * -(-len(panels) // columns), columns=columns, wide=True)


def _panel(place: PlaceFacts, colours: Mapping[str, Ink]) -> Panel:
    """The front over all engines is a broad grey staircase."""
    fronts = zip(_fronts(place.rankable_records(place.foremost)), LINES, strict=True)
    curves = [
        Curve(np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1], ink="reference", line=line, width=5.0)
        for (x, y), line in fronts
        if len(x)
    ]
    notes = []
    for facts in place.engines(place.foremost):
        curves += _engine(facts, colours[facts.engine])
        notes += [_order_note(sweep) for sweep in facts.sweeps if sweep.order]
    title, names = f"{place.mechanism}: {plain(place.foremost)}", ("set-up and stepping, s", "largest |error| / peak")
    return Panel(tuple(curves), *names, notes=tuple(notes), scale="loglog", title=title)


def _order_note(sweep: MethodSweep) -> Note:
    """The observed order, at the least error of a method."""
    return Note(sweep.least.total_seconds, drawn_error(sweep.least), f"{sweep.order:.0f}")


def _engine(facts: EngineFacts, ink: Ink) -> Iterator[Curve]:
    """The curves of one engine: its sweeps, floors, fronts and settings."""
    for sweep in facts.sweeps:
        line = LINES[sweep.first.is_extrapolated]
        yield Curve(*_places(sweep.records), ink=ink, line=line, width=0.6, marker=".")
        if sweep.has_floor:
            yield Curve(*_places([sweep.least]), ink=ink, line="", marker="_", size=11.0)
    fronts = _fronts(facts.records)
    lowest = min((y[-1] for _, y in fronts if len(y)), default=0.0)
    for (x, y), line in zip(fronts, LINES, strict=True):
        if len(x):
            name = "control" if facts.is_control else facts.engine
            yield Curve(x, y, name=name if y[-1] == lowest else "", ink=ink, line=line, width=1.9)
    for record in facts.records:
        if record.kind == SETTING and record.finished:
            yield Curve(*_places([record]), ink=ink, line="", marker=MARKERS.get(record.setting, "D"))


def _fronts(records: Sequence[BenchRecord]) -> list[tuple[Array, Array]]:
    """The front of methods' single runs, and that of several extrapolated; a setting alone is no front."""
    return [_places(on_front(part)) for part in split_by_runs(record for record in records if record.kind == METHOD)]


def _places(records: Sequence[BenchRecord]) -> tuple[Array, Array]:
    """Times, s, and errors over the peak of points (n,)."""
    return np.array([record.total_seconds for record in records]), np.array([drawn_error(record) for record in records])


def drawn_error(record: BenchRecord) -> float:
    """The largest error over the peak, between the least and the most that a decade is worth."""
    return min(max(record.error_max or 0.0, LEAST), MOST)
