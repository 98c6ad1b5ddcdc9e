"""Released cranks on a mechanism's page: where they rest, how they settle, their speed."""

from __future__ import annotations

import numpy as np

from analytic.description.crank_motion import RPM
from comparisons.datasheet.sheet import Released, Sheet
from reports.document.chart import Chart, Curve, Panel
from reports.document.parts import Bullets, FigureGroup, PageFigure, Part, Section
from reports.document.templates import lines
from reports.mechanism.shown import page_figure
from reports.records.views import anchor


def released_section(sheet: Sheet) -> Section:
    """What there is to say of every regime of the linkage's own, and its curves."""
    parts: list[Part] = []
    for regime, one in sheet.released.items():
        figures = (_speed(sheet, regime, one), *_last_turn(sheet, regime, one))
        parts.append(
            Section(anchor("released", regime), regime, (Bullets(tuple(sentences(one))), FigureGroup(figures)))
        )
    return Section("released", "Released crank", tuple(parts))


def sentences(one: Released) -> list[str]:
    """What there is to say of a released crank, in this order: rest, rotation, own error, the articles' integrator."""
    return lines("released_sheet", one=one.facts, rpm=RPM)


def _speed(sheet: Sheet, regime: str, one: Released) -> PageFigure:
    """The crank's speed over time."""
    curve = Curve(one.motion["time"], one.motion["omega"] / RPM)
    chart = Chart((Panel((curve,), "time, s", "n, rpm"),), 2.8)
    words = f"Crank speed under {regime}."
    return page_figure(sheet, anchor("released", regime), words, words, chart)


def _last_turn(sheet: Sheet, regime: str, one: Released) -> tuple[PageFigure, ...]:
    """Speed and acceleration over the last whole turn, where the crank ends in one."""
    if not one.last_turn:
        return ()
    degrees = np.degrees(one.last_turn["phi"])
    speed, acceleration = one.last_turn["omega"] / RPM, one.last_turn["epsilon"]
    panels = (
        Panel((Curve(degrees, speed),), "", "n, rpm", turn=True),
        Panel((Curve(degrees, acceleration, ink=1),), "crank angle φ, °", "ε, rad/s²", turn=True),
    )
    caption = f"Its last turn, which ends at φ = {np.degrees(one.facts['end']):.1f}°."
    name = anchor("released", regime, "last-turn")
    return (page_figure(sheet, name, caption, f"last turn under {regime}", Chart(panels, 2.8)),)
