"""A mapping file read and held against the columns that there are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from analytic.description.diagnosis import Source, sentence
from analytic.description.loading import check_characters, tables
from analytic.errors import DescriptionError, UnknownNameError, printable, shortened
from comparisons.imported.columns import Axis, Column, ResultTable
from comparisons.imported.files.text import read_text
from comparisons.imported.mapping.schema import MappedColumn, MappingDocument

LARGEST: Final = 1 << 20  # characters


@dataclass(frozen=True)
class Mapping:
    """What the user agrees to, or nothing of it."""

    source: Source = field(default_factory=lambda: Source(""))
    document: MappingDocument = field(default_factory=MappingDocument)

    @property
    def axis(self) -> Axis | None:
        """The axis that was chosen, if any."""
        return self.document.axis

    def entry(self, column: Column, table: ResultTable, number: int) -> tuple[int, MappedColumn] | None:
        """The entry of a column of the table with a ``number`` in its file, and the entry's own number."""
        entries = [e for e in enumerate(self.document.column) if _means(e[1], column, table, number)]
        if len(entries) > 1:
            place = self.source.at(["column", str(entries[1][0])])
            raise DescriptionError(
                f"{place}: expected one [[column]] for '{shortened(column.header)}' ({column.place}), got two; leave "
                "one of them out, or tell them apart by file = ... and table = ..."
            )
        return entries[0] if entries else None

    def ignores(self, column: Column) -> bool:
        """Whether a column is not to be judged."""
        return printable(column.header).strip() in {header.strip() for header in self.document.ignore}

    def fail(self, entry: int, key: str, message: str) -> DescriptionError:
        """The error to raise about a key of an entry."""
        return DescriptionError(f"{self.source.at(['column', str(entry), key])}: {message}")

    def check(self, numbered: Sequence[tuple[int, ResultTable]]) -> None:
        """Refuse entries and headers that no column has."""
        columns = [(number, table, column) for number, table in numbered for column in table.columns]
        headers = {printable(column.header).strip() for _, _, column in columns}
        for keys, header in self._headers():
            if header.strip() not in headers:
                raise DescriptionError(f"{self.source.at(keys)}: {UnknownNameError('column', header, headers)}")
        for number, entry in enumerate(self.document.column):
            if not any(_means(entry, column, table, count) for count, table, column in columns):
                place = self.source.at(["column", str(number)])
                raise DescriptionError(
                    f"{place}: expected a column '{shortened(entry.header)}' in that file and table, got none there; "
                    "correct file = ... or table = ..."
                )

    def _headers(self) -> Iterator[tuple[list[str], str]]:
        for number, entry in enumerate(self.document.column):
            yield ["column", str(number), "header"], entry.header
        for number, header in enumerate(self.document.ignore):
            yield ["ignore", str(number)], header


def _means(entry: MappedColumn, column: Column, table: ResultTable, number: int) -> bool:
    return (
        entry.header.strip() == printable(column.header).strip()
        and entry.table in (None, number)
        and (entry.file is None or entry.file in (table.file, Path(table.file).name))
    )


def read_mapping(path: Path) -> Mapping:
    """Read a mapping; raises LinkproofError with file and line."""
    file = read_text(path, "a mapping file (TOML)")
    if len(file.text) > LARGEST:
        raise file.fail(1, "expected a mapping of some lines, got more than a megabyte; give the mapping file")
    if not file.text.strip():
        raise _names_nothing(file.name)
    raw = tables(file.text, file.name)
    source = Source(file.name, file.text)
    check_characters(raw, source)
    try:
        document = MappingDocument.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(sentence(error, source, MappingDocument)) from None
    if not document.column and not document.ignore and document.axis is None:
        raise _names_nothing(file.name)
    return Mapping(source, document)


def _names_nothing(name: str) -> DescriptionError:
    return DescriptionError(
        f'{name}:1: expected a mapping that names a column, such as [[column]] with header = "Torque", signal = "Mkr" '
        'and unit = "N*m", got one that names nothing; add a column, or leave the mapping out'
    )
