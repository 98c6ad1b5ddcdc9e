"""What the page says and shows of one mechanism: how it is built, its parts, the figures its source prints."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from analytic.description.linkage import Link
from analytic.errors import LinkproofError
from reports.campaign.parts import (
    ReportPart,
    forces_part,
    inertia_part,
    kinematics_part,
    printed_part,
    shown,
    thread_part,
)
from reports.campaign.regime_part import regime_part
from reports.charts import inertia
from reports.charts import old_scheme as scheme
from reports.charts.style import ReportFigure
from reports.document.numbers import ABSENT, printed
from reports.document.tables import ReportTable
from reports.document.templates import plain
from reports.facts.printed_models import judgements
from reports.facts.readings import Readings
from reports.records.views import View


def mechanism_section(view: View, readings: Readings | None) -> dict[str, object]:
    """What ``section.html`` shows of one mechanism in one variant."""
    parts = [_attempt("Motion of the output", partial(kinematics_part, view))] if view.has_output else []
    parts += [_attempt("Reduced moment of inertia Jeq", partial(inertia_part, view))] if view.makes_full_turn else []
    if view.makes_full_turn:
        parts += [_attempt("Forces in the joints and on the frame", partial(forces_part, view))]
    if view.linkage.thread is not None and view.makes_full_turn:
        parts += [_attempt("Thread", partial(thread_part, view))]
    parts += [_attempt(f"Regime {regime.name}", partial(regime_part, view, regime)) for regime in view.regimes]
    if judgements(view):
        parts += [_attempt("Printed models put to the engines", partial(printed_part, view))]
    return {
        "key": view.key,
        "linkage": view.linkage,
        "formula": view.mechanism.structure.formula.replace("->", "→").replace("_", " "),
        "scheme": _scheme(view),
        "links": _links(view),
        "parts": parts,
        "readings": readings,
    }


def _attempt(heading: str, build: Callable[[], ReportPart]) -> ReportPart:
    """A part, or why there is none: a linkage may have velocities everywhere but in a dead position."""
    try:
        return build()
    except LinkproofError as error:
        return ReportPart(heading, f"Cannot be derived: {error}.", ())


def _scheme(view: View) -> ReportFigure:
    """The linkage in positions of its turn, or of the range that it reaches."""
    number = scheme.scheme_of(view.mechanism).shown
    return shown(view, "scheme", scheme.scheme_figure(view), positions=scheme.POSITIONS, shown=number)


def _links(view: View) -> ReportTable:
    """The moving links in the units of a drawing, with their shares of the mean Jeq where it exists over a turn."""
    links = view.linkage.links
    head = ("Link", "m, kg", "J, kg m²", "Mass centre, mm")
    note = "Mass centres in the link's own frame; J about the mass centre, – where the link cannot turn."
    caption = "The moving links as described"
    try:
        parts = inertia.links_inertia(view, np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False))
    except LinkproofError:
        return ReportTable(f"{caption}.", head, tuple(_link_row(link) for link in links.values()), note=note)
    means = {name: float(np.mean(values)) for name, values in parts.items()}
    whole = sum(means.values()) or 1.0  # no link has a mass
    rows = tuple((*_link_row(links[name]), f"{100.0 * mean / whole:.1f}") for name, mean in means.items())
    return ReportTable(f"{caption}, and what each gives to the mean Jeq.", (*head, "Jeq, %"), rows, note=note)


def _link_row(link: Link) -> tuple[str, ...]:
    centre = f"({_millimetres(link.centre[0])}, {_millimetres(link.centre[1])})"
    return plain(link.name), printed(link.mass), ABSENT if link.inertia is None else printed(link.inertia), centre


def _millimetres(value: float) -> str:
    return f"{value * 1e3:.4g}".replace("-", "−")
