"""The numbers of a linkage, its file or an engine's scene: those of the fields whose annotations say their kind."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass, replace
from functools import cache
from typing import Any, Final, NamedTuple, TypeVar, get_args, get_type_hints

import numpy as np
from pydantic import BaseModel

from analytic.description.law import Law, LawOfNumbers
from analytic.description.units import Kind

Keys = tuple[str | int, ...]  # fields, keys and indices that lead to a number; of a law row and component
T = TypeVar("T")
ANGLES: Final = "angles"  # of a law, in a path


class Number(NamedTuple):
    """A number, SI, with its kind and its path."""

    path: Keys
    kind: Kind
    value: float


def walk(part: Any, kind: Kind | None = None, path: Keys = ()) -> Iterator[Number]:  # noqa: ANN401 - any part
    """Yield every number of a part with its path and kind, in the order of fields.

    ``kind`` is that of the part's own field, None if its parts state their own; ``path`` leads to the part, and paths
    begin with it. A field that is None, as one left out, yields nothing.
    """
    if isinstance(part, tuple | list | Mapping):
        for key, inner in part.items() if isinstance(part, Mapping) else enumerate(part):
            if isinstance(inner, float) and kind is not None:
                yield Number((*path, key), kind, inner)
            else:
                yield from walk(inner, kind, (*path, key))
    elif isinstance(part, Law):
        places = Kind.COORDINATE if part.over == "phi" else Kind.LENGTH
        for key, row in _rows(part).items():
            yield from walk(row, places if key == ANGLES else kind, (*path, key))
    elif fields := number_fields(part.__class__):
        for name, own in fields.items():
            yield from walk(getattr(part, name), own, (*path, name))
    elif kind is not None and not isinstance(part, BaseModel | None):
        yield Number(path, kind, part)


def with_values(part: Any, values: Mapping[Keys, Any], kind: Kind | None = None) -> Any:  # noqa: ANN401 - any part
    """A copy of a part with ``values``, which may be arrays, at some paths; a changed direction becomes a unit vector.

    ``kind`` is that of the part's field. Paths are those of ``walk`` and lead from the part; where there are none in a
    field, the copy shares it. Raises ZeroDivisionError for a direction whose plain components are all 0.
    """
    if () in values:
        return values[()]
    if isinstance(part, Law):
        return _law(part, with_values(_rows(part), values))
    inner: dict[Any, dict[Keys, Any]] = {}
    for (key, *rest), value in values.items():
        inner.setdefault(key, {})[tuple(rest)] = value
    if fields := number_fields(part.__class__):
        new = {key: with_values(getattr(part, key), inner[key], fields[key]) for key in inner}
        return part.model_copy(update=new) if isinstance(part, BaseModel) else replace(part, **new)
    if isinstance(part, Mapping):
        return {key: with_values(old, inner[key], kind) if key in inner else old for key, old in part.items()}
    row = type(part)(with_values(old, inner[key], kind) if key in inner else old for key, old in enumerate(part))
    same = all(isinstance(value, float) and value == old for value, old in zip(row, part, strict=True))
    return unit_vector(row) if kind is Kind.DIRECTION and not same else row


def _rows(law: Law) -> dict[str | int, tuple[float, ...]]:
    """The values of a load's law by row number, and its angles, if it has any, by ``ANGLES``."""
    rows: dict[str | int, tuple[float, ...]] = dict(enumerate(map(tuple, np.atleast_2d(law.values).tolist())))
    return rows if law.angles is None else {**rows, ANGLES: tuple(law.angles.tolist())}


def _law(law: Law, rows: dict[str | int, tuple[Any, ...]]) -> Law:
    """A copy of a load's law with these rows and angles in place of its own; removes the angles from ``rows``.

    With rows that are not all plain numbers it is a LawOfNumbers.
    """
    angles = np.array(rows.pop(ANGLES)) if law.angles is not None else None
    flat = tuple(value for row in rows.values() for value in row)
    if not all(isinstance(value, float | int) for value in flat):
        return LawOfNumbers(law.values, angles, law.period, law.linear, law.over, law.when, flat)
    return replace(law, values=np.reshape(flat, law.values.shape), angles=angles)


@cache
def number_fields(part: type) -> Mapping[str, Kind | None]:
    """The fields of a dataclass or a table that have numbers, with their kinds, in order.

    None for one whose parts state their own. For any other type {}. The same object comes back for the same type.
    """
    hints: Mapping[str, Any] = {}
    if is_dataclass(part):
        hints = get_type_hints(part, include_extras=True)
    elif issubclass(part, BaseModel):
        hints = {name: (field.annotation, *field.metadata) for name, field in part.model_fields.items()}
    kinds = {name: next(_inside(hint, Kind), None) for name, hint in hints.items()}
    return {name: kind for name, kind in kinds.items() if kind or any(map(number_fields, _inside(hints[name], type)))}


def _inside(hint: Any, what: type[T]) -> Iterator[T]:  # noqa: ANN401 - a hint may be anything
    """Yield every instance of ``what`` that stands in a hint such as ``tuple[Spring, ...]`` or ``Position | None``."""
    if isinstance(hint, what):
        yield hint
    for inner in hint if isinstance(hint, tuple) else (*get_args(hint), *getattr(hint, "__metadata__", ())):
        yield from _inside(inner, what)


def unit_vector(vector: tuple[float, float]) -> tuple[float, float]:
    """The unit vector along a non-zero vector, whose components may be arrays or traced numbers.

    Plain numbers that are all zero raise ZeroDivisionError.
    """
    plain = all(isinstance(part, float | int) for part in vector)
    length = math.hypot(*vector) if plain else np.hypot(*vector)
    return (vector[0] / length, vector[1] / length)
