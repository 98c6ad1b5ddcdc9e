"""Writing files so that nothing is ever half-written: to a neighbour first, then renamed; and claiming a folder.

A link is followed; what stands at a path and is no file, a pipe or a device, is refused.
"""

from __future__ import annotations

import os
import stat
import weakref
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final
from zlib import crc32

from analytic.errors import LinkproofError

STORE: Final = "linkproof.sqlite"  # all results of a folder
# What linkproof writes into a folder.
ENTRIES: Final = (
    STORE, f"{STORE}-journal", "index.html", "bench.html", "stress.html", "RESULTS.md", "assets", "data", "figures",
    "mechanisms",
)  # fmt: skip


class Claim:
    """An exclusive lock on writing to a folder, across processes; without effect where the system has no file locks."""

    def __init__(self, folder: Path) -> None:
        """Lock a folder until this object is deleted; raises OSError if it is locked. No lock on Windows."""
        try:
            import fcntl  # noqa: PLC0415  POSIX only
        except ImportError:
            return
        handle = os.open(folder, os.O_RDONLY)
        weakref.finalize(self, os.close, handle)
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


_CLAIMS: weakref.WeakValueDictionary[Path, Claim] = weakref.WeakValueDictionary()


def claim(folder: Path) -> Claim:
    """Keep other commands out of a results folder, created if missing, as long as the returned claim lives.

    Within this process a claim that lives is shared. Raises LinkproofError where another process has claimed it, and
    for a path that is no results folder or cannot be made one.
    """
    check_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        place = folder.resolve()
        result = _CLAIMS.get(place) or Claim(place)
    except BlockingIOError as error:
        raise LinkproofError(
            f"another linkproof command is writing to '{folder}': wait until it ends, or choose another folder"
        ) from error
    except OSError as error:
        raise _write_error(folder, error.strerror) from error
    _CLAIMS[place] = result
    return result


def check_folder(folder: Path) -> None:
    """Raise LinkproofError for a path that is neither a results folder nor free to be one, as a missing one is.

    What has a name of ``ENTRIES`` in it, and what is beneath, are files and folders: it may come from a stranger, and
    what a link leads to is neither read, written nor removed. Other names are not looked at.
    """
    try:
        if not stat.S_ISDIR(folder.stat().st_mode):
            raise LinkproofError(f"expected a folder, got '{folder}', which is none; give another place")
        for name in ENTRIES:
            _check_tree(folder / name)
    except FileNotFoundError:
        return
    except OSError as error:
        raise _write_error(folder, error.strerror) from error


def _check_tree(place: Path) -> None:
    """Raise LinkproofError for a link, pipe or device at a place or beneath it; a missing place is fine.

    Raises OSError where it cannot be looked at.
    """
    with suppress(FileNotFoundError):
        mode = place.lstat().st_mode
        if stat.S_ISDIR(mode):
            for entry in place.iterdir():
                _check_tree(entry)
        elif not stat.S_ISREG(mode):
            what = "a link" if stat.S_ISLNK(mode) else "a pipe or a device"
            raise LinkproofError(f"'{place}' is {what}, which a results folder does not have: remove it first")


def check_writable(path: Path) -> None:
    """Raise LinkproofError at once, not after an hour's work, if no file can be written at ``path``.

    Nothing is written; folders on the way to it may be missing.
    """
    nearest = next(folder for folder in _final_path(path).parents if os.path.exists(folder))
    if not nearest.is_dir() or not os.access(nearest, os.W_OK):
        raise _write_error(path)


def write_file(path: Path, content: str | bytes | Callable[[Path], object]) -> None:
    """Write a file whole or not at all, by renaming a filled neighbour; raises LinkproofError if it cannot.

    A text is written in UTF-8; a function is called with the path to write to, and what it raises passes, an OSError as
    LinkproofError. Missing folders are made; a file that is replaced leaves its permissions. A neighbour that a killed
    process left is overwritten by the next write.
    """
    place = _final_path(path)
    temporary = place.with_name(f".{crc32(os.fsencode(place.name)):08x}{place.suffix[:16]}")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        temporary.unlink(missing_ok=True)  # a link there is not followed
        try:
            if callable(content):
                content(temporary)
            else:
                temporary.write_bytes(content if isinstance(content, bytes) else content.encode())
            if place.exists():  # its permissions stay
                temporary.chmod(stat.S_IMODE(place.stat().st_mode))
            os.replace(temporary, place)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise _write_error(path, error.strerror) from error


def _final_path(path: Path) -> Path:
    """The file to write once links are followed, which may not exist yet.

    Raises LinkproofError if it is something else or may not be written.
    """
    if "\0" in str(path):
        raise _write_error(path)
    place = Path(os.path.realpath(path))
    try:
        is_file = stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return place
    except OSError as error:  # a link to itself, a name that is too long
        raise _write_error(path, error.strerror) from error
    if not is_file or not os.access(path, os.W_OK):  # one that is kept from being written is not replaced
        raise _write_error(path)
    return place


def _write_error(path: Path, why: str | None = "expected a file in a folder that can be written") -> LinkproofError:
    """The LinkproofError for a path that cannot be written, with the reason ``why``, to raise."""
    return LinkproofError(f"cannot write '{path}': {why}; give another place")
