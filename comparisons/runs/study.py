"""Studies: keyed tasks in worker processes; each result is written to a journal and read back in order."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final, Generic, TypeVar

from comparisons.runs.files import Claim, claim, write_text, writing
from comparisons.runs.record_file import Array, RecordFile, temporary_records
from comparisons.runs.run_engine import Lost
from comparisons.runs.workers import DEFAULT_BOUNDS, EVERY_CORE, Bounds, LocalPool, Pool

# The journal of a request: its finished records, appended one by one, so that a killed process loses none.


FOLDER: Final = "unfinished"
HEADER: Final = "request.txt"
COMMAND: Final = "command.txt"


@dataclass(frozen=True)
class Journal:
    """The finished records of a request, in ``folder/unfinished`` until all are there.

    ``request`` is the text that tells it from any other: first the command that began it, then, line by line, all
    else that decides its results, such as versions. ``command`` repeats it with every option, also those that do
    not decide its results. From its first use on no other process may use the folder.
    """

    folder: Path
    request: str
    command: str = ""

    @property
    def place(self) -> Path:
        """The folder of the records."""
        return self.folder / FOLDER

    @cached_property
    def records(self) -> RecordFile:
        """The records finished so far; those of another request are removed first."""
        _ = self._claim
        header = self.place / HEADER
        if not header.is_file() or self.other_request():
            self.clear()
            write_text(header, self.request)
        write_text(self.place / COMMAND, self.command)
        return RecordFile(self.place, survives_power_failure=True)

    def other_request(self) -> str:
        """How the request that was begun in the folder differs from this one; empty if it does not, or none was."""
        header = self.place / HEADER
        begun = header.read_text(encoding="utf-8", errors="replace") if header.is_file() else self.request
        lines = zip_longest(begun.splitlines(), self.request.splitlines(), fillvalue="nothing")
        return next((f"`{then}`, now `{now}`" for then, now in lines if then != now), "")

    def keep(self, key: str, row: Mapping[str, Any], curves: Mapping[str, Array] | None = None) -> None:
        """Write one finished record under its key; a record already there is replaced."""
        with writing(self.place):
            self.records.append(key, row, curves)

    def clear(self) -> None:
        """Remove everything there, of whatever request; a kill leaves all of it or nothing."""
        if self.folder.is_dir():
            _ = self._claim
        vars(self).pop("records", None)
        leaving = self.place.with_name(f".{FOLDER}")
        if leaving.is_dir():
            shutil.rmtree(leaving)
        if self.place.is_dir():
            self.place.rename(leaving)
            shutil.rmtree(leaving)

    @cached_property
    def _claim(self) -> Claim:
        return claim(self.folder)


def unfinished_command(folder: Path) -> str:
    """The command that began what is unfinished in a folder; empty if nothing is."""
    file = folder / FOLDER / COMMAND
    return file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""


# Studies: keyed tasks in worker processes; each result is written to a journal and read back in order.

R = TypeVar("R")

# Hears the label of a task, how many tasks are finished and how many are known of.
Announce = Callable[[str, int, int], object]
Written = tuple[Mapping[str, Any], Mapping[str, Array]]  # a result as a row of JSON data, and its arrays


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
class Study(Generic[R]):
    """Tasks of one kind; what the ``journal`` holds is not made again, and no result stays in memory.

    ``function``, a module's own, makes a result of a task's job; ``lost`` does so from what went wrong and the same
    job, or None if the task counts as never begun. ``encode`` and ``decode`` are for the journal. The ``pool`` says
    where they are made.
    """

    function: Callable[..., R]
    lost: Callable[..., R | None]
    encode: Callable[[R], Written]
    decode: Callable[[Mapping[str, Any], Mapping[str, Array]], R]
    journal: Journal | None = None
    announce: Announce = lambda *_: None
    pool: Pool = EVERY_CORE
    _known: set[str] = field(default_factory=set, init=False)
    _finished: int = field(default=0, init=False)  # of those known

    def __post_init__(self) -> None:
        self._records = self.journal.records if self.journal else temporary_records()
        self._keep = self.journal.keep if self.journal else self._records.append

    def expect(self, tasks: Iterable[Task]) -> list[Task]:
        """Count these tasks among those known of; returns those still to be made, each once."""
        by_key = {task.key: task for task in tasks}
        self._finished += sum(key in self._records for key in by_key.keys() - self._known)
        self._known |= by_key.keys()
        return [task for key, task in by_key.items() if key not in self._records]

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
                    self._keep(task.key, *self.encode(result))
                    self._finished += 1
                    self._announce(task)
                    yield task

    def complete(self, tasks: Sequence[Task], bounds: Bounds = DEFAULT_BOUNDS) -> None:
        """Make those tasks that have no result yet.

        Several processes begin with the heaviest, so that it does not run alone at the end.
        """
        for _ in self._heaviest_first(tasks, bounds):
            pass

    def in_order(self, tasks: Sequence[Task], bounds: Bounds = DEFAULT_BOUNDS) -> Generator[R, None, None]:
        """Results in the order of the tasks, each as soon as all before it are there."""
        self.expect(tasks)
        with closing(self._heaviest_first(tasks, bounds)) as ended:
            for task in tasks:
                while task.key not in self._records:
                    next(ended)
                yield self.result(task.key)

    def _heaviest_first(self, tasks: Sequence[Task], bounds: Bounds) -> Generator[Task, None, None]:
        return self.make(tasks if self.pool == LocalPool(0) else sorted(tasks, key=lambda task: -task.weight), bounds)

    def result(self, key: str) -> R:
        """The result of a task that is finished, read from the journal; raises KeyError for any other."""
        return self.decode(*self._records.read(key))

    def results(self) -> Iterator[R]:
        """Every result that the tasks known of have by now, in the order in which they were finished."""
        return (self.result(key) for key in self._records.keys if key in self._known)

    def has(self, key: str) -> bool:
        """Whether a task is finished."""
        return key in self._records

    def _announce(self, task: Task) -> None:
        self.announce(task.label, self._finished, len(self._known))
