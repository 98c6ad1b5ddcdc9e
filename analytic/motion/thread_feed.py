"""The thread's contour and feed over the crank angle (articles 002 and 004).

The contour's length is the sum of the straight distances between its stops, guides and eyes, in space (article 002,
eqs (19)-(21); article 004, eqs (15)-(17)); the thickness of guides and eyes is neglected. The feed is the contour's
change from a reference position, plus the thread's stretch (article 002, eqs (22) and (23); article 004, eqs (21)-(24),
where D(φ_bottom) − D(φ) = L(φ_bottom) − L(φ)).
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import ThreadEye, ThreadGuide, ThreadPath
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.frames import Scalar
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.refine import zeros

Array = NDArray[np.float64]


def stop_position(sweep: Sweep, stop: ThreadGuide | ThreadEye) -> tuple[Scalar, Scalar, Scalar]:
    """A corner of the contour in space, m."""
    if isinstance(stop, ThreadGuide):
        return stop.position
    x, y = sweep.point(stop.point)
    return x, y, stop.z


def contour_length(sweep: Sweep, path: ThreadPath) -> Scalar:
    """L(φ), m."""
    corners = [stop_position(sweep, stop) for stop in path.stops]
    length: Scalar = 0.0
    for (x0, y0, z0), (x1, y1, z1) in itertools.pairwise(corners):
        x, y, z = x1 - x0, y1 - y0, z1 - z0
        length = length + np.sqrt(x * x + y * y + z * z)
    return length


def reference_angle(mechanism: Mechanism, path: ThreadPath) -> float:
    """φ_ref, rad: the crank angle at which the feed is ΔP.

    The extreme position of an eye is the outermost zero of the exact derivative of its height, not a grid point.
    Raises LinkproofError where the crank makes no full turn, and for an eye that does not move up and down.
    """
    if isinstance(path.reference, float | int):
        return float(path.reference)
    eye, name = path.reference.eye, mechanism.linkage.name
    words = f"thread: the extreme height of eye '{eye}' of '{name}' needs a full turn of the crank, which"
    if mechanism.linkage.is_linear:
        raise LinkproofError(f"{words} its linear drive does not make; give a place of the drive as the reference")
    try:
        mechanism.check_full_turn()
    except AssemblyError as error:
        raise LinkproofError(f"{words} it cannot make; give a crank angle as the reference") from error
    angles = zeros(lambda phi: mechanism.sweep(phi).point(eye, 1)[1])
    if not len(angles):
        raise LinkproofError(
            f"thread: expected an eye that moves up and down, got '{eye}' of '{name}', which does not; name another "
            "point"
        )
    heights = mechanism.sweep(angles).point(eye)[1]
    return float(angles[np.argmax(heights) if path.reference.extreme == "highest" else np.argmin(heights)])


def reference_length(mechanism: Mechanism, path: ThreadPath) -> float:
    """L(φ_ref), m: the contour's length at which the feed is ΔP."""
    return float(contour_length(mechanism.sweep(reference_angle(mechanism, path)), path))


def feed(mechanism: Mechanism, path: ThreadPath, angle: ArrayLike) -> Array:
    """Actual feed Pd(φ), m, at crank angles of any shape, rad."""
    length = contour_length(mechanism.sweep(angle), path)
    return np.asarray(feed_of_length(path, length, reference_length(mechanism, path)))


def feed_of_length(path: ThreadPath, length: Scalar, start: float) -> Scalar:
    """Feed, m, of a contour of the given length, m, from its length ``start`` at the reference angle, m."""
    sign = -1.0 if path.feed == "shortening" else 1.0
    return sign * (length - start) + path.stretch
