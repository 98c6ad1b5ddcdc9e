"""The folder of a sweep: figures grow as plain doubles in ``unfinished``, and become a netCDF file when all are there.

HDF5 does not survive a kill in the midst of a write. Every block has its place in the plain file, and the journal
beside it lists those written; the netCDF file is made of it in one step.
"""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.designs.parameters import NamedFigure, Parameter
from comparisons.designs.space import ONE_BY_ONE
from comparisons.designs.sweep import SweepRequest
from comparisons.runs.study import FOLDER, HEADER, Journal

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

FILE: Final = "sweep.nc"
DATA: Final = "data/figures"  # in unfinished; the journal's own pieces stand beside the folder
SLASH: Final = "∕"  # in the file instead of "/", which parts groups of HDF5


def labelled_dataset(
    request: SweepRequest, values: Mapping[str, Any], figures: Any, about: Mapping[str, str | int]  # noqa: ANN401
) -> xarray.Dataset:  # fmt: skip
    """``values`` of the parameters and ``figures`` (figures, *shape), arrays of any kind, with names and units."""
    import xarray  # noqa: PLC0415 - half a second that a sweep without files does not pay

    over = request.space.dimensions
    units = {parameter.name: {"units": parameter.unit.name} for parameter in request.space.parameters}
    return xarray.Dataset(
        {
            figure.name: (over, row, {"units": figure.unit.name})
            for figure, row in zip(request.figures, figures, strict=True)
        },
        coords={name: (name if name in over else ONE_BY_ONE, entry, units[name]) for name, entry in values.items()},
        attrs=about,
    )


def dataset_attributes(request: SweepRequest, conditions: str, command: str) -> dict[str, str | int]:
    """Attributes of a sweep's dataset."""
    return {
        "mechanism": request.linkage.name,
        "variant": request.linkage.variant,
        "conditions": conditions,
        "angles": len(request.motion.places),
        "refined": int(request.refine),
        "command": command,
    }


@dataclass
class SavedSweep:
    """A request in a folder; ``about`` are the attributes of its file."""

    request: SweepRequest
    folder: Path
    about: Mapping[str, str | int]

    def __post_init__(self) -> None:
        self._path = self.folder / FOLDER / DATA
        self._missing = [folder for folder in (self.folder, *self.folder.parents) if not folder.exists()]
        self._shape = (len(self.request.figures), self.request.space.count)

    @property
    def command(self) -> str:
        """The command that repeats the sweep."""
        return str(self.about["command"])

    def check(self) -> None:
        """Raise LinkproofError where the folder has unfinished work of another command, or too little room."""
        header = self.folder / FOLDER / HEADER
        begun = (
            header.read_text(encoding="utf-8", errors="replace").partition("\n")[0]
            if header.is_file()
            else self.command
        )
        if begun.split()[:2] != self.command.split()[:2]:
            raise LinkproofError(
                f"expected a folder of its own, got '{self.folder}' with unfinished work of `{begun}`: finish that, or "
                "give another folder"
            )
        free = shutil.disk_usage(next(parent for parent in self.folder.parents if parent.exists())).free / 1e6
        needed = 16e-6 * self._shape[0] * self._shape[1]  # twice: the plain file and the netCDF file
        if needed > free and not self._path.exists():
            raise LinkproofError(
                f"expected room for {self.request.space.count} designs, {needed:.3g} MB, in '{self.folder}', got "
                f"{free:.3g} MB: give fewer designs or figures, or a place on another disk"
            )

    def begin(self, journal: Journal) -> set[int]:
        """The numbers of the blocks that are written already."""
        self._journal = journal
        done = {int(key) for key in journal.records.keys}
        if not self._path.is_file():
            journal.clear()
            done = set()
        return done

    def keep(self, number: int, figures: Array) -> None:
        """Write a block, then note that it is written."""
        with self._writing():
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with os.fdopen(os.open(self._path, os.O_RDWR | os.O_CREAT), "r+b") as file:
                for row, values in enumerate(figures):
                    file.seek(8 * (row * self._shape[1] + self.request.blocks[number]))
                    file.write(np.ascontiguousarray(values).data)
                file.truncate(8 * self._shape[0] * self._shape[1])  # its size from the first block on
                file.flush()
                os.fsync(file.fileno())
        self._journal.keep(str(number), {})

    def read(self, number: int) -> Array:
        """The figures of a block that is written, (figures, designs)."""
        first, last = self.request.block(number)
        return np.array(self._figures()[:, first:last])

    def _figures(self) -> Array:
        return np.memmap(self._path, float, "r", shape=self._shape)

    def dataset(self) -> xarray.Dataset:
        """All designs, their figures left on the disk."""
        space = self.request.space
        values = dict(zip((parameter.name for parameter in space.parameters), space.columns, strict=True))
        return labelled_dataset(self.request, values, self._figures().reshape(-1, *space.shape), self.about)

    def finish(self, *, keeps: bool) -> None:
        """Write the netCDF file if ``keeps``, and delete everything else."""
        if keeps:
            made = self._path.with_name(FILE)
            with self._writing():
                self._write(made)
                os.replace(made, self.folder / FILE)
        self._journal.clear()

    def _write(self, path: Path) -> None:
        """Write the dataset as netCDF; not by xarray, which takes a second to import where Dask is installed."""
        import h5netcdf  # noqa: PLC0415 - needed for files alone

        space = self.request.space
        over = space.dimensions
        beside = [number.name for number in space.parameters if number.name not in over]
        with h5netcdf.File(path, "w") as file:
            file.attrs.update(self.about)
            file.dimensions = dict(zip(over, space.shape, strict=True))

            def add(entry: Parameter | NamedFigure, dimensions: tuple[str, ...], values: Array) -> h5netcdf.Variable:
                variable = file.create_variable(entry.name.replace("/", SLASH), dimensions, float, data=values)
                variable.attrs["units"] = entry.unit.name
                return variable

            for parameter, column in zip(space.parameters, space.columns, strict=True):
                add(parameter, (parameter.name,) if parameter.name in over else (ONE_BY_ONE,), column)
            for figure, row in zip(self.request.figures, self._figures(), strict=True):
                variable = add(figure, over, row.reshape(space.shape))
                if beside and not any(" " in name for name in beside):  # a list of names is parted by blanks
                    variable.attrs["coordinates"] = " ".join(name.replace("/", SLASH) for name in beside)

    def forget(self) -> None:
        """Leave the folder as it was."""
        self._journal.clear()
        with contextlib.suppress(OSError):  # another command may have written there
            for folder in self._missing:
                folder.rmdir()

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Raise LinkproofError, which says how to go on, for an error of the disk."""
        try:
            yield
        except OSError as error:
            raise LinkproofError(
                f"cannot write to '{self.folder}': {error.strerror or error}; finished designs are saved: free some "
                "space and repeat with --resume"
            ) from error
