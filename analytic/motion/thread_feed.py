"""The thread's contour and feed over the crank angle (articles 002 and 004).

The contour's length is the sum of the straight distances between its stops, guides and eyes, in space (article 002,
eqs (19)-(21); article 004, eqs (15)-(17)); the thickness of guides and eyes is neglected. The feed is the contour's
change from a reference position, plus the thread's stretch (article 002, eqs (22) and (23); article 004, eqs (21)-(24),
where D(φ_bottom) − D(φ) = L(φ_bottom) − L(φ)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.thread_path import ThreadEye, ThreadPath
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.refine import Extremes, extremes, grid, zeros

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
    return np.asarray(_feed_sign(path) * (np.asarray(length) - start) + path.stretch)


def _feed_sign(path: ThreadPath) -> float:
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


# Required against actual feed of thread: the curve a stitch needs, from the user's file, beside the mechanism's.

COLUMNS: Final = ("phi_deg", "feed_mm")
FORM: Final = f"two columns, {' and '.join(COLUMNS)}"
MM: Final = 1e-3


@dataclass(frozen=True)
class RequiredFeed:
    """Crank angles, rad, and the feed required at each, m; both (n,), in the file's order."""

    angle: Array
    feed: Array


@dataclass(frozen=True)
class FeedComparison:
    """Required and actual feed, m, at the crank angles of the required curve, rad; all (n,)."""

    angle: Array
    required: Array
    actual: Array

    @property
    def difference(self) -> Array:
        """Actual less required, m: positive where the mechanism gives more thread than the stitch needs."""
        return self.actual - self.required


def compare_feed(mechanism: Mechanism, path: ThreadPath, required: RequiredFeed) -> FeedComparison:
    """The mechanism's feed at the angles of a required curve."""
    return FeedComparison(required.angle, required.feed, feed(mechanism, path, required.angle))


def read_required_feed(path: str | Path) -> RequiredFeed:
    """Read a required curve from a CSV file: crank angle in degrees and feed in mm.

    A first line with the columns' names is optional and may swap them; empty lines and lines that start with # are
    passed over. Columns are separated by commas, or by semicolons or tabs, in which case numbers may have decimal
    commas. Raises LinkproofError with the line at fault.
    """
    rows: list[tuple[float, float]] = []
    swapped = False
    for number, line in enumerate(_lines(Path(path)), start=1):
        fields = _cells_of_line(line)
        if not fields:
            continue
        if not rows and not any(_is_number(field) for field in fields):
            names = tuple(field.strip('"').lower() for field in fields)
            if sorted(names) != sorted(COLUMNS):
                raise LinkproofError(f"{path}, line {number}: expected {FORM}, got '{line.strip()}'; name them so")
            swapped = names != COLUMNS
            continue
        if len(fields) != len(COLUMNS) or not all(_is_number(field) for field in fields):
            raise LinkproofError(
                f"{path}, line {number}: expected {FORM}, with a finite number each, got '{line.strip()}'; correct it"
            )
        first, second = (float(field) for field in fields)
        rows.append((second, first) if swapped else (first, second))
    if not rows:
        raise LinkproofError(f"{path}: expected {FORM}, with a row for each crank angle, got none; add them")
    table = np.array(rows)
    return RequiredFeed(np.radians(table[:, 0]), MM * table[:, 1])


def _lines(path: Path) -> list[str]:
    """The lines of a CSV file; raises LinkproofError where it cannot be read."""
    try:
        return path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise LinkproofError(f"{path}: expected a text file in UTF-8, got other bytes; save it as UTF-8") from None
    except (OSError, ValueError) as error:
        raise LinkproofError(f"{path}: expected a readable CSV file, got '{error}'; check the path") from None


def _cells_of_line(line: str) -> list[str]:
    """The cells of a line of a CSV file; none for an empty line or a comment."""
    text = line.strip()
    if not text or text.startswith("#"):
        return []
    mark = next((mark for mark in (";", "\t") if mark in text), None)
    if mark is None:
        return [field.strip() for field in text.split(",")]
    return [field.strip().replace(",", ".") for field in text.split(mark)]


def _is_number(field: str) -> bool:
    try:
        return math.isfinite(float(field))
    except ValueError:
        return False
