"""Quantities by name over many crank angles: only what is asked for is computed, in pieces that stay in the cache."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic import dynamics
from analytic.errors import LinkproofError, UnknownNameError
from analytic.mechanism import Mechanism
from analytic.sweep import Sweep

Array = NDArray[np.float64]

# Crank angles per piece. Measured on the needle mechanisms: from 4096 to 16384 the cost per angle is the same within a
# tenth; shorter pieces pay NumPy's cost per call (1024: twice), longer ones leave the cache (100 000 at once: twice).
PIECE: Final = 6144


@dataclass(frozen=True)
class Instants:
    """A piece of the crank angles with the crank's speed, rad/s, and acceleration, rad/s², at each."""

    sweep: Sweep
    speed: Array
    acceleration: Array

    @cached_property
    def inertia(self) -> Array:
        """Jeq, which Teq and Mkr need as well."""
        return dynamics.reduced_inertia(self.sweep)

    @cached_property
    def torque(self) -> Array:
        """Mkr, which Peq needs as well."""
        return dynamics.balance(self.sweep, self.inertia, self.speed, self.acceleration)

    @cached_property
    def squared_speed(self) -> Array:
        """ω²."""
        return self.speed * self.speed


# S, v and a are the output's coordinate along its direction and its time derivatives, not counted from a dead centre.
QUANTITIES: Final[Mapping[str, Callable[[Instants], Array]]] = {
    "Jeq": lambda at: at.inertia,
    "half_slope": lambda at: dynamics.half_inertia_slope(at.sweep),
    "Q": lambda at: dynamics.generalised_force(at.sweep),
    "Mkr": lambda at: at.torque,
    "Teq": lambda at: 0.5 * at.inertia * at.squared_speed,
    "Peq": lambda at: at.torque * at.speed,
    "S": lambda at: at.sweep.output(),
    "v": lambda at: at.sweep.output(1) * at.speed,
    "a": lambda at: at.sweep.output(2) * at.squared_speed + at.sweep.output(1) * at.acceleration,
}
"""What can be asked for: Jeq kg m², half_slope ½Jeq' kg m², Q N m, Mkr N m, Teq J, Peq W, S m, v m/s, a m/s²."""

MOVING: Final = frozenset({"Mkr", "Teq", "Peq", "v", "a"})  # those that depend on how the crank moves


def evaluate(
    mechanism: Mechanism,
    angle: ArrayLike,
    quantities: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
) -> dict[str, Array]:
    """Quantities of ``QUANTITIES`` by name at every crank angle (rad, any shape); arrays of that shape.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank are signed, scalar or of the angles' shape; the speed
    is needed by whatever depends on the crank's motion.
    """
    names = tuple(dict.fromkeys(quantities))
    for name in names:
        if name not in QUANTITIES:
            raise UnknownNameError("quantity", name, QUANTITIES)
    if speed is None and MOVING.intersection(names):
        needing = ", ".join(name for name in names if name in MOVING)
        raise LinkproofError(f"speed: expected the crank's speed in rad/s for {needing}, got none; pass speed=...")
    angle = np.asarray(angle, dtype=float)
    flat = angle.ravel()
    moves = [_like(angle, 0.0 if speed is None else speed, "speed"), _like(angle, acceleration, "acceleration")]
    found = {name: np.empty(flat.shape) for name in names}
    for start in range(0, flat.size, PIECE):
        here = slice(start, start + PIECE)
        at = Instants(mechanism.sweep(flat[here]), *(move[here] if move.ndim else move for move in moves))
        for name in names:
            found[name][here] = QUANTITIES[name](at)
    return {name: values.reshape(angle.shape) for name, values in found.items()}


def _like(angle: Array, value: ArrayLike, name: str) -> Array:
    """A scalar as it is, an array flattened like the angles."""
    values = np.asarray(value, dtype=float)
    if values.ndim and values.shape != angle.shape:
        raise LinkproofError(
            f"{name}: expected a number or an array of the crank angles' shape {angle.shape}, got shape "
            f"{values.shape}; pass one value per angle"
        )
    return values.ravel() if values.ndim else values
