"""Solving a group of a higher class within a linkage, many values of φ at once; the counterpart of ``DyadSolver``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage, Vector
from analytic.errors import AssemblyError, StructureError
from analytic.kinematics import frames
from analytic.kinematics.branch import GroupBranch
from analytic.kinematics.frames import STILL, Pose, Rate, Scalar
from analytic.kinematics.groups.equations import GroupSystem, Motions, poses_of, rates_of
from analytic.kinematics.groups.following import Problem, newton
from analytic.kinematics.sketch import Points, named_places, nearest_to_sketch
from analytic.kinematics.structure import Group, Revolute, Structure

Array = NDArray[np.float64]

DEAD: Final = "in a dead position"


class GroupSolver:
    """A group being solved; the mappings hold every body placed before it."""

    def __init__(self, group: Group, coordinate: Array) -> None:
        self.dyad = group
        self.hosts = group.hosts
        self.shape = np.shape(coordinate)
        self.coordinate = np.atleast_1d(np.asarray(coordinate, dtype=float)).ravel()
        self.known: list[Mapping[str, Any]] = []

    @property
    def branch(self) -> GroupBranch:
        """The configuration that is followed."""
        assert self.dyad.branch is not None
        return self.dyad.branch

    def poses(self, poses: Mapping[str, Pose]) -> tuple[Pose, ...]:
        """Poses of the links; nan where they do not meet in this configuration."""
        self.known = [poses, {}, {}]
        self.place = newton(self._system(), self.branch.guess(self.coordinate))
        outside = self.branch.margin(self.coordinate) < 0.0
        self.place[outside] = np.nan
        self.moves: Scalar = np.isfinite(self.place[:, 0, 0]).reshape(self.shape)
        self.link_poses = tuple(self._shaped(pose) for pose in poses_of(self.place))
        return self.link_poses

    def rates(self, rates: Mapping[str, Rate]) -> tuple[Rate, ...]:
        """First derivatives over φ; the poses must be known."""
        self.known[1] = rates
        system = self._system()
        self.matrix = system.matrix(system.motions(self.place))
        self.first = system.step(self.matrix, system.residual(system.motions(self.place), 1))
        return tuple(self._shaped(rate) for rate in rates_of(self.first))

    def accelerations(self, accelerations: Mapping[str, Rate]) -> tuple[Rate, ...]:
        """Second derivatives over φ; the rates must be known."""
        self.known[2] = accelerations
        system = self._system()
        second = system.step(self.matrix, system.residual(system.motions(self.place, self.first), 2))
        return tuple(self._shaped(rate) for rate in rates_of(second))

    def _system(self) -> GroupSystem:
        """The equations with the known motions of the placed bodies."""
        hosts = {
            body: tuple(self._flat(known.get(body, STILL)) for known in self.known) for body in self.hosts
        }  # fmt: skip
        return GroupSystem(self.dyad.joints, self.dyad.links, hosts, self.coordinate, self.branch.unit)

    def _flat(self, parts: Any) -> Any:  # noqa: ANN401 - a pose or a rate
        count = (len(self.coordinate),)
        return tuple(np.ravel(np.broadcast_to(np.asarray(part, dtype=float), self.shape or count)) for part in parts)

    def _shaped(self, parts: Any) -> Any:  # noqa: ANN401 - a pose or a rate
        return tuple(part.reshape(self.shape) for part in parts)

    def margin(self) -> Scalar:
        """Distance of φ from the end of the followed configuration over its whole extent, negative outside."""
        low, high = self.branch.ends
        return self.branch.margin(self.coordinate).reshape(self.shape) / (high - low or 1.0)

    def assembly_fault(self, linkage: Linkage) -> str:
        """The reason, in a sentence, why the links do not meet at some φ."""
        names = ", ".join(f"'{name}'" for name in self.dyad.links)
        s = "" if len(self.dyad.links) > 1 else "s"
        low, high = (linkage.place(end) for end in self.branch.ends)
        if self.branch.strays:
            return (
                f"a turn of the driver takes {names} into another configuration, and one turn to either side of the "
                f"sketch is followed; stay within"
            )
        return (
            f"{names} keep{s} the configuration of the sketch from {low} to {high} only, and end{s} there {DEAD}; stay "
            "within, or change a length"
        )


def group_problem(group: Group, linkage: Linkage, hosts: Any) -> Problem:  # noqa: ANN401 - a function of φ
    """The equations of a group of a linkage; ``hosts`` gives the motions of the bodies that it is joined to at φ."""
    return Problem(group.joints, group.links, hosts, linkage.extent(), linkage.is_linear)


# The configuration of a group that the sketch means: of the solutions from many starts the nearest to the sketch.

STARTS: Final = 96  # configurations to start from: the sketch, more and more disturbed
MOST_ITERATIONS: Final = 60  # steps of Levenberg and Marquardt
CONVERGED: Final = 1e-6  # of the unit: from here on Newton's method settles
SAME: Final = 1e-6  # units and rad between two configurations that are one


def configuration_at_sketch(linkage: Linkage, structure: Structure, group: Group, problem: Problem) -> Array:
    """The group's configuration (links, 3), x, y and θ, at the sketch.

    Raises AssemblyError without any solution, StructureError where the sketch leaves open which is meant.
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
            f"'{linkage.name}': {names} cannot be assembled at {linkage.place(at)} from the sketch; check the "
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
            f"{linkage.coordinate(at)}, got a sketch that leaves open which of {len(groups)} configurations "
            f"{names} have; place it under [sketch.points], nearer to one of them"
        )
    return np.asarray(groups[nearest_root])


def _point_names(points: Points) -> set[str]:
    return {f"'{point}'" for places in points.values() for point in places}


def _known_points(linkage: Linkage, group: Group, hosts: Motions) -> dict[str, Vector]:
    """Positions of points: of placed bodies, and of the sketch."""
    known = dict(linkage.sketch)
    for joint in group.joints:
        if isinstance(joint, Revolute) and joint.near in hosts:
            x, y = (float(np.ravel(part)[0]) for part in frames.point(hosts[joint.near][0], joint.near_local))
            known[joint.point] = (x, y)
    return known


def _guesses(points: Points, known: Mapping[str, Vector], unit: float) -> Array:
    """Coordinates to start from, (starts, links, 3): the sketch's as far as it goes, then ever more disturbed."""
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
    """The angle of a link whose points lie nearest to given places."""
    a, b = np.array(local) - np.mean(local, axis=0), np.array(world) - np.mean(world, axis=0)
    sine = float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    return math.atan2(sine, float(np.sum(a * b)))


def _levenberg_marquardt(system: GroupSystem, guess: Array) -> Array:
    """Levenberg and Marquardt's method from every guess; those that do not get near are nan."""
    here, factor = guess, np.full(len(guess), 1e-2)
    identity = np.eye(guess.shape[1] * 3)
    residual = system.residual(system.motions(here), 0)
    for _ in range(MOST_ITERATIONS):
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
    """The different configurations among all solutions, in the order of their starts."""
    result: list[Array] = []
    for root in values[np.all(np.isfinite(values), axis=(1, 2))]:
        if not any(_are_same(root, other, unit) for other in result):
            result.append(root)
    return result


def _are_same(values: Array, other: Array, unit: float) -> bool:
    turned = np.abs(np.exp(1j * values[:, 2]) - np.exp(1j * other[:, 2]))
    return bool(np.max(np.abs(values[:, :2] - other[:, :2])) < SAME * unit and np.max(turned) < SAME)
