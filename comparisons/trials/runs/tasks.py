"""Studies: keyed tasks in worker processes; each result is stored as it comes and read back in order."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, Lost, RunBounds
from comparisons.trials.runs.store import Curve, Runs, temporary_runs
from comparisons.trials.runs.workers import EVERY_CORE, LocalPool, Pool

R = TypeVar("R")

# Hears the label of a task, how many tasks are finished and how many are known of.
Announce = Callable[[str, int, int], object]
Written = tuple[Mapping[str, Any], Mapping[str, Curve]]  # a result as a row of JSON data, and its curves


@dataclass(frozen=True)
class Task:
    """One piece of work: ``job`` are the arguments of the study's function, ``key`` tells it from all others.

    ``weight`` is its approximate cost, in any unit.
    """

    key: str
    job: tuple[Any, ...]
    label: str = ""
    weight: float = 0.0


@dataclass
class TaskList(Generic[R]):
    """Tasks of one kind; what is among the ``finished`` runs is not made again, and no result stays in memory.

    ``function``, a module's own, makes a result of a task's job; ``lost`` does so from what went wrong and the same
    job, or None if the task counts as never begun. ``encode`` and ``decode`` are for the store. The ``pool`` says
    where they are made.
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
        """Take the finished runs, or keep runs in a file without a name."""
        self._runs = temporary_runs() if self.finished is None else self.finished

    def expect(self, tasks: Iterable[Task]) -> list[Task]:
        """Add tasks to those known; returns, each once, those without a result."""
        by_key = {task.key: task for task in tasks}
        self._finished += sum(key in self._runs for key in by_key.keys() - self._known)
        self._known |= by_key.keys()
        return [task for key, task in by_key.items() if key not in self._runs]

    def make(self, tasks: Iterable[Task], bounds: RunBounds = DEFAULT_BOUNDS) -> Generator[Task, None, None]:
        """Make the tasks without a result, begun in their order; stores each result and yields each task as it ends."""
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
        task was lost and counts as never begun.
        """
        begun = tasks if self.pool == LocalPool(0) else sorted(tasks, key=lambda task: -task.weight)
        for _ in self.make(begun, bounds):
            pass
        return [self.result(task.key) for task in tasks]

    def result(self, key: str) -> R:
        """The result of a task that is finished, read back; raises KeyError for any other."""
        return self.decode(*self._runs.read(key))

    def has(self, key: str) -> bool:
        """Whether a task with this key is finished."""
        return key in self._runs

    def _announce(self, task: Task) -> None:
        """Report a task's label with the numbers of finished and of known tasks."""
        self.announce(task.label, self._finished, len(self._known))
