"""Worker processes for lists of jobs: one that crashes, hangs or runs out of memory costs its own job alone.

What starts processes is imported with the first worker: where a system has none, jobs run in this process.
"""

from __future__ import annotations

import contextlib
import pickle
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import closing
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Generic, Protocol, TypeVar

from analytic.machine_code import cores
from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, Failure, Lost, RunBounds, lost
from comparisons.trials.runs.store import Curve, Runs, temporary_runs

if TYPE_CHECKING:
    from comparisons.trials.runs.worker_process import Worker

R = TypeVar("R")
Begun = Callable[[int], object]

_PULSE: Final = 1.0  # s, after which a Ctrl-C is noticed where it does not interrupt a wait


def most_processes() -> int:
    """The number of cores that this process may use; 0 where this Python has no processes, as in a browser."""
    try:
        import multiprocessing.synchronize  # noqa: F401, PLC0415
    except ImportError:
        return 0
    return cores()


def usual_processes(count: int) -> int:
    """The default number of processes for ``count`` jobs: ``most_processes``, or 0 for a single job."""
    return 0 if count == 1 else most_processes()


class Pool(Protocol):
    """Where runs are made: ``LocalPool`` or ``comparisons.trials.runs.cluster.DaskPool``."""

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: RunBounds = DEFAULT_BOUNDS,
        begun: Begun = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Call ``function(*job)`` for every job in worker processes; yields (index of the job, result) as they end.

        ``function`` is of a module, or a ``functools.partial`` of one. Jobs begin in order, are taken from their
        iterable when there is room for them, and ``begun`` is called with the index of each. A job that raises, or
        breaks its ``bounds``, has a Lost result.
        """
        ...


@dataclass(frozen=True)
class LocalPool:
    """Worker ``processes`` of this machine, as many as cores by default, never more than there are jobs.

    A job whose worker dies is tried once more if the worker had finished others before, which may have damaged it. A
    worker has its next job before its result is yielded, ignores Ctrl-C and writes nothing to the terminal. All workers
    are killed at once when the generator of results is closed or raises; when this process dies, each ends as soon as
    its Python code runs, at the latest with its job.

    Workers of a pool that ``lasts`` outlive a list of jobs, so that they import and warm up once, until ``close``.

    With 0 processes the jobs run in this one, one after the other and without bounds: only exceptions are caught.
    """

    processes: int | None = None
    lasts: bool = False
    _free: list[Worker] = field(default_factory=list, init=False, repr=False, compare=False)
    _busy: dict[Future[bytes], Worker] = field(default_factory=dict, init=False, repr=False, compare=False)

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: RunBounds = DEFAULT_BOUNDS,
        begun: Begun = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Yield index and result of ``function(*job)`` for every job, as a ``Pool`` does.

        ``begun`` is called again for a job that is tried once more. Raises LinkproofError where none can start.
        """
        count = most_processes() if self.processes is None else self.processes
        if not count:
            yield from _results_here(function, jobs, bounds, begun)
            return
        if not self.lasts:
            with contextlib.closing(LocalPool(count, lasts=True)) as pool:
                yield from pool.run(function, jobs, bounds, begun)
            return
        pickled, module, left = pickle.dumps(function), getattr(function, "func", function).__module__, enumerate(jobs)
        ended: list[tuple[int, R | Lost]] = []
        try:
            while True:
                while len(self._busy) < count and (numbered := next(left, None)) is not None:
                    arguments = pickle.dumps(numbered[1], pickle.HIGHEST_PROTOCOL)
                    self._begin(self._worker(module), (numbered[0], pickled, arguments, bounds), begun)
                yield from ended
                if not self._busy:
                    return
                ended = list(self._ended(module, begun))
        except BaseException:
            self.close()
            raise

    def _worker(self, module: str) -> Worker:
        """A free worker, or a new one, for jobs of a module, named; raises LinkproofError where none can start."""
        while self._free and not self._free[-1].is_usable():  # it has ended meanwhile
            self._free.pop().stop()
        from comparisons.trials.runs.worker_process import Worker  # noqa: PLC0415  lacks modules in a browser

        return self._free.pop() if self._free else Worker(module)

    def _begin(self, worker: Worker, job: tuple[int, bytes, bytes, RunBounds], begun: Begun) -> None:
        """Call ``begun`` with a job's index, and give the job, as ``Worker.job`` has it, to a worker."""
        begun(job[0])
        self._busy[worker.begin(job)] = worker

    def _ended(self, module: str, begun: Begun) -> Iterator[tuple[int, Any]]:
        """Wait for results, up to _PULSE, and yield them, each after its job's index.

        A job whose used worker died is begun once more in a new one, which needs the ``module``.
        """
        wait(self._busy, _PULSE, FIRST_COMPLETED)
        for future, worker in list(self._busy.items()):
            if not future.done() and worker.is_usable():
                continue
            result = worker.result(future)
            del self._busy[future]
            if isinstance(result, Lost) and result.outcome in (Failure.CRASHED, Failure.TIMED_OUT):
                worker.stop()  # its state is not known
            else:
                worker.used = True
                self._free.append(worker)
            if worker.used and worker.has_died:
                self._begin(type(worker)(module), worker.job, begun)
            else:
                yield worker.job[0], result

    def close(self) -> None:
        """Kill all workers, also those with a job; the pool can be used again."""
        workers = (*self._free, *self._busy.values())
        self._free.clear()
        self._busy.clear()
        for worker in workers:
            worker.pool.stop()  # type: ignore[no-untyped-call]
        for worker in workers:
            worker.stop()


def _results_here(
    function: Callable[..., R], jobs: Iterable[tuple[Any, ...]], bounds: RunBounds, begun: Begun
) -> Iterator[tuple[int, R | Lost]]:
    """Run the jobs in this process, one after the other, and yield their indices and results; bounds do not hold.

    A job that raises has a Lost result, an interruption ends all.
    """
    for number, job in enumerate(jobs):
        begun(number)
        result: R | Lost
        try:
            result = function(*job)
        except (Exception, SystemExit) as error:
            result = lost(error, bounds.memory)
        yield number, result


EVERY_CORE, ONE_BY_ONE = LocalPool(), LocalPool(1)


# Studies: keyed tasks in a pool; each result is stored as it comes and read back in order.


# Hears the label of a task, how many tasks are finished and how many are known of.
Announce = Callable[[str, int, int], object]
Written = tuple[Mapping[str, Any], Mapping[str, Curve]]  # a result as a row of JSON data, and its curves


@dataclass(frozen=True)
class Task:
    """One piece of work: ``job`` are the arguments of the study's function, ``key`` tells it from all others.

    ``label`` names it for a reader, ``weight`` is its approximate cost, in any unit.
    """

    key: str
    job: tuple[Any, ...]
    label: str = ""
    weight: float = 0.0


@dataclass
class TaskList(Generic[R]):
    """Tasks of one kind; what is among the ``finished`` runs is not made again, and no result stays in memory.

    ``function``, a module's own, is called with a task's job and makes its result; ``lost(loss, *job)`` does so from a
    Lost one, or gives None if the task counts as never begun. ``encode`` makes a row and curves of a result for the
    store, ``decode`` a result of these. ``announce(label, finished, known)`` hears of each task that begins or ends,
    with the numbers of tasks. The ``pool`` says where they are made.
    """

    function: Callable[..., R]
    lost: Callable[..., R | None]
    encode: Callable[[R], Written]
    decode: Callable[[Mapping[str, Any], Mapping[str, Curve]], R]
    finished: Runs | None = None
    announce: Announce = lambda *_: None
    pool: Pool = EVERY_CORE
    _known: set[str] = field(default_factory=set, init=False)
    _finished: int = field(default=0, init=False)  # of those known

    def __post_init__(self) -> None:
        """Take the ``finished`` runs to add to, or keep runs in a file without a name."""
        self._runs = temporary_runs() if self.finished is None else self.finished

    def expect(self, tasks: Iterable[Task]) -> list[Task]:
        """Add tasks to those known; returns, each once, those without a result, in their order."""
        by_key = {task.key: task for task in tasks}
        self._finished += sum(key in self._runs for key in by_key.keys() - self._known)
        self._known |= by_key.keys()
        return [task for key, task in by_key.items() if key not in self._runs]

    def make(self, tasks: Iterable[Task], bounds: RunBounds = DEFAULT_BOUNDS) -> Generator[Task, None, None]:
        """Make the tasks without a result, begun in their order; stores each result and yields each task as it ends.

        Each has its ``bounds``; one that counts as never begun is neither stored nor yielded. Nothing is made before
        the first is asked for, and closing the generator ends the rest. Raises LinkproofError where no worker can
        start.
        """
        todo = self.expect(tasks)

        def begun(number: int) -> None:
            """Announce that the task of this number has begun."""
            self._announce(todo[number])

        jobs = [task.job for task in todo]
        with closing(self.pool.run(self.function, jobs, bounds, begun)) as ended:
            for number, outcome in ended:
                task = todo[number]
                result = self.lost(outcome, *task.job) if isinstance(outcome, Lost) else outcome
                if result is not None:
                    self._runs.add(task.key, *self.encode(result))
                    self._finished += 1
                    self._announce(task)
                    yield task

    def complete(self, tasks: Sequence[Task], bounds: RunBounds = DEFAULT_BOUNDS) -> list[R]:
        """Make those tasks that have no result yet; returns the results of all, in their order.

        Several processes begin with the heaviest, so that it does not run alone at the end. Raises KeyError where a
        task was lost and counts as never begun, LinkproofError where no worker can start.
        """
        begun = tasks if self.pool == LocalPool(0) else sorted(tasks, key=lambda task: -task.weight)
        for _ in self.make(begun, bounds):
            pass
        return [self.result(task.key) for task in tasks]

    def result(self, key: str) -> R:
        """The result of a task that is finished, by its key, read back; raises KeyError for any other."""
        return self.decode(*self._runs.read(key))

    def has(self, key: str) -> bool:
        """Whether a task with this key is finished, now or among the runs to add to."""
        return key in self._runs

    def _announce(self, task: Task) -> None:
        """Report a task's label with the numbers of finished and of known tasks to ``announce``."""
        self.announce(task.label, self._finished, len(self._known))
