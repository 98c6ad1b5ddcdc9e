"""Columns of another tool's result files, as they stand there and as signals of the linkage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.filejudge.fault import Correction

Array = NDArray[np.float64]
Axis = Literal["time", "phi"]

TIME: Final = "time"  # an axis, which the closed form has under no name of its own


class MappingNeededError(LinkproofError):
    """Columns that only the user can tell; ``mapping_text`` is a mapping with places to fill in."""

    def __init__(self, message: str, mapping_text: str) -> None:
        super().__init__(message)
        self.mapping_text = mapping_text


@dataclass(frozen=True)
class Column:
    """A column as it stands in the file.

    ``values`` (n,) are in the file's own ``unit`` (as printed, "" where the file states none); ``resolution`` (n,) is
    half a unit of the last printed digit of each. ``place`` is file, line of the header and number of the column.
    """

    header: str
    unit: str
    values: Array
    resolution: Array
    place: str


@dataclass(frozen=True)
class ResultTable:
    """One header row and its columns, equally long; ``line`` is that of the header.

    ``is_si`` is whether the tool that wrote it prints no units since all its numbers are in SI units.
    """

    file: str
    line: int
    is_si: bool
    columns: tuple[Column, ...]


def correction_keys(correction: Correction, unit: float, digits: int = 17) -> list[str]:
    """The keys of a mapping that write a correction, its offset in a ``unit`` of this SI value, with so many digits."""
    given = {"factor": correction.factor, "time_shift": correction.time_shift, "offset": correction.offset / unit}
    numbers = {key: float(f"{value:.{digits}g}") for key, value in given.items()}
    neutral = {"sign": 1, "factor": 1.0}
    return [f"{k} = {v!r}" for k, v in {"sign": correction.sign, **numbers}.items() if v != neutral.get(k, 0.0)]


@dataclass(frozen=True)
class ImportedSignal:
    """A signal of the linkage by its name: SI values with angles in rad, corrections of the mapping applied.

    ``at`` (n,) is the time, s, or the crank angle, rad; ``at_resolution`` (n,) is its resolution in the file.
    ``joint_force:NAME:magnitude`` is the size of a joint's force. ``assumption`` says what was
    assumed where the header leaves it open; "" for nothing.
    """

    name: str
    axis: Axis
    at: Array
    values: Array
    resolution: Array
    column: Column
    at_resolution: Array
    assumption: str = ""


@dataclass(frozen=True)
class ImportedResults:
    """Signals of a linkage read from result files.

    ``corrections`` are those agreed to, by the names of signals, ``units`` the SI values of their columns' units;
    ``mapping_text`` is a mapping of everything recognised, to be written and changed.
    """

    signals: tuple[ImportedSignal, ...]
    not_judged: tuple[tuple[Column, str], ...]
    corrections: Mapping[str, Correction]
    mapping_text: str
    units: Mapping[str, float] = field(default_factory=dict)

    def written(self, signal: str, correction: Correction) -> str:
        """A correction of a signal's column as a mapping writes it; "nothing" for none."""
        return ", ".join(correction_keys(correction, self.units.get(signal, 1.0), 6)) or "nothing"
