"""The parts of a report as data; ``terminal``, ``markdown`` and ``html`` write them."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from reports.document.templates import FOLDER

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing


@dataclass(frozen=True)
class PageLink:
    """A link: ``href`` is a path within the report's folder, "#key" on the page, or an address."""

    text: str
    href: str


@dataclass(frozen=True)
class Mono:
    """A command or a file's name, in the typeface of code."""

    text: str


Inline = str | PageLink | Mono
Words = Inline | tuple[Inline, ...]


def as_text(words: Words) -> str:
    """Words as plain text, links by their text."""
    if isinstance(words, tuple):
        return "".join(map(as_text, words))
    return words if isinstance(words, str) else words.text


@dataclass(frozen=True)
class Paragraph:
    """A paragraph; ``role`` is its purpose, ``colour`` a style of the terminal."""

    words: Words
    role: Literal["", "lead", "verdict", "small", "banner"] = ""
    colour: str = ""


@dataclass(frozen=True)
class Bullets:
    """A list without an order."""

    items: tuple[Words, ...]


@dataclass(frozen=True)
class Facts:
    """Names and values."""

    rows: tuple[tuple[str, Words], ...]


@dataclass(frozen=True)
class Command:
    """Commands, a line each, for a reader to copy."""

    text: str


@dataclass(frozen=True)
class TableCell:
    """A cell of a table with more than words.

    ``style`` is a class of the style sheet, ``colour`` a style of the terminal, ``note`` small print beneath,
    ``tooltip`` a sentence under the pointer, ``span`` the number of columns.
    """

    words: Words
    style: str = ""
    colour: str = ""
    note: str = ""
    tooltip: str = ""
    span: int = 1


@dataclass(frozen=True)
class Table:
    """A table with a sentence before it and a note in small print after it.

    ``align`` has a letter per column, "l" for words and "r" for figures; the last letter holds for all that follow.
    ``groups`` are heads over several columns, (words, columns) each, all columns of them together; ``style`` is a class
    of the style sheet.
    """

    caption: str
    head: Sequence[TableCell | Words]
    rows: Sequence[Sequence[TableCell | Words]]
    align: str = "lr"
    note: str = ""
    groups: tuple[tuple[str, int], ...] = ()
    style: str = ""

    def side(self, column: int) -> str:
        """The letter of the alignment of a column, by its number: "l" or "r"."""
        return self.align[min(column, len(self.align) - 1)]


@dataclass(frozen=True)
class PageFigure:
    """A figure, written as a file beside the page: ``name`` is that of its file, unique on the page.

    ``alt`` is for a reader without pictures; ``drawing``, called when the page is written, returns the figure.
    """

    name: str
    caption: Words
    alt: str
    drawing: Callable[[], Drawing]


@dataclass(frozen=True)
class JavaScript:
    """An expression of a page's script, made of numbers and operations alone."""

    text: str


@dataclass(frozen=True)
class Widget:
    """An interactive part of a page: ``kind`` names its script, ``label`` describes it for a reader.

    ``data`` is JSON-ready (no number that is not finite) and on the page; each of ``further`` is a file of its own,
    loaded when it is chosen, JSON-ready too or a script's text: ``name`` and keys are plain file names. ``instead`` is
    in its place where no script runs.
    """

    kind: str
    name: str
    label: str
    data: Mapping[str, Any]
    further: Mapping[str, Mapping[str, Any] | str] = field(default_factory=dict)
    instead: tuple[Part, ...] = ()


@dataclass(frozen=True)
class Fold:
    """Parts behind a line that opens them."""

    summary: str
    parts: tuple[Part, ...]
    is_open: bool = False


@dataclass(frozen=True)
class Card:
    """A box among others: a heading, which may lead to a page of its own, and parts under it."""

    heading: Words
    parts: tuple[Part, ...]


@dataclass(frozen=True)
class Cards:
    """Boxes beside each other, as many as the width allows; two if they are ``wide``."""

    cards: tuple[Card, ...]
    wide: bool = False


@dataclass(frozen=True)
class FigureGroup:
    """Figures in two columns, those that are wide across both."""

    figures: tuple[PageFigure, ...]


@dataclass(frozen=True)
class Section:
    """Parts under a heading; ``key`` is its anchor. A section inside another has a smaller heading."""

    key: str
    heading: str
    parts: tuple[Part, ...]


Part = Paragraph | Bullets | Facts | Command | Table | PageFigure | FigureGroup | Widget | Fold | Cards | Section


@dataclass(frozen=True)
class Page:
    """A page: ``file`` is its path within the report's folder, ``parts`` are before the first section.

    ``title`` names it in the browser and in the links of the other pages; ``charts``: it needs Plotly. A page that
    follows a file has the file's ``state``.
    """

    file: str
    title: str
    heading: str
    subtitle: Words
    parts: tuple[Part, ...]
    sections: tuple[Section, ...]
    charts: bool = False
    state: str = ""


# Verdicts as a reader sees them: a sign, a word and a colour; sign and word have the meaning without the colour.


class VerdictSign(NamedTuple):
    """The sign of a verdict: ``symbol`` and ``word``; ``style`` is a class of the page's style sheet.

    ``colour`` is a colour of the terminal.
    """

    symbol: str
    word: str
    style: str
    colour: str


TABLES = tomllib.loads((FOLDER / "signs.toml").read_text(encoding="utf-8"))
RUNS: Mapping[str, VerdictSign] = {verdict: VerdictSign(*row) for verdict, row in TABLES["runs"].items()}
PUBLISHED: Mapping[str, VerdictSign] = {verdict: VerdictSign(*row) for verdict, row in TABLES["published"].items()}
