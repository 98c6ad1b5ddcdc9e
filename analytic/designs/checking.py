"""Parameters of designs as arrays of one length, of numbers that a linkage can have."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import Kind, changed
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError

Array = NDArray[np.float64]

SKETCH = "sketch."  # it says which assembly mode is meant, and is the same for all designs


def checked(
    linkage: Linkage, parameters: Mapping[str, ArrayLike], known: Collection[str] | None = None
) -> dict[str, Array]:
    """The parameters as arrays (designs,) by name.

    ``known`` are the names that are allowed: all of ``analytic.description.changes.numbers`` but the sketch's if None.
    Raises UnknownNameError for another, LinkproofError for arrays that are not of one length or not flat, numbers that
    are not finite, negative masses and directions of no length.
    """
    kinds, numbers = _kinds(linkage)
    for name in parameters:
        if name not in (kinds if known is None else known):
            raise UnknownNameError(f"parameter of '{linkage.name}'", name, kinds if known is None else known)
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
    directions = [name for name, kind in kinds.items() if kind == "direction"]
    for x, y in zip(directions[::2], directions[1::2], strict=True):
        if x in arrays or y in arrays:
            _check_direction(x.removesuffix(".x"), *(arrays.get(name, np.asarray(numbers[name])) for name in (x, y)))
    return arrays


def _kinds(linkage: Linkage) -> tuple[dict[str, Kind], dict[str, float]]:
    """Kind and value of every number that a design may differ in."""
    kinds: dict[str, Kind] = {}
    numbers: dict[str, float] = {}

    def note(name: str, kind: Kind, value: float) -> float:
        if not name.startswith(SKETCH):
            kinds[name], numbers[name] = kind, value
        return value

    changed(linkage, note)
    return kinds, numbers


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
