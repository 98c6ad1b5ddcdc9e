"""Forces of a linkage in steady rotation: in its joints and on its frame, over a turn at the regime's final speed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.dynamics.joint_forces import joint_forces, shaking_force, shaking_moment
from analytic.kinematics.structure import Revolute
from reports.document.templates import sentence
from reports.records.views import View

Array = NDArray[np.float64]

POINTS = 361


@dataclass(frozen=True)
class TurnForces:
    """Forces at every degree of a turn with the crank at ``view.final_speed`` and no acceleration."""

    view: View

    @cached_property
    def angle(self) -> Array:
        """Crank angle, rad, (n,), a full turn with both ends."""
        return np.linspace(0.0, 2.0 * np.pi, POINTS)

    @cached_property
    def joints(self) -> dict[str, Array]:
        """Force of every joint, N, (2, n), by name."""
        return joint_forces(self.view.mechanism.sweep(self.angle), self.view.final_speed, 0.0)

    @cached_property
    def peaks(self) -> dict[str, tuple[float, float]]:
        """Largest magnitude of every joint's force, N, and the crank angle of it, degrees."""
        return {name: self._peak(np.hypot(*force)) for name, force in self.joints.items()}

    @cached_property
    def shaking(self) -> Array:
        """Force on the frame, N, (2, n)."""
        return shaking_force(self.view.mechanism.sweep(self.angle), self.view.final_speed, 0.0)

    @cached_property
    def pivot(self) -> str:
        """The crank's pivot, about which the moment is taken; of another driver the drawing's origin."""
        pivot = self.view.mechanism.structure.pivot
        return pivot.point if isinstance(pivot, Revolute) else "the origin"

    @cached_property
    def moment(self) -> Array:
        """Moment on the frame about the crank's pivot, N m, (n,)."""
        about = self.view.linkage.ground.get(self.pivot, (0.0, 0.0))
        return shaking_moment(self.view.mechanism.sweep(self.angle), self.view.final_speed, 0.0, about)

    def _peak(self, values: Array) -> tuple[float, float]:
        place = int(np.argmax(values))
        return float(values[place]), float(np.degrees(self.angle[place]))


def lead(found: TurnForces) -> str:
    """The forces in words."""
    joint = max(found.peaks, key=lambda name: found.peaks[name][0])
    largest, angle = found.peaks[joint]
    shake = float(np.hypot(*found.shaking).max())
    return sentence("forces", found=found, joint=joint, largest=largest, angle=angle, shake=shake)
