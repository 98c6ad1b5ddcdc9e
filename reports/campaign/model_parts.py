"""Parts of a section that tell of the model itself: the thread, forces over a steady turn, models as printed."""

from __future__ import annotations

from functools import partial

from analytic.description.linkage import Erratum
from reports.campaign.parts import ReportFigure, ReportPart, shown
from reports.drawing import forces, thread
from reports.drawing.printed import printed_figure
from reports.facts import forces as force_facts
from reports.facts import printed_models
from reports.facts import thread as thread_facts
from reports.facts.forces import TurnForces
from reports.facts.views import View


def thread_part(view: View) -> ReportPart:
    """The thread's contour and feed diagram."""
    figures = [
        shown(
            view,
            "contour",
            "The contour at φ_ref (orange) with the scheme; rings are guides, dashed lines the paths of the eyes.",
            lambda: thread.plane_figure(view),
            "the thread's contour with the kinematic scheme in the reference position",
        )
    ]
    figures.append(
        shown(
            view,
            "feed",
            "Feed diagram Pd(φ), and beneath it the length of the contour; uprights mark where an eye turns round.",
            lambda: thread.feed_figure(view),
            "thread feed and contour length over the crank angle",
        )
    )
    if thread.is_spatial(view):
        figures.append(
            shown(
                view,
                "contour-in-space",
                "The contour in space: z runs along the main shaft and is drawn to a larger scale.",
                lambda: thread.space_figure(view),
                "the thread's contour in space",
            )
        )
    return ReportPart("Thread", thread_facts.lead(view), tuple(figures))


def forces_part(view: View) -> ReportPart:
    """Joint forces, shaking force and shaking moment by the closed form."""
    found = TurnForces(view)
    hodographs = "Fx against Fy of every joint, each to its own scale: dots are 30° of the crank apart."
    figures = (
        shown(
            view,
            "joint-forces",
            "Magnitude of every joint's force over the crank angle, named with its peak.",
            lambda: forces.magnitudes_figure(found),
            "magnitude of every joint force over the crank angle",
            wide=True,
        ),
        shown(
            view,
            "hodographs",
            hodographs,
            lambda: forces.hodographs_figure(found),
            "hodographs of the joint forces",
            wide=True,
        ),
        shown(
            view,
            "shaking-force",
            "Shaking force on the frame, dots 30° of the crank apart.",
            lambda: forces.shaking_force_figure(found),
            "hodograph of the shaking force",
        ),
        shown(
            view,
            "shaking-moment",
            f"Shaking moment on the frame about {found.pivot}, the drive's reaction included.",
            lambda: forces.shaking_moment_figure(found),
            "shaking moment over the crank angle",
        ),
    )
    return ReportPart("Forces in the joints and on the frame", force_facts.lead(found), figures)


def printed_part(view: View) -> ReportPart:
    """Models as printed, and what the engines say of them."""
    lines = tuple(row["sentence"] for row in printed_models.judgements(view))
    figures = tuple(_printed(view, erratum) for erratum in printed_models.judged(view))
    lead = "The engines know neither model; each simulates the linkage as described, and its crank speed decides."
    return ReportPart("Printed models put to the engines", lead, figures, lines)


def _printed(view: View, erratum: Erratum) -> ReportFigure:
    note = f": {erratum.note}" if erratum.note else ""
    return shown(
        view,
        f"printed-{erratum.name}",
        f"{erratum.name} ({erratum.place}){note}. Crank speed in regime {erratum.regime}: the corrected model in grey, "
        "the printed one in red, the engines that ran the regime dashed; beneath, |error| over the corrected peak.",
        partial(printed_figure, view, erratum),
        f"crank speed by the corrected and the printed model, {erratum.name}",
        wide=True,
    )
