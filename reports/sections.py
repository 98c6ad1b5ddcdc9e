"""What the page says and shows of one mechanism, put together from the closed form, the records and the figures."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from analytic.dynamics import reduced_inertia
from analytic.extremes import extremes
from analytic.harmonics import stroke, unit_functions
from analytic.linkage import Link
from analytic.regimes import RPM, CrankMotion
from reports.figures import errors, inertia, kinematics, run_up, scheme
from reports.figures.style import picture
from reports.numbers import ABSENT, error, figure
from reports.readings import Readings
from reports.views import Trace, View, engines


@dataclass(frozen=True)
class Shown:
    """A figure: the sentence before it, its drawing, and whether it takes the page's whole width."""

    lead: str
    drawing: Markup
    wide: bool = False


@dataclass(frozen=True)
class Part:
    """Figures under one heading, with a sentence before them."""

    heading: str
    lead: str
    figures: tuple[Shown, ...]


@dataclass(frozen=True)
class LinkRow:
    """One link of the table beside the scheme, in the units of a drawing."""

    name: str
    mass: str
    inertia: str
    centre: str
    share: str


@dataclass(frozen=True)
class Section:
    """Everything about one mechanism in one variant."""

    key: str
    view: View
    formula: str
    scheme: Shown
    links: tuple[LinkRow, ...]
    parts: tuple[Part, ...]
    readings: Readings | None


def section(view: View, readings: Readings | None) -> Section:
    """Build a mechanism's section."""
    parts = [_kinematics(view)] if view.has_output and view.motions else []
    if view.motions:
        parts += [_inertia(view), *(_regime(view, motion) for motion in view.motions)]
    return Section(
        key=view.key,
        view=view,
        formula=view.mechanism.structure.formula.replace("->", "→").replace("_", " "),
        scheme=_scheme(view),
        links=_links(view),
        parts=tuple(parts),
        readings=readings,
    )


def _shown(view: View, name: str, lead: str, draw: Callable[[], Figure], description: str, wide: bool = False) -> Shown:
    alt = f"{view.linkage.title} ({view.linkage.variant}): {description}"
    return Shown(lead, picture(draw(), f"{view.key}-{name}", alt), wide)


def _scheme(view: View) -> Shown:
    number = scheme.scheme_of(view).shown
    output = view.linkage.output
    lead = (
        f"The linkage to scale in {scheme.POSITIONS} crank positions, numbered every {360 // scheme.POSITIONS}° from "
        f"φ = 0; position {number} is drawn out with its joints, and quartered discs are mass centres clear of a joint."
    )
    if output is not None:
        lead += f" The blue line is the path of the output {output.point}, its dots the same positions."
    return _shown(view, "scheme", lead, lambda: scheme.scheme_figure(view), f"kinematic scheme in {scheme.POSITIONS} positions")


def _links(view: View) -> tuple[LinkRow, ...]:
    parts = inertia.links_inertia(view, np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False))
    whole = sum(float(np.mean(values)) for values in parts.values())
    return tuple(
        _link_row(view.linkage.links[name], float(np.mean(values)) / whole) for name, values in parts.items()
    )


def _link_row(link: Link, share: float) -> LinkRow:
    centre = f"({_millimetres(link.centre[0])}, {_millimetres(link.centre[1])})"
    turning = ABSENT if link.inertia is None else figure(link.inertia)
    return LinkRow(link.name.replace("_", " "), figure(link.mass), turning, centre, f"{100.0 * share:.1f}")


def _millimetres(value: float) -> str:
    return f"{value * 1e3:.4g}".replace("-", "−")


def _rpm(speed: float) -> str:
    return f"{abs(speed) / RPM:.4g} rpm" + (" clockwise" if speed < 0.0 else "")


def _kinematics(view: View) -> Part:
    _, values = kinematics.turn_at_final_speed(view)
    fastest, hardest = (float(np.max(np.abs(values[name]))) for name in ("v", "a"))
    point = view.linkage.output.point if view.linkage.output else ""
    means = unit_functions(view.mechanism).deviations
    named = ", ".join(f"{name} {100.0 * mean:.2f} %" for name, mean in zip("Sva", means, strict=True))
    return Part(
        "Motion of the output",
        f"At {_rpm(view.final_speed)} the output {point} strokes {figure(stroke(view.mechanism) * 1e3)} mm and reaches "
        f"{figure(fastest)} m/s and {figure(hardest)} m/s²; all curves are the closed form.",
        (
            _shown(view, "output", f"S from top dead centre, v and a over the crank angle at {_rpm(view.final_speed)}; "
                   "dots mark the extremes.", lambda: kinematics.output_figure(view),
                   "displacement, velocity and acceleration of the output over the crank angle"),
            _shown(view, "units", "Freed of stroke and speed: unit functions against a harmonic motion (dashed).",
                   lambda: kinematics.unit_figure(view), "unit functions of the output against harmonics"),
            _shown(view, "differences", f"Unit function less harmonic; mean absolute difference over the turn: {named}.",
                   lambda: kinematics.difference_figure(view), "differences of unit functions and harmonics"),
        ),
    )  # fmt: skip


def _inertia(view: View) -> Part:
    found = extremes(lambda phi: reduced_inertia(view.mechanism.sweep(phi)))
    motion = view.motions[0]
    constant = [name.replace("_", " ") for name, values in inertia.links_inertia(view, np.linspace(0.0, 6.0, 25)).items()
                if not inertia.varies(values)]  # fmt: skip
    kept = f" The constant share ({', '.join(constant)}) is left out." if constant else ""
    return Part(
        "Reduced moment of inertia Jeq",
        f"Jeq lies between {figure(found.minimum)} kg m² at {math.degrees(found.minimum_angle):.1f}° and "
        f"{figure(found.maximum)} kg m² at {math.degrees(found.maximum_angle):.1f}°, mean {figure(found.mean)} kg m², "
        f"relative pulsation {100.0 * found.relative_pulsation:.2f} %.",
        (
            _shown(view, "methods", "Jeq by every method over the last turn, and how far each is off. "
                   + _largest_words(view, view.traces(motion, "Jeq")),
                   lambda: inertia.methods_figure(view), "Jeq of all methods and their deviation over the crank angle"),
            _shown(view, "groups", "Where Jeq comes from: the class I crank and each Assur group, one on the other.",
                   lambda: inertia.groups_figure(view), "Jeq by Assur group over the crank angle"),
            _shown(view, "links", f"What varies: Jeq of each link by itself.{kept}",
                   lambda: inertia.links_figure(view), "Jeq by link over the crank angle"),
        ),
    )  # fmt: skip


def _regime(view: View, motion: CrankMotion) -> Part:
    records = [record for record in view.records if record.regime == motion.regime]
    shown = [q for q in run_up.QUANTITIES_SHOWN if any(record.quantity == q for record in records)]
    figures = [
        _shown(view, f"{motion.regime}-errors", "Every deviation of this regime at a glance: the further left of its "
               "limit (red stroke), the better.", lambda: errors.errors_figure(view, motion),
               f"largest deviation of every run by quantity, {motion.regime}", wide=True)
    ]  # fmt: skip
    figures += [_history(view, motion, name) for name in shown]
    jumps = " Dotted uprights are jumps of the crank's acceleration." if motion.jumps else ""
    lead = (
        f"Over {motion.duration:.4g} s ({records[0].conditions}): grey is the closed form, dashed the engines at setting "
        f"{view.setting}. Beneath stands the upper envelope of |error| over the peak, on a logarithmic scale, for every "
        f"setting that ran.{jumps}"
    )
    return Part(f"Regime {motion.regime}", lead, tuple(figures))


def _history(view: View, motion: CrankMotion, quantity: str) -> Shown:
    traces = view.traces(motion, quantity)
    peak = next((trace.record.peak for trace in traces), None)
    unit = next((record.unit for record in view.records if record.quantity == quantity), "")
    words = f"{quantity}" + (f", peak {figure(peak)} {unit}. " if peak is not None else ". ")
    return _shown(
        view,
        f"{motion.regime}-{quantity}",
        words + _largest_words(view, traces),
        lambda: run_up.history_figure(view, motion, quantity),
        f"{quantity} over time by the closed form and the engines, {motion.regime}",
    )


def _largest_words(view: View, traces: list[Trace]) -> str:
    """The largest deviation of each engine at the view's setting, over the whole regime."""
    mine = [trace.record for trace in traces if trace.record.setting == view.setting]
    if not mine:
        return f"No engine gave a curve at setting {view.setting}."
    words = ", ".join(f"{r.engine} {error(r.error_max)}" for name in engines(view.results) for r in mine if r.engine == name)
    return f"Largest deviation at {view.setting}: {words}."
