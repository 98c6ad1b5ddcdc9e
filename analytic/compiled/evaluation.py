"""The compiled path of the closed form: the same numbers as from NumPy, for long sweeps and many designs.

The kernels are compiled once for all linkages, by numba, an optional dependency, and kept on disk; the first use on a
machine takes half a minute, later ones a fraction of a second. A linkage that cannot be assembled or cannot move at
some crank angle is left to NumPy, which knows what to say about it.
"""

from __future__ import annotations

import importlib.util
import itertools
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.compiled.derivative_orders import NO_OUTPUT, Needs, needs
from analytic.compiled.flat_linkage import Integers, Program, levels, program
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.request import Request, requested

Array = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Span = tuple[int, int]

ORDERS: Final = 3
CHUNK: Final = 256  # designs a thread takes at a time: their vectors stay in its cache
SHARE: Final = 16384  # crank angles that are worth a thread's attention: less than a millisecond's work


def available() -> bool:
    """Whether numba is installed; it is not imported for the answer."""
    return importlib.util.find_spec("numba") is not None


def is_loaded() -> bool:
    """Whether the kernels are in memory, compiled."""
    module = sys.modules.get("analytic.compiled.kernels.evaluation")
    return module is not None and bool(getattr(module.quantities, "signatures", ()))


def is_ready() -> bool:
    """Whether the kernels lie compiled where numba keeps them as a rule; numba is not imported for the answer."""
    here = Path(__file__).parent / "kernels"
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or here / "__pycache__")
    kept = folder.rglob(f"evaluation.quantities*.py{sys.version_info.major}{sys.version_info.minor}.nbi")
    newest = max(path.stat().st_mtime for path in here.glob("*.py"))
    return any(path.stat().st_mtime > newest for path in kept)


def kernels() -> tuple[ModuleType, ModuleType]:
    """The compiled entry points, one linkage's and whole arrays'; raises LinkproofError if numba is not installed."""
    try:
        from analytic.compiled.kernels import evaluation, linkage  # noqa: PLC0415 - numba takes half a second to import
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != "numba":
            raise
        raise LinkproofError(
            "compiled path: expected numba, which compiles it, got an installation without; pip install "
            "'linkproof[compiled]', or choose the path 'numpy'"
        ) from error
    return linkage, evaluation


@dataclass(frozen=True)
class Motion:
    """Positions at crank angles of some shape, and their derivatives over φ of ascending order.

    ``points`` by name, m, are (orders, 2, *shape); ``angles`` of links by name, rad, (orders, *shape), those of order 0
    unwrapped along the last axis.
    """

    points: Mapping[str, Array]
    angles: Mapping[str, Array]


class CompiledMechanism:
    """A linkage in compiled form; raises LinkproofError if numba is not installed.

    ``cores`` of its methods is the number of threads, one for each core of the machine if None.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self._kernels, self._arrays = kernels()
        self.mechanism = mechanism
        self.program = program(mechanism)
        self._design: Array = self._kernels.design_of(self.program)

    def evaluate(
        self,
        angle: ArrayLike,
        quantities: Iterable[str],
        *,
        speed: ArrayLike | None = None,
        acceleration: ArrayLike = 0.0,
        cores: int | None = None,
    ) -> dict[str, Array]:
        """Quantities by name, as ``analytic.evaluation.evaluate`` has them."""
        request = requested(angle, quantities, speed, acceleration)
        needed = needs(self.program.linkage, request.names, turns=request.turns)
        check_output(self.mechanism, needed)
        numbers = self.program.numbers[None]
        found, moving = compute(self.program, request, needed, count=1, designs=lambda *_: numbers, cores=cores)
        if not np.all(moving):
            # There the plain path has a sentence to say, or finds that no more than a rounding was missing.
            from analytic.evaluation import evaluate  # noqa: PLC0415 - it needs this module

            return evaluate(self.mechanism, angle, request.names, speed=speed, acceleration=acceleration, path="numpy")
        return {name: row.reshape(request.shape) for name, row in zip(request.names, found, strict=True)}

    def motion(
        self,
        angle: ArrayLike,
        points: Iterable[str] = (),
        links: Iterable[str] = (),
        order: int = 2,
        cores: int | None = None,
    ) -> Motion:
        """Named points and angles of links at crank angles, rad, with their derivatives up to an order of 0 to 2."""
        if order not in range(ORDERS):
            raise LinkproofError(f"order of the derivative: expected 0, 1 or 2, got {order}; choose one of them")
        angle = np.asarray(angle, dtype=float)
        points, links = tuple(dict.fromkeys(points)), tuple(dict.fromkeys(links))
        carriers = {name: self._carrier(name) for name in points}
        for link in links:
            if link not in self.program.linkage.links:
                raise UnknownNameError("link", link, self.program.linkage.links)
        places = np.empty((len(points), order + 1, 2, angle.size))
        turns = np.empty((len(links), order + 1, angle.size))
        bodies = dict.fromkeys((*carriers.values(), *links), order)
        orders = levels(self.program.structure, bodies)
        if self._stands(writable(angle), carriers, links, orders=orders, places=places, turns=turns, cores=cores):
            return plain_motion(self.mechanism, angle, points, links, order)
        if angle.ndim and angle.size:
            self._arrays.unwrapped(turns, angle.shape[-1])
        if self.program.linkage.crank in links:
            turns[links.index(self.program.linkage.crank), 0] = angle.ravel()
        return Motion(
            {name: row.reshape(*row.shape[:-1], *angle.shape) for name, row in zip(points, places, strict=True)},
            {name: row.reshape(*row.shape[:-1], *angle.shape) for name, row in zip(links, turns, strict=True)},
        )

    def _carrier(self, point: str) -> str:
        """The body through which a point is cheapest to reach."""
        return self.mechanism.sweep(0.0).carrier(point)

    def _stands(
        self,
        angle: Array,
        carriers: Mapping[str, str],
        links: tuple[str, ...],
        *,
        orders: Integers,
        places: Array,
        turns: Array,
        cores: int | None,
    ) -> bool:
        """Fill in points and angles; whether the linkage cannot move at some of the angles."""
        bodies = self.program.bodies
        points = [(bodies[body], self.program.points[body, point]) for point, body in carriers.items()]
        rows = np.array(points, dtype=np.int64).reshape(-1, 2)
        numbers = np.array([bodies[link] for link in links], dtype=np.int64)

        def share(span: Span) -> float:
            work = self._kernels.scratch(self.program)
            missing: float = self._arrays.motion(
                self.program.tables, self._design, angle, *span, orders, rows, numbers, places, turns, work
            )
            return missing

        return any(in_threads(share, spans(angle.size, cores), cores))


def check_output(mechanism: Mechanism, needed: Needs) -> None:
    """Raise LinkproofError if quantities of an output are needed of a linkage that has none."""
    if needed.output != NO_OUTPUT and mechanism.linkage.output is None:
        mechanism.sweep(0.0).output()


def plain_motion(
    mechanism: Mechanism, angle: Array, points: Iterable[str], links: Iterable[str], order: int = 2
) -> Motion:
    """The same from NumPy, which raises AssemblyError where there is no motion."""
    sweep, orders = mechanism.sweep(angle), range(order + 1)

    def turn(link: str, of: int) -> Array:
        if of == 0:
            return sweep.angles(link)
        part = sweep.rates(link)[2] if of == 1 else sweep.accelerations(link)[2]
        return np.broadcast_to(np.asarray(part, dtype=float), angle.shape)

    return Motion(
        {name: np.stack([sweep.point(name, of) for of in orders]) for name in points},
        {name: np.stack([turn(name, of) for of in orders]) for name in links},
    )


def compute(
    program: Program,
    request: Request,
    needed: Needs,
    *,
    count: int,
    designs: Callable[[int, int], Array],
    cores: int | None,
) -> tuple[Array, Booleans]:
    """Quantities of ``count`` designs at all crank angles, (quantities, count, angles), and where they move.

    ``designs`` gives the vectors of numbers from one design to before another, (designs, numbers). Where a design
    has no motion its values are nan.
    """
    scalars, arrays = kernels()
    wanted = np.array([needed.inertia, needed.half_slope, needed.forces, needed.output], dtype=np.int64)
    codes = np.array([arrays.CODES[name] for name in request.names], dtype=np.int64)
    orders = levels(program.structure, needed.orders)
    angle, speed, acceleration = map(writable, (request.angle, request.speed, request.acceleration))
    values = np.empty((len(codes), count, angle.size))
    moving = np.empty((count, angle.size), dtype=np.bool_)

    def share(part: tuple[int, Span]) -> None:
        first, span = part
        rows = designs(first, min(first + CHUNK, count))
        own = np.zeros((len(rows), scalars.design_size(program)))
        own[:, : rows.shape[1]] = rows
        motion = (angle, speed, acceleration)
        asked = (orders, wanted, codes)
        arrays.quantities(program.tables, own, first, *motion, *span, *asked, values, moving, scalars.scratch(program))

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


def in_threads(function: Callable[[Any], Any], parts: list[Any], cores: int | None) -> list[Any]:
    """The function of every part; the kernels let go of the interpreter, so threads run side by side."""
    threads = min(len(parts), _threads(cores))
    if threads <= 1:
        return [function(part) for part in parts]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(function, parts))


def _threads(cores: int | None) -> int:
    """The number asked for, or the cores that this process may use."""
    if cores is not None:
        if cores < 1:
            raise LinkproofError(f"cores: expected a positive number of threads, or none for all, got {cores}; mend it")
        return cores
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
