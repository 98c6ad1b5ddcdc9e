"""The workers of a Dask scheduler as a pool: jobs are given out one by one, and anew where a worker is lost."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Generator, Hashable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from typing import Any, Final, TypeVar

from analytic.errors import LinkproofError
from comparisons.runs.cluster.orders import PULSE, Orders
from comparisons.runs.cluster.station import StationFacts, facts
from comparisons.runs.environment import INCIDENTAL
from comparisons.runs.failures import Lost
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, PoolLostError

R = TypeVar("R")

GREETING: Final = 60.0  # s that a worker is given to say what it has; importing everything takes a while
NOBODY: Final = 60.0  # s without any worker before all is given up
ANSWER: Final = 20.0  # s that a scheduler which was there is given to answer
# Of a worker's environment, what need not be as here: sources are compared by themselves.
APART: Final = (*INCIDENTAL, "commit")


@dataclass(frozen=True)
class Station:
    """A Dask worker that takes jobs: as many at once as it has ``threads``."""

    host: str
    threads: int


@dataclass(eq=False)
class ClusterPool:
    """The workers of the scheduler that a Dask ``client`` is connected to.

    ``alone``: one job at a time on a machine, jobs with the same first argument all on the same machine as long as it
    is there, and no machine unlike the others, so that times can be held against each other.
    """

    client: Any
    alone: bool = False
    stations: dict[str, Station] = field(default_factory=dict)
    hosts: dict[str, str] = field(default_factory=dict)  # every machine, by its name
    _greeted: dict[str, Any] = field(default_factory=dict)
    _refused: set[str] = field(default_factory=set)
    _homes: dict[Hashable, str] = field(default_factory=dict)
    _asked: float = -1.0
    _seen: float = 0.0

    @property
    def address(self) -> str:
        """The scheduler's."""
        return str(self.client.scheduler.address)

    @property
    def is_there(self) -> bool:
        """Whether the scheduler is still connected."""
        return bool(self.client.status == "running")

    @property
    def place(self) -> Mapping[str, str]:
        """Names and hardware of the machines."""
        machines = dict.fromkeys(self.hosts.values())
        return {"machine": "; ".join(machines), "hosts": ", ".join(sorted(self.hosts))}

    def check(self) -> None:
        """Get to know all workers; raises LinkproofError unless there are some, and each has what is here."""
        here = facts()
        self._check_dask()
        threads = self._threads()
        if not threads:
            raise LinkproofError(
                f"expected workers at {self.address}, got none: start some with: dask worker {self.address} --no-nanny"
            )
        self._greet(threads)
        patience = time.monotonic() + GREETING
        while self._greeted and time.monotonic() < patience:
            time.sleep(0.01)
            for address, told in self._told():
                fault = told if isinstance(told, str) else _fault(told, here)
                if fault:
                    raise LinkproofError(f"worker {address}: {fault}")
                self._take(address, told, threads[address])
        if not self.stations:
            raise LinkproofError(f"workers at {self.address} do not answer: restart them")
        if self.alone and len(set(self.hosts.values())) > 1:
            raise LinkproofError(
                f"expected machines of one kind, so that times are comparable, got {self.place['machine']}: "
                "measure on each of them into a folder of its own and join these with: linkproof merge"
            )
        if self.alone and any(self._answer(self.client.scheduler.processing, workers=None).values()):
            raise LinkproofError(f"expected idle workers at {self.address} for timed runs, got some at work: wait")

    def renew(self) -> None:
        """See which workers are there by now; those that come late and lack anything are left alone.

        Raises PoolLostError where the scheduler is gone, or all workers are and none has come for long.
        """
        if not self.is_there:
            raise PoolLostError(f"the scheduler at {self.address} is gone")
        if time.monotonic() < self._asked + PULSE:
            return
        threads, here = self._threads(), None
        self._asked = time.monotonic()
        for address in self.stations.keys() - threads.keys():
            del self.stations[address]
        self._greet({address: count for address, count in threads.items() if address not in self._refused})
        for address, told in self._told():
            here = here or facts()
            if address not in threads:
                continue
            if isinstance(told, str) or _fault(told, here) or (self.alone and told.host not in self.hosts):
                self._refused.add(address)
            else:
                self._take(address, told, threads[address])
        if self.stations:
            self._seen = time.monotonic()
        elif time.monotonic() > self._seen + NOBODY:
            raise PoolLostError(f"no worker is left at {self.address}")

    def run(
        self,
        function: Callable[..., R],
        jobs: Sequence[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job, in processes of the workers' machines.

        Raises PoolLostError where they are lost; what was done until then has been yielded.
        """
        self._seen = time.monotonic()
        with closing(Orders(self, function, jobs, bounds, begun)) as orders:
            yield from orders.results()

    def home(self, place: Hashable) -> str:
        """The machine that the jobs of a place belong to: of those that are there, the one with fewest places."""
        there = dict.fromkeys(station.host for station in self.stations.values())
        if self._homes.get(place) not in there:
            places = Counter(self._homes.values())
            self._homes[place] = min(there, key=lambda host: places[host])
        return self._homes[place]

    def _take(self, address: str, told: StationFacts, threads: int) -> None:
        self.stations[address] = Station(told.host, threads)
        self.hosts[told.host] = told.environment["machine"]

    def _threads(self) -> dict[str, int]:
        """Every worker's threads, by its address."""
        found: dict[str, int] = self._answer(self.client.scheduler.ncores)
        return found

    def _answer(self, question: Callable[..., Any], **words: Any) -> Any:  # noqa: ANN401 - any answer
        """What the scheduler says; raises PoolLostError where it, or a worker that it asks, says nothing for long."""
        try:
            return self.client.sync(question, callback_timeout=ANSWER, **words)
        except Exception as error:  # the end of a connection has many names
            raise PoolLostError(f"the scheduler at {self.address}, or a worker, does not answer") from error

    def _greet(self, addresses: Mapping[str, int]) -> None:
        """Ask workers that are not known yet what they have."""
        for address in addresses.keys() - self.stations.keys() - self._greeted.keys():
            self._greeted[address] = self.client.submit(facts, workers=[address], pure=False)
        for address in self._greeted.keys() - addresses.keys():
            del self._greeted[address]

    def _told(self) -> list[tuple[str, Any]]:
        """What workers have said by now: their facts, or why they have none."""
        found: list[tuple[str, Any]] = []
        for address in [name for name, future in self._greeted.items() if future.done()]:
            future = self._greeted.pop(address)
            with suppress(Exception):  # a worker that has died meanwhile
                error = future.exception(timeout=PULSE)
                found.append((address, _why(error) if error else future.result(timeout=ANSWER)))
        return found

    def _check_dask(self) -> None:
        """Raise LinkproofError where scheduler or workers have another Dask."""
        versions = self._answer(self.client._get_versions)
        here = versions["client"]["packages"]
        others = {f"scheduler {self.address}": versions["scheduler"]}
        others |= {f"worker {address}": told for address, told in versions["workers"].items()}
        for who, told in others.items():
            for package in ("distributed", "dask"):
                found = (told or {}).get("packages", {}).get(package)
                if found != here[package]:
                    raise LinkproofError(
                        f"{who}: expected {package} {here[package]}, as here, got {found}: install the same"
                    )


def _why(error: BaseException) -> str:
    if isinstance(error, ImportError):
        return f"expected linkproof, as here, got none ({error}): install the same there"
    return f"expected to hear what it has, got {type(error).__name__}: {error}; restart it"


def _fault(told: StationFacts, here: StationFacts) -> str:
    """Why a worker cannot do the jobs of this process; empty where it can."""
    if told.is_daemon:
        return (
            "expected one that may start processes, which keep engines apart, got a daemonic one: start it with "
            "DASK_DISTRIBUTED__WORKER__DAEMON=False in its environment, or with --no-nanny"
        )
    for name in {**here.environment, **told.environment}:
        expected, got = (one.environment.get(name, "none") for one in (here, told))
        if name not in APART and expected != got:
            return f"expected {name} {expected}, as here, got {got}: install the same"
    if told.sources != here.sources:
        return "expected linkproof's files as they are here, got others of the same version: install the same"
    return ""
