"""A worker process as its parent sees it: started, told a job, listened to, stopped."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from analytic.errors import LinkproofError
from comparisons.runs import worker_process
from comparisons.runs.worker_process import unheard

# How much of the end of a worker's output is kept, to see what it died of.
_HEARD = 4096
_CHUNK = 1 << 16
# Seconds that a process which has hung up is given to end.
_DYING = 2.0


@dataclass(eq=False)
class Worker:
    """A worker process and what it is at; ``job`` is None while it is free, ``used`` once it has finished any."""

    process: BaseProcess
    channel: Connection
    output: Connection | None
    ready: bool = False
    used: bool = False
    job: int | None = None
    deadline: float = float("inf")
    heard: bytes = b""

    def listen(self) -> None:
        """Take what it has written since, keeping the end of it, so that a full pipe never holds it up."""
        while self.output is not None and self.output.poll():
            told = os.read(self.output.fileno(), _CHUNK)
            self.heard = (self.heard + told)[-_HEARD:]
            if not told:
                self.output.close()
                self.output = None

    def exit_code(self) -> int | None:
        """Exit code of a process that has hung up, None if it does not end: it may have closed what it is joined by."""
        patience = time.monotonic() + _DYING
        while self.process.exitcode is None and time.monotonic() < patience:
            time.sleep(1e-3)
        return self.process.exitcode

    def stop(self) -> None:
        """Kill it, whatever it is at."""
        self.process.kill()
        self.process.join()
        self.channel.close()
        if self.output is not None:
            self.output.close()


def started(pickled: bytes, function: Callable[..., Any], memory: int) -> Worker:
    """A worker that has been started, though it may not be ready yet."""
    while isinstance(function, partial):
        function = function.func
    try:
        worker_process.start_server([function.__module__])
        context = multiprocessing.get_context(worker_process.start_method())
        channel, far_end = context.Pipe()
        output, far_output = context.Pipe(duplex=False) if os.name == "posix" else (None, None)
        process = context.Process(  # type: ignore[attr-defined]
            target=worker_process.serve, args=(far_end, far_output, pickled, memory), daemon=True
        )
        with unheard():
            process.start()
    except (OSError, EOFError) as error:
        raise LinkproofError(
            f"expected to start a worker process, got {type(error).__name__}: {error}; run with --jobs 0 to do without"
        ) from error
    far_end.close()
    if far_output is not None:
        far_output.close()
    return Worker(process, channel, output)


def read(message: bytes) -> tuple[int, Any]:
    """A worker's message; one that cannot be read back here is the job's fault, not ours."""
    try:
        kind, told = pickle.loads(message)
    except Exception as error:
        return worker_process.failure(error)
    return kind, told


def how(code: int | None) -> str:
    """How a process ended, from its exit code as multiprocessing gives it; None while it still runs."""
    if code is None:
        return "hung up without ending"
    if code >= 0:
        return f"exited with code {code}"
    try:
        return f"died by signal {-code} ({signal.Signals(-code).name})"
    except ValueError:
        return f"died by signal {-code}"
