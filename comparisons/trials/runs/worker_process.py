"""A worker: a pool of pebble's with one process and pipes of its own, and one job at a time, each within its bounds.

Nothing is shared that a dying process could leave locked or half-written, and whatever it was doing is known.
"""

from __future__ import annotations

import contextlib
import faulthandler
import functools
import multiprocessing
import os
import pickle
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Future
from multiprocessing import forkserver, util
from multiprocessing.connection import Connection, wait
from pathlib import Path
from types import ModuleType
from typing import Any, Final
from uuid import uuid4

from pebble import CONSTS, ProcessPool

from analytic.errors import LinkproofError
from comparisons.trials.runs.run_engine import SHOW_OUTPUT, Failure, Lost, RunBounds, lost
from engines.registry import silenced

START: Final = "LINKPROOF_WORKER_START"  # how workers are started: forkserver or spawn, as in multiprocessing
_START_LOCK: Final = threading.Lock()  # the main module is hidden from one start at a time
_CLEAN_EXIT: Final = 256  # stands for an exit code of 0
_EXIT_TIMEOUT: Final = 2.0  # s within which a process must end after it has broken its connection
# What C and C++ run-time libraries write when an allocation fails and nobody catches it.
_NO_MEMORY: Final = (b"bad_alloc", b"out of memory", b"Out of memory", b"Cannot allocate memory", b"MemoryError")
_OUTPUT_END: Final = 4096  # bytes of the end of a worker's output that are searched for these
CONSTS.sleep_unit = 0.02  # s, after which pebble looks again for a worker that has ended or is late


def start_method() -> str:
    """The name of multiprocessing's way to start workers: "forkserver", which forks in 5 ms, or "spawn".

    On Windows, which has no such server, and on macOS, whose libraries may not be forked, every worker is spawned and
    imports anew. ``START`` in the environment overrules it.
    """
    return os.environ.get(START) or ("forkserver" if sys.platform.startswith("linux") else "spawn")


def start_server(modules: Sequence[str]) -> None:
    """Start the server that forks workers, if it does not run yet, and have it import these modules, given by name.

    Does nothing where workers are spawned. Returns at once: if it is called early, the server imports while the caller
    does. It imports from the same folders as this process, not from the working folder, and its workers print nothing
    unless ``SHOW_OUTPUT`` is in the environment. Raises OSError where it cannot start.
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
    """In the block, let processes that start not import the main module, which none of their jobs needs.

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
    """In the block, append the process' output to a file at ``path``, unless ``SHOW_OUTPUT`` is in the environment."""
    return contextlib.nullcontext() if os.environ.get(SHOW_OUTPUT) else silenced(path)


class _Context:
    """The start of the one process of a pool of pebble's; a pool whose process has ended is not filled again."""

    def __init__(self) -> None:
        """Use the start method of ``start_method``; no process yet."""
        self._context = multiprocessing.get_context(start_method())
        self.process: _Process | None = None

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - pipes and locks
        """Any other attribute, from the wrapped context of multiprocessing."""
        return getattr(self._context, name)

    def Pipe(self, duplex: bool = True) -> tuple[Any, Any]:  # noqa: N802 - the name that pebble calls
        """A pipe's reader and writer; reading raises OSError for anything an engine has written, as pebble expects."""
        reader, writer = self._context.Pipe(duplex)
        reader.recv = functools.partial(_received, reader)  # type: ignore[method-assign]
        return reader, writer

    def Process(self, **arguments: Any) -> _Process:  # noqa: ANN401, N802 - the name that pebble calls
        """The context's only process, wrapped; raises OSError for a second one."""
        if self.process is not None:
            raise OSError("the process of this pool has ended")
        self.process = _Process(self._context.Process(**arguments))  # type: ignore[attr-defined]
        return self.process


def _received(reader: Connection) -> object:
    """The next object from a worker; raises OSError for bytes that are none, EOFError at the end."""
    try:
        return type(reader).recv(reader)
    except (EOFError, OSError):
        raise
    except Exception as error:  # as raised by bytes that are none of a pickled object
        raise OSError from error


class _Process:
    """A process of multiprocessing that is killed at once, with all that it has started."""

    def __init__(self, process: Any) -> None:  # noqa: ANN401 - each start has a class of its own
        """Wrap a process of multiprocessing that is not started yet, and mark it to end with this one."""
        self._process = process
        process.daemon = True

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """Any other attribute, from the wrapped process."""
        return getattr(self._process, name)

    def start(self) -> None:
        """Start the process without importing the main module in it."""
        with _main_module_hidden():
            self._process.start()

    def terminate(self) -> None:
        """Kill the process and its group, whatever they are doing."""
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError, PermissionError):  # no group yet, or no longer
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()

    @property
    def exitcode(self) -> int | None:
        """The process' exit code, None while it runs; never 0, which pebble takes for an end that it asked for."""
        code: int | None = self._process.exitcode
        return _CLEAN_EXIT if code == 0 else code

    def end(self) -> str:
        """How the process has ended, in words such as "exited with code 1", after at most 2 s of waiting for it.

        They are "broke its connection" for one that still runs.
        """
        self._process.join(_EXIT_TIMEOUT)
        code: int | None = self._process.exitcode
        if code is None:
            return "broke its connection"
        if code >= 0:
            return f"exited with code {code}"
        with contextlib.suppress(ValueError):
            return f"died by signal {-code} ({signal.Signals(-code).name})"
        return f"died by signal {-code}"


class Worker:
    """A worker process and the job that it has; it has been ``used`` once it has finished any."""

    job: tuple[int, bytes, bytes, RunBounds]  # index, function and arguments, pickled, and bounds

    def __init__(self, module: str) -> None:
        """Start the process; ``module``, a name, is imported for its jobs. Raises LinkproofError if it cannot start."""
        self.used = self.has_died = False
        try:
            start_server([module])
            self.output = Path(util.get_temp_dir()) / f"{uuid4().hex}.txt"
            context = _Context()
            self.pool = ProcessPool(1, initializer=_prepare, initargs=(str(self.output),), context=context)
            self.is_usable()  # which starts it
        except (OSError, EOFError, BrokenExecutor) as error:
            cause = error.__cause__ or error
            raise _start_error(f"{type(cause).__name__}: {cause}") from error
        assert context.process is not None
        self.process = context.process

    def is_usable(self) -> bool:
        """Whether the process and its pipes are as they should be."""
        return bool(self.pool.active)

    def begin(self, job: tuple[int, bytes, bytes, RunBounds]) -> Future[bytes]:
        """Send a job to the worker, and keep it as ``job``; returns the future of its pickled result.

        It runs within the job's bounds.
        """
        self.job, (_, function, arguments, bounds) = job, job
        return self.pool.schedule(
            _run_job, (function, arguments, bounds.memory, str(self.output)), timeout=bounds.seconds
        )

    def result(self, future: Future[bytes]) -> Any:  # noqa: ANN401 - whatever the function returns
        """The result of its job, or a Lost one that says how it was lost; notes whether the process has died.

        A ``future`` that is not done stands for a process that has died. Raises LinkproofError where the process ended
        before it began any job.
        """
        error = future.exception() if future.done() else BrokenExecutor()
        if isinstance(error, TimeoutError):
            return Lost(Failure.TIMED_OUT, f"took longer than {self.job[-1].seconds:g} s")
        if error is not None:
            self.has_died = True
            return self._crash()
        try:
            return pickle.loads(future.result())
        except Exception as fault:  # as raised by an object of a job
            return Lost(Failure.CRASHED, f"sent an answer that cannot be read ({type(fault).__name__})")

    def _crash(self) -> Lost:
        """The loss of a job whose process ended, for want of memory if its output says so.

        Waits up to 2 s for the end. Raises LinkproofError if the process never began a job.
        """
        reason = self.process.end()
        if not self.output.exists():
            raise _start_error(f"one that {reason} at its start")
        written = self.output.read_bytes()[-_OUTPUT_END:]
        if any(words in written for words in _NO_MEMORY):
            return lost(MemoryError(), self.job[-1].memory)
        return Lost(Failure.CRASHED, reason)

    def stop(self) -> None:
        """Kill the process, and all that it has started, at once; the file of its output is deleted."""
        self.pool.stop()  # type: ignore[no-untyped-call]
        self.process.terminate()
        self.pool.join()
        self.output.unlink(missing_ok=True)


def _start_error(what: str) -> LinkproofError:
    """The LinkproofError that no worker can be started, with what was got instead."""
    return LinkproofError(f"expected to start a worker process, got {what}; run with --jobs 0 to do without")


# What runs in a worker.


def _prepare(output: str) -> None:
    """Make this process a worker, which has a group of its own, writes no core dumps and ends with its parent.

    SIGTERM ends it, and its temporary files are in the folder of the command's. The file of its output, at ``output``,
    is there once the worker is.
    """
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # SIGINT is ignored already
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
    """Block until the parent dies, by its ``sentinel``, then kill this worker and all processes that it started."""
    wait([sentinel])
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def _run_job(function: bytes, job: bytes, memory: int, output: str) -> bytes:
    """The pickled result of a pickled job, which is ``Lost`` if the job raises anything.

    ``function`` is a pickle, too, ``job`` one of its arguments. What is printed goes to the file ``output``, emptied
    first; at most ``memory`` bytes are added.
    """
    try:
        os.truncate(output, 0)  # what earlier jobs have printed
        with _output_to(output), _memory_bounded(memory):
            value = _unpickled_function(function)(*pickle.loads(job))
        return pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    except BaseException as error:
        return pickle.dumps(lost(error, memory))


@functools.cache
def _unpickled_function(function: bytes) -> Callable[..., object]:
    """The unpickled ``function``, the same object for all jobs of this process, so that it can cache."""
    loaded: Callable[..., object] = pickle.loads(function)
    return loaded


@contextlib.contextmanager
def _memory_bounded(memory: int) -> Iterator[None]:
    """In the block, let the process add at most ``memory`` bytes of address space, if the system can bound it.

    Afterwards the bound is as before.
    """
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
