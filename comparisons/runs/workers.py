"""Worker processes for lists of jobs: one that crashes, hangs or runs out of memory costs its own job alone.

Every worker is a pool of pebble's with one process and pipes of its own, so that nothing is shared that a dying process
could leave locked or half-written, and whatever it was doing is known. What starts processes is imported with the first
worker: where a system has none, jobs run in this process.
"""

from __future__ import annotations

import contextlib
import pickle
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar
from uuid import uuid4

from analytic.errors import LinkproofError
from analytic.machine_code import cores
from comparisons.runs.run_engine import GIB, Failure, Lost, lost

R = TypeVar("R")
Begun = Callable[[int], object]

# What C and C++ run-time libraries write when an allocation fails and nobody catches it.
_NO_MEMORY: Final = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")
_OUTPUT_END: Final = 4096  # bytes of the end of a worker's output that are searched for these
_PULSE: Final = 1.0  # s, after which a Ctrl-C is noticed where it does not interrupt a wait
_POLL: Final = 0.02  # s, after which pebble looks again for a worker that has ended or is late


@dataclass(frozen=True)
class Bounds:
    """Bounds of one job: ``seconds`` of wall time, and ``memory``, bytes that it may add to the address space.

    Address space counts reserved memory, used or not. It is bounded where the system can (Linux).
    """

    seconds: float = 600.0
    memory: int = 4 * GIB


DEFAULT_BOUNDS = Bounds()


def usual_processes(count: int) -> int:
    """The default number of processes for ``count`` jobs: the number of cores, or 0 for a single job."""
    return 0 if count == 1 else cores()


class _Job(NamedTuple):
    """A job by its index, with its pickled function and arguments."""

    number: int
    function: bytes
    arguments: bytes
    bounds: Bounds


class _Worker:
    """A worker process and the job that it has; it has been ``used`` once it has finished any."""

    def __init__(self, module: str) -> None:
        """Start it; ``module`` is what its jobs need. Raises LinkproofError where that is not possible."""
        self.used = self.has_died = False
        try:
            from multiprocessing.util import get_temp_dir  # noqa: PLC0415

            from pebble import CONSTS, ProcessPool  # noqa: PLC0415

            from comparisons.runs.worker_process import WorkerContext, prepare, start_server  # noqa: PLC0415

            CONSTS.sleep_unit = _POLL
            start_server([module])
            self.output = Path(get_temp_dir()) / f"{uuid4().hex}.txt"
            context = WorkerContext()
            self.pool = ProcessPool(1, initializer=prepare, initargs=(str(self.output),), context=context)
            self.is_usable()  # which starts it
            assert context.process is not None
            self.process = context.process
        except (ImportError, OSError, EOFError, BrokenExecutor) as error:
            cause = error.__cause__ or error
            raise _start_error(f"{type(cause).__name__}: {cause}") from error

    def is_usable(self) -> bool:
        """Whether the process and its pipes are as they should be."""
        return bool(self.pool.active)

    def begin(self, job: _Job) -> Future[bytes]:
        """The pickled result of a job to come; its time begins when the worker takes it."""
        from comparisons.runs.worker_process import run_job  # noqa: PLC0415

        self.job = job
        arguments = (job.function, job.arguments, job.bounds.memory, str(self.output))
        return self.pool.schedule(run_job, arguments, timeout=job.bounds.seconds)

    def result(self, future: Future[bytes]) -> Any:  # noqa: ANN401 - whatever the function returns
        """The result of its job, or how that was lost."""
        error = future.exception() if future.done() else BrokenExecutor()
        if isinstance(error, TimeoutError):
            return Lost(Failure.TIMED_OUT, f"took longer than {self.job.bounds.seconds:g} s")
        if error is not None:
            self.has_died = True
            return self._crash()
        try:
            return pickle.loads(future.result())
        except Exception as fault:  # as raised by an object of a job
            return Lost(Failure.CRASHED, f"sent an answer that cannot be read ({type(fault).__name__})")

    def _crash(self) -> Lost:
        """How the process ended in its job; raises LinkproofError if it never began one."""
        reason = self.process.end()
        if not self.output.exists():
            raise _start_error(f"one that {reason} at its start")
        written = self.output.read_bytes()[-_OUTPUT_END:]
        if any(words in written for words in _NO_MEMORY):
            return lost(MemoryError(), self.job.bounds.memory)
        return Lost(Failure.CRASHED, reason)

    def stop(self) -> None:
        """Kill the process, whatever it is doing, and all that it has started."""
        self.pool.stop()  # type: ignore[no-untyped-call]
        self.process.terminate()
        self.pool.join()
        self.output.unlink(missing_ok=True)


def _start_error(what: str) -> LinkproofError:
    return LinkproofError(f"expected to start a worker process, got {what}; run with --jobs 0 to do without")


class LastingPool:
    """Worker ``processes`` of this machine that outlive a list of jobs, so that they import and warm up once.

    A list whose results are not all taken ends the workers, and so does ``close``.
    """

    def __init__(self, processes: int = 1) -> None:
        self.processes = processes
        self._free: list[_Worker] = []
        self._busy: dict[Future[bytes], _Worker] = {}

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Begun = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in these workers, as ``run_jobs`` does."""
        pickled, module, left = pickle.dumps(function), _module_name(function), enumerate(jobs)
        ended: list[tuple[int, R | Lost]] = []
        try:
            while True:
                while len(self._busy) < self.processes and (numbered := next(left, None)) is not None:
                    number, arguments = numbered
                    job = _Job(number, pickled, pickle.dumps(arguments, pickle.HIGHEST_PROTOCOL), bounds)
                    self._begin(self._free_worker() or _Worker(module), job, begun)
                yield from ended
                if not self._busy:
                    return
                ended = list(self._ended(module, begun))
        except BaseException:
            self.close()
            raise

    def _free_worker(self) -> _Worker | None:
        """A worker without a job, if there is any that has not ended meanwhile."""
        while self._free:
            worker = self._free.pop()
            if worker.is_usable():
                return worker
            worker.stop()
        return None

    def _begin(self, worker: _Worker, job: _Job, begun: Begun) -> None:
        begun(job.number)
        self._busy[worker.begin(job)] = worker

    def _ended(self, module: str, begun: Begun) -> Iterator[tuple[int, Any]]:
        """Wait for results; the job that a used worker died of begins once more in a new one."""
        wait(self._busy, _PULSE, FIRST_COMPLETED)
        for future, worker in list(self._busy.items()):
            if not future.done() and worker.is_usable():
                continue
            result = worker.result(future)
            del self._busy[future]
            if isinstance(result, Lost) and result.outcome in (Failure.CRASHED, Failure.TIMED_OUT):
                worker.stop()  # its state is not known
            else:
                worker.used = True
                self._free.append(worker)
            if worker.used and worker.has_died:
                self._begin(_Worker(module), worker.job, begun)
            else:
                yield worker.job.number, result

    def close(self) -> None:
        """Kill the workers, busy or not."""
        workers = (*self._free, *self._busy.values())
        self._free, self._busy = [], {}
        for worker in workers:
            worker.pool.stop()  # type: ignore[no-untyped-call]
        for worker in workers:
            worker.stop()


def _module_name(function: Callable[..., Any]) -> str:
    """The module of a function, or of what a ``functools.partial`` calls."""
    while isinstance(function, partial):
        function = function.func
    return function.__module__


def run_jobs(
    function: Callable[..., R],
    jobs: Iterable[tuple[Any, ...]],
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    processes: int | None = None,
    begun: Begun = lambda _: None,
) -> Generator[tuple[int, R | Lost], None, None]:
    """Call ``function(*job)`` for every job, in worker processes; yields (index of the job, result) as they complete.

    ``function`` is of a module, or a ``functools.partial`` of one. Jobs begin in order, are taken from their iterable
    when workers need them, and ``begun`` is called with the index of each; a worker has its next job before its result
    is yielded. ``processes`` are the cores by default, never more than there are jobs. With 0 the jobs run in this
    process, one after the other and without bounds: only exceptions are caught.

    A job whose worker dies is tried once more if the worker had finished others before, which may have damaged it.
    A worker ignores Ctrl-C and writes nothing to the terminal. All workers are killed at once when the generator is
    closed or raises; when this process dies, each ends as soon as its Python code runs, at the latest with its job.
    """
    if processes == 0:
        yield from _run_here(function, jobs, bounds, begun)
        return
    with contextlib.closing(LastingPool(processes or cores())) as pool:
        yield from pool.run(function, jobs, bounds, begun)


def _run_here(
    function: Callable[..., R], jobs: Iterable[tuple[Any, ...]], bounds: Bounds, begun: Begun
) -> Iterator[tuple[int, R | Lost]]:
    for number, job in enumerate(jobs):
        begun(number)
        result: R | Lost
        try:
            result = function(*job)
        except (Exception, SystemExit) as error:
            result = lost(error, bounds.memory)
        yield number, result


@dataclass(frozen=True)
class LocalPool:
    """Worker ``processes`` of this machine, as ``run_jobs`` takes them."""

    processes: int | None = None

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Begun = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in worker processes."""
        return run_jobs(function, jobs, bounds=bounds, processes=self.processes, begun=begun)


EVERY_CORE, ONE_BY_ONE = LocalPool(), LocalPool(1)
Pool = LocalPool | LastingPool
