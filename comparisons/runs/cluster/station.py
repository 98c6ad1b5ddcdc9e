"""What runs inside a Dask worker: every job goes to a process of its own, which is kept for the next one."""

from __future__ import annotations

import multiprocessing
import pickle
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

from comparisons.runs.crew import Bounds, Crew
from comparisons.runs.environment import environment, sources
from comparisons.runs.failures import Lost
from engines.registry import engine_names, plugins

KEPT: Final = 60.0  # s that a process is kept without a job

_idle: Final[dict[tuple[bytes, int], list[tuple[float, Crew]]]] = {}
_lock: Final = threading.Lock()


class UnwantedError(Exception):
    """The job that is being done is wanted no more."""


@dataclass(frozen=True)
class StationFacts:
    """What tells a Dask worker from others: ``host``, ``environment`` and ``sources`` as of the calling process.

    The environment has all engines; of plug-ins, which are not imported, the packages that announce them.
    ``is_daemon``: it may start no process, so that no engine can be kept apart from it.
    """

    host: str
    environment: dict[str, str]
    sources: str
    is_daemon: bool


def facts() -> StationFacts:
    """Those of the process that this is called in."""
    daemon, others = bool(multiprocessing.current_process().daemon), plugins()
    versions = environment([name for name in engine_names() if name not in others]) | others
    return StationFacts(socket.gethostname(), versions, sources(), daemon)


def work(function: bytes, job: bytes, bounds: Bounds) -> bytes:
    """The pickled result of a pickled function for a pickled job, done within bounds in a process of this machine."""
    crew = _hired(function, bounds)
    crew.alive = _check()
    try:
        ((_, result),) = crew.take_up([pickle.loads(job)], bounds.seconds)
    except BaseException:
        crew.close()
        raise
    with _lock:
        _idle.setdefault((function, bounds.memory), []).append((time.monotonic(), crew))
    if isinstance(result, Lost):
        result = replace(result, host=crew.host)
    return pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)


def _hired(function: bytes, bounds: Bounds) -> Crew:
    """A crew of one that has done such jobs before, or a new one."""
    with _lock:
        if not _idle:
            threading.Thread(target=_dismiss, daemon=True).start()
        kept = _idle.setdefault((function, bounds.memory), [])
        if kept:
            return kept.pop()[1]
    return Crew(pickle.loads(function), (), bounds, 1, host=socket.gethostname())


def _dismiss() -> None:
    """End processes that have had no job for long: nobody says when the last one is done."""
    while True:
        time.sleep(KEPT / 10.0)
        with _lock:
            oldest = time.monotonic() - KEPT
            old = [crew for kept in _idle.values() for since, crew in kept if since < oldest]
            for kept in _idle.values():
                kept[:] = [entry for entry in kept if entry[0] >= oldest]
        for crew in old:
            crew.close()


def _check() -> Callable[[], None]:
    """What raises UnwantedError once nobody waits for the present job any more, or its Dask worker closes."""
    import distributed  # noqa: PLC0415  only a Dask worker has it for certain

    worker: Any = distributed.get_worker()
    key = worker.get_current_task()

    def check() -> None:
        task = worker.state.tasks.get(key)
        if task is None or task.state != "executing" or worker.status.name in ("closing", "closed", "failed"):
            raise UnwantedError(key)

    return check
