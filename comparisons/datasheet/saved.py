"""Data sheets as a file beside a campaign's curves: ``mechanisms.json``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from pydantic import TypeAdapter, ValidationError

from analytic.errors import LinkproofError
from comparisons.datasheet.sheet import Sheet, ThreadSheet
from comparisons.runs.files import write_text

FILE: Final = "mechanisms.json"
AGAIN: Final = "run compare with --out again"


@dataclass(frozen=True)
class Saved:
    """What the file holds."""

    format: int
    sheets: tuple[Sheet, ...]


Shape = tuple[int, ...]
FORM: Final = TypeAdapter(Saved)


def save_sheets(folder: Path, sheets: Iterable[Sheet]) -> None:
    """Write the sheets into a folder, in one step."""
    write_text(folder / FILE, FORM.dump_json(Saved(1, tuple(sheets))).decode() + "\n")


def load_sheets(folder: Path) -> tuple[Sheet, ...]:
    """Read them back; raises LinkproofError, which names the key, for a file that is missing or damaged."""
    path = folder / FILE
    if not path.is_file():
        raise LinkproofError(f"no data sheets of the mechanisms at '{path}': {AGAIN}")
    try:
        found = FORM.validate_json(path.read_bytes(), strict=True).sheets
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        raise _damaged(path, ".".join(map(str, first["loc"])), first["msg"]) from error
    except OSError as error:
        raise LinkproofError(f"cannot read '{path}': {error.strerror}; {AGAIN}") from error
    for number, sheet in enumerate(found):
        for key, shape, expected in _shapes(sheet):
            if shape != expected:
                raise _damaged(path, f"sheets.{number}.{key}", f"expected {expected} numbers, got {shape}")
    return found


def _shapes(sheet: Sheet) -> Iterator[tuple[str, Shape, Shape]]:
    """Every array by its key, with the shape that it has and the one that it must have."""
    axis = (len(sheet.values[sheet.axis]) if sheet.axis in sheet.values else 0,)
    for name, values in sheet.values.items():
        yield f"values.{name}", values.shape, axis
    for kind, shares in sheet.shares.items():
        for name, values in shares.items():
            yield f"shares.{kind}.{name}", values.shape, axis
    if sheet.positions is not None:
        count = len(sheet.positions.axis)
        yield "positions.angle", sheet.positions.angle.shape, (count,)
        for name, places in sheet.positions.bodies.items():
            yield f"positions.bodies.{name}", places.shape, (3, count)
    if sheet.normalised is not None:
        phase = sheet.normalised.phase.shape
        for key in ("functions", "harmonics"):
            for name in "Sva":
                values = getattr(sheet.normalised, key).get(name, np.empty(0))
                yield f"normalised.{key}.{name}", values.shape, phase
    yield from _thread_shapes(sheet.thread) if sheet.thread else ()


def _thread_shapes(thread: ThreadSheet) -> Iterator[tuple[str, Shape, Shape]]:
    angle = thread.angle.shape
    yield "thread.feed", thread.feed.shape, angle
    yield "thread.length", thread.length.shape, angle
    yield "thread.contour", thread.contour.shape, (len(thread.stops), 3)
    for name, eye in thread.eyes.items():
        yield f"thread.eyes.{name}.path", eye["path"].shape, (3, *angle)


def _damaged(path: Path, key: str, what: str) -> LinkproofError:
    return LinkproofError(f"'{path}' is damaged at {key or 'its start'}: {what}; {AGAIN}")
