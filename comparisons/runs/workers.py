"""Pools in which jobs run: worker processes of this machine, each within bounds."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from analytic.machine_code.compiling import cores
from comparisons.runs.run_engine import Lost, lost
from comparisons.runs.worker_pool import DEFAULT_BOUNDS, Bounds, WorkerPool

__all__ = [
    "DEFAULT_BOUNDS", "EVERY_CORE", "ONE_BY_ONE", "Bounds", "LastingPool", "LocalPool", "Pool",
    "run_jobs", "usual_processes",
]  # fmt: skip

R = TypeVar("R")


def usual_processes(count: int) -> int:
    """The default number of processes for ``count`` jobs: the number of cores, or 0 for a single job."""
    return 0 if count == 1 else cores()


@dataclass(frozen=True)
class LocalPool:
    """Worker ``processes`` of this machine, as ``run_jobs`` takes them."""

    processes: int | None = None

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in worker processes."""
        return run_jobs(function, jobs, bounds=bounds, processes=self.processes, begun=begun)


EVERY_CORE, ONE_BY_ONE = LocalPool(), LocalPool(1)


class LastingPool:
    """Worker ``processes`` of this machine that outlive a list of jobs, so that they import and warm up once.

    A list whose results are not all taken ends the workers, and so do ``close`` and a list for another function.
    """

    def __init__(self, processes: int = 1) -> None:
        self.processes = processes
        self._pool: WorkerPool | None = None

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in these workers; bounds of memory are those of the first list."""
        if self._pool is None or self._pool.function is not function:
            self.close()
            self._pool = WorkerPool(function, (), bounds, self.processes)
        self._pool.begun = begun
        try:
            yield from self._pool.run_more(jobs, bounds.seconds)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """End the workers, busy or not."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None


Pool = LocalPool | LastingPool


def run_jobs(
    function: Callable[..., R],
    jobs: Iterable[tuple[Any, ...]],
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    processes: int | None = None,
    begun: Callable[[int], object] = lambda _: None,
) -> Generator[tuple[int, R | Lost], None, None]:
    """Call ``function(*job)`` for every job, in worker processes; yields (index of the job, result) as they complete.

    ``function``, of a module or a ``functools.partial`` of one, is sent to each worker once. Jobs begin in order, are
    taken from their iterable when workers need them, and ``begun`` is called with the index of each. ``processes`` are
    the cores by default, never more than there are jobs. With 0 the jobs run in this process, one after the other and
    without bounds: only exceptions are caught.

    A job whose worker dies is tried once more if the worker had finished others before, which may have damaged it.
    A worker ignores Ctrl-C and writes nothing to the terminal. All workers are killed at once when the generator is
    closed or raises, and when this process dies, whatever its cause.
    """
    if processes == 0:
        yield from _run_here(function, jobs, bounds, begun)
        return
    with contextlib.closing(WorkerPool(function, jobs, bounds, processes or cores(), begun)) as workers:
        yield from workers.results()


def _run_here(
    function: Callable[..., R], jobs: Iterable[tuple[Any, ...]], bounds: Bounds, begun: Callable[[int], object]
) -> Iterator[tuple[int, R | Lost]]:
    for number, job in enumerate(jobs):
        begun(number)
        result: R | Lost
        try:
            result = function(*job)
        except (Exception, SystemExit) as error:
            result = lost(error, bounds.memory)
        yield number, result
