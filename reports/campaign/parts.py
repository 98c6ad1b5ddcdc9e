"""The parts of a section that tell of the model itself: figures under one heading, each with a sentence before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from analytic.dynamics.reduced import reduced_inertia
from analytic.numerics.extremes import extremes
from analytic.turn.unit_functions import stroke, unit_functions
from reports.charts import forces, inertia, kinematics
from reports.charts import old_thread as thread
from reports.charts.released import printed_figure
from reports.charts.style import ReportFigure, picture
from reports.document.tables import ReportTable
from reports.document.templates import captions, filled, plain, sentence
from reports.facts import forces as force_facts
from reports.facts import thread as thread_facts
from reports.facts.forces import TurnForces
from reports.facts.printed_models import judged, judgements
from reports.records.views import Regime, View, anchor


@dataclass(frozen=True)
class ReportPart:
    """Figures under one heading, with a sentence before them, ``lines`` of a list and a table after those."""

    heading: str
    lead: str
    figures: tuple[ReportFigure, ...]
    lines: tuple[str, ...] = ()
    table: ReportTable | None = None


def shown(view: View, kind: str, figure: Figure, name: str = "", **values: object) -> ReportFigure:
    """A figure of a mechanism with the words of its ``kind``, filled in with ``values``; ``name`` is its anchor."""
    words = captions()[kind]
    values = {"view": view, **values}
    alt = f"{view.linkage.title} ({view.linkage.variant}): {filled(words['alt'], **values)}"
    drawing = picture(figure, anchor(view.key, name or kind), alt)
    return ReportFigure(filled(words["caption"], **values), drawing, words.get("wide", False))


def kinematics_part(view: View) -> ReportPart:
    """S, v, a, and the unit functions against harmonics."""
    _, values = kinematics.turn_at_final_speed(view)
    fastest, hardest = (float(np.max(np.abs(values[name]))) for name in ("v", "a"))
    lead = sentence("output_motion", view=view, stroke=stroke(view.mechanism), fastest=fastest, hardest=hardest)
    means = list(zip("Sva", unit_functions(view.mechanism).deviations, strict=True))
    figures = (
        shown(view, "output", kinematics.output_figure(view)),
        shown(view, "units", kinematics.unit_figure(view)),
        shown(view, "differences", kinematics.difference_figure(view), means=means),
    )
    return ReportPart("Motion of the output", lead, figures)


def inertia_part(view: View) -> ReportPart:
    """Jeq by all methods, where the campaign asked for it, by group and by link."""
    lead = sentence("reduced_inertia", found=extremes(lambda phi: reduced_inertia(view.mechanism.sweep(phi))))
    parts = inertia.links_inertia(view, np.linspace(0.0, 2.0 * np.pi, 25))
    constant = [plain(name) for name, values in parts.items() if not inertia.varies(values)]
    figures = [
        shown(view, "groups", inertia.groups_figure(view)),
        shown(view, "links", inertia.links_figure(view), constant=constant),
    ]
    if any(record.quantity == "Jeq" for record in view.records):
        regime = view.regimes[0]
        words = largest_errors(view, regime, "Jeq")
        figures.insert(0, shown(view, "methods", inertia.methods_figure(view), regime=regime, largest=words))
    return ReportPart("Reduced moment of inertia Jeq", lead, tuple(figures))


def largest_errors(view: View, regime: Regime, quantity: str) -> str:
    """The largest error of each engine at the view's setting, over the whole regime, in words."""
    records = [trace.record for trace in view.traces(regime, quantity) if trace.record.setting == view.setting]
    return sentence("largest_errors", records=records, setting=view.setting)


def forces_part(view: View) -> ReportPart:
    """Joint forces, shaking force and shaking moment by the closed form."""
    found = TurnForces(view)
    figures = (
        shown(view, "joint-forces", forces.magnitudes_figure(found)),
        shown(view, "hodographs", forces.hodographs_figure(found)),
        shown(view, "shaking-force", forces.shaking_force_figure(found)),
        shown(view, "shaking-moment", forces.shaking_moment_figure(found), found=found),
    )
    return ReportPart("Forces in the joints and on the frame", force_facts.lead(found), figures)


def thread_part(view: View) -> ReportPart:
    """The thread's contour and feed diagram."""
    figures = [
        shown(view, "contour", thread.plane_figure(view)),
        shown(view, "feed", thread.feed_figure(view)),
    ]
    if thread.is_spatial(view):
        figures.append(shown(view, "contour-in-space", thread.space_figure(view)))
    return ReportPart("Thread", thread_facts.lead(view), tuple(figures))


def printed_part(view: View) -> ReportPart:
    """Models as printed, and what the engines say of them."""
    lines = tuple(row["sentence"] for row in judgements(view))
    figures = tuple(
        shown(view, "printed", printed_figure(view, erratum), f"printed-{erratum.name}", erratum=erratum)
        for erratum in judged(view)
    )
    lead = "The engines know neither model; each simulates the linkage as described, and its crank speed decides."
    return ReportPart("Printed models put to the engines", lead, figures, lines)
