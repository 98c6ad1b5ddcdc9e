"""Worker processes at a list of jobs: one that crashes, hangs or runs out of memory costs its own job alone.

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
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Final

from analytic.errors import LinkproofError
from comparisons.runs.failures import GIB, Failure, Lost, lost
from comparisons.runs.worker_process import (
    START_MARK,
    BrokenMessageError,
    cut_off,
    message_of,
    received,
    serve,
    start_method,
    start_server,
)  # fmt: skip

# What C and C++ run-time libraries say when an allocation fails and nobody catches it.
_NO_MEMORY: Final = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")
_OUTPUT_END: Final = 4096  # bytes kept of the end of a worker's output, to see what it died of
_CHUNK: Final = 1 << 16
_ANSWERING: Final = 30.0  # s that a worker may pause in its answer
_DYING: Final = 2.0  # s within which a process must end after it has closed its connection
_PULSE: Final = 1.0  # s
_STARTING: Final = threading.Lock()  # a process is cut off as a whole, whichever of its threads starts a worker


@dataclass(frozen=True)
class Bounds:
    """What one job may take: ``seconds`` of wall time, and ``memory``, bytes that it may add to the address space.

    Address space counts what is reserved, touched or not. It is bounded where the system can (Linux).
    """

    seconds: float = 600.0
    memory: int = 4 * GIB


DEFAULT_BOUNDS = Bounds()


@dataclass(eq=False)
class _Worker:
    """A worker process; ``job`` is None while it is free, ``used`` once it has finished any.

    ``sent`` has come of a message, which bears the ``mark``.
    """

    process: BaseProcess
    channel: Connection
    output: Connection | None
    ready: bool = False
    used: bool = False
    job: int | None = None
    deadline: float = math.inf
    written: bytes = b""
    mark: bytes = START_MARK
    sent: bytearray = field(default_factory=bytearray)

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

    def listen(self) -> bool:
        """Take what has come of its message; False where nothing came and nothing will."""
        try:
            if not self.channel.poll():
                return self.process.is_alive()
            some = received(self.channel)
        except (EOFError, OSError):
            return False
        self.deadline = max(self.deadline, time.monotonic() + _ANSWERING)  # a long answer may be heard late
        self.sent += some
        return bool(some)

    def exit_code(self) -> int | None:
        """Exit code of a process that has closed its connection, or None if it still runs after 2 s."""
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
class Crew:
    """Workers at a list of jobs, on a machine that their results name where ``host`` is given.

    ``alive`` is called at least every second while they work; what it raises ends the work.
    """

    function: Callable[..., Any]
    jobs: Sequence[tuple[Any, ...]]
    bounds: Bounds
    size: int
    begun: Callable[[int], object] = lambda _: None
    alive: Callable[[], object] = lambda: None
    host: str = ""
    workers: list[_Worker] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.todo = deque(range(len(self.jobs)))
        self.again: set[int] = set()  # jobs that died in a worker which another job may have spoilt
        self.pickled = pickle.dumps(self.function)

    def results(self) -> Iterator[tuple[int, Any]]:
        """Every job's result, as they complete; a worker has its next job before its result is handed on.

        The workers stay until ``close``.
        """
        left = len(self.jobs)
        while left:
            self._hire()
            self._wait()
            found = [result for worker in list(self.workers) for result in (*self._heard(worker), *self._late(worker))]
            left -= len(found)
            if found:
                self._hire()
            yield from found

    def take_up(self, jobs: Sequence[tuple[Any, ...]], seconds: float) -> Iterator[tuple[int, Any]]:
        """Results of further jobs, each of which may take so many seconds; workers of earlier ones make them."""
        self.jobs, self.todo, self.bounds = jobs, deque(range(len(jobs))), replace(self.bounds, seconds=seconds)
        self.again.clear()
        return self.results()

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
            self.workers.append(_started(self.pickled, self.function, self.bounds.memory, self.host))
        for worker in self._free():
            if self.todo and not (worker.used and self.todo[0] in self.again):
                self._assign(worker, self.todo.popleft())

    def _free(self) -> list[_Worker]:
        return [worker for worker in self.workers if worker.ready and worker.job is None]

    def _assign(self, worker: _Worker, number: int) -> None:
        message = pickle.dumps(self.jobs[number], protocol=pickle.HIGHEST_PROTOCOL)
        worker.job, worker.written, worker.mark = number, b"", os.urandom(len(START_MARK))
        worker.deadline = time.monotonic() + self.bounds.seconds
        self.begun(number)
        with contextlib.suppress(OSError):  # a worker that died meanwhile is found when it is waited for
            worker.channel.send_bytes(worker.mark)
            worker.channel.send_bytes(message)

    def _wait(self) -> None:
        """Wait until any worker says or writes something, ends or is late."""
        first = min(worker.deadline for worker in self.workers)
        seconds = min(_PULSE, max(0.0, first - time.monotonic()))
        wait([source for worker in self.workers for source in worker.sources], seconds)
        self.alive()
        for worker in self.workers:
            worker.read_output()

    def _heard(self, worker: _Worker) -> list[tuple[int, Any]]:
        """The job that a worker's message or death ends."""
        if not worker.listen():
            return self._died(worker, _how(worker.exit_code()))
        try:
            message = message_of(worker.sent, worker.mark, self.bounds.memory)
        except BrokenMessageError:
            return self._died(worker, "wrote into the pipe that its result comes through")
        if message is None:
            return []
        worker.sent.clear()
        number, worker.job, worker.mark, worker.deadline = worker.job, None, b"", math.inf
        if number is None:
            worker.ready = True
            return []
        worker.used = True
        result = self._read(message)
        if isinstance(result, Lost) and result.outcome is Failure.CRASHED:
            self._dismiss(worker)  # who knows in what state it was left
        return [(number, result)]

    def _read(self, message: bytes) -> object:
        """A job's result; one that cannot be read back here is lost."""
        try:
            return pickle.loads(message)
        except Exception as error:
            return lost(error, self.bounds.memory)

    def _died(self, worker: _Worker, how: str) -> list[tuple[int, Lost]]:
        """The end of a worker, whose job is done by another if this one had done any before."""
        number = worker.job
        worker.read_output()
        self._dismiss(worker)
        if not worker.ready:
            raise LinkproofError(
                f"expected a worker process, got one that {how} at its start: run with --jobs 0 to do without"
            )
        if number is None:
            return []
        if worker.used:
            self.again.add(number)
            self.todo.appendleft(number)
            return []
        if any(words in worker.written for words in _NO_MEMORY):
            return [(number, lost(MemoryError(), self.bounds.memory))]
        return [(number, Lost(Failure.CRASHED, how))]

    def _late(self, worker: _Worker) -> list[tuple[int, Lost]]:
        """The job of a worker past its deadline; one that has answered meanwhile is not, however late it is asked."""
        in_time = worker not in self.workers or worker.deadline > time.monotonic()
        if in_time or (not worker.sent and worker.channel.poll()):
            return []
        assert worker.job is not None
        self._dismiss(worker)
        return [(worker.job, Lost(Failure.TIMED_OUT, f"took longer than {self.bounds.seconds:g} s"))]

    def _dismiss(self, worker: _Worker) -> None:
        self.workers.remove(worker)
        worker.stop()


def _started(pickled: bytes, function: Callable[..., Any], memory: int, host: str) -> _Worker:
    """A worker that has been started, though it may not be ready yet."""
    while isinstance(function, partial):
        function = function.func
    try:
        start_server([function.__module__])
        context = multiprocessing.get_context(start_method())
        channel, far_end = context.Pipe()
        output, far_output = context.Pipe(duplex=False) if os.name == "posix" else (None, None)
        process = context.Process(  # type: ignore[attr-defined]
            target=serve, args=(far_end, far_output, pickled, memory, host), daemon=True
        )
        with _STARTING, cut_off():
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
        return "closed its connection without ending"
    if code >= 0:
        return f"exited with code {code}"
    with contextlib.suppress(ValueError):
        return f"died by signal {-code} ({signal.Signals(-code).name})"
    return f"died by signal {-code}"
