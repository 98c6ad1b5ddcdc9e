"""Parameters of designs as arrays of one length, of numbers that a linkage can have."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import Kind, design_numbers
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError

Array = NDArray[np.float64]


def checked(
    linkage: Linkage, parameters: Mapping[str, ArrayLike], known: Collection[str] | None = None
) -> dict[str, Array]:
    """The parameters as arrays (designs,) by name.

    ``known`` are the names that are allowed: all of ``analytic.description.changes.numbers`` but the sketch's if None.
    Raises UnknownNameError for another, LinkproofError for arrays that are not of one length or not flat, numbers that
    are not finite, negative masses and directions of no length.
    """
    numbers = design_numbers(linkage)
    allowed = numbers if known is None else known
    for name in parameters:
        if name not in allowed:
            raise UnknownNameError(f"parameter of '{linkage.name}'", name, allowed)
    arrays = {name: np.asarray(values, dtype=float) for name, values in parameters.items()}
    shapes = {values.shape for values in arrays.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1 or next(iter(shapes)) == (0,):
        raise LinkproofError(
            "parameters: expected one or more flat arrays of one length, a value per design, got "
            f"{', '.join(f'{name} of shape {values.shape}' for name, values in arrays.items()) or 'none'}; "
            "give every parameter a value per design"
        )
    for name, values in arrays.items():
        _check(name, numbers[name][0], values)
    directions = [name for name, (kind, _) in numbers.items() if kind == "direction"]
    for x, y in zip(directions[::2], directions[1::2], strict=True):
        if x in arrays or y in arrays:
            _check_direction(x.removesuffix(".x"), *(arrays.get(name, np.asarray(numbers[name][1])) for name in (x, y)))
    return arrays


def _check(name: str, kind: Kind, values: Array) -> None:
    """Finite numbers, and no negative masses."""
    wrong = ~np.isfinite(values)
    expected = "finite numbers"
    if kind in ("mass", "inertia"):
        wrong |= values < 0.0
        expected = "finite numbers, none negative"
    if np.any(wrong):
        first = int(np.argmax(wrong))
        raise LinkproofError(f"{name}: expected {expected}, got {values[first]:g} in design {first}; correct it")


def _check_direction(name: str, x: Array, y: Array) -> None:
    """A direction needs a length."""
    size = np.hypot(x, y)
    if not np.all(size):
        first = int(np.argmin(size != 0.0))
        raise LinkproofError(f"{name}: expected a direction, got (0, 0) in design {first}; correct it")
