"""Result files of other tools as tables of columns: texts, workbooks, MATLAB files, results of Adams.

A table is rows of numbers below a line of headers, which has a cell for each column; a row of units may stand between.
Lines of anything else above the headers are left out. Workbooks and Adams' steps are read as texts, too.
"""

from __future__ import annotations

import codecs
import csv
import io
import math
import re
import zipfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Any, Final, NamedTuple, NoReturn, TypeVar
from xml.etree import ElementTree

import numpy as np
import pandas
from numpy.typing import NDArray

from analytic.errors import LinkproofError, printable, shortened
from analytic.files import check_file, read_file
from analytic.numerics.arrays import Array
from comparisons.filejudge.columns import Column, ResultTable
from comparisons.filejudge.headers import parse_unit
from comparisons.trials.runs.run_engine import Lost, RunBounds
from comparisons.trials.runs.workers import LocalPool, most_processes

EXPECTED: Final = "a file of results, such as a CSV"
LARGEST: Final = 1 << 27  # bytes of a file, and of what is packed in it
MOST_NUMBERS: Final = 10_000_000  # of a file
MOST_COLUMNS: Final = 10_000
MOST_LINES: Final = 5000  # of text, headers among them
# Of a number: squares of larger ones are beyond all numbers. What is smaller than 1 over it is 0.
LARGEST_NUMBER: Final = 1e100
READER: Final = RunBounds(60.0, 1 << 30)  # of the process that reads a workbook or a MATLAB file

R = TypeVar("R")

CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
# Signs that spreadsheets and text processors print for plain ones.
PLAIN_SIGNS: Final = {"−": "-", "–": "-", "\u00a0": " ", "\u202f": " ", "\u2009": " ", "“": '"', "”": '"'}
# A line with anything but numbers; its first part cannot give back what it took, so a search is linear.
TEXT_LINE: Final = re.compile(r"^[0-9eEdD+\-.,; \t\"]*+[^0-9eEdD+\-.,; \t\"\n].*$", re.MULTILINE)
FIRST_ROW: Final = re.compile(r"^.*[0-9]", re.MULTILINE)
COMMENT: Final = re.compile(r"\s*(?:[#%!*]+|//+)\s*")
BLANK: Final = r"\s+"
BETWEEN_BLANKS: Final = re.compile(r"[^,\s]\s+[^,\s]")
QUOTED: Final = re.compile(r'"[^"]*"')
QUOTED_COMMA: Final = re.compile(r'"[+-]?\d+,\d')
NUMBER: Final = re.compile(r"[+-]?(?=\.?[0-9])([0-9]*+)\.?([0-9]*+)(?:[eE]([+-]?[0-9]{1,3}))?")
NOT_FINITE: Final = re.compile(r"[+-]?(?:nan|n/?a|null|none|inf|infinity|∞|1\.#\w+|#\w+[!/?]?\w*[!?]?)", re.IGNORECASE)
SAMPLE: Final = 300  # rows whose digits are counted
MOST_DIGITS: Final = 17  # of a double
LONGEST_ROW: Final = 1 << 17  # characters of a row that are looked at one by one
# Modelica tools, FMU and Simscape exports print names of variables, which may be elements of arrays, and no units.
MODELICA_NAME: Final = re.compile(r"[^()\[\]/ ]+(?:\[[\d,]+\])?")
STEPS_WITHOUT_INSTANT: Final = ("input", "output")  # types of Adams' steps that are no instants of the motion
TRAJECTORY: Final = ("Aclass", "name", "dataInfo", "data_2")
MATLAB_KINDS: Final = {"double", "single", "char", *(f"{sign}int{n}" for sign in ("", "u") for n in (8, 16, 32, 64))}


@dataclass(frozen=True)
class ResultText:
    """The text of a result file, and what messages call the file."""

    name: str
    text: str

    def fail(self, line: int, message: str) -> LinkproofError:
        """The LinkproofError about a line, for the caller to raise."""
        return LinkproofError(f"{self.name}:{line}: {message}")


def result_tables(path: Path, encoding: str = "") -> list[ResultTable]:
    """Every table of a file in its order, as its suffix says: MATLAB, a workbook, or else a text or results of Adams.

    Tables of a single column are left out. ``encoding`` is that of a text, if the user names one. Raises
    LinkproofError, with file and line, for a file without a table, or that cannot be read.
    """
    kind, name = path.suffix.lower(), printable(str(path))
    if kind == ".mat":
        every = _read_isolated(_matlab_tables, path)
    elif kind in (".xlsx", ".xlsm"):
        sheets = _read_isolated(_workbook_texts, path)
        every = [table for sheet, text in sheets for table in _text_tables(ResultText(f"{name}[{sheet}]", text))]
    else:
        file = read_text(path, encoding)
        is_adams = file.text.lstrip().startswith("<") and "<Results" in file.text[:2000]
        every = [_adams_table(file)] if is_adams else [*_text_tables(file)]
    every = [table for table in every if len(table.columns) > 1]
    if not every:
        raise LinkproofError(
            f"{name}: expected rows of numbers below a header, a column of time or crank angle and others beside it, "
            "got none; export the results with their values"
        )
    return every


def read_text(path: Path, encoding: str = "", expected: str = EXPECTED) -> ResultText:
    """The text of a file in UTF-8, UTF-16 with its mark, or the ``encoding`` that the user names.

    Line ends become line feeds, and typographic signs plain ones. ``expected`` says in messages what the file should
    be. Raises LinkproofError for a file that cannot be read or is too large, an unknown encoding, other bytes and a
    binary file.
    """
    content, name = read_file(path, expected, LARGEST), printable(str(path))
    is_wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    encoding = encoding or ("utf-16" if is_wide else "utf-8-sig")
    try:
        text = content.decode(encoding)
    except LookupError:
        raise LinkproofError(
            f"--encoding: expected the name of an encoding, such as cp1252, got '{shortened(encoding)}'; correct it"
        ) from None
    except UnicodeError as error:
        line = content.count(b"\n", 0, getattr(error, "start", 0)) + 1
        raise LinkproofError(
            f"{name}:{line}: expected text in {encoding.removesuffix('-sig').upper()}, got other bytes; name its "
            "encoding with --encoding, such as cp1252 (Western) or cp1251 (Cyrillic)"
        ) from error
    control = CONTROL.search(text)
    if control:
        line = text.count("\n", 0, control.start()) + 1
        raise LinkproofError(f"{name}:{line}: expected {expected}, got a binary file; export the results as CSV")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if not text.isascii():  # sign by sign is faster than str.translate, by far
        for sign, simple in PLAIN_SIGNS.items():
            text = text.replace(sign, simple)
    return ResultText(name, text)


# Texts: blocks of rows of numbers, and the lines of text between them.


class _Part(NamedTuple):
    """Lines of a text from one on, counted from 1: rows of numbers, or a line of anything else."""

    line: int
    text: str
    is_rows: bool


class _Header(NamedTuple):
    """The name and the unit of every column, "" for none, on a line counted from 1."""

    line: int
    names: Sequence[str]
    units: Sequence[str]


class _Signs(NamedTuple):
    """What parts the cells of a row, BLANK for any blanks, and the decimal sign."""

    delimiter: str
    decimal: str

    def cells(self, row: str) -> list[str]:
        """The cells of a row, quotes taken away, decimal commas turned into points."""
        cells = row.replace('"', "").split() if self.delimiter == BLANK else _split_cells(row, self.delimiter)
        return [cell.replace(",", ".") for cell in cells] if self.decimal == "," else cells


def _split_cells(row: str, delimiter: str) -> list[str]:
    """The cells of a row's first LONGEST_ROW characters between delimiters, without quotes and outer spaces.

    Blanks inside a cell become one space.
    """
    cells = next(csv.reader([row[:LONGEST_ROW]], delimiter=delimiter, skipinitialspace=True), [])
    return [" ".join(cell.split()) for cell in cells]


def _find_signs(row: str, text: str) -> _Signs:
    """The delimiter and decimal sign of a text, from its first ``row`` of numbers and from the ``text`` of all rows."""
    bare = QUOTED.sub("0", row.strip(" "))
    delimiter = next((sign for sign in "\t;" if sign in bare), "")
    delimiter = delimiter or (BLANK if BETWEEN_BLANKS.search(bare) or "," not in bare else ",")
    has_commas = QUOTED_COMMA.search(text) if delimiter == "," else "," in text
    return _Signs(delimiter, "," if has_commas else ".")


def _is_number(cell: str) -> bool:
    """Whether a cell is a number below LARGEST_NUMBER in magnitude, its decimal sign, if it has one, a point."""
    return bool(NUMBER.fullmatch(cell)) and abs(float(cell)) < LARGEST_NUMBER


def _text_tables(file: ResultText) -> Iterator[ResultTable]:
    """Yield the tables of a text; numbers alone, without a line above them, have columns without names.

    Raises LinkproofError, with file and line, for rows that are spoilt or lack a header, and for too many lines,
    columns or numbers.
    """
    above: list[_Part] = []  # lines of text since the last rows of numbers
    lines, numbers, width, signs = 0, 0, 0, _Signs(",", ".")
    for part in _parts(file.text):
        if not part.is_rows:
            above.append(part)
            lines += 1
            if lines > MOST_LINES:
                _refuse_spoilt_rows(file, above[:SAMPLE], signs, width)
                raise file.fail(part.line, f"expected at most {MOST_LINES} lines of text, got more; leave them out")
            continue
        row = part.text.partition("\n")[0]
        cells = 1 + max(map(row.count, ",;\t "))  # at most
        numbers += cells * part.text.count("\n")
        if cells > MOST_COLUMNS or numbers > MOST_NUMBERS:
            raise file.fail(
                part.line, f"expected at most {MOST_COLUMNS} columns and {MOST_NUMBERS} numbers, got more; export fewer"
            )
        signs = _find_signs(row, part.text)
        first = signs.cells(row)
        header = _Header(part.line, [""] * len(first), [""] * len(first))
        if above or width:
            header = _find_header(file, above, signs, first, part.line)
        above, width = [], len(first)
        yield _read_rows(file, part, signs, header)
    if width:
        _refuse_spoilt_rows(file, above, signs, width)


def _parts(text: str) -> Iterator[_Part]:
    """Yield the blocks of rows, each beginning with a number, and the lines of text between them, in order.

    Excel's line ``sep=`` is left out.
    """
    start, line = 0, 1
    for words in chain(TEXT_LINE.finditer(text), [None]):
        end = words.start() if words else len(text)
        rows = FIRST_ROW.search(text, start, end)
        if rows:
            yield _Part(line + text.count("\n", start, rows.start()), text[rows.start() : end].rstrip(), True)
        line += text.count("\n", start, end)
        if words is not None and not words.group().startswith("sep="):  # Excel's own line
            yield _Part(line, words.group(), False)
        start = words.end() if words else end


def _find_header(file: ResultText, above: Sequence[_Part], signs: _Signs, first: Sequence[str], at: int) -> _Header:
    """The last of the lines ``above`` the ``first`` row that has a header for every column, with units.

    Units are those of a row of units below it, if there is one. ``at`` is the line of the first row. Raises
    LinkproofError without such a line, or for a row of numbers that is spoilt.
    """
    fitting = []
    filled = max((number for number, cell in enumerate(first, start=1) if cell), default=0)
    for line, text, _ in above:
        for cells in _header_cells(text, signs):
            names = " ".join(cells).split() and [*cells, *[""] * (len(first) - len(cells))]
            if filled <= len(cells) and len(names) == len(first) and not any(map(_is_value, cells)):
                fitting.append(_Header(line, names, [""] * len(first)))
                break
    _refuse_spoilt_rows(
        file, [part for part in above if not fitting or part.line > fitting[-1].line], signs, len(first)
    )
    if not fitting:
        line, text = (above[-1].line, above[-1].text) if above else (at, "")
        raise file.fail(
            line,
            f"expected a header for each of the {len(first)} columns of line {at}, got '{shortened(text)}'; check "
            "delimiters and decimal signs (with decimal commas columns are parted by semicolons or tabs), or leave "
            "this line out",
        )
    units = [cell.strip("[](){} ") for cell in fitting[-1].names]
    if fitting[-2:-1] and fitting[-2].line == fitting[-1].line - 1 and all(parse_unit(u) for u in units if u):
        return fitting[-2]._replace(units=units)
    return fitting[-1]


def _header_cells(line: str, signs: _Signs) -> Iterator[list[str]]:
    """Yield ways to divide a line of headers into cells, the likeliest first; a comment's sign is dropped."""
    line = COMMENT.sub("", line, count=1) if COMMENT.match(line) else line
    for delimiter in dict.fromkeys((signs.delimiter, "\t", ";", ",")):
        if delimiter != BLANK and delimiter in line:
            yield _split_cells(line, delimiter)
    if signs.delimiter in (BLANK, "\t"):
        yield [cell.strip('"') for cell in re.split(r"\s{2,}|\t+", line.strip())]
        yield [" ".join((quoted or bare).split()) for quoted, bare in re.findall(r'"([^"]*)"|(\S+)', line)]


def _is_value(cell: str) -> bool:
    """Whether a stripped cell is a number with a point, finite or not, or words for a missing one, such as ``n/a``.

    An empty cell is none.
    """
    return bool(NUMBER.fullmatch(cell) or NOT_FINITE.fullmatch(cell))


def _refuse_spoilt_rows(file: ResultText, lines: Sequence[_Part], signs: _Signs, width: int) -> None:
    """Raise LinkproofError, with file and line, for a line that is a row of ``width`` cells, one of which is no number.

    A row has a number in some cell and is no comment; all other lines pass.
    """
    for number, text, _ in lines:
        cells = signs.cells(text)
        if len(cells) == width and any(map(_is_value, cells)) and not COMMENT.match(text):
            _check_row(file, number, cells, cells)


def _read_rows(file: ResultText, part: _Part, signs: _Signs, header: _Header) -> ResultTable:
    """The table of a block of rows; raises LinkproofError, with file and line, for a row that is none.

    Rows and columns that are empty throughout are left out, and columns that repeat the first one, with its header or
    none: Adams writes the time beside every curve. Tiny numbers become 0.
    """
    text = part.text.replace("D", "e").replace("d", "e")  # Fortran writes exponents with a D
    form: Any = {"sep": signs.delimiter, "decimal": signs.decimal, "header": None, "skipinitialspace": True}
    try:
        frame = pandas.read_csv(io.StringIO(text), dtype=float, skip_blank_lines=False, **form)
        frame = frame.dropna(how="all").dropna(how="all", axis="columns")
        numbers = frame.to_numpy()
        is_read = frame.shape[1] > 0 and len(frame.columns) <= len(header.names)
        is_read &= bool((np.abs(numbers) < LARGEST_NUMBER).all())
    except ValueError:  # of pandas' own, all of them
        is_read = False
    if not is_read:
        _refuse_rows(file, part, signs)
    numbers = np.where(np.abs(numbers) < 1.0 / LARGEST_NUMBER, 0.0, numbers)
    rows = text.split("\n")
    sample = [signs.cells(row) for row in rows[:: max(1, len(rows) // SAMPLE)] if row.strip()]
    columns: list[Column] = []
    for place, values in zip(frame.columns, numbers.T, strict=True):
        name, unit = header.names[place], header.units[place]
        axis = columns[0] if columns else None
        if axis and axis.header and name in ("", axis.header) and np.array_equal(values, axis.values):
            continue
        printed = [cells[place] for cells in sample if len(cells) > place]
        where = f"{file.name}:{header.line} (column {place + 1})"
        columns.append(Column(name, unit, values, resolution(values, printed), where))
    is_si = columns[0].header == "time" and all(MODELICA_NAME.fullmatch(c.header) and not c.unit for c in columns)
    return ResultTable(file.name, header.line, is_si, tuple(columns))


def _refuse_rows(file: ResultText, part: _Part, signs: _Signs) -> NoReturn:
    """Raise LinkproofError, with file and line, for the first row of a block that is no row of numbers.

    If none is found, for the block.
    """
    rows = part.text.replace("D", "e").replace("d", "e").split("\n")
    first = signs.cells(rows[0])
    for number, row in enumerate(rows, start=part.line):
        cells = signs.cells(row)
        if any(cells):
            _check_row(file, number, cells, first)
    raise file.fail(part.line, "expected rows of numbers, got others; export the results again")


def _check_row(file: ResultText, line: int, cells: Sequence[str], first: Sequence[str]) -> None:
    """Raise LinkproofError for a row with another number of cells than the ``first``, or with no finite number in one.

    It has the file and the ``line``. A cell may be empty where that of the first row is.
    """
    if len(cells) != len(first):
        raise file.fail(
            line,
            f"expected {len(first)} columns, as in the first row of the table, got {len(cells)}; complete the row, or "
            "give every table a header of its own",
        )
    for number, (cell, usual) in enumerate(zip(cells, first, strict=True), start=1):
        if not _is_number(cell) and (cell or usual):
            found = f"'{shortened(cell)}'" if cell else "an empty cell"
            raise file.fail(
                line,
                f"expected a finite number in column {number}, got {found}; export that stretch of the run again, "
                "without signs between thousands, or leave the row or the column out",
            )


def resolution(values: Array, words: Sequence[str]) -> Array:
    """Half a unit of the last digit of each number of a column (n,), some of which are printed as ``words``.

    Where trailing zeros are left out, as by ``%g``, a short number is as sharp as the column's other numbers: it has
    their decimals or their number of digits, whichever is coarser. Without words numbers are as sharp as a double.
    """
    printed = [match.groups("") for word in words if (match := NUMBER.fullmatch(word))]
    decimals = max((len(part) - int(exponent or 0) for _, part, exponent in printed), default=MOST_DIGITS)
    digits = max((len((whole + part).lstrip("0")) for whole, part, _ in printed), default=MOST_DIGITS)
    with np.errstate(divide="ignore"):
        magnitude = np.where(values == 0.0, -np.inf, np.floor(np.log10(np.abs(values))))
    last = np.minimum(decimals, np.clip(digits, 1, MOST_DIGITS) - magnitude - 1.0)
    return np.asarray(0.5 * 10.0 ** -np.clip(last, -300, 300))


def number_headers(every: Iterable[ResultTable]) -> list[ResultTable]:
    """Copies of the tables with repeated headers numbered as in ``Torque #2``, so that a user can name each.

    The first column of a table, its axis, keeps its header. A column without a header becomes "column 2".
    """
    counts: Counter[str] = Counter()
    result = []
    for table in every:
        columns = []
        for number, column in enumerate(table.columns, start=1):
            header = column.header or f"column {number}"
            counts[header] += 1
            again = counts[header] if number > 1 else 1
            columns.append(replace(column, header=header if again == 1 else f"{header} #{again}"))
        result.append(replace(table, columns=tuple(columns)))
    return result


# Adams result files (``.res``): XML of schema xrf 2.0, as Adams/Solver and the solver in SolidWorks Motion write it.
#
# ``StepMap`` lists entities with their components, each with ``id`` and ``unitsValue``; a ``Step`` holds one instant,
# its numbers in the order of the ids.


def _adams_table(file: ResultText) -> ResultTable:
    """The steps of an Adams result file as a table, a row for each instant.

    Raises LinkproofError, with the file, and the line or in its place the step, for invalid XML and for steps that are
    no rows of numbers, one for each component.
    """
    names: dict[int, tuple[str, str]] = {}  # header and unit by id
    steps: list[str] = []
    entity = ""
    content = re.sub(r"^\s*<\?xml[^>]*\?>", "", file.text, count=1).encode("utf-8", "replace")
    try:
        for event, element in ElementTree.iterparse(io.BytesIO(content), ("start", "end")):
            tag = element.tag.rpartition("}")[2]
            if event == "start" and tag == "Entity":
                entity = printable(element.get("name", "")).removesuffix("_XFORM")
            elif event == "start" and tag == "Component":
                name = printable(element.get("name", ""))
                header = name if entity.lower() == name.lower() else f"{entity}.{name}"
                names[int(element.get("id", "")[:9])] = (header, element.get("unitsValue", ""))
            elif event == "end" and tag == "Step":
                if element.get("type") not in STEPS_WITHOUT_INSTANT:
                    steps.append("\t".join((element.text or "").split()))
                element.clear()
    except (ElementTree.ParseError, ValueError) as error:
        line = getattr(error, "position", (1,))[0]
        raise file.fail(line, f"expected valid XML of Adams, got another ({error}); export it again") from error
    tables = [*_text_tables(ResultText(f"{file.name}[steps]", "\n".join(steps)))]
    if len(tables) != 1 or len(tables[0].columns) != len(names):
        raise file.fail(1, f"expected {len(names)} numbers in every step, got another count; export the results again")
    every = zip(tables[0].columns, sorted(names.items()), strict=True)
    return replace(tables[0], columns=tuple(replace(c, header=header, unit=unit) for c, (_, (header, unit)) in every))


# Workbooks and MATLAB files, read in a process with bounds, which a damaged one may crash or fill its memory.


def _read_isolated(reader: Callable[[Path], R], path: Path) -> R:
    """The result of ``reader(path)``, run in another process within READER's bounds of time, s, and memory, bytes.

    Raises LinkproofError for a path that is no file, one that is too large, and for any failure there.
    """
    check_file(path, EXPECTED, LARGEST)
    processes = min(1, most_processes())
    results: list[tuple[int, R | str | Lost]] = [
        *LocalPool(processes).run(_result_or_words, [(reader, path)], bounds=READER)
    ]
    result = results[0][1]
    if isinstance(result, Lost | str):
        raise LinkproofError(
            f"{path}: expected a file of results, got one that cannot be read "
            f"({shortened(result if isinstance(result, str) else result.reason)}); export the results as CSV"
        )
    return result


def _result_or_words(reader: Callable[[Path], R], path: Path) -> R | str:
    """The result of ``reader(path)``, or the error that it raised, in words; a MemoryError is raised."""
    try:
        return reader(path)
    except MemoryError:
        raise
    except Exception as error:  # errors of damaged zip, XML, cells and matrices have no common class
        return printable(" ".join(str(error).split())) or type(error).__name__


def _workbook_texts(path: Path) -> list[tuple[str, str]]:
    """Name and text of every sheet, a line for each row, cells parted by tabs.

    Raises ValueError if the workbook unpacks to over LARGEST, and errors of other classes for a damaged one.
    """
    with zipfile.ZipFile(path) as parts:
        size = sum(part.file_size for part in parts.infolist())
    if size > LARGEST:
        raise ValueError(f"it is packed, and has {size >> 20} MB, more than {LARGEST >> 20} MB")
    sheets = pandas.read_excel(path, sheet_name=None, header=None, dtype=str, na_filter=False, engine="openpyxl")
    plain = {name: sheet.replace(r"\s+", " ", regex=True) for name, sheet in sheets.items()}
    return [
        (printable(str(name)), "\n".join(map("\t".join, sheet.to_numpy().tolist()))) for name, sheet in plain.items()
    ]


def _matlab_tables(path: Path) -> list[ResultTable]:
    """A table for each length of curves in a MATLAB file; raises ValueError for one too large or not finite.

    It raises errors of other classes for a damaged file. The resolution of a number is the rounding of its type.
    OpenModelica and Dymola write trajectories as matrices ``Aclass``, ``name``, ``dataInfo``, ``data_1`` (what is
    constant) and ``data_2``, as they are or transposed (``Aclass[3]`` says which): ``dataInfo`` has for each name the
    matrix and the row, with a sign. Other curves are vectors and the columns of matrices.
    """
    from scipy.io import loadmat, whosmat  # noqa: PLC0415 - where one is read

    every = {name: math.prod(shape) for name, shape, kind in whosmat(path) if kind in MATLAB_KINDS}
    if sum(every.values()) > MOST_NUMBERS:
        raise ValueError(f"it has more than {MOST_NUMBERS} numbers")
    read = loadmat(path, variable_names=list(every), chars_as_strings=False)
    data = {name: read[name] for name in every if read[name].ndim == 2}
    curves: list[tuple[str, NDArray[Any]]] = []
    is_trajectory = all(key in data for key in TRAJECTORY)
    if is_trajectory:
        is_transposed = "".join(data["Aclass"][3]).strip("\0 ") == "binTrans"
        names, info, values = (data[key].T if is_transposed else data[key] for key in TRAJECTORY[1:])
        for name, (matrix, place, *_) in zip(names, info.astype(int), strict=True):
            if matrix in (0, 2) and place:
                curves.append(("".join(name).strip("\0 "), math.copysign(1.0, place) * values[:, abs(place) - 1]))
    for name, array in () if is_trajectory else data.items():
        columns = array if array.shape[0] == 1 else array.T
        if array.dtype.kind in "fiu" and array.size > 1:
            curves += [(f"{name}({n})" if len(columns) > 1 else name, c) for n, c in enumerate(columns, start=1)]
    tables: dict[int, list[Column]] = {}
    for header, array in curves:
        numbers = array.astype(float)
        if not (np.abs(numbers) < LARGEST_NUMBER).all():
            raise ValueError(f"expected finite numbers of '{header}', got others")
        sharp = np.finfo(array.dtype if array.dtype.kind == "f" else float).eps * np.abs(numbers)
        place = f"{printable(str(path))} ({printable(header)})"
        tables.setdefault(len(numbers), []).append(Column(header, "", numbers, sharp, place))
    return [ResultTable(printable(str(path)), 1, is_trajectory, tuple(columns)) for columns in tables.values()]
