"""Change points, where two assembly modes cross: a path of poses leaps over them and is smooth on both sides.

Beside one at a distance δ the joints' equations are solved to eps/δ only, their derivatives to eps/δ² and eps/δ³. So
poses and their first two derivatives are solved at Chebyshev nodes on both sides, of which none lies on the point, and
interpolated in between. Beyond the point Newton's method starts from Taylor's series: at a distance δ the other mode is
as far off as δ, the series only as δ⁴. That the series in Chebyshev polynomials end in rounding shows that what was
found on both sides is one smooth motion: of a mode that turns back, or of a linkage that misses its change point by a
length e, they do not end, for each side is then off by e/δ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from engines.direct_adapter.assembly import Equations, UnsolvableError, close
from engines.direct_adapter.nodes import LEAST_STEP, Node, node, predicted, walk
from engines.direct_adapter.solution import bends, transfer
from engines.mechanics.states import Reals, pose_of

PLACES = 24  # nodes of a passage
LANDING = 0.25  # of half a passage: from where to where a path leaps
WIDTHS = (0.4, 0.25, 0.15, 0.1, 0.06)  # rad, half a passage
ENDED = 4e-14  # last terms of the poses' series over the largest: a few hundred roundings


@dataclass(frozen=True)
class Passage:
    """The surroundings of a change point, ``half`` rad to either side, and the path's nodes at its ends, in its order.

    ``series`` (PLACES, 3, bodies, 3) are Chebyshev's of poses and their first two derivatives, units and rad.
    """

    centre: float
    half: float
    ends: tuple[Node, Node]
    series: Reals

    def state(self, angle: Reals) -> Reals:
        """Poses and derivatives at crank angles (n,) within, (n, 3, bodies, 3)."""
        return np.moveaxis(chebyshev.chebval((angle - self.centre) / self.half, self.series), -1, 0)

    def holds(self, angle: Reals) -> Reals:
        """Which crank angles lie within."""
        return np.asarray(np.abs(angle - self.centre) < self.half)

    @property
    def tail(self) -> float:
        """The last terms of the poses' series over the largest of all."""
        poses = np.abs(self.series[:, 0])
        return float(np.max(poses[-3:]) / np.max(poses))


def passage(equations: Equations, nodes: list[Node], direction: float) -> Passage | None:
    """The passage over the change point that a path has run up against; None if it is none."""
    for half in WIDTHS:
        try:
            result = _passage(equations, nodes, direction * half)
        except UnsolvableError:
            continue
        if result.tail <= ENDED:
            return result
    return None


def _passage(equations: Equations, nodes: list[Node], half: float) -> Passage:
    """One of a half width, negative where the path goes backwards; raises UnsolvableError."""
    centre = nodes[-1].angle
    places = np.sort(chebyshev.chebpts1(PLACES))
    aims = (centre + half * places).tolist()
    before = [n for n in nodes if abs(n.angle - centre) >= abs(half)]
    near = _visited(equations, before[-1] if before else nodes[0], [centre - half, *aims[: PLACES // 2]])
    leap = int(np.searchsorted(places, -LANDING))
    beyond = PLACES - 1 - leap
    landing = node(equations, predicted(equations, near[1 : leap + 2], aims[beyond]), aims[beyond])
    outward = _visited(equations, landing, [*aims[beyond + 1 :], centre + half])
    inward = _visited(equations, landing, aims[PLACES // 2 : beyond][::-1])
    visited = [*near[1:], *inward[::-1], landing, *outward[:-1]]
    return Passage(centre, abs(half), (near[0], outward[-1]), _series(equations, visited, places * np.sign(half)))


def _visited(equations: Equations, start: Node, aims: list[float]) -> list[Node]:
    """The nodes at crank angles one after the other; raises UnsolvableError."""
    result = []
    for aim in aims:
        way, whole = walk(equations, start, aim, abs(aim - start.angle) or LEAST_STEP)
        if not whole:
            raise UnsolvableError("the change point is too near to another one, or to a stop")
        start = way[-1]
        result.append(start)
    return result


def _series(equations: Equations, nodes: list[Node], places: Reals) -> Reals:
    """Chebyshev coefficients (PLACES, 3, bodies, 3) of poses and derivatives, solved with the machine's most digits."""
    angle = np.array([n.angle for n in nodes])
    guess = np.stack([n.state[0] for n in nodes]).astype(np.longdouble)
    closed = close(equations, pose_of(guess), angle)
    solver = closed.solver(equations, 3)
    first = transfer(equations, closed, solver)
    second = bends(equations, closed, solver, first, np.ones(len(angle)))
    values = np.stack([closed.pose.coordinates(), equations.spread(first), equations.spread(second)], axis=1)
    matrix = chebyshev.chebvander(places, PLACES - 1)
    return np.asarray(np.linalg.solve(matrix, values.reshape(PLACES, -1).astype(float)).reshape(values.shape))
