"""What may be requested of the closed form, checked: quantities by name over many crank angles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError, UnknownNameError

Array = NDArray[np.float64]

UNITS: Final[Mapping[str, str]] = {
    "Jeq": "kg m²",
    "half_slope": "kg m²",
    "Q": "N m",
    "Mkr": "N m",
    "Teq": "J",
    "Peq": "W",
    "S": "m",
    "v": "m/s",
    "a": "m/s²",
}
"""Names that can be requested, with their units; half_slope is ½ dJeq/dφ."""

LINEAR_UNITS: Final[Mapping[str, str]] = {
    "phi": "m",
    "omega": "m/s",
    "epsilon": "m/s²",
    "Jeq": "kg",
    "half_slope": "kg/m",
    "Q": "N",
    "Mkr": "N",
}
"""Units that change where the driver is pushed along a line, so that φ is a length."""


def unit_of(name: str, unit: str, *, is_linear: bool) -> str:
    """The unit of a quantity by name, whose ``unit`` is that of a linkage driven by a turning crank."""
    return LINEAR_UNITS.get(name, unit) if is_linear else unit


MOVING: Final = frozenset({"Mkr", "Teq", "Peq", "v", "a"})  # those that depend on how the crank moves


@dataclass(frozen=True)
class EvaluationRequest:
    """Quantities requested at crank angles of a ``shape``, here flat, as speed and acceleration if not scalar."""

    names: tuple[str, ...]
    shape: tuple[int, ...]
    angle: Array
    speed: Array
    acceleration: Array

    @property
    def turns(self) -> bool:
        """Whether the crank turns at any instant."""
        return bool(np.any(self.speed))

    @property
    def accelerates(self) -> bool:
        """Whether it has an acceleration at any instant."""
        return bool(np.any(self.acceleration))


def evaluation_request(
    angle: ArrayLike, quantities: Iterable[str], speed: ArrayLike | None, acceleration: ArrayLike
) -> EvaluationRequest:
    """The arguments of ``evaluate``, checked."""
    names = tuple(dict.fromkeys(quantities))
    for name in names:
        if name not in UNITS:
            raise UnknownNameError("quantity", name, UNITS)
    if speed is None and MOVING.intersection(names):
        needing = ", ".join(name for name in names if name in MOVING)
        raise LinkproofError(f"speed: expected the crank's speed in rad/s for {needing}, got none; pass speed=...")
    angle = np.asarray(angle, dtype=float)
    moves = _like(angle, 0.0 if speed is None else speed, "speed"), _like(angle, acceleration, "acceleration")
    return EvaluationRequest(names, angle.shape, angle.ravel(), *moves)


def _like(angle: Array, value: ArrayLike, name: str) -> Array:
    """A scalar as it is, an array flattened like the angles."""
    values = np.asarray(value, dtype=float)
    if values.ndim and values.shape != angle.shape:
        raise LinkproofError(
            f"{name}: expected a number or an array of the crank angles' shape {angle.shape}, got shape "
            f"{values.shape}; pass one value per angle"
        )
    return values.ravel() if values.ndim else values
