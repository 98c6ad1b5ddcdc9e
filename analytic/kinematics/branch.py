"""Which configuration a group has over φ: the one that the sketch means, followed through change points."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage, Vector
from analytic.kinematics import frames
from analytic.kinematics.frames import Pose
from analytic.numerics.arrays import Array

# A configuration of a group over φ: nodes from which Newton's method finds the links anywhere between them.


@dataclass(frozen=True, eq=False)
class GroupBranch:
    """Nodes over φ, ``coordinate`` (m,), rad or m, increasing: ``state`` (m, 3, links, 3), x, y, θ and derivatives.

    ``unit``, m, is the length that weighs like a radian. ``turns`` (links,) is each link's angle per turn of a crank
    that returns to its start, rad; None for a branch with two ends. ``is_linear`` says that φ is a travel, m.
    ``strays`` says that a turn of the crank ends in another configuration.
    """

    coordinate: Array
    state: Array
    unit: float
    turns: Array | None
    is_linear: bool
    strays: bool = False

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest φ, rad or m, up to which the branch was followed."""
        return float(self.coordinate[0]), float(self.coordinate[-1])

    def wrapped(self, coordinate: Array) -> Array:
        """φ, rad, any shape, shifted by whole turns of a crank into the range of the nodes, or nearest to its middle.

        Of a linear driver, and of a branch with two ends that spans a turn, as it is.
        """
        if self.is_linear:
            return coordinate
        low, high = self.ends
        if self.turns is not None:
            return coordinate - FULL_TURN * np.floor((coordinate - low) / FULL_TURN)
        if high - low >= FULL_TURN:
            return coordinate
        return coordinate - FULL_TURN * np.round((coordinate - 0.5 * (low + high)) / FULL_TURN)

    def margin(self, coordinate: Array) -> Array:
        """Distance of φ, rad or m, any shape, from the nearer end, negative outside; infinite without ends."""
        if self.turns is not None:
            return np.full(np.shape(coordinate), np.inf)
        at, (low, high) = self.wrapped(coordinate), self.ends
        return np.asarray(np.minimum(at - low, high - at))

    def guess(self, coordinate: Array) -> Array:
        """Coordinates x, y, θ of the links near the exact ones at φ (n,), (n, links, 3), by quintics between the nodes.

        Of a branch without ends θ may be off by whole turns.
        """
        return quintic(self.coordinate, self.state, self.wrapped(coordinate))


def quintic(places: Array, state: Array, at: Array) -> Array:
    """Hermite's quintics through both neighbours' values and derivatives, at ``at`` (n,): (n, links, 3).

    ``places`` (m,) increase, ``state`` (m, 3, links, 3) has values, first and second derivatives there. Beyond the
    outermost places the value is theirs.
    """
    if len(places) == 1:
        return np.repeat(state[:, 0], len(at), axis=0)
    left = np.clip(np.searchsorted(places, at, side="right") - 1, 0, len(places) - 2)
    width = places[left + 1] - places[left]
    x = np.clip((at - places[left]) / width, 0.0, 1.0)
    result = np.zeros((len(at), *state.shape[2:]))
    for node, s, sign in ((left, x, 1.0), (left + 1, 1.0 - x, -1.0)):
        u = 1.0 - s
        weights = (
            u**3 * (1.0 + 3.0 * s + 6.0 * s * s),
            sign * width * u**3 * s * (1.0 + 3.0 * s),
            0.5 * width**2 * u**3 * s * s,
        )
        for order, weight in enumerate(weights):
            result += weight[:, None, None] * state[node, order]
    return result


# Passages through change points as they are read: angles at which W changes, and series about each of them.
#
# ``analytic.kinematics.change_points`` computes them.


NODES: Final = 24
NEAREST_NODE: Final = float(np.sin(0.5 * np.pi / NODES))  # of half a patch from its centre
EXTENDED: Final = bool(np.finfo(np.longdouble).eps < np.finfo(float).eps)  # whether this machine has more digits
INNER: Final = 0.05  # of half a patch: nearer than any node


class Touch(NamedTuple):
    """A crank angle, rad, at which a dyad's links just reach each other: its ``margin`` of reach, m, is a rounding.

    ``lengths``, m, are the sum of those that it is computed from, ``gap`` is the outer pins' distance there, m.
    """

    angle: Any
    margin: Any
    lengths: Any
    gap: Any


@dataclass(frozen=True, eq=False)
class Patch:
    """The surroundings of a change point, up to ``half`` on either side, rad.

    ``series``: by order of derivative the coefficients (NODES, 8 or 6) of both links' poses, rates, accelerations,
    those of the first link first; ``extended`` are the same with more digits.
    """

    touch: Touch
    half: float
    series: tuple[Array, Array, Array]
    extended: tuple[NDArray[np.longdouble], ...]

    def values(self, order: int, polynomials: Any) -> Any:  # noqa: ANN401 - of either precision
        """The numbers of both links' poses, (8, n), or of their derivatives of an order, (6, n).

        ``polynomials`` are those of a ``Window``, (n, NODES), whose precision the answer has.
        """
        series = self.extended if polynomials.dtype == np.longdouble else self.series
        with np.errstate(invalid="ignore"):  # a series that is not finite leaves its angles without an answer
            return (polynomials @ series[order]).T  # faster than chebval


@dataclass(frozen=True, eq=False)
class Window:
    """Flat indices of the crank angles within a patch, and their places there, in [-1, 1], (n,) each."""

    within: NDArray[np.intp]
    place: Any

    @cached_property
    def polynomials(self) -> Any:  # noqa: ANN401 - of either precision
        """Chebyshev polynomials at the places, (n, NODES), the same for every dyad and derivative."""
        return chebyshev.chebvander(self.place, NODES - 1)


# Windows of crank angles by the change point, the size of the patch and the period: dyads of one linkage share most.
Windows = dict[tuple[float, float, float], Window]


@dataclass(frozen=True, eq=False)
class ChangePoints:
    """Change points of a dyad: crank angles, rad, rising within ``period``, the sign W before the first, patches.

    ``period``, rad, is a turn or several.
    """

    angles: tuple[float, ...]
    period: float
    first_sign: float
    patches: tuple[Patch, ...] = ()

    def signs(self, angle: Any) -> Array:  # noqa: ANN401 - of either precision
        """The sign W of the dyad at crank angles, rad, any shape: 1.0 or -1.0, changing at every change point."""
        passed = np.searchsorted(self.angles, np.mod(angle, self.period), "right")
        return np.where(passed % 2 == 0, self.first_sign, -self.first_sign)

    def patches_at(self, angle: Any, known: Windows) -> Iterator[tuple[Patch, Window]]:  # noqa: ANN401
        """Yield each patch that holds some of the crank angles, rad, with its window of them.

        ``known`` has the windows found for these angles before, and gets the new ones. Of angles in extended precision
        only those count that are nearer to a change point than a twentieth of half its patch.
        """
        for patch in self.patches:
            centre = float(patch.touch.angle)
            key = (centre, patch.half, self.period)
            if key not in known:
                flat = np.ravel(angle)
                away = np.mod(flat - centre + 0.5 * self.period, self.period) - 0.5 * self.period
                reach = patch.half * (INNER if flat.dtype == np.longdouble else 1.0)
                within = np.flatnonzero(np.abs(away) < reach)
                known[key] = Window(within, away[within] / patch.half)
            if len(known[key].within):
                yield patch, known[key]

    def moves(self, angle: Any, away: Any, known: Windows) -> Any:  # noqa: ANN401
        """Whether the dyad can move at each crank angle, rad: where ``away`` is True, and within patches.

        ``away`` says which angles are far enough from dead positions; ``known`` has the windows of patches found
        before, and gets the new ones.
        """
        result = np.empty(np.shape(angle), dtype=bool)
        result[...] = away
        for _, window in self.patches_at(angle, known):
            result.reshape(-1)[window.within] = True
        return result

    def with_series(self, angle: Any, order: int, pair: tuple[Any, Any], known: Windows) -> tuple[Any, Any]:  # noqa: ANN401
        """The poses of both links, or their derivatives of an ``order``: ``pair``, but the series within patches.

        The pair is returned as it is where no crank angle, rad, lies in a patch. ``known`` has the windows of patches
        found before, and gets the new ones.
        """
        result, size = None, len(pair[0])
        for patch, window in self.patches_at(angle, known):
            if result is None:
                parts = (*pair[0], *pair[1])
                result = np.empty((len(parts), *np.shape(angle)), np.result_type(*parts))
                for number, part in enumerate(parts):
                    result[number, ...] = part
            result.reshape(len(result), -1)[:, window.within] = patch.values(order, window.polynomials)
        return pair if result is None else (tuple(result[:size]), tuple(result[size:]))

    def move_out_of_patches(self, angle: Array) -> None:
        """Move crank angles, rad, that lie within patches, in place, to the nodes that determine the series there.

        The series are no worse than the closed form at the edges of the patch or, where the machine has no extended
        precision, at the nodes nearest to the change point.
        """
        for patch, window in self.patches_at(angle, {}):
            from_centre = np.copysign(1.0 if EXTENDED else NEAREST_NODE, window.place)
            angle.reshape(-1)[window.within] += (from_centre - window.place) * patch.half


# Which of several configurations a sketch means: the one whose named points lie nearest to it.


# Two configurations closer to the sketch than this ratio of each other are not distinguished by it.
AMBIGUITY: Final = 0.9
TELLING: Final = 1e-6  # share of the drawing's size by which they must differ at a point for the sketch to show it
Points = Mapping[str, Mapping[str, Vector]]  # of links, by name, in their frames


def named_places(points: Points, poses: Iterable[Pose]) -> dict[str, Vector]:
    """Positions, m, ground frame, of the named points of links, by the points' names.

    ``points`` has, by link, each point's place in its frame, m; ``poses`` one pose per link, in that order, of a single
    φ, or of several, of which the first counts. Raises ValueError for another number of poses.
    """
    places = {}
    for locals_, pose in zip(points.values(), poses, strict=True):
        for point, local in locals_.items():
            x, y = (float(np.ravel(part)[0]) for part in frames.point(pose, local))
            places[point] = (x, y)
    return places


def nearest_to_sketch(linkage: Linkage, places: Sequence[Mapping[str, Vector]]) -> tuple[int, list[str] | None]:
    """The index of the configuration nearest to the sketch, and None; where that is unclear, names of points to add.

    ``places`` has for each configuration, of which there is one or more, the positions of points, m, by name. It is
    unclear where the second nearest is hardly farther. The names are of points that differ between these two, sorted;
    there may be none.
    """
    distances = [
        math.hypot(*(math.dist(place, linkage.sketch[p]) for p, place in configuration.items() if p in linkage.sketch))
        for configuration in places
    ]
    order = sorted(range(len(places)), key=lambda number: distances[number])
    if len(order) == 1 or distances[order[0]] < AMBIGUITY * distances[order[1]]:
        return order[0], None
    nearest, other = places[order[0]], places[order[1]]
    least = TELLING * linkage.extent()
    return order[0], sorted(point for point in nearest if math.dist(nearest[point], other[point]) > least)
