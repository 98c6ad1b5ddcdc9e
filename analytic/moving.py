"""A linkage at crank angles with the crank's motion there: the common argument of torques, forces and signals."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import reactions, shaking
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Revolute
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]


class LinkageInMotion(ABC):
    """A ``sweep`` of a ``mechanism`` whose crank has a ``speed``, rad/s, and an ``acceleration``, rad/s².

    Both are of the sweep's shape or scalar. Everything is computed once, when it is needed.
    """

    if TYPE_CHECKING:

        @property
        def mechanism(self) -> Mechanism: ...  # noqa: D102
        @property
        def sweep(self) -> Sweep: ...  # noqa: D102
        @property
        def speed(self) -> Array: ...  # noqa: D102
        @property
        def acceleration(self) -> Array: ...  # noqa: D102

    @property
    @abstractmethod
    def farthest(self) -> Any:  # noqa: ANN401 - a number, or one for each design
        """The output's coordinate at which S is 0, m."""

    @cached_property
    def inertia(self) -> Array:
        """Jeq, the moment of inertia reduced to the crank, kg m²; of a linear driver the mass, kg."""
        return reduced.reduced_inertia(self.sweep)

    @cached_property
    def torque(self) -> Array:
        """Mkr, the torque of the drive on the crank, N m, positive along growing φ; of a linear driver its force, N."""
        inertia = self.inertia if np.any(self.acceleration) else np.zeros(self.sweep.angle.shape)
        return reduced.balance(self.sweep, inertia, self.speed, self.acceleration)

    @cached_property
    def joint_forces(self) -> Mapping[str, Array]:
        """Force of every joint by name, (2, *shape), N: one analysis of the linkage gives them all."""
        return reactions(self.sweep, self.speed, self.acceleration).forces

    @cached_property
    def shaking(self) -> Array:
        """Force on the frame, N, and its moment about the crank's pivot, or the origin, N m: (3, *shape)."""
        pivot = self.sweep.structure.pivot
        about = pivot.near_local if isinstance(pivot, Revolute) else (0.0, 0.0)
        return shaking(self.sweep, self.speed, self.acceleration, about)


@dataclass(frozen=True)
class MovingSweep(LinkageInMotion):
    """Crank angles with the crank's speed, rad/s, acceleration, rad/s², and the output's coordinate at which S is 0."""

    mechanism: Mechanism
    sweep: Sweep
    speed: Array
    acceleration: Array
    farthest: float | Array = 0.0
