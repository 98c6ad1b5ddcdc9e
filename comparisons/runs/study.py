"""Studies: keyed tasks in worker processes, each result written to a journal and read back in order, and their folders.

Every study has a folder of its name beneath the one that the user gives: ``compare``, ``judge``, ``bench``, ``stress``.
``sha256sum -c SHA256SUMS`` checks it as well.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass, field, is_dataclass
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final, Generic, TypeVar

from pydantic import TypeAdapter, ValidationError

from analytic.errors import LinkproofError
from comparisons.runs.files import (
    CURVES,
    RECORDS,
    Array,
    Claim,
    RecordFile,
    check_folder,
    claim,
    temporary_records,
    write_text,
    writing,
)
from comparisons.runs.run_engine import Lost
from comparisons.runs.workers import DEFAULT_BOUNDS, EVERY_CORE, Bounds, LocalPool, Pool

DOCUMENT: Final = "study.json"
SUMS: Final = "SHA256SUMS"
FORMAT: Final = 5  # of the files; it counts up where they change
REPEAT_HINT: Final = "run {} with --out again"

WrittenRecord = tuple[str, Mapping[str, Any], Mapping[str, Array]]  # key, row and curves

# The journal of a request: its finished records, appended one by one, so that a killed process loses none.


FOLDER: Final = "unfinished"
HEADER: Final = "request.txt"
COMMAND: Final = "command.txt"


def save_study(folder: Path, kind: str, document: Mapping[str, Any], records: Iterable[WrittenRecord]) -> None:
    """Write a study into ``folder/kind``, which is replaced as a whole once all is written.

    The records may come from a generator; they do not stay in memory.
    """
    lock, new = claim(folder), folder / f".{kind}.new"
    with writing(folder / kind):
        shutil.rmtree(new, ignore_errors=True)
        file = RecordFile(new)
        file.begin()
        for record in records:
            file.append(*record)
        file.finish()
        table = {"kind": kind, "format": FORMAT, **document}
        with (new / DOCUMENT).open("w", encoding="utf-8") as target:  # in pieces: there may be many key figures
            json.dump(table, target, indent=1, ensure_ascii=False, allow_nan=False, default=_json_value)
        sums = "".join(f"{_checksum_line(new / name)}\n" for name in (DOCUMENT, RECORDS, CURVES))
        (new / SUMS).write_text(sums, "utf-8")
        _replace_folder(folder / kind, new)
    del lock


def to_json(document: Mapping[str, Any]) -> str:
    """JSON text with records written out; NaN never appears."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False, default=_json_value) + "\n"


def _json_value(value: object) -> object:
    """A data class as JSON has it, with its ``sentence`` if it has one; raises TypeError for anything else."""
    if not is_dataclass(value) or isinstance(value, type):
        raise TypeError(f"cannot write {type(value).__name__} as JSON")
    sentence = getattr(value, "sentence", None)
    return asdict(value) | ({"sentence": sentence} if sentence is not None else {})


def has_study(folder: Path, kind: str) -> bool:
    """Whether a folder has a study of this kind."""
    return (folder / kind / DOCUMENT).is_file()


def load_study(
    folder: Path, kind: str, form: TypeAdapter[Any], read: Callable[[Mapping[str, Any], Mapping[str, Array]], R]
) -> tuple[dict[str, Any], tuple[R, ...]]:
    """The document of a study, which has the ``form``, and its records, of which ``read`` makes each.

    Raises LinkproofError where the study is missing, damaged, or of another version.
    """
    check_folder(folder)
    place = folder / kind
    if not (place / DOCUMENT).is_file():
        raise LinkproofError(f"no results of {kind} in '{folder}': expected the folder given to {kind} --out")
    with study_errors(folder, kind):
        _check_sums(place)
        document = json.loads((place / DOCUMENT).read_text("utf-8"))
        if document["format"] != FORMAT:
            raise LinkproofError(
                f"'{place}' was made by another version of linkproof: {REPEAT_HINT.format(kind)}, into a new folder"
            )
        form.validate_python(document)
        file = RecordFile(place, may_be_torn=False)
        del document["kind"], document["format"]
        return document, tuple(read(*file.read(key)) for key in file.keys)


@contextmanager
def study_errors(folder: Path, kind: str) -> Iterator[None]:
    """Turn errors of reading a changed or damaged study into LinkproofError."""
    try:
        yield
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise LinkproofError(
            f"'{folder / kind}' cannot be used: {fault_words(error)}; {REPEAT_HINT.format(kind)}"
        ) from error


def _check_sums(place: Path) -> None:
    """Raise ValueError for a file that is not as it was written."""
    sums = (place / SUMS).read_text("utf-8").splitlines()
    for name in (DOCUMENT, RECORDS, CURVES):
        if _checksum_line(place / name) not in sums:
            raise ValueError(f"the checksum of {name} does not match: the file was changed after it was written")


def _checksum_line(path: Path) -> str:
    """A file's line among the checksums, as sha256sum writes it."""
    with path.open("rb") as file:
        return f"{hashlib.file_digest(file, 'sha256').hexdigest()}  {path.name}"


def _replace_folder(place: Path, new: Path) -> None:
    """Put a finished folder in the place of the one before."""
    old = place.with_name(f".{place.name}.old")
    shutil.rmtree(old, ignore_errors=True)
    if place.exists():
        place.rename(old)
    new.rename(place)
    shutil.rmtree(old, ignore_errors=True)


def first_fault(error: ValidationError) -> tuple[str, str]:
    """The key of the first wrong part, such as "cells.3.value", empty for the whole, and the fault in words."""
    first = error.errors(include_url=False, include_input=False)[0]
    return ".".join(map(str, first["loc"])), first["msg"]


def fault_words(error: Exception) -> str:
    """Why a saved file cannot be read: the first fault with its key of a ValidationError, else the error's text."""
    return ": ".join(first_fault(error)) if isinstance(error, ValidationError) else str(error)


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
    check_folder(folder)
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
