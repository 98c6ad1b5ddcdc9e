"""A linkage over an array of crank angles: poses and their exact derivatives, computed on demand and only once."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Linkage, Output, Vector
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics import frames
from analytic.kinematics.branch import Windows
from analytic.kinematics.dyad_solver import DyadSolver, check_assembly, check_motion
from analytic.kinematics.frames import STILL, Pair, Pose, Rate, Scalar
from analytic.kinematics.group_equations import point_derivative, residuals
from analytic.kinematics.group_solver import GroupSolver
from analytic.kinematics.structure import (
    AnyGroup,
    ClosedGroup,
    Prismatic,
    Revolute,
    Structure,
)
from analytic.numerics.arrays import Array, Booleans

FIXED: tuple[Any, Any, Any] = ((0.0, 0.0, 1.0, 0.0), STILL, STILL)  # the ground and its derivatives


def crank_pose(pivot: Revolute | Prismatic, angle: Scalar) -> Pose:
    """Pose of the driver at φ, rad or m: turned about its pin, or shifted along its guide."""
    if isinstance(pivot, Prismatic):
        x, y = frames.point_along(pivot.origin, angle, pivot.along)
        return (x, y, *pivot.turn)
    return frames.pose_through(pivot.near_local, (np.cos(angle), np.sin(angle)), pivot.far_local)


def crank_motion(pivot: Revolute | Prismatic, angle: Scalar) -> tuple[Pose, Rate, Rate]:
    """Pose of the driver's frame at φ, rad or m, and its first and second derivative over φ."""
    crank = crank_pose(pivot, angle)
    if isinstance(pivot, Prismatic):
        return crank, (*pivot.along, 0.0), STILL
    local = pivot.far_local
    rate = frames.rate_through(crank, (0.0, 0.0), 1.0, local)
    return crank, rate, frames.acceleration_through(crank, (0.0, 0.0), 1.0, 0.0, local)


def output_of(linkage: Linkage) -> Output:
    """The linkage's output; raises LinkproofError for a linkage without an output."""
    if linkage.output is None:
        raise LinkproofError(
            f"'{linkage.name}' names no output, so its S, v and a are undefined: add "
            "output = { point = ..., along = [x, y] } to its file"
        )
    return linkage.output


def driver_poses(structure: Structure, angle: Scalar) -> dict[str, Pose]:
    """Poses, by name, of the ground and the driven link at φ, rad or m, which belong to no group.

    Without a pivot, where a cylinder drives, it is the ground's alone.
    """
    poses: dict[str, Pose] = {GROUND: (0.0, 0.0, 1.0, 0.0)}
    return poses if structure.pivot is None else poses | {structure.pivot.far: crank_pose(structure.pivot, angle)}


def solver_of(group: AnyGroup, angle: Array, windows: Windows | None = None) -> DyadSolver | GroupSolver:
    """The solver of a group at values of φ: formulas where there are any, Newton's method for a higher class.

    Dyads of one linkage share the ``windows`` of change points at these values, which they fill.
    """
    return DyadSolver(group, angle, windows) if isinstance(group, ClosedGroup) else GroupSolver(group, angle)


class Sweep:
    """The linkage at the crank angles ``angle`` (rad, any shape).

    Everything is lazy: a pose solves only the dyads its link depends on, rates are computed only where a first
    derivative is requested, and so on. All derivatives are over φ (transfer functions), exact, and hold for any motion:
    velocity = first · ω, acceleration = second · ω² + first · ε.

    Where a group cannot be assembled or moved AssemblyError is raised; with ``faults``, of the angles' shape, they are
    set True there instead, and what depends on the group is nan or meaningless. ``places`` are the angles without the
    first axis if they are the same all along it, as those of many designs are. ``zero_of_s`` gives the output's
    coordinate, m, from which loads over S count.
    """

    def __init__(
        self,
        linkage: Linkage,
        structure: Structure,
        angle: Array,
        faults: Booleans | None = None,
        *,
        zero_of_s: Callable[[], Scalar] = float,
    ) -> None:
        """Pose the linkage at φ of any shape; where it fails ``faults`` is set or, without it, AssemblyError raised.

        Groups are solved when they are needed. ``zero_of_s`` gives the coordinate, m, from which loads over S count, by
        default 0.
        """
        self.linkage = linkage
        self.structure = structure
        self.angle = angle
        self.faults = faults
        self.zero_of_s = zero_of_s
        self.places = angle[0] if angle.ndim > 1 and angle.strides[0] == 0 and len(angle) > 1 else angle
        self._solvers: dict[str, DyadSolver | GroupSolver] = {}
        self._windows: Windows = {}
        self._centres: dict[tuple[str, int], Pair] = {}
        self._needs = {name: group for group in structure.groups for name in group.links}
        # Poses, rates and accelerations.
        self._known: list[dict[str, Any]] = [{GROUND: fixed} for fixed in FIXED]
        if structure.pivot is not None:
            for known, part in zip(self._known, crank_motion(structure.pivot, self.places), strict=True):
                known[linkage.crank] = part

    def with_loads_of(self, linkage: Linkage) -> Sweep:
        """The sweep of a linkage that differs in masses and loads only: its poses are those that are known here.

        Both share those worked out later, too.
        """
        other = copy(self)
        other.linkage, other._centres = linkage, {}
        return other

    def poses(self, body: str) -> Pose:
        """Origin x, y, m, and cosine and sine of the angle of a body's frame in the ground's.

        Raises UnknownNameError for no link, AssemblyError where it cannot be assembled.
        """
        pose: Pose = self._solve(body, 0)
        return pose

    def rates(self, body: str) -> Rate:
        """First derivatives x', y' (m/rad) and θ' over φ of a body's frame.

        Raises UnknownNameError for no link, AssemblyError where it cannot be assembled or moved.
        """
        rate: Rate = self._solve(body, 1)
        return rate

    def accelerations(self, body: str) -> Rate:
        """Second derivatives x'', y'' (m/rad²) and θ'' over φ of a body's frame; raises as ``rates`` does."""
        second: Rate = self._solve(body, 2)
        return second

    def _solve(self, body: str, order: int) -> Any:  # noqa: ANN401 - a pose or a rate
        """Pose of a body or its derivative of an order; solves its group, and those before it, as far as needed.

        Raises UnknownNameError for no link, AssemblyError where a group cannot be assembled or move.
        """
        known = self._known[order]
        if body not in known:
            if body not in self._needs:
                raise UnknownNameError("link", body, self.linkage.links)
            group = self._needs[body]
            if order == 0:
                solver = self._solvers[group.first] = solver_of(group, self.angle, self._windows)
            else:
                self._solve(body, order - 1)
                solver = self._solvers[group.first]
            for host in solver.hosts:
                self._solve(host, order)
            if order == 1:
                self._check_motion(solver)
            solved = (solver.poses, solver.rates, solver.accelerations)[order](known)
            if order == 0:
                self._handle_assembly(solver)  # before it counts as known: it fails every time
            known.update(zip(group.links, solved, strict=True))
        return known[body]

    def determinant(self, dyad: ClosedGroup) -> Scalar:
        """Determinant of the dyad's closure equations: its sign is the assembly mode's; zero in a dead position.

        Raises AssemblyError where the dyad cannot be assembled.
        """
        return self.solver(dyad).form.determinant

    def solver(self, dyad: ClosedGroup) -> DyadSolver:
        """The dyad's solver, its poses known; raises AssemblyError where they cannot be assembled."""
        self.poses(dyad.first)
        solver = self._solvers[dyad.first]
        assert isinstance(solver, DyadSolver)
        return solver

    def _handle_assembly(self, solver: DyadSolver | GroupSolver) -> None:
        """Raise AssemblyError where a group's links do not meet, or note it in ``faults``.

        Without ``faults`` raises LinkproofError for φ that are not finite.
        """
        check_assembly(self.linkage, solver, self.angle, self.faults)

    def _check_motion(self, solver: DyadSolver | GroupSolver) -> None:
        """Raise AssemblyError where a dyad is in a dead position, or note it in ``faults``."""
        check_motion(self.linkage, solver, self.angle, self.faults)

    def local_point(self, body: str, local: Vector, order: int = 0) -> Pair:
        """Place, m, ground frame, of the point ``local`` of a body's frame, or its derivative of order 1 or 2 over φ.

        Raises UnknownNameError for no link, AssemblyError where it cannot be assembled or moved.
        """
        motion: Any = tuple(self._solve(body, k) for k in range(order + 1))
        return point_derivative(motion, local, order)

    def point(self, name: str, order: int = 0) -> Array:
        """A named point in the ground frame, m, or its derivative of order 1 or 2 over φ; shape (2, *angle.shape).

        Raises UnknownNameError for an unknown point, AssemblyError where its link cannot be assembled or moved.
        """
        body = self.carrier(name)
        return self._filled(self.local_point(body, self.linkage.local(name, body), order))

    def carrier(self, name: str) -> str:
        """Name of the body through which a named point is cheapest to reach: ground, crank, else the link solved first.

        Raises UnknownNameError for an unknown point.
        """
        if name in self.linkage.ground:
            return GROUND
        if name not in self._carriers:
            raise UnknownNameError("point", name, {*self._carriers, *self.linkage.ground})
        return self._carriers[name]

    @cached_property
    def _carriers(self) -> dict[str, str]:
        """The name of the moving link that carries each point and is solved first, by the point's name."""
        links = self.linkage.links
        order = [self.linkage.crank, *(name for group in self.structure.groups for name in group.links)]
        return {point: body for body in reversed(order) if body in links for point in links[body].points}

    def angles(self, body: str) -> Array:
        """Angle of a link's frame, rad, shape of the crank angles, unwrapped along their last axis.

        A turning crank's is φ itself. Raises as ``poses`` does.
        """
        if body == self.linkage.crank and not self.linkage.is_linear:
            return self.angle
        _, _, c, s = self.poses(body)
        return np.unwrap(np.broadcast_to(np.arctan2(s, c), self.angle.shape)) if self.angle.ndim else np.arctan2(s, c)

    def turned_from(self, bodies: tuple[str, str], angle: float) -> Array:
        """Angle, rad, of the first body against the second less ``angle``, rad, within half a turn to either side.

        ``bodies`` are names; raises as ``poses`` does.
        """
        (_, _, c1, s1), (_, _, c2, s2) = (self.poses(body) for body in bodies)
        c, s = frames.turned((0.0, 0.0, c2, s2), (np.cos(angle), np.sin(angle)))
        turned: Array = np.arctan2(s1 * c - c1 * s, c1 * c + s1 * s)
        return turned

    def centre(self, body: str, order: int = 0) -> Pair:
        """Mass centre of a link, by name, m, ground frame, or its derivative of order 1 or 2 over φ.

        It is kept, since all of the dynamics uses it. Raises KeyError for no link of the file, AssemblyError where it
        cannot be assembled or moved.
        """
        if (body, order) not in self._centres:
            self._centres[body, order] = self.local_point(body, self.linkage.links[body].centre, order)
        return self._centres[body, order]

    def _filled(self, pair: Pair) -> Array:
        """The components of a vector as one array, each over all angles: (2, *angle.shape)."""
        return np.stack([np.broadcast_to(part, self.angle.shape) for part in pair])

    def output(self, order: int = 0) -> Array:
        """The linkage's output point along the output's direction, m, or a derivative of it; shape of the angles.

        The order of the derivative over φ is 1 or 2. Raises LinkproofError for a linkage without an output,
        AssemblyError where it cannot be assembled or moved.
        """
        output = output_of(self.linkage)
        x, y = self.local_point(output.link, self.linkage.local(output.point, output.link), order)
        along = frames.dot(output.along, (x, y))
        return np.broadcast_to(along, self.angle.shape)

    def load(self, law: Law, speed: Scalar) -> Any:  # noqa: ANN401 - plain or traced
        """Components, SI, of a force's or torque's law at the sweep's φ, or at S, 0 where it does not act.

        There is an entry for each. The sign of ``speed`` gives the driver's direction for a law that acts on one way
        only; at rest it is as if φ grew. Raises LinkproofError for a law that needs the output of a linkage without
        one, AssemblyError where the output cannot be assembled or moved.
        """
        parts: Any = law(self.places if law.over == "phi" else self.zero_of_s() - self.output())
        if law.when is None:
            return parts
        rises = self.output(1) * np.where(speed < 0.0, -1.0, 1.0) > 0.0  # and S falls
        shown, hidden = (0.0, 1.0) if law.when == "advance" else (1.0, 0.0)
        acts = np.where(rises, shown, hidden)
        return [acts * part for part in parts]

    def closure_error(self) -> Array:
        """Largest distance between the two ends of any joint, m, per crank angle: a check of loop closure.

        Of a slide it is the distance across its line, of a cylinder its length less φ. Raises AssemblyError where the
        linkage cannot be assembled.
        """
        worst = np.zeros(self.angle.shape)
        for joint in (joint for group in self.structure.groups for joint in group.joints):
            motions = {body: (self.poses(body), STILL, STILL) for body in (joint.near, joint.far)}
            gaps = residuals([joint], motions, 0, self.angle)
            lengths = gaps[:1] if isinstance(joint, Prismatic) else gaps  # the other one is an angle
            worst = np.maximum(worst, np.sqrt(sum(gap * gap for gap in lengths)))
        return worst


# Transmission angle of a dyad: how well its links transmit force to each other: 90° at best, 0° in a dead position.
#
# Of two rods (RRR) it is the angle between them at their common pin (Alt). Of a rod and a slide (RRP) it is the angle
# between the rod and the slide's normal; of a slide between two pins (RPR) the angle between the line through the pins
# and the slide's normal; of two slides (RPP, PRP) the angle between them; a cylinder that drives a link counts as its
# rod. In each case it is the angle between the two columns of the dyad's closure equations, so that its sine is their
# determinant over the lengths in it; the acute one, for 130° push as well as 50°, with a kink where they are square to
# each other.


def transmission_angle(sweep: Sweep, dyad: ClosedGroup) -> Array:
    """The dyad's transmission angle, rad, in [0, π/2], at every crank angle of the sweep, as a new array.

    Raises AssemblyError where the dyad cannot be assembled.
    """
    solver = sweep.solver(dyad)
    first, second = solver.form.columns(solver.link_poses)
    angle = np.arctan2(np.abs(frames.cross(first, second)), np.abs(frames.dot(first, second)))  # of two lines, acute
    return np.copy(np.broadcast_to(angle, sweep.angle.shape))
