"""Figures over a space of designs, block by block: nothing but a summary is kept of what has been handed on."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import with_numbers
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.designs.results import design_figures, usual_path
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import names
from comparisons.designs.named_figures import STROKE, NamedFigure, named_figures
from comparisons.designs.steady_motion import SteadyMotion
from comparisons.designs.sweep.space import DesignSpace
from comparisons.runs.failures import Lost
from comparisons.runs.workers import Bounds, Pool

Array = NDArray[np.float64]
Entry = TypeVar("Entry")

USUAL: Final = ("Mkr.peak", "joint_force.peak", "transmission_angle.min")
PLACES: Final = 8_000_000  # designs times crank angles of a block: half a second of a core, or so
LARGEST: Final = 200_000  # designs of a block, of which a few arrays are held
REFINED: Final = 10  # what a figure costs that is refined, in figures that are not
BOUNDS: Final = Bounds(seconds=math.inf)
NONE: Final = -1  # the number of no design


@dataclass(frozen=True)
class Blocks(Sequence[tuple[int, int]]):
    """Ranges of designs (first, last + 1), about ``size`` each: several whole slabs, or parts of one."""

    designs: int
    slab: int
    size: int

    @property
    def _whole(self) -> int:
        return max(1, self.size // self.slab) * self.slab

    @property
    def _parts(self) -> int:
        return max(1, -(-self.slab // self.size))

    def __len__(self) -> int:
        return -(-self.designs // self._whole) * self._parts

    def __getitem__(self, number: Any) -> Any:  # noqa: ANN401 - a sequence's own types are two
        """The range of a block by its number."""
        if not 0 <= number < len(self):
            raise IndexError(number)
        whole, part = divmod(number, self._parts)
        first = whole * self._whole + part * self.size
        return first, min(
            first + (self._whole if self._parts == 1 else self.size), (whole + 1) * self._whole, self.designs
        )


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

    def on_one_path(self) -> SweepRequest:
        """The same on the path that its size calls for."""
        size = self.space.count * len(self.motion.places)
        return replace(self, path=usual_path([one.figure for one in self.figures], size, self.cores))

    @cached_property
    def blocks(self) -> Blocks:
        """The pieces in which the space is worked through, the same wherever they are."""
        cost = len(self.motion.places) * (REFINED if self.refine else 1)
        return Blocks(self.space.count, self.space.slab, min(max(1, PLACES // cost), LARGEST))


class RankedDesign(NamedTuple):
    """The first design that has a value; the one with the smaller ``rank`` is the least, or the largest."""

    rank: float = math.inf
    design: int = NONE
    value: float = math.nan


@dataclass(frozen=True)
class Summary:
    """What is known of so many ``designs``: how many assemble, the ends of their figures and of their parameters.

    ``least`` and ``largest`` have an extreme per figure, ``reach`` the least and largest value per parameter, file's
    units; nothing where no design assembles.
    """

    designs: int = 0
    assembled: int = 0
    least: tuple[RankedDesign, ...] = ()
    largest: tuple[RankedDesign, ...] = ()
    reach: tuple[tuple[float, float], ...] = ()

    def plus(self, other: Summary) -> Summary:
        """Both together, in either order."""
        return Summary(
            self.designs + other.designs,
            self.assembled + other.assembled,
            _merged(min, self.least, other.least),
            _merged(min, self.largest, other.largest),
            _merged(lambda a, b: (min(a[0], b[0]), max(a[1], b[1])), self.reach, other.reach),
        )

    def encoded(self) -> bytes:
        """The summary as JSON."""
        return json.dumps(asdict(self)).encode()

    @staticmethod
    def decoded(text: bytes) -> Summary:
        """The summary of ``encoded``."""
        told = json.loads(text)
        extremes = {end: tuple(RankedDesign(*one) for one in told[end]) for end in ("least", "largest")}
        return Summary(told["designs"], told["assembled"], **extremes, reach=tuple(map(tuple, told["reach"])))


def _merged(
    how: Callable[[Entry, Entry], Entry], first: tuple[Entry, ...], second: tuple[Entry, ...]
) -> tuple[Entry, ...]:
    """Both, entry by entry; one of them where the other is empty."""
    return tuple(map(how, first, second)) if first and second else first or second


def usual_figures(mechanism: Mechanism) -> tuple[NamedFigure, ...]:
    """What is asked of designs where nobody says: peaks of torque, forces and transmission angles, and the stroke."""
    there = names(mechanism)
    asked = [name for name in USUAL if any(one.partition(":")[0] == name.partition(".")[0] for one in there)]
    return named_figures(mechanism, [*asked, *([STROKE] if "S" in there else [])])


def sweep_block(request: SweepRequest, first: int, last: int) -> Array:
    """Figures of the designs from number ``first`` up to ``last``, (figures, designs), in the units of the file."""
    return _figures(request, request.space.block(first, last))


def _figures(request: SweepRequest, numbers: dict[str, Array]) -> Array:
    motion = request.motion
    found = design_figures(
        Mechanism(request.linkage), numbers, [one.figure for one in request.figures], motion.places,
        speed=motion.speed, refine=request.refine, cores=request.cores,
        period=FULL_TURN if motion.is_full_turn else None, path=request.path,
    )  # fmt: skip
    return np.asarray(found / np.array([one.unit.size for one in request.figures])[:, None])


def own_figures(request: SweepRequest) -> Array:
    """The figures (figures,) of the file's own design, nan where it cannot move through all of the motion.

    Raises LinkproofError where the space has values that no design can.
    """
    for one, (least, _) in zip(request.space.parameters, request.space.ends, strict=True):
        if one.kind in ("mass", "inertia") and least < 0.0:
            raise LinkproofError(f"{one.name}: expected no negative {one.kind}, got {least:g} {one.unit.name}; "
                                 "correct the range")  # fmt: skip
    return _figures(
        replace(request, path="numpy"), {one.name: np.array([one.value]) for one in request.space.parameters}
    )[:, 0]


def sweep(
    request: SweepRequest,
    *,
    keep: Callable[[int, int, Array, Summary], object] = lambda *_: None,
    done: Collection[int] = (),
    begun: Summary | None = None,
    announce: Callable[[int], object] = lambda _: None,
    pool: Pool | None = None,
) -> Summary:
    """Work a space through; ``keep`` is handed every block's number, first design, figures and summary.

    Blocks that are ``done`` are not made again, and ``begun`` is their summary. ``announce`` hears how many designs are
    finished. Blocks are made here, in turn, or by a ``pool``, which is sent what it needs.
    """
    total = begun or Summary()
    todo = [number for number in range(len(request.blocks)) if number not in done]
    for number, found in _made(request, todo, pool):
        first, last = request.blocks[number]
        summary = _summary(request, first, last, found)
        keep(number, first, found, summary)
        total = total.plus(summary)
        announce(total.designs)
    return total


def _made(request: SweepRequest, todo: Sequence[int], pool: Pool | None) -> Iterator[tuple[int, Array]]:
    if pool is None:
        for number in todo:
            yield number, sweep_block(request, *request.blocks[number])
        return
    for place, found in pool.run(sweep_block, _Jobs(request, todo), BOUNDS):
        if isinstance(found, Lost):
            first, last = request.blocks[todo[place]]
            raise LinkproofError(f"designs {first} to {last - 1}: expected their figures, got none: {found.reason}")
        yield todo[place], found


@dataclass(frozen=True)
class _Jobs(Sequence[tuple[Any, ...]]):
    """What is sent for each block, made when it is sent."""

    request: SweepRequest
    todo: Sequence[int]

    def __len__(self) -> int:
        return len(self.todo)

    def __getitem__(self, place: Any) -> Any:  # noqa: ANN401 - a sequence's own types are two
        first, last = self.request.blocks[self.todo[place]]
        return replace(self.request, space=self.request.space.part(first, last)), first, last


def _summary(request: SweepRequest, first: int, last: int, found: Array) -> Summary:
    finite = np.isfinite(found)
    there = ~np.all(np.isnan(found), axis=0)
    if not np.any(there):
        return Summary(last - first)
    shown = request.space.shown(first, last)[:, there]
    reach = zip(np.min(shown, axis=1).tolist(), np.max(shown, axis=1).tolist(), strict=True)
    ends = []
    for signed in (found, -found):
        places = np.argmin(np.where(finite, signed, np.inf), axis=1).tolist()
        ends.append(tuple(
            RankedDesign(float(signed[row, at]), first + at, float(found[row, at]))
            if finite[row, at] else RankedDesign()
            for row, at in enumerate(places)
        ))  # fmt: skip
    return Summary(last - first, int(np.count_nonzero(there)), ends[0], ends[1], tuple(reach))


def why_not(request: SweepRequest) -> str:
    """Why the first design cannot be assembled through all of the motion, in a sentence; "" where it can."""
    mechanism = Mechanism(request.linkage)
    first = request.space.block(0, 1)
    own = {name: float(values[0]) for name, values in first.items()}
    try:
        moved = mechanism.redesigned(with_numbers(mechanism.linkage, own)).sweep(request.motion.places)
        for body in mechanism.structure.bodies:
            moved.rates(body)
    except AssemblyError as error:
        return str(error)
    stands = np.all(np.isnan(_figures(replace(request, path="numpy"), first)))
    return f"'{mechanism.linkage.name}' stands in a dead position between two of the crank angles" if stands else ""
