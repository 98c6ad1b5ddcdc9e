"""Code inside a Dask worker: it runs every job in a separate process, which serves the next job too."""

from __future__ import annotations

import multiprocessing
import pickle
import socket
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version

from comparisons.runs.environment import environment, source_checksum
from comparisons.runs.run_engine import Lost
from comparisons.runs.worker_pool import Bounds, WorkerPool
from engines.registry import engine_names, plugins

DASK = ("dask", "distributed")
_thread_state = (
    threading.local()
)  # the process that a thread of a Dask worker has used last, by what it was started for


class JobRecalledError(Exception):
    """No one waits for the running job any more."""


@dataclass(frozen=True)
class DaskMachine:
    """The machine of a Dask worker: its ``host`` name, its ``kind``, and the ``versions`` that its results depend on.

    Plug-ins, which are not imported, have the version of their package. A daemonic worker may start no process.
    """

    host: str
    kind: str
    versions: dict[str, str]
    is_daemon: bool


def this_machine() -> DaskMachine:
    """The machine of this process and the versions of its software."""
    others = plugins()
    facts = environment([name for name in engine_names() if name not in others]) | others
    facts |= {name: version(name) for name in DASK} | {"linkproof's files": source_checksum()}
    kind = facts.pop("machine")
    versions = {name: value for name, value in facts.items() if name not in ("date", "commit")}
    return DaskMachine(socket.gethostname(), kind, versions, bool(multiprocessing.current_process().daemon))


def work(function: bytes, job: bytes, bounds: Bounds) -> bytes:
    """The pickled result of a pickled function for a pickled job, within bounds in a process beside this one."""
    pool = _pool_of_thread(function, bounds)
    pool.check = _recall_check()
    try:
        ((_, result),) = pool.run_more([pickle.loads(job)], bounds.seconds)
    except BaseException:
        pool.close()
        raise
    return pickle.dumps(replace(result, host=pool.host) if isinstance(result, Lost) else result)


def _pool_of_thread(function: bytes, bounds: Bounds) -> WorkerPool:
    """The process that this thread has used last, or a new one for another function; it ends by itself when idle."""
    purpose = (function, bounds.memory)
    if getattr(_thread_state, "purpose", None) != purpose:
        if hasattr(_thread_state, "pool"):
            _thread_state.pool.close()
        _thread_state.purpose, _thread_state.pool = (
            purpose,
            WorkerPool(pickle.loads(function), (), bounds, 1, host=socket.gethostname()),
        )
    pool: WorkerPool = _thread_state.pool
    return pool


def _recall_check() -> Callable[[], None]:
    """A function that raises JobRecalledError once the present job is recalled, or its Dask worker closes."""
    from distributed import get_worker  # noqa: PLC0415  only where Dask is

    worker = get_worker()
    key = worker.get_current_task()

    def check() -> None:
        task = worker.state.tasks.get(key)
        if task is None or task.state != "executing" or worker.status.name in ("closing", "closed", "failed"):
            raise JobRecalledError(key)

    return check
