"""Result files of a tool that cannot be called, as signals of the linkage.

Nothing is guessed that would change a verdict unseen: a column that may be two things is not judged, a unit that no
header and no convention gives must come from the mapping; assumptions are written beside the signal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, listed, printable, shortened
from comparisons.faults.fault import Correction
from comparisons.imported.columns import (
    TIME,
    Array,
    Axis,
    Column,
    ImportedResults,
    ImportedSignal,
    MappingNeededError,
    ResultTable,
)  # fmt: skip
from comparisons.imported.header_meaning import HeaderParser, Meaning, NotJudgedError
from comparisons.imported.mapping import ColumnMapping, mapping_text, read_mapping, written
from comparisons.imported.result_files import numbered, result_tables

FEWEST: Final = 4  # instants of a curve


@dataclass
class _Read:
    """A column with its meaning, or the reason why it has none."""

    table: ResultTable
    column: Column
    meaning: Meaning | None = None
    correction: Correction = field(default_factory=Correction)
    reason: str = ""

    def in_si(self) -> tuple[Array, Array]:
        """Values in SI units, corrected, and their resolution, each (n,)."""
        assert self.meaning is not None
        assert self.meaning.unit is not None
        scale = self.correction.factor * self.meaning.unit.factor
        values = self.correction.sign * scale * self.column.values + self.correction.offset
        return values, scale * self.column.resolution


class _Reading:
    """State of reading result files: tables, meanings, and columns without one."""

    def __init__(self, linkage: Linkage, mapping: ColumnMapping, tables: Sequence[ResultTable]) -> None:
        self.recognition = HeaderParser(linkage)
        self.mapping = mapping
        self.columns = [self._read(table, column) for table in tables for column in table.columns]
        self.axes = {id(table): self._axis(table) for table in tables}

    def of(self, table: ResultTable | None = None) -> list[tuple[_Read, Meaning]]:
        """Columns of a table, or of all, that mean something."""
        every = [column for column in self.columns if table is None or column.table is table]
        return [(column, column.meaning) for column in every if column.meaning is not None]

    def ask(self, message: str) -> MappingNeededError:
        """The error to raise where the user must decide, with a mapping of everything recognised."""
        return MappingNeededError(message, self.mapping_text())

    def mapping_text(self) -> str:
        """A mapping of everything recognised."""
        every = [column for column in self.columns if not self.mapping.ignores(column.column)]
        entries = {
            column.column.header: written(column.column.header, column.meaning, column.reason, column.correction)
            for column in every
        }
        ignored = dict.fromkeys(column.column.header for column in self.columns if self.mapping.ignores(column.column))
        return mapping_text(self.recognition.linkage.name, entries.values(), ignored)

    def _read(self, table: ResultTable, column: Column) -> _Read:
        if self.mapping.ignores(column):
            return _Read(table, column, reason="the mapping ignores it")
        try:
            meaning, correction = self.mapping.meaning(self.recognition, column)
        except NotJudgedError as reason:
            return _Read(table, column, reason=str(reason))
        if meaning.unit is None and table.is_si:
            signal, taken = meaning.signal, "no unit: in SI units, as Modelica writes it"
            taken = "; ".join(filter(None, (taken, meaning.taken)))
            meaning = Meaning(signal, self.recognition.unit(signal), self.recognition.si(signal), taken)
        return _Read(table, column, meaning, correction)

    def _axis(self, table: ResultTable) -> _Read | None:
        """The axis of a table: time, or without time the crank angle."""
        every = self.of(table)
        axes = [column for name in (TIME, "phi") for column, meaning in every if meaning.signal == name]
        if every and not axes:
            raise self.ask(
                f"{table.file}:{table.line}: expected a column of time or crank angle, got "
                f"{listed(column.header for column in table.columns)}; name its column in a mapping, with "
                f'signal = "{TIME}", or export it as well'
            )
        return axes[0] if axes else None

    def refuse_twice(self) -> None:
        """Refuse two columns for one signal or axis; one that names the signal goes before one taken for it."""
        seen: dict[tuple[str, int], _Read] = {}
        for column, meaning in self.of():
            axis = self.axes[id(column.table)]
            is_axis = axis is not None and axis.meaning is not None and axis.meaning.signal == meaning.signal
            place = (meaning.signal, id(column.table) if is_axis else 0)
            before = seen.setdefault(place, column)
            if before is column or before.meaning is None:
                continue
            if is_axis or bool(before.meaning.taken) == bool(meaning.taken):
                raise self.ask(
                    f"expected one column for {meaning.signal}, got '{shortened(before.column.header)}' "
                    f"({before.column.place}) and '{shortened(column.column.header)}' ({column.column.place}); "
                    "name one in a mapping, and the other under ignore"
                )
            weaker, seen[place] = (column, before) if meaning.taken else (before, column)
            weaker.meaning, weaker.reason = None, f"'{shortened(seen[place].column.header)}' names {meaning.signal}"

    def ask_for_units(self) -> None:
        """Ask for the units that neither header nor tool states."""
        without = [(column, meaning) for column, meaning in self.of() if meaning.unit is None]
        for first, meaning in without[:1]:
            more = f" and {len(without) - 1} more" if len(without) > 1 else ""
            raise self.ask(
                f"{first.column.place}: expected a unit of {meaning.signal} in the header "
                f"'{shortened(first.column.header)}'{more}, got none; fill in "
                f'unit = "{self.recognition.si(meaning.signal)}", or what it is, in a mapping'
            )

    def signals(self, table: ResultTable) -> Iterator[ImportedSignal]:
        """The signals of a table in SI units, corrected."""
        axis = self.axes[id(table)]
        if axis is None or axis.meaning is None:
            return
        name: Axis = "time" if axis.meaning.signal == TIME else "phi"
        rows, repeated = _instants(axis.column, name)
        at, sharpness = axis.in_si()
        at = at + axis.correction.time_shift if name == "time" else at
        axis_taken = f"{name}: {axis.meaning.taken}" if axis.meaning.taken else ""
        for column, meaning in self.of(table):
            if column is axis:
                continue
            row = () if axis.meaning.taken == meaning.taken else (axis_taken,)
            taken = "; ".join(filter(None, (meaning.taken, *row, repeated)))
            values, resolution = column.in_si()
            yield ImportedSignal(
                meaning.signal, name, at[rows] + column.correction.time_shift, values[rows], resolution[rows],
                replace(column.column, unit=meaning.printed), sharpness[rows], taken,
            )  # fmt: skip


def read_results(paths: Sequence[Path], linkage: Linkage, mapping: Path | None = None) -> ImportedResults:
    """The signals in result files, with the corrections of the mapping applied.

    Raises LinkproofError with file and line for what cannot be read, and MappingNeededError, which has a mapping to
    fill in, where only the user can tell what a column is.
    """
    tables = numbered(table for path in dict.fromkeys(paths) for table in result_tables(Path(path)))
    if not tables:
        raise LinkproofError("expected at least one file of results, got none; name the files")
    agreed = read_mapping(mapping) if mapping else ColumnMapping()
    agreed.check(column.header for table in tables for column in table.columns)
    reading = _Reading(linkage, agreed, tables)
    reading.refuse_twice()
    reading.ask_for_units()
    signals = [signal for table in tables for signal in reading.signals(table)]
    not_judged = tuple((entry.column, entry.reason) for entry in reading.columns if entry.reason)
    if not signals:
        column, reason = not_judged[0] if not_judged else (tables[0].columns[0], "it is an axis")
        raise reading.ask(
            f"{tables[0].file}:{tables[0].line}: expected a column that is a signal of {printable(linkage.name)}, got "
            f"none: '{shortened(column.header)}' is not judged, since {reason}; name the columns in a mapping"
        )
    corrections = {m.signal: entry.correction for entry, m in reading.of() if entry.correction != Correction()}
    units = {m.signal: m.unit.factor for _, m in reading.of() if m.unit}
    return ImportedResults(tuple(signals), not_judged, corrections, reading.mapping_text(), units)


def _instants(column: Column, name: Axis) -> tuple[NDArray[np.intp], str]:
    """The rows of an axis that are instants of their own, the last of equal ones, and a word on those left out.

    Tools write an instant twice where an event changes the motion. Raises LinkproofError for an axis that turns back.
    """
    steps = np.diff(column.values)
    forward = -1.0 if name == "phi" and len(steps) and column.values[-1] < column.values[0] else 1.0
    back = np.flatnonzero(forward * steps < 0.0)
    if len(back):
        row = int(back[0])
        before, after = column.values[row], column.values[row + 1]
        cure = "export one run a file, its rows in order" if name == "time" else "export the time beside it"
        expected = "a time that grows" if name == "time" else "a crank angle that runs one way"
        raise LinkproofError(
            f"{column.place}: expected {expected} in '{shortened(column.header)}', got {after:g} after {before:g} "
            f"(row {row + 2} of the table); {cure}"
        )
    rows = np.flatnonzero(np.append(steps != 0.0, True))
    if len(rows) < FEWEST:
        raise LinkproofError(
            f"{column.place}: expected a curve of at least {FEWEST} instants, got {len(rows)}; export more "
            "steps of the run"
        )
    left_out = len(column.values) - len(rows)
    return rows, f"of instants written more than once the last is taken ({left_out} left out)" if left_out else ""
