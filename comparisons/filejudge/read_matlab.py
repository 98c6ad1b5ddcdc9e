"""A script of its own process: the arrays of a MATLAB file, each as ``_NAME`` in ``arrays.npz``."""

import math
import sys
from typing import Any

import numpy as np
from scipy.io import loadmat, whosmat


def read(file: str, most_numbers: int) -> None:
    """Read matrices of numbers and letters; raises whatever SciPy does."""
    if sum(math.prod(shape) for _, shape, _ in whosmat(file)) > most_numbers:
        sys.exit("it has more numbers than can be read")
    every = {k: v for k, v in loadmat(file, chars_as_strings=False).items() if isinstance(v, np.ndarray)}
    arrays: dict[str, Any] = {f"_{k}": v for k, v in every.items() if v.ndim == 2 and v.dtype.kind in "fiuU"}
    np.savez("arrays.npz", **arrays)


if __name__ == "__main__":
    read(sys.argv[1], int(sys.argv[2]))
