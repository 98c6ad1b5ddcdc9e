"""Result files of a tool that cannot be called, as signals of the linkage.

Nothing is guessed that would change a verdict unseen: a column that may be two things is not judged, a unit that no
header and no convention gives must come from the mapping; assumptions are written beside the signal.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError, listed, printable, shortened
from comparisons.faults.fault import Correction
from comparisons.imported.columns import (
    NO_CORRECTION,
    TIME,
    Array,
    Axis,
    Column,
    ImportedResults,
    ImportedSignal,
    MappingNeededError,
    ResultTable,
)  # fmt: skip
from comparisons.imported.files.axes import check_curve, instants
from comparisons.imported.files.result_files import SI_TOOLS, result_tables
from comparisons.imported.headers.meaning import Meaning, NotJudgedError, Recognition
from comparisons.imported.headers.units import Unit
from comparisons.imported.mapping.agreement import Agreement
from comparisons.imported.mapping.mapping_file import Mapping, read_mapping
from comparisons.imported.mapping.writing import entry, mapping_text

AXES: Final = {TIME: "time", "phi": "crank angle"}


@dataclass
class _Judged:
    """A column with its meaning, or the reason why it has none."""

    table: ResultTable
    number: int  # of the table in its file, from 1
    column: Column
    meaning: Meaning | None = None
    correction: Correction = NO_CORRECTION
    reason: str = ""
    is_ignored: bool = False


@dataclass
class _Reading:
    """What is known of the columns while they are read."""

    recognition: Recognition
    mapping: Mapping
    columns: list[_Judged] = field(default_factory=list)

    @property
    def known(self) -> Iterator[tuple[_Judged, Meaning]]:
        """Columns that mean something."""
        for column in self.columns:
            if column.meaning is not None:
                yield column, column.meaning

    def of(self, table: ResultTable) -> list[tuple[_Judged, Meaning]]:
        """Columns of a table that mean something."""
        return [(column, meaning) for column, meaning in self.known if column.table is table]


def read_results(paths: Sequence[Path], linkage: Linkage, mapping: Path | None = None) -> ImportedResults:
    """The signals in result files, with the corrections of the mapping applied.

    Raises LinkproofError with file and line for what cannot be read, and MappingNeededError, which has a mapping to
    fill in, where only the user can tell what a column is.
    """
    numbered = [pair for path in dict.fromkeys(paths) for pair in enumerate(result_tables(Path(path)), start=1)]
    if not numbered:
        raise LinkproofError("expected at least one file of results, got none; name the files")
    reading = _Reading(Recognition(linkage), read_mapping(mapping) if mapping else Mapping())
    reading.mapping.check(numbered)
    agreement = Agreement(reading.recognition, reading.mapping)
    for number, table in numbered:
        reading.columns += [_judged(agreement, table, number, column) for column in table.columns]
    axes = {id(table): _axis(reading, table) for _, table in numbered}
    _refuse_twice(reading)
    _ask_for_units(reading)
    signals = [signal for _, table in numbered for signal in _signals(reading, table, axes[id(table)])]
    if not signals:
        raise _nothing(reading)
    corrections = {m.signal: c.correction for c, m in reading.known if c.correction != NO_CORRECTION}
    not_judged = tuple((c.column, c.reason) for c in reading.columns if c.reason)
    units = {m.signal: m.unit.factor for _, m in reading.known if m.unit}
    return ImportedResults(tuple(signals), not_judged, corrections, _text(reading), units)


def _judged(agreement: Agreement, table: ResultTable, number: int, column: Column) -> _Judged:
    if agreement.mapping.ignores(column):
        return _Judged(table, number, column, reason="the mapping ignores it", is_ignored=True)
    try:
        meaning, correction = agreement.meaning(column, table, number)
    except NotJudgedError as reason:
        return _Judged(table, number, column, reason=str(reason))
    except UnknownNameError as error:
        raise LinkproofError(f"{column.place}: {error}") from error
    if meaning.unit is None and table.tool in SI_TOOLS:
        unit = agreement.recognition.unit(meaning.signal)
        taken = "; ".join(filter(None, (f"no unit: in SI units, as {table.tool} writes it", meaning.taken)))
        meaning = Meaning(meaning.signal, unit, agreement.recognition.si(meaning.signal), taken)
    return _Judged(table, number, column, meaning, correction)


def _axis(reading: _Reading, table: ResultTable) -> _Judged | None:
    """The axis of a table: time, or the crank angle where there is none or the mapping says so."""
    found: dict[str, list[_Judged]] = defaultdict(list)
    for judged, meaning in reading.of(table):
        if meaning.signal in (TIME, "phi"):
            found[meaning.signal].append(judged)
    preferred = [reading.mapping.axis] if reading.mapping.axis else [TIME, "phi"]
    axis = next((found[name] for name in preferred if name in found), [])
    if len(axis) > 1:
        raise _twice(axis[0], axis[1], "the axis")
    if not axis:
        others = [judged for judged, _ in reading.of(table)]
        if others:
            raise MappingNeededError(
                f"{table.file}:{table.line}: expected a column of {' or '.join(AXES[name] for name in preferred)}, got "
                f"{listed(column.header for column in table.columns)}; name its column in a mapping, with signal = "
                f'"{preferred[0]}", or export it as well',
                _text(reading),
            )
        for judged in reading.columns:
            if judged.table is table and not judged.reason:
                judged.reason = "its table has no column of time or crank angle"
        return None
    if axis[0] not in found[TIME]:
        for other in found[TIME]:
            other.meaning, other.reason = None, "the mapping has the crank angle for the axis"
    return axis[0]


def _refuse_twice(reading: _Reading) -> None:
    """Refuse two columns for one signal; one that names it goes before one that was taken for it."""
    seen: dict[str, _Judged] = {}
    for judged, meaning in list(reading.known):
        before = seen.get(meaning.signal)
        if meaning.signal == TIME or _is_axis(reading, judged):
            continue
        if before is None or before.meaning is None:
            seen[meaning.signal] = judged
        elif bool(before.meaning.taken) == bool(meaning.taken):
            raise _twice(before, judged, meaning.signal, _text(reading))
        else:
            weaker, stronger = (judged, before) if meaning.taken else (before, judged)
            weaker.meaning = None
            weaker.reason = f"'{shortened(stronger.column.header)}' names {meaning.signal}"
            seen[meaning.signal] = stronger


def _is_axis(reading: _Reading, judged: _Judged) -> bool:
    """Whether the crank angle is the axis of its table, which several tables have."""
    others = reading.of(judged.table)
    return (
        judged.meaning is not None
        and judged.meaning.signal == "phi"
        and not any(meaning.signal == TIME for _, meaning in others)
    )


def _twice(one: _Judged, other: _Judged, name: str, text: str = "") -> LinkproofError:
    return MappingNeededError(
        f"expected one column for {name}, got '{shortened(one.column.header)}' ({one.column.place}) and "
        f"'{shortened(other.column.header)}' ({other.column.place}); name one in a mapping, and the "
        "other under ignore",
        text,
    )


def _ask_for_units(reading: _Reading) -> None:
    """Ask for the units that neither header nor tool states."""
    without = [(judged, meaning) for judged, meaning in reading.known if meaning.unit is None]
    if not without:
        return
    first, meaning = without[0]
    more = f" and {len(without) - 1} more" if len(without) > 1 else ""
    raise MappingNeededError(
        f"{first.column.place}: expected a unit of {meaning.signal} in the header '{shortened(first.column.header)}'"
        f'{more}, got none; fill in unit = "{reading.recognition.si(meaning.signal)}", or what it is, in a mapping',
        _text(reading),
    )


def _nothing(reading: _Reading) -> LinkproofError:
    judged = next((c for c in reading.columns if c.reason), reading.columns[0])
    reason = f"'{shortened(judged.column.header)}' is not judged, since {judged.reason}" if judged.reason else "an axis"
    return MappingNeededError(
        f"{judged.table.file}:{judged.table.line}: expected a column that is a signal of "
        f"{printable(reading.recognition.linkage.name)}, got none: {reason}; name the columns in a mapping",
        _text(reading),
    )


def _signals(reading: _Reading, table: ResultTable, axis: _Judged | None) -> Iterator[ImportedSignal]:
    """The signals of a table in SI units, corrected."""
    if axis is None or axis.meaning is None or axis.meaning.unit is None:
        return
    name: Axis = "time" if axis.meaning.signal == TIME else "phi"
    scale = axis.correction.sign * axis.correction.factor * axis.meaning.unit.factor
    offset = axis.correction.time_shift if name == "time" else axis.correction.offset
    kept, repeated = instants(axis.column, name)
    at, sharpness = axis.column.values * scale + offset, axis.column.resolution * abs(scale)
    for judged, meaning in reading.of(table):
        column = judged.column
        if judged is axis or meaning.unit is None:
            continue
        check_curve(column, axis.column)
        rows = kept[kept < len(column.values)]
        axis_taken = "" if axis.meaning.taken in ("", meaning.taken) else f"{name}: {axis.meaning.taken}"
        taken = "; ".join(filter(None, (meaning.taken, axis_taken, repeated)))
        values, resolution = _in_si(column, meaning.unit, judged.correction)
        yield ImportedSignal(
            meaning.signal, name, at[rows] + judged.correction.time_shift, values[rows], resolution[rows],
            replace(column, unit=meaning.printed), sharpness[rows], taken,
        )  # fmt: skip


def _in_si(column: Column, unit: Unit, correction: Correction) -> tuple[Array, Array]:
    scale = correction.factor * unit.factor
    return correction.sign * scale * column.values + correction.offset, scale * column.resolution


def _text(reading: _Reading) -> str:
    """A mapping that says all that was recognised."""
    headers = Counter(c.column.header for c in reading.columns)
    several = len({c.table.file for c in reading.columns}) > 1
    entries: dict[tuple[str, ...], list[str]] = {}
    for c in reading.columns:
        signal = c.meaning.signal if c.meaning else ""
        alone = headers[c.column.header] == 1 or signal in (TIME, "phi")
        name = Path(c.table.file).name if several else ""
        place: dict[str, str | int] = {} if alone else {"file": name, "table": c.number}
        if not c.is_ignored:
            key = (c.column.header, signal, "" if alone else c.column.place)
            entries.setdefault(key, entry(c.column.header, place, c.meaning, c.reason, c.correction))
    ignored = dict.fromkeys(c.column.header for c in reading.columns if c.is_ignored)
    return mapping_text(reading.recognition.linkage.name, reading.mapping.axis or "", entries.values(), ignored)
