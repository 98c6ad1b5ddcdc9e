"""Solving a dyad within a linkage: from the placed bodies' poses, rates and accelerations to those of its two links."""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType
from typing import Any, Final

import numpy as np

from analytic.kinematics.dyads import prp, rpp, rpr, rrp, rrr
from analytic.kinematics.dyads.closure import At, Shortfall, Written
from analytic.kinematics.frames import Pose, Rate, Scalar
from analytic.kinematics.structure import Dyad

FORMULAS: Final[Mapping[str, ModuleType]] = {"RRR": rrr, "RRP": rrp, "RPR": rpr, "RPP": rpp, "PRP": prp}


class DyadSolver:
    """A dyad being solved; the mappings hold every body placed before it.

    Results of one step are stored for the next, so that poses alone cost no more than poses.
    """

    def __init__(self, dyad: Dyad, angle: Scalar = None) -> None:
        """``angle``, rad, is needed where the dyad passes change points."""
        self.dyad, self.angle = dyad, angle
        self.sign: Scalar = float(dyad.sign) if dyad.changes is None else dyad.changes.signs(angle)
        self.constants = self.formulas.constants(*dyad.joints, self.sign)
        self.hosts = (dyad.first_joint.near, dyad.second_joint.near)
        self.link_poses: tuple[Pose, Pose]
        self.link_rates: tuple[Rate, Rate]

    @property
    def formulas(self) -> ModuleType:
        """The module of the dyad's kind; looked up here, since solvers are pickled and modules cannot be."""
        return FORMULAS[self.dyad.kind]

    def poses(self, poses: Mapping[str, Pose]) -> tuple[Pose, Pose]:
        """Poses of the first and the second link; nan where the links do not meet."""
        first, two = self.hosts
        self.near = (poses[first], poses[two])
        with np.errstate(divide="ignore", invalid="ignore"):
            self.link_poses, self.closure = self.formulas.poses(self.constants, self.near)
            self.moves = self._moves()
        self.link_poses = self._followed(0, self.link_poses)
        return self.link_poses

    def _followed(self, order: int, pair: tuple[Any, Any]) -> tuple[Any, Any]:
        """Values of the formulas, near change points those of the series through them."""
        return pair if self.dyad.changes is None else self.dyad.changes.patched(self.angle, order, pair)

    def _moves(self) -> Scalar:
        """Where the dyad is away from its dead positions, so that its links meet and can move."""
        determinant, least = self.closure.determinant, self.formulas.least(self.constants, self.closure)
        if self.dyad.changes is not None:
            return self.dyad.changes.moves(self.angle, self.sign * determinant > least)
        if self.dyad.sign > 0:  # the determinant's own sign
            return determinant > least
        return determinant < -least if self.dyad.sign < 0 else abs(determinant) > least

    def rates(self, rates: Mapping[str, Rate]) -> tuple[Rate, Rate]:
        """First derivatives over φ; the poses must be known."""
        first, two = self.hosts
        self.near_rates = (rates[first], rates[two])
        with np.errstate(divide="ignore", invalid="ignore"):
            link_poses, self.travel = self.formulas.rates(
                self.constants, self.near, self.near_rates, self.link_poses, self.closure
            )
        self.link_rates = self._followed(1, link_poses)
        return self.link_rates

    def accelerations(self, accelerations: Mapping[str, Rate]) -> tuple[Rate, Rate]:
        """Second derivatives over φ; the rates must be known."""
        first, two = self.hosts
        with np.errstate(divide="ignore", invalid="ignore"):
            pair = self.formulas.accelerations(
                self.constants,
                (self.near, self.near_rates, (accelerations[first], accelerations[two])),
                (self.link_poses, self.link_rates),
                self.closure,
                self.travel,
            )
        return self._followed(2, pair)

    def missing(self) -> tuple[Scalar, Scalar]:
        """Length, m, by which the links reach beyond meeting, else negative, and the lengths it comes from."""
        length, lengths = self.formulas.missing(self.constants, self.near, self.closure)
        return length, lengths

    def gap(self) -> Scalar:
        """Distance of the outer pins, m; infinite where there is only one."""
        return self.formulas.gap(self.constants, self.near)

    def touch(self, margin: Scalar, gap: Scalar) -> None:
        """Take those lengths of the links with which they touch where they miss by a ``margin`` of rounding, m."""
        self.constants = self.formulas.touching(self.constants, margin, gap)

    def shortfall(self, at: At, written: Written) -> Shortfall:
        """Why the links do not meet at a crank angle: the link, by how much it misses, and the remedy."""
        fault, detail = self.formulas.shortfall(self.dyad, self.constants, self.near, at, written)
        return fault, detail
