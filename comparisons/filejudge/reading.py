"""Result files of a tool that cannot be called, as signals of the linkage, and the mapping of their columns.

Nothing is guessed that would change a verdict unseen: a column that may be two things is not judged, a unit that no
header and no convention gives must come from the mapping; assumptions are written beside the signal.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Final, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from analytic.description.diagnosis import Source
from analytic.description.linkage import Linkage
from analytic.description.loading import parse_document
from analytic.description.schema import Finite, Tables, TomlTable
from analytic.errors import DescriptionError, LinkproofError, UnknownNameError, listed, printable, shortened
from comparisons.filejudge.columns import (
    TIME,
    Array,
    Axis,
    Column,
    ImportedResults,
    ImportedSignal,
    MappingNeededError,
    ResultTable,
    correction_keys,
)
from comparisons.filejudge.fault import Correction
from comparisons.filejudge.headers import UNITS_BY_NAME, HeaderParser, Meaning, NotJudgedError, parse_unit
from comparisons.filejudge.tables import number_headers, read_text, result_tables

HEAD: Final = """# Columns of result files as signals of {}: correct what is wrong, and give this file
# to judge with --mapping. Corrections that a [[column]] has are applied as they stand here, as
# the value sign * factor * value + offset (in the column's unit) at the time time + time_shift (s).
"""
Text = Annotated[str, Field(min_length=1)]

FEWEST: Final = 4  # instants of a curve


class MappedColumn(TomlTable):
    """A column by its ``header``, and its meaning: a ``signal`` in a ``unit``, by default those of its header.

    What is agreed to: ``sign * factor * value + offset`` (in the column's unit) at the time + ``time_shift`` (s).
    """

    header: Text
    signal: Text | None = None
    unit: Text | None = None
    sign: Literal[1, -1] = 1
    factor: Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)] = 1.0
    time_shift: Finite = 0.0
    offset: Finite = 0.0


class MappingDocument(TomlTable):
    """A whole mapping: headers to ``ignore``, and the columns."""

    ignore: list[Text] = Field(default_factory=list)
    column: Tables[MappedColumn] = Field(default_factory=list)


@dataclass(frozen=True)
class ColumnMapping:
    """A mapping file: ``document`` as checked, ``source`` for the lines of messages; empty without a file."""

    source: Source = field(default_factory=lambda: Source(""))
    document: MappingDocument = field(default_factory=MappingDocument)

    def check(self, headers: Iterable[str]) -> None:
        """Refuse a header that no column has, or that has two entries."""
        known, seen = {_comparable(header) for header in headers}, set()
        every = [(["column", str(n), "header"], column.header) for n, column in enumerate(self.document.column)]
        every += [(["ignore", str(n)], header) for n, header in enumerate(self.document.ignore)]
        for place, header in every:
            if _comparable(header) not in known:
                raise DescriptionError(f"{self.source.at(place)}: {UnknownNameError('column', header, known)}")
            if _comparable(header) in seen:
                raise DescriptionError(
                    f"{self.source.at(place)}: expected one entry for '{shortened(header)}', got two; leave one out"
                )
            seen.add(_comparable(header))

    def ignores(self, column: Column) -> bool:
        """Whether a column is not to be judged."""
        return _comparable(column.header) in map(_comparable, self.document.ignore)

    def meaning(self, recognition: HeaderParser, column: Column) -> tuple[Meaning, Correction]:
        """The meaning of a column by the mapping or by its header, and the accepted corrections.

        Raises NotJudgedError for one whose meaning is unknown, DescriptionError for an entry that cannot be.
        """
        entries = (
            pair
            for pair in enumerate(self.document.column)
            if _comparable(pair[1].header) == _comparable(column.header)
        )
        at, entry = next(entries, (0, None))
        if entry is None:
            return recognition.meaning(column), Correction()
        known = (TIME, *recognition.signals)
        if entry.signal is not None and entry.signal not in known:
            raise self._entry_error(at, "signal", str(UnknownNameError("signal", entry.signal, known)))
        try:
            meaning = recognition.in_stated_unit(entry.signal, column) if entry.signal else recognition.meaning(column)
        except NotJudgedError as reason:
            message = f'expected a signal for this column, got none, and {reason}; add signal = "..."'
            raise self._entry_error(at, "header", message) from None
        if entry.unit is not None:
            unit, si = parse_unit(entry.unit), recognition.unit(meaning.signal)
            if unit is None or not unit.measures(si.dimension):
                fitting = [
                    name for name, item in UNITS_BY_NAME.items() if item.dimension == si.dimension and name.isascii()
                ]
                fault = UnknownNameError(
                    f"unit of {meaning.signal}", entry.unit, [recognition.si_unit_name(meaning.signal), *fitting]
                )
                raise self._entry_error(at, "unit", str(fault))
            meaning = replace(meaning, unit=unit, printed=entry.unit)
        factor = meaning.unit.factor if meaning.unit else 1.0
        return meaning, Correction(entry.sign, entry.factor, entry.time_shift, entry.offset * factor)

    def _entry_error(self, entry: int, key: str, message: str) -> DescriptionError:
        return DescriptionError(f"{self.source.at(['column', str(entry), key])}: {message}")


def _comparable(header: str) -> str:
    return printable(header).strip()


def read_mapping(path: Path) -> ColumnMapping:
    """Read a mapping; raises LinkproofError with file and line."""
    file = read_text(path)
    source = Source(file.name, file.text)
    document = parse_document(source, MappingDocument)
    if not document.column and not document.ignore:
        raise file.fail(
            1,
            'expected a mapping that names a column, such as [[column]] with header = "Torque", signal = "Mkr" and '
            'unit = "N*m", got one that names nothing; add a column, or leave the mapping out',
        )
    return ColumnMapping(source, document)


def format_mapping(linkage: str, entries: Iterable[Sequence[str]], ignored: Iterable[str]) -> str:
    """The text of a mapping with these entries, which leave out the headers that are ignored."""
    headers = ", ".join(map(_quoted, ignored))
    head = [f"ignore = [{headers}]"] if headers else []
    return (
        HEAD.format(printable(linkage))
        + "\n".join([*head, *(line for entry in entries for line in ("", *entry))])
        + "\n"
    )


def column_lines(header: str, meaning: Meaning | None, reason: str, correction: Correction) -> list[str]:
    """The lines of a mapping about one column: its header and what it means.

    A unit that is not known is left to be filled in, what is not judged is a comment.
    """
    lines = ["[[column]]", f"header = {_quoted(header)}"]
    if meaning is None or reason:
        return [f"# not judged: {printable(reason)}", *(f"# {line}" for line in (*lines, 'signal = ""', 'unit = ""'))]
    unit = _quoted(meaning.printed) if meaning.printed else '""  # fill in'
    own = correction_keys(correction, meaning.unit.factor if meaning.unit else 1.0)
    return [*lines, f"signal = {_quoted(meaning.signal)}", f"unit = {unit}", *own]


def _quoted(text: str) -> str:
    """A TOML string."""
    return json.dumps(printable(text), ensure_ascii=False).replace("\x7f", "\\u007f")


def with_proposals(text: str, proposals: Mapping[str, Correction], units: Mapping[str, float]) -> str:
    """A mapping with corrections that are not agreed to yet, by the names of signals, as comments to take away.

    ``units`` are the SI values of the units in which their offsets are written.
    """
    for signal, correction in proposals.items():
        lines = "".join(
            f"\n# {line}  # estimated: remove the first # to accept"
            for line in correction_keys(correction, units.get(signal, 1.0), 9)
        )
        pattern = rf"(?m)^(signal = {re.escape(_quoted(signal))}\nunit = .*)$"
        text = re.sub(pattern, lambda entry, added=lines: entry[1] + added, text)  # type: ignore[misc]
    return text


@dataclass
class _ReadColumn:
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

    def with_meaning(self, table: ResultTable | None = None) -> list[tuple[_ReadColumn, Meaning]]:
        """The columns of a table, or of all tables, that have a meaning, each with it."""
        every = [column for column in self.columns if table is None or column.table is table]
        return [(column, column.meaning) for column in every if column.meaning is not None]

    def mapping_needed(self, message: str) -> MappingNeededError:
        """The error to raise where the user must decide, with a mapping of everything recognised."""
        return MappingNeededError(message, self.mapping_text())

    def mapping_text(self) -> str:
        """A mapping of everything recognised."""
        every = [column for column in self.columns if not self.mapping.ignores(column.column)]
        entries = {
            column.column.header: column_lines(column.column.header, column.meaning, column.reason, column.correction)
            for column in every
        }
        ignored = dict.fromkeys(column.column.header for column in self.columns if self.mapping.ignores(column.column))
        return format_mapping(self.recognition.linkage.name, entries.values(), ignored)

    def _read(self, table: ResultTable, column: Column) -> _ReadColumn:
        """A column with its meaning and correction, or the reason why it has none."""
        if self.mapping.ignores(column):
            return _ReadColumn(table, column, reason="the mapping ignores it")
        try:
            meaning, correction = self.mapping.meaning(self.recognition, column)
        except NotJudgedError as reason:
            return _ReadColumn(table, column, reason=str(reason))
        if meaning.unit is None and table.is_si:
            signal, assumption = meaning.signal, "no unit: in SI units, as Modelica writes it"
            assumption = "; ".join(filter(None, (assumption, meaning.assumption)))
            meaning = Meaning(signal, self.recognition.unit(signal), self.recognition.si_unit_name(signal), assumption)
        return _ReadColumn(table, column, meaning, correction)

    def _axis(self, table: ResultTable) -> _ReadColumn | None:
        """The axis of a table: time, else the crank angle; None where no column has a meaning."""
        every = self.with_meaning(table)
        axes = [column for name in (TIME, "phi") for column, meaning in every if meaning.signal == name]
        if every and not axes:
            raise self.mapping_needed(
                f"{table.file}:{table.line}: expected a column of time or crank angle, got "
                f"{listed(column.header for column in table.columns)}; name its column in a mapping, with "
                f'signal = "{TIME}", or export it as well'
            )
        return axes[0] if axes else None

    def refuse_duplicates(self) -> None:
        """Refuse two columns for one signal or axis; one that names the signal goes before one taken for it."""
        seen: dict[tuple[str, int], _ReadColumn] = {}
        for column, meaning in self.with_meaning():
            axis = self.axes[id(column.table)]
            is_axis = axis is not None and axis.meaning is not None and axis.meaning.signal == meaning.signal
            place = (meaning.signal, id(column.table) if is_axis else 0)
            before = seen.setdefault(place, column)
            if before is column or before.meaning is None:
                continue
            if is_axis or bool(before.meaning.assumption) == bool(meaning.assumption):
                raise self.mapping_needed(
                    f"expected one column for {meaning.signal}, got '{shortened(before.column.header)}' "
                    f"({before.column.place}) and '{shortened(column.column.header)}' ({column.column.place}); "
                    "name one in a mapping, and the other under ignore"
                )
            weaker, seen[place] = (column, before) if meaning.assumption else (before, column)
            weaker.meaning, weaker.reason = None, f"'{shortened(seen[place].column.header)}' names {meaning.signal}"

    def ask_for_units(self) -> None:
        """Ask for the units that neither header nor tool states."""
        without = [(column, meaning) for column, meaning in self.with_meaning() if meaning.unit is None]
        for first, meaning in without[:1]:
            more = f" and {len(without) - 1} more" if len(without) > 1 else ""
            raise self.mapping_needed(
                f"{first.column.place}: expected a unit of {meaning.signal} in the header "
                f"'{shortened(first.column.header)}'{more}, got none; fill in "
                f'unit = "{self.recognition.si_unit_name(meaning.signal)}", or what it is, in a mapping'
            )

    def signals(self, table: ResultTable) -> Iterator[ImportedSignal]:
        """The signals of a table in SI units, corrected."""
        axis = self.axes[id(table)]
        if axis is None or axis.meaning is None:
            return
        name: Axis = "time" if axis.meaning.signal == TIME else "phi"
        rows, repeated = _distinct_rows(axis.column, name)
        at, sharpness = axis.in_si()
        at = at + axis.correction.time_shift if name == "time" else at
        axis_assumption = f"{name}: {axis.meaning.assumption}" if axis.meaning.assumption else ""
        for column, meaning in self.with_meaning(table):
            if column is axis:
                continue
            row = () if axis.meaning.assumption == meaning.assumption else (axis_assumption,)
            assumption = "; ".join(filter(None, (meaning.assumption, *row, repeated)))
            values, resolution = column.in_si()
            yield ImportedSignal(
                meaning.signal, name, at[rows] + column.correction.time_shift, values[rows], resolution[rows],
                replace(column.column, unit=meaning.printed), sharpness[rows], assumption,
            )  # fmt: skip


def read_results(
    paths: Sequence[Path], linkage: Linkage, mapping: Path | None = None, encoding: str = ""
) -> ImportedResults:
    """The signals in result files, with the corrections of the mapping applied.

    Texts are UTF-8, UTF-16 with its mark, or in the ``encoding`` that is named. Raises LinkproofError with
    file and line for what cannot be read, and MappingNeededError, which has a mapping to fill in, where only the user
    can tell what a column is.
    """
    tables = number_headers(table for path in dict.fromkeys(paths) for table in result_tables(Path(path), encoding))
    if not tables:
        raise LinkproofError("expected at least one file of results, got none; name the files")
    agreed = read_mapping(mapping) if mapping else ColumnMapping()
    agreed.check(column.header for table in tables for column in table.columns)
    reading = _Reading(linkage, agreed, tables)
    reading.refuse_duplicates()
    reading.ask_for_units()
    signals = [signal for table in tables for signal in reading.signals(table)]
    not_judged = tuple((entry.column, entry.reason) for entry in reading.columns if entry.reason)
    if not signals:
        column, reason = not_judged[0] if not_judged else (tables[0].columns[0], "it is an axis")
        raise reading.mapping_needed(
            f"{tables[0].file}:{tables[0].line}: expected a column that is a signal of {printable(linkage.name)}, got "
            f"none: '{shortened(column.header)}' is not judged, since {reason}; name the columns in a mapping"
        )
    corrections = {
        m.signal: entry.correction for entry, m in reading.with_meaning() if entry.correction != Correction()
    }
    units = {m.signal: m.unit.factor for _, m in reading.with_meaning() if m.unit}
    return ImportedResults(tuple(signals), not_judged, corrections, reading.mapping_text(), units)


def _distinct_rows(column: Column, name: Axis) -> tuple[NDArray[np.intp], str]:
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
