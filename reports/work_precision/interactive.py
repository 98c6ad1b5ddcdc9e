"""Error over cost as a picture to point at: any quantity, over time, steps or work, all told of every point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from comparisons.work_precision.analysis import apart
from comparisons.work_precision.records import SETTING, BenchRecord
from comparisons.work_precision.step_sweep import pareto
from reports.charts.style import FAINT, INK, MUTED, REFERENCE
from reports.document.templates import lines, plain
from reports.work_precision.facts import EngineFacts, PlaceFacts, effort_words
from reports.work_precision.figure import drawn_error
from reports.work_precision.words import KINDS

# The file that the page needs beside it; the pages of one folder share it.
SCRIPT = "plotly.min.js"
HEIGHT = 560
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "triangle-down", "cross", "x", "pentagon")
DASHES = ("solid", "6px,3px")  # of single runs, and of several extrapolated
MARKS = {"naive": ("circle-open", 11), "tuned": ("square", 11), "best": ("star", 15)}
FONT = "Helvetica Neue, Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif"


def _whole(record: BenchRecord) -> float:
    return (record.setup_seconds or 0.0) + (record.seconds_min or 0.0) + (record.readout_seconds or 0.0)


# What the x axis may show: its words, and a point's value.
AXES: dict[str, tuple[str, Any]] = {
    "stepping": ("stepping alone, s (shortest of the repeats)", lambda one: one.seconds_min),
    "all of a run": ("set-up, stepping and read-out, s", _whole),
    "steps": ("time steps, over all runs of a point", lambda one: one.steps or None),
    "solver work": ("what the constraint solver did, in the engine's own unit", lambda one: one.solver_work or None),
}


def script() -> str:
    """The text of the file the page needs."""
    return str(get_plotlyjs())


def bench_html(place: PlaceFacts, colours: Mapping[str, str], key: str) -> str:
    """The picture of one mechanism and regime as a part of a page that has loaded the script."""
    figure = go.Figure()
    shown: list[dict[str, bool | str]] = []
    for quantity in place.quantities:
        for trace, visible in _traces(place, quantity, colours):
            trace.visible = visible if quantity == place.foremost else False
            figure.add_trace(trace)
            shown.append({"quantity": quantity, "visible": visible})
    _lay_out(figure, place, shown)
    shown_as = {"displaylogo": False, "responsive": True}
    return str(figure.to_html(full_html=False, include_plotlyjs=False, div_id=key, config=shown_as))


def _traces(place: PlaceFacts, quantity: str, colours: Mapping[str, str]) -> list[tuple[go.Scatter, bool | str]]:
    """All lines and marks of a quantity, each with whether it shows from the start."""
    ranked = enumerate(apart(place.ranked(quantity)))
    found: list[tuple[go.Scatter, bool | str]] = [(_front(part, kind), True) for kind, part in ranked if part]
    for facts in place.engines(quantity):
        ink = colours[facts.engine]
        for number, sweep in enumerate(facts.sweeps):
            own = facts.is_own(sweep.first)
            found.append((_sweep(facts, sweep.points.records, ink, number, own), True if own else "legendonly"))
        found += [(_setting(facts, one, ink), True) for one in facts.records if one.kind == SETTING and one.finished]
        for kind, records in enumerate(apart(facts.records)):
            if any(record.finished for record in records):
                found.append((_engine_front(facts, records, ink, kind), True))
    return found


def _sweep(facts: EngineFacts, records: Sequence[BenchRecord], ink: str, number: int, own: bool) -> go.Scatter:
    line = {"color": ink, "width": 1.2, "dash": DASHES[records[0].is_extrapolated] if own else "dot"}
    marker = {"color": ink, "size": 6 if own else 5, "symbol": SYMBOLS[number % len(SYMBOLS)]}
    name = f"{facts.label}: {facts.way(records[0])}"
    return go.Scatter(**_points(records), mode="lines+markers", name=name, line=line, marker=marker, opacity=0.8)


def _setting(facts: EngineFacts, record: BenchRecord, ink: str) -> go.Scatter:
    symbol, size = MARKS.get(record.setting, ("hexagon", 11))
    line = {"color": ink if symbol.endswith("-open") else INK, "width": 1.2}
    marker = {"color": ink, "size": size, "symbol": symbol, "line": line}
    name = f"{facts.label}: setting {facts.way(record)}"
    return go.Scatter(**_points([record]), mode="markers", name=name, marker=marker)


def _engine_front(facts: EngineFacts, records: Sequence[BenchRecord], ink: str, kind: int) -> go.Scatter:
    """An engine's front in single runs or in several, bold, with its name at the lower end."""
    text = {"textposition": "middle right", "cliponaxis": False, "textfont": {"color": ink, "size": 13}}
    line = {"color": ink, "width": 3, "dash": DASHES[kind]}
    places = _fronts(records, f"&nbsp;&nbsp;&nbsp;{facts.label}{', extrapolated' if kind else ''}")
    name = f"{facts.label}: front, {KINDS[kind]}"
    return go.Scatter(**places, **text, mode="lines+text", name=name, line=line, hoverinfo="skip")


def _front(records: Sequence[BenchRecord], kind: int) -> go.Scatter:
    """The front over all engines, in single runs or in several; none over solver work, whose units differ."""
    places = _fronts(records, "")
    places["meta"]["solver work"] = ([], [], [])
    line = {"color": REFERENCE, "width": 9, "shape": "hv", "dash": DASHES[kind]}
    name = f"front over all engines, {KINDS[kind]}"
    return go.Scatter(**places, mode="lines", name=name, line=line, opacity=0.5, hoverinfo="skip")


def _fronts(records: Sequence[BenchRecord], label: str) -> dict[str, Any]:
    """The points that no other beats, for each of the axes, with a label on the last one."""
    found = {}
    for name, (_, value) in AXES.items():
        counted = [one for one in records if one.finished and value(one)]
        kept = pareto([value(one) for one in counted], [one.error_max or 0.0 for one in counted])
        front = sorted((one for one, keep in zip(counted, kept, strict=True) if keep), key=value)
        words = [*[""] * (len(front) - 1), label] if front else []
        found[name] = ([value(one) for one in front], [drawn_error(one) for one in front], words)
    x, y, words = found["stepping"]
    return {"x": x, "y": y, "text": words, "meta": found}


def _points(records: Sequence[BenchRecord]) -> dict[str, Any]:
    """Places and words of points; ``meta`` keeps x, y and text for every choice of the x axis."""
    heights = [drawn_error(record) for record in records]
    return {
        "x": [record.seconds_min for record in records],
        "y": heights,
        "meta": {name: ([value(one) for one in records], heights, None) for name, (_, value) in AXES.items()},
        "hovertext": [_hover(record) for record in records],
        "hovertemplate": "%{hovertext}<extra></extra>",
    }


def _hover(record: BenchRecord) -> str:
    """Everything a record holds, a line for each thing."""
    effort = effort_words(record.effort, record.effort_unit)
    return "<br>".join(lines("benchmark_point", record=record, effort=effort))


def _lay_out(figure: go.Figure, place: PlaceFacts, shown: Sequence[dict[str, bool | str]]) -> None:
    axis = {"type": "log", "exponentformat": "power", "showgrid": True, "gridcolor": FAINT, "zeroline": False,
            "linecolor": MUTED, "ticks": "outside", "tickcolor": MUTED, "dtick": 1}  # fmt: skip
    figure.update_layout(
        template="none",
        height=HEIGHT,
        font={"family": FONT, "size": 13, "color": INK},
        margin={"l": 80, "r": 10, "t": 56, "b": 60},
        hoverlabel={"bgcolor": "white", "font": {"size": 12, "color": INK}, "align": "left"},
        legend={"font": {"size": 11.5}, "itemsizing": "constant", "tracegroupgap": 2},
        xaxis={**axis, "title": {"text": AXES["stepping"][0]}},
        yaxis={**axis, "title": {"text": "largest |error| / peak"}, "dtick": 2},
        updatemenus=[_quantity_menu(place, shown), _axis_menu(figure)],
    )
    figure.update_traces(meta=None)  # the menu has the values now


def _quantity_menu(place: PlaceFacts, shown: Sequence[dict[str, bool | str]]) -> dict[str, Any]:
    buttons = []
    for name in place.quantities:
        visible = [one["visible"] if one["quantity"] == name else False for one in shown]
        buttons.append({"label": plain(name), "method": "restyle", "args": [{"visible": visible}]})
    return _menu(buttons, 0.0, place.quantities.index(place.foremost))


def _axis_menu(figure: go.Figure) -> dict[str, Any]:
    buttons = [
        {"label": f"over {name}", "method": "update", "args": [_places(figure, name), {"xaxis.title.text": words}]}
        for name, (words, _) in AXES.items()
    ]
    return _menu(buttons, 0.22, 0)


def _places(figure: go.Figure, name: str) -> dict[str, list[Any]]:
    """Where all traces are over one choice of the x axis."""
    chosen = [trace.meta[name] for trace in figure.data]
    return {key: [one[place] for one in chosen] for place, key in enumerate(("x", "y", "text"))}


def _menu(buttons: Sequence[dict[str, Any]], x: float, active: int) -> dict[str, Any]:
    return {"buttons": list(buttons), "x": x, "xanchor": "left", "y": 1.02, "yanchor": "bottom", "active": active,
            "bgcolor": "white", "bordercolor": MUTED, "font": {"size": 12}, "pad": {"t": 0, "b": 2}}  # fmt: skip
