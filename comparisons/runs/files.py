"""Writing files so that nothing is ever half-written: to a neighbour first, then renamed into place."""

from __future__ import annotations

import os
import tempfile
import weakref
from collections.abc import Callable
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
            f"expected to be alone in '{folder}', got another command that still writes there: wait for it, or give "
            "another folder"
        ) from error
    except OSError as error:
        raise _cannot_write(folder, error) from error
    _CLAIMS[place] = found
    return found


def write_text(path: Path, text: str) -> None:
    """Replace a file by this text in one step."""
    write_file(path, lambda target: target.write_text(text, encoding="utf-8"))


def check_writable(path: Path) -> None:
    """Raise LinkproofError now, rather than after an hour's work, if a file could not be written at ``path``."""
    nearest = next(folder for folder in (path.parent, *path.parent.parents) if folder.exists())
    if path.is_dir() or not nearest.is_dir() or not os.access(nearest, os.W_OK):
        raise LinkproofError(
            f"cannot write '{path}': expected a file in a folder that can be written; give another place"
        )


def write_file(path: Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a neighbour of ``path``, then rename it into place; raises LinkproofError if it cannot."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
        os.close(handle)
    except OSError as error:
        raise _cannot_write(path, error) from error
    temporary = Path(name)
    try:
        write(temporary)
        temporary.chmod(0o644)
        os.replace(temporary, path)
    except OSError as error:
        raise _cannot_write(path, error) from error
    finally:
        temporary.unlink(missing_ok=True)


def _cannot_write(path: Path, error: OSError) -> LinkproofError:
    return LinkproofError(f"cannot write '{path}': {error.strerror}; give a place that can be written")
