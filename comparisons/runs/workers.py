"""Jobs in worker processes, each within a time and memory bound: a job that dies, hangs or swells costs itself alone.

Every worker has a pipe of its own and holds one job at a time, so nothing is shared that a dying process could leave
locked, and whatever it was doing is known. The parent needs no threads: it waits for all pipes at once.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from typing import Any, TypeVar

from analytic.errors import LinkproofError
from comparisons.runs.worker_handle import Worker, how, read, started
from comparisons.runs.worker_process import DONE, EXITED, OUT_OF_MEMORY, READY, failure
from engines.contract import Outcome

R = TypeVar("R")

GIB = 1 << 30
# What C and C++ run-time libraries say when an allocation fails and nobody catches it.
_OUT_OF_MEMORY_WORDS = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")


@dataclass(frozen=True)
class Bounds:
    """What one job may take: ``seconds`` of wall time, and ``memory``, bytes that it may add to the address space.

    Address space counts what is reserved, touched or not. It is bounded where the system can (Linux).
    """

    seconds: float = 600.0
    memory: int = 4 * GIB


DEFAULT_BOUNDS = Bounds()


@dataclass(frozen=True)
class Lost:
    """A job that gave no result: TIMED_OUT or CRASHED, DIVERGED where it raised; ``reason`` in one sentence."""

    outcome: Outcome
    reason: str


def cores() -> int:
    """Processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def usual_processes(count: int) -> int:
    """How many processes ``count`` jobs are given where nobody says: the cores; none for a single one."""
    return 0 if count == 1 else cores()


def as_sent(value: R) -> R:
    """A copy as a worker would have it, for jobs that are to give the same here to the last bit.

    Sending an array changes how it lies in memory, and that the order in which linear algebra adds up.
    """
    copy: R = pickle.loads(pickle.dumps(value))
    return copy


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
            result = _lost(*failure(error), bounds)
        yield number, result


def _lost(kind: int, told: object, bounds: Bounds) -> Lost:
    """What a failed job comes to, from the worker's message on it."""
    if kind == OUT_OF_MEMORY:
        return Lost(Outcome.CRASHED, f"needed more than {bounds.memory / GIB:.3g} GiB of memory")
    if kind == EXITED:
        return Lost(Outcome.CRASHED, f"exited with code {told}")
    return Lost(Outcome.DIVERGED, str(told))


@dataclass
class _Crew:
    """Workers at a list of jobs."""

    function: Callable[..., Any]
    jobs: Sequence[tuple[Any, ...]]
    bounds: Bounds
    size: int
    begun: Callable[[int], object]
    workers: list[Worker] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.todo = deque(range(len(self.jobs)))
        self.again: set[int] = set()  # jobs that died in a worker which another job may have spoilt
        self.pickled = pickle.dumps(self.function)

    def results(self) -> Iterator[tuple[int, Any]]:
        """Every job's result, as they complete; a worker has its next job before its result is handed on."""
        left = len(self.jobs)
        while left:
            self._hire()
            found = [*self._told(self._waiting_time()), *self._overdue()]
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
        if self._needs_fresh():
            for worker in [worker for worker in self._free() if worker.used]:
                self._dismiss(worker)
        busy = sum(worker.job is not None for worker in self.workers)
        while len(self.workers) < min(self.size, busy + len(self.todo)):
            self.workers.append(started(self.pickled, self.function, self.bounds.memory))
        for worker in self._free():
            if self.todo and not (worker.used and self._needs_fresh()):
                self._assign(worker, self.todo.popleft())

    def _free(self) -> list[Worker]:
        return [worker for worker in self.workers if worker.ready and worker.job is None]

    def _needs_fresh(self) -> bool:
        """Whether the next job has died in a used worker already."""
        return bool(self.todo) and self.todo[0] in self.again

    def _assign(self, worker: Worker, number: int) -> None:
        message = pickle.dumps(self.jobs[number], protocol=pickle.HIGHEST_PROTOCOL)
        worker.job, worker.heard = number, b""
        worker.deadline = time.monotonic() + self.bounds.seconds
        self.begun(number)
        with contextlib.suppress(OSError):  # a worker that died meanwhile is found when it is waited for
            worker.channel.send_bytes(message)

    def _waiting_time(self) -> float | None:
        first = min(worker.deadline for worker in self.workers)
        return None if first == float("inf") else max(0.0, first - time.monotonic())

    def _told(self, seconds: float | None) -> list[tuple[int, Any]]:
        """Wait for any worker to say or write something or to die; returns the jobs that this ends."""
        sources = [
            source
            for worker in self.workers
            for source in (worker.channel, worker.output, worker.process.sentinel)
            if source is not None
        ]
        wait(sources, seconds)
        for worker in self.workers:
            worker.listen()
        return [found for worker in list(self.workers) for found in self._heard_from(worker)]

    def _heard_from(self, worker: Worker) -> list[tuple[int, Any]]:
        try:
            if not worker.channel.poll():
                if worker.process.is_alive():
                    return []
                raise EOFError
            kind, told = read(worker.channel.recv_bytes())
        except (EOFError, OSError):
            return self._died(worker)
        if kind == READY:
            worker.ready = True
            return []
        number, worker.job, worker.deadline, worker.used = worker.job, None, float("inf"), True
        assert number is not None
        if kind in (EXITED, OUT_OF_MEMORY):
            self._dismiss(worker)  # who knows in what state it was left
        return [(number, told if kind == DONE else _lost(kind, told, self.bounds))]

    def _died(self, worker: Worker) -> list[tuple[int, Lost]]:
        code, number = worker.exit_code(), worker.job
        worker.listen()
        self._dismiss(worker)
        if not worker.ready:
            raise LinkproofError(
                f"expected a worker process, got one that {how(code)} at its start: run with --jobs 0 to do without"
            )
        if number is None:
            return []
        if worker.used:
            self.again.add(number)
            self.todo.appendleft(number)
            return []
        if any(words in worker.heard for words in _OUT_OF_MEMORY_WORDS):
            return [(number, _lost(OUT_OF_MEMORY, None, self.bounds))]
        return [(number, Lost(Outcome.CRASHED, how(code)))]

    def _overdue(self) -> list[tuple[int, Lost]]:
        """Jobs past their deadline; one that has answered meanwhile is not, however late it was asked."""
        now, found = time.monotonic(), []
        for worker in [w for w in self.workers if w.deadline <= now and not w.channel.poll()]:
            assert worker.job is not None
            found.append((worker.job, Lost(Outcome.TIMED_OUT, f"took longer than {self.bounds.seconds:g} s")))
            self._dismiss(worker)
        return found

    def _dismiss(self, worker: Worker) -> None:
        self.workers.remove(worker)
        worker.stop()
