"""The range of φ, a crank angle or a travel, in which a linkage stays in its assembly mode, and its limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import CylinderDrive, DriverCoordinate, Linkage
from analytic.errors import AssemblyError
from analytic.kinematics.branch import Windows
from analytic.kinematics.change_points import TOUCHING, Undetermined, is_followed
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.dyads import ROUNDING
from analytic.kinematics.group_solver import DEAD, GroupSolver
from analytic.kinematics.structure import AnyGroup, ClosedGroup, Structure
from analytic.kinematics.sweep import Sweep, driver_poses, solver_of
from analytic.numerics.arrays import Array
from analytic.numerics.roots import find_lowest, may_touch_zero, root

# The margins are looked at in steps of half a degree, and in ever finer ones towards the start, for ranges narrower
# than that; a minimum that may come down to zero between two steps is closed in on.
STEP: Final = FULL_TURN / 720
NEAREST, NEAR_STEPS = 1e-13, 80
SPAN: Final = 8.0  # of the drawing's size: how far a driver that does not turn is followed to either side
DIGITS: Final = 8  # of a change point that several dyads have
LOOKS: Final = 12  # each look at a minimum shrinks its bracket 16-fold


@dataclass(frozen=True)
class Toggle:
    """A crank angle, rad, or a travel, m, at which a dyad comes to the end of its assembly mode, and how it stands.

    Without a dyad it is an end of the driving cylinder, where nothing is dead.
    """

    angle: float
    dyad: AnyGroup | None
    reason: str

    @property
    def sentence(self) -> str:
        """How the links stand there, after their names, such as "coupler + rocker (RRR): stretched in one line".

        At an end of the cylinder it is "the cylinder is retracted" or "extended".
        """
        return f"{self.dyad.name}: {self.reason}" if self.dyad else self.reason


@dataclass(frozen=True)
class CrankRange:
    """The crank angles from ``low`` to ``high`` around ``start``, rad; both are None where the crank turns fully.

    Of a driver that is pushed they are travels or lengths, m, and an end is None where nothing limits it within
    ``reach`` of the start. ``phi`` says which of both the driver has, and writes φ. ``change_points`` are the angles
    within it at which two assembly modes meet and neither ends: the crank passes them.
    """

    start: float
    low: Toggle | None
    high: Toggle | None
    change_points: tuple[Toggle, ...]
    phi: DriverCoordinate
    reach: float

    @property
    def is_full_turn(self) -> bool:
        """Whether the driver is a crank without limits."""
        return self.low is None and not self.phi.is_linear

    @property
    def limits(self) -> tuple[float, float]:
        """The lowest and the highest φ, rad or m; of a full turn, the turn that begins at ``start``.

        Of a pushed driver an end that nothing limits lies ``reach`` from the start.
        """
        if self.phi.is_linear:
            low = self.start - self.reach if self.low is None else self.low.angle
            return low, self.start + self.reach if self.high is None else self.high.angle
        if self.low is None or self.high is None:
            return self.start, self.start + FULL_TURN
        return self.low.angle, self.high.angle

    def check(self, first: float, last: float, linkage: str) -> None:
        """Raise AssemblyError where a motion from ``first`` to ``last``, rad or m, leaves the range.

        ``linkage`` is the name for the message; a crank without limits may go anywhere.
        """
        if self.is_full_turn:
            return
        low, high = self.limits
        if min(first, last) < low or max(first, last) > high:
            limit = self.low if min(first, last) < low else self.high
            place = self.phi.unwrapped
            cause = f"at {place(limit.angle)} {limit.sentence}" if limit else "farther it is not followed"
            driver = "drive" if self.phi.is_linear else "crank"
            raise AssemblyError(
                f"'{linkage}' cannot be moved from {place(first)} to {place(last)}: its {driver} reaches "
                f"{place(low)} to {place(high)} ({cause}); stay within, "
                "with --from and --to or a regime of its file"
            )


def crank_range(
    linkage: Linkage, structure: Structure, undetermined: Sequence[Undetermined], start: float | None = None
) -> CrankRange:
    """The range of φ around ``start``, rad or m, by default the sketch's.

    The limits are zeros of the margin by which a dyad's links reach each other, to rounding; where the margin only
    touches zero, and the linkage is not followed on, the place where rounding has it zero. ``undetermined`` are the
    change points that leave a dyad free. Raises AssemblyError where it cannot be assembled at the start.
    """
    search = _Margins(linkage, structure, linkage.sketch_angle if start is None else start)
    low = search.nearest_limit(-1.0)
    turns = low is None and not linkage.is_linear  # a whole turn backwards, so forwards as well
    high = None if turns else search.nearest_limit(1.0)
    changes = search.change_points(low, high, undetermined)
    if linkage.is_linear:
        low, high = _cylinder_ends(linkage.cylinder, low, high)
    return CrankRange(search.start, low, high, changes, linkage.phi, FULL_TURN * search.radian)


def _cylinder_ends(
    cylinder: CylinderDrive | None, low: Toggle | None, high: Toggle | None
) -> tuple[Toggle | None, Toggle | None]:
    """The ends of a pushed driver's range: ``low`` and ``high``, or the ends of its cylinder that come before them.

    None is no end, or no cylinder.
    """
    shortest, longest = (None, None) if cylinder is None else (cylinder.shortest, cylinder.longest)
    if shortest is not None and (low is None or low.angle < shortest):
        low = Toggle(shortest, None, "the cylinder is retracted")
    if longest is not None and (high is None or high.angle > longest):
        high = Toggle(longest, None, "the cylinder is extended")
    return low, high


class _Margins:
    """The margins of a linkage's groups over the crank angle: the lengths left before links fail to meet."""

    def __init__(self, linkage: Linkage, structure: Structure, start: float) -> None:
        """Note each group's sign at ``start``, rad or m.

        Raises AssemblyError where the linkage cannot be assembled there.
        """
        self.structure, self.start = structure, start
        here = np.array([start])
        sweep = Sweep(linkage, structure, here)
        for body in structure.bodies:
            sweep.poses(body)  # raises where it is not assembled
        self.signs = [
            1.0 if isinstance(solver, GroupSolver) else np.sign(solver.form.determinant)
            for solver in self.solvers(here)
        ]
        self.radian = SPAN * linkage.extent() / FULL_TURN if linkage.is_linear else 1.0  # what angles are counted in
        steps = [np.zeros(1), np.geomspace(NEAREST, STEP, NEAR_STEPS)[:-1], np.arange(1, 721) * STEP]
        self.offsets = self.radian * np.concatenate(steps)

    def solvers(self, angle: Array) -> list[DyadSolver | GroupSolver]:
        """The solvers of all groups at φ, rad or m, in order, their poses worked out, whether the links meet or not."""
        poses = driver_poses(self.structure, angle)
        windows: Windows = {}
        solvers = [solver_of(group, angle, windows) for group in self.structure.groups]
        for solver in solvers:
            poses.update(zip(solver.group.links, solver.poses(poses), strict=True))
        return solvers

    def margins(self, offset: Array) -> Array:
        """Each group's remaining length over the lengths it comes from, (groups, ...); negative where it fails.

        ``offset`` counts from the start, rad or m. The margin of two crossing lines is the sine of their angle. Behind
        a group that fails, margins are infinite.
        """
        rows = np.full((len(self.signs), *offset.shape), np.inf)
        fails = np.zeros(offset.shape, dtype=bool)
        with np.errstate(invalid="ignore", divide="ignore"):
            for number, (solver, sign) in enumerate(zip(self.solvers(self.start + offset), self.signs, strict=True)):
                if isinstance(solver, GroupSolver):
                    missing, lengths = solver.margin(), 1.0
                else:
                    parallel = (solver.form.determinant, sign)
                    missing, lengths = solver.form.reach_margin() if solver.group.has_two_modes else parallel
                row = np.where(fails, np.inf, missing / lengths)
                rows[number] = np.where(np.isnan(row), -1.0, row)
                fails |= rows[number] < -ROUNDING
        return rows

    def toggle(self, offset: float, row: int) -> Toggle:
        """The limit at an offset, rad or m, from the start: the group numbered ``row`` and how its links stand."""
        solver = self.solvers(np.array([self.start + offset]))[row]
        if isinstance(solver, GroupSolver):
            return Toggle(self.start + offset, solver.group, f"its links stand {DEAD}")
        return Toggle(self.start + offset, solver.group, solver.form.dead_position())

    def nearest_limit(self, direction: float) -> Toggle | None:
        """The end of the range in a direction of φ, 1 or -1; None where no limit is found.

        A crank is followed for a turn, a driver that is pushed over eight times the drawing's size.
        """
        offsets = direction * self.offsets
        margins = self.margins(offsets)
        least = -ROUNDING if is_followed(self.structure) else TOUCHING
        bad = np.concatenate(
            [offsets[np.any(margins < -ROUNDING, axis=0)], self._minima_below(offsets, margins, least)]
        )
        if not len(bad):
            return None
        end = float(bad[np.argmin(np.abs(bad))])
        good = float(offsets[np.abs(offsets) < abs(end)][-1])
        for _ in self.signs:
            row = int(np.argmin(self.margins(np.array([end]))[:, 0]))
            at = self._zero_of_margin(row, good, end)
            left = self.margins(np.array([at]))[:, 0]
            left[row] = 0.0
            if np.min(left) >= -ROUNDING:
                break
            end = at  # a group before it comes to its end nearer to the start
        return self.toggle(at, row)

    def _minima_below(self, offsets: Array, margins: Array, least: float) -> Array:
        """Offsets, rad or m, at minima of a group's margin, refined between samples, where it is below ``least``.

        ``margins`` (groups, n) are those at ``offsets`` (n,) from the start. Bends at change points, which the linkage
        passes, are left out.
        """
        inner = margins[:, 1:-1]
        low = (inner < margins[:, :-2]) & (inner <= margins[:, 2:]) & (inner < least)
        seen = offsets[1:-1][np.any(low, axis=0)]
        looked_at = may_touch_zero(margins, ROUNDING)
        for row, group in enumerate(self.structure.groups):
            if isinstance(group, ClosedGroup) and group.changes:  # which it passes, so that they are no limits
                bends = group.changes.signs(self.start + offsets[2:]) != group.changes.signs(self.start + offsets[:-2])
                looked_at[row] &= ~bends
        rows, columns = np.nonzero(looked_at)
        if not len(rows):
            return seen
        each = np.arange(len(rows))
        brackets = offsets[columns], offsets[columns + 2]
        spots, heights = find_lowest(lambda at: self.margins(at)[rows, each], *brackets, LOOKS, enough=least)
        return np.concatenate([seen, spots[heights < least]])

    def _zero_of_margin(self, row: int, good: float, end: float) -> float:
        """The offset at which the margin of group ``row`` is zero or touches it, between ``good`` and ``end``.

        All three are rad or m from the start; ``good`` is within the range.
        """

        def margin(offset: float) -> float:
            """The margin of the group numbered ``row`` at one offset from the start, rad or m."""
            return float(self.margins(np.array([offset]))[row, 0])

        if margin(end) >= 0.0:
            return end
        return root(margin, good, end) if margin(good) > 0.0 else good

    def change_points(
        self, low: Toggle | None, high: Toggle | None, undetermined: Sequence[Undetermined]
    ) -> tuple[Toggle, ...]:
        """Change points between the limits, in order; one shared by several dyads is the first dyad's.

        Without both limits they are those of a turn from the start; ``undetermined`` ones are among them.
        """
        known = [(angle, dyad) for dyad in self.structure.dyads if dyad.changes for angle in dyad.changes.angles]
        known += [(angle, dyad) for dyad, angle, _ in undetermined]
        first, last = (low.angle, high.angle) if low and high else (self.start, self.start + FULL_TURN)
        points: dict[float, Toggle] = {}
        for angle, dyad in known:
            offset = first - self.start + (angle - first) % FULL_TURN
            if offset <= last - self.start and round(offset, DIGITS) not in points:
                points[round(offset, DIGITS)] = self.toggle(offset, self.structure.groups.index(dyad))
        return tuple(points[offset] for offset in sorted(points))
