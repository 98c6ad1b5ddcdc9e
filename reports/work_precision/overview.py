"""Error over time as a chart, a panel for each mechanism: sweeps thin, each engine's front bold, settings marked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from comparisons.work_precision.analysis import apart, on_front
from comparisons.work_precision.places import EngineFacts, PlaceFacts, Regimes
from comparisons.work_precision.records import SETTING, BenchRecord
from reports.document.chart import Array, Chart, Curve, Ink, Panel
from reports.document.parts import Figure
from reports.document.templates import plain

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


def figures(regimes: Regimes, colours: Mapping[str, Ink]) -> tuple[Figure, ...]:
    """A figure for every regime."""
    return tuple(
        Figure(
            regime,
            f"Regime {regime}: largest error over the peak against the time of the stepping. Thin: a method over its "
            "steps; bold: an engine's front, dashed where several runs are extrapolated; broad grey: the front over "
            "all engines; marked: the settings (circle naive, square tuned, star best).",
            f"error over stepping time, {regime}, every engine, {len(places)} mechanisms",
            chart(places, colours),
            wide=True,
        )
        for regime, places in regimes.items()
    )


def chart(places: Sequence[PlaceFacts], colours: Mapping[str, Ink], quantity: str = "") -> Chart:
    """Work and precision of one regime over its mechanisms, in ``quantity`` or in the one each is judged by."""
    panels = tuple(_panel(place, colours, quantity or place.foremost) for place in places)
    columns = min(COLUMNS, len(panels))
    return Chart(panels, height=PANEL * -(-len(panels) // columns), columns=columns, wide=True)


def _panel(place: PlaceFacts, colours: Mapping[str, Ink], quantity: str) -> Panel:
    curves = [*_overall(place.ranked(quantity))]
    for facts in place.engines(quantity):
        curves += _engine(facts, colours[facts.engine])
    title = f"{place.mechanism}: {plain(quantity)}"
    return Panel(tuple(curves), "stepping alone, s", "largest |error| / peak", scale="loglog", title=title)


def _overall(records: Sequence[BenchRecord]) -> Iterator[Curve]:
    """What no engine does better than, as a broad grey staircase."""
    for part, line in zip(apart(records), LINES, strict=True):
        x, y = _places(on_front(part))
        if len(x):
            yield Curve(np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1], ink="reference", line=line, width=5.0)


def _engine(facts: EngineFacts, ink: Ink) -> Iterator[Curve]:
    for sweep in facts.methods:
        x, y = _places(sweep.points.records)
        yield Curve(x, y, ink=ink, line=LINES[sweep.first.is_extrapolated], width=0.6, marker=".")
    fronts = [(_places(on_front(part)), line) for part, line in zip(apart(facts.records), LINES, strict=True)]
    lowest = min((y[-1] for (_, y), _ in fronts if len(y)), default=0.0)
    for (x, y), line in fronts:
        if len(x):
            name = "control" if facts.is_control else facts.engine
            yield Curve(x, y, name=name if y[-1] == lowest else "", ink=ink, line=line, width=1.9)
    for record in facts.records:
        if record.kind == SETTING and record.finished:
            x, y = _places([record])
            yield Curve(x, y, ink=ink, line="", marker=MARKERS.get(record.setting, "D"))


def _places(records: Sequence[BenchRecord]) -> tuple[Array, Array]:
    """Times, s, and errors over the peak of points (n,)."""
    return np.array([one.seconds_min or 0.0 for one in records]), np.array([drawn_error(one) for one in records])


def drawn_error(record: BenchRecord) -> float:
    """The largest error over the peak, between the least and the most that a decade is worth."""
    return min(max(record.error_max or 0.0, LEAST), MOST)
