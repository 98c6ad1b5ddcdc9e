"""Figures over a space of designs, and which designs have the least and the largest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

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
from comparisons.designs.space import ONE_BY_ONE, DesignSpace

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

USUAL: Final = ("Mkr.peak", "joint_force.peak", "transmission_angle.min")
PLACES: Final = 8_000_000  # designs times crank angles of a block: half a second of a core, or so
LARGEST: Final = 200_000  # designs of a block, of which a few arrays are in memory
REFINED: Final = 10  # cost of a refined figure over that of a sampled figure


@dataclass(frozen=True)
class SweepRequest:
    """Which figures of which designs of a linkage, and under which motion, described by ``conditions``.

    ``path`` is as for ``design_figures``; the paths differ by rounding, so that one does all blocks.
    """

    linkage: Linkage
    space: DesignSpace
    figures: tuple[NamedFigure, ...]
    motion: SteadyMotion
    refine: bool = False
    conditions: str = ""
    path: str = "auto"

    @property
    def numbers_of_file(self) -> dict[str, float]:
        """Numbers of the linkage's file, SI, by parameter; the speed is the motion's."""
        return {
            parameter.name: abs(self.motion.speed) if parameter.kind == SPEED else parameter.value
            for parameter in self.space.parameters
        }


@dataclass(frozen=True)
class SweepStudy:
    """The figures of all designs, ``values`` (figures, designs), and the ``own`` (figures,) of the linkage's file.

    They are in the units of the file, and nan where a design does not assemble.
    """

    request: SweepRequest
    own: Array
    values: Array

    @cached_property
    def assembles(self) -> NDArray[np.bool_]:
        """Which designs assemble at every angle, (designs,)."""
        return np.asarray(~np.all(np.isnan(self.values), axis=0))

    @property
    def reach(self) -> Array:
        """Least and largest value of each parameter among the designs that assemble, (parameters, 2)."""
        shown = self.request.space.file_values(0, len(self.assembles))[:, self.assembles]
        return np.stack([np.min(shown, axis=1), np.max(shown, axis=1)], axis=1)

    def extreme(self, figure: int, way: float) -> int | None:
        """The number of the first design with the largest of a figure, or with ``way`` -1 the least; None without."""
        heights = np.where(np.isfinite(self.values[figure]), way * self.values[figure], -np.inf)
        place = int(np.argmax(heights))
        return place if np.isfinite(heights[place]) else None

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """All designs with names and units."""
        space = self.request.space
        columns = dict(zip((parameter.name for parameter in space.parameters), space.columns, strict=True))
        return labelled_dataset(self.request, columns, self.values.reshape(-1, *space.shape))


def usual_figures(mechanism: Mechanism) -> tuple[NamedFigure, ...]:
    """The figures where nobody names any: peaks of torque, forces and transmission angles, and the stroke."""
    signals = names(mechanism)
    usual = [name for name in USUAL if any(key.partition(":")[0] == name.partition(".")[0] for key in signals)]
    return named_figures(mechanism, [*usual, *([STROKE] if "S" in signals else [])])


def sweep(request: SweepRequest, announce: Callable[[str, int, int], object] = lambda *_: None) -> SweepStudy:
    """Compute the figures of a space, block by block; ``announce`` hears how many designs are finished.

    Raises LinkproofError where the space has values that no design can.
    """
    own, count = figures_of_file(request), request.space.count
    cost = len(request.motion.places) * (REFINED if request.refine else 1)
    size = min(max(1, PLACES // cost), LARGEST)
    path = usual_path([figure.figure for figure in request.figures], count * len(request.motion.places))
    values = np.empty((len(request.figures), count))
    for first in range(0, count, size):
        last = min(first + size, count)
        values[:, first:last] = sweep_block(replace(request, path=path), first, last)
        announce("designs", last, count)
    return SweepStudy(request, own, values)


def sweep_block(request: SweepRequest, first: int, last: int) -> Array:
    """Figures of the designs from number ``first`` up to ``last``, (figures, designs), in the units of the file."""
    return _compute_figures(request, request.space.block(first, last))


def _compute_figures(request: SweepRequest, numbers: dict[str, Array]) -> Array:
    """Figures (figures, designs) of numbers (designs,), SI, by name, in the units of the file."""
    figures = [figure.figure for figure in request.figures]
    values = request.motion.figures(
        Mechanism(request.linkage), numbers, figures, refine=request.refine, path=request.path
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


def labelled_dataset(request: SweepRequest, values: Mapping[str, Any], figures: Any) -> xarray.Dataset:  # noqa: ANN401
    """``values`` of the parameters and ``figures`` (figures, *shape), arrays of any kind, with names and units."""
    import xarray  # noqa: PLC0415 - half a second that a sweep without files does not pay

    over = request.space.dimensions
    units = {parameter.name: {"units": parameter.unit.name} for parameter in request.space.parameters}
    return xarray.Dataset(
        {
            figure.name: (over, row, {"units": figure.unit.name})
            for figure, row in zip(request.figures, figures, strict=True)
        },
        coords={name: (name if name in over else ONE_BY_ONE, entry, units[name]) for name, entry in values.items()},
        attrs={
            "mechanism": request.linkage.name,
            "variant": request.linkage.variant,
            "conditions": request.conditions,
            "angles": len(request.motion.places),
            "refined": int(request.refine),
        },
    )
