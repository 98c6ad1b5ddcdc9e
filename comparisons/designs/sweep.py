"""Figures over a space of designs, block by block; only a summary stays in memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import SPEED, with_numbers
from analytic.description.linkage import Linkage
from analytic.designs.figures import STROKE
from analytic.designs.results import usual_path
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import names
from comparisons.designs.parameters import NamedFigure, SteadyMotion, named_figures
from comparisons.designs.space import DesignSpace
from comparisons.runs.run_engine import Lost
from comparisons.runs.workers import Bounds, Pool

Array = NDArray[np.float64]

USUAL: Final = ("Mkr.peak", "joint_force.peak", "transmission_angle.min")
PLACES: Final = 8_000_000  # designs times crank angles of a block: half a second of a core, or so
LARGEST: Final = 200_000  # designs of a block, of which a few arrays are in memory
REFINED: Final = 10  # cost of a refined figure over that of a sampled figure
BOUNDS: Final = Bounds(seconds=math.inf)
NO_DESIGN: Final = -1  # the number of no design


@dataclass(frozen=True)
class SweepRequest:
    """Which figures of which designs of a linkage, and under which motion.

    ``cores`` and ``path`` are as for ``design_figures``; the paths differ by rounding, so that one does all blocks.
    """

    linkage: Linkage
    space: DesignSpace
    figures: tuple[NamedFigure, ...]
    motion: SteadyMotion
    refine: bool = False
    cores: int | None = None
    path: str = "auto"

    def with_fixed_path(self) -> SweepRequest:
        """The request with one path of computation for all blocks, chosen by its size."""
        size = self.space.count * len(self.motion.places)
        return replace(self, path=usual_path([figure.figure for figure in self.figures], size))

    @property
    def numbers_of_file(self) -> dict[str, float]:
        """Numbers of the linkage's file, SI, by parameter; the speed is the motion's."""
        return {
            parameter.name: abs(self.motion.speed) if parameter.kind == SPEED else parameter.value
            for parameter in self.space.parameters
        }

    @cached_property
    def blocks(self) -> range:
        """The first designs of the pieces in which the space is worked through, the same wherever they are."""
        cost = len(self.motion.places) * (REFINED if self.refine else 1)
        return range(0, self.space.count, min(max(1, PLACES // cost), LARGEST))

    def block(self, number: int) -> tuple[int, int]:
        """The first and the last + 1 of the designs of a piece."""
        first = self.blocks[number]
        return first, min(first + self.blocks.step, self.space.count)


class RankedDesign(NamedTuple):
    """The first design that has a value; the one with the smaller ``rank`` is the least, or the largest."""

    rank: float = math.inf
    design: int = NO_DESIGN
    value: float = math.nan


@dataclass
class Summary:
    """Summary of so many ``designs``: how many assemble, the ends of their figures and of their parameters.

    ``least`` and ``largest`` have an extreme per figure, ``reach`` (parameters, 2) the least and the largest value of a
    parameter among the designs that assemble, in the file's units; nan where none does.
    """

    request: SweepRequest
    designs: int = 0
    assembled: int = 0
    least: list[RankedDesign] = field(init=False)
    largest: list[RankedDesign] = field(init=False)
    reach: Array = field(init=False)

    def __post_init__(self) -> None:
        self.least, self.largest = ([RankedDesign()] * len(self.request.figures) for _ in range(2))
        self.reach = np.full((len(self.request.space.parameters), 2), np.nan)

    @property
    def extremes(self) -> set[int]:
        """The designs with the least and the largest figures."""
        return {design.design for design in (*self.least, *self.largest)} - {NO_DESIGN}

    def add(self, first: int, figures: Array) -> None:
        """Count in the figures (figures, designs) of the designs from number ``first`` on; blocks come in any order."""
        assembles = ~np.all(np.isnan(figures), axis=0)
        self.designs += len(assembles)
        self.assembled += int(np.count_nonzero(assembles))
        if not np.any(assembles):
            return
        shown = self.request.space.file_values(first, first + len(assembles))[:, assembles]
        self.reach[:, 0] = np.fmin(self.reach[:, 0], np.min(shown, axis=1))
        self.reach[:, 1] = np.fmax(self.reach[:, 1], np.max(shown, axis=1))
        for row, values in enumerate(figures):
            for ends, signed in ((self.least, values), (self.largest, -values)):
                at = int(np.argmin(np.where(np.isfinite(values), signed, np.inf)))
                if np.isfinite(values[at]):
                    ends[row] = min(ends[row], RankedDesign(float(signed[at]), first + at, float(values[at])))


def usual_figures(mechanism: Mechanism) -> tuple[NamedFigure, ...]:
    """The figures where nobody names any: peaks of torque, forces and transmission angles, and the stroke."""
    signals = names(mechanism)
    usual = [name for name in USUAL if any(key.partition(":")[0] == name.partition(".")[0] for key in signals)]
    return named_figures(mechanism, [*usual, *([STROKE] if "S" in signals else [])])


def sweep_block(request: SweepRequest, first: int, last: int) -> Array:
    """Figures of the designs from number ``first`` up to ``last``, (figures, designs), in the units of the file."""
    return _compute_figures(request, request.space.block(first, last))


def _compute_figures(request: SweepRequest, numbers: dict[str, Array]) -> Array:
    """Figures (figures, designs) of numbers (designs,), SI, by name, in the units of the file."""
    figures = [figure.figure for figure in request.figures]
    values = request.motion.figures(
        Mechanism(request.linkage), numbers, figures, refine=request.refine, cores=request.cores, path=request.path
    )
    return np.asarray(values / np.array([figure.unit.size for figure in request.figures])[:, None])


def figures_of_file(request: SweepRequest) -> Array:
    """Figures (figures,) of the linkage as its file has it, in its units; nan where it cannot make the motion.

    Raises LinkproofError where the space has values that no design can.
    """
    for parameter, (least, most) in zip(request.space.parameters, request.space.ends, strict=True):
        if parameter.kind == SPEED and least <= 0.0 <= most:
            raise LinkproofError(
                f"{parameter.name}: expected speeds on one side of 0, got {least:g} to {most:g}; correct it"
            )
        if parameter.kind in ("mass", "inertia") and least < 0.0:
            raise LinkproofError(
                f"{parameter.name}: expected no negative {parameter.kind}, got {least:g} {parameter.unit.name}; "
                "correct the range"
            )
    design = {name: np.array([value]) for name, value in request.numbers_of_file.items()}
    return _compute_figures(replace(request, path="numpy"), design)[:, 0]


def sweep(
    request: SweepRequest,
    *,
    keep: Callable[[int, Array], object] = lambda *_: None,
    done: Collection[int] = (),
    begun: Summary | None = None,
    announce: Callable[[int], object] = lambda _: None,
    pool: Pool | None = None,
) -> Summary:
    """Work a space through; ``keep`` is handed the number and the figures of every block.

    Blocks that are ``done`` are not made again, and ``begun`` is their summary. ``announce`` hears how many designs are
    finished. Blocks are made here, in turn, or by a ``pool``, which is sent what it needs.
    """
    total = begun or Summary(request)
    todo = [number for number in range(len(request.blocks)) if number not in done]
    for number, values in _finished_blocks(request, todo, pool):
        keep(number, values)
        total.add(request.blocks[number], values)
        announce(total.designs)
    return total


def _finished_blocks(request: SweepRequest, todo: Sequence[int], pool: Pool | None) -> Iterator[tuple[int, Array]]:
    """Number and figures of every block as it is finished, here or in a pool."""
    if pool is None:
        for number in todo:
            yield number, sweep_block(request, *request.block(number))
        return
    for place, result in pool.run(sweep_block, _BlockJobs(request, todo), BOUNDS):
        if isinstance(result, Lost):
            first, last = request.block(todo[place])
            raise LinkproofError(f"designs {first} to {last - 1}: expected their figures, got none: {result.reason}")
        yield todo[place], result


@dataclass(frozen=True)
class _BlockJobs(Sequence[tuple[Any, ...]]):
    """The arguments of each block's job, made when the job is sent."""

    request: SweepRequest
    todo: Sequence[int]

    def __len__(self) -> int:
        return len(self.todo)

    def __getitem__(self, place: Any) -> Any:  # noqa: ANN401 - a sequence's own types are two
        first, last = self.request.block(self.todo[place])
        return replace(self.request, space=self.request.space.subset(first, last)), first, last


def reason_not_assembled(request: SweepRequest) -> str:
    """Why the first design cannot be assembled through all of the motion, in a sentence; "" where it can."""
    mechanism = Mechanism(request.linkage)
    first = request.space.block(0, 1)
    design = {name: float(values[0]) for name, values in first.items()}
    try:
        moved = mechanism.redesigned(with_numbers(mechanism.linkage, design)).sweep(request.motion.places)
        for body in mechanism.structure.bodies:
            moved.rates(body)
    except AssemblyError as error:
        return str(error)
    stands = np.all(np.isnan(_compute_figures(replace(request, path="numpy"), first)))
    return f"'{mechanism.linkage.name}' stands in a dead position between two of the crank angles" if stands else ""
