"""Following a configuration of a group over φ, and Newton's method from the nodes that this leaves.

From the configuration at the sketch the branch is followed with a predictor of the third order and steps that shrink
where the corrector has far to go (P. Deuflhard, Newton Methods for Nonlinear Problems, 2004, chapter 5). The sign of
det Φ_q never changes along it: where it would, the branch ends in a dead position. Between the nodes quintics through
their first two derivatives are the guess; nodes are added until these are near.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.errors import AssemblyError
from analytic.kinematics.branch import GroupBranch, quintic
from analytic.kinematics.groups.equations import GroupSystem, Motions
from analytic.kinematics.structure import GroupJoint

Array = NDArray[np.float64]
Hosts = Callable[[Array], Motions]

LARGEST_STEP: Final = FULL_TURN / 24.0  # rad, or units of length, between two nodes
LEAST_STEP: Final = 1e-9  # a branch that has to go slower has come to its end
FARTHEST_CORRECTION: Final = (
    1e-3  # units and rad that a predicted node may be off; farther, another branch may be nearer
)
NEAR: Final = 1e-4  # the same of a guess between two nodes
LEVELS: Final = 8  # times that an interval between two nodes is halved
MOST_ITERATIONS: Final = 12
SETTLED: Final = 1e-9  # a correction that no longer shrinks is rounding if it is smaller, failure if not
CLOSED: Final = 1e-9  # units and rad between the two ends of a turn
SPAN: Final = 16.0  # units that the branch of a driver that does not turn is followed to either side


@dataclass(frozen=True)
class Problem:
    """A group, the motions of its host bodies as a function of φ, and the unit of its lengths, m."""

    joints: tuple[GroupJoint, ...]
    links: tuple[str, ...]
    hosts: Hosts
    unit: float
    is_linear: bool

    @property
    def radian(self) -> float:
        """How much of φ counts as a radian: 1 rad, or of a linear driver the unit of length, m."""
        return self.unit if self.is_linear else 1.0

    def system(self, coordinate: Array) -> GroupSystem:
        """The equations at values of φ; raises AssemblyError where the links before it do not meet."""
        return GroupSystem(self.joints, self.links, self.hosts(coordinate), coordinate, self.unit)


@dataclass(frozen=True)
class BranchNode:
    """A point of a branch and the sign of det Φ_q there."""

    coordinate: float
    state: Array
    side: float


def newton(system: GroupSystem, guess: Array, farthest: float = math.inf) -> Array:
    """Newton's method from guesses (n, links, 3), m and rad; nan where it fails or goes farther than ``farthest``."""
    here, before = guess, np.full(system.count, np.inf)
    scale = np.array([system.columns[0], system.columns[0], 1.0])
    done = np.zeros(system.count, dtype=bool)
    with np.errstate(all="ignore"):
        for number in range(MOST_ITERATIONS):
            motions = system.motions(here)
            step = system.step(system.matrix(motions), system.residual(motions, 0))
            size = np.max(np.abs(step / scale), axis=(1, 2))
            lost = ~(size <= (farthest if number == 0 else np.maximum(0.5 * before, SETTLED)))
            here = np.where(lost[:, None, None], np.nan, np.where(done[:, None, None], here, here + step))
            done |= size <= np.maximum(4.0 * np.finfo(float).eps, np.where(number > 0, size * size / before, 0.0))
            done |= (size <= SETTLED) & (size >= 0.25 * before)
            before = size
            if np.all(done | np.isnan(here[:, 0, 0])):
                break
    return np.where(done[:, None, None], here, np.nan)


def follow_branch(problem: Problem, start: Array, coordinate: float) -> GroupBranch:
    """The branch of the configuration ``start`` (links, 3) at φ = ``coordinate``; raises AssemblyError."""
    first = _node(problem, start[None], coordinate, math.inf)
    if first is None:
        raise AssemblyError(f"{problem.links}: the start is in a dead position")
    if not problem.is_linear:
        nodes, whole = _follow(problem, first, coordinate + FULL_TURN)
        turns = _turns(nodes, problem.unit) if whole else None
        if not whole or turns is None:
            below, down = _follow(problem, first, coordinate - FULL_TURN)
            nodes = [*below[:0:-1], *nodes]
        else:
            down = False
        branch = _branch(problem, nodes, turns, strays=whole and down and turns is None)
    else:
        above, _ = _follow(problem, first, coordinate + SPAN * problem.unit)
        below, _ = _follow(problem, first, coordinate - SPAN * problem.unit)
        branch = _branch(problem, [*below[:0:-1], *above], None)
    return _refine(problem, branch, first.side)


def _branch(problem: Problem, nodes: Sequence[BranchNode], turns: Array | None, *, strays: bool = False) -> GroupBranch:
    places = np.array([node.coordinate for node in nodes])
    return GroupBranch(places, np.stack([n.state for n in nodes]), problem.unit, turns, problem.is_linear, strays)


def _node(problem: Problem, guess: Array, coordinate: float, farthest: float) -> BranchNode | None:
    """The node of the configuration nearest to a guess (1, links, 3) at φ; None if it is farther than ``farthest``."""
    try:
        system = problem.system(np.array([coordinate]))
    except AssemblyError:
        return None
    place = newton(system, guess, farthest)
    if not np.all(np.isfinite(place)):
        return None
    with np.errstate(all="ignore"):
        first, second = system.derivatives(place)
        side = float(np.linalg.slogdet(system.matrix(system.motions(place)))[0][0])
    state = np.stack([place[0], first[0], second[0]])
    return BranchNode(coordinate, state, side) if np.all(np.isfinite(state)) and side else None


def _follow(problem: Problem, start: BranchNode, end: float) -> tuple[list[BranchNode], bool]:
    """Nodes from ``start`` towards φ = ``end``, and whether they get there."""
    nodes = [start]
    direction, largest = (1.0 if end >= start.coordinate else -1.0), LARGEST_STEP * problem.radian
    step = largest / 4.0
    while nodes[-1].coordinate != end:
        here = nodes[-1]
        aim = here.coordinate + direction * step
        if (end - aim) * direction < 0.3 * step:  # no sliver is left over
            aim = end
        node = _node(problem, _predict(nodes, aim)[None], aim, FARTHEST_CORRECTION)
        if node is not None and node.side == here.side:
            nodes.append(node)
            step = min(2.0 * step, largest)
        else:
            step = abs(aim - here.coordinate) / 2.0
            if step < LEAST_STEP * problem.radian:
                return nodes, False
    return nodes, True


def _predict(nodes: list[BranchNode], coordinate: float) -> Array:
    """Taylor's series to the third order from the last node, the third derivative by difference."""
    here = nodes[-1]
    step = coordinate - here.coordinate
    third = np.zeros_like(here.state[2])
    if len(nodes) > 1:
        third = (here.state[2] - nodes[-2].state[2]) / (here.coordinate - nodes[-2].coordinate)
    return np.asarray(here.state[0] + step * (here.state[1] + step / 2.0 * (here.state[2] + step / 3.0 * third)))


def _turns(nodes: list[BranchNode], unit: float) -> Array | None:
    """Each link's angle gained over a turn of the crank, rad; None if its ends do not meet."""
    gained = (nodes[-1].state[0] - nodes[0].state[0]) / np.array([unit, unit, 1.0])
    turns = FULL_TURN * np.round(gained[:, 2] / FULL_TURN)
    gained[:, 2] -= turns
    return np.asarray(turns) if float(np.max(np.abs(gained))) <= CLOSED else None


def _refine(problem: Problem, branch: GroupBranch, side: float) -> GroupBranch:
    """The branch with nodes added in the middle of intervals whose quintic is not near there."""
    places, state = branch.coordinate, branch.state
    left = np.arange(len(places) - 1)
    for _ in range(LEVELS):
        wide = left[np.diff(places)[left] > 2.0 * LEAST_STEP * problem.radian]
        if not len(wide):
            break
        middle = 0.5 * (places[wide] + places[wide + 1])
        guess, system = quintic(places, state, middle), problem.system(middle)
        exact = newton(system, guess)
        with np.errstate(all="ignore"):
            sides = np.linalg.slogdet(system.matrix(system.motions(exact)))[0]
            first, second = system.derivatives(exact)
        scale = np.array([problem.unit, problem.unit, 1.0])
        off = np.max(np.abs((exact - guess) / scale), axis=(1, 2))
        more = (off > NEAR) & (sides == side)
        if not np.any(more):
            break
        added = np.stack([exact, first, second], axis=1)[more]
        places, state = np.append(places, middle[more]), np.concatenate([state, added])
        order = np.argsort(places)
        places, state = places[order], state[order]
        new = np.flatnonzero(np.isin(places, middle[more]))
        left = np.unique(np.concatenate([new - 1, new]))
        left = left[(left >= 0) & (left < len(places) - 1)]
    return GroupBranch(places, state, branch.unit, branch.turns, branch.is_linear, branch.strays)
