"""The parts of a mechanism's section: figures under one heading, each with the sentence that says what to see."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from analytic.dynamics.reduced import reduced_inertia
from analytic.numerics.extremes import extremes
from analytic.turn.unit_functions import stroke, unit_functions
from reports.drawing import errors, inertia, kinematics, run_up
from reports.drawing.last_turn import last_turn_figure
from reports.drawing.panels import LEAST_ERROR
from reports.drawing.style import picture
from reports.facts.joint_rows import joint_table
from reports.facts.released import STEPS, Released, released, sentences
from reports.facts.views import Regime, Trace, View, anchor, family, title
from reports.text.numbers import ROUND_OFF, bound, error, figure
from reports.text.tables import ReportTable


@dataclass(frozen=True)
class ReportFigure:
    """A figure: the sentence before it, its drawing, and whether it takes the page's whole width."""

    lead: str
    drawing: Markup
    wide: bool = False


@dataclass(frozen=True)
class ReportPart:
    """Figures under one heading, with a sentence before them, ``lines`` of a list and a table after those."""

    heading: str
    lead: str
    figures: tuple[ReportFigure, ...]
    lines: tuple[str, ...] = ()
    table: ReportTable | None = None


def shown(
    view: View, name: str, lead: str, draw: Callable[[], Figure], description: str, *, wide: bool = False
) -> ReportFigure:
    """A figure of a mechanism; ``description`` is what a reader without pictures gets."""
    key = anchor(view.key, name)
    alt = f"{view.linkage.title} ({view.linkage.variant}): {description}"
    return ReportFigure(lead, picture(draw(), key, alt), wide)


def kinematics_part(view: View) -> ReportPart:
    """S, v, a, and the unit functions against harmonics."""
    _, values = kinematics.turn_at_final_speed(view)
    fastest, hardest = (float(np.max(np.abs(values[name]))) for name in ("v", "a"))
    point = view.linkage.output.point if view.linkage.output else ""
    speed = view.speed_words
    means = unit_functions(view.mechanism).deviations
    named = ", ".join(f"{name} {100.0 * mean:.2f} %" for name, mean in zip("Sva", means, strict=True))
    figures = (
        shown(
            view,
            "output",
            f"S from top dead centre, v and a over the crank angle at {speed}; dots mark the extremes.",
            lambda: kinematics.output_figure(view),
            "displacement, velocity and acceleration of the output over the crank angle",
        ),
        shown(
            view,
            "units",
            "Normalised motion against simple harmonic motion (dashed).",
            lambda: kinematics.unit_figure(view),
            "unit functions of the output against harmonics",
        ),
        shown(
            view,
            "differences",
            f"Unit function less harmonic; mean absolute difference over the turn: {named}.",
            lambda: kinematics.difference_figure(view),
            "differences of unit functions and harmonics",
            wide=True,
        ),
    )
    lead = (
        f"At {speed} the output {point} has a stroke of {figure(stroke(view.mechanism) * 1e3)} mm and reaches "
        f"{figure(fastest)} m/s and {figure(hardest)} m/s² at most; all curves are the closed form."
    )
    return ReportPart("Motion of the output", lead, figures)


def inertia_part(view: View) -> ReportPart:
    """Jeq by all methods, by group and by link."""
    found = extremes(lambda phi: reduced_inertia(view.mechanism.sweep(phi)))
    lead = (
        f"Jeq lies between {figure(found.minimum)} kg m² at {math.degrees(found.minimum_angle):.1f}° and "
        f"{figure(found.maximum)} kg m² at {math.degrees(found.maximum_angle):.1f}°, mean {figure(found.mean)} kg m², "
        f"relative pulsation {100.0 * found.relative_pulsation:.2f} %."
    )
    figures = (
        *_methods(view),
        shown(
            view,
            "groups",
            "Where Jeq comes from: the class I crank and each Assur group, one on the other.",
            lambda: inertia.groups_figure(view),
            "Jeq by Assur group over the crank angle",
        ),
        shown(
            view,
            "links",
            f"What varies: Jeq of each link by itself.{_constant_share(view)}",
            lambda: inertia.links_figure(view),
            "Jeq by link over the crank angle",
        ),
    )
    return ReportPart("Reduced moment of inertia Jeq", lead, figures)


def _methods(view: View) -> list[ReportFigure]:
    """Jeq by every method, where the campaign asked for it."""
    if not any(record.quantity == "Jeq" for record in view.records):
        return []
    regime = view.regimes[0]
    lead = f"Jeq by every method over the last turn of {regime.name}, and beneath how far each is off. "
    return [
        shown(
            view,
            "methods",
            lead + _largest(view, view.traces(regime, "Jeq")),
            lambda: inertia.methods_figure(view),
            "Jeq of all methods and their deviation over the crank angle",
            wide=True,
        )
    ]


def _constant_share(view: View) -> str:
    parts = inertia.links_inertia(view, np.linspace(0.0, 2.0 * np.pi, 25))
    constant = [name.replace("_", " ") for name, values in parts.items() if not inertia.varies(values)]
    return f" The constant share ({', '.join(constant)}) is left out." if constant else ""


def regime_part(view: View, regime: Regime) -> ReportPart:
    """Every deviation of a regime, and the histories behind them."""
    found = released(view, regime)
    figures = [*_deviations(view, regime), *(_history(view, regime, name) for name in run_up.histories(view, regime))]
    figures += _last_turn(view, regime, found) if found else []
    jumps = " Dotted lines: jumps of the crank's acceleration." if regime.jumps else ""
    forces = (
        " Of the joint forces the one nearest its limit is drawn: magnitudes, while the largest deviation is the "
        "vector's."
        if _has_forces(view)
        else ""
    )
    coarse = f" The thin black line is the articles' integrator, {STEPS}." if found and found.coarse else ""
    lead = (
        f"{regime.conditions[:1].upper()}{regime.conditions[1:]}. Grey is the closed form, the engines at setting "
        f"{view.setting} are dashed; beneath stands the upper envelope of |error| over the peak, on a logarithmic "
        f"scale, for every setting that ran.{jumps}{coarse}{forces}"
    )
    lines = tuple(sentences(found)) if found else ()
    return ReportPart(f"Regime {regime.name}", lead, tuple(figures), lines, joint_table(view, regime))


def _last_turn(view: View, regime: Regime, found: Released) -> list[ReportFigure]:
    """Speed and acceleration over the last turn, where the crank ends in one."""
    if found.ending is None:
        return []
    lead = f"The last full turn: n between {found.ending.smallest / RPM:.1f} and {found.ending.largest / RPM:.1f} rpm, "
    lead += f"begun and ended at φ = {math.degrees(float(found.motion.angle(found.motion.duration))) % 360.0:.1f}°."
    draw = partial(last_turn_figure, view, regime, found)
    words = f"crank speed and acceleration over the last turn, {regime.name}"
    return [shown(view, f"{regime.name}-last-turn", lead, draw, words, wide=True)]


def _has_forces(view: View) -> bool:
    return any(record.quantity != family(record.quantity) for record in view.records)


def _deviations(view: View, regime: Regime) -> list[ReportFigure]:
    """All deviations at a glance, where any run gave one."""
    found = [r.error_max for r in view.records if r.regime == regime.name and r.error_max is not None]
    if not found:
        return []
    zeros = f" Smaller than {bound(LEAST_ERROR)} is drawn there." if min(found) < LEAST_ERROR else ""
    return [
        shown(
            view,
            f"{regime.name}-errors",
            f"Every deviation of this regime: the further left of its limit (red stroke), the better.{zeros}",
            lambda: errors.errors_figure(view, regime),
            f"largest deviation of every run by quantity, {regime.name}",
            wide=True,
        )
    ]


def _history(view: View, regime: Regime, quantity: str) -> ReportFigure:
    _, values = run_up.truth(view, regime, quantity)
    unit = next((record.unit for record in view.records if record.quantity == quantity), "")
    span = f"{run_up.symbol(quantity)}, {title(quantity)}"
    if len(values):
        span += f", between {_signed(values, np.min)} and {_signed(values, np.max)} {unit}"
    return shown(
        view,
        f"{regime.name}-{quantity}",
        f"{span}. {_largest(view, view.traces(regime, quantity))}",
        lambda: run_up.history_figure(view, regime, quantity),
        f"{quantity} over time by the closed form and the engines, {regime.name}",
    )


def _signed(values: NDArray[np.float64], end: Callable[[NDArray[np.float64]], np.float64]) -> str:
    """An end of a range; what is round-off beside the other end is nought."""
    value = float(end(values))
    value = 0.0 if abs(value) < ROUND_OFF * float(np.max(np.abs(values))) else value
    return figure(value).replace("-", "−", 1) if value < 0.0 else figure(value)


def _largest(view: View, traces: list[Trace]) -> str:
    """The largest deviation of each engine at the view's setting, over the whole regime."""
    mine = [trace.record for trace in traces if trace.record.setting == view.setting]
    if not mine:
        return f"No engine gave a curve at setting {view.setting}."
    words = ", ".join(f"{record.engine} {error(record.error_max)}" for record in mine)
    return f"Largest deviation at {view.setting}: {words}."
