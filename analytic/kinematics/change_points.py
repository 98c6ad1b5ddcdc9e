"""Change points: crank angles at which a dyad's two assembly modes meet and neither ends, passed smoothly.

There the radicand of the dyad's closure equation has a double root. Its links go on smoothly where the sign W changes,
so W becomes a piecewise constant function of φ. It need not have the period of a turn: with one change point a turn the
linkage is in its other mode in every second one.

Beside a change point at a distance δ the closed form loses digits: poses err by eps/δ, first derivatives by eps/δ²,
second ones by eps/δ³. Smooth they are all the same, so within a patch about the point they are read from series in
Chebyshev polynomials, one for each derivative, fitted to the closed form at nodes of which none lies on the point. The
nodes are worked out in extended precision where the machine has it. The lengths there are those that touch exactly: the
radicand's minimum, a rounding of the file's numbers, would otherwise count δ⁻² times.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from analytic.description.linkage import GROUND
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.dyads.arms import ROUNDING
from analytic.kinematics.structure import Dyad, Revolute, Structure
from analytic.kinematics.sweep import FIXED, crank_motion

Array = NDArray[np.float64]
Solved = dict[str, Any]

FULL_TURN: Final = 2.0 * np.pi
GRID: Final = 720  # crank angles a turn at which a touch is looked for
COARSE: Final = 1e-2  # of the lengths: how near to touching a sample beside a change point is at least
LOOK, LOOKS = 17, 14  # each look at a touch shrinks its bracket 8-fold, half a degree to the root of extended rounding
# What the file's numbers, once rounded, leave of a touch, over the lengths it is computed from.
TOUCHING: Final = 2.0 * ROUNDING
ON_TOP: Final = 1e-6  # of the lengths: a gap between the outer pins below which they meet, and the dyad turns freely
QUARTIC: Final = 8.0  # of a double root the radicand grows fourfold over twice the distance, of a fourfold one 16 times
NEAR: Final = 0.02  # rad, that distance
FOLDED: Final = "have their outer pins on top of each other and turn about them freely; move one of the pivots"
MERGED: Final = (
    "turn round on a change point, or pass two of them within two degrees: which way they go on hangs on roundings; "
    "change a length"
)
SIDES: Final = np.array([-1.0, 1.0])
BESIDE: Final = 0.5  # rad: what is so near to a change point is computed with the lengths that touch there
NODES: Final = 24
WIDTHS: Final = (0.4, 0.25, 0.15, 0.1, 0.06, 0.03, 0.015)  # rad, half a patch
FITTED: Final = 64.0 * float(np.finfo(float).eps)  # last terms of a series over its largest value
NEAREST_NODE: Final = float(np.sin(0.5 * np.pi / NODES))  # of half a patch from its centre
EXTENDED: Final = bool(np.finfo(np.longdouble).eps < np.finfo(float).eps)  # whether this machine has more digits
INNER: Final = 0.05  # of half a patch: nearer than any node
APART: Final = 0.45  # of the distance of two change points


class Touch(NamedTuple):
    """A crank angle, rad, at which a dyad's margin is a rounding, m, of the lengths; and the outer pins' gap there."""

    angle: Any
    margin: Any
    lengths: Any
    gap: Any


class Undetermined(NamedTuple):
    """A dyad, a crank angle, rad, and why its motion there is not told: a folded kite, change points that merge."""

    dyad: Dyad
    angle: float
    reason: str


@dataclass(frozen=True, eq=False)
class Patch:
    """The surroundings of a change point, up to ``half`` on either side, rad.

    ``series``: by order of derivative the coefficients (NODES, 8 or 6) of both links' poses, rates, accelerations.
    """

    touch: Touch
    half: float
    series: tuple[Array, Array, Array]
    extended: tuple[NDArray[np.longdouble], ...]

    def values(self, order: int, place: Any) -> Any:  # noqa: ANN401 - of either precision
        """Both links' numbers of an order at places of [-1, 1], (8 or 6, n)."""
        series = self.extended if np.asarray(place).dtype == np.longdouble else self.series
        return chebyshev.chebval(place, series[order])


@dataclass(frozen=True, eq=False)
class ChangePoints:
    """Those of a dyad: crank angles, rad, rising within a ``period``, the sign W below the first one, the patches."""

    angles: tuple[float, ...]
    period: float
    first_sign: float
    patches: tuple[Patch, ...] = ()

    def signs(self, angle: Any) -> Array:  # noqa: ANN401 - of either precision
        """W at crank angles, rad."""
        passed = np.searchsorted(self.angles, np.mod(angle, self.period), "right")
        return np.where(passed % 2 == 0, self.first_sign, -self.first_sign)

    def inside(self, angle: Any) -> Iterator[tuple[Patch, NDArray[np.intp], Any]]:  # noqa: ANN401
        """Each patch with the flat indices of the crank angles within it and their places there, in [-1, 1].

        Of angles in extended precision only those nearer to a change point than any node.
        """
        flat = np.ravel(angle)
        for patch in self.patches:
            away = np.mod(flat - float(patch.touch.angle) + 0.5 * self.period, self.period) - 0.5 * self.period
            reach = patch.half * (INNER if flat.dtype == np.longdouble else 1.0)
            within = np.flatnonzero(np.abs(away) < reach)
            if len(within):
                yield patch, within, away[within] / patch.half

    def moves(self, angle: Any, away: Any) -> Any:  # noqa: ANN401
        """Where the dyad can move: away from its dead positions, and within patches."""
        result = np.array(np.broadcast_to(away, np.shape(angle)))
        for _, within, _ in self.inside(angle):
            result.reshape(-1)[within] = True
        return result

    def patched(self, angle: Any, order: int, pair: tuple[Any, Any]) -> tuple[Any, Any]:  # noqa: ANN401
        """Poses of the dyad's two links, or their derivatives, with those within patches read from the series."""
        result, size = None, len(pair[0])
        for patch, within, place in self.inside(angle):
            if result is None:
                result = [np.array(np.broadcast_to(np.asarray(part), np.shape(angle))) for part in (*pair[0], *pair[1])]
            for part, values in zip(result, patch.values(order, place), strict=True):
                part.reshape(-1)[within] = values
        return pair if result is None else (tuple(result[:size]), tuple(result[size:]))


def through_change_points(structure: Structure, angle: float) -> tuple[Structure, tuple[Undetermined, ...]]:
    """The structure with the change points of its dyads; ``angle``, rad, is where its signs hold.

    And the dyads that are followed through no series somewhere.
    """
    if not is_followed(structure):
        return structure, ()
    search = _Search(structure, angle)
    for number in range(len(structure.dyads)):
        search.look_at(number)
    return replace(structure, groups=tuple(search.dyads)), tuple(search.undetermined)


def is_followed(structure: Structure) -> bool:
    """Whether a linkage goes on through its change points: with a driver that is pushed it ends there."""
    return isinstance(structure.pivot, Revolute) and not structure.is_numerical


class _Search:
    """Dyad after dyad: those before it are followed through their own change points already."""

    def __init__(self, structure: Structure, start: float) -> None:
        self.dyads = list(structure.dyads)
        assert structure.pivot is not None
        self.pivot, self.start = structure.pivot, start
        self.period = FULL_TURN
        self.undetermined: list[Undetermined] = []
        self.centres: list[Any] = []
        self.nodes: dict[tuple[float, float], _Nodes] = {}
        self.grid_up_to(0)

    def placed(self, angle: Any) -> list[Solved]:  # noqa: ANN401
        """Poses, rates and accelerations of ground and crank."""
        moving = crank_motion(self.pivot, angle)
        return [{GROUND: ground, self.pivot.far: own} for ground, own in zip(FIXED, moving, strict=True)]

    def grid_up_to(self, number: int) -> None:
        """Poses over the period of the bodies of all dyads before one."""
        self.grid = np.arange(round(GRID * self.period / FULL_TURN)) * (FULL_TURN / GRID)
        self.poses = self.placed(self.grid)[0]
        for dyad in self.dyads[:number]:
            self._add(dyad)

    def _add(self, dyad: Dyad) -> DyadSolver:
        solver = DyadSolver(dyad, self.grid)
        self.poses[dyad.first], self.poses[dyad.second] = solver.poses(self.poses)
        return solver

    def look_at(self, number: int) -> None:
        """Find a dyad's change points, if it has any."""
        dyad = self.dyads[number]
        solver = self._add(dyad)
        if not dyad.has_two_modes:
            return
        touches = list(self._touches(number, solver))
        if all(touch.gap <= ON_TOP * touch.lengths for touch in touches):
            self.undetermined += [Undetermined(dyad, float(touch.angle), FOLDED) for touch in touches]
            return
        touches.sort(key=lambda touch: touch.angle)
        period = self.period
        if len(touches) % 2:
            self.period *= 2.0
            touches += [touch._replace(angle=touch.angle + period) for touch in touches]
        angles = tuple(float(touch.angle) for touch in touches)
        here = int(np.searchsorted(angles, np.mod(self.start, self.period), "right"))
        points = ChangePoints(angles, self.period, float(dyad.sign * (-1) ** here))
        self.dyads[number] = replace(dyad, changes=points)
        patches = tuple(self._patch(number, touch, _apart(angles, touch, self.period)) for touch in touches)
        self.dyads[number] = replace(dyad, changes=replace(points, patches=patches))
        if self.period == period:
            self._add(self.dyads[number])
        else:
            self.grid_up_to(number + 1)

    def _touches(self, number: int, solver: DyadSolver) -> Iterator[Touch]:
        """Where the links' margin touches zero."""
        with np.errstate(invalid="ignore"):
            margin, lengths = np.broadcast_arrays(*solver.missing(), self.grid)[:2]
            low = (np.abs(margin) <= COARSE * lengths) & (margin <= np.roll(margin, 1)) & (margin < np.roll(margin, -1))
        for angle in self.grid[low]:
            touch = self._closed_in(number, angle)
            if abs(touch.margin) > TOUCHING * touch.lengths:
                continue
            one, two = (self._margin(number, touch.angle + far * SIDES)[0].sum() for far in (NEAR, 2.0 * NEAR))
            if not two < QUARTIC * one:
                if np.isfinite(two):
                    self.undetermined.append(Undetermined(self.dyads[number], float(touch.angle), MERGED))
                continue
            self.centres.append(touch.angle)
            yield touch._replace(angle=np.mod(touch.angle, self.period))

    def _margin(self, number: int, angle: Any) -> tuple[Any, Any, Any]:  # noqa: ANN401
        """What is left of a dyad's margin, the lengths it comes from, and the gap between the outer pins."""
        angle = np.asarray(angle, dtype=np.longdouble)
        known = self.placed(angle)
        self._solve(known, 0, angle, 0, number)
        solver = DyadSolver(self.dyads[number], angle)
        solver.poses(known[0])
        with np.errstate(invalid="ignore"):
            margin, lengths = solver.missing()
        margin, lengths, gap = np.broadcast_arrays(np.where(np.isnan(margin), np.inf, margin), lengths, solver.gap())
        return margin, lengths, gap

    def _closed_in(self, number: int, angle: float) -> Touch:
        """The minimum of the margin beside a crank angle; that of a dyad before it, if it is the same."""
        for near in self.centres:
            touch = Touch(near, *(part[0] for part in self._margin(number, [near])))
            if abs(_turned(near - angle)) < FULL_TURN / GRID and abs(touch.margin) <= TOUCHING * touch.lengths:
                return touch
        centre, reach = np.longdouble(angle), np.longdouble(FULL_TURN / GRID)
        for _ in range(LOOKS):
            places = centre + reach * np.linspace(-1.0, 1.0, LOOK)
            parts = self._margin(number, places)
            best = int(np.argmin(parts[0]))
            centre, reach = places[best], reach / ((LOOK - 1) // 2)
        return Touch(centre, *(part[best] for part in parts))

    def _solve(self, known: list[Solved], first: int, angle: Any, order: int, last: int) -> None:  # noqa: ANN401
        """Adds the bodies of the dyads from one to before another, with derivatives up to an order."""
        for dyad in self.dyads[first:last]:
            solver = DyadSolver(dyad, angle)
            for patch in dyad.changes.patches if dyad.changes else ():
                if np.all(np.abs(_turned(angle - patch.touch.angle)) < BESIDE):
                    solver.touch(patch.touch.margin, patch.touch.gap)
            steps = (solver.poses, solver.rates, solver.accelerations)
            for rank in range(order + 1):
                known[rank][dyad.first], known[rank][dyad.second] = steps[rank](known[rank])

    def _patch(self, number: int, touch: Touch, apart: float) -> Patch:
        """The widest patch whose series end in rounding, or the one whose series come nearest to it."""
        best: tuple[float, Patch] | None = None
        for half in WIDTHS:
            if half > APART * apart and half != WIDTHS[-1]:
                continue
            series = tuple(self._series(number, touch, half))
            tail = max(_tail(part) for part in series)
            if best is None or tail < best[0]:
                plain = (series[0].astype(float), series[1].astype(float), series[2].astype(float))
                best = tail, Patch(touch, half, plain, series)
            if tail <= FITTED:
                break
        assert best is not None
        return best[1]

    def _series(self, number: int, touch: Touch, half: float) -> Iterator[Any]:
        """By order, the coefficients (NODES, parts) of both links' numbers."""
        dyad = self.dyads[number]
        half_turn = np.arccos(np.longdouble(-1.0))  # π of extended precision
        places = np.cos(half_turn * (np.arange(NODES, dtype=np.longdouble) + 0.5) / NODES)
        key = (float(touch.angle), half)
        if key not in self.nodes:
            self.nodes[key] = _Nodes(touch.angle + half * places, self.placed(touch.angle + half * places), 0)
        nodes = self.nodes[key]
        self._solve(nodes.known, nodes.done, nodes.angle, 2, number)
        nodes.done = number
        known = [dict(solved) for solved in nodes.known]
        solver = DyadSolver(dyad, nodes.angle)
        solver.touch(touch.margin, touch.gap)
        steps: tuple[Any, ...] = (solver.poses, solver.rates, solver.accelerations)
        for solved, step in zip(known, steps, strict=True):
            solved[dyad.first], solved[dyad.second] = step(solved)
        analysis = chebyshev.chebvander(places, NODES - 1) * (np.longdouble(2.0) / NODES)
        analysis[:, 0] *= 0.5
        for solved in known:
            parts = itertools.chain(solved[dyad.first], solved[dyad.second])
            values = np.stack([np.broadcast_to(np.asarray(part, dtype=np.longdouble), places.shape) for part in parts])
            with np.errstate(invalid="ignore"):
                yield analysis.T @ values.T


@dataclass
class _Nodes:
    """The nodes of patches of one centre and width, and the bodies of the first dyads there."""

    angle: Any
    known: list[Solved]
    done: int


def _apart(angles: tuple[float, ...], touch: Touch, period: float) -> float:
    """Distance of a change point from the next one of the dyad, rad; the period if there is no other."""
    others = [abs((angle - float(touch.angle) + 0.5 * period) % period - 0.5 * period) for angle in angles]
    return min((other for other in others if other > 0.0), default=period)


def _turned(angle: Any) -> Any:  # noqa: ANN401
    """An angle brought to within half a turn of zero."""
    return np.mod(angle + np.pi, FULL_TURN) - np.pi


def _tail(series: Any) -> float:  # noqa: ANN401
    """Last terms of the series over the largest of all; infinite where it is no number."""
    with np.errstate(all="ignore"):
        tail = np.max(np.abs(series[-3:])) / (np.max(np.abs(series)) or 1.0)
    return float(tail) if np.isfinite(tail) else np.inf


def period_of(structure: Structure) -> float:
    """The crank angle after which the linkage moves as before, rad: a turn, or several."""
    return max((dyad.changes.period for dyad in structure.dyads if dyad.changes), default=FULL_TURN)
