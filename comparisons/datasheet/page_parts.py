"""Parts of a mechanism's page besides the signals of one motion: shares of Jeq, normalised motion, thread."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.thread_path import ThreadEye
from analytic.dynamics import reduced
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.turn.thread_feed import contour, feed_diagram
from analytic.turn.unit_functions import unit_functions
from comparisons.datasheet.sheet import Normalised, ThreadSheet
from comparisons.reference.case import Case

Array = NDArray[np.float64]

SHOWN: Final = 180  # steps of the normalised motion, which is smooth


def shares(mechanism: Mechanism, angle: Array) -> dict[str, dict[str, Array]]:
    """Jeq by group and by link at values of φ (n,), kg m²; nothing where nothing has mass."""
    linkage, sweep = mechanism.linkage, mechanism.sweep(angle)
    if linkage.is_massless:
        return {}
    order = [linkage.crank, *(name for group in mechanism.structure.groups for name in group.links)]
    links = {name: reduced.link_inertia(sweep, name) for name in order if name in linkage.links}
    return {"groups": dict(reduced.group_inertia(sweep)), "links": links}


def normalised(case: Case) -> Normalised | None:
    """Unit functions of the output, if there is one; raises LinkproofError where the driver makes no full turn."""
    mechanism, linkage, motion = case.mechanism, case.mechanism.linkage, case.motion
    if linkage.output is None:
        return None
    if linkage.is_linear or not mechanism.crank_range().is_full_turn:
        raise LinkproofError(f"The normalised motion needs a full turn, which the {linkage.driver} does not make")
    functions = unit_functions(mechanism, clockwise=float(motion.speed(motion.duration)) < 0.0)
    every = len(functions.phase) // SHOWN
    ours = (functions.displacement, functions.velocity, functions.acceleration)

    def named(curves: tuple[Array, ...]) -> dict[str, Array]:
        return {name: np.append(c[::every], c[0]) for name, c in zip("Sva", curves, strict=True)}

    phase = np.append(functions.phase[::every], FULL_TURN)
    return Normalised(
        phase, named(ours), named(functions.harmonics), dict(zip("Sva", functions.deviations, strict=True))
    )


def thread(mechanism: Mechanism, steps: int) -> ThreadSheet | None:
    """Contour and feed of the thread, if there is one, in so many steps of a turn."""
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
