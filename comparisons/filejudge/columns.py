"""Columns of another tool's result files, as they stand there and as signals of the linkage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from analytic.numerics.arrays import Array, Booleans

Axis = Literal["time", "phi"]

NEGLIGIBLE: Final = 1e-5  # of a signal's scale: what every solver's numerics may do, and no fault of a model
TIME: Final = "time"  # an axis, which the closed form has under no name of its own


@dataclass(frozen=True)
class Correction:
    """A correction that a mapping may accept: ``sign * factor * value + offset`` at the time + ``time_shift``; SI, s.

    ``sign`` is 1 or -1, ``factor`` positive. By default nothing is corrected.
    """

    sign: int = 1
    factor: float = 1.0
    time_shift: float = 0.0
    offset: float = 0.0

    def compose(self, first: Correction) -> Correction:
        """The one correction with the effect of ``first`` and then of this one."""
        return Correction(
            self.sign * first.sign,
            self.factor * first.factor,
            self.time_shift + first.time_shift,
            self.sign * self.factor * first.offset + self.offset,
        )


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


@dataclass(frozen=True)
class SignalTimes:
    """A signal by its ``name`` at ``time`` (n,), s."""

    name: str
    time: Array


@dataclass(frozen=True)
class ImportedSignal(SignalTimes):
    """A signal of the linkage: SI values (n,), angles in rad, corrected as was agreed.

    Over the ``axis`` phi the ``time`` (n,) is the crank angle, rad, until the crank's speed is known. Values and times
    are each within their ``rounding`` and ``time_rounding`` (n,). ``joint_force:NAME:magnitude`` is the size of a
    joint's force. The column's unit has the SI value ``unit_value``; ``assumption`` says what was assumed where the
    header leaves it open, "" for nothing.
    """

    values: Array
    rounding: Array
    time_rounding: Array
    axis: Axis
    column: Column
    unit_value: float = 1.0
    assumption: str = ""


@dataclass(frozen=True)
class Evidence(SignalTimes):
    """A column of a file beside the closed form: ``values`` and ``truth`` (n,) at its times.

    The file leaves ``rounding`` (n,) open. A cause need not explain samples that are not ``counted``; ``over`` are
    those that are off even so. ``scale`` is the size, SI, over which errors are stated. All are in the SI unit ``si``;
    words are in ``unit``, of the SI value ``unit_value``; the column's own unit has the SI value ``header``.
    """

    values: Array
    truth: Array
    rounding: Array
    counted: Booleans
    over: Booleans
    scale: float
    unit: str
    unit_value: float = 1.0
    si: str = ""
    header: float = 1.0

    def thinned(self, most: int, worst: int = 0) -> Evidence:
        """A copy of the evidence at up to ``most`` samples, evenly spread, and the ``worst`` samples farthest off.

        With no more samples than ``most`` it has all of them.
        """
        few = np.arange(0, len(self.time), -(-len(self.time) // most))
        if worst and len(few) < len(self.time):
            few = np.union1d(few, np.argsort(np.nan_to_num(np.abs(self.residual)))[-worst:])
        parts: dict[str, Any] = {k: v[few] for k, v in vars(self).items() if isinstance(v, np.ndarray)}
        return replace(self, **parts)

    @property
    def tolerance(self) -> Array:
        """The difference, SI, (n,), that needs no cause: rounding and what is negligible."""
        return np.asarray(self.rounding + NEGLIGIBLE * self.scale)

    @property
    def residual(self) -> Array:
        """Value less truth over the tolerance, (n,), nan where a sample is not counted."""
        return np.where(self.counted, (self.values - self.truth) / self.tolerance, np.nan)


@dataclass(frozen=True)
class ImportedResults:
    """Signals of a linkage read from result files.

    ``not_judged`` are columns, each with the reason. ``corrections`` are those agreed to, by the names of signals;
    ``read`` has every column that was read, axes too: its signal, the column in the unit it was read in, the unit's SI
    value, and what was assumed.
    """

    signals: tuple[ImportedSignal, ...]
    not_judged: tuple[tuple[Column, str], ...]
    corrections: Mapping[str, Correction]
    read: tuple[tuple[str, Column, float, str], ...] = ()

    def written(self, signal: str, correction: Correction) -> str:
        """The ``--map`` option that states a correction of a signal's column, quoted for a shell.

        As in ``--map "Torque=-1000*Mkr [N*mm] + 5 @ +0.001 s"``. Raises StopIteration for a signal that was not read.
        """
        column, value = next((column, value) for name, column, value, _ in self.read if name == signal)
        unit, factor = f" [{column.unit}]", 1.0 / correction.factor
        offset = -correction.sign * correction.offset * factor / value
        sign, times = "-" if correction.sign < 0 else "", f"{factor:.9g}*" if factor != 1.0 else ""
        added = f" {'+' if offset > 0.0 else '-'} {abs(offset):.9g}" if offset else ""
        later = f" @ {correction.time_shift:+.9g} s" if correction.time_shift else ""
        return f'--map "{column.header}={sign}{times}{signal}{unit}{added}{later}"'
