"""Linkage files with something wrong in them: a document changed at random, written back as TOML."""

from __future__ import annotations

import copy
import json
import tomllib
from typing import Any

from hypothesis import strategies as st

from analytic.description.loading import CATALOGUE, catalogue
from tests.analytic.linkages import FOLDER, MADE_UP

TEXTS = tuple(
    path.read_text(encoding="utf-8")
    for path in (*(CATALOGUE / f"{n}.toml" for n in catalogue()), *(FOLDER / f"{n}.toml" for n in MADE_UP))
)

NAMES = st.sampled_from(["A", "B", "D", "O", "O1", "crank", "rod", "rocker", "mass", "slides", "ground", "zzz"])
NUMBERS = st.sampled_from([0, 1, -1, 3, 0.5, -2.5, 1e-9, 1e9, 1e300, -1e300, 1e-300, 10**30, 10**400])
FACTORS = st.sampled_from([-1.0, 0.0, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3, 1e-3, 1e20, 1e-20, 1e40, 1e-40])
SPECIAL = st.sampled_from([float("nan"), float("inf"), -float("inf"), True, "", "ground", "crank", "A", "mm", "°\n\"'"])
PLAIN = NUMBERS | SPECIAL | st.floats()
PIECES = PLAIN | st.lists(PLAIN, max_size=4) | st.dictionaries(st.sampled_from(["A", "mass", "x"]), PLAIN, max_size=3)


def toml(value: Any) -> str:
    """A value as inline TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return (
            "{ "
            + ", ".join(f"{json.dumps(key, ensure_ascii=False)} = {toml(part)}" for key, part in value.items())
            + " }"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def document(tables: dict[str, Any]) -> str:
    """A whole document."""
    return "\n".join(f"{json.dumps(key, ensure_ascii=False)} = {toml(value)}" for key, value in tables.items())


def _places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths to everything inside a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [result for key, part in inner for result in ((*path, key), *_places(part, (*path, key)))]


def _is_number(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, int) and abs(value) < 10**300)


def _at(tables: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        tables = tables[key]
    return tables


@st.composite
def mutated_files(draw: st.DrawFn) -> str:
    """A file of the catalogue or of the tests with one to three changes anywhere in it."""
    tables = tomllib.loads(draw(st.sampled_from(TEXTS)))
    for _ in range(draw(st.integers(1, 3))):
        places = _places(tables)
        numbers = [place for place in places if _is_number(_at(tables, place))]
        if numbers and draw(st.booleans()):  # a number that may well pass as one
            path = draw(st.sampled_from(numbers))
            _at(tables, path[:-1])[path[-1]] *= draw(FACTORS)
        elif places:
            _change(draw, tables, places)
    return document(tables)


def _change(draw: st.DrawFn, tables: dict[str, Any], places: list[tuple[Any, ...]]) -> None:
    """Anything anywhere: replaced, left out, copied from elsewhere, renamed."""
    path = draw(st.sampled_from(places))
    holder, key = _at(tables, path[:-1]), path[-1]
    change = draw(st.sampled_from(["replace", "delete", "copy", "rename"]))
    if change == "delete":
        del holder[key]
    elif change == "copy":
        holder[key] = copy.deepcopy(_at(tables, draw(st.sampled_from(places))))
    elif change == "rename" and isinstance(holder, dict):
        holder[draw(NAMES)] = holder.pop(key)
    else:
        holder[key] = draw(PIECES)
