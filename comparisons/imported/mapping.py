"""The mapping file: what columns mean and which corrections the user agrees to; read, checked and written (TOML)."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import Field

from analytic.description.diagnosis import Source
from analytic.description.loading import parse_document
from analytic.description.schema import Finite, Tables, TomlTable
from analytic.errors import DescriptionError, UnknownNameError, printable, shortened
from comparisons.faults.fault import Correction
from comparisons.imported.columns import TIME, Column, correction_keys
from comparisons.imported.encodings import read_text
from comparisons.imported.header_meaning import HeaderParser, Meaning, NotJudgedError
from comparisons.imported.header_words import UNITS_BY_NAME, parse_unit

LARGEST: Final = 1 << 20  # characters
HEAD: Final = """# Columns of result files as signals of {}: correct what is wrong, and give this file
# to judge with --mapping. Corrections that a [[column]] has are applied as they stand here, as
# the value sign * factor * value + offset (in the column's unit) at the time time + time_shift (s).
"""
Text = Annotated[str, Field(min_length=1)]


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
    file = read_text(path, "a mapping file (TOML)")
    if len(file.text) > LARGEST:
        raise file.fail(1, "expected a mapping of some lines, got more than a megabyte; give the mapping file")
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
