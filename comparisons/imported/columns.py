"""Columns of another tool's result files, as they stand there and as signals of the linkage."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError

Array = NDArray[np.float64]
Axis = Literal["time", "phi"]

# Signals that the closed form has under no name of its own: the axes, and the size of a joint's force.
TIME: Final = "time"
MAGNITUDE: Final = "magnitude"


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
    """One header row and its columns, equally long; ``line`` is that of the header, ``tool`` what wrote it."""

    file: str
    line: int
    tool: str
    columns: tuple[Column, ...]


@dataclass(frozen=True)
class Correction:
    """What the mapping agrees to: ``sign * factor * value + angle_offset`` at the file's time + ``time_shift``.

    ``time_shift`` is in s, ``angle_offset`` in rad; the offset is that of an angle, which may be the axis.
    """

    sign: int = 1
    factor: float = 1.0
    time_shift: float = 0.0
    angle_offset: float = 0.0

    def keys(self, digits: int = 17) -> list[str]:
        """It as the keys of a mapping, the angle in degrees, with so many significant digits."""
        given = {"factor": self.factor, "time_shift": self.time_shift, "angle_offset": math.degrees(self.angle_offset)}
        numbers = {key: float(f"{value:.{digits}g}") for key, value in given.items()}
        neutral = {"sign": 1, "factor": 1.0}
        return [f"{k} = {v!r}" for k, v in {"sign": self.sign, **numbers}.items() if v != neutral.get(k, 0.0)]


NO_CORRECTION: Final = Correction()


@dataclass(frozen=True)
class ImportedSignal:
    """A signal of the linkage by its name: SI values with angles in rad, corrections of the mapping applied.

    ``at`` (n,) is the time, s, or the crank angle, rad; ``at_resolution`` (n,) is how closely the file tells it.
    ``joint_force:NAME:magnitude`` is the size of a joint's force. ``taken`` says what was taken for granted.
    """

    name: str
    axis: Axis
    at: Array
    values: Array
    resolution: Array
    column: Column
    at_resolution: Array
    taken: str = ""


@dataclass(frozen=True)
class ImportedResults:
    """What result files tell about a linkage.

    ``corrections`` are those agreed to, by the names of signals; ``mapping_text`` is a mapping that says all that was
    recognised, to be written and changed.
    """

    signals: tuple[ImportedSignal, ...]
    not_judged: tuple[tuple[Column, str], ...]
    corrections: Mapping[str, Correction]
    mapping_text: str
