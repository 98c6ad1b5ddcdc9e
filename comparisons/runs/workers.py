"""Jobs in worker processes, each within bounds: one that crashes, hangs or runs out of memory fails alone.

Every worker has a pipe of its own and holds one job at a time, so nothing is shared that a dying process could leave
locked, and whatever it was doing is known. The parent needs no threads: it waits for all pipes at once.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import os
import pickle
import signal
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Final, Protocol, TypeVar

from analytic.compiled.choice import cores
from analytic.errors import LinkproofError
from comparisons.runs.failures import GIB, Failure, Lost, lost
from comparisons.runs.worker_process import READY, cut_off, serve, start_method, start_server

R = TypeVar("R")

# What C and C++ run-time libraries say when an allocation fails and nobody catches it.
_NO_MEMORY: Final = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")
_OUTPUT_END: Final = 4096  # bytes kept of the end of a worker's output, to see what it died of
_CHUNK: Final = 1 << 16
_DYING: Final = 2.0  # s that a process which has hung up is given to end


@dataclass(frozen=True)
class Bounds:
    """What one job may take: ``seconds`` of wall time, and ``memory``, bytes that it may add to the address space.

    Address space counts what is reserved, touched or not. It is bounded where the system can (Linux).
    """

    seconds: float = 600.0
    memory: int = 4 * GIB


DEFAULT_BOUNDS = Bounds()


def usual_processes(count: int) -> int:
    """How many processes ``count`` jobs are given where nobody says: the cores; none for a single one."""
    return 0 if count == 1 else cores()


class Pool(Protocol):
    """Where jobs are run."""

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

    def run(
        self,
        function: Callable[..., R],
        jobs: Sequence[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in worker processes."""
        return run_jobs(function, jobs, bounds=bounds, processes=self.processes, begun=begun)


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
    crew = _Crew(function, jobs, bounds, min(processes or cores(), len(jobs)), begun)
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


@dataclass(eq=False)
class _Worker:
    """A worker process; ``job`` is None while it is free, ``used`` once it has finished any."""

    process: BaseProcess
    channel: Connection
    output: Connection | None
    ready: bool = False
    used: bool = False
    job: int | None = None
    deadline: float = math.inf
    written: bytes = b""

    @property
    def sources(self) -> list[Connection | int]:
        """What can be waited for: its messages, its output, its end."""
        return [self.channel, self.process.sentinel, *([self.output] if self.output else [])]

    def read_output(self) -> None:
        """Take what it has written since, keeping the end of it, so that a full pipe never holds it up."""
        while self.output is not None and self.output.poll():
            text = os.read(self.output.fileno(), _CHUNK)
            self.written = (self.written + text)[-_OUTPUT_END:]
            if not text:
                self.output.close()
                self.output = None

    def exit_code(self) -> int | None:
        """Exit code of a process that has hung up, None if it does not end: it may have closed what it is joined by."""
        patience = time.monotonic() + _DYING
        while self.process.exitcode is None and time.monotonic() < patience:
            time.sleep(1e-3)
        return self.process.exitcode

    def stop(self) -> None:
        """Kill it, whatever it is doing, and what it has started."""
        if hasattr(os, "killpg") and self.process.pid is not None:
            with contextlib.suppress(ProcessLookupError, PermissionError):  # no group yet, or none any more
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.join()
        self.channel.close()
        if self.output is not None:
            self.output.close()


@dataclass
class _Crew:
    """Workers at a list of jobs."""

    function: Callable[..., Any]
    jobs: Sequence[tuple[Any, ...]]
    bounds: Bounds
    size: int
    begun: Callable[[int], object]
    workers: list[_Worker] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.todo = deque(range(len(self.jobs)))
        self.again: set[int] = set()  # jobs that died in a worker which another job may have spoilt
        self.pickled = pickle.dumps(self.function)

    def results(self) -> Iterator[tuple[int, Any]]:
        """Every job's result, as they complete; a worker has its next job before its result is handed on."""
        left = len(self.jobs)
        while left:
            self._hire()
            self._wait()
            found = [result for worker in list(self.workers) for result in (*self._heard(worker), *self._late(worker))]
            left -= len(found)
            if found:
                self._hire()
            yield from found

    def close(self) -> None:
        """Kill all workers, busy or not."""
        while self.workers:
            self.workers.pop().stop()

    def _hire(self) -> None:
        """Have as many workers as there is work for, each of them busy."""
        fresh = bool(self.todo) and self.todo[0] in self.again  # the next job has died in a used worker already
        for worker in self._free():
            if fresh and worker.used:
                self._dismiss(worker)
        busy = sum(worker.job is not None for worker in self.workers)
        while len(self.workers) < min(self.size, busy + len(self.todo)):
            self.workers.append(_started(self.pickled, self.function, self.bounds.memory))
        for worker in self._free():
            if self.todo and not (worker.used and self.todo[0] in self.again):
                self._assign(worker, self.todo.popleft())

    def _free(self) -> list[_Worker]:
        return [worker for worker in self.workers if worker.ready and worker.job is None]

    def _assign(self, worker: _Worker, number: int) -> None:
        message = pickle.dumps(self.jobs[number], protocol=pickle.HIGHEST_PROTOCOL)
        worker.job, worker.written = number, b""
        worker.deadline = time.monotonic() + self.bounds.seconds
        self.begun(number)
        with contextlib.suppress(OSError):  # a worker that died meanwhile is found when it is waited for
            worker.channel.send_bytes(message)

    def _wait(self) -> None:
        """Wait until any worker says or writes something, ends or is late."""
        first = min(worker.deadline for worker in self.workers)
        seconds = None if first == math.inf else max(0.0, first - time.monotonic())
        wait([source for worker in self.workers for source in worker.sources], seconds)
        for worker in self.workers:
            worker.read_output()

    def _heard(self, worker: _Worker) -> list[tuple[int, Any]]:
        """The job that a worker's message or death ends."""
        try:
            if not worker.channel.poll():
                if worker.process.is_alive():
                    return []
                raise EOFError
            message = worker.channel.recv_bytes()
        except (EOFError, OSError):
            return self._died(worker)
        if message == READY:
            worker.ready = True
            return []
        result = self._read(message)
        number, worker.job, worker.deadline, worker.used = worker.job, None, math.inf, True
        assert number is not None
        if isinstance(result, Lost) and result.outcome is Failure.CRASHED:
            self._dismiss(worker)  # who knows in what state it was left
        return [(number, result)]

    def _read(self, message: bytes) -> object:
        """A job's result; one that cannot be read back here is lost."""
        try:
            return pickle.loads(message)
        except Exception as error:
            return lost(error, self.bounds.memory)

    def _died(self, worker: _Worker) -> list[tuple[int, Lost]]:
        code, number = worker.exit_code(), worker.job
        worker.read_output()
        self._dismiss(worker)
        if not worker.ready:
            raise LinkproofError(
                f"expected a worker process, got one that {_how(code)} at its start: run with --jobs 0 to do without"
            )
        if number is None:
            return []
        if worker.used:
            self.again.add(number)
            self.todo.appendleft(number)
            return []
        if any(words in worker.written for words in _NO_MEMORY):
            return [(number, lost(MemoryError(), self.bounds.memory))]
        return [(number, Lost(Failure.CRASHED, _how(code)))]

    def _late(self, worker: _Worker) -> list[tuple[int, Lost]]:
        """The job of a worker past its deadline; one that has answered meanwhile is not, however late it is asked."""
        if worker not in self.workers or worker.deadline > time.monotonic() or worker.channel.poll():
            return []
        assert worker.job is not None
        self._dismiss(worker)
        return [(worker.job, Lost(Failure.TIMED_OUT, f"took longer than {self.bounds.seconds:g} s"))]

    def _dismiss(self, worker: _Worker) -> None:
        self.workers.remove(worker)
        worker.stop()


def _started(pickled: bytes, function: Callable[..., Any], memory: int) -> _Worker:
    """A worker that has been started, though it may not be ready yet."""
    while isinstance(function, partial):
        function = function.func
    try:
        start_server([function.__module__])
        context = multiprocessing.get_context(start_method())
        channel, far_end = context.Pipe()
        output, far_output = context.Pipe(duplex=False) if os.name == "posix" else (None, None)
        process = context.Process(  # type: ignore[attr-defined]
            target=serve, args=(far_end, far_output, pickled, memory), daemon=True
        )
        with cut_off():
            process.start()
    except (OSError, EOFError) as error:
        raise LinkproofError(
            f"expected to start a worker process, got {type(error).__name__}: {error}; run with --jobs 0 to do without"
        ) from error
    for end in filter(None, (far_end, far_output)):
        end.close()
    return _Worker(process, channel, output)


def _how(code: int | None) -> str:
    """How a process ended, from its exit code as multiprocessing gives it; None while it still runs."""
    if code is None:
        return "hung up without ending"
    if code >= 0:
        return f"exited with code {code}"
    with contextlib.suppress(ValueError):
        return f"died by signal {-code} ({signal.Signals(-code).name})"
    return f"died by signal {-code}"
