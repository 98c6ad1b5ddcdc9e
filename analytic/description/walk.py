"""The numbers of a description, or of an engine's scene: those of the fields whose annotations say their kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass, replace
from functools import cache
from typing import Any, Final, NamedTuple, get_args, get_type_hints

import numpy as np

from analytic.description.law import Law, LawOfNumbers
from analytic.description.linkage import unit
from analytic.description.units import Kind

Keys = tuple[str | int, ...]  # fields, keys and indices that lead to a number; of a law row and component
ANGLES: Final = "angles"  # of a law, in a path


class Number(NamedTuple):
    """A number, SI, with its kind and its path."""

    path: Keys
    kind: Kind
    value: float


def walk(part: Any, kind: Kind | None = None, path: Keys = ()) -> Iterator[Number]:  # noqa: ANN401 - any part
    """Every number of a part, in the order of its fields; ``kind`` is that of the part's own field, if that has one."""
    if isinstance(part, tuple | Mapping):
        for key, inner in enumerate(part) if isinstance(part, tuple) else part.items():
            if isinstance(inner, float) and kind is not None:
                yield Number((*path, key), kind, inner)
            else:
                yield from walk(inner, kind, (*path, key))
    elif isinstance(part, Law):
        for key, row in _rows(part).items():
            yield from walk(row, Kind.COORDINATE if key == ANGLES else kind, (*path, key))
    elif fields := number_fields(part.__class__):
        for name, own in fields.items():
            yield from walk(getattr(part, name), own, (*path, name))
    elif part is not None and kind is not None:
        yield Number(path, kind, part)


def with_values(part: Any, values: Mapping[Keys, Any], kind: Kind | None = None) -> Any:  # noqa: ANN401 - any part
    """A part with other values, which may be arrays, at some paths; a direction becomes a unit vector again."""
    if () in values:
        return values[()]
    if isinstance(part, Law):
        return _law(part, with_values(_rows(part), values))
    inner: dict[Any, dict[Keys, Any]] = {}
    for (key, *rest), value in values.items():
        inner.setdefault(key, {})[tuple(rest)] = value
    if fields := number_fields(part.__class__):
        return replace(part, **{key: with_values(getattr(part, key), inner[key], fields[key]) for key in inner})
    if isinstance(part, Mapping):
        return {key: with_values(old, inner[key], kind) if key in inner else old for key, old in part.items()}
    new = tuple(with_values(old, inner[key], kind) if key in inner else old for key, old in enumerate(part))
    same = all(isinstance(value, float) and value == old for value, old in zip(new, part, strict=True))
    return unit(new) if kind is Kind.DIRECTION and not same else new


def _rows(law: Law) -> dict[str | int, tuple[float, ...]]:
    """The values of a load's law row by row, and its angles."""
    rows: dict[str | int, tuple[float, ...]] = dict(enumerate(map(tuple, np.atleast_2d(law.values).tolist())))
    return rows if law.angles is None else {**rows, ANGLES: tuple(law.angles.tolist())}


def _law(law: Law, rows: dict[str | int, tuple[Any, ...]]) -> Law:
    """A load's law with other rows and angles."""
    angles = np.array(rows.pop(ANGLES)) if law.angles is not None else None
    flat = tuple(value for row in rows.values() for value in row)
    if not all(isinstance(value, float | int) for value in flat):
        return LawOfNumbers(law.values, angles, law.periodic, law.linear, flat)
    return replace(law, values=np.reshape(flat, law.values.shape), angles=angles)


@cache
def number_fields(part: type) -> Mapping[str, Kind | None]:
    """The fields of a dataclass that have numbers, with their kinds; None where the parts in the field say them.

    Any other type has none.
    """
    fields: dict[str, Kind | None] = {}
    if not is_dataclass(part):
        return fields
    for name, hint in get_type_hints(part, include_extras=True).items():
        kinds = [extra for extra in getattr(hint, "__metadata__", ()) if isinstance(extra, Kind)]
        if kinds or any(number_fields(inner) for inner in _dataclasses_in(hint)):
            fields[name] = kinds[0] if kinds else None
    return fields


def _dataclasses_in(hint: Any) -> Iterator[type]:  # noqa: ANN401 - a hint may be anything
    """The dataclasses inside a type such as ``tuple[Spring, ...]`` or ``Output | None``."""
    if isinstance(hint, type) and is_dataclass(hint):
        yield hint
    for argument in get_args(hint):
        yield from _dataclasses_in(argument)
