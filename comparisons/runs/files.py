"""Writing files so that nothing is ever half-written: to a neighbour first, then renamed into place.

A link is followed; what stands at a path and is no file, a pipe or a device, is refused.
"""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final
from uuid import uuid4

from analytic.errors import LinkproofError

_OPEN_FILES: Final = Path("/proc/self/fd")  # a file without a name has one there


class Claim:
    """An exclusive lock on writing to a folder, across processes; without effect where the system has no file locks."""

    def __init__(self, folder: Path) -> None:
        try:
            import fcntl  # noqa: PLC0415  POSIX only
        except ImportError:
            return
        handle = os.open(folder, os.O_RDONLY)
        weakref.finalize(self, os.close, handle)
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


_CLAIMS: weakref.WeakValueDictionary[Path, Claim] = weakref.WeakValueDictionary()


def claim(folder: Path) -> Claim:
    """Keep other commands out of a folder, made if need be, as long as the claim lives.

    Raises LinkproofError where another process has claimed it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        place = folder.resolve()
        result = _CLAIMS.get(place) or Claim(place)
    except BlockingIOError as error:
        raise LinkproofError(
            f"another linkproof command is writing to '{folder}': wait until it ends, or choose another folder"
        ) from error
    except OSError as error:
        raise _write_error(folder, error) from error
    _CLAIMS[place] = result
    return result


def write_text(path: Path, text: str) -> None:
    """Replace a file by this text in one step."""
    write_file(path, lambda target: target.write_text(text, encoding="utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Replace a file by these bytes in one step."""
    write_file(path, lambda target: target.write_bytes(data))


def check_writable(path: Path) -> None:
    """Raise LinkproofError now, rather than after an hour's work, if a file could not be written at ``path``."""
    nearest = next(folder for folder in _final_path(path).parents if folder.exists())
    if not nearest.is_dir() or not os.access(nearest, os.W_OK):
        raise _no_file_error(path)


def write_file(path: Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a file of its own, then rename it to ``path``; raises LinkproofError if it cannot."""
    place = _final_path(path)
    with writing(path):
        place.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = _open_nameless_file(place.parent), _temporary_path(place)
        try:
            target = temporary if handle is None else _OPEN_FILES / str(handle)
            write(target)
            target.chmod(0o644)
            if handle is not None:
                os.link(target, temporary, src_dir_fd=handle)  # given a folder, it follows links
            os.replace(temporary, place)
        finally:
            temporary.unlink(missing_ok=True)
            if handle is not None:
                os.close(handle)


def _open_nameless_file(folder: Path) -> int | None:
    """A new file without a name, which vanishes if the process is killed; None where the system has no such files."""
    if not _OPEN_FILES.is_dir() or not hasattr(os, "O_TMPFILE"):
        return None
    try:
        return os.open(folder, os.O_TMPFILE | os.O_RDWR)
    except OSError:  # a file system without them
        return None


def _temporary_path(place: Path) -> Path:
    """A name in the same folder that nothing has."""
    return place.with_name(f".{place.name}.{uuid4().hex}{place.suffix}")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn errors of writing to a path into LinkproofError."""
    try:
        yield
    except OSError as error:
        raise _write_error(path, error) from error


def _final_path(path: Path) -> Path:
    """The path of a file to write, at the end of its links; raises LinkproofError if something else is there."""
    place = Path(os.path.realpath(path))
    if place.is_symlink() or (os.path.exists(path) and not os.path.isfile(path)):  # the first is a loop
        raise _no_file_error(path)
    return place


def _no_file_error(path: Path) -> LinkproofError:
    return LinkproofError(f"cannot write '{path}': expected a file in a folder that can be written; give another place")


def _write_error(path: Path, error: OSError) -> LinkproofError:
    return LinkproofError(f"cannot write '{path}': {error.strerror}; give a place that can be written")
