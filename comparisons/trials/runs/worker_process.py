"""A worker: a process that does one job at a time, each within its bounds, and tells when it begins and ends.

Jobs and answers are files, and a byte over a socket only says that it is time to look: whatever an engine writes into
it, the command waits for nothing that does not come.
"""

from __future__ import annotations

import contextlib
import faulthandler
import functools
import math
import multiprocessing
import os
import pickle
import signal
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import forkserver, util
from multiprocessing.connection import wait
from pathlib import Path
from types import ModuleType
from typing import Any, Final
from uuid import uuid4

from analytic.errors import LinkproofError
from comparisons.trials.runs.run_engine import SHOW_OUTPUT, Bounds, Failure, Lost, lost
from engines.registry import silenced

START: Final = "LINKPROOF_WORKER_START"  # how workers are started: forkserver or spawn, as in multiprocessing
_START_LOCK: Final = threading.Lock()  # the main module is hidden from one start at a time
_EXIT_TIMEOUT: Final = 2.0  # s within which a process must end after it has broken its connection
# What C and C++ run-time libraries write when an allocation fails and nobody catches it.
_NO_MEMORY: Final = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")
_OUTPUT_END: Final = 4096  # bytes of the end of a worker's output that are searched for these
_PULSE: Final = 1.0  # s, after which a Ctrl-C is noticed where it does not interrupt a wait
_LOOK: Final = b"."  # there is a job, it is begun, or there is an answer


def start_method() -> str:
    """The start of workers: forked in 5 ms from a server without threads that has imported what they need.

    On Windows, which has no such server, and on macOS, whose libraries may not be forked, every worker is spawned and
    imports anew. ``START`` in the environment overrules it.
    """
    return os.environ.get(START) or ("forkserver" if sys.platform.startswith("linux") else "spawn")


def start_server(modules: Sequence[str]) -> None:
    """Start the server that forks workers, if it does not run yet, and have it import these modules.

    Returns at once: if it is called early, the server imports while the caller does. It imports from the same folders
    as this process, not from the working folder, and its workers print nothing unless it is requested.
    """
    if start_method() != "forkserver":
        return
    forkserver.set_forkserver_preload([__name__, *modules])
    path = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
    before = dict(os.environ)
    os.environ.update(PYTHONPATH=path, PYTHONSAFEPATH="1")
    try:
        with _main_module_hidden(), _output_to(os.devnull):
            forkserver.ensure_running()
    finally:
        for name in ("PYTHONPATH", "PYTHONSAFEPATH"):
            del os.environ[name]
            os.environ.update({name: before[name]} if name in before else {})


@contextlib.contextmanager
def _main_module_hidden() -> Iterator[None]:
    """A process started here does not import the main module, which has no job in it.

    So a script that calls us needs no ``if __name__ == "__main__"``, and a command line is not imported twice.
    """
    with _START_LOCK:
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


def _output_to(path: str) -> contextlib.AbstractContextManager[None]:
    """Append what this process writes to a file, unless its output is requested."""
    return contextlib.nullcontext() if os.environ.get(SHOW_OUTPUT) else silenced(path)


class Worker:
    """A worker process and the job that it has; it has been ``used`` once it has finished any."""

    job: tuple[int, bytes, bytes, Bounds]  # index, function and arguments, pickled, and bounds

    def __init__(self, module: str) -> None:
        """Start it; ``module`` is what its jobs need. Raises LinkproofError where that is not possible."""
        self.used = self.has_died = False
        self.place = Path(util.get_temp_dir()) / uuid4().hex
        try:
            self.wire, theirs = socket.socketpair()
            self.wire.setblocking(False)
            start_server([module])
            context: Any = multiprocessing.get_context(start_method())
            self.process = context.Process(target=_serve, args=(theirs, str(self.place)), daemon=True)
            with theirs, _main_module_hidden():
                self.process.start()
        except (OSError, EOFError) as error:
            raise _start_error(f"{type(error).__name__}: {error}") from error

    def begin(self, job: tuple[int, bytes, bytes, Bounds]) -> None:
        """Give it a job; its time begins when the worker takes it."""
        self.job, self.deadline = job, math.inf
        _, function, arguments, bounds = job
        self.place.with_suffix(".job").write_bytes(pickle.dumps((function, arguments, bounds.memory)))
        with contextlib.suppress(OSError):  # a process that has ended is seen by its end of the wire
            self.wire.send(_LOOK)

    def has_ended(self) -> bool:
        """Whether its job has ended: with an answer, with the process, or over its time."""
        try:
            heard = self.wire.recv(_OUTPUT_END)
        except BlockingIOError:
            return self.is_late or not self.process.is_alive()
        except OSError:
            return True
        if self.deadline == math.inf:
            self.deadline = time.monotonic() + self.job[-1].seconds
        return not heard or self._answer.exists()

    @property
    def _answer(self) -> Path:
        return self.place.with_suffix(".answer")

    @property
    def is_late(self) -> bool:
        """Whether its job is over its time."""
        return time.monotonic() >= self.deadline

    def result(self) -> Any:  # noqa: ANN401 - whatever the function returns
        """The result of its job, or how that was lost."""
        try:
            content = self._answer.read_bytes()
            self._answer.unlink()
        except FileNotFoundError:
            if self.is_late:
                return Lost(Failure.TIMED_OUT, f"took longer than {self.job[-1].seconds:g} s")
            self.has_died = True
            return self._crash()
        try:
            return pickle.loads(content)
        except Exception as fault:  # as raised by an object of a job
            return Lost(Failure.CRASHED, f"sent an answer that cannot be read ({type(fault).__name__})")

    def _crash(self) -> Lost:
        """How the process ended in its job; raises LinkproofError if it never began one."""
        reason, output = self._end(), self.place.with_suffix(".txt")
        if not output.exists():
            raise _start_error(f"one that {reason} at its start")
        written = output.read_bytes()[-_OUTPUT_END:]
        if any(words in written for words in _NO_MEMORY):
            return lost(MemoryError(), self.job[-1].memory)
        return Lost(Failure.CRASHED, reason)

    def _end(self) -> str:
        """How the process ended, within 2 s from now."""
        self.process.join(_EXIT_TIMEOUT)
        code: int | None = self.process.exitcode
        if code is None:
            return "broke its connection"
        if code >= 0:
            return f"exited with code {code}"
        with contextlib.suppress(ValueError):
            return f"died by signal {-code} ({signal.Signals(-code).name})"
        return f"died by signal {-code}"

    def stop(self) -> None:
        """Kill the process, whatever it is doing, and all that it has started."""
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError, PermissionError):  # no group yet, or no longer
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.join(_EXIT_TIMEOUT)
        self.wire.close()
        for kind in (".job", ".answer", ".txt"):
            self.place.with_suffix(kind).unlink(missing_ok=True)


def ended(workers: Sequence[Worker]) -> list[Worker]:
    """The workers whose jobs have ended; waits for the first, a second at most."""
    left = min(worker.deadline for worker in workers) - time.monotonic()
    signs = [sign for worker in workers for sign in (worker.wire, worker.process.sentinel)]
    wait(signs, min(max(left, 0.0), _PULSE))
    return [worker for worker in workers if worker.has_ended()]


def _start_error(what: str) -> LinkproofError:
    """What to say where no worker can be started."""
    return LinkproofError(f"expected to start a worker process, got {what}; run with --jobs 0 to do without")


# What runs in a worker.


def _serve(wire: socket.socket, place: str) -> None:
    """Do the jobs at a place, one after the other, until the other end of the wire is closed."""
    path = Path(place)
    output, answer = str(path.with_suffix(".txt")), path.with_suffix(".answer")
    _prepare(output)
    while wire.recv(1):
        wire.send(_LOOK)
        function, job, memory = pickle.loads(path.with_suffix(".job").read_bytes())
        done = _run_job(function, job, memory, output)
        path.with_suffix(".part").write_bytes(done)
        path.with_suffix(".part").replace(answer)
        wire.send(_LOOK)


def _prepare(output: str) -> None:
    """Make this process a worker, which has a group of its own, writes no core dumps and ends with its parent.

    The file of its output is there once the worker is.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if not os.environ.get(SHOW_OUTPUT):
        faulthandler.disable()  # a forked one writes to where its parent's did
    # Temporary files are in the folder of the command's own, which goes with the command.
    tempfile.tempdir = os.environ["TMPDIR"] = util.get_temp_dir()
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # processes that an engine starts are in the worker's group, and are killed with it
    with contextlib.suppress(ImportError):
        import resource  # noqa: PLC0415  POSIX only

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    alive = forkserver._forkserver._forkserver_alive_fd  # type: ignore[attr-defined]
    if alive is not None:  # the server ends, and all workers with it, if an engine writes into this pipe
        os.close(alive)
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    Path(output).touch()


def _end_with(sentinel: int) -> None:
    """Kill this worker and all that it has started when its parent dies, as soon as Python code runs."""
    wait([sentinel])
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def _run_job(function: bytes, job: bytes, memory: int, output: str) -> bytes:
    """The pickled result of a pickled job, which is ``Lost`` if the job raises anything."""
    try:
        os.truncate(output, 0)  # what earlier jobs have printed
        with _output_to(output), _memory_bounded(memory):
            value = _unpickled_function(function)(*pickle.loads(job))
        return pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    except BaseException as error:
        return pickle.dumps(lost(error, memory))


@functools.cache
def _unpickled_function(function: bytes) -> Callable[..., object]:
    """A function, unpickled once for all jobs, so that it can cache."""
    loaded: Callable[..., object] = pickle.loads(function)
    return loaded


@contextlib.contextmanager
def _memory_bounded(memory: int) -> Iterator[None]:
    """Let the process add at most ``memory`` bytes to its address space, if the system can bound it."""
    try:
        import resource  # noqa: PLC0415

        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (ImportError, OSError):
        yield
        return
    before = resource.getrlimit(resource.RLIMIT_AS)
    largest = pages * resource.getpagesize() + memory
    bounds = [value for value in (largest, *before) if value != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min(bounds), before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
