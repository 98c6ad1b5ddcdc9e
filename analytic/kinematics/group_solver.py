"""Solving a group of a higher class within a linkage, many values of φ at once; the counterpart of ``DyadSolver``."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage, Vector
from analytic.errors import AssemblyError, StructureError
from analytic.kinematics import frames
from analytic.kinematics.branch import GroupBranch, Points, named_places, nearest_to_sketch, quintic
from analytic.kinematics.dyads import UNASSEMBLED, Shortfall
from analytic.kinematics.frames import STILL, Pose, Rate, Scalar
from analytic.kinematics.group_equations import GroupSystem, Motions, poses_of, rates_of
from analytic.kinematics.structure import Group, GroupJoint, Revolute, Structure
from analytic.numerics.arrays import Array

# Following a configuration of a group over φ, and Newton's method from the nodes that this leaves.
#
# From the configuration at the sketch the branch is followed with a predictor of the third order and steps that shrink
# where the corrector has far to go (P. Deuflhard, Newton Methods for Nonlinear Problems, 2004, chapter 5). The sign of
# det Φ_q never changes along it: where it would, the branch ends in a dead position. Between the nodes quintics through
# their first two derivatives are the guess; nodes are added until these are near.


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
    """A group, the motions of its host bodies as a function of φ, and the unit of its lengths, m.

    ``hosts`` takes φ (n,), rad or m, and gives pose, rate and acceleration of each host by name. ``is_linear`` says
    that φ is a travel.
    """

    joints: tuple[GroupJoint, ...]
    links: tuple[str, ...]
    hosts: Hosts
    unit: float
    is_linear: bool

    @property
    def radian(self) -> float:
        """The change of φ that counts as a radian: 1 rad or, for a linear driver, the unit of length, m."""
        return self.unit if self.is_linear else 1.0

    def system(self, coordinate: Array) -> GroupSystem:
        """The equations at values of φ (n,), rad or m; raises AssemblyError where the links before it do not meet."""
        return GroupSystem(self.joints, self.links, self.hosts(coordinate), coordinate, self.unit)


@dataclass(frozen=True)
class BranchNode:
    """A point of a branch: φ, rad or m, the configuration, and the sign of det Φ_q there.

    ``state`` (3, links, 3) has x, y and θ, m and rad, and two derivatives over φ.
    """

    coordinate: float
    state: Array
    side: float


def newton(system: GroupSystem, guess: Array, farthest: float = math.inf) -> Array:
    """Configurations (n, links, 3) by Newton's method from guesses, m and rad; nan where it fails.

    It fails also where its first step exceeds ``farthest``, in units of length and rad.
    """
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
    """The branch of the configuration ``start`` (links, 3) at φ = ``coordinate``, rad or m.

    A crank is followed for a turn, to both sides if that does not close, a linear driver for 16 units of length to both
    sides. Raises AssemblyError in a dead position.
    """
    first = _node(problem, start[None], coordinate, math.inf)
    if first is None:
        raise AssemblyError(f"{problem.links}: the start is in a dead position")
    if not problem.is_linear:
        nodes, whole = _nodes_towards(problem, first, coordinate + FULL_TURN)
        turns = _gains_over_turn(nodes, problem.unit) if whole else None
        if not whole or turns is None:
            below, down = _nodes_towards(problem, first, coordinate - FULL_TURN)
            nodes = [*below[:0:-1], *nodes]
        else:
            down = False
        branch = _branch(problem, nodes, turns, strays=whole and down and turns is None)
    else:
        above, _ = _nodes_towards(problem, first, coordinate + SPAN * problem.unit)
        below, _ = _nodes_towards(problem, first, coordinate - SPAN * problem.unit)
        branch = _branch(problem, [*below[:0:-1], *above], None)
    return _refine(problem, branch, first.side)


def _branch(problem: Problem, nodes: Sequence[BranchNode], turns: Array | None, *, strays: bool = False) -> GroupBranch:
    """The branch through these nodes, by ascending φ.

    ``turns`` as from ``_gains_over_turn``, ``strays`` if a turn ends in another configuration.
    """
    places = np.array([node.coordinate for node in nodes])
    return GroupBranch(places, np.stack([n.state for n in nodes]), problem.unit, turns, problem.is_linear, strays)


def _node(problem: Problem, guess: Array, coordinate: float, farthest: float) -> BranchNode | None:
    """The node of the configuration nearest to a guess (1, links, 3) at φ, rad or m.

    None without one within ``farthest``, in units of length and rad, in a dead position, or where the links before it
    do not meet.
    """
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


def _nodes_towards(problem: Problem, start: BranchNode, end: float) -> tuple[list[BranchNode], bool]:
    """Nodes of the branch from ``start``, itself the first, towards φ = ``end``, and whether they reach it.

    ``end`` is in rad or m.
    """
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
    """The configuration at φ by Taylor's series to the third order from the last node, (links, 3)."""
    here = nodes[-1]
    step = coordinate - here.coordinate
    third = np.zeros_like(here.state[2])
    if len(nodes) > 1:
        third = (here.state[2] - nodes[-2].state[2]) / (here.coordinate - nodes[-2].coordinate)
    return np.asarray(here.state[0] + step * (here.state[1] + step / 2.0 * (here.state[2] + step / 3.0 * third)))


def _gains_over_turn(nodes: list[BranchNode], unit: float) -> Array | None:
    """The angle, rad, that each link gains over a turn of the crank, from first to last node.

    None if a turn does not close. ``unit`` is the length, m, that counts as 1 in that.
    """
    gained = (nodes[-1].state[0] - nodes[0].state[0]) / np.array([unit, unit, 1.0])
    turns = FULL_TURN * np.round(gained[:, 2] / FULL_TURN)
    gained[:, 2] -= turns
    return np.asarray(turns) if float(np.max(np.abs(gained))) <= CLOSED else None


def _refine(problem: Problem, branch: GroupBranch, side: float) -> GroupBranch:
    """The branch with nodes added in the middle of intervals whose quintic is not near there, as a new branch.

    ``side`` is the sign of det Φ_q.
    """
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


# One group within a linkage.


DEAD: Final = "in a dead position"


class GroupSolver:
    """A group being solved; the mappings hold every body placed before it."""

    def __init__(self, group: Group, coordinate: Array) -> None:
        """Prepare to solve a group of a higher class, which has its branch, at values of φ, rad or m, any shape."""
        self.group = group
        self.hosts = group.hosts
        self.shape = np.shape(coordinate)
        self.coordinate = np.atleast_1d(np.asarray(coordinate, dtype=float)).ravel()
        self.known: list[Mapping[str, Any]] = []

    @property
    def branch(self) -> GroupBranch:
        """The branch of the configuration that the group follows."""
        assert self.group.branch is not None
        return self.group.branch

    def poses(self, poses: Mapping[str, Pose]) -> tuple[Pose, ...]:
        """Poses of the links, by those of placed bodies by name; nan where they do not meet in this configuration.

        Sets ``moves``, True where they do, and keeps the poses for the derivatives.
        """
        self.known = [poses, {}, {}]
        self.place = newton(self._system(), self.branch.guess(self.coordinate))
        outside = self.branch.margin(self.coordinate) < 0.0
        self.place[outside] = np.nan
        self.moves: Scalar = np.isfinite(self.place[:, 0, 0]).reshape(self.shape)
        self.link_poses = tuple(self._shaped(pose) for pose in poses_of(self.place))
        return self.link_poses

    def rates(self, rates: Mapping[str, Rate]) -> tuple[Rate, ...]:
        """Derivatives over φ of the links' poses, from those of placed bodies by name; the poses must be known."""
        self.known[1] = rates
        system = self._system()
        self.matrix = system.matrix(system.motions(self.place))
        self.first = system.step(self.matrix, system.residual(system.motions(self.place), 1))
        return tuple(self._shaped(rate) for rate in rates_of(self.first))

    def accelerations(self, accelerations: Mapping[str, Rate]) -> tuple[Rate, ...]:
        """Second derivatives over φ of the links' poses; the rates must be known.

        ``accelerations`` has those of the placed bodies by name.
        """
        self.known[2] = accelerations
        system = self._system()
        second = system.step(self.matrix, system.residual(system.motions(self.place, self.first), 2))
        return tuple(self._shaped(rate) for rate in rates_of(second))

    def _system(self) -> GroupSystem:
        """The equations at φ, with the known motions of the placed bodies."""
        hosts = {
            body: tuple(self._flat(known.get(body, STILL)) for known in self.known) for body in self.hosts
        }  # fmt: skip
        return GroupSystem(self.group.joints, self.group.links, hosts, self.coordinate, self.branch.unit)

    def _flat(self, parts: Any) -> Any:  # noqa: ANN401 - a pose or a rate
        """The numbers of a pose or a rate, arrays over φ or constants, as a tuple, each flat over all φ, (n,)."""
        count = (len(self.coordinate),)
        return tuple(np.ravel(np.broadcast_to(np.asarray(part, dtype=float), self.shape or count)) for part in parts)

    def _shaped(self, parts: Any) -> Any:  # noqa: ANN401 - a pose or a rate
        """The numbers of a pose or a rate, arrays (n,) over all φ, as a tuple, each reshaped to the shape of φ."""
        return tuple(part.reshape(self.shape) for part in parts)

    def margin(self) -> Scalar:
        """Distance of φ from the end of the followed configuration as a share of its whole extent, negative outside."""
        low, high = self.branch.ends
        return self.branch.margin(self.coordinate).reshape(self.shape) / (high - low or 1.0)

    def severity(self) -> Scalar:
        """Below zero where the links do not meet, the farther from the configuration's end the lower; else 0."""
        return np.where(self.moves, 0.0, np.minimum(self.margin(), 0.0) - np.finfo(float).tiny)

    def fault(self, _: object, linkage: Linkage) -> Shortfall:
        """Why the links do not meet at some φ, as a fault, always ``UNASSEMBLED``, and a sentence, one for every φ."""
        names = ", ".join(f"'{name}'" for name in self.group.links)
        s = "" if len(self.group.links) > 1 else "s"
        low, high = (linkage.phi.text(end) for end in self.branch.ends)
        if self.branch.strays:
            return UNASSEMBLED, (
                f"a turn of the driver takes {names} into another configuration, and one turn to either side of the "
                f"sketch is followed; stay within"
            )
        return UNASSEMBLED, (
            f"{names} keep{s} the configuration of the sketch from {low} to {high} only, and end{s} there {DEAD}; stay "
            "within, or change a length"
        )


def group_problem(group: Group, linkage: Linkage, hosts: Any) -> Problem:  # noqa: ANN401 - a function of φ
    """The equations of a group of a linkage; ``hosts`` gives the motions of the bodies that it is joined to at φ.

    It takes φ (n,) and gives pose, rate and acceleration by the body's name.
    """
    return Problem(group.joints, group.links, hosts, linkage.extent(), linkage.is_linear)


# The configuration of a group that the sketch means: of the solutions from many starts the nearest to the sketch.

STARTS: Final = 96  # configurations to start from: the sketch, more and more disturbed
MOST_FITTING_STEPS: Final = 60  # steps of Levenberg and Marquardt
CONVERGED: Final = 1e-6  # of the unit: from here on Newton's method settles
SAME: Final = 1e-6  # units and rad between two configurations that are one


def configuration_at_sketch(linkage: Linkage, structure: Structure, group: Group, problem: Problem) -> Array:
    """The group's configuration (links, 3), x and y, m, and θ, rad, at the sketch.

    ``structure`` has the groups before it. Raises AssemblyError without any solution, StructureError where the sketch
    leaves open which is meant.
    """
    at = linkage.sketch_angle
    points = {name: structure.bodies[name].points for name in group.links}
    known = _known_points(linkage, group, problem.hosts(np.array([at])))
    guesses = _guesses(points, known, problem.unit)
    system = problem.system(np.full(len(guesses), at))
    groups = _distinct(newton(system, _levenberg_marquardt(system, guesses)), problem.unit)
    names = ", ".join(f"'{name}'" for name in group.links)
    if not len(groups):
        raise AssemblyError(
            f"'{linkage.name}': {names} cannot be assembled at {linkage.phi.text(at)} from the sketch; check the "
            f"lengths, or place {', '.join(sorted(_point_names(points)))} under [sketch.points], nearer to where "
            "they belong"
        )
    nearest_root, telling = nearest_to_sketch(
        linkage, [named_places(points, poses_of(values[None])) for values in groups]
    )
    if telling is not None:
        telling = [point for point in telling if point not in linkage.sketch] or telling
        raise StructureError(
            f"sketch of '{linkage.name}': expected the rough position of {' or '.join(map(repr, telling))} at "
            f"{linkage.phi.named(at)}, got a sketch that leaves open which of {len(groups)} configurations "
            f"{names} have; place it under [sketch.points], nearer to one of them"
        )
    return np.asarray(groups[nearest_root])


def _point_names(points: Points) -> set[str]:
    """Names, in quotes, of all points."""
    return {f"'{point}'" for places in points.values() for point in places}


def _known_points(linkage: Linkage, group: Group, hosts: Motions) -> dict[str, Vector]:
    """Positions, m, by name: points of pins on placed bodies, and others that the sketch gives.

    ``hosts`` are the placed bodies' motions at the sketch, by name.
    """
    known = dict(linkage.sketch)
    for joint in group.joints:
        if isinstance(joint, Revolute) and joint.near in hosts:
            x, y = (float(np.ravel(part)[0]) for part in frames.point(hosts[joint.near][0], joint.near_local))
            known[joint.point] = (x, y)
    return known


def _guesses(points: Points, known: Mapping[str, Vector], unit: float) -> Array:
    """Coordinates to start from, (starts, links, 3): first those of the sketch, then with growing disturbances.

    ``points`` has each link's points in its frame, ``known`` positions of points, m, by name; ``unit``, m, scales the
    disturbances. Links with fewer than two known points start at angles drawn at random, the same in every run.
    """
    random = np.random.default_rng(1)
    middle = np.mean(list(known.values()), axis=0) if known else np.zeros(2)
    disturbance = np.linspace(0.0, 1.0, STARTS)
    rows = []
    for places in points.values():
        here = [point for point in places if point in known]
        angle = _fitted_angle([places[p] for p in here], [known[p] for p in here]) if len(here) > 1 else None
        spread = disturbance if angle is not None else np.ones(STARTS)
        theta = (angle or 0.0) + np.pi * spread * random.uniform(-1.0, 1.0, STARTS)
        local = np.mean([places[p] for p in here], axis=0) if here else np.zeros(2)
        target = np.mean([known[p] for p in here], axis=0) if here else middle
        loose = unit * (0.3 * disturbance if here else np.ones(STARTS))
        shift = target + loose[:, None] * random.uniform(-1.0, 1.0, (STARTS, 2))
        c, s = np.cos(theta), np.sin(theta)
        rows.append(
            np.stack([shift[:, 0] - c * local[0] + s * local[1], shift[:, 1] - s * local[0] - c * local[1], theta])
        )
    return np.moveaxis(np.array(rows), -1, 0)


def _fitted_angle(local: list[Vector], world: list[Vector]) -> float:
    """The angle, rad, of a link whose ``local`` points come nearest to ``world`` places, one for each."""
    a, b = np.array(local) - np.mean(local, axis=0), np.array(world) - np.mean(world, axis=0)
    sine = float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    return math.atan2(sine, float(np.sum(a * b)))


def _levenberg_marquardt(system: GroupSystem, guess: Array) -> Array:
    """Levenberg and Marquardt's method from every guess, (n, links, 3); those that do not get near are nan."""
    here, factor = guess, np.full(len(guess), 1e-2)
    identity = np.eye(guess.shape[1] * 3)
    residual = system.residual(system.motions(here), 0)
    for _ in range(MOST_FITTING_STEPS):
        matrix = system.matrix(system.motions(here))
        normal = matrix.swapaxes(1, 2) @ matrix + factor[:, None, None] * identity
        slope = (matrix.swapaxes(1, 2) @ residual[..., None])[..., 0]
        step = -np.linalg.solve(normal, slope[..., None])[..., 0] * system.columns
        moved = here + step.reshape(here.shape)
        after = system.residual(system.motions(moved), 0)
        better = np.sum(after**2, axis=1) < np.sum(residual**2, axis=1)
        here = np.where(better[:, None, None], moved, here)
        residual = np.where(better[:, None], after, residual)
        factor = np.clip(np.where(better, factor * 0.2, factor * 4.0), 1e-15, 1e6)
        if np.all(np.max(np.abs(residual), axis=1) < CONVERGED):
            break
    met = np.max(np.abs(residual), axis=1) < 1e3 * CONVERGED
    return np.where(met[:, None, None], here, np.nan)


def _distinct(values: Array, unit: float) -> list[Array]:
    """The configurations that differ, (links, 3) each, among all solutions (n, links, 3), in the order of their starts.

    Those with nan are left out; ``unit`` is the length, m, that weighs like a radian.
    """
    result: list[Array] = []
    for root in values[np.all(np.isfinite(values), axis=(1, 2))]:
        if not any(_are_same(root, other, unit) for other in result):
            result.append(root)
    return result


def _are_same(values: Array, other: Array, unit: float) -> bool:
    """Whether two configurations (links, 3) are the same but for rounding; whole turns do not count.

    ``unit`` is the length, m, that weighs like a radian.
    """
    turned = np.abs(np.exp(1j * values[:, 2]) - np.exp(1j * other[:, 2]))
    return bool(np.max(np.abs(values[:, :2] - other[:, :2])) < SAME * unit and np.max(turned) < SAME)
