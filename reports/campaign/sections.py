"""What the page says and shows of one mechanism: how it is built, its parts, the figures its source prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from analytic.description.linkage import Link
from analytic.errors import LinkproofError
from reports.campaign.model_parts import forces_part, printed_part, thread_part
from reports.campaign.parts import Part, Shown, inertia_part, kinematics_part, regime_part, shown
from reports.drawing import inertia, scheme
from reports.facts.printed_models import judgements
from reports.facts.readings import Readings
from reports.facts.views import View
from reports.text.numbers import ABSENT, printed


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
    scheme: Shown | None
    links: tuple[LinkRow, ...]
    parts: tuple[Part, ...]
    readings: Readings | None


def section(view: View, readings: Readings | None) -> Section:
    """Build a mechanism's section."""
    parts = [_attempt("Motion of the output", partial(kinematics_part, view))] if view.has_output else []
    parts += [_attempt("Reduced moment of inertia Jeq", partial(inertia_part, view))] if view.makes_full_turn else []
    if view.makes_full_turn:
        parts += [_attempt("Forces in the joints and on the frame", partial(forces_part, view))]
    if view.linkage.thread is not None and view.makes_full_turn:
        parts += [_attempt("Thread", partial(thread_part, view))]
    parts += [_attempt(f"Regime {regime.name}", partial(regime_part, view, regime)) for regime in view.regimes]
    if judgements(view):
        parts += [_attempt("Printed models put to the engines", partial(printed_part, view))]
    return Section(
        key=view.key,
        view=view,
        formula=view.mechanism.structure.formula.replace("->", "→").replace("_", " "),
        scheme=_scheme(view) if view.makes_full_turn else None,
        links=_links(view),
        parts=tuple(parts),
        readings=readings,
    )


def _attempt(heading: str, build: Callable[[], Part]) -> Part:
    """A part, or why there is none: a linkage may have velocities everywhere but in a dead position."""
    try:
        return build()
    except LinkproofError as error:
        return Part(heading, f"Not to be had: {error}.", ())


def _scheme(view: View) -> Shown:
    number = scheme.scheme_of(view).shown
    output = view.linkage.output
    lead = (
        f"The linkage to scale in {scheme.POSITIONS} crank positions, numbered every {360 // scheme.POSITIONS}° from "
        f"φ = 0; position {number} is drawn out with its joints, and quartered discs are mass centres clear of a joint."
    )
    if output is not None:
        lead += f" The blue line is the path of the output {output.point}, its dots the same positions."
    words = f"kinematic scheme in {scheme.POSITIONS} positions"
    return shown(view, "scheme", lead, lambda: scheme.scheme_figure(view), words)


def _links(view: View) -> tuple[LinkRow, ...]:
    try:
        parts = inertia.links_inertia(view, np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False))
    except LinkproofError:
        return tuple(_link_row(link, None) for link in view.linkage.links.values())
    whole = sum(float(np.mean(values)) for values in parts.values())
    return tuple(_link_row(view.linkage.links[name], float(np.mean(values)) / whole) for name, values in parts.items())


def _link_row(link: Link, share: float | None) -> LinkRow:
    centre = f"({_millimetres(link.centre[0])}, {_millimetres(link.centre[1])})"
    turning = ABSENT if link.inertia is None else printed(link.inertia)
    part = "" if share is None else f"{100.0 * share:.1f}"
    return LinkRow(link.name.replace("_", " "), printed(link.mass), turning, centre, part)


def _millimetres(value: float) -> str:
    return f"{value * 1e3:.4g}".replace("-", "−")
