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
from analytic.description.linkage import Linkage
from analytic.dynamics.derivative_orders import Needs, needs
from analytic.errors import LinkproofError, UnknownNameError
from analytic.evaluation import PER_ANGLE, PIECE, QUANTITIES, moving_sweep
from analytic.kinematics.change_points import through_change_points
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Structure
from analytic.kinematics.sweep import Sweep
from analytic.numerics.where_assembled import where_assembled
from analytic.request import EvaluationRequest, evaluation_request

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Outcome = tuple[Array, Booleans]

ASSEMBLED: Final = "assembled"
# Crank angles that cost NumPy as much as a design may: building one takes 0.26 ms, but one that cannot be assembled at
# some angles is halved down to single angles, 30 to 60 ms measured on the six-bar.
ANGLES_OF_A_DESIGN: Final = 200_000


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
    the number of threads of the compiled path, all of the machine's if None; ``path`` is as for
    ``analytic.evaluation.evaluate``.
    """
    request = evaluation_request(angle, quantities, speed, acceleration)
    if len(request.shape) != 1 or not np.all(np.isfinite(request.angle)):
        raise LinkproofError(
            "angle: expected a flat list of finite crank angles in rad, got "
            f"{'nan or infinity' if len(request.shape) == 1 else f'shape {request.shape}'}; pass such a list"
        )
    flat = flatten(mechanism)
    designs = _designs(flat, parameters)
    largest = redesigned(flat, designs.largest())
    angles = request.angle.size + ANGLES_OF_A_DESIGN
    if not mechanism.changes and is_compiled(
        path, "evaluation", PER_ANGLE * designs.count * angles * len(flat.structure.bodies)
    ):
        values, moving = compute(flat, request, largest, count=designs.count, designs=designs.rows, cores=cores)
    else:
        values, moving = _plain(mechanism, flat, request, needs(largest, request.names, turns=request.turns), designs)
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


def _designs(flat: FlatLinkage, parameters: Mapping[str, ArrayLike]) -> Designs:
    """The designs, checked."""
    for name in parameters:
        if name not in flat.places:
            raise UnknownNameError(f"parameter of '{flat.linkage.name}'", name, flat.places)
    arrays = {name: np.asarray(values, dtype=float) for name, values in parameters.items()}
    shapes = {values.shape for values in arrays.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1 or next(iter(shapes)) == (0,):
        raise LinkproofError(
            "parameters: expected one or more flat arrays of one length, a value per design, got "
            f"{', '.join(f'{name} of shape {values.shape}' for name, values in arrays.items()) or 'none'}; "
            "give every parameter a value per design"
        )
    for name, values in arrays.items():
        _check(name, values)
    places = np.array([flat.places[name] for name in arrays], dtype=np.int64)
    designs = Designs(flat.numbers, places, np.stack(list(arrays.values()), axis=1))
    _check_directions(flat, designs)
    return designs


def _check(name: str, values: Array) -> None:
    """Finite numbers, and no negative masses."""
    wrong = ~np.isfinite(values)
    kind = "finite numbers"
    if name.endswith((".mass", ".inertia")):
        wrong |= values < 0.0
        kind = "finite numbers, none negative"
    if np.any(wrong):
        first = int(np.argmax(wrong))
        raise LinkproofError(f"{name}: expected {kind}, got {values[first]:g} in design {first}; correct it")


def _check_directions(flat: FlatLinkage, designs: Designs) -> None:
    """A direction needs a length."""
    names = {place: name for name, place in flat.places.items()}
    for start in flat.directions:
        columns = [np.flatnonzero(designs.places == at) for at in (start, start + 1)]
        parts = [
            designs.values[:, column[0]] if len(column) else designs.numbers[at]
            for at, column in zip((start, start + 1), columns, strict=True)
        ]
        zero = np.broadcast_to(np.hypot(*parts) == 0.0, designs.count)
        if np.any(zero):
            name, first = names[start].removesuffix(".x"), int(np.argmax(zero))
            raise LinkproofError(f"{name}: expected a direction, got (0, 0) in design {first}; correct it")


def _plain(
    mechanism: Mechanism, flat: FlatLinkage, request: EvaluationRequest, needed: Needs, designs: Designs
) -> Outcome:
    """Design by design with NumPy."""
    values = np.full((len(request.names), designs.count, request.angle.size), np.nan)
    moving = np.zeros((designs.count, request.angle.size), dtype=np.bool_)
    signs = tuple(dyad.sign for dyad in flat.structure.dyads)
    follows = any(dyad.changes for dyad in flat.structure.dyads)
    for number in range(designs.count):
        linkage = redesigned(flat, designs.rows(number, number + 1)[0])
        structure = find_structure(linkage).with_signs(signs)
        if follows:
            structure, _ = through_change_points(structure, linkage.sketch_angle)

        def at(here: Integers, linkage: Linkage = linkage, structure: Structure = structure) -> Array:
            return _piece(mechanism, Sweep(linkage, structure, request.angle[here]), request, needed, here)

        for start in range(0, request.angle.size, PIECE):
            here = np.arange(start, min(start + PIECE, request.angle.size))
            rows = where_assembled(at, here, (len(values) + 1,))
            values[:, number, here], moving[number, here] = rows[:-1], rows[-1] == 1.0
    return values, moving


def _piece(mechanism: Mechanism, sweep: Sweep, request: EvaluationRequest, needed: Needs, here: Integers) -> Array:
    """Quantities at some of the crank angles, and a row of ones; raises AssemblyError if any of them has no motion."""
    for body, order in needed.orders.items():
        (sweep.poses, sweep.rates, sweep.accelerations)[order](body)
    at = moving_sweep(mechanism, sweep, request, here)
    return np.array([*(QUANTITIES[name](at) for name in request.names), np.ones(here.shape)])
