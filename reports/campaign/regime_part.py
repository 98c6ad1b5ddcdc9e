"""The part of a section that shows one regime: every deviation, the histories behind them, a released crank's end."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from reports.campaign.parts import ReportPart, largest_errors, shown
from reports.charts import errors, run_up
from reports.charts.panels import LEAST_ERROR
from reports.charts.released import last_turn_figure
from reports.charts.style import ReportFigure
from reports.document.numbers import ROUND_OFF
from reports.document.numbers import figure as digits
from reports.document.templates import sentence
from reports.facts.released import STEPS, Released, released, sentences
from reports.records.joint_rows import joint_table
from reports.records.views import Regime, View, family, title


def regime_part(view: View, regime: Regime) -> ReportPart:
    """Every deviation of a regime, and the histories behind them."""
    found = released(view, regime)
    figures = [*_deviations(view, regime), *(_history(view, regime, name) for name in run_up.histories(view, regime))]
    figures += _last_turn(view, regime, found) if found else []
    forces = any(record.quantity != family(record.quantity) for record in view.records)
    coarse = STEPS if found and found.coarse else ""
    lead = sentence("regime", regime=regime, setting=view.setting, coarse=coarse, forces=forces)
    lines = tuple(sentences(found)) if found else ()
    return ReportPart(f"Regime {regime.name}", lead, tuple(figures), lines, joint_table(view, regime))


def _last_turn(view: View, regime: Regime, found: Released) -> list[ReportFigure]:
    """Speed and acceleration over the last turn, where the crank ends in one."""
    if found.ending is None:
        return []
    end = math.degrees(float(found.motion.angle(found.motion.duration))) % 360.0
    figure = last_turn_figure(view, regime, found)
    return [shown(view, "last-turn", figure, f"{regime.name}-last-turn", regime=regime, found=found, rpm=RPM, end=end)]


def _deviations(view: View, regime: Regime) -> list[ReportFigure]:
    """All deviations at a glance, where any run gave one."""
    found = [r.error_max for r in view.records if r.regime == regime.name and r.error_max is not None]
    if not found:
        return []
    figure, name = errors.errors_figure(view, regime), f"{regime.name}-errors"
    return [shown(view, "errors", figure, name, regime=regime, smallest=min(found), least=LEAST_ERROR)]


def _history(view: View, regime: Regime, quantity: str) -> ReportFigure:
    _, values = run_up.truth(view, regime, quantity)
    return shown(
        view,
        "history",
        run_up.history_figure(view, regime, quantity),
        f"{regime.name}-{quantity}",
        regime=regime,
        quantity=quantity,
        symbol=run_up.symbol(quantity),
        title=title(quantity),
        span=(_signed(values, np.min(values)), _signed(values, np.max(values))) if len(values) else (),
        unit=next((record.unit for record in view.records if record.quantity == quantity), ""),
        largest=largest_errors(view, regime, quantity),
    )


def _signed(values: NDArray[np.float64], end: np.float64) -> str:
    """An end of a range; what is round-off beside the other end is zero."""
    value = 0.0 if abs(end) < ROUND_OFF * float(np.max(np.abs(values))) else float(end)
    return digits(value).replace("-", "−", 1) if value < 0.0 else digits(value)
