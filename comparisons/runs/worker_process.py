"""A worker process: how it is started, and one job after the other in it, each within a bound of memory.

Imports the standard library alone, so that the server which forks workers can be started before anything heavy is.
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
from multiprocessing import forkserver, util
from multiprocessing.connection import wait
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from comparisons.runs.run_engine import SHOW_OUTPUT, lost

START: Final = "LINKPROOF_WORKER_START"  # how workers are started: forkserver or spawn, as in multiprocessing
_START_LOCK: Final = threading.Lock()  # the main module is hidden from one start at a time
_CLEAN_EXIT: Final = 256  # stands for an exit code of 0
_EXIT_TIMEOUT: Final = 2.0  # s within which a process must end after it has broken its connection


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
    forkserver.set_forkserver_preload(["comparisons.runs.worker_process", "pebble.pool.process", *modules])
    path = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
    before = dict(os.environ)
    os.environ.update(PYTHONPATH=path, PYTHONSAFEPATH="1")
    try:
        with _isolated_start(), _output_discarded():
            forkserver.ensure_running()
    finally:
        for name in ("PYTHONPATH", "PYTHONSAFEPATH"):
            del os.environ[name]
            os.environ.update({name: before[name]} if name in before else {})


@contextlib.contextmanager
def _isolated_start() -> Iterator[None]:
    """A process started here does not import the main module, and a Ctrl-C reaches this one afterwards.

    Without the main module, which has no job in it, a script that calls us needs no ``if __name__ == "__main__"``, and
    a command line is not imported twice.
    """
    with _START_LOCK, _interrupts_blocked():
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


@contextlib.contextmanager
def _interrupts_blocked() -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _output_discarded() -> Iterator[None]:
    """Discard output to the file descriptors 1 and 2, unless it is requested."""
    if os.environ.get(SHOW_OUTPUT):
        yield
        return
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()
    copies = [os.dup(descriptor) for descriptor in (1, 2)]
    try:
        _redirect_output(os.devnull)
        yield
    finally:
        for descriptor, copy in zip((1, 2), copies, strict=True):
            os.dup2(copy, descriptor)
            os.close(copy)


def _redirect_output(path: str) -> None:
    """Append what this process writes, from Python and from C, to a file."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for descriptor in (1, 2):
        os.dup2(handle, descriptor)
    os.close(handle)


class WorkerContext:
    """The start of the one process of a pool of pebble's; a pool whose process has ended is not filled again."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context(start_method())
        self.process: WorkerProcess | None = None

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - pipes and locks
        """Whatever else pebble asks of a context."""
        return getattr(self._context, name)

    def Pipe(self, duplex: bool = True) -> tuple[Any, Any]:  # noqa: N802 - as pebble calls it
        """A pipe; what an engine has written into it is an OSError, as pebble expects of a broken one."""
        reader, writer = self._context.Pipe(duplex)

        def receive() -> object:
            try:
                return type(reader).recv(reader)
            except (EOFError, OSError):
                raise
            except Exception as error:
                raise OSError from error

        reader.recv = receive  # type: ignore[method-assign]
        return reader, writer

    def Process(self, **arguments: Any) -> WorkerProcess:  # noqa: ANN401, N802 - the name that pebble calls
        """The process; raises OSError for a second one."""
        if self.process is not None:
            raise OSError("the process of this pool has ended")
        self.process = WorkerProcess(self._context.Process(**arguments))  # type: ignore[attr-defined]
        return self.process


class WorkerProcess:
    """A process of multiprocessing that is killed at once, with all that it has started."""

    def __init__(self, process: Any) -> None:  # noqa: ANN401 - each start has a class of its own
        self._process = process
        process.daemon = True

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """Whatever else pebble asks of a process."""
        return getattr(self._process, name)

    def start(self) -> None:
        """Start it without the main module."""
        with _isolated_start():
            self._process.start()

    def terminate(self) -> None:
        """Kill the process and its group, whatever they are doing."""
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError, PermissionError):  # no group yet, or no longer
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()

    @property
    def exitcode(self) -> int | None:
        """Its exit code, None while it runs; never 0, which pebble takes for an end that it has asked for."""
        code: int | None = self._process.exitcode
        return _CLEAN_EXIT if code == 0 else code

    def end(self) -> str:
        """How the process ended, within 2 s from now."""
        self._process.join(_EXIT_TIMEOUT)
        code: int | None = self._process.exitcode
        if code is None:
            return "broke its connection"
        if code >= 0:
            return f"exited with code {code}"
        with contextlib.suppress(ValueError):
            return f"died by signal {-code} ({signal.Signals(-code).name})"
        return f"died by signal {-code}"


# What runs in a worker.


def prepare(output: str) -> None:
    """Make this process a worker, which has a group of its own, is deaf to Ctrl-C and ends with its parent.

    Its output goes to a file, which is there once the worker is.
    """
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # SIGINT is ignored already
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
    if not os.environ.get(SHOW_OUTPUT):
        faulthandler.disable()  # a forked one writes to where its parent's did
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__
        _redirect_output(output)


def _end_with(sentinel: int) -> None:
    """Kill this worker and all that it has started when its parent dies, as soon as Python code runs."""
    wait([sentinel])
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def run_job(function: bytes, job: bytes, memory: int, output: str) -> bytes:
    """The pickled result of a pickled job, which is ``Lost`` if the job raises anything."""
    os.truncate(output, 0)  # what earlier jobs have printed
    try:
        with _memory_bounded(memory):
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
