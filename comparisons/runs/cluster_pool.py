"""The workers of a Dask scheduler as a pool: Dask hands out the jobs, and repeats those whose worker dies."""

from __future__ import annotations

import asyncio
import pickle
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping
from concurrent import futures
from dataclasses import dataclass, field
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any, Final, TypeVar

from analytic.errors import LinkproofError
from comparisons.runs.cluster_worker import DASK, DaskMachine, this_machine, work
from comparisons.runs.run_engine import Failure, Lost
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, PoolLostError

R = TypeVar("R")
_Job = tuple[int, tuple[Any, ...]]  # index and arguments

PULSE: Final = 1.0  # s from one look at the workers to the next
STARTUP_TIMEOUT: Final = 60.0  # s for an answer of the scheduler, or of a worker that imports everything for it
NO_WORKER_TIMEOUT: Final = 60.0  # s without any worker after which the run is given up
JOBS_PER_THREAD: Final = 2  # that Dask has at a time: one runs, and the next waits beside it
RETRIES: Final = 3  # by Dask, of a job that its worker could not finish
ATTEMPTS: Final = 10  # of a job all of whose workers have died
_LOST_RESULT: Final = (asyncio.CancelledError, futures.CancelledError, OSError)  # of a future: its result is lost


@dataclass(eq=False)
class ClusterPool:
    """The workers of the scheduler that a Dask ``client`` is connected to.

    ``alone`` is for times that are compared: a machine has one job at a time, jobs with the same first argument go to
    the same machine as long as it is there, and all machines are of one kind.
    """

    client: Any
    alone: bool = False
    here: DaskMachine = field(default_factory=this_machine)
    hosts: dict[str, str] = field(default_factory=dict)  # the kind of every machine so far, by its name
    machines: dict[str, DaskMachine] = field(default_factory=dict)  # by the address of the worker that takes jobs
    _threads: dict[str, int] = field(default_factory=dict)
    # Of each worker its machine, or an exception.
    _machine_requests: dict[str, futures.Future[object]] = field(default_factory=dict)
    _preferred: dict[Hashable, str] = field(default_factory=dict)  # machine of each place
    _last_look: float = -PULSE
    _last_worker_time: float = field(default_factory=time.monotonic)  # when a worker was there

    def __post_init__(self) -> None:
        self.address = str(self.client.scheduler.address)  # which a closed client does not know

    @property
    def place(self) -> Mapping[str, str]:
        """Names and hardware of the machines."""
        return {"machine": "; ".join(dict.fromkeys(self.hosts.values())), "hosts": ", ".join(sorted(self.hosts))}

    @property
    def room(self) -> int:
        """Number of jobs that Dask may have at a time."""
        return sum(1 if self.alone else JOBS_PER_THREAD * self._threads[address] for address in self.machines)

    def check(self) -> None:
        """Raise LinkproofError unless there are workers, and all can do the jobs of this process."""
        packages = self._call_scheduler(self.client._get_versions)["scheduler"]["packages"]
        if fault := self._version_fault({name: packages[name] for name in DASK}, DASK):
            raise LinkproofError(f"scheduler {self.address}: {fault}")
        self.refresh()
        if not self._machine_requests:
            raise LinkproofError(
                f"expected workers at {self.address}, got none: start some with: dask worker {self.address} --no-nanny"
            )
        futures.wait(self._machine_requests.values(), STARTUP_TIMEOUT)
        self._update_machines()
        for address, future in self._machine_requests.items():
            if fault := self._why_unusable(future.result() if future.done() else TimeoutError()):
                raise LinkproofError(f"worker {address}: {fault}")
        if self.alone and any(self._call_scheduler(self.client.scheduler.processing, workers=None).values()):
            raise LinkproofError(f"expected idle workers at {self.address} for timed runs, got some at work: wait")

    def refresh(self) -> bool:
        """See which workers are there, at most once in a pulse; late ones that cannot do the jobs are left alone.

        Returns whether it has looked. Raises PoolLostError if the scheduler is gone, or all workers are for long.
        """
        if self.client.status != "running":
            raise PoolLostError(f"the scheduler at {self.address} is gone")
        if time.monotonic() < self._last_look + PULSE:
            return False
        self._threads = self._call_scheduler(self.client.scheduler.ncores)
        self._machine_requests = {
            address: self._machine_requests.get(address) or self._ask_for_machine(address) for address in self._threads
        }
        self._update_machines()
        self._last_look = time.monotonic()
        if self.machines:
            self._last_worker_time = self._last_look
        elif self._last_look > self._last_worker_time + NO_WORKER_TIMEOUT:
            raise PoolLostError(f"no worker is left at {self.address}")
        return True

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: Bounds = DEFAULT_BOUNDS,
        begun: Callable[[int], object] = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job, in processes of the workers' machines.

        Raises PoolLostError if the workers or the scheduler are lost; all results until then have been yielded.
        """
        self._last_worker_time = time.monotonic()
        dispatcher = Dispatcher(self, pickle.dumps(function), enumerate(jobs), bounds, begun)
        try:
            yield from dispatcher.results()
        finally:
            dispatcher.close()

    def workers_for(self, job: tuple[Any, ...]) -> list[str]:
        """The workers that may do a job."""
        return [self.preferred_worker(job[0])] if self.alone else list(self.machines)

    def preferred_worker(self, place: Hashable) -> str:
        """The worker for the jobs of a place: on the machine of the earlier ones, else on that with fewest places."""
        addresses = {machine.host: address for address, machine in self.machines.items()}
        if self._preferred.get(place) not in addresses:
            places = Counter(self._preferred.values())
            self._preferred[place] = min(addresses, key=lambda host: places[host])
        return addresses[self._preferred[place]]

    def _ask_for_machine(self, address: str) -> futures.Future[object]:
        """Ask a worker for its machine; not by ``submit``, which waits for ever for a worker that dies meanwhile."""

        async def answer() -> object:
            try:
                return (await self.client._run(this_machine, workers=[address], on_error="return"))[address]
            except Exception as error:
                return error

        return asyncio.run_coroutine_threadsafe(answer(), self.client.loop.asyncio_loop)

    def _update_machines(self) -> None:
        """Find the workers that have answered by now, and can do the jobs; ``alone`` takes one of each machine."""
        self.machines = {}
        answers = {address: future.result() for address, future in self._machine_requests.items() if future.done()}
        for address, result in answers.items():
            if isinstance(result, DaskMachine) and not self._why_unusable(result):
                self.hosts[result.host] = result.kind
                if not self.alone or result.host not in {machine.host for machine in self.machines.values()}:
                    self.machines[address] = result

    def _why_unusable(self, result: object) -> str:
        """Why a worker cannot do the jobs of this process; empty if it can."""
        if isinstance(result, ImportError):
            return f"expected linkproof, as here, got none ({result}): install the same there"
        if not isinstance(result, DaskMachine):
            return f"expected its versions, got {type(result).__name__}: {result}; restart it"
        if result.is_daemon:
            return (
                "expected one that may start processes, which keep engines apart, got a daemonic one: start it with "
                "DASK_DISTRIBUTED__WORKER__DAEMON=False in its environment, or with --no-nanny"
            )
        kinds = [kind for kind in self.hosts.values() if self.alone and kind != result.kind]
        if kinds:
            return (
                f"expected machines of one kind, so that times are comparable, got {result.kind} beside {kinds[0]}: "
                "measure on each of them into a folder of its own"
            )
        return self._version_fault(result.versions, {**self.here.versions, **result.versions})

    def _version_fault(self, versions: Mapping[str, str], names: Iterable[str]) -> str:
        """Why these versions of the named packages do not fit this process; empty if they do."""
        for name in names:
            expected, got = self.here.versions.get(name, "none"), versions.get(name, "none")
            if expected != got:
                return f"expected {name} {expected}, as here, got {got}: install the same"
        return ""

    def _call_scheduler(self, question: Callable[..., Any], *args: Any, **words: Any) -> Any:  # noqa: ANN401
        """The answer of the scheduler; raises PoolLostError if it does not answer in time."""
        try:
            return self.client.sync(question, *args, callback_timeout=STARTUP_TIMEOUT, **words)
        except Exception as error:  # the end of a connection has many names
            raise PoolLostError(f"the scheduler at {self.address} does not answer") from error


@dataclass
class Dispatcher:
    """The jobs of one call: Dask has few of them at a time, and the others stay in their iterator."""

    pool: ClusterPool
    function: bytes
    jobs: Iterator[_Job]
    bounds: Bounds
    begun: Callable[[int], object]
    waiting: deque[_Job] = field(default_factory=deque)
    submitted: dict[Any, tuple[_Job, list[str]]] = field(default_factory=dict)  # with the workers that may do it
    attempts: Counter[int] = field(default_factory=Counter)
    arrived: SimpleQueue[tuple[Any, object]] = field(default_factory=SimpleQueue)

    def results(self) -> Iterator[tuple[int, Any]]:
        """The result of every job, as they arrive."""
        from distributed import KilledWorker  # noqa: PLC0415  only where Dask is

        while True:
            if self.pool.refresh():
                self._recall()
            self._submit()
            if not (self.submitted or self.waiting):
                return
            try:
                future, result = self.arrived.get(timeout=PULSE)
            except Empty:
                continue
            job, workers = self.submitted.pop(future)
            number = job[0]
            if isinstance(result, bytes):
                yield number, pickle.loads(result)
            elif isinstance(result, _LOST_RESULT) and self.attempts[number] < ATTEMPTS:
                self.waiting.appendleft(job)
            elif isinstance(result, (*_LOST_RESULT, KilledWorker)):
                yield number, Lost(Failure.CRASHED, "all Dask workers that ran it have died")
            else:
                reason = f"expected a result, got {type(result).__name__}: {result}; restart them"
                raise LinkproofError(f"workers {', '.join(workers)}: {reason}")

    def close(self) -> None:
        """Recall all jobs: workers end them."""
        for future in self.submitted:
            future.release()

    def _recall(self) -> None:
        """Take back the jobs whose workers are all gone: Dask would wait until one of these comes back."""
        for future, (_, workers) in self.submitted.items():
            if not any(address in self.pool.machines for address in workers):
                future.cancel()

    def _submit(self) -> None:
        """Hand on as many jobs as there is room for."""
        pool, later = self.pool, []
        self.waiting.extend(islice(self.jobs, None if pool.alone else max(0, 1 + pool.room - len(self.waiting))))
        while self.waiting and len(self.submitted) < pool.room:
            job = number, arguments = self.waiting.popleft()
            workers = pool.workers_for(arguments)
            if pool.alone and any(workers == others for _, others in self.submitted.values()):
                later.append(job)
                continue
            self.begun(number)
            self.attempts[number] += 1
            words = {"workers": workers, "retries": RETRIES, "pure": False}
            future = pool.client.submit(work, self.function, pickle.dumps(arguments), self.bounds, **words)
            self.submitted[future] = job, workers
            asyncio.run_coroutine_threadsafe(self._fetch(future), pool.client.loop.asyncio_loop)
        self.waiting.extendleft(reversed(later))

    async def _fetch(self, future: Any) -> None:  # noqa: ANN401
        """Fetch a result when it is there, on the client's own loop.

        ``distributed.as_completed`` never yields a future whose result is lost on its way, and its timeout counts from
        its creation.
        """
        try:
            result: object = await future
        except BaseException as error:  # that of a future that is cancelled is an interruption by its type
            result = error
        self.arrived.put((future, result))
