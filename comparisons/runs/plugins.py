"""Engines by name; a plug-in is tried in a worker process before it is imported anywhere else.

Who installs a plug-in need not use it, and importing it may hang or end the process: that costs its own rows alone.
"""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Sequence
from functools import cache
from types import FrameType
from typing import Final, NoReturn

from comparisons.runs.run_engine import AdapterError, Failure, Lost, blamed_on
from comparisons.runs.worker_process import start_server
from comparisons.runs.workers import Bounds, run_jobs
from engines import registry
from engines.contract import Engine

LONGEST_LOADING: Final = 30.0  # s within which a plug-in must be imported and return its version
_TRIED: Final[dict[str, Lost | None]] = {}  # plug-ins that a worker has imported, by entry point, and how that failed


def engine(name: str) -> Engine:
    """The adapter of that name, or its stand-in; raises UnknownNameError for a name that nobody announces."""
    return engines((name,))[0]


def engines(names: Sequence[str]) -> list[Engine]:
    """The adapters of these names, as ``engine`` has them; plug-ins are all tried at the same time."""
    if multiprocessing.current_process().daemon:  # a worker, which may start no other
        return [_imported_in_time(name) if registry.is_plugin(name) else registry.engine(name) for name in names]
    values = {name: registry.entry_point(name).value for name in names if registry.is_plugin(name)}
    new = [name for name, value in values.items() if value not in _TRIED]
    if new:
        start_server(["comparisons.campaign.campaign"])  # which runs will need, as the server starts once
    for number, lost in run_jobs(_try_plugin, [(name,) for name in new], bounds=Bounds(LONGEST_LOADING + 5.0)):
        _TRIED[values[new[number]]] = lost
    faults = {name: _TRIED[value] for name, value in values.items()}
    return [_stand_in(name, lost) if (lost := faults.get(name)) else registry.engine(name) for name in names]


def _try_plugin(name: str) -> None:
    """Import a plug-in in a worker; raises AdapterError if it cannot be loaded."""
    adapter = engine(name)
    with blamed_on(adapter):
        if isinstance(adapter, registry.Unusable):
            raise adapter.error
        registry.why_unavailable(adapter)


def _stand_in(name: str, lost: Lost) -> Engine:
    whole = lost.outcome in (Failure.ADAPTER_ERROR, Failure.SUITE_ERROR)
    reason = lost.reason if whole else f"the adapter of {name} cannot be loaded: its process {lost.reason}"
    return registry.stand_in(name, AdapterError(reason))


@cache
def _imported_in_time(name: str) -> Engine:
    """A plug-in's adapter in a worker, or the stand-in of one that takes too long, where the system has alarms."""
    if not hasattr(signal, "setitimer"):
        return registry.engine(name)

    def stop(_: int, __: FrameType | None) -> NoReturn:
        raise TimeoutError(f"loading it took longer than {LONGEST_LOADING:g} s")

    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, LONGEST_LOADING)
    try:
        return registry.engine(name)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
