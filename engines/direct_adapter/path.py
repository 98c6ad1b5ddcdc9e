"""Following the assembly mode of the start state over the crank angles of a motion.

A path of poses is followed from the start state, each close enough to the one before for Newton's method to have no
other solution in reach (P. Deuflhard, Newton Methods for Nonlinear Problems, 2004, chapter 5). Between the path's
poses, quintics through their first two derivatives come so near that all instants can be solved at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic.description.law import FULL_TURN
from engines.direct_adapter.assembly import NEAR, Closed, Equations, UnsolvableError, close, inverted
from engines.mechanics.states import Pose, Reals, pose_of

LARGEST_STEP = FULL_TURN / 24.0  # rad of crank between two poses of a path
FARTHEST = 1e-3  # units and rad that a predicted pose may be off; farther, another solution may be nearer
LEAST_STEP = 1e-5  # rad; a path that has to go slower than this has come to its end
STOP = 1e-3  # rad before a position that the path cannot pass
ATTEMPTS = 5
SHUT = 1e-9  # units and rad between the two ends of a full turn


@dataclass(frozen=True)
class Node:
    """A pose of the path with its first two derivatives over φ, (3, bodies, 3) in units and rad.

    ``side`` is the sign of det G, which a path can only change where it is singular: on crossing to another mode.
    """

    angle: float
    state: Reals
    side: float


@dataclass(frozen=True)
class Path:
    """Poses over φ, ``angle`` (m,), rad or units, increasing; ``state`` (m, 3, bodies, 3) as of the nodes.

    ``turns`` (bodies,) is each body's turn in rad per full turn of the crank where the path is one full turn that
    shuts, so that it repeats; None where the path has two ends.
    """

    equations: Equations
    angle: Reals
    state: Reals
    side: float
    turns: Reals | None = None

    def away_from_stops(self, low: float, high: float) -> Path:
        """The path without its ends where it stops short of ``low`` or ``high``: at a stop its equations are singular.

        A crank that gets nearer than STOP to one is taken to run up against it.
        """
        if self.turns is not None:
            return self
        first = self.angle[0] + (STOP if self.angle[0] > low else 0.0)
        last = self.angle[-1] - (STOP if self.angle[-1] < high else 0.0)
        kept = (self.angle >= first) & (self.angle <= last)
        return replace(self, angle=self.angle[kept], state=self.state[kept])

    def closed(self, crank: Reals, dtype: type[np.floating[Any]] = np.float64) -> Closed:
        """The poses at crank angles (n,); raises UnsolvableError where the path is too coarse to find them."""
        closed = close(self.equations, self.guess(crank, dtype), crank)
        if float(np.max(closed.first)) <= NEAR:
            return closed
        matrix = self.equations.jacobian(closed.arms).astype(float)
        if np.any(np.linalg.slogdet(matrix)[0] != self.side):
            raise UnsolvableError("the linkage cannot be kept in its assembly mode")
        return replace(closed, inverse=inverted(matrix))

    def guess(self, crank: Reals, dtype: type[np.floating[Any]] = np.float64) -> Pose:
        """Poses near the exact ones at crank angles (n,), the crank itself exact."""
        start, number = self.angle[0], np.zeros(len(crank))
        if self.turns is not None:
            number = np.floor((crank - start) / FULL_TURN)
        coordinates = self._quintic(crank - FULL_TURN * number)
        place, reduced = coordinates[..., :2].astype(dtype), coordinates[..., 2].astype(dtype)
        driver = self.equations.driver
        if driver.turns:
            reduced[:, driver.crank] = crank
        angle = reduced if self.turns is None else reduced + number[:, None] * self.turns
        if driver.turns:
            angle[:, driver.crank] = crank
        return Pose(place, angle, np.cos(reduced), np.sin(reduced))

    def _quintic(self, crank: Reals) -> Reals:
        """Hermite's quintic through both neighbours' values and derivatives, (n, bodies, 3)."""
        if len(self.angle) == 1:  # a crank that stands still
            return np.repeat(self.state[:, 0], len(crank), axis=0)
        left = np.clip(np.searchsorted(self.angle, crank, side="right") - 1, 0, len(self.angle) - 2)
        width = self.angle[left + 1] - self.angle[left]
        x = (crank - self.angle[left]) / width
        y = 1.0 - x
        result = np.zeros((len(crank), *self.state.shape[2:]))
        for at, s, sign in ((left, x, 1.0), (left + 1, y, -1.0)):
            u = 1.0 - s
            weights = (
                u**3 * (1.0 + 3.0 * s + 6.0 * s * s),
                sign * width * u**3 * s * (1.0 + 3.0 * s),
                0.5 * width**2 * u**3 * s * s,
            )
            for order, weight in enumerate(weights):
                result += weight[:, None, None] * self.state[at, order]
        return result


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
    return Node(coordinate, np.stack([position[0], first[0], second[0]]), float(np.linalg.slogdet(matrix[0])[0]))


def follow(equations: Equations, start: Node, end: float, largest: float) -> tuple[list[Node], bool]:
    """Nodes from ``start`` towards crank angle ``end``, and whether they get there."""
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
    following = node(equations, _predicted(equations, nodes, crank), crank)
    if following.side != nodes[-1].side:
        raise UnsolvableError("the pose is in another assembly mode")
    return following


def _predicted(equations: Equations, nodes: list[Node], crank: float) -> Pose:
    """Taylor's series to the third order from the last node, the third derivative by difference."""
    here = nodes[-1]
    step = crank - here.angle
    third = 0.0 if len(nodes) == 1 else (here.state[2] - nodes[-2].state[2]) / (here.angle - nodes[-2].angle)
    state = here.state[0] + step * (here.state[1] + step / 2.0 * (here.state[2] + step / 3.0 * third))
    if equations.driver.turns:
        state[equations.driver.crank, 2] = crank
    return pose_of(state[None])


def reach(equations: Equations, low: float, high: float) -> Path:
    """The path that holds all crank angles from ``low`` to ``high``, or as much of it as can be reached.

    The start state lies between them. A path of a full turn is followed for one turn only if its ends meet. Its steps
    are halved until the quintics lead Newton's method to the path in the middle between its poses.
    """
    largest = LARGEST_STEP
    for _ in range(ATTEMPTS):
        path = _followed(equations, low, high, largest)
        try:
            path.closed(0.5 * (path.angle[1:] + path.angle[:-1]) if len(path.angle) > 1 else path.angle)
            break
        except UnsolvableError:
            largest *= 0.5
    return path


def _followed(equations: Equations, low: float, high: float, largest: float) -> Path:
    at_start = equations.start()
    start = node(equations, at_start, float(equations.driven(at_start, equations.arms(at_start))[0]))
    if equations.driver.turns and high - low >= FULL_TURN:
        nodes, whole = follow(equations, start, start.angle + FULL_TURN, largest)
        turns = _turns(nodes) if whole else None
        if turns is not None:
            return _joined(equations, nodes, turns)
    above, _ = follow(equations, start, high, largest)
    below, _ = follow(equations, start, low, largest)
    return _joined(equations, [*below[:0:-1], *above], None)


def _joined(equations: Equations, nodes: list[Node], turns: Reals | None) -> Path:
    return Path(equations, np.array([n.angle for n in nodes]), np.stack([n.state for n in nodes]), nodes[0].side, turns)


def _turns(nodes: list[Node]) -> Reals | None:
    """Each body's angle gained over the turn, rad, a multiple of a full turn; None if the ends do not meet."""
    gained = nodes[-1].state[0] - nodes[0].state[0]
    turns = FULL_TURN * np.round(gained[:, 2] / FULL_TURN)
    gained[:, 2] -= turns
    return turns if float(np.max(np.abs(gained))) <= SHUT else None
