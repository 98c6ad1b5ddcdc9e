"""Records lost and doubled by a campaign on a cluster whose workers and schedulers are killed at random moments.

``python -m tests.nightly.cluster_endurance WORKERS SCHEDULERS [SEED]`` measures it, in campaigns one after the other
until so many have been killed. POSIX only, with a /proc.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from analytic.description.crank_motion import REGIMES, crank_motion
from analytic.description.loading import catalogue, load
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.judging.records import RunRecord
from comparisons.runs.cluster import opened
from comparisons.runs.record_file import Array
from comparisons.runs.study import Journal
from comparisons.runs.workers import EVERY_CORE, PoolLostError
from engines.contract import Setting
from tests.nightly.endurance import losses

WORKERS = 2
PAUSE = 0.5  # s, the mean from a result to the next kill


@dataclass(frozen=True)
class ClusterEndurance:
    """Result of so many killed ``workers`` and ``schedulers`` over so many ``campaigns`` of so many ``runs`` each.

    ``lost`` counts records and curves that are missing or differ from those of an undisturbed campaign, ``doubled``
    those present, or runs saved, more than once.
    """

    workers: int
    schedulers: int
    campaigns: int
    runs: int
    lost: int
    doubled: int


@dataclass(frozen=True)
class _CountingJournal(Journal):
    """A journal that counts how often it saved each run."""

    counts: Counter[str] = field(default_factory=Counter)

    def keep(self, key: str, row: Mapping[str, Any], curves: Mapping[str, Array] | None = None) -> None:
        self.counts[key] += 1
        super().keep(key, row, curves)


@dataclass
class _Killer:
    """Kills workers and schedulers, each a while after a result, until the numbers are reached."""

    chance: random.Random
    workers: int
    schedulers: int
    killed: Counter[str] = field(default_factory=Counter)
    scheduler: int = 0

    def __post_init__(self) -> None:
        self.share = self.workers // max(1, self.schedulers)  # workers to a scheduler
        self.moment = 0.0

    @property
    def done(self) -> bool:
        return self.killed["workers"] >= self.workers and self.killed["schedulers"] >= self.schedulers

    def noticed(self, *_: object) -> None:
        """A run has begun or ended."""
        self.moment = self.moment or time.monotonic() + self.chance.expovariate(1.0 / PAUSE)

    def watch(self, ended: threading.Event) -> None:
        while not ended.wait(0.01):
            if self.moment and time.monotonic() > self.moment and self.scheduler and not self.done:
                self._kill()
                self.moment = 0.0

    def _kill(self) -> None:
        due = self.killed["schedulers"] < self.schedulers
        if due and self.killed["workers"] >= min(self.workers, self.share * (self.killed["schedulers"] + 1)):
            os.kill(self.scheduler, signal.SIGKILL)
            self.killed["schedulers"] += 1
            self.scheduler = 0
        elif self.killed["workers"] < self.workers and (workers := _workers(self.scheduler)):
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.chance.choice(workers), signal.SIGKILL)
                self.killed["workers"] += 1


def _workers(scheduler: int) -> list[int]:
    """The processes of the workers that a local cluster's process has started."""
    numbers = []
    listed = [path.read_text() for path in Path(f"/proc/{scheduler}/task").glob("*/children")]
    for process in map(int, " ".join(listed).split()):
        with contextlib.suppress(OSError):
            if b"spawn_main" in Path(f"/proc/{process}/cmdline").read_bytes():
                numbers.append(process)
    return numbers


def request(regimes: int) -> CampaignRequest:
    """Every mechanism of the catalogue under so many regimes in two engines and every setting."""
    motions = tuple(crank_motion(name) for name in REGIMES[:regimes])
    linkages = tuple(load(name) for name in catalogue())
    return CampaignRequest(linkages, motions, "brief", ("direct", "pymunk"), tuple(Setting), ("Jeq", "Mkr"),
                           with_invariants=False)  # fmt: skip


def measure(workers: int, schedulers: int, seed: int = 0, regimes: int = len(REGIMES)) -> ClusterEndurance:
    """Kill so many, and compare every finished campaign with an undisturbed one."""
    given, killer, ended = request(regimes), _Killer(random.Random(seed), workers, schedulers), threading.Event()
    expected = list(compare(given, pool=EVERY_CORE))
    lost = doubled = campaigns = runs = 0
    thread = threading.Thread(target=killer.watch, args=(ended,), daemon=True)
    thread.start()
    with tempfile.TemporaryDirectory() as folder:
        while not killer.done:
            journal = _CountingJournal(Path(folder) / str(campaigns), "as tested")
            results = None
            while results is None:
                results = _attempt(given, journal, killer)
            missing, surplus = losses(expected, results)
            campaigns, runs, lost = campaigns + 1, len(results), lost + missing
            doubled += surplus + sum(journal.counts.values()) - runs
    ended.set()
    thread.join()
    return ClusterEndurance(killer.killed["workers"], killer.killed["schedulers"], campaigns, runs, lost, doubled)


def _attempt(given: CampaignRequest, journal: Journal, killer: _Killer) -> list[RunRecord] | None:
    """The results of a campaign, resumed from its journal; None where its scheduler is killed."""
    try:
        with opened(f"local:{WORKERS}", EVERY_CORE) as pool:
            killer.scheduler = pool.client.run_on_scheduler(os.getpid)  # type: ignore[attr-defined]
            return list(compare(given, killer.noticed, pool=pool, journal=journal))
    except PoolLostError:
        return None
    finally:
        killer.scheduler = 0


if __name__ == "__main__":
    sys.stdout.write(json.dumps(asdict(measure(*map(int, sys.argv[1:])))) + "\n")
