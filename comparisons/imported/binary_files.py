"""Result files that are no text: workbooks, MATLAB files, and trajectories of Modelica.

OpenModelica and Dymola write matrices ``Aclass``, ``name``, ``dataInfo``, ``data_1`` (what is constant), ``data_2``, as
they are or transposed (``Aclass[3]`` says which): ``dataInfo`` has for each name the matrix and the row, with a sign.
"""

from __future__ import annotations

import io
import math
import os
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError, printable
from comparisons.imported.columns import Column
from comparisons.imported.encodings import LARGEST, MOST_NUMBERS, ResultText
from comparisons.imported.text_tables import LARGEST_NUMBER

TRAJECTORY: Final = ("Aclass", "name", "dataInfo", "data_2")
# The script that writes the arrays of a file to arrays.npz, in a process of its own, which a damaged file may crash.
MATLAB_READER: Final = Path(__file__).with_name("read_matlab.py")
LONGEST_RUN: Final = 60.0  # s, of the script
MOST_WORDS: Final = 500  # characters of what is wrong


def read_workbook(path: Path) -> Iterator[ResultText]:
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
    except Exception as error:  # errors of damaged zip, XML and cells have no common class
        raise _reading_error(path, "a workbook", error) from error


def _reading_error(path: Path, kind: str, error: Exception) -> LinkproofError:
    """The error to raise about a file that a reader refused."""
    reason = str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"
    return LinkproofError(
        f"{path}: expected a file of results, got {kind} that cannot be read ({reason}); export the results as CSV"
    )


def _read_arrays(path: Path) -> dict[str, Any]:
    """The arrays, by name, of a MATLAB file; raises ValueError with the last words of the script that reads it."""
    with TemporaryDirectory() as folder:  # removed with everything that the script writes
        command = [sys.executable, "-P", str(MATLAB_READER), str(path.resolve()), str(MOST_NUMBERS)]
        try:
            done = subprocess.run(
                command, cwd=folder, env={**os.environ, "TMPDIR": folder}, timeout=LONGEST_RUN, check=False,
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise ValueError(f"it takes more than {LONGEST_RUN:.0f} s") from None
        words = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        result = Path(folder, "arrays.npz")
        if done.returncode or not result.exists():
            raise ValueError(printable(words[-MOST_WORDS:]) if done.returncode > 0 and words else "it crashes")
        with np.load(result) as arrays:
            return dict(arrays)


def _column(path: Path, name: str, unit: str, array: NDArray[Any]) -> Column:
    """A column as sharp as its numbers are; raises LinkproofError for numbers that are not finite."""
    values = array.astype(float)
    if not (np.abs(values) < LARGEST_NUMBER).all():
        raise LinkproofError(f"{path}: expected finite numbers of '{printable(name)}', got others; export it again")
    sharp = np.finfo(array.dtype if array.dtype.kind == "f" else float).eps * np.abs(values)
    return Column(name, unit, values, sharp, f"{path} ({printable(name)})")


def matlab_columns(path: Path) -> tuple[bool, list[list[Column]]]:
    """Whether a MATLAB file is a trajectory of Modelica, and the columns of every length in it.

    Raises LinkproofError for one that cannot be read.
    """
    try:
        data = {name[1:]: array for name, array in _read_arrays(path).items()}
        is_trajectory = all(name in data for name in TRAJECTORY)
        arrays = dict(_modelica_curves(data) if is_trajectory else _matlab_curves(data))
    except Exception as error:  # errors of damaged matrices have no common class
        raise _reading_error(path, "a MATLAB file", error) from error
    tables: dict[int, list[Column]] = {}
    for name, array in arrays.items():
        tables.setdefault(len(array), []).append(_column(path, name, "", array))
    return is_trajectory, list(tables.values())


def _modelica_curves(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and values of all that varies, the time first."""
    is_transposed = "".join(data["Aclass"][3]).strip("\0 ") == "binTrans"
    names, info, values = (data[key].T if is_transposed else data[key] for key in TRAJECTORY[1:])
    for name, (matrix, place, *_) in zip(names, info.astype(int), strict=True):
        if matrix in (0, 2) and place:
            yield "".join(name).strip("\0 "), math.copysign(1.0, place) * values[:, abs(place) - 1]


def _matlab_curves(data: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Names and values of vectors and of the columns of matrices."""
    for name, array in data.items():
        every = array if array.shape[0] == 1 else array.T
        if array.dtype.kind in "fiu" and array.size > 1:
            for number, values in enumerate(every, start=1):
                yield f"{name}({number})" if len(every) > 1 else name, values
