"""The smooth motion of the start state over the driver's coordinate φ.

The velocity q' of the joints' equations, G q' = e, is integrated over φ by SciPy. What the integration is off by stays
small, as the joints' own violation pulls it back (J. Baumgarte, Computer Methods in Applied Mechanics and Engineering
1, 1972), and Newton's method removes it from every pose that is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from analytic.description.law import FULL_TURN
from engines.direct_adapter.solution import Equations, UnsolvableError
from engines.mechanics.states import Pose, Reals, pose_of

RELATIVE, ABSOLUTE = 1e-9, 1e-9  # of the integration, units and rad: near enough for Newton's method
PULL = 4.0  # 1/rad, at which a violation of the joints fades
LONGEST = FULL_TURN / 16.0  # rad or units, between two poses of which one could be in another assembly mode
EVALUATIONS = 5000  # a turn; an integration that needs more has come to a stop, where steps shrink without end
SHUT = 1e-6  # units and rad between the two ends of a full turn


@dataclass(frozen=True)
class Path:
    """Poses from ``low`` to ``high``, rad or units, both at most as far as the linkage can move.

    ``turns`` (bodies,) is each body's turn in rad over a full turn of the crank, after which all repeats; None where
    the path has two ends.
    """

    equations: Equations
    low: float
    high: float
    gain: Callable[[Reals], Reals]
    turns: Reals | None

    def closed(self, coordinate: Reals) -> Pose:
        """The poses at φ (n,), the driver exactly there; raises UnsolvableError where they cannot be closed."""
        number = np.zeros(len(coordinate))
        if self.turns is not None:
            number = np.floor((coordinate - self.low) / FULL_TURN)
        pose = _pose(self.equations, self.gain(coordinate - FULL_TURN * number), coordinate)
        pose = self.equations.close(pose, coordinate)
        if self.turns is None:
            return pose
        angle = pose.angle + number[:, None] * self.turns
        angle[:, self.equations.driver.crank] = coordinate
        return Pose(pose.place, angle, pose.cosine, pose.sine)


def reach(equations: Equations, low: float, high: float) -> Path:
    """The path that holds φ from ``low`` to ``high``, between which the start state lies, or as much as can be reached.

    Of a path that shuts after a full turn, one turn.
    """
    at_start = equations.start()
    start = float(equations.driven(at_start, equations.arms(at_start))[0])
    if equations.driver.turns and high - low > FULL_TURN:
        end, above = _followed(equations, start, start + FULL_TURN)
        gained = equations.spread(above(np.array([end])))[0]
        turns = FULL_TURN * np.round(gained[:, 2] / FULL_TURN)
        gained[:, 2] -= turns
        if end == start + FULL_TURN and np.max(np.abs(gained)) <= SHUT:
            return Path(equations, start, end, above, turns)
    bottom, below = _followed(equations, start, low)
    top, above = _followed(equations, start, high)

    def gain(coordinate: Reals) -> Reals:
        return np.where(coordinate[:, None] < start, below(coordinate), above(coordinate))

    return Path(equations, bottom, top, gain, None)


def _followed(equations: Equations, start: float, end: float) -> tuple[float, Callable[[Reals], Reals]]:
    """φ up to which the path can be followed towards ``end`` in its assembly mode, and the coordinates' gain (n, k).

    The gain is a function of φ (n,).
    """
    most = equations.solves + EVALUATIONS * (1.0 + abs(end - start) / FULL_TURN)

    def rate(coordinate: float, state: Reals) -> Reals:
        if equations.solves > most:
            return np.full_like(state, np.nan)
        place = np.array([coordinate])
        residual, matrix = equations.violation(_pose(equations, state[None], place), place)
        pull = PULL if end > start else -PULL
        try:
            return np.asarray(equations.solve(matrix, equations.crank_unit(1) - pull * residual)[0])
        except UnsolvableError:
            return np.full_like(state, np.nan)  # a step that is too long

    if end == start:
        return start, lambda coordinate: np.zeros((len(coordinate), equations.size))
    span, at_start = (start, end), np.zeros(equations.size)
    solution = solve_ivp(
        rate, span, at_start, "DOP853", dense_output=True, max_step=LONGEST, rtol=RELATIVE, atol=ABSOLUTE
    )
    places = solution.t
    matrices = equations.jacobian(equations.arms(_pose(equations, solution.y.T, places)))
    # Between two matrices on a line there is a singular one where one over the other has a negative eigenvalue: several
    # groups that cross at once leave the determinant its sign. What is repeated need not come out real.
    crossing = np.any(np.linalg.eigvals(np.linalg.solve(matrices[:-1], matrices[1:])).real < 0.0, axis=1)
    last = places[int(np.argmax(crossing))] if np.any(crossing) else places[-1]
    return float(last), lambda coordinate: np.asarray(solution.sol(coordinate).T)


def _pose(equations: Equations, gain: Reals, coordinate: Reals) -> Pose:
    """The poses of coordinates (n, k) from the start state on, the crank at φ."""
    coordinates = equations.start().coordinates() + equations.spread(gain)
    if equations.driver.turns:
        coordinates[..., equations.driver.crank, 2] = coordinate
    return pose_of(coordinates)
