"""Poses of a path over φ, each found from the ones before by Newton's method, up to where the joints' equations end.

Each is close enough to the one before for Newton's method to have no other solution in reach (P. Deuflhard, Newton
Methods for Nonlinear Problems, 2004, chapter 5).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engines.direct_adapter.assembly import Equations, UnsolvableError, close, inverted
from engines.mechanics.states import Pose, Reals, pose_of

FARTHEST = 1e-3  # units and rad that a predicted pose may be off; farther, another solution may be nearer
LEAST_STEP = 1e-5  # rad; a path that has to go slower than this has come to its end


@dataclass(frozen=True)
class Node:
    """A pose of the path with its first two derivatives over φ, (3, bodies, 3) in units and rad; G there (k, k)."""

    angle: float
    state: Reals
    matrix: Reals

    @property
    def side(self) -> float:
        """The sign of det G, which a path can only change where it is singular: on crossing to another mode."""
        return float(np.linalg.slogdet(self.matrix)[0])


def node(equations: Equations, pose: Pose, coordinate: float) -> Node:
    """The pose nearest to ``pose`` (one instant) that closes the joints at φ; raises UnsolvableError."""
    closed = close(equations, pose, np.array([coordinate]))
    if not float(closed.first[0]) <= FARTHEST:
        raise UnsolvableError("the pose is too far from the one before")
    matrix = equations.jacobian(closed.arms)
    inverse = inverted(matrix)
    first = equations.spread(inverse[:, :, equations.crank_row])
    second = equations.spread((inverse @ equations.bend(closed.arms, first)[..., None])[..., 0])
    equations.solves += 2
    position = closed.pose.coordinates()
    return Node(coordinate, np.stack([position[0], first[0], second[0]]), matrix[0])


def walk(equations: Equations, start: Node, end: float, largest: float) -> tuple[list[Node], bool]:
    """Nodes from ``start`` towards crank angle ``end`` in its assembly mode, and whether they get there."""
    nodes = [start]
    direction = 1.0 if end >= start.angle else -1.0
    step = largest / 4.0
    while nodes[-1].angle != end:
        here = nodes[-1]
        aim = here.angle + direction * step
        if (end - aim) * direction < 0.3 * step:  # no sliver is left over
            aim = end
        try:
            nodes.append(_next(equations, nodes, aim))
            step = min(2.0 * step, largest)
        except UnsolvableError:
            step = abs(aim - here.angle) / 2.0
            if step < LEAST_STEP:
                return nodes, False
    return nodes, True


def _next(equations: Equations, nodes: list[Node], crank: float) -> Node:
    """The node at a crank angle in the mode of the nodes before; raises UnsolvableError."""
    following = node(equations, predicted(equations, nodes, crank), crank)
    # Between two matrices on a line there is a singular one where one over the other has a negative eigenvalue: several
    # groups that cross at once leave the determinant its sign. What is repeated need not come out real.
    if np.any(np.linalg.eigvals(np.linalg.solve(nodes[-1].matrix, following.matrix)).real < 0.0):
        raise UnsolvableError("the pose is in another assembly mode")
    return following


def predicted(equations: Equations, nodes: list[Node], crank: float) -> Pose:
    """Taylor's series to the third order from the last node, the third derivative by difference."""
    here = nodes[-1]
    step = crank - here.angle
    third = 0.0 if len(nodes) == 1 else (here.state[2] - nodes[-2].state[2]) / (here.angle - nodes[-2].angle)
    state = here.state[0] + step * (here.state[1] + step / 2.0 * (here.state[2] + step / 3.0 * third))
    if equations.driver.turns:
        state[equations.driver.crank, 2] = crank
    return pose_of(state[None])
