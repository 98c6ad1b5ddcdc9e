"""Worker processes for lists of jobs: one that crashes, hangs or runs out of memory costs its own job alone.

Every worker has a pipe of its own and one job at a time, so nothing is shared that a dying process could leave locked,
and whatever it was doing is known. The parent needs no threads: it waits for all pipes at once.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from multiprocessing.util import get_temp_dir
from typing import Any, Final, NamedTuple, TypeVar

from analytic.errors import LinkproofError
from analytic.machine_code import cores
from comparisons.runs.run_engine import GIB, Failure, Lost, lost
from comparisons.runs.worker_process import isolated_start, serve, start_method, start_server

R = TypeVar("R")

# What C and C++ run-time libraries write when an allocation fails and nobody catches it.
_NO_MEMORY: Final = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")
_OUTPUT_END: Final = 4096  # bytes of the end of a worker's output that are searched for these
_CHUNK: Final = 1 << 16
_EXIT_TIMEOUT: Final = 2.0  # s within which a process must end after it has closed its connection
_PULSE: Final = 1.0  # s, after which a Ctrl-C is noticed where it does not interrupt a wait
_START_LOCK: Final = threading.Lock()  # a process is cut off as a whole, whichever of its threads starts a worker


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
    """A job by its index; one ``needs_new`` worker where an earlier job may have spoilt the one that it died in."""

    number: int
    arguments: tuple[Any, ...]
    needs_new: bool = False


@dataclass(eq=False)
class _Worker:
    """A worker process; ``job`` is None while it is free, ``used`` is True once it has finished any."""

    process: BaseProcess
    channel: Connection
    output: Connection | None
    ready: bool = False
    used: bool = False
    job: _Job | None = None
    deadline: float = math.inf
    written: bytes = b""

    @property
    def sources(self) -> list[Connection | int]:
        """Handles to wait for: its messages, its output, its end."""
        return [self.channel, self.process.sentinel, *([self.output] if self.output else [])]

    def read_output(self) -> None:
        """Read what it has printed, and store the end of it; a full pipe would stop the worker."""
        while self.output is not None and self.output.poll():
            text = os.read(self.output.fileno(), _CHUNK)
            self.written = (self.written + text)[-_OUTPUT_END:]
            if not text:
                self.output.close()
                self.output = None

    def exit_code(self) -> int | None:
        """Exit code, or None if the process still runs after 2 s."""
        end = time.monotonic() + _EXIT_TIMEOUT
        while self.process.exitcode is None and time.monotonic() < end:
            time.sleep(1e-3)
        return self.process.exitcode

    def kill(self) -> None:
        """Kill the process, whatever it is doing, and all that it has started."""
        if hasattr(os, "killpg") and self.process.pid is not None:
            with contextlib.suppress(ProcessLookupError, PermissionError):  # no group yet, or no longer
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.join()
        self.channel.close()
        if self.output is not None:
            self.output.close()


@dataclass
class WorkerPool:
    """At most ``size`` worker processes for ``jobs``, which are taken from their iterable when they are needed.

    ``begun`` is called with the index of each job that begins.
    """

    function: Callable[..., Any]
    jobs: Iterable[tuple[Any, ...]]
    bounds: Bounds
    size: int
    begun: Callable[[int], object] = lambda _: None
    workers: list[_Worker] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.todo: deque[_Job] = deque()
        self.pickled = pickle.dumps(self.function)

    def results(self) -> Iterator[tuple[int, Any]]:
        """The result of every job, as they complete; a worker has its next job before its result is yielded.

        The workers run until ``close``.
        """
        left = enumerate(self.jobs)
        self._start(left)
        while self.todo or any(worker.job for worker in self.workers):
            self._wait()
            results = [
                pair for worker in list(self.workers) for pair in (*self._receive(worker), *self._timed_out(worker))
            ]
            self._start(left)
            yield from results

    def run_more(self, jobs: Iterable[tuple[Any, ...]], seconds: float) -> Iterator[tuple[int, Any]]:
        """Results of further jobs, each of which may take so many seconds; workers of earlier ones make them."""
        self.jobs, self.bounds = jobs, replace(self.bounds, seconds=seconds)
        return self.results()

    def close(self) -> None:
        """Kill all workers, busy or not, and forget their jobs."""
        self.todo.clear()
        while self.workers:
            self.workers.pop().kill()

    def _start(self, left: Iterator[tuple[int, tuple[Any, ...]]]) -> None:
        """Give every free worker a job, and start as many workers as there are jobs for."""
        self.todo.extend(_Job(*numbered) for numbered in islice(left, max(0, self.size - len(self.todo))))
        if self.todo and self.todo[0].needs_new:
            for worker in self._free_workers():
                if worker.used:
                    self._stop(worker)
        busy = sum(worker.job is not None for worker in self.workers)
        while len(self.workers) < min(self.size, busy + len(self.todo)):
            self.workers.append(_new_worker(self.pickled, self.function, self.bounds.memory))
        for worker in self._free_workers():
            if self.todo and not (worker.used and self.todo[0].needs_new):
                self._assign(worker, self.todo.popleft())

    def _free_workers(self) -> list[_Worker]:
        return [worker for worker in self.workers if worker.ready and worker.job is None]

    def _assign(self, worker: _Worker, job: _Job) -> None:
        message = pickle.dumps(job.arguments, protocol=pickle.HIGHEST_PROTOCOL)
        worker.job, worker.written = job, b""
        worker.deadline = time.monotonic() + self.bounds.seconds
        self.begun(job.number)
        with contextlib.suppress(OSError):  # a worker that died meanwhile is noticed when it is waited for
            worker.channel.send_bytes(message)

    def _wait(self) -> None:
        """Wait until any worker sends or prints something, ends or is late."""
        first = min(worker.deadline for worker in self.workers)
        seconds = min(_PULSE, max(0.0, first - time.monotonic()))
        wait([source for worker in self.workers for source in worker.sources], seconds)
        for worker in self.workers:
            worker.read_output()

    def _receive(self, worker: _Worker) -> list[tuple[int, Any]]:
        """The job that a worker's message or death ends, with its result."""
        try:
            if not worker.channel.poll():
                return [] if worker.process.is_alive() else self._crashed(worker, _exit_reason(worker.exit_code()))
            message = worker.channel.recv_bytes(self.bounds.memory)
        except (EOFError, OSError):  # it has closed the pipe, or written into it
            return self._crashed(worker, _exit_reason(worker.exit_code()))
        job, worker.job, worker.deadline = worker.job, None, math.inf
        if job is None:
            worker.ready = True
            return []
        worker.used = True
        try:
            result = pickle.loads(message)
        except Exception as error:  # as raised by an object of a job, or by bytes that an engine has written
            result = Lost(Failure.CRASHED, f"sent an answer that cannot be read ({type(error).__name__})")
        if isinstance(result, Lost) and result.outcome is Failure.CRASHED:
            self._stop(worker)  # its state is not known
        return [(job.number, result)]

    def _crashed(self, worker: _Worker, reason: str) -> list[tuple[int, Lost]]:
        """The job that a worker died of; it is tried once more if the worker had finished another before."""
        worker.read_output()
        self._stop(worker)
        if not worker.ready:
            raise LinkproofError(
                f"expected a worker process, got one that {reason} at its start: run with --jobs 0 to do without"
            )
        if worker.job is None:
            return []
        if worker.used:
            self.todo.appendleft(worker.job._replace(needs_new=True))
            return []
        if any(words in worker.written for words in _NO_MEMORY):
            return [(worker.job.number, lost(MemoryError(), self.bounds.memory))]
        return [(worker.job.number, Lost(Failure.CRASHED, reason))]

    def _timed_out(self, worker: _Worker) -> list[tuple[int, Lost]]:
        """The job of a worker past its deadline; a message that has arrived is in time, however late it is read."""
        if worker not in self.workers or worker.deadline > time.monotonic() or worker.channel.poll():
            return []
        assert worker.job is not None
        self._stop(worker)
        return [(worker.job.number, Lost(Failure.TIMED_OUT, f"took longer than {self.bounds.seconds:g} s"))]

    def _stop(self, worker: _Worker) -> None:
        self.workers.remove(worker)
        worker.kill()


def _new_worker(pickled: bytes, function: Callable[..., Any], memory: int) -> _Worker:
    """A worker process that has been started, though it may not be ready yet."""
    while isinstance(function, partial):
        function = function.func
    try:
        start_server([function.__module__])
        context = multiprocessing.get_context(start_method())
        get_temp_dir()  # of this process, and so of its workers
        channel, far_end = context.Pipe()
        output, far_output = context.Pipe(duplex=False) if os.name == "posix" else (None, None)
        process = context.Process(  # type: ignore[attr-defined]
            target=serve, args=(far_end, far_output, pickled, memory), daemon=True
        )
        with _START_LOCK, isolated_start():
            process.start()
    except (OSError, EOFError) as error:
        raise LinkproofError(
            f"expected to start a worker process, got {type(error).__name__}: {error}; run with --jobs 0 to do without"
        ) from error
    for end in filter(None, (far_end, far_output)):
        end.close()
    return _Worker(process, channel, output)


def _exit_reason(code: int | None) -> str:
    """How a process ended, from its exit code as multiprocessing gives it; None if it still runs."""
    if code is None:
        return "closed its connection without ending"
    if code >= 0:
        return f"exited with code {code}"
    with contextlib.suppress(ValueError):
        return f"died by signal {-code} ({signal.Signals(-code).name})"
    return f"died by signal {-code}"


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
    closed or raises; when this process dies, each ends as soon as its Python code runs, at the latest with its job.
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
