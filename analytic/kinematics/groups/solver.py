"""Solving a group of a higher class within a linkage, many values of φ at once; the counterpart of ``DyadSolver``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.kinematics.branch import GroupBranch
from analytic.kinematics.frames import STILL, Pose, Rate, Scalar
from analytic.kinematics.groups.equations import GroupSystem, poses_of, rates_of
from analytic.kinematics.groups.following import Problem, corrected
from analytic.kinematics.structure import Group

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
        self.place = corrected(self._system(), self.branch.guess(self.coordinate))
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

    def why(self, linkage: Linkage) -> str:
        """Why the links do not meet somewhere."""
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


def problem_of(group: Group, linkage: Linkage, hosts: Any) -> Problem:  # noqa: ANN401 - a function of φ
    """A group of a linkage as a problem of its own."""
    return Problem(group.joints, group.links, hosts, linkage.extent(), linkage.is_linear)
