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
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND
from analytic.kinematics.branch import NODES, ChangePoints, Patch, Touch, Windows
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.dyads import ROUNDING
from analytic.kinematics.structure import ClosedGroup, Prismatic, Revolute, Structure
from analytic.kinematics.sweep import FIXED, crank_motion
from analytic.numerics.roots import find_lowest, may_touch_zero

GRID: Final = 720  # crank angles a turn at which a touch is looked for
LOOK, LOOKS = 17, 14  # each look at a touch shrinks its bracket 8-fold, half a degree to the root of extended rounding
# What the file's numbers, once rounded, leave of a touch, over the lengths it is computed from.
TOUCHING: Final = 2.0 * ROUNDING
ON_TOP: Final = 1e-6  # of the lengths: a gap between the outer pins below which they meet, and the dyad turns freely
QUARTIC: Final = 8.0  # of a double root the radicand grows fourfold over twice the distance, of a fourfold one 16 times
NEAR: Final = 0.02  # rad, that distance
FOLDED: Final = "have their outer pins on top of each other and turn about them freely; move one of the pivots"
MERGED: Final = (
    "turn round on a change point, or pass two of them within two degrees: their further motion depends on rounding "
    "errors; change a length"
)
SIDES: Final = np.array([-1.0, 1.0])
BESIDE: Final = 0.5  # rad: what is so near to a change point is computed with the lengths that touch there
WIDTHS: Final = (0.4, 0.25, 0.15, 0.1, 0.06, 0.03, 0.015)  # rad, half a patch
FITTED: Final = 64.0 * float(np.finfo(float).eps)  # last terms of a series over its largest value
APART: Final = 0.45  # of the distance of two change points


class Undetermined(NamedTuple):
    """A dyad, a crank angle, rad, and why its motion there is undetermined: a folded kite, change points that merge."""

    dyad: ClosedGroup
    angle: float
    reason: str


def with_change_points(structure: Structure, angle: float) -> tuple[Structure, tuple[Undetermined, ...]]:
    """The structure with the change points of its dyads, and the dyads whose motion is undetermined somewhere.

    ``angle``, rad, is where the signs of the structure hold. A linkage that is not followed through change points keeps
    its structure.
    """
    if not is_followed(structure):
        return structure, ()
    search = _ChangePointSearch(structure, angle)
    for number in range(len(structure.dyads)):
        search.find_change_points(number)
    return replace(structure, groups=tuple(search.dyads)), tuple(search.undetermined)


def is_followed(structure: Structure) -> bool:
    """Whether the linkage is followed through change points: its driver turns and no group is numerical."""
    return isinstance(structure.pivot, Revolute) and not structure.is_numerical


class _Chain:
    """Poses of the bodies at crank angles, and derivatives up to an ``order``: of each dyad once, the next when needed.

    Near a change point of a dyad on the way, its links have the lengths that touch there.
    """

    def __init__(self, pivot: Revolute | Prismatic, angle: Any, order: int = 0) -> None:  # noqa: ANN401
        """Place the ground and the driver at these angles, rad, with derivatives up to ``order``, 0 to 2.

        The driver moves at the ``pivot``. The angles, of any shape, may be in extended precision.
        """
        self.angle = np.asarray(angle)
        self.windows: Windows = {}
        moving = crank_motion(pivot, self.angle)[: order + 1]
        self.known: list[dict[str, Any]] = [
            {GROUND: fixed, pivot.far: driver} for fixed, driver in zip(FIXED, moving, strict=False)
        ]
        self.done = 0
        self.fails = np.zeros(self.angle.shape, dtype=bool)  # where a dyad solved so far cannot be assembled

    def poses_before(self, dyads: Sequence[ClosedGroup]) -> list[dict[str, Any]]:
        """The poses, by body, once these dyads are solved: a mapping for every order of derivative.

        The dyads are the first ones of the linkage, of which those solved already are not solved again. Notes in
        ``fails`` where one of them cannot be assembled.
        """
        for dyad in dyads[self.done :]:
            patches = dyad.changes.patches if dyad.changes else ()
            touches = [patch.touch for patch in patches]
            beside = [
                touch for touch in touches if np.all(np.abs(_within_half_turn(self.angle - touch.angle)) < BESIDE)
            ]
            margin, lengths = self.solve(dyad, self.known, beside).form.reach_margin()
            self.fails |= ~(margin >= -TOUCHING * lengths)
        self.done = len(dyads)
        return self.known

    def solve(self, dyad: ClosedGroup, known: list[dict[str, Any]], touches: Sequence[Touch] = ()) -> DyadSolver:
        """Solve a dyad, enter its links' motion in ``known``, in place, and return its solver.

        ``known`` has the bodies' poses by name, then their derivatives. ``touches`` fix lengths that just meet.
        """
        solver = DyadSolver(dyad, self.angle, self.windows)
        for touch in touches:
            solver.form.snap_to_touch(touch.margin, touch.gap)
        steps: tuple[Any, ...] = (solver.poses, solver.rates, solver.accelerations)
        for solved, step in zip(known, steps, strict=False):
            solved.update(zip(dyad.links, step(solved), strict=True))
        return solver


class _ChangePointSearch:
    """Dyad after dyad: those before it are followed through their own change points already.

    The results are ``dyads``, with their change points, and the ``undetermined`` ones.
    """

    def __init__(self, structure: Structure, start: float) -> None:
        """Prepare to search the dyads one by one; ``start``, rad, is where the structure's signs hold."""
        self.dyads = list(structure.dyads)
        assert structure.pivot is not None
        self.pivot, self.start = structure.pivot, start
        self.period = FULL_TURN
        self.undetermined: list[Undetermined] = []
        self.centres: list[_Chain] = []
        self.beside: dict[tuple[float, float], _Chain] = {}  # by a change point and a distance from it
        self.grid = self._grid()

    def _grid(self) -> _Chain:
        """The chain at evenly spaced crank angles over the period, half a degree apart."""
        return _Chain(self.pivot, np.arange(round(GRID * self.period / FULL_TURN)) * (FULL_TURN / GRID))

    def find_change_points(self, number: int) -> None:
        """Find a dyad's change points and put their patches into ``dyads``; note where it is undetermined.

        ``number`` is the dyad's; one with a single mode is left as it is. An odd number of change points doubles the
        ``period``.
        """
        dyad = self.dyads[number]
        if not dyad.has_two_modes:
            return
        touches = list(self._touches(number))
        if all(touch.gap <= ON_TOP * touch.lengths for touch in touches):
            self.undetermined += [Undetermined(dyad, float(touch.angle), FOLDED) for touch in touches]
            return
        touches.sort(key=lambda touch: touch.angle)
        if len(touches) % 2:
            touches += [touch._replace(angle=touch.angle + self.period) for touch in touches]
            self.period *= 2.0
            self.grid = self._grid()
        angles = tuple(float(touch.angle) for touch in touches)
        here = int(np.searchsorted(angles, np.mod(self.start, self.period), "right"))
        points = ChangePoints(angles, self.period, float(dyad.sign * (-1) ** here))
        self.dyads[number] = replace(dyad, changes=points)
        patches = tuple(self._patch(number, touch, _distance_to_next(angles, touch, self.period)) for touch in touches)
        self.dyads[number] = replace(dyad, changes=replace(points, patches=patches))

    def _touches(self, number: int) -> Iterator[Touch]:
        """Yield the touches at which the margin of reach of dyad ``number`` comes down to zero, by the crank angle.

        Those that merge are noted as undetermined instead.
        """
        share = self._relative_margin(number, self.grid)
        around = np.concatenate([share[-1:], share, share[:1]])
        for angle in self.grid.angle[may_touch_zero(around, TOUCHING)]:
            touch = self._find_touch(number, angle)
            if touch is None:
                continue
            far = self._chain_beside(touch, NEAR, np.multiply.outer([1.0, 2.0], SIDES))
            near, twice = self._margin(number, far)[0].sum(axis=1)
            if twice < QUARTIC * near:
                yield touch._replace(angle=np.mod(touch.angle, self.period))
            elif np.isfinite(twice):
                self.undetermined.append(Undetermined(self.dyads[number], float(touch.angle), MERGED))

    def _chain_beside(self, touch: Touch, distance: float, places: Any, order: int = 0) -> _Chain:  # noqa: ANN401
        """The chain at ``places`` of -1 to 1, times a distance, rad, from the change point of a ``touch``.

        It has derivatives up to ``order``; dyads that have a change point there share it: it is kept by angle and
        distance.
        """
        key = (float(touch.angle), distance)
        if key not in self.beside:
            self.beside[key] = _Chain(self.pivot, touch.angle + distance * places, order)
        return self.beside[key]

    def _margin(self, number: int, chain: _Chain) -> tuple[Any, Any, Any]:
        """A dyad's margin of reach, m, the lengths it comes from, and the gap between the outer pins, m, along a chain.

        ``number`` is the dyad's. The margin is infinite where the dyad, or one before it, cannot be placed.
        """
        poses = chain.poses_before(self.dyads[:number])[0]
        solver = chain.solve(self.dyads[number], [dict(poses)])
        with np.errstate(invalid="ignore"):
            margin, lengths = solver.form.reach_margin()
        margin = np.where(np.isnan(margin) | chain.fails, np.inf, margin)
        margin, lengths, gap = np.broadcast_arrays(margin, lengths, solver.form.gap())
        return margin, lengths, gap

    def _find_touch(self, number: int, angle: float) -> Touch | None:
        """The touch of dyad ``number`` within a grid step of a crank angle, rad; None where its margin stays off zero.

        Where an earlier search has a centre at which this dyad touches too, the angle is that centre's; a new centre is
        kept for later searches.
        """
        for near in self.centres:
            if abs(_within_half_turn(near.angle[0] - angle)) < FULL_TURN / GRID:
                touch = self._touch_of_chain(number, near)
                if abs(touch.margin) <= TOUCHING * touch.lengths:
                    return touch
        step = np.longdouble(FULL_TURN / GRID)
        bracket = np.array([angle - step]), np.array([angle + step])
        centre, height = find_lowest(
            lambda at: self._relative_margin(number, _Chain(self.pivot, at)),
            *bracket,
            LOOKS,
            points=LOOK,
            enough=-TOUCHING,
        )
        if abs(height[0]) > TOUCHING:
            return None
        self.centres.append(_Chain(self.pivot, centre))
        return self._touch_of_chain(number, self.centres[-1])

    def _relative_margin(self, number: int, chain: _Chain) -> Any:  # noqa: ANN401
        """The margin of reach of dyad ``number`` over the lengths it comes from, at the angles of a chain."""
        margin, lengths, _ = self._margin(number, chain)
        return margin / lengths

    def _touch_of_chain(self, number: int, chain: _Chain) -> Touch:
        """The touch of dyad ``number`` at the first angle of a chain."""
        return Touch(chain.angle[0], *(part[0] for part in self._margin(number, chain)))

    def _patch(self, number: int, touch: Touch, apart: float) -> Patch:
        """The widest patch about a touch whose series end in rounding, or the one whose series come nearest to it.

        Half of it is at most 0.45 of ``apart``, the distance to the next change point, rad, or else 0.015 rad, the
        least; ``number`` is the dyad's.
        """
        best: tuple[float, Patch] | None = None
        for half in WIDTHS:
            if half > APART * apart and half != WIDTHS[-1]:
                continue
            series = tuple(self._series(number, touch, half))
            tail = max(_relative_tail(part) for part in series)
            if best is None or tail < best[0]:
                plain = (series[0].astype(float), series[1].astype(float), series[2].astype(float))
                best = tail, Patch(touch, half, plain, series)
            if tail <= FITTED:
                break
        assert best is not None
        return best[1]

    def _series(self, number: int, touch: Touch, half: float) -> Iterator[Any]:
        """Yield, for each order, the coefficients (NODES, parts) of both links' series about a dyad's touch.

        The patch reaches ``half``, rad, to either side; ``number`` is the dyad's.
        """
        dyad = self.dyads[number]
        half_turn = np.arccos(np.longdouble(-1.0))  # π of extended precision
        places = np.cos(half_turn * (np.arange(NODES, dtype=np.longdouble) + 0.5) / NODES)
        nodes = self._chain_beside(touch, half, places, 2)
        known = [dict(solved) for solved in nodes.poses_before(self.dyads[:number])]
        nodes.solve(dyad, known, [touch])
        analysis = chebyshev.chebvander(places, NODES - 1) * (np.longdouble(2.0) / NODES)
        analysis[:, 0] *= 0.5
        for solved in known:
            parts = itertools.chain(*(solved[link] for link in dyad.links))
            values = np.stack([np.broadcast_to(np.asarray(part, dtype=np.longdouble), places.shape) for part in parts])
            with np.errstate(invalid="ignore"):
                yield analysis.T @ values.T


def _distance_to_next(angles: tuple[float, ...], touch: Touch, period: float) -> float:
    """Distance of a change point from the next one of the dyad, rad; the period if it is the only one."""
    others = [abs((angle - float(touch.angle) + 0.5 * period) % period - 0.5 * period) for angle in angles]
    return min((other for other in others if other > 0.0), default=period)


def _within_half_turn(angle: Any) -> Any:  # noqa: ANN401
    """An angle, rad, any shape, with whole turns taken off, so that it is in [-π, π)."""
    return np.mod(angle + np.pi, FULL_TURN) - np.pi


def _relative_tail(series: Any) -> float:  # noqa: ANN401
    """The truncation of a series (terms, parts): its last terms over its largest; infinite if it is not finite."""
    with np.errstate(all="ignore"):
        tail = np.max(np.abs(series[-3:])) / (np.max(np.abs(series)) or 1.0)
    return float(tail) if np.isfinite(tail) else np.inf


def period_of(structure: Structure) -> float:
    """The crank angle after which the linkage moves as before, rad: a turn, or several.

    It is a turn also of a driver that is pushed.
    """
    return max((dyad.changes.period for dyad in structure.dyads if dyad.changes), default=FULL_TURN)
