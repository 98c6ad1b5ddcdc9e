"""Reading the files that a user names: regular files of a sensible size, or links to them, and nothing else.

A pipe would wait for whoever writes into it, and a device may never end.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError

LARGEST_TEXT: Final = 1 << 22  # bytes of a file that a person writes, such as a linkage
REASONS: Final = {
    errno.ENOENT: "does not exist; check the path",
    errno.ENOTDIR: "does not exist; check the path",
    errno.ELOOP: "is a link that leads to itself; name a file",
    errno.ENAMETOOLONG: "has a longer name than a file can have; check the path",
    errno.EACCES: "you have no permission to read; change its permissions",
}


def read_file(path: Path, expected: str, largest: int = LARGEST_TEXT) -> bytes:
    """The content of a regular file of at most ``largest`` bytes.

    Raises LinkproofError, which says what was ``expected``, for a path that is none, is larger or cannot be read.
    """
    check_file(path, expected, largest)
    try:
        with path.open("rb") as file:
            content = file.read(largest + 1)
        fault = _size_fault(len(content), largest)  # one in /proc has no size
    except OSError as error:
        fault = _reason(error)
    if fault is not None:
        raise _error(path, expected, fault)
    return content


def check_file(path: Path, expected: str, largest: int = LARGEST_TEXT) -> None:
    """Raise LinkproofError unless a path is a readable regular file of at most ``largest`` bytes.

    The message says what was ``expected``.
    """
    fault = file_fault(path, largest)
    if fault is not None:
        raise _error(path, expected, fault)


def _error(path: Path, expected: str, fault: str) -> LinkproofError:
    """The error, not raised, for a path that is not what was ``expected``; ``fault`` ends its sentence."""
    return LinkproofError(f"expected {expected}, got '{path}', which {fault}")


def file_fault(path: Path, largest: int = LARGEST_TEXT) -> str | None:
    """The fault of a path as the end of a sentence, after "which", with the remedy.

    None for a readable regular file of at most ``largest`` bytes.
    """
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        return _reason(error)
    if stat.S_ISDIR(status.st_mode):
        return "is a folder; name a file"
    if not stat.S_ISREG(status.st_mode):
        return "is a pipe or a device; name a file"
    return _size_fault(status.st_size, largest) if os.access(path, os.R_OK) else REASONS[errno.EACCES]


def _reason(error: OSError | ValueError) -> str:
    """The reason why a path cannot be used, as the end of a sentence, after "which".

    A null character in it raises a ValueError.
    """
    if isinstance(error, ValueError):
        return REASONS[errno.ENOENT]
    return REASONS.get(error.errno or 0, f"cannot be read ({error.strerror}); check the path")


def _size_fault(size: int, largest: int) -> str | None:
    """The fault of a file of ``size`` bytes, as the end of a sentence; None if at most ``largest`` bytes."""
    return f"has more than {largest >> 20} MB; give a smaller one" if size > largest else None
