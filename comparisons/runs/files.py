"""Writing files so that nothing is ever half-written: to a neighbour first, then renamed into place.

What stands at a path and is no file of its own is never replaced: a link is followed, a pipe or a device written into.
"""

from __future__ import annotations

import errno
import os
import shutil
import stat
import tempfile
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from analytic.errors import LinkproofError


class Claim:
    """The sole right to write to a folder, kept by every process that holds one; nothing where the system cannot."""

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
        found = _CLAIMS.get(place) or Claim(place)
    except BlockingIOError as error:
        raise LinkproofError(
            f"another linkproof command is writing to '{folder}': wait until it ends, or choose another folder"
        ) from error
    except OSError as error:
        raise _cannot_write(folder, error) from error
    _CLAIMS[place] = found
    return found


def write_text(path: Path, text: str) -> None:
    """Replace a file by this text in one step."""
    write_file(path, lambda target: target.write_text(text, encoding="utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Replace a file by these bytes in one step."""
    write_file(path, lambda target: target.write_bytes(data))


def check_writable(path: Path) -> None:
    """Raise LinkproofError now, rather than after an hour's work, if a file could not be written at ``path``."""
    is_stream, folders = _is_stream(path), Path(os.path.realpath(path)).parents
    nearest = path if is_stream else next(folder for folder in folders if folder.exists())
    if path.is_dir() or not (is_stream or nearest.is_dir()) or not os.access(nearest, os.W_OK):
        raise LinkproofError(
            f"cannot write '{path}': expected a file in a folder that can be written; give another place"
        )


def write_file(path: Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a file of its own, then rename it to ``path``, or copy it into a pipe or device there.

    Raises LinkproofError if it cannot.
    """
    is_stream, place = _is_stream(path), Path(os.path.realpath(path))
    with writing(path):
        if not is_stream:
            place.parent.mkdir(parents=True, exist_ok=True)
        beside = None if is_stream else place.parent
        handle, name = tempfile.mkstemp(dir=beside, prefix=f".{path.name}.", suffix=path.suffix)
        os.close(handle)
        temporary = Path(name)
        try:
            write(temporary)
            if is_stream:
                with temporary.open("rb") as source, os.fdopen(_opened(path), "wb") as target:
                    shutil.copyfileobj(source, target)
            else:
                temporary.chmod(0o644)
                os.replace(temporary, place)
        finally:
            temporary.unlink(missing_ok=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Raise LinkproofError where what is done inside cannot write at a path."""
    try:
        yield
    except OSError as error:
        raise _cannot_write(path, error) from error


def _is_stream(path: Path) -> bool:
    """Whether what stands at a path is written into: neither a file nor a folder, or where this process prints."""
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise _cannot_write(path, error) from error
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)) or _printed_to(path) is not None


def _printed_to(path: Path) -> int | None:
    """The standard stream that a path leads to, as /dev/stdout does."""
    for stream in (1, 2):
        with suppress(OSError):  # it may be closed
            if os.path.samestat(path.stat(), os.fstat(stream)):
                return stream
    return None


def _opened(path: Path) -> int:
    """A descriptor of a pipe or device; a pipe that nobody reads is an OSError, where a shell would wait for ever."""
    stream = _printed_to(path)
    if stream is not None:
        return os.dup(stream)
    at_once = getattr(os, "O_NONBLOCK", 0)  # POSIX only
    try:
        handle = os.open(path, os.O_WRONLY | at_once)
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise OSError(error.errno, "nobody reads from it") from error
        raise
    if at_once:
        os.set_blocking(handle, True)
    return handle


def _cannot_write(path: Path, error: OSError) -> LinkproofError:
    return LinkproofError(f"cannot write '{path}': {error.strerror}; give a place that can be written")
