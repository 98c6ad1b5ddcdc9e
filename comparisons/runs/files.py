"""Writing files so that nothing is ever half-written, to a neighbour first, then renamed; and records that only grow.

A link is followed; what stands at a path and is no file, a pipe or a device, is refused.

Records are only appended, so that a killed process loses no more than the record being written; only the position
of each record is in memory.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import shutil
import stat
import tempfile
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing.util import get_temp_dir
from pathlib import Path
from typing import IO, Any, Final
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError

STUDIES: Final = ("compare", "judge", "bench", "stress", "results")
# What linkproof writes into a folder.
ENTRIES: Final = (
    *STUDIES, *(f".{study}.{state}" for study in STUDIES for state in ("new", "old")), "unfinished", ".unfinished",
    "index.html", "bench.html", "stress.html", "RESULTS.md", "assets", "data", "figures", "mechanisms",
)  # fmt: skip
_OPEN_FILES: Final = Path("/proc/self/fd")  # a file without a name has one there

Array = NDArray[np.float64]

RECORDS: Final = "records.jsonl"
CURVES: Final = "curves.npy"  # doubles; a record's "curves" has the place of the first and the shape, by name
HEADER_SIZE: Final = 128  # bytes of NumPy's header, padded by it so that the number of doubles may grow
_SHOWN_BYTES: Final = 40  # bytes of a line in a message
_CHECKSUM: Final = ', "checksum": "'  # ends a line: of all before it and of the record's arrays


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
    """Keep other commands out of a results folder, made if need be, as long as the claim lives.

    Raises LinkproofError where another process has claimed it, and for what is no results folder.
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
        raise _write_error(folder, error) from error
    _CLAIMS[place] = result
    return result


def check_folder(folder: Path) -> None:
    """Raise LinkproofError for a path that is neither a results folder nor free to be one.

    Its entries, and what is beneath them, are files and folders: it may come from a stranger, and what a link leads to
    is neither read, written nor removed.
    """
    try:
        if not stat.S_ISDIR(folder.stat().st_mode):
            raise LinkproofError(f"expected a folder, got '{folder}', which is none; give another place")
        for name in ENTRIES:
            _check_tree(folder / name)
    except FileNotFoundError:
        return
    except OSError as error:
        raise _write_error(folder, error) from error


def _check_tree(place: Path) -> None:
    """Raise LinkproofError for a link, a pipe or a device at a place or beneath it; nothing need be there."""
    with suppress(FileNotFoundError):
        mode = place.lstat().st_mode
        if stat.S_ISDIR(mode):
            for entry in place.iterdir():
                _check_tree(entry)
        elif not stat.S_ISREG(mode):
            what = "a link" if stat.S_ISLNK(mode) else "a pipe or a device"
            raise LinkproofError(f"'{place}' is {what}, which a results folder does not have: remove it first")


def write_text(path: Path, text: str) -> None:
    """Replace a file by this text in one step."""
    write_file(path, lambda target: target.write_text(text, encoding="utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Replace a file by these bytes in one step."""
    write_file(path, lambda target: target.write_bytes(data))


def check_writable(path: Path) -> None:
    """Raise LinkproofError now, rather than after an hour's work, if a file could not be written at ``path``."""
    nearest = next(folder for folder in _final_path(path).parents if os.path.exists(folder))
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
    """A name in the same folder that nothing has, no longer than names may be."""
    return place.with_name(f".{uuid4().hex}{place.suffix[:16]}")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn errors of writing to a path into LinkproofError."""
    try:
        yield
    except OSError as error:
        raise _write_error(path, error) from error


def _final_path(path: Path) -> Path:
    """The path of a file to write, at the end of its links; raises LinkproofError if something else is there."""
    if "\0" in str(path):
        raise _no_file_error(path)
    place = Path(os.path.realpath(path))
    try:
        is_file = stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return place
    except OSError as error:  # a link to itself, a name that is too long
        raise _write_error(path, error) from error
    if not is_file or not os.access(path, os.W_OK):  # one that is kept from being written is not replaced
        raise _no_file_error(path)
    return place


def _no_file_error(path: Path) -> LinkproofError:
    return LinkproofError(f"cannot write '{path}': expected a file in a folder that can be written; give another place")


def _write_error(path: Path, error: OSError) -> LinkproofError:
    return LinkproofError(f"cannot write '{path}': {error.strerror}; give a place that can be written")


@dataclass(eq=False)
class RecordFile:
    """The records in a folder, by key.

    Where it ``may_be_torn``, a record that is incomplete, or whose checksum does not match, is left out.
    ``survives_power_failure`` costs some milliseconds a record.
    """

    folder: Path
    may_be_torn: bool = True
    survives_power_failure: bool = False
    _places: dict[str, tuple[int, int]] = field(default_factory=dict, init=False, repr=False)  # first byte and length
    _has_begun: bool = field(default=False, init=False, repr=False)

    def __post_init__(self) -> None:
        if (self.folder / RECORDS).is_file():
            self._places = dict(self._scan())

    @property
    def keys(self) -> Sequence[str]:
        """The keys of all records, in the order in which they were first written."""
        return list(self._places)

    def __contains__(self, key: object) -> bool:
        """Whether there is a record of this key."""
        return key in self._places

    def __len__(self) -> int:
        """Number of records."""
        return len(self._places)

    def append(self, key: str, row: Mapping[str, Any], curves: Mapping[str, Array] | None = None) -> None:
        """Write a record and its arrays, which come back bit for bit; it replaces another of the same key.

        Raises ValueError for a number that is not finite in the ``row``.
        """
        self.begin()
        blocks = {name: np.ascontiguousarray(values, dtype=float) for name, values in (curves or {}).items()}
        with (self.folder / CURVES).open("ab") as file:
            first, places = (file.tell() - HEADER_SIZE) // 8, {}
            for name, values in blocks.items():
                places[name] = [first, list(values.shape)]
                first += values.size
                file.write(values.data)
            self._flush(file)
        text = json.dumps({"key": key, **row, "curves": places}, ensure_ascii=False, allow_nan=False)[:-1]
        line = f'{text}{_CHECKSUM}{_checksum(text, blocks.values())}"}}\n'.encode()
        with (self.folder / RECORDS).open("ab") as file:
            self._places[key] = (file.tell(), len(line))
            file.write(line)
            self._flush(file)

    def row(self, key: str) -> dict[str, Any]:
        """The row written under a key, with ``key`` and the positions of its arrays."""
        first, length = self._places[key]
        with (self.folder / RECORDS).open("rb") as file:
            file.seek(first)
            table: dict[str, Any] = json.loads(file.read(length))
        return table

    def read(self, key: str) -> tuple[dict[str, Any], Mapping[str, Array]]:
        """A record as it was written, its arrays read when they are needed; raises KeyError."""
        row = self.row(key)
        return row, _Curves(self, row)

    def curve(self, row: Mapping[str, Any], name: str) -> Array:
        """An array of a record by its name; raises KeyError, or ValueError where the file has no such place."""
        start, shape = row["curves"][name]
        path, count = self.folder / CURVES, math.prod(shape)
        if not 0 <= start <= start + count <= (path.stat().st_size - HEADER_SIZE) // 8:
            raise ValueError(f"{name}: expected {count} numbers in {CURVES}, got fewer")
        return np.fromfile(path, np.float64, count, offset=HEADER_SIZE + 8 * start).reshape(shape)

    def begin(self) -> None:
        """Make the files; what a kill has left by halves at their ends is cut off."""
        if not self._has_begun:
            self._has_begun = True
            self.folder.mkdir(parents=True, exist_ok=True)
            records, curves = self.folder / RECORDS, self.folder / CURVES
            if not curves.is_file():
                _write_header(curves)
            os.truncate(curves, curves.stat().st_size // 8 * 8)
            records.touch()
            os.truncate(records, _last_line_end(records))

    def finish(self) -> None:
        """Note in the file of arrays how many numbers it has, so that NumPy reads it."""
        _write_header(self.folder / CURVES)

    def _flush(self, file: IO[bytes]) -> None:
        file.flush()
        if self.survives_power_failure:
            os.fsync(file.fileno())

    def _scan(self) -> Iterator[tuple[str, tuple[int, int]]]:
        """Keys and places of the records."""
        first = 0
        with (self.folder / RECORDS).open("rb") as file:
            for line in file:
                try:
                    yield self._checked_key(line), (first, len(line))
                except (ValueError, TypeError, KeyError, OSError, OverflowError):
                    if not self.may_be_torn:
                        raise
                first += len(line)

    def _checked_key(self, line: bytes) -> str:
        """The key of a record; raises ValueError, or what reading raises, for one that is not as it was written."""
        row = json.loads(line)
        if not isinstance(row, dict) or not isinstance(row["key"], str):
            raise ValueError(f"{RECORDS}: expected records with a key, got {line[:_SHOWN_BYTES]!r}")
        if self.may_be_torn:
            text, _, ending = line.decode().rpartition(_CHECKSUM)
            blocks = [self.curve(row, name) for name in row["curves"]]
            if ending != f'{_checksum(text, blocks)}"}}\n':
                raise ValueError("the checksum does not match")
        return row["key"]


def temporary_records() -> RecordFile:
    """Records in a temporary folder, which goes with them, or with the workers if this process is killed."""
    folder = Path(tempfile.mkdtemp(prefix="linkproof-", dir=get_temp_dir()))
    file = RecordFile(folder)
    weakref.finalize(file, shutil.rmtree, folder, ignore_errors=True)
    return file


@dataclass(frozen=True)
class _Curves(Mapping[str, Array]):
    """The arrays of a record, left in their file."""

    file: RecordFile
    row: Mapping[str, Any]

    def __getitem__(self, name: str) -> Array:
        return self.file.curve(self.row, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.row["curves"])

    def __len__(self) -> int:
        return len(self.row["curves"])


def _checksum(text: str, blocks: Iterable[Array]) -> str:
    digest = hashlib.sha256(text.encode())
    for block in blocks:
        digest.update(block.data)
    return digest.hexdigest()[:16]


def _write_header(path: Path) -> None:
    """NumPy's header for as many doubles as the file has."""
    with path.open("r+b" if path.is_file() else "w+b") as file:
        size = max(0, file.seek(0, os.SEEK_END) - HEADER_SIZE)
        file.seek(0)
        np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": (size // 8,)})


def _last_line_end(path: Path) -> int:
    """Number of bytes up to the end of a file's last whole line."""
    with path.open("rb") as file:
        return sum(len(line) for line in file if line.endswith(b"\n"))
