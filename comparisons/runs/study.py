"""The spine of every study: keyed tasks in worker processes, each result kept in a journal, in order or as they end."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from comparisons.runs.failures import Lost
from comparisons.runs.journal import Journal
from comparisons.runs.workers import DEFAULT_BOUNDS, EVERY_CORE, Bounds, LocalPool, Pool

R = TypeVar("R")

# Hears the label of a task, how many tasks are finished and how many are known of.
Announce = Callable[[str, int, int], object]


@dataclass(frozen=True)
class Task:
    """One piece of work: ``job`` are the arguments of the study's function, ``key`` tells it from all others.

    ``weight`` is what it costs, very roughly, in any unit.
    """

    key: str
    job: tuple[Any, ...]
    label: str = ""
    weight: float = 0.0


@dataclass
class Study(Generic[R]):
    """Tasks of one kind and the ``results`` so far, by key; what the ``journal`` holds is not made again.

    ``function``, a module's own, makes a result of a task's job; ``lost`` does so from what went wrong and the same
    job, or None where the task counts as never begun. ``encode`` and ``decode`` are for the journal. The ``pool`` says
    where they are made. Raises LinkproofError if the journal is another request's.
    """

    function: Callable[..., R]
    lost: Callable[..., R | None]
    encode: Callable[[R], bytes]
    decode: Callable[[bytes], R]
    journal: Journal | None = None
    announce: Announce = lambda *_: None
    pool: Pool = EVERY_CORE
    results: dict[str, R] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._kept = self.journal.kept() if self.journal else {}
        self._known: set[str] = set()

    def expect(self, tasks: Iterable[Task]) -> list[Task]:
        """Count these tasks among those known of; returns those still to be made, each once."""
        by_key = {task.key: task for task in tasks}
        self._known |= by_key.keys()
        self.results |= {key: self.decode(self._kept.pop(key)) for key in by_key if key in self._kept}
        return [task for key, task in by_key.items() if key not in self.results]

    def make(self, tasks: Iterable[Task], bounds: Bounds = DEFAULT_BOUNDS) -> Generator[Task, None, None]:
        """Make the tasks that have no result yet, begun in their order, and yield each as it ends."""
        todo = self.expect(tasks)

        def begun(number: int) -> None:
            self._announce(todo[number])

        jobs = [task.job for task in todo]
        with closing(self.pool.run(self.function, jobs, bounds, begun)) as ended:
            for number, outcome in ended:
                task = todo[number]
                result = self.lost(outcome, *task.job) if isinstance(outcome, Lost) else outcome
                if result is not None:
                    self._keep(task, result)
                    yield task

    def in_order(self, tasks: Sequence[Task], bounds: Bounds = DEFAULT_BOUNDS) -> Generator[R, None, None]:
        """Results in the order of the tasks, each as soon as all before it are there.

        Several processes begin with the heaviest, so that none is left alone with it at the end.
        """
        self.expect(tasks)
        first = tasks if self.pool == LocalPool(0) else sorted(tasks, key=lambda task: -task.weight)
        with closing(self.make(first, bounds)) as ended:
            for task in tasks:
                while task.key not in self.results:
                    next(ended)
                yield self.results[task.key]

    def _keep(self, task: Task, result: R) -> None:
        self.results[task.key] = result
        if self.journal is not None:
            self.journal.keep(task.key, self.encode(result))
        self._announce(task)

    def _announce(self, task: Task) -> None:
        self.announce(task.label, len(self.results), len(self._known))
