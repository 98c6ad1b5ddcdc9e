"""A user's project: the folder of a ``linkproof.toml``, with the linkages, engines and limits to compare."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any, Final

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.judging.limits import LimitTable, shipped_limits, with_rows

FILE: Final = "linkproof.toml"
BASELINE: Final = "linkproof-baseline.json"
LISTS: Final = ("linkages", "engines", "settings", "regimes", "figures")
KEYS: Final = (*LISTS, "time_limit", "memory_limit", "baseline", "allow_new", "allow_missing", "limit")


@dataclass(frozen=True)
class Project:
    """The contents of a ``linkproof.toml``; an empty field means the command's default.

    ``linkages`` are the files that its patterns match, ``engines``, ``settings`` and ``regimes`` names as the commands
    take them, ``time_limit`` s and ``memory_limit`` GiB of each run, ``baseline`` the file of what was recorded,
    ``names_baseline`` whether it is named; ``allow_new`` and ``allow_missing`` let linkages and motions differ from it.
    ``figures`` are names of figures that are recorded in it and compared besides the key figures.
    """

    folder: Path
    baseline: Path
    linkages: tuple[Path, ...] = ()
    engines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    regimes: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    time_limit: float | None = None
    memory_limit: float | None = None
    limits: LimitTable = field(default_factory=shipped_limits)
    names_baseline: bool = False
    allow_new: bool = False
    allow_missing: bool = False


def find_project(start: Path) -> Project | None:
    """The project that a file or folder belongs to: the nearest ``linkproof.toml`` there or above; else None."""
    here = start.resolve()
    for folder in (here, *here.parents):
        if (folder / FILE).is_file():
            return read_project(folder / FILE)
    return None


def read_project(path: Path) -> Project:
    """A project from its file; raises LinkproofError for a wrong one."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise LinkproofError(f"{path}: expected TOML, got {error}; correct it") from error
    for name in table:
        if name not in KEYS:
            raise UnknownNameError(f"key of {path}", name, KEYS)
    lists = {name: _names(table, name, path) for name in LISTS}
    folder = path.parent
    return Project(
        folder=folder,
        baseline=_within(folder, _text(table, "baseline", BASELINE, path), "baseline", path),
        linkages=tuple(file for pattern in lists.pop("linkages") for file in _files(folder, pattern, path)),
        limits=with_rows(table["limit"], str(path)) if "limit" in table else shipped_limits(),
        time_limit=_number(table, "time_limit", path),
        memory_limit=_number(table, "memory_limit", path),
        names_baseline="baseline" in table,
        allow_new=_flag(table, "allow_new", path),
        allow_missing=_flag(table, "allow_missing", path),
        **lists,
    )


def _names(table: Mapping[str, Any], name: str, path: Path) -> tuple[str, ...]:
    words = table.get(name, [])
    if not isinstance(words, list) or not all(isinstance(word, str) and word for word in words):
        raise LinkproofError(f"{path}: {name}: expected a list of words, got {words!r}; write it in brackets")
    return tuple(words)


def _text(table: Mapping[str, Any], name: str, default: str, path: Path) -> str:
    text = table.get(name, default)
    if not isinstance(text, str) or not text:
        raise LinkproofError(f"{path}: {name}: expected the name of a file, got {text!r}; write one")
    return text


def _flag(table: Mapping[str, Any], name: str, path: Path) -> bool:
    value = table.get(name, False)
    if not isinstance(value, bool):
        raise LinkproofError(f"{path}: {name}: expected true or false, got {value!r}; write one of them")
    return value


def _number(table: Mapping[str, Any], name: str, path: Path) -> float | None:
    value = table.get(name)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < math.inf:
        raise LinkproofError(f"{path}: {name}: expected a positive finite number, got {value!r}; correct it")
    return float(value)


def _within(folder: Path, place: str, key: str, path: Path) -> Path:
    """A place beneath the project's folder; raises LinkproofError for one elsewhere, also if links lead there."""
    try:
        result = Path(os.path.realpath(folder / place))
    except ValueError:  # a null character
        result = Path(os.sep)
    if ".." in PurePath(place).parts or not result.is_relative_to(os.path.realpath(folder)):
        raise LinkproofError(f"{path}: {key}: expected a place beneath its folder, got '{place}'; give one there")
    return folder / place


def _files(folder: Path, pattern: str, path: Path) -> list[Path]:
    """The files that a pattern matches, sorted; raises LinkproofError without one, or for one outside the folder."""
    _within(folder, pattern, "linkages", path)
    try:
        paths = sorted(file for file in folder.glob(pattern) if file.is_file() and file.name != FILE)
    except (ValueError, NotImplementedError) as error:  # an absolute pattern, or a double star beside letters
        raise LinkproofError(f"{path}: linkages: expected a pattern beneath its folder, got '{pattern}'") from error
    if not paths:
        raise LinkproofError(f"{path}: linkages: expected linkage files, got none that match '{pattern}'; correct it")
    return [_within(folder, str(file.relative_to(folder)), "linkages", path) for file in paths]
