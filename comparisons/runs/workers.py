"""Where jobs are run: in worker processes of this machine, each within bounds, or wherever else a pool has them run."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from analytic.errors import LinkproofError
from analytic.machine_code.compiling import cores
from comparisons.runs.crew import DEFAULT_BOUNDS, Bounds, Crew
from comparisons.runs.failures import Lost, lost

__all__ = [
    "DEFAULT_BOUNDS", "EVERY_CORE", "ONE_BY_ONE", "Bounds", "LastingPool", "LocalPool", "Pool", "PoolLostError",
    "run_jobs", "usual_processes",
]  # fmt: skip

R = TypeVar("R")


def usual_processes(count: int) -> int:
    """How many processes ``count`` jobs are given where nobody says: the cores; none for a single one."""
    return 0 if count == 1 else cores()


class PoolLostError(LinkproofError):
    """What jobs are run on is gone, in half a sentence; what they came to until then is kept."""


class Pool(Protocol):
    """Where jobs are run."""

    @property
    def place(self) -> Mapping[str, str]:
        """What an environment tells of the machines that jobs run on, where they are not this one."""
        ...

    def run(
        self,
        function: Callable[..., R],
        jobs: Sequence[tuple[Any, ...]],
        bounds: Bounds = ...,
        begun: Callable[[int], object] = ...,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job; yields (index of the job, result) as they complete."""
        ...


@dataclass(frozen=True)
class LocalPool:
    """Worker ``processes`` of this machine, as ``run_jobs`` takes them."""

    processes: int | None = None

    @property
    def place(self) -> Mapping[str, str]:
        """Nothing: this machine."""
        return {}

    def run(
        self,
        function: Callable[..., R],
        jobs: Sequence[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in worker processes."""
        return run_jobs(function, jobs, bounds=bounds, processes=self.processes, begun=begun)


EVERY_CORE, ONE_BY_ONE = LocalPool(), LocalPool(1)


class LastingPool:
    """One worker process of this machine that outlives a list of jobs, so that it imports and warms up once.

    A list whose results are not all taken ends the worker, and so does ``close``.
    """

    place: Mapping[str, str] = {}

    def __init__(self) -> None:
        self._crew: Crew | None = None

    def run(
        self,
        function: Callable[..., R],
        jobs: Sequence[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job, one after the other; bounds of memory are those of the first list."""
        if self._crew is None or self._crew.function is not function:
            self.close()
            self._crew = Crew(function, (), bounds, 1)
        self._crew.begun = begun
        try:
            yield from self._crew.take_up(jobs, bounds.seconds)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """End the worker, busy or not."""
        if self._crew is not None:
            self._crew.close()
            self._crew = None


def run_jobs(
    function: Callable[..., R],
    jobs: Sequence[tuple[Any, ...]],
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    processes: int | None = None,
    begun: Callable[[int], object] = lambda _: None,
) -> Generator[tuple[int, R | Lost], None, None]:
    """Call ``function(*job)`` for every job, in worker processes; yields (index of the job, result) as they complete.

    ``function``, a module's own or a ``functools.partial`` of one, is sent to each worker once, every job when it is
    taken up, in order; ``begun`` hears its index. ``processes`` are the cores by default, never more than there are
    jobs. With 0 the jobs run in this process, one after the other and without bounds: only what they raise is caught.

    A job whose worker dies is tried once more if the worker had done others before, so that it pays for itself alone. A
    worker never hears Ctrl-C and writes nothing to the terminal. Closing the generator, or an exception in it, kills
    them at once; so does the death of this process, whatever its cause.
    """
    if processes == 0:
        yield from _run_here(function, jobs, bounds, begun)
        return
    crew = Crew(function, jobs, bounds, min(processes or cores(), len(jobs)), begun)
    with contextlib.closing(crew):
        yield from crew.results()


def _run_here(
    function: Callable[..., R], jobs: Sequence[tuple[Any, ...]], bounds: Bounds, begun: Callable[[int], object]
) -> Iterator[tuple[int, R | Lost]]:
    for number, job in enumerate(jobs):
        begun(number)
        result: R | Lost
        try:
            result = function(*job)
        except (Exception, SystemExit) as error:
            result = lost(error, bounds.memory)
        yield number, result
