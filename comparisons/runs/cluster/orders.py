"""Jobs given out to the stations of a cluster until each has its one result."""

from __future__ import annotations

import asyncio
import pickle
import uuid
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, Final

from analytic.errors import LinkproofError
from comparisons.runs.cluster.station import UnwantedError, work
from comparisons.runs.crew import Bounds
from comparisons.runs.failures import Failure, Lost
from comparisons.runs.workers import PoolLostError

if TYPE_CHECKING:
    from comparisons.runs.cluster.pool import ClusterPool

PULSE: Final = 0.5  # s from one look at the workers to the next
AHEAD: Final = 1  # jobs that wait at a worker for the one before them, so that it never waits for the next
# What says that a worker has ended or is closing, or that the way to it broke, not that the job failed.
GIVEN_BACK: Final = (asyncio.CancelledError, futures.CancelledError, UnwantedError, OSError)
# So many workers may die at one job before it is taken for the cause.
DEATHS: Final = 10


@dataclass(frozen=True)
class _Given:
    """A job in the hands of a worker."""

    number: int
    address: str
    future: Any


class Orders:
    """The jobs of one call, and who has them."""

    def __init__(
        self,
        pool: ClusterPool,
        function: Callable[..., Any],
        jobs: Sequence[tuple[Any, ...]],
        bounds: Bounds,
        begun: Callable[[int], object],
    ) -> None:
        self.pool, self.jobs, self.bounds, self.begun = pool, jobs, bounds, begun
        self.function = pickle.dumps(function)
        self.todo = deque(range(len(jobs)))
        self.given: dict[str, _Given] = {}
        self.deaths: Counter[int] = Counter()
        self.arrived: SimpleQueue[tuple[str, object]] = SimpleQueue()

    def results(self) -> Iterator[tuple[int, Any]]:
        """Every job's result, as they arrive."""
        left = len(self.jobs)
        while left:
            lost: PoolLostError | None = None
            try:
                self.pool.renew()
                self._take_back()
                self._give()
            except PoolLostError as error:
                lost = error
            found = list(self._heard(0.0 if lost else PULSE))
            left -= len(found)
            if found and self.pool.is_there:
                self._give()  # a worker has its next job before a result is handed on
            yield from found
            if lost and left:
                raise lost

    def close(self) -> None:
        """Want no result any more: workers end what they are at."""
        for given in self.given.values():
            given.future.release()
        self.given.clear()

    def _give(self) -> None:
        while (choice := self._choice()) is not None:
            number, address = choice
            self.todo.remove(number)
            self.begun(number)
            client, job = self.pool.client, pickle.dumps(self.jobs[number], protocol=pickle.HIGHEST_PROTOCOL)
            options = {"key": f"linkproof-{uuid.uuid4().hex}", "workers": [address], "allow_other_workers": False}
            try:
                future = client.submit(work, self.function, job, self.bounds, **options)
            except Exception:
                self.todo.appendleft(number)
                if self.pool.is_there:
                    raise
                return  # which the next look at the workers tells
            self.given[future.key] = _Given(number, address, future)
            asyncio.run_coroutine_threadsafe(self._bring(future), client.loop.asyncio_loop)

    def _choice(self) -> tuple[int, str] | None:
        """The next job and a free worker for it."""
        stations, busy = self.pool.stations, Counter(given.address for given in self.given.values())
        if not self.todo or not stations:
            return None
        if not self.pool.alone:
            waiting = {address: busy[address] - station.threads for address, station in stations.items()}
            first = min(waiting, key=lambda address: waiting[address])
            plenty = len(self.todo) > sum(station.threads for station in stations.values())
            return (self.todo[0], first) if waiting[first] < (AHEAD if plenty else 0) else None
        at_work = {stations[address].host for address in busy}
        for number in self.todo:
            home = self.pool.home(self.jobs[number][0])
            if home not in at_work:
                return number, next(address for address, station in stations.items() if station.host == home)
        return None

    async def _bring(self, future: Any) -> None:  # noqa: ANN401
        """Fetch a result when it is there, on the client's own loop."""
        try:
            found: object = await future
        except BaseException as error:  # that of a future given up is an interruption by its kind
            found = error
        self.arrived.put((future.key, found))

    def _take_back(self) -> None:
        """Have the jobs of workers that are gone done by others, before all else."""
        for key, given in list(self.given.items()):
            if given.address not in self.pool.stations:
                del self.given[key]
                given.future.release()
                self._again(given.number)

    def _again(self, number: int) -> None:
        self.deaths[number] += 1
        self.todo.appendleft(number)

    def _heard(self, seconds: float) -> Iterator[tuple[int, Any]]:
        """The results that have arrived by now, or within so many seconds."""
        try:
            arrived = [self.arrived.get(timeout=seconds) if seconds else self.arrived.get_nowait()]
            while not self.arrived.empty():
                arrived.append(self.arrived.get())
        except Empty:
            arrived = []
        fault = ""
        for key, found in arrived:
            given = self.given.pop(key, None)
            if given is None:
                continue  # its worker was gone, and the job is another's
            if isinstance(found, bytes):
                given.future.release()
                yield given.number, pickle.loads(found)
            elif isinstance(found, GIVEN_BACK) or type(found).__name__ == "KilledWorker":
                self._again(given.number)
            else:
                fault = f"worker {given.address}: expected a result, got {type(found).__name__}: {found}; restart it"
        if fault:
            raise LinkproofError(fault)
        for number in [number for number in self.todo if self.deaths[number] >= DEATHS]:
            self.todo.remove(number)
            yield number, Lost(Failure.CRASHED, f"{DEATHS} workers have died at it")
