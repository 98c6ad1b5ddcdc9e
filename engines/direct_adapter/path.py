"""Following the smooth motion of the start state over the crank angles of a motion.

A path of nodes is followed from the start state, over change points by passages. Between the path's nodes, quintics
through their first two derivatives come so near that all instants can be solved at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic.description.law import FULL_TURN
from engines.direct_adapter.assembly import NEAR, Closed, Equations, UnsolvableError, close, inverted
from engines.direct_adapter.nodes import Node, node, walk
from engines.direct_adapter.passages import Passage, passage
from engines.mechanics.states import Pose, Reals

LARGEST_STEP = FULL_TURN / 24.0  # rad of crank between two poses of a path
CLEAR = 0.053  # rad from a change point, where accelerations are known to 1e-12
STOP = 1e-3  # rad before a position that the path cannot pass
ATTEMPTS = 5
PERIODS = (FULL_TURN, 2.0 * FULL_TURN)  # rad; with one change point a turn, all is as before after two
SHUT = 1e-9  # units and rad between the two ends of a full turn


@dataclass(frozen=True)
class Path:
    """Poses over φ, ``angle`` (m,), rad or units, increasing, none within ``passages``; the rest as of the nodes.

    ``state`` is (m, 3, bodies, 3), ``side`` (m,). ``turns`` (bodies,) is each body's turn in rad over a path that shuts
    after one turn of the crank, or two, so that it repeats; None where the path has two ends.
    """

    equations: Equations
    angle: Reals
    state: Reals
    side: Reals
    passages: tuple[Passage, ...] = ()
    turns: Reals | None = None

    @property
    def period(self) -> float:
        """The crank angle after which a path that shuts repeats, rad."""
        return float(FULL_TURN * np.round((self.angle[-1] - self.angle[0]) / FULL_TURN))

    def away_from_stops(self, low: float, high: float) -> Path:
        """The path without its ends where it stops short of ``low`` or ``high``: at a stop its equations are singular.

        A crank that gets nearer than STOP to one is taken to run up against it.
        """
        if self.turns is not None:
            return self
        first = self.angle[0] + (STOP if self.angle[0] > low else 0.0)
        last = self.angle[-1] - (STOP if self.angle[-1] < high else 0.0)
        kept = (self.angle >= first) & (self.angle <= last)
        return replace(self, angle=self.angle[kept], state=self.state[kept], side=self.side[kept])

    def closed(self, crank: Reals, dtype: type[np.floating[Any]] = np.float64) -> Closed:
        """The poses at crank angles (n,); raises UnsolvableError where the path is too coarse to find them."""
        guess, states = self._near(crank, dtype)
        passing = np.zeros(len(crank), dtype=bool)
        for within, _ in states:
            passing |= within
        if not states:
            return self._closed(guess, crank)
        inverse = np.full((len(crank), self.equations.rows, self.equations.size), np.nan)
        first = np.zeros(len(crank))
        if not np.all(passing):
            solved = self._closed(guess.part(~passing), crank[~passing])
            guess = guess.joined(~passing, solved.pose)
            inverse[~passing], first[~passing] = solved.inverse, solved.first
        slopes = np.zeros((2, len(crank), self.equations.size))
        for within, state in states:
            slopes[:, within] = [self.equations.gather(state[:, order]) for order in (1, 2)]
        return Closed(guess, self.equations.arms(guess), inverse, first, (passing, slopes[:, passing]))

    def _closed(self, guess: Pose, crank: Reals) -> Closed:
        closed = close(self.equations, guess, crank)
        if float(np.max(closed.first)) <= NEAR:
            return closed
        matrix = self.equations.jacobian(closed.arms).astype(float)
        left = np.searchsorted(self.angle, self._reduced(crank)[0], side="right") - 1
        if np.any(np.linalg.slogdet(matrix)[0] != self.side[np.clip(left, 0, len(self.side) - 1)]):
            raise UnsolvableError("the linkage cannot be kept in its assembly mode")
        return replace(closed, inverse=inverted(matrix))

    def _reduced(self, crank: Reals) -> tuple[Reals, Reals]:
        """Crank angles on the path, and how many periods they are ahead."""
        number = np.zeros(len(crank)) if self.turns is None else np.floor((crank - self.angle[0]) / self.period)
        return crank - self.period * number, number

    def _near(self, crank: Reals, dtype: type[np.floating[Any]]) -> tuple[Pose, list[tuple[Reals, Reals]]]:
        """Poses near the exact ones at crank angles (n,), the crank itself exact.

        By passage the instants within, where the pose is known, and what is known of them.
        """
        turned, number = self._reduced(crank)
        coordinates = self._quintic(turned)
        states = []
        for one in self.passages:
            within = one.holds(turned)
            if np.any(within):
                states.append((within, one.state(turned[within])))
                coordinates[within] = states[-1][1][:, 0]
        place, reduced = coordinates[..., :2].astype(dtype), coordinates[..., 2].astype(dtype)
        driver = self.equations.driver
        if driver.turns:
            reduced[:, driver.crank] = crank
        angle = reduced if self.turns is None else reduced + number[:, None] * self.turns
        if driver.turns:
            angle[:, driver.crank] = crank
        return Pose(place, angle, np.cos(reduced), np.sin(reduced)), states

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


def reach(equations: Equations, low: float, high: float) -> Path:
    """The path that holds all crank angles from ``low`` to ``high``, or as much of it as can be reached.

    The start state lies between them. A path of full turns is followed until its ends meet, if they do. Its steps
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
        for period in PERIODS:
            nodes, passages, whole = _turned(equations, start, period, largest)
            turns = _turns(nodes) if whole else None
            if turns is not None:
                return _joined(equations, nodes, passages, turns)
            if not whole or high - low <= period:
                break
    beyond = CLEAR if equations.driver.turns else 0.0  # a change point just behind an end is to be seen
    above, over, _ = follow(equations, start, high + beyond, largest)
    below, under, _ = follow(equations, start, low - beyond, largest)
    first = [*below[::-1], *(n for n in above if n.angle > below[0].angle)]
    return _joined(equations, first, [*under, *over], None)


def _turned(equations: Equations, start: Node, period: float, largest: float) -> tuple[list[Node], list[Passage], bool]:
    """The path of a period, as ``follow`` has it; one that would begin in a passage begins a little behind one."""
    nodes, passages, whole = follow(equations, start, start.angle + period, largest)
    if passages and (nodes[0].angle, nodes[-1].angle) != (start.angle, start.angle + period):
        clear = passages[-1].ends[1]
        begin = walk(equations, clear, clear.angle + CLEAR, largest)[0][-1]
        return follow(equations, begin, begin.angle + period, largest)
    return nodes, passages, whole


def follow(equations: Equations, start: Node, end: float, largest: float) -> tuple[list[Node], list[Passage], bool]:
    """Nodes from ``start`` to a crank angle or beyond, the passages between them, and whether they get there."""
    direction = 1.0 if end >= start.angle else -1.0
    nodes, whole = walk(equations, start, end, largest)
    passages: list[Passage] = []
    while not whole:
        leap = passage(equations, nodes, direction) if equations.driver.turns else None
        if leap is None:
            break
        passages.append(leap)
        nodes = [*(n for n in nodes if (leap.ends[0].angle - n.angle) * direction > 0.0), *leap.ends]
        if (nodes[-1].angle - end) * direction >= 0.0:
            whole = True
        else:
            more, whole = walk(equations, nodes[-1], end, largest)
            nodes += more[1:]
    return nodes, passages, whole


def _joined(equations: Equations, nodes: list[Node], passages: list[Passage], turns: Reals | None) -> Path:
    angle, state, side = (np.array([getattr(n, part) for n in nodes]) for part in ("angle", "state", "side"))
    return Path(equations, angle, state, side, tuple(passages), turns)


def _turns(nodes: list[Node]) -> Reals | None:
    """Each body's angle gained over the path, rad, a multiple of a full turn; None if the ends do not meet."""
    gained = nodes[-1].state[0] - nodes[0].state[0]
    turns = FULL_TURN * np.round(gained[:, 2] / FULL_TURN)
    gained[:, 2] -= turns
    return turns if float(np.max(np.abs(gained))) <= SHUT else None
