"""A sweep as a file written block by block: netCDF-3 with 64-bit offsets, whose records are the first dimension.

A record has the values of the first axis, or of a list's parameters, and a slab of every figure: its values over the
other dimensions. All are doubles, so that every value has a place known beforehand, and a block is written where it
belongs. The other axes stand before the records.
"""

from __future__ import annotations

import os
import shutil
import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.designs.sweep.space import ONE_BY_ONE, Grid
from comparisons.designs.sweep.sweep import SweepRequest

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

COORDINATES: Final = "coordinates"
FILE: Final = "sweep.nc"
BIG: Final = ">f8"
SIZE: Final = 8
MOST_RECORDS, LARGEST_SLAB = 2**31 - 1, 2**32 - 4  # of the format; the latter in bytes
DIMENSION, VARIABLE, ATTRIBUTE = 10, 11, 12
CHARACTERS, INTEGER, DOUBLE = 2, 4, 6


@dataclass(frozen=True)
class SweepFile:
    """The file of a request at ``path``; ``about`` are the attributes of the dataset."""

    path: Path
    request: SweepRequest
    about: Mapping[str, str | int]

    @property
    def size(self) -> int:
        """Its size."""
        return self._begin + self.request.space.shape[0] * self._width * SIZE

    @property
    def is_whole(self) -> bool:
        """Whether the file is there in its full size, which it has from the start."""
        return self.path.is_file() and self.path.stat().st_size == self.size

    @cached_property
    def _leading(self) -> int:
        """Values of a record before its slabs."""
        return 1 if isinstance(self.request.space, Grid) else len(self.request.space.parameters)

    @cached_property
    def _width(self) -> int:
        """Values of a record."""
        return self._leading + len(self.request.figures) * self.request.space.slab

    @cached_property
    def _fixed(self) -> list[Array]:
        """The other axes."""
        space = self.request.space
        return [axis[np.arange(len(axis))] for axis in space.axes[1:]] if isinstance(space, Grid) else []

    @cached_property
    def _begin(self) -> int:
        """Where the records begin."""
        return self._end_of_header + sum(map(len, self._fixed)) * SIZE

    @cached_property
    def _end_of_header(self) -> int:
        return len(self._header(0))

    def check(self) -> None:
        """Raise LinkproofError for more designs than the format or the disk holds."""
        space = self.request.space
        if space.shape[0] > MOST_RECORDS or space.slab * SIZE > LARGEST_SLAB:
            raise LinkproofError(
                f"expected at most {MOST_RECORDS} designs along the first dimension and {LARGEST_SLAB // SIZE} along "
                f"all others, which is what netCDF holds, got {space.shape[0]} and {space.slab}: vary another "
                "parameter first, or leave --out out"
            )
        there = next(folder for folder in self.path.parents if folder.exists())
        free = shutil.disk_usage(there).free
        if self.size > free and not self.is_whole:
            raise LinkproofError(
                f"expected room for {space.count} designs, {_size(self.size)}, in '{there}', got {_size(free)}: give "
                "fewer designs or figures, or a place on another disk"
            )

    def create(self) -> None:
        """Write all but the records, and give the file its size."""
        with _told(self.path), self.path.open("wb") as file:
            file.write(self._header(self._end_of_header))
            for values in self._fixed:
                file.write(values.astype(BIG).tobytes())
            file.truncate(self.size)

    def write(self, first: int, found: Array) -> None:
        """Write the figures (figures, designs) of the designs from number ``first`` on, of a block of the request."""
        space, count = self.request.space, found.shape[1]
        record, offset = divmod(first, space.slab)
        with _told(self.path), self.path.open("r+b") as file:
            if count % space.slab == 0:
                rows = np.empty((count // space.slab, self._width), BIG)
                rows[:, : self._leading] = self._lead(record, record + len(rows))
                self._slabs(rows)[:] = found.reshape(len(found), len(rows), space.slab).swapaxes(0, 1)
                self._put(file, record * self._width, rows)
            else:
                self._put(file, record * self._width, self._lead(record, record + 1))
                for number, values in enumerate(found):
                    start = self._leading + number * space.slab + offset
                    self._put(file, record * self._width + start, values)
            file.flush()
            os.fsync(file.fileno())

    def read(self, first: int, last: int) -> Array:
        """The figures of a block of the request, (figures, designs)."""
        record, offset = divmod(first, self.request.space.slab)
        shape = (-(-last // self.request.space.slab) - record, self._width)
        rows = np.memmap(self.path, BIG, "r", self._begin + record * self._width * SIZE, shape)
        found = self._slabs(rows)[:, :, offset : offset + last - first].swapaxes(0, 1)
        return np.array(found, dtype=float).reshape(len(self.request.figures), -1)

    def _slabs(self, rows: Array) -> Array:
        """The figures of whole records, (records, figures, slab), in place."""
        return rows[:, self._leading :].reshape(len(rows), len(self.request.figures), -1)

    def _lead(self, first: int, last: int) -> Array:
        space = self.request.space
        return space.axes[0][np.arange(first, last)][:, None] if isinstance(space, Grid) else space.shown(first, last).T

    def _put(self, file: BinaryIO, place: int, values: Array) -> None:
        file.seek(self._begin + place * SIZE)
        file.write(np.ascontiguousarray(values, BIG).data)

    def _header(self, end: int) -> bytes:
        """Dimensions, attributes and variables, of which the first begins where the header ends."""
        space, figures = self.request.space, self.request.figures
        dimensions = [
            _name(name) + _integer(0 if number == 0 else size)
            for number, (name, size) in enumerate(zip(space.dimensions, space.shape, strict=True))
        ]
        lead, rest = space.parameters[: self._leading], space.parameters[self._leading :]
        place, record = end, end + sum(map(len, self._fixed)) * SIZE
        variables = []
        for number, (one, values) in enumerate(zip(rest, self._fixed, strict=True), start=1):
            variables.append(_variable(one.name, (number,), {"units": one.unit.name}, len(values), place))
            place += len(values) * SIZE
        for one in lead:
            variables.append(_variable(one.name, (0,), {"units": one.unit.name}, 1, record))
            record += SIZE
        beside = {} if isinstance(space, Grid) else {COORDINATES: " ".join(one.name for one in lead)}
        for figure in figures:
            told = {"units": figure.unit.name, **beside}
            variables.append(_variable(figure.name, range(len(space.shape)), told, space.slab, record))
            record += space.slab * SIZE
        lists = (_list(DIMENSION, dimensions), _attributes(self.about), _list(VARIABLE, variables))
        return b"CDF\x02" + _integer(space.shape[0]) + b"".join(lists)


def saved_sweep(path: Path) -> xarray.Dataset:
    """The dataset of a file, its values read when they are asked for."""
    import xarray  # noqa: PLC0415  half a second that a sweep without a picture does not pay

    found = xarray.open_dataset(path, engine="scipy", decode_coords=False)
    # SciPy takes names for Latin-1; a list's parameters may have blanks in theirs, which part those of coordinates.
    names = {name: str(name).encode("latin1").decode() for name in (*found.variables, *found.dims)}
    found = found.rename({name: right for name, right in names.items() if name != right})
    if ONE_BY_ONE in found.dims:
        found = found.set_coords([name for name, one in found.data_vars.items() if COORDINATES not in one.attrs])
        for one in found.data_vars.values():
            del one.attrs[COORDINATES]
    return found


@contextmanager
def _told(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise LinkproofError(
            f"cannot write '{path}': {error.strerror}; what is done is kept: free some space and repeat with --resume"
        ) from error


def _size(count: float) -> str:
    """Bytes in words."""
    for unit in ("B", "kB", "MB", "GB", "TB"):
        if count < 1000.0:
            return f"{count:.3g} {unit}"
        count /= 1000.0
    return f"{count:.3g} PB"


def _integer(value: int) -> bytes:
    return struct.pack(">I", value)


def _padded(data: bytes) -> bytes:
    return data + b"\0" * (-len(data) % 4)


def _name(name: str) -> bytes:
    return _integer(len(name.encode())) + _padded(name.encode())


def _list(tag: int, items: list[bytes]) -> bytes:
    return _integer(tag if items else 0) + _integer(len(items)) + b"".join(items)


def _attributes(told: Mapping[str, str | int]) -> bytes:
    items = []
    for name, value in told.items():
        if isinstance(value, int):
            items.append(_name(name) + _integer(INTEGER) + _integer(1) + _integer(value))
        else:
            items.append(_name(name) + _integer(CHARACTERS) + _name(value))
    return _list(ATTRIBUTE, items)


def _variable(name: str, over: range | tuple[int, ...], told: Mapping[str, str], count: int, begin: int) -> bytes:
    """A variable over these dimensions, ``count`` doubles in all or of a record, that begins at a byte of the file."""
    dimensions = _integer(len(over)) + b"".join(map(_integer, over))
    return _name(name) + dimensions + _attributes(told) + struct.pack(">IIQ", DOUBLE, count * SIZE, begin)
