"""The signals of a linkage as one list of operations: of its crank angle, the crank's motion and numbers that vary."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from analytic.description.changes import SPEED, with_numbers
from analytic.errors import LinkproofError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.groups.solver import GroupSolver
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.machine_code.tracing import INPUT, OperationList
from analytic.moving import MovingSweep
from analytic.signals import signal

PHI, ACCELERATION = ("crank angle", "crank acceleration")  # no numbers' names
OF_DESIGN, OF_PLACE = 1, 2


class TracedSweep(Sweep):
    """A sweep of traced numbers: where its groups can move is noted in ``moves`` in place of being checked."""

    moves: Any = True

    def _check_assembly(self, solver: DyadSolver | GroupSolver) -> None:
        self.moves = solver.moves if self.moves is True else self.moves & solver.moves

    def _check_motion(self, solver: DyadSolver | GroupSolver) -> None:
        """Nothing to check: ``_check_assembly`` has recorded where the group can move."""


@dataclass(frozen=True, eq=False)
class LinkageTrace:
    """Lines of the signals of designs that differ in ``varied`` numbers, and of whether all groups needed can move.

    ``determinants`` are those of the dyads, magnitudes. Inputs of the ``trace`` are the numbers by name, ``PHI``,
    ``SPEED``, ``ACCELERATION`` and laws over φ, which are named (law, order, component).
    """

    trace: OperationList
    varied: frozenset[str]
    signals: tuple[int, ...]
    moves: int
    determinants: tuple[int, ...]

    @property
    def lines(self) -> tuple[int, ...]:
        """Those of the signals, of whether they move, and of the determinants."""
        return (*self.signals, self.moves, *self.determinants)

    def values(
        self, numbers: Mapping[str, Any], phi: ArrayLike = 0.0, speed: ArrayLike = 0.0, acceleration: ArrayLike = 0.0
    ) -> dict[int, Any]:
        """Values of the inputs by line: of the ``numbers`` that are given, and of the crank's place and motion, SI."""
        known = {**numbers, PHI: phi, SPEED: speed, ACCELERATION: acceleration}
        table: dict[int, Any] = {}
        for name, line in self.trace.inputs.items():
            if isinstance(name, tuple):
                law, order, component = name
                table[line] = law(phi, order)[component]
            elif name in known:
                table[line] = known[name]
        return table

    def borders(self, outputs: Iterable[int]) -> tuple[list[int], list[int]]:
        """The lines of a design's numbers alone, and of the crank's place alone, from which outputs follow."""
        parts = dict.fromkeys(range(len(self.trace.operations)), 0)
        for name, line in self.trace.inputs.items():
            parts[line] = OF_DESIGN if name in self.varied else OF_PLACE
        for line, operation in enumerate(self.trace.operations):
            if operation.name != INPUT:
                for other in operation.operands:
                    parts[line] |= parts[other]
        needed = self.trace.leading_to(outputs)
        mixed = [line for line in needed if parts[line] == OF_DESIGN | OF_PLACE]
        used = sorted({other for line in mixed for other in self.trace.operations[line].operands} | set(outputs))
        return [line for line in used if parts[line] == OF_DESIGN], [line for line in used if parts[line] == OF_PLACE]


def is_traceable(mechanism: Mechanism) -> bool:
    """Whether the linkage is made of dyads whose assembly modes stay: others have no straight list."""
    return not mechanism.is_numerical and not any(dyad.changes for dyad in mechanism.structure.dyads)


def linkage_trace(
    mechanism: Mechanism,
    varied: Iterable[str],
    signals: Sequence[str],
    *,
    zero: Iterable[str] = (),
    accelerates: bool = False,
    all_groups: bool = True,
) -> LinkageTrace:
    """The list of a linkage's signals, with numbers by name, or ``SPEED``, that vary or are ``zero``, others constants.

    ``signals`` are those of ``analytic.signals``, magnitudes of vectors and the output's coordinate. ``all_groups``
    takes the groups that no signal needs as well. Raises LinkproofError for a linkage that is not traceable.
    """
    if not is_traceable(mechanism):
        raise LinkproofError(f"'{mechanism.linkage.name}': expected groups of two links without change points")
    trace, varied = OperationList(), frozenset(varied)
    linkage = with_numbers(mechanism.linkage, {name: trace.input(name) for name in varied} | dict.fromkeys(zero, 0.0))
    signs = tuple(dyad.sign for dyad in mechanism.structure.dyads)
    sweep = TracedSweep(linkage, find_structure(linkage).with_signs(signs), trace.input(PHI))  # type: ignore[arg-type]
    at = MovingSweep(mechanism, sweep, trace.input(SPEED), trace.input(ACCELERATION) if accelerates else 0.0)  # type: ignore[arg-type]
    lines = tuple(trace.line(signal(at, name)) for name in signals)
    dyads = sweep.structure.dyads if all_groups else ()
    determinants = tuple(trace.line(abs(sweep.determinant(dyad))) for dyad in dyads)
    return LinkageTrace(trace, varied, lines, trace.line(sweep.moves), determinants)
