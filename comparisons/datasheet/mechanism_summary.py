"""The summary of a mechanism that ``linkproof show`` prints, as plain data."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.thread_path import ThreadEye, ThreadPath
from analytic.dynamics import reduced
from analytic.dynamics.equation_of_motion import equilibria
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.thread_feed import contour, eye_travel, feed_diagram
from analytic.motion.unit_functions import bottom_dead_centre, stroke, top_dead_centre, unit_functions
from analytic.numerics.refine import Extremes, extremes, periodic_mean
from comparisons.datasheet.linkage_check import accuracy_facts, range_facts
from comparisons.datasheet.sheet import ThreadSheet, UnitFunctionCurves
from comparisons.reference.case import Case

Array = NDArray[np.float64]


def portrait(linkage: Linkage) -> dict[str, Any]:
    """Structure, inertia and accuracy of a linkage in SI units and degrees, ready for JSON.

    Where the crank cannot turn fully, or passes change points, its range stands in place of the figures of a turn.
    """
    mechanism = Mechanism(linkage)
    reach = mechanism.crank_range()
    signs = {dyad.name: dyad.sign for dyad in mechanism.structure.dyads if dyad.sign}
    facts = file_facts(linkage, structure=mechanism.structure.formula, signs=signs)
    if reach.is_full_turn:
        return facts | _full_turn_facts(mechanism, facts["links"])
    return facts | {"range": range_facts(mechanism, reach)}


def file_facts(linkage: Linkage, **worked_out: object) -> dict[str, Any]:
    """The data of a linkage's file, ready for JSON, with the facts ``worked_out`` from them."""
    return {
        "mechanism": linkage.name,
        "title": linkage.title,
        "source": linkage.source,
        "variant": linkage.variant,
        "variants": list(linkage.variants),
        **worked_out,
        "links": {name: _link_facts(linkage, name) for name in linkage.links},
        "notes": list(linkage.notes),
    }


def _full_turn_facts(mechanism: Mechanism, links: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Figures of a full turn; each link's mean Jeq is added to ``links``."""
    linkage = mechanism.linkage
    for name, link in links.items():
        link["Jeq_mean"] = periodic_mean(reduced.link_inertia(mechanism.turn, name))
    facts = accuracy_facts(mechanism)
    if not linkage.is_massless:
        facts["Jeq"] = _inertia_extremes(extremes(lambda phi: reduced.reduced_inertia(mechanism.sweep(phi))))
    if any(linkage.gravity) or linkage.springs:
        facts["equilibria"] = [
            {"angle": math.degrees(equilibrium.angle), "stable": bool(equilibrium.stable)}
            for equilibrium in equilibria(mechanism)
        ]
    if linkage.thread is not None:
        facts["thread"] = thread_facts(mechanism, linkage.thread)
    if linkage.output is not None:
        facts["output"] = {
            "point": linkage.output.point,
            "stroke": stroke(mechanism),
            "top_dead_centre": math.degrees(top_dead_centre(mechanism).angle),
            "bottom_dead_centre": math.degrees(bottom_dead_centre(mechanism).angle),
        }
    return facts


def thread_facts(mechanism: Mechanism, path: ThreadPath) -> dict[str, Any]:
    """Contour and feed of the thread over a turn, m and degrees."""
    diagram = feed_diagram(mechanism, path)
    travels = {stop.point: eye_travel(mechanism, stop.point) for stop in path.eyes}
    ends = {eye: {"top": travel.top_angle, "bottom": travel.bottom_angle} for eye, travel in travels.items()}
    return {
        "contour": {"min": diagram.length_extremes.minimum, "max": diagram.length_extremes.maximum},
        "feed": {"min": float(np.min(diagram.feed)), "max": float(np.max(diagram.feed)), "total": diagram.total_feed},
        "reference_angle": math.degrees(diagram.reference_angle),
        "eyes": {eye: {end: math.degrees(angle) for end, angle in two.items()} for eye, two in ends.items()},
    }


def _inertia_extremes(result: Extremes) -> dict[str, float]:
    """Extremes of Jeq, kg m², and the crank angles of both, degrees."""
    return {
        "mean": result.mean,
        "max": result.maximum,
        "min": result.minimum,
        "pulsation": result.relative_pulsation,
        "max_at": math.degrees(result.maximum_angle),
        "min_at": math.degrees(result.minimum_angle),
    }


def _link_facts(linkage: Linkage, name: str) -> dict[str, Any]:
    """Points, m, mass, kg, mass centre and inertia of a link as its file has them."""
    link = linkage.links[name]
    return {
        "points": {point: list(local) for point, local in link.points.items()},
        "mass": link.mass,
        "centre": list(link.centre),
        "inertia": link.inertia,
    }


# Parts of a mechanism's page besides the signals of one motion: shares of Jeq, normalised motion, thread.


CURVE_STEPS: Final = 180  # steps of the normalised motion, which is smooth


def inertia_shares(mechanism: Mechanism, angle: Array) -> dict[str, dict[str, Array]]:
    """Shares of Jeq, kg m²: by group ("groups") and by link ("links") at φ (n,); {} where nothing has mass."""
    linkage, sweep = mechanism.linkage, mechanism.sweep(angle)
    if linkage.is_massless:
        return {}
    order = [linkage.crank, *(name for group in mechanism.structure.groups for name in group.links)]
    links = {name: reduced.link_inertia(sweep, name) for name in order if name in linkage.links}
    return {"groups": dict(reduced.group_inertia(sweep)), "links": links}


def unit_function_curves(case: Case) -> UnitFunctionCurves | None:
    """S/stroke, v/max|v| and a/max|a| of the output over a turn beside a harmonic drive's; None without an output.

    Raises LinkproofError where the driver makes no full turn.
    """
    mechanism, linkage, motion = case.mechanism, case.mechanism.linkage, case.motion
    if linkage.output is None:
        return None
    if linkage.is_linear or not mechanism.crank_range().is_full_turn:
        raise LinkproofError(f"The normalised motion needs a full turn, which the {linkage.driver} does not make")
    functions = unit_functions(mechanism, clockwise=float(motion.speed(motion.duration)) < 0.0)
    every = len(functions.phase) // CURVE_STEPS
    ours = (functions.displacement, functions.velocity, functions.acceleration)

    def named(curves: tuple[Array, ...]) -> dict[str, Array]:
        return {name: np.append(c[::every], c[0]) for name, c in zip("Sva", curves, strict=True)}

    phase = np.append(functions.phase[::every], FULL_TURN)
    return UnitFunctionCurves(
        phase, named(ours), named(functions.harmonics), dict(zip("Sva", functions.deviations, strict=True))
    )


def thread_sheet(mechanism: Mechanism, steps: int) -> ThreadSheet | None:
    """Contour and feed of the thread in so many steps of a turn; None without a thread."""
    path = mechanism.linkage.thread
    if path is None:
        return None
    diagram = feed_diagram(mechanism, path, steps)
    angle = np.append(diagram.angle, FULL_TURN)
    corners = zip(path.stops, contour(mechanism.sweep(angle), path), strict=True)
    return ThreadSheet(
        angle=angle,
        feed=np.append(diagram.feed, diagram.feed[0]),
        length=np.append(diagram.length, diagram.length[0]),
        contour=contour(mechanism.sweep(diagram.reference_angle), path),
        stops=tuple(stop.point if isinstance(stop, ThreadEye) else stop.name for stop in path.stops),
        eyes={stop.point: {"path": corner} for stop, corner in corners if isinstance(stop, ThreadEye)},
        reference_angle=diagram.reference_angle,
    )
