"""Quantities of one linkage or of many designs by the kernels: the same numbers as from NumPy."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.choice import cores as available
from analytic.compiled.choice import kernels
from analytic.compiled.flat_linkage import FlatLinkage, flatten, levels
from analytic.description.linkage import Linkage
from analytic.dynamics.derivative_orders import needs
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.request import EvaluationRequest

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Span = tuple[int, int]

CHUNK: Final = 256  # designs a thread takes at a time: their vectors stay in its cache
SHARE: Final = 16384  # crank angles that are worth a thread's attention: less than a millisecond's work


def by_kernels(mechanism: Mechanism, request: EvaluationRequest, cores: int | None) -> Array | None:
    """Quantities (quantities, angles); None where the linkage cannot be assembled or cannot move at some angle.

    There NumPy has a sentence to say, or finds that no more than a rounding was missing.
    """
    flat = flatten(mechanism)
    values, moving = compute(
        flat, request, mechanism.linkage, count=1, designs=lambda *_: flat.numbers[None], cores=cores
    )
    return values[:, 0] if np.all(moving) else None


def compute(
    flat: FlatLinkage,
    request: EvaluationRequest,
    largest: Linkage,
    *,
    count: int,
    designs: Callable[[int, int], Array],
    cores: int | None,
) -> tuple[Array, Booleans]:
    """Quantities of ``count`` designs at all crank angles, (quantities, count, angles), and where they move.

    ``largest`` is a linkage that has whatever one of the designs has, a mass or a load for instance. ``designs`` gives
    the vectors of numbers from one design to before another, (designs, numbers). Where a design has no motion its
    values are nan. ``cores`` is the number of threads, one for each core of the machine if None. Raises LinkproofError
    if numba is not installed.
    """
    linkage, arrays = kernels("linkage"), kernels("evaluation")
    needed = needs(largest, request.names, turns=request.turns, accelerates=request.accelerates)
    wanted = np.array([needed.inertia, needed.half_derivative, needed.forces, needed.output], dtype=np.int64)
    codes = np.array([arrays.CODES[name] for name in request.names], dtype=np.int64)
    orders = levels(flat.structure, needed.orders)
    angle, speed, acceleration = map(writable, (request.angle, request.speed, request.acceleration))
    values = np.empty((len(codes), count, angle.size))
    moving = np.empty((count, angle.size), dtype=np.bool_)

    def share(part: tuple[int, Span]) -> None:
        first, span = part
        rows = designs(first, min(first + CHUNK, count))
        own = np.zeros((len(rows), linkage.design_size(flat)))
        own[:, : rows.shape[1]] = rows
        motion = (angle, speed, acceleration)
        selection = (orders, wanted, codes)
        work = linkage.scratch(flat)
        arrays.quantities(flat.tables, own, first, *motion, *span, *selection, values, moving, work)

    in_threads(share, [(first, span) for first in range(0, count, CHUNK) for span in spans(angle.size, cores)], cores)
    return values, moving


def writable(values: Array) -> Array:
    """A flat array that may be written to: for one that may not, every kernel would be compiled once more."""
    return np.require(np.ravel(values), requirements=["C", "A", "W"])


def spans(size: int, cores: int | None) -> list[Span]:
    """A range of indices in parts of about equal size: a few for each thread, so that none waits long for another."""
    parts = 1 if _threads(cores) == 1 else max(1, min(4 * _threads(cores), size // SHARE))
    edges = [size * part // parts for part in range(parts + 1)]
    return list(itertools.pairwise(edges))


def in_threads(function: Callable[[Any], Any], parts: list[Any], cores: int | None) -> None:
    """Call the function with every part; the kernels let go of the interpreter, so threads run side by side."""
    threads = min(len(parts), _threads(cores))
    if threads <= 1:
        for part in parts:
            function(part)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(function, parts))


def _threads(cores: int | None) -> int:
    """The number given, or the cores that this process may use."""
    if cores is not None:
        if cores < 1:
            raise LinkproofError(f"cores: expected a positive number of threads, or none for all, got {cores}; mend it")
        return cores
    return available()
