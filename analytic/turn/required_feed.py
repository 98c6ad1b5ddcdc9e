"""Required against actual feed of thread: the curve a stitch needs, from the user's file, beside the mechanism's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.thread_path import ThreadPath
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.turn.thread_feed import feed

Array = NDArray[np.float64]

COLUMNS: Final = ("phi_deg", "feed_mm")
FORM: Final = f"two columns, {' and '.join(COLUMNS)}"
MM: Final = 1e-3


@dataclass(frozen=True)
class RequiredFeed:
    """Crank angles, rad, and the feed required at each, m; both (n,), in the file's order."""

    angle: Array
    feed: Array


@dataclass(frozen=True)
class FeedComparison:
    """Required and actual feed, m, at the crank angles of the required curve, rad; all (n,)."""

    angle: Array
    required: Array
    actual: Array

    @property
    def difference(self) -> Array:
        """Actual less required, m: positive where the mechanism gives more thread than the stitch needs."""
        return self.actual - self.required


def compare_feed(mechanism: Mechanism, path: ThreadPath, required: RequiredFeed) -> FeedComparison:
    """The mechanism's feed at the angles of a required curve."""
    return FeedComparison(required.angle, required.feed, feed(mechanism, path, required.angle))


def read_required_feed(path: str | Path) -> RequiredFeed:
    """Read a required curve from a CSV file: crank angle in degrees and feed in mm.

    A first line with the columns' names is optional and may swap them; empty lines and lines that start with # are
    passed over. Columns are separated by commas, or by semicolons or tabs, in which case numbers may have decimal
    commas. Raises LinkproofError with the line at fault.
    """
    rows: list[tuple[float, float]] = []
    swapped = False
    for number, line in enumerate(_lines(Path(path)), start=1):
        fields = _fields(line)
        if not fields:
            continue
        if not rows and not any(_is_number(field) for field in fields):
            names = tuple(field.strip('"').lower() for field in fields)
            if sorted(names) != sorted(COLUMNS):
                raise LinkproofError(f"{path}, line {number}: expected {FORM}, got '{line.strip()}'; name them so")
            swapped = names != COLUMNS
            continue
        if len(fields) != len(COLUMNS) or not all(_is_number(field) for field in fields):
            raise LinkproofError(
                f"{path}, line {number}: expected {FORM}, with a finite number each, got '{line.strip()}'; correct it"
            )
        first, second = (float(field) for field in fields)
        rows.append((second, first) if swapped else (first, second))
    if not rows:
        raise LinkproofError(f"{path}: expected {FORM}, with a row for each crank angle, got none; add them")
    table = np.array(rows)
    return RequiredFeed(np.radians(table[:, 0]), MM * table[:, 1])


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise LinkproofError(f"{path}: expected a text file in UTF-8, got other bytes; save it as UTF-8") from None
    except (OSError, ValueError) as error:
        raise LinkproofError(f"{path}: expected a readable CSV file, got '{error}'; check the path") from None


def _fields(line: str) -> list[str]:
    text = line.strip()
    if not text or text.startswith("#"):
        return []
    mark = next((mark for mark in (";", "\t") if mark in text), None)
    if mark is None:
        return [field.strip() for field in text.split(",")]
    return [field.strip().replace(",", ".") for field in text.split(mark)]


def _is_number(field: str) -> bool:
    try:
        return math.isfinite(float(field))
    except ValueError:
        return False
