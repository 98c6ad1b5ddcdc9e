"""Printed functions as machine code, by numba where it is installed.

A function takes 1 to 3 s to compile and serves this process only, so it is compiled where that saves time.
"""

from __future__ import annotations

import importlib.util
import math
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError, UnknownNameError
from analytic.machine_code.printing import FUNCTION, LANES, Result, ahead, python_source
from analytic.machine_code.tracing import OperationList

Array = NDArray[np.float64]

PATHS: Final = ("auto", "numpy", "compiled")
# s per operation of a list: what compiling it takes, above a second, and what NumPy takes for each lane and row.
COMPILING, LEAST_COMPILING, BY_NUMPY = 2.5e-3, 1.0, 1e-9
MOST_OPERATIONS: Final = 3000  # compiling a longer list takes longer than it saves


def is_worthwhile(path: str, operations: int, poses: float) -> bool:
    """Whether to compile a list of so many operations for so many poses; raises for a wrong ``path``.

    ``path`` is ``numpy``, ``compiled``, or ``auto``: compiled where NumPy would take longer than compiling does.
    Raises UnknownNameError for another, LinkproofError where numba is missing for "compiled".
    """
    if path not in PATHS:
        raise UnknownNameError("path", path, PATHS)
    if path == "compiled" and not is_installed():
        raise LinkproofError(
            "compiled path: expected numba, which compiles it, got an installation without; pip install "
            "'linkproof[compiled]', or choose the path 'numpy'"
        )
    if path != "auto":
        return path == "compiled"
    seconds = BY_NUMPY * operations * poses
    return operations <= MOST_OPERATIONS and seconds > LEAST_COMPILING + COMPILING * operations and is_installed()


@lru_cache(maxsize=1)
def is_installed() -> bool:
    """Whether numba is installed; it is not imported for the answer."""
    return importlib.util.find_spec("numba") is not None


class StraightFunction:
    """Lines of a trace as machine code: ``results`` of lanes, from ``lanes`` and ``rows``, lines that are given.

    See ``analytic.machine_code.printing`` for lanes and rows. The compiled code releases the interpreter's lock.
    """

    def __init__(
        self, trace: OperationList, lanes: Sequence[int], rows: Sequence[int], results: Sequence[Result]
    ) -> None:
        self.lanes, self.rows = tuple(lanes), tuple(rows)
        self._widths = len(lanes) + len(ahead(trace, lanes, results)), len(results)
        self._straight = compiled(python_source(trace, lanes, rows, results))
        self._scratch = threading.local()

    def __call__(self, lanes: Sequence[Any], rows: Array, count: int, into: Array | None = None) -> Array:
        """Results (results, count), or put there: ``lanes`` are numbers or arrays of so many, ``rows`` (rows, k)."""
        given, out = self._memory(-(-count // LANES))
        full = count - count % LANES
        for number, values in enumerate(lanes):
            flat = np.broadcast_to(values, count)
            given[: full // LANES, number] = flat[:full].reshape(-1, LANES)
            if full < count:
                given[-1, number, : count - full] = flat[full:]
                given[-1, number, count - full :] = flat[-1]
        self._straight(given.reshape(len(given), -1), rows, out.reshape(len(out), -1))
        results = np.empty((len(out[0]), count)) if into is None else into
        results[:, :full].reshape(len(results), full // LANES, LANES)[:] = out[: full // LANES].swapaxes(0, 1)
        if full < count:
            results[:, full:] = out[-1, :, : count - full]
        return results

    def _memory(self, chunks: int) -> tuple[Array, Array]:
        """Memory of a thread for so many chunks, the same as before: new memory costs more than the computation."""
        values: tuple[Array, Array] | None = getattr(self._scratch, "arrays", None)
        if values is None or len(values[0]) < chunks:
            values = self._scratch.arrays = tuple(np.empty((chunks, width, LANES)) for width in self._widths)
        return values[0][:chunks], values[1][:chunks]


@lru_cache(maxsize=32)
def compiled(source: str) -> Callable[[Array, Array, Array], None]:
    """The function of a source of ``analytic.machine_code.printing``."""
    import numba  # noqa: PLC0415 - optional, and slow to import

    space: dict[str, Any] = {"math": math}
    exec(source, space)
    numbers = numba.float64[:, ::1]
    signature = numba.void(numbers, numbers, numbers)
    function: Callable[[Array, Array, Array], None] = numba.njit(signature, nogil=True, error_model="numpy")(
        space[FUNCTION]
    )
    return function


def cores() -> int:
    """Processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_threads(function: Callable[[Any], object], parts: Sequence[Any], count: int | None) -> None:
    """Call the function with every part on so many threads, all cores if None: machine code runs side by side."""
    if count is not None and count < 1:
        raise LinkproofError(f"cores: expected a positive number of threads, or none for all, got {count}; correct it")
    threads = min(len(parts), cores() if count is None else count)
    if threads <= 1:
        for part in parts:
            function(part)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(function, parts))
