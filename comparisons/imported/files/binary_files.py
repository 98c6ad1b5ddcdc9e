"""Result files that are no text: workbooks, MATLAB files and trajectories of Modelica.

OpenModelica and Dymola write matrices ``Aclass``, ``name``, ``dataInfo``, ``data_1`` (what is constant), ``data_2``, as
they are or transposed (``Aclass[3]`` says which): ``dataInfo`` has for each name the matrix and the row, with a sign.
"""

from __future__ import annotations

import io
import math
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytic.errors import LinkproofError, printable
from comparisons.imported.columns import Column
from comparisons.imported.files.tables import GREATEST
from comparisons.imported.files.text import LARGEST, MOST_NUMBERS, ResultText

TRAJECTORY: Final = ("Aclass", "name", "dataInfo", "data_2")
# SciPy's reader, in a process of its own: a damaged file may crash it. An archive of NumPy's arrays goes to stdout.
READER: Final = """
import math, sys, numpy
from scipy.io import loadmat, whosmat
if sum(math.prod(shape) for _, shape, _ in whosmat(sys.argv[1])) > int(sys.argv[2]):
    raise ValueError("more numbers than can be read")
arrays = {k: v for k, v in loadmat(sys.argv[1], chars_as_strings=False).items() if isinstance(v, numpy.ndarray)}
numpy.savez(sys.stdout.buffer, **{f"_{k}": v for k, v in arrays.items() if v.ndim == 2 and v.dtype.kind in "fiuU"})
"""
LONGEST: Final = 60.0  # seconds that it may take


def sheets(path: Path) -> Iterator[ResultText]:
    """The sheets of a workbook as tables parted by tabs; raises LinkproofError for what cannot be read."""
    try:
        from openpyxl import load_workbook  # noqa: PLC0415 - an extra
    except ImportError:
        raise LinkproofError(
            f"{path}: expected openpyxl to read a workbook, got none installed; pip install 'linkproof[xlsx]', or "
            "export the results as CSV"
        ) from None
    try:
        with zipfile.ZipFile(path) as parts:
            size = sum(part.file_size for part in parts.infolist())
        for sheet in load_workbook(io.BytesIO(path.read_bytes()), read_only=True, data_only=True).worksheets:
            lines, numbers = [], 0
            for row in sheet.iter_rows(values_only=True):
                lines.append("\t".join("" if cell is None else " ".join(str(cell).split()) for cell in row))
                numbers = max(numbers, sum(isinstance(cell, int | float) for cell in row))
                size += len(lines[-1])  # of empty cells, too
                if size > LARGEST:
                    raise ValueError(f"more than {LARGEST >> 20} MB of cells")
            if numbers > 1:  # no sheet of notes
                yield ResultText(f"{printable(str(path))}[{printable(sheet.title)}]", "\n".join(lines))
    except Exception as error:  # what damaged files raise in zip, XML and cells has no common class
        raise _unreadable(path, "a workbook", error) from error


def _unreadable(path: Path, kind: str, error: Exception) -> LinkproofError:
    return LinkproofError(
        f"{path}: expected a file of results, got {kind} that cannot be read ({type(error).__name__}: {error}); export "
        "the results as CSV"
    )


def matlab_columns(path: Path) -> tuple[bool, list[list[Column]]]:
    """Whether a MATLAB file is a trajectory of Modelica, and the columns of every length in it.

    Raises LinkproofError for one that cannot be read.
    """
    try:
        command = [sys.executable, "-c", READER, str(path), str(MOST_NUMBERS)]
        read = subprocess.run(command, capture_output=True, timeout=LONGEST, check=False)
        if read.returncode:
            raise ValueError(read.stderr.decode(errors="replace").strip().rpartition("\n")[2] or "it is damaged")
        data = {name[1:]: array for name, array in np.load(io.BytesIO(read.stdout)).items()}
        is_trajectory = all(name in data for name in TRAJECTORY)
        arrays = dict(_trajectory(data) if is_trajectory else _vectors(data))
    except Exception as error:  # what damaged files raise in decompression and matrices has no common class
        raise _unreadable(path, "a MATLAB file", error) from error
    tables: dict[int, list[Column]] = {}
    for name, array in arrays.items():
        values = array.astype(float)
        if not (np.abs(values) < GREATEST).all():
            raise LinkproofError(f"{path}: expected finite numbers of '{printable(name)}', got others; export it again")
        sharp = np.finfo(array.dtype if array.dtype.kind == "f" else float).eps * np.abs(values)
        tables.setdefault(len(values), []).append(Column(name, "", values, sharp, f"{path} ({printable(name)})"))
    return is_trajectory, list(tables.values())


def _trajectory(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and values of all that varies, the time first."""
    is_transposed = "".join(data["Aclass"][3]).strip("\0 ") == "binTrans"
    names, info, values = (data[key].T if is_transposed else data[key] for key in TRAJECTORY[1:])
    for name, (matrix, place, *_) in zip(names, info.astype(int), strict=True):
        if matrix in (0, 2) and place:
            yield "".join(name).strip("\0 "), math.copysign(1.0, place) * values[:, abs(place) - 1]


def _vectors(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and values of vectors and of the columns of matrices."""
    for name, array in data.items():
        every = array if array.shape[0] == 1 else array.T
        if array.dtype.kind in "fiu" and array.size > 1:
            for number, values in enumerate(every, start=1):
                yield f"{name}({number})" if len(every) > 1 else name, values
