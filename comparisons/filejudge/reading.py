"""Result files of a tool that cannot be called, as signals of the linkage, and what the user says of their columns.

Nothing is guessed that would change a verdict unseen: a column that may be two things is not judged, and a unit that no
header and no convention gives must be named; assumptions are written beside the signal.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError, listed, printable, shortened
from analytic.numerics.arrays import Array
from comparisons.filejudge.columns import TIME, Axis, Column, Correction, ImportedResults, ImportedSignal, ResultTable
from comparisons.filejudge.headers import UNITS_BY_NAME, HeaderParser, Meaning, NotJudgedError, parse_unit
from comparisons.filejudge.tables import number_headers, read_text, result_tables

FEWEST: Final = 4  # instants of a curve
NOTHING: Final = Correction()

ENTRIES: Final = 'COLUMN=SIGNAL [UNIT], such as "Motor Torque12=-Mkr [N*mm]"'
_NUMBER: Final = r"\d*\.?\d+(?:[eE][+-]?\d{1,2})?"
SAID: Final = re.compile(
    rf"(?P<sign>-?)\s*(?:(?P<factor>{_NUMBER})\s*\*\s*)?(?P<signal>[^\[\]@]*?)\s*"
    rf"(?:\[(?P<unit>[^\]]*)\]\s*(?P<offset>[+-]\s*{_NUMBER})?)?\s*(?:@\s*(?P<shift>[+-]?\s*{_NUMBER})\s*s)?"
)


@dataclass(frozen=True)
class MapEntry:
    """What the user says of a column: its signal, its unit ("" for the header's), and a correction in that unit.

    No ``signal`` leaves the column out; ``text`` is the entry as written, ``COLUMN=-2*SIGNAL [UNIT] + 5 @ 0.1 s``.
    """

    text: str
    signal: str
    unit: str
    correction: Correction

    def fail(self, message: str) -> LinkproofError:
        """The LinkproofError about the entry, for the caller to raise."""
        return LinkproofError(f"--map '{shortened(self.text)}': {message}")

    def meaning(self, parser: HeaderParser, column: Column) -> tuple[Meaning, Correction]:
        """The column's meaning and its correction, in SI; raises LinkproofError for an unknown signal or unit.

        The meaning has no unit where neither the entry nor the header states one that measures the signal.
        """
        if self.signal not in (TIME, *parser.signals):
            raise self.fail(str(UnknownNameError("signal", self.signal, (TIME, *parser.signals))))
        si, unit = parser.unit(self.signal).dimension, parse_unit(self.unit)
        if self.unit and not (unit and unit.measures(si)):
            names = [name for name, unit in UNITS_BY_NAME.items() if unit.dimension == si and name.isascii()]
            known = [parser.si_unit_name(self.signal), *names]
            raise self.fail(str(UnknownNameError(f"unit of {self.signal}", self.unit, known)))
        meaning = parser.in_stated_unit(self.signal, replace(column, unit=self.unit or column.unit))
        factor = meaning.unit.factor if meaning.unit else 1.0
        return meaning, replace(self.correction, offset=self.correction.offset * factor)


def map_entries(given: Iterable[str], headers: Iterable[str]) -> dict[str, MapEntry]:
    """The entries by their columns' headers, as ``_comparable``; one without "=" names a file with an entry per line.

    An entry is an equation, ``COLUMN=SIGNAL [UNIT]``: the column is ``sign factor signal + offset`` at its time +
    shift; the entry's correction undoes this. Raises LinkproofError for a text that is no equation, a header that no
    column has, two entries for one column, and a file that cannot be read.
    """
    known, entries = {_comparable(header) for header in headers}, dict[str, MapEntry]()
    for text in (line for one in given for line in _lines(one)):
        header, _, said = text.rpartition("=")
        match = SAID.fullmatch(said.strip())
        if not (header and match) or (match["factor"] and float(match["factor"]) <= 0.0):
            raise LinkproofError(f"--map: expected {ENTRIES}, got '{shortened(text)}'; correct it")
        number = {key: float((match[key] or "0").replace(" ", "")) for key in ("offset", "shift")}
        factor, sign = float(match["factor"] or 1.0), -1 if match["sign"] else 1
        correction = Correction(sign, 1.0 / factor, number["shift"], -sign * number["offset"] / factor)
        entry, header = MapEntry(text, match["signal"], match["unit"] or "", correction), _comparable(header)
        if header not in known:
            raise entry.fail(str(UnknownNameError("column", header, known)))
        if header in entries:
            raise entry.fail("expected one entry for a column, got two; leave one out")
        entries[header] = entry
    return entries


def _lines(given: str) -> list[str]:
    """The entries of one ``--map``: its own text, or without "=" the lines of the file that it names, but blank ones.

    Raises LinkproofError for a file that cannot be read.
    """
    if "=" in given:
        return [given]
    return [*filter(str.strip, read_text(Path(given), expected=f"{ENTRIES}, or a file of such lines").text.split("\n"))]


def _comparable(header: str) -> str:
    """A header as it is compared with those that a user types: control characters escaped, without outer spaces."""
    return printable(header).strip()


@dataclass
class _ReadColumn:
    """A column of a table: its ``meaning``, in a unit of the SI value ``factor``; or None and the ``reason``."""

    table: ResultTable
    column: Column
    meaning: Meaning | None
    factor: float = 1.0
    correction: Correction = NOTHING
    reason: str = ""

    def in_si(self) -> tuple[Array, Array]:
        """Values in SI units, corrected but for the time's shift, and their resolution, each (n,)."""
        scale = self.correction.factor * self.factor
        values = self.correction.sign * scale * self.column.values + self.correction.offset
        return values, scale * self.column.resolution


class _Reading:
    """State of reading result files: tables, meanings, and columns without one."""

    def __init__(self, linkage: Linkage, tables: Sequence[ResultTable], said: Iterable[str]) -> None:
        """Read every column of the tables and choose each table's axis; ``said`` is as for ``map_entries``.

        Raises LinkproofError for wrong entries, a column without a unit, a table without an axis, and duplicates.
        """
        self.parser = HeaderParser(linkage)
        self.entries = map_entries(said, (column.header for table in tables for column in table.columns))
        self.columns = [self._read(table, column) for table in tables for column in table.columns]
        self.axes = {id(table): self._axis(table) for table in tables}
        self._refuse_duplicates()

    def with_meaning(self, table: ResultTable | None = None) -> list[tuple[_ReadColumn, Meaning]]:
        """The columns of a table, or of all tables, that have a meaning, each with it."""
        every = [column for column in self.columns if table is None or column.table is table]
        return [(column, column.meaning) for column in every if column.meaning is not None]

    def _read(self, table: ResultTable, column: Column) -> _ReadColumn:
        """A column with its meaning and correction, or with the reason why it has none.

        Raises LinkproofError for a meaning without a unit, and for an entry with an unknown signal or unit.
        """
        entry, correction, header = self.entries.get(_comparable(column.header)), NOTHING, shortened(column.header)
        if entry is not None and not entry.signal:
            return _ReadColumn(table, column, None, reason="--map leaves it out")
        try:
            if entry is None:
                meaning = self.parser.meaning(column)
            else:
                meaning, correction = entry.meaning(self.parser, column)
        except NotJudgedError as reason:
            return _ReadColumn(table, column, None, reason=str(reason))
        unit, si = meaning.unit, self.parser.si_unit_name(meaning.signal)
        if unit is None and table.is_si:
            words = "; ".join(filter(None, ("no unit: in SI units, as Modelica writes it", meaning.assumption)))
            unit, meaning = self.parser.unit(meaning.signal), replace(meaning, printed=si, assumption=words)
        if unit is None:
            raise LinkproofError(
                f"{column.place}: expected a unit of {meaning.signal} in the header '{header}', got none; add it with "
                f'--map "{header}={meaning.signal} [{si}]", or what it is'
            )
        return _ReadColumn(table, column, meaning, unit.factor, correction)

    def _axis(self, table: ResultTable) -> tuple[_ReadColumn, Meaning] | None:
        """The axis of a table with its meaning: time, else the crank angle; None for a table without any meaning.

        Raises LinkproofError for a table that has signals but no axis.
        """
        every = self.with_meaning(table)
        axes = [pair for name in (TIME, "phi") for pair in every if pair[1].signal == name]
        if every and not axes:
            raise LinkproofError(
                f"{table.file}:{table.line}: expected a column of time or crank angle, got "
                f'{listed(column.header for column in table.columns)}; name it with --map "COLUMN={TIME} [s]", or '
                "export it as well"
            )
        return axes[0] if axes else None

    def _refuse_duplicates(self) -> None:
        """Raise LinkproofError for two columns of one signal, or of one table's axis.

        If only one of two for a signal is guessed, it loses its meaning instead.
        """
        seen: dict[tuple[str, int], tuple[_ReadColumn, Meaning]] = {}
        for column, meaning in sorted(self.with_meaning(), key=lambda pair: bool(pair[1].assumption)):
            axis = self.axes[id(column.table)]
            is_axis = axis is not None and axis[1].signal == meaning.signal
            place = (meaning.signal, id(column.table) if is_axis else 0)
            before, known = seen.setdefault(place, (column, meaning))
            if before is column:
                continue
            if is_axis or bool(known.assumption) == bool(meaning.assumption):
                raise LinkproofError(
                    f"expected one column for {meaning.signal}, got '{shortened(before.column.header)}' "
                    f"({before.column.place}) and '{shortened(column.column.header)}' ({column.column.place}); "
                    f'leave one out with --map "{shortened(column.column.header)}="'
                )
            column.meaning, column.reason = None, f"'{shortened(before.column.header)}' names {meaning.signal}"

    def signals(self, table: ResultTable) -> Iterator[ImportedSignal]:
        """Yield the signals of a table, corrected and in SI, over its axis; none for a table without an axis.

        Raises LinkproofError for an axis that turns back or has too few instants.
        """
        pair = self.axes[id(table)]
        if pair is None:
            return
        axis, meant = pair
        name: Axis = "time" if meant.signal == TIME else "phi"
        rows, repeated = _distinct_rows(axis.column, name)
        at, sharpness = axis.in_si()
        at = at + axis.correction.time_shift if name == "time" else at
        for column, meaning in self.with_meaning(table):
            if column is axis:
                continue
            of_axis = f"{name}: {meant.assumption}" if meant.assumption not in ("", meaning.assumption) else ""
            assumption = "; ".join(filter(None, (meaning.assumption, of_axis, repeated)))
            values, resolution = column.in_si()
            yield ImportedSignal(
                meaning.signal, at[rows] + column.correction.time_shift, values[rows], resolution[rows],
                sharpness[rows], name, replace(column.column, unit=meaning.printed), column.factor, assumption,
            )  # fmt: skip


def read_results(
    paths: Sequence[Path], linkage: Linkage, said: Iterable[str] = (), encoding: str = ""
) -> ImportedResults:
    """The signals in result files, by their headers and by what is ``said`` of columns (see ``map_entries``).

    A file named twice is read once. Texts are UTF-8, UTF-16 with its mark, or in the ``encoding`` that is named. Raises
    LinkproofError with file and line for what cannot be read, and for what only the user can tell.
    """
    tables = number_headers(table for path in dict.fromkeys(paths) for table in result_tables(Path(path), encoding))
    if not tables:
        raise LinkproofError("expected at least one file of results, got none; name the files")
    reading = _Reading(linkage, tables, said)
    signals = [signal for table in tables for signal in reading.signals(table)]
    not_judged = tuple((entry.column, entry.reason) for entry in reading.columns if entry.reason)
    if not signals:
        column, reason = not_judged[0] if not_judged else (tables[0].columns[0], "it is an axis")
        raise LinkproofError(
            f"{tables[0].file}:{tables[0].line}: expected a column that is a signal of {printable(linkage.name)}, got "
            f"none: '{shortened(column.header)}' is not judged, since {reason}; name the columns with --map {ENTRIES}"
        )
    every = reading.with_meaning()
    corrections = {m.signal: entry.correction for entry, m in every if entry.correction != NOTHING}
    read = tuple((m.signal, replace(entry.column, unit=m.printed), entry.factor, m.assumption) for entry, m in every)
    return ImportedResults(tuple(signals), not_judged, corrections, read)


def _distinct_rows(column: Column, name: Axis) -> tuple[NDArray[np.intp], str]:
    """Indices of the rows with instants of their own, the last of equal ones, and words on rows left out, "" for none.

    Tools write an instant twice where an event changes the motion. Raises LinkproofError for an axis that turns back,
    or has fewer than FEWEST instants.
    """
    steps, what = np.diff(column.values), f"{column.place}: expected"
    is_backward = name == "phi" and len(steps) and column.values[-1] < column.values[0]
    back = np.flatnonzero(steps > 0.0 if is_backward else steps < 0.0)
    if len(back):
        row = int(back[0])
        expected = "a time that grows" if name == "time" else "a crank angle that runs one way"
        cure = "export one run a file, its rows in order" if name == "time" else "export the time beside it"
        raise LinkproofError(
            f"{what} {expected} in '{shortened(column.header)}', got {column.values[row + 1]:g} after "
            f"{column.values[row]:g} (row {row + 2} of the table); {cure}"
        )
    rows = np.flatnonzero(np.append(steps != 0.0, True))
    if len(rows) < FEWEST:
        raise LinkproofError(
            f"{what} a curve of at least {FEWEST} instants, got {len(rows)}; export more steps of the run"
        )
    left_out = len(column.values) - len(rows)
    return rows, f"of instants written more than once the last is taken ({left_out} left out)" if left_out else ""
