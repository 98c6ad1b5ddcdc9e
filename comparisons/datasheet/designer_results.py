"""The results of a case, ready to be printed, written or drawn."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.kinematics.structure import Revolute
from analytic.numerics.extremes import in_turn
from comparisons.datasheet.curves import Curves
from comparisons.datasheet.figures import (
    NEGLIGIBLE,
    DrivePoint,
    Extreme,
    ForcePeak,
    drive_points,
    force_peaks,
    output_extremes,
    transmission,
)
from comparisons.datasheet.instants import Instants
from comparisons.datasheet.units import FileUnit, file_unit
from comparisons.reference.case import Case, Truth

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DesignerResults:
    """A case at its instants: key figures, signals by name, conditions in words."""

    case: Case
    instants: Instants
    _scales: dict[tuple[str, str], float] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def curves(self) -> Curves:
        """The signals by name."""
        return Curves(self.case, self.instants)

    @property
    def linkage(self) -> Linkage:
        """The linkage."""
        return self.case.mechanism.linkage

    @property
    def axis(self) -> str:
        """Name of the axis: "phi" or "time"."""
        return self.instants.axis

    @cached_property
    def drive(self) -> list[DrivePoint]:
        """What chooses a motor."""
        return drive_points(self.curves)

    @cached_property
    def forces(self) -> list[ForcePeak]:
        """Largest forces, joint by joint, and on the frame."""
        return force_peaks(self.curves)

    @cached_property
    def transmission(self) -> list[Extreme]:
        """Least transmission angles, group by group."""
        return transmission(self.curves)

    @cached_property
    def output(self) -> list[Extreme]:
        """Ends of the output's travel and its peaks."""
        return output_extremes(self.curves)

    @property
    def is_linear(self) -> bool:
        """Whether the drive moves along a line."""
        return self.linkage.is_linear

    @property
    def speed_unit(self) -> FileUnit:
        """The unit of the crank's speed for a designer: rpm, or the file's along a line."""
        return file_unit("m/s", self.linkage) if self.is_linear else FileUnit("rpm", RPM)

    def unit(self, name: str) -> FileUnit:
        """The file's unit of a signal."""
        return file_unit(self.curves.unit(name), self.linkage)

    def shown_angle(self, time: float) -> float:
        """φ at an instant in the file's unit, within a turn where the motion is that long."""
        angle = float(self.case.motion.angle(np.array([time]))[0])
        if not self.is_linear and self.way >= FULL_TURN * (1.0 - NEGLIGIBLE):
            angle = float(in_turn(angle))
        return angle / self.unit("phi").size

    @property
    def moment_centre(self) -> str:
        """The point about which the shaking moment is taken: the crank's pivot, else the origin."""
        pivot = self.case.mechanism.structure.pivot
        return pivot.point if isinstance(pivot, Revolute) else "the origin"

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Least and largest φ, rad, or travel, m."""
        angle = self.case.motion.angle(self.instants.grid)
        return float(np.min(angle)), float(np.max(angle))

    @property
    def way(self) -> float:
        """Difference between the two."""
        return self.reach[1] - self.reach[0]

    @property
    def conditions(self) -> str:
        """Mechanism, motion and gravity in words."""
        name = f"{self.linkage.name} ({self.linkage.variant})"
        gravity = "gravity on" if any(self.linkage.gravity) else "gravity off"
        return f"{name}: {self.case.conditions or f'{self._motion()}, {gravity}'}"

    def _motion(self) -> str:
        """The crank's motion in words."""
        motion, angle = self.case.motion, self.unit("phi")
        first, last = (float(motion.angle(np.array([t]))[0]) / angle.size for t in (0.0, motion.duration))
        unit = self.speed_unit
        sign = "" if self.is_linear else " clockwise" if last < first else " counter-clockwise"
        most = "" if self.instants.is_steady else "up to "
        mark = "°" if angle.name == "deg" else f" {angle.name}"
        speed = f"{most}{motion.peak_speed / unit.size:.6g} {unit.name}{sign}"
        return f"{motion.regime}, {speed}, φ from {first:.6g}{mark} to {last:.6g}{mark} in {motion.duration:.4g} s"

    @cached_property
    def shown(self) -> Truth:
        """The closed form at the instants of tables and files."""
        return self.curves.on_grid if self.instants.chosen is None else self.curves.at(self.instants.shown)

    def scale(self, name: str) -> float:
        """The largest magnitude over the motion of all signals of the kind and unit of one: what is small beside it."""
        kind, unit = name.partition(":")[0], self.curves.unit(name)
        if (kind, unit) not in self._scales:
            alike = [n for n in self.curves.names if n.partition(":")[0] == kind and self.curves.unit(n) == unit]
            values = np.abs([self.curves.of(self.curves.on_grid, n) for n in alike])
            self._scales[kind, unit] = float(np.max(values, where=np.isfinite(values), initial=0.0))
        return self._scales[kind, unit]
