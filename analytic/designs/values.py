"""Quantities of many designs of one linkage at once: arrays of parameters times crank angles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.compiled.choice import is_compiled
from analytic.compiled.evaluation import compute
from analytic.compiled.flat_linkage import FlatLinkage, Integers, flatten, redesigned
from analytic.designs.batches import BLOCK, Sweeps, faults_of, in_blocks
from analytic.designs.checking import checked
from analytic.dynamics.derivative_orders import Needs, needs
from analytic.errors import LinkproofError
from analytic.evaluation import PER_ANGLE, QUANTITIES, moving_sweep
from analytic.kinematics.mechanism import Mechanism
from analytic.request import EvaluationRequest, evaluation_request

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Outcome = tuple[Array, Booleans]

ASSEMBLED: Final = "assembled"


def evaluate_designs(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    angle: ArrayLike,
    quantities: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    cores: int | None = None,
    path: str = "auto",
) -> dict[str, NDArray[Any]]:
    """Quantities of ``analytic.evaluation.QUANTITIES`` by name for every design and crank angle, (designs, angles).

    ``parameters`` are arrays (designs,) by the names of ``analytic.compiled.flat_linkage.FlatLinkage.places``, in SI
    units; all else is as in the linkage's description, and the assembly modes are those that its sketch picks.
    ``angle`` (angles,) is in rad; ``speed`` (rad/s) and ``acceleration`` (rad/s²) are scalar or one per angle.

    Where a design cannot be assembled or stands in a dead position its values are nan, and False in ``assembled``,
    which is returned besides; that counts for every link that the quantities need in any of the designs. ``cores`` is
    the number of threads, all of the machine's if None; ``path`` is as for
    ``analytic.evaluation.evaluate``.
    """
    request = evaluation_request(angle, quantities, speed, acceleration)
    if len(request.shape) != 1 or not np.all(np.isfinite(request.angle)):
        raise LinkproofError(
            "angle: expected a flat list of finite crank angles in rad, got "
            f"{'nan or infinity' if len(request.shape) == 1 else f'shape {request.shape}'}; pass such a list"
        )
    flat = flatten(mechanism)
    arrays = checked(mechanism.linkage, parameters, flat.places)
    designs = designs_of(flat, arrays)
    largest = redesigned(flat, designs.largest())
    seconds = PER_ANGLE * designs.count * request.angle.size * len(flat.structure.bodies)
    if not mechanism.changes and is_compiled(path, "evaluation", seconds):
        values, moving = compute(flat, request, largest, count=designs.count, designs=designs.rows, cores=cores)
    else:
        needed = needs(largest, request.names, turns=request.turns, accelerates=request.accelerates)
        values, moving = _plain(mechanism, arrays, request, needed, cores)
    return {**dict(zip(request.names, values, strict=True)), ASSEMBLED: moving}


@dataclass(frozen=True)
class Designs:
    """Vectors of numbers that differ in some ``places`` only, by ``values`` (count, places)."""

    numbers: Array
    places: NDArray[np.int64]
    values: Array

    @property
    def count(self) -> int:
        """How many."""
        return len(self.values)

    def rows(self, first: int, last: int) -> Array:
        """The vectors from one to before another, (last - first, numbers)."""
        rows = np.tile(self.numbers, (last - first, 1))
        rows[:, self.places] = self.values[first:last]
        return rows

    def largest(self) -> Array:
        """A vector that is zero only where it is zero in every design."""
        numbers = self.numbers.copy()
        rows = np.argmax(np.abs(self.values), axis=0)
        numbers[self.places] = self.values[rows, np.arange(len(self.places))]
        return numbers


def designs_of(flat: FlatLinkage, arrays: Mapping[str, Array]) -> Designs:
    """Designs by arrays (designs,) of numbers that have a place."""
    places = np.array([flat.places[name] for name in arrays], dtype=np.int64)
    return Designs(flat.numbers, places, np.stack(list(arrays.values()), axis=1))


def _plain(
    mechanism: Mechanism,
    arrays: Mapping[str, Array],
    request: EvaluationRequest,
    needed: Needs,
    cores: int | None,
) -> Outcome:
    """Block by block with NumPy."""
    count = len(next(iter(arrays.values())))
    values = np.full((len(request.names), count, request.angle.size), np.nan)
    moving = np.zeros(values.shape[1:], dtype=np.bool_)
    angles = [slice(start, start + BLOCK) for start in range(0, request.angle.size, BLOCK)]

    def work(rows: Integers, sweeps: Sweeps) -> None:
        for here in angles:
            phi = request.angle[here]
            sweep = sweeps(rows, np.broadcast_to(phi, (len(rows), len(phi))))
            for body, order in needed.orders.items():
                (sweep.poses, sweep.rates, sweep.accelerations)[order](body)
            own = moving[rows[0] : rows[-1] + 1, here] = ~faults_of(sweep)
            at = moving_sweep(mechanism, sweep, request, here)
            for row, name in zip(values, request.names, strict=True):
                row[rows[0] : rows[-1] + 1, here] = np.where(own, QUANTITIES[name](at), np.nan)

    in_blocks(mechanism, arrays, max(1, BLOCK // max(1, request.angle.size)), work, cores)
    return values, moving
