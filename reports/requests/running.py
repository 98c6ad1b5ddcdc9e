"""The place of runs, and the time and memory that each may use."""

from __future__ import annotations

import math
from contextlib import AbstractContextManager
from dataclasses import dataclass

from analytic.errors import LinkproofError
from analytic.machine_code.compiling import cores
from comparisons.runs.cluster.connecting import check_scheduler, opened
from comparisons.runs.failures import GIB
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, LocalPool, Pool
from reports.requests.options.campaign import RunLimits


@dataclass(frozen=True)
class Running:
    """The ``bounds`` of each run, and the worker ``processes`` here, or the ``scheduler`` whose workers make them."""

    bounds: Bounds
    processes: int
    scheduler: object

    def pool(self, here: Pool | None = None) -> AbstractContextManager[Pool]:
        """The pool of workers, on this machine ``here``; raises LinkproofError if it cannot be opened."""
        return opened(self.scheduler, here or LocalPool(self.processes))


def running(limits: RunLimits) -> Running:
    """The bounds and the place of runs; raises LinkproofError for bad input.

    By default there are as many worker processes as cores; a single run has a process of its own, too.
    """
    for option, value, unit in (
        ("--time-limit", limits.time_limit, "s"),
        ("--memory-limit", limits.memory_limit, "GiB"),
    ):
        if value is not None and not 0.0 < value < math.inf:
            raise LinkproofError(f"{option}: expected a positive finite number of {unit}, got {value:g}")
        if value is not None and limits.jobs == 0:
            raise LinkproofError(
                f"{option} applies to worker processes, but --jobs 0 starts none: leave one of the two out"
            )
    if limits.jobs is not None and limits.jobs < 0:
        raise LinkproofError(f"--jobs: expected a number of processes, or 0 for none, got {limits.jobs}")
    if limits.jobs is not None and limits.scheduler is not None:
        raise LinkproofError("--jobs and --scheduler exclude each other: leave one of them out")
    check_scheduler(limits.scheduler)
    seconds = DEFAULT_BOUNDS.seconds if limits.time_limit is None else limits.time_limit
    memory = DEFAULT_BOUNDS.memory if limits.memory_limit is None else round(limits.memory_limit * GIB)
    return Running(Bounds(seconds, memory), cores() if limits.jobs is None else limits.jobs, limits.scheduler)
