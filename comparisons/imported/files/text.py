"""A result file as text: the encodings of tools and spreadsheets, and what is no text at all."""

from __future__ import annotations

import codecs
import re
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError, printable
from comparisons.imported.headers.units import parsed
from comparisons.imported.headers.words import TOKEN, known_parts, plain

LARGEST: Final = 1 << 29  # bytes of a file
# First bytes of files that are no text.
BINARY: Final = {
    b"PK\x03\x04": "an Excel workbook, a Simulink model or another zip archive",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook or a SolidWorks document",
    b"MATLAB 5.0 MAT": "a MATLAB file",
    b"\x89HDF": "an HDF5 or new MATLAB file",
    b"CDF\x01": "a netCDF file",
    b"CDF\x02": "a netCDF file",
    b"\x1f\x8b": "a compressed file",
    b"%PDF": "a PDF document",
    b"SQLite format 3": "a database",
}
MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
# Of a file that is not UTF-8 the encoding in which most of its words are known, the first of equals.
ENCODINGS: Final = ("cp1252", "cp1251", "cp1250", "gb18030", "shift_jis")
START: Final = 4096  # bytes looked at to tell an encoding
CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
# Signs that spreadsheets and text processors print for plain ones.
PLAIN: Final = {"−": "-", "–": "-", "\u00a0": " ", "\u202f": " ", "\u2009": " ", "“": '"', "”": '"'}


@dataclass(frozen=True)
class ResultText:
    """The text of a result file and what messages call the file."""

    name: str
    text: str

    def fail(self, line: int, message: str) -> LinkproofError:
        """The error to raise about a line; the message says what was expected, what was got, and the cure."""
        return LinkproofError(f"{self.name}:{line}: {message}")


def read_text(path: Path, wanted: str = "a text file of results, such as a CSV") -> ResultText:
    """The text of a file; raises LinkproofError for what is no readable text."""
    check_file(path, f"expected {wanted}")
    name = printable(str(path))
    text = decoded(path.read_bytes(), name).replace("\r\n", "\n").replace("\r", "\n")
    if not text.isascii():  # sign by sign is faster than str.translate, by far
        for sign, plain in PLAIN.items():
            text = text.replace(sign, plain)
    return ResultText(name, text)


def check_file(path: Path, wanted: str) -> None:
    """Raise LinkproofError for a path where no ordinary file can be read, or one that is too large."""
    try:
        if path.is_dir():
            raise LinkproofError(f"{wanted}, got the folder '{path}'; give a file")
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would wait for whoever writes into it
            raise LinkproofError(f"{wanted}, got '{path}', which is no ordinary file; give a file")
        size = path.stat().st_size
        if size > LARGEST:
            raise LinkproofError(
                f"{wanted} of at most {LARGEST >> 20} MB, got '{path}' of {size >> 20} MB; export fewer columns or a "
                "coarser step"
            )
        path.open("rb").close()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "a path that cannot be"
        raise LinkproofError(f"{wanted}, got '{path}' ({reason}); check the path") from error


def decoded(content: bytes, name: str) -> str:
    """The text of a file's bytes, by its byte-order mark, as UTF-8, or in the encoding of its country."""
    kind = next((kind for magic, kind in BINARY.items() if content.startswith(magic)), None)
    if kind:
        raise _not_text(name, kind)
    encoding = next((encoding for mark, encoding in MARKS if content.startswith(mark)), None)
    encoding = encoding or _without_mark(content, name)
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise LinkproofError(
            f"{name}:{line}: expected text in {encoding.removesuffix('-sig').upper()}, got other bytes; save it as "
            "UTF-8"
        ) from error
    control = CONTROL.search(text)
    if control:
        line = text.count("\n", 0, control.start()) + 1
        raise _not_text(f"{name}:{line}", "a control character")
    return text


def _not_text(place: str, kind: str) -> LinkproofError:
    return LinkproofError(f"{place}: expected a text file of results, got {kind}; export the results as CSV")


def _without_mark(content: bytes, name: str) -> str:
    """The encoding of bytes that begin with no mark."""
    start = content[:START]
    if b"\x00" in start:
        halves = (start[::2].count(0), start[1::2].count(0))
        if max(halves) < len(start) // 4:
            raise _not_text(f"{name}:1", "a binary file")
        return "utf-16-be" if halves[0] > halves[1] else "utf-16-le"
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return max(ENCODINGS, key=lambda encoding: _known_words(start, encoding))
    return "utf-8"


def _known_words(start: bytes, encoding: str) -> int:
    """How many words of the beginning of a file, in letters that are not English, mean something in an encoding."""
    tokens = TOKEN.findall(start.decode(encoding, "ignore"))
    foreign = dict.fromkeys(token for token in tokens if not token.isascii() and len(token) > 1)
    return sum(bool(known_parts(plain(token))) or parsed(token) is not None for token in foreign)
