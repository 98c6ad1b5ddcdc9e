"""A result file as text: the encodings of tools and spreadsheets; and how large a file may be."""

from __future__ import annotations

import codecs
import re
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError, printable

# Bytes of a file, or of what is packed in it, and its numbers: what is read takes less than a GiB of memory.
LARGEST: Final = 1 << 27
MOST_NUMBERS: Final = 10_000_000
BYTE_ORDER_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
# Three letters beyond ASCII in a row: a Cyrillic word in cp1251, while those of cp1252 stand among plain letters.
CYRILLIC: Final = re.compile(rb"[\xa5\xaa\xaf\xb2-\xb4\xba\xbf-\xff]{3}")
CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
# Signs that spreadsheets and text processors print for plain ones.
PLAIN_SIGNS: Final = {"−": "-", "–": "-", "\u00a0": " ", "\u202f": " ", "\u2009": " ", "“": '"', "”": '"'}


@dataclass(frozen=True)
class ResultText:
    """The text of a result file and what messages call the file."""

    name: str
    text: str

    def fail(self, line: int, message: str) -> LinkproofError:
        """The error to raise about a line; ``message`` states the expectation, the content, and the remedy."""
        return LinkproofError(f"{self.name}:{line}: {message}")


def read_text(path: Path, expected: str = "a text file of results, such as a CSV") -> ResultText:
    """The text of a file; raises LinkproofError if it is not readable text."""
    check_file(path, f"expected {expected}")
    content, name = path.read_bytes(), printable(str(path))
    encoding = next(
        (encoding for mark, encoding in BYTE_ORDER_MARKS if content.startswith(mark)), None
    ) or _guess_encoding(content)
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
        raise LinkproofError(f"{name}:{line}: expected {expected}, got a binary file; export the results as CSV")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if not text.isascii():  # sign by sign is faster than str.translate, by far
        for sign, simple in PLAIN_SIGNS.items():
            text = text.replace(sign, simple)
    return ResultText(name, text)


def check_file(path: Path, expected: str) -> None:
    """Raise LinkproofError for a path that is no file that can be read, or one that is too large."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):  # a pipe would wait for whoever writes into it
            kind = "folder" if path.is_dir() else "pipe or device"
            raise LinkproofError(f"{expected}, got the {kind} '{path}'; give a file")
        if status.st_size > LARGEST:
            raise LinkproofError(
                f"{expected} of at most {LARGEST >> 20} MB, got '{path}' of {status.st_size >> 20} MB; export fewer "
                "columns or a coarser step"
            )
        path.open("rb").close()
    except (OSError, ValueError) as error:  # a name with a zero character is a ValueError
        reason = getattr(error, "strerror", None) or "no file can have this name"
        raise LinkproofError(f"{expected}, got '{path}' ({reason}); check the path") from error


def _guess_encoding(content: bytes) -> str:
    """The encoding of bytes without a byte order mark: UTF-8, else Windows' of Western or of Cyrillic letters."""
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1251" if CYRILLIC.search(content) else "cp1252"
    return "utf-8"
