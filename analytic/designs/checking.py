"""Checks of the parameters of designs: known names, equal lengths, possible values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import SPEED, design_numbers
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError

Array = NDArray[np.float64]


def speed_of(numbers: Mapping[str, Any], speed: ArrayLike) -> Any:  # noqa: ANN401 - plain or dual
    """The driver's signed speed, rad/s or m/s: the designs' own, with the sign of ``speed``, or ``speed`` itself."""
    return numbers[SPEED] * np.sign(speed) if SPEED in numbers else np.asarray(speed)


def checked(linkage: Linkage, parameters: Mapping[str, ArrayLike], *, has_speed: bool = False) -> dict[str, Array]:
    """The parameters as arrays (designs,) by name: numbers of a description but the sketch's; ``SPEED`` if it has one.

    Raises UnknownNameError for another name, LinkproofError for arrays that are not of one length or not flat, numbers
    that are not finite, negative masses, directions of no length and speeds of zero.
    """
    numbers = design_numbers(linkage)
    kinds: dict[str, str] = {name: kind for name, (kind, _) in numbers.items()} | ({SPEED: SPEED} if has_speed else {})
    for name in parameters:
        if name not in kinds:
            raise UnknownNameError(f"parameter of '{linkage.name}'", name, kinds)
    arrays = {name: np.asarray(values, dtype=float) for name, values in parameters.items()}
    shapes = {values.shape for values in arrays.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1 or next(iter(shapes)) == (0,):
        raise LinkproofError(
            "parameters: expected one or more flat arrays of one length, a value per design, got "
            f"{', '.join(f'{name} of shape {values.shape}' for name, values in arrays.items()) or 'none'}; "
            "give every parameter a value per design"
        )
    for name, values in arrays.items():
        _check(name, kinds[name], values)
    directions = [name for name, (kind, _) in numbers.items() if kind == "direction"]
    for x, y in zip(directions[::2], directions[1::2], strict=True):
        if x in arrays or y in arrays:
            _check_direction(x.removesuffix(".x"), *(arrays.get(name, np.asarray(numbers[name][1])) for name in (x, y)))
    return arrays


def _check(name: str, kind: str, values: Array) -> None:
    """Finite numbers, no negative masses, and a speed."""
    wrong = ~np.isfinite(values)
    expected = "finite numbers"
    if kind in ("mass", "inertia"):
        wrong |= values < 0.0
        expected = "finite numbers, none negative"
    if kind == SPEED:
        wrong |= values == 0.0
        expected = "finite numbers other than 0"
    if np.any(wrong):
        first = int(np.argmax(wrong))
        raise LinkproofError(f"{name}: expected {expected}, got {values[first]:g} in design {first}; correct it")


def _check_direction(name: str, x: Array, y: Array) -> None:
    """A direction needs a length."""
    size = np.hypot(x, y)
    if not np.all(size):
        first = int(np.argmin(size != 0.0))
        raise LinkproofError(f"{name}: expected a direction, got (0, 0) in design {first}; correct it")
