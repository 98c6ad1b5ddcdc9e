"""The thread's contour and feed over the crank angle (articles 002 and 004).

The contour's length is the sum of the straight distances between its stops, guides and eyes, in space (article 002,
eqs (19)-(21); article 004, eqs (15)-(17)); the thickness of guides and eyes is neglected. The feed is the contour's
change from a reference position, plus the thread's stretch (article 002, eqs (22) and (23); article 004, eqs (21)-(24),
where D(φ_bottom) − D(φ) = L(φ_bottom) − L(φ)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.thread_path import ThreadEye, ThreadPath
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.extremes import Extremes, extremes, grid, zeros

Array = NDArray[np.float64]

POINTS = 720


@dataclass(frozen=True)
class EyeTravel:
    """Crank angles, rad in [0, 2π), where an eye is highest and lowest (φ_top, φ_bottom), and its heights there, m."""

    top_angle: float
    bottom_angle: float
    top: float
    bottom: float


@dataclass(frozen=True)
class FeedDiagram:
    """Contour length L and feed Pd, m, at the crank angles, rad; all (n,).

    ``reference_angle`` is φ_ref, rad; ``length_extremes`` are L's over a turn.
    """

    angle: Array
    length: Array
    feed: Array
    reference_angle: float
    length_extremes: Extremes

    @property
    def total_feed(self) -> float:
        """Thread given and taken back in a turn: the longest contour less the shortest, m."""
        return self.length_extremes.maximum - self.length_extremes.minimum


def contour(sweep: Sweep, path: ThreadPath) -> Array:
    """The contour's corners in space, m; shape (stops, 3, *angle.shape)."""
    corners = np.zeros((len(path.stops), 3, *sweep.angle.shape))
    for corner, stop in zip(corners, path.stops, strict=True):
        if isinstance(stop, ThreadEye):
            corner[:2] = sweep.point(stop.point)
            corner[2] = stop.z
        else:
            corner[:] = np.reshape(stop.position, (3, *[1] * sweep.angle.ndim))
    return corners


def contour_length(sweep: Sweep, path: ThreadPath) -> Array:
    """L(φ), m."""
    return np.asarray(np.linalg.norm(np.diff(contour(sweep, path), axis=0), axis=1).sum(axis=0))


def _check_turns(mechanism: Mechanism, what: str, cure: str) -> None:
    """Raise LinkproofError if the request needs a full turn and the crank makes none."""
    words = f"thread: {what} of '{mechanism.linkage.name}' needs a full turn of the crank, which"
    if mechanism.linkage.is_linear:
        raise LinkproofError(f"{words} its linear drive does not make; {cure}")
    try:
        mechanism.check_full_turn()
    except AssemblyError as error:
        raise LinkproofError(f"{words} it cannot make; {cure}") from error


def eye_travel(mechanism: Mechanism, eye: str) -> EyeTravel:
    """Where an eye turns round: the outermost zeros of the exact derivative of its height, not grid points."""
    _check_turns(mechanism, f"the extreme height of eye '{eye}'", "give a crank angle as the reference")
    angles = zeros(lambda phi: mechanism.sweep(phi).point(eye, 1)[1])
    if not len(angles):
        raise LinkproofError(
            f"thread: expected an eye that moves up and down, got '{eye}' of '{mechanism.linkage.name}', which does "
            "not; name another point"
        )
    heights = mechanism.sweep(angles).point(eye)[1]
    top, bottom = int(np.argmax(heights)), int(np.argmin(heights))
    return EyeTravel(float(angles[top]), float(angles[bottom]), float(heights[top]), float(heights[bottom]))


def reference_angle(mechanism: Mechanism, path: ThreadPath) -> float:
    """φ_ref, rad: the crank angle at which the feed is ΔP."""
    if isinstance(path.reference, float | int):
        return float(path.reference)
    travel = eye_travel(mechanism, path.reference.eye)
    return travel.top_angle if path.reference.extreme == "highest" else travel.bottom_angle


def feed(mechanism: Mechanism, path: ThreadPath, angle: ArrayLike) -> Array:
    """Actual feed Pd(φ), m, at crank angles of any shape, rad."""
    return feed_of_length(path, contour_length(mechanism.sweep(angle), path), reference_length(mechanism, path))


def reference_length(mechanism: Mechanism, path: ThreadPath) -> float:
    """L(φ_ref), m: the contour's length at which the feed is ΔP."""
    return float(contour_length(mechanism.sweep(reference_angle(mechanism, path)), path))


def feed_of_length(path: ThreadPath, length: ArrayLike, start: float) -> Array:
    """Feed, m, of a contour of the given length, m, from its length ``start`` at the reference angle, m."""
    return np.asarray(_sign(path) * (np.asarray(length) - start) + path.stretch)


def _sign(path: ThreadPath) -> float:
    return -1.0 if path.feed == "shortening" else 1.0


def feed_diagram(mechanism: Mechanism, path: ThreadPath, points: int = POINTS) -> FeedDiagram:
    """Contour and feed over a turn from φ = 0, at ``points`` equal steps."""
    _check_turns(mechanism, "the contour", "compare computes its feed over a swing, --from to --to")
    angle = grid(points)
    sweep = mechanism.sweep(angle)
    return FeedDiagram(
        angle=angle,
        length=contour_length(sweep, path),
        feed=feed(mechanism, path, angle),
        reference_angle=reference_angle(mechanism, path),
        length_extremes=extremes(lambda phi: contour_length(mechanism.sweep(phi), path)),
    )
