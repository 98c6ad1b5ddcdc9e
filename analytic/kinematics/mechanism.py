"""A linkage ready to be evaluated: with its Assur groups and the assembly modes that its sketch means."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property, wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import AssemblyError, LinkproofError, StructureError
from analytic.kinematics.branch import named_places, nearest_to_sketch
from analytic.kinematics.change_points import period_of, with_change_points
from analytic.kinematics.crank_range import CrankRange, crank_range
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.dyad_solver import DyadSolver, check_assembly
from analytic.kinematics.frames import Pose
from analytic.kinematics.group_equations import Motions
from analytic.kinematics.group_solver import configuration_at_sketch, follow_branch, group_problem
from analytic.kinematics.structure import AnyGroup, ClosedGroup, Group, Structure
from analytic.kinematics.sweep import Sweep, driver_poses, solver_of
from analytic.numerics.arrays import Array
from analytic.numerics.refine import zeros

AT_REST = 1e-6  # rad from a change point


class Mechanism:
    """The closed form of one linkage.

    Raises StructureError if the linkage has no Assur groups or its sketch leaves an assembly mode open, and
    AssemblyError if it cannot be put together at the sketch's crank angle.
    """

    def __init__(self, linkage: Linkage) -> None:
        """The closed form of a ``linkage``, which is kept; raises StructureError or AssemblyError where it has none."""
        self._assemble(linkage, ())

    def _assemble(self, linkage: Linkage, signs: Sequence[int]) -> None:
        """Set the linkage, its structure with assembly modes and change points, and its period.

        ``signs`` are those of the dyads in order; without any the sketch picks the modes. Raises as the class does.
        """
        self.linkage = linkage
        signed = _with_assembly_modes(linkage, find_structure(linkage), signs)
        self.structure, self.undetermined = with_change_points(signed, linkage.sketch_angle)
        self.period = period_of(self.structure)
        self._ranges: dict[float | None, CrankRange] = {}

    def redesigned(self, linkage: Linkage) -> Mechanism:
        """The closed form of a linkage that differs in numbers only, its dyads in the assembly modes of this one.

        Whether its dyads meet is not checked; raises StructureError or AssemblyError for a group of a higher class that
        the sketch leaves open or that does not meet.
        """
        other = Mechanism.__new__(Mechanism)
        other._assemble(linkage, [dyad.sign for dyad in self.structure.dyads])
        return other

    def with_loads_of(self, linkage: Linkage) -> Mechanism:
        """The closed form of a linkage that differs in masses and loads only, so that it moves as this linkage does.

        It shares what this one has worked out about the motion.
        """
        other = copy(self)
        other.__dict__.pop("turn", None)
        other.linkage = linkage
        return other

    @property
    def cycle(self) -> float:
        """The angle, rad, through which the crank turns until motion and loads repeat: one turn, or several."""
        return max(self.period, self.linkage.load_period)

    @property
    def repeats(self) -> bool:
        """Whether motion and loads repeat after one turn.

        They do not of a pushed driver, with an odd number of change points a turn, or under loads of a longer period.
        """
        return not self.linkage.is_linear and self.cycle == FULL_TURN

    @cached_property
    def changes(self) -> tuple[float, ...]:
        """Crank angles, rad in [0, 2π), ascending, of change points that the linkage passes smoothly."""
        points = [dyad.changes.angles for dyad in self.structure.dyads if dyad.changes]
        turned = [float(np.mod(angle, FULL_TURN)) for angles in points for angle in angles]
        return tuple(sorted({round(angle, 8): angle for angle in turned}.values()))

    def sweep(self, angle: ArrayLike) -> Sweep:
        """The linkage at every φ (rad or m, any shape); poses are computed when they are needed.

        AssemblyError, where it cannot be assembled or moved, is raised only then.
        """
        places = np.asarray(angle, dtype=float)
        return Sweep(self.linkage, self.structure, places, zero_of_s=self.zero_of_s)

    @cached_property
    def output_reversals(self) -> Array:
        """Crank angles, rad, ascending, at which the output turns back: roots of its first derivative, not grid points.

        They are those of one period of the motion. Raises LinkproofError without an output, AssemblyError where the
        linkage cannot be assembled or moved over a turn.
        """
        return zeros(lambda phi: self.sweep(phi).output(1), turns=round(self.period / FULL_TURN))

    def zero_of_s(self) -> float:
        """The output's coordinate at the top dead centre, m, from which loads over S count.

        Raises LinkproofError where the crank makes no full turn, which would show it, or moves no output.
        """
        return self._top_of_output

    @cached_property
    def _top_of_output(self) -> float:
        """The output's largest coordinate over a turn, m; raises LinkproofError without a full turn that moves it."""
        try:
            self.check_full_turn()
            return float(np.max(self.sweep(self.output_reversals).output()))
        except (AssemblyError, ValueError) as error:
            raise LinkproofError(
                f"'{self.linkage.name}': a load over S counts from the top dead centre, which shows in a full turn of "
                "the crank that moves the output, and the crank makes none; give the load over its angle"
            ) from error

    def where_assembled(self, function: Callable[[Sweep], Array], angle: Array) -> Array:
        """Values (n,) of a function of the linkage at φ (n,), rad or m; nan where it cannot be assembled or moved.

        ``function`` takes the sweep at these φ, whose poses are meaningless at such places, and gives the values.
        """
        faults = np.zeros(angle.shape, dtype=bool)
        with np.errstate(all="ignore"):  # of what is meaningless
            values = function(Sweep(self.linkage, self.structure, angle, faults, zero_of_s=self.zero_of_s))
        return np.where(faults, np.nan, values)

    @property
    def is_numerical(self) -> bool:
        """Whether a group is of class III or higher, so that the reference is numerical: solved by Newton's method."""
        return self.structure.is_numerical

    @cached_property
    def turn(self) -> Sweep:
        """The linkage over a turn in half-degree steps, from which extremes are refined; over its range if pushed.

        A linkage whose motion repeats after several turns only has all of these. Poses are computed when they are
        needed. Raises AssemblyError where a pushed one cannot be assembled at the sketch.
        """
        if self.linkage.is_linear:
            low, high = self.crank_range().limits
            return self.sweep(np.linspace(low, high, 724)[2:-2])  # at its limits it stands in dead positions
        return self.sweep(np.linspace(0.0, self.period, round(720 * self.period / FULL_TURN), endpoint=False))

    def crank_range(self, start: float | None = None) -> CrankRange:
        """The range of φ around a start, rad or m, the sketch's if None, with its limits; kept for each start.

        Raises AssemblyError where the linkage cannot be assembled at the start.
        """
        if start not in self._ranges:
            self._ranges[start] = crank_range(self.linkage, self.structure, self.undetermined, start)
        return self._ranges[start]

    def check_full_turn(self) -> None:
        """Raise AssemblyError where the crank cannot make a full turn or its motion is undetermined somewhere.

        A gap between two steps of the turn counts, too.
        """
        for body in self.structure.bodies:
            self.turn.poses(body)
        self.check_determined(0.0, self.period)
        reach = self.crank_range()
        reach.check(reach.start, reach.start + FULL_TURN, self.linkage.name)

    def check_determined(self, low: float, high: float) -> None:
        """Raise AssemblyError where the motion is undetermined at a crank angle from ``low`` to ``high``, rad."""
        for dyad, angle, reason in self.undetermined:
            if (angle - low) % FULL_TURN <= high - low:
                raise AssemblyError(f"'{self.linkage.name}' is undetermined at {degrees(angle)}: {dyad.words} {reason}")

    def check_rest(self, angle: float) -> None:
        """Raise AssemblyError where the crank rests, at ``angle``, rad, on a change point: two motions begin there.

        Nearer than 1e-6 rad counts as on it.
        """
        for dyad in self.structure.dyads:
            for change in dyad.changes.angles if dyad.changes else ():
                if abs((angle - change + np.pi) % FULL_TURN - np.pi) < AT_REST:
                    where = degrees(round(change, 6) % round(FULL_TURN, 6))
                    raise AssemblyError(
                        f"'{self.linkage.name}' is at rest on a change point at {where}, from which "
                        f"{dyad.words} can go on in two ways; start, turn and rest elsewhere"
                    )


Value = TypeVar("Value")


def once_per_mechanism(function: Callable[[Mechanism], Value]) -> Callable[[Mechanism], Value]:
    """A decorator of a function of a mechanism, whose value is computed once for each.

    The value, not a copy, is kept as long as the mechanism; an error is not kept.
    """
    known: WeakKeyDictionary[Mechanism, Value] = WeakKeyDictionary()

    @wraps(function)
    def value_of(mechanism: Mechanism) -> Value:
        """The value for a mechanism, computed at the first call only."""
        if mechanism not in known:
            known[mechanism] = function(mechanism)
        return known[mechanism]

    return value_of


def _with_assembly_modes(linkage: Linkage, structure: Structure, signs: Sequence[int] = ()) -> Structure:
    """The structure with each group's assembly mode nearest to the sketch, chosen group by group.

    Dyads take the ``signs``, in order, if there are any; groups of a higher class get the branch of the sketch's
    configuration. Raises AssemblyError where links do not meet at the sketch, StructureError where it leaves a mode
    open.
    """
    left = iter(signs)
    poses = driver_poses(structure, linkage.sketch_angle)
    done: list[AnyGroup] = []
    for group in structure.groups:
        if isinstance(group, ClosedGroup):
            known = replace(group, sign=next(left)) if signs else None
            done.append(known or _nearest_mode(linkage, structure, group, poses))
        else:
            done.append(_with_branch(linkage, replace(structure, groups=tuple(done)), group))
        solver = solver_of(done[-1], np.asarray(linkage.sketch_angle))
        poses.update(zip(group.links, solver.poses(poses), strict=True))
    return replace(structure, groups=tuple(done))


def _with_branch(linkage: Linkage, before: Structure, group: Group) -> Group:
    """A group of a higher class with the configuration that the sketch means, followed over φ, as its ``branch``.

    ``before`` is the structure of the groups solved before it. Raises StructureError where the sketch leaves the
    configuration open, AssemblyError where there is none or it stands in a dead position.
    """

    def hosts(angle: Array) -> Motions:
        """Motions, over φ (n,), by name, of the bodies that the group hangs on: pose, rate, acceleration.

        Every number of them is an array (n,). Raises AssemblyError where a group before it does not meet or move.
        """
        sweep = Sweep(linkage, before, angle)
        motion = {body: (sweep.poses(body), sweep.rates(body), sweep.accelerations(body)) for body in group.hosts}
        full = np.ones(angle.shape)
        return {body: tuple(tuple(p * full for p in part) for part in parts) for body, parts in motion.items()}  # type: ignore[misc]

    problem = group_problem(group, linkage, hosts)
    start = configuration_at_sketch(linkage, before, group, problem)
    return replace(group, branch=follow_branch(problem, start, linkage.sketch_angle))


def _nearest_mode(linkage: Linkage, structure: Structure, dyad: ClosedGroup, poses: dict[str, Pose]) -> ClosedGroup:
    """The dyad in the assembly mode that the sketch means; one with a single mode as it is.

    ``poses``, by name, are those of the bodies before it at the sketch. Raises StructureError if it is open,
    AssemblyError if there is none.
    """
    if not dyad.has_two_modes:
        return dyad
    modes = [replace(dyad, sign=sign) for sign in (1, -1)]
    points = {name: structure.bodies[name].points for name in dyad.links}
    places = []
    for mode in modes:
        solver = DyadSolver(mode, np.asarray(linkage.sketch_angle))
        places.append(named_places(points, solver.poses(poses)))
        check_assembly(linkage, solver, np.asarray(linkage.sketch_angle))
    nearest, telling = nearest_to_sketch(linkage, places)
    if telling is not None:
        raise StructureError(_ambiguous_sketch(linkage, dyad, telling))
    return modes[nearest]


def _ambiguous_sketch(linkage: Linkage, dyad: ClosedGroup, telling: Sequence[str]) -> str:
    """The error's sentence for a sketch that leaves a dyad's mode open.

    Names the points ``telling`` the two modes apart, which are to be added, if there are any.
    """
    if telling:
        needed, cure = f"the rough position of {' or '.join(map(repr, telling))}", "add it under [sketch.points]"
    else:
        needed = "a point that tells them apart"
        cure = "name a further point on one of them, and place it in [sketch]"
    verb = "are" if len(dyad.links) > 1 else "is"
    return (
        f"sketch of '{linkage.name}': expected {needed} at {linkage.phi.named(linkage.sketch_angle)}, got a "
        f"sketch that leaves open how {dyad.words} {verb} assembled; {cure}"
    )
