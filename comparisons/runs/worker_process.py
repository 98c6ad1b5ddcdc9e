"""Code inside a worker process: one job after the other, each within a memory bound, its output captured.

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
from multiprocessing.connection import Connection, wait
from pathlib import Path
from types import ModuleType
from typing import Final

from comparisons.runs.run_engine import SHOW_OUTPUT, lost

# How workers are started: fork, forkserver or spawn, as in multiprocessing.
START: Final = "LINKPROOF_WORKER_START"


def start_method() -> str:
    """The start of workers: forked in 5 ms from a server without threads that has imported what they need.

    On Windows, which has no such server, and on macOS, whose libraries may not be forked, every worker is spawned and
    imports anew. ``START`` in the environment overrules it.
    """
    return os.environ.get(START) or ("forkserver" if sys.platform.startswith("linux") else "spawn")


def start_server(modules: Sequence[str]) -> None:
    """Start the server that forks workers, if it does not run yet, and have it import these modules.

    Returns at once: if it is called early, the server imports while the caller does.
    """
    if start_method() == "forkserver":
        forkserver.set_forkserver_preload(["comparisons.runs.worker_process", *modules])
        with isolated_start(), inherited_path():
            forkserver.ensure_running()


@contextlib.contextmanager
def inherited_path() -> Iterator[None]:
    """A Python started here imports modules from the same folders as this one, and not from the working folder."""
    path = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
    before = dict(os.environ)
    os.environ.update(PYTHONPATH=path, PYTHONSAFEPATH="1")
    try:
        yield
    finally:
        for name in ("PYTHONPATH", "PYTHONSAFEPATH"):
            del os.environ[name]
            os.environ.update({name: before[name]} if name in before else {})


@contextlib.contextmanager
def isolated_start() -> Iterator[None]:
    """A process started here ignores Ctrl-C, prints nothing and does not import the main module.

    A Ctrl-C meanwhile reaches this process at the end. Without the main module, which has no job in it, a script that
    calls us needs no ``if __name__ == "__main__"``, and a command line is not imported twice.
    """
    main = sys.modules["__main__"]
    with _interrupts_blocked(), _output_discarded():
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
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    copies = [os.dup(descriptor) for descriptor in (1, 2)]
    try:
        for descriptor in (1, 2):
            os.dup2(nowhere, descriptor)
        yield
    finally:
        for descriptor, copy in zip((1, 2), copies, strict=True):
            os.dup2(copy, descriptor)
        for descriptor in (nowhere, *copies):
            os.close(descriptor)


def serve(channel: Connection, output: Connection | None, function: bytes, memory: int) -> None:
    """Receive pickled tuples of arguments and send back the results of ``function``, until the channel is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Temporary files are in the folder of the command's own, which goes with the command.
    tempfile.tempdir = os.environ["TMPDIR"] = util.get_temp_dir()
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # processes that an engine starts are in the worker's group, and are killed with it
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    _redirect_output(output)
    channel.send_bytes(b"")  # it is ready
    with contextlib.suppress(EOFError):
        while True:
            channel.send_bytes(_run_pickled_job(function, channel.recv_bytes(), memory))


def _run_pickled_job(function: bytes, job: bytes, memory: int) -> bytes:
    """The pickled result of one job, which is ``Lost`` if the job raises anything."""
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


def _end_with(sentinel: int) -> None:
    """Kill this worker and all that it has started when its parent dies, as soon as Python code runs."""
    wait([sentinel])
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def _redirect_output(output: Connection | None) -> None:
    """Send all output, from Python and from C, to the parent; write no core dumps."""
    with contextlib.suppress(ImportError):
        import resource  # noqa: PLC0415  POSIX only

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if output is not None and not os.environ.get(SHOW_OUTPUT):
        faulthandler.disable()  # a forked one writes to where its parent's did
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__
        for descriptor in (1, 2):
            os.dup2(output.fileno(), descriptor)


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
