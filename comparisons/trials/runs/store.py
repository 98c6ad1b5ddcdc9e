"""The results of a folder in one SQLite file: its studies, their runs, and the errors and the curves of these.

A folder has at most one finished study of a kind (``compare``, ``judge``, ``bench``, ``stress``, ``results``), and the
runs of one request that is not finished. Every run is added in a transaction of its own, so that a killed process
loses no more than the run that it was making.

A file may come from a stranger. It is read only if its tables are exactly ours and SQLite finds each value of the type
of its column; nothing in it is run, and nothing is written while it is read.

A browser's Python has SQLite only if it is asked for: it is imported by what opens a file.
"""

from __future__ import annotations

import json
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import asdict, dataclass, field, is_dataclass
from itertools import islice, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from analytic.errors import LinkproofError
from comparisons.trials.runs.files import STORE, Claim, check_folder, claim

if TYPE_CHECKING:
    import sqlite3

R = TypeVar("R")
Curve = NDArray[np.float32]  # (4, samples): CURVE
WrittenRun = tuple[str, Mapping[str, Any], Mapping[str, Curve]]  # key, row and curves

FORMAT: Final = 6  # of the file and of what is in it; it counts up where they change
REPEAT_HINT: Final = "run {} with --out again"
UNFINISHED: Final = ""  # the kind of a study that is not finished
LARGEST: Final = 1 << 28  # bytes of a text or a curve
PAGE: Final = 1 << 15  # bytes of a page of the file, which has room for ten curves; of the usual size one fills it
BEFORE: Final = "study.json"  # the document of a study up to format 5, in a folder of the study's name
_SUPER_JOURNAL: Final = bytes.fromhex("d9d505f920a163d7")  # ends a rollback journal that names another file

# A run's ``errors`` and ``invariants`` (``is_check``) are rows of a table of their own, with these columns.
ERRORS: Final = {
    "quantity": "TEXT NOT NULL",
    "unit": "TEXT NOT NULL",
    "error_max": "REAL",
    "error_rms": "REAL",
    "error_at_jumps": "REAL NOT NULL",
    "limit": "REAL",
    "outcome": "TEXT NOT NULL",
    "detail": "TEXT NOT NULL",
    "peak": "REAL",
    "worst_time": "REAL",
    "samples": "INTEGER NOT NULL",
    "left_out": "INTEGER NOT NULL",
    "origin": "TEXT NOT NULL",
    "shared": "TEXT NOT NULL",
}
# The rows of a curve: s, rad (m of a linear drive), and twice the unit of its quantity, "error" being what is observed
# beyond the reference.
CURVE: Final = ("time", "angle", "reference", "error")
_COLUMNS: Final = ", ".join(f'"{name}"' for name in ERRORS)
_SCHEMA: Final = (
    "CREATE TABLE studies (id INTEGER PRIMARY KEY, kind TEXT NOT NULL UNIQUE, request TEXT NOT NULL, "
    "command TEXT NOT NULL, document TEXT NOT NULL) STRICT",
    "CREATE TABLE runs (id INTEGER PRIMARY KEY, study INTEGER NOT NULL REFERENCES studies ON DELETE CASCADE, "
    "key TEXT NOT NULL, facts TEXT NOT NULL, UNIQUE (study, key)) STRICT",
    "CREATE TABLE errors (run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE, is_check INTEGER NOT NULL, "
    + ", ".join(f'"{name}" {kind}' for name, kind in ERRORS.items())
    + ") STRICT",
    "CREATE INDEX errors_of_run ON errors (run)",
    "CREATE TABLE curves (run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE, name TEXT NOT NULL, "
    + ", ".join(f"{name} BLOB NOT NULL" for name in CURVE)
    + ", UNIQUE (run, name)) STRICT",
)


@dataclass(eq=False)
class Runs:
    """The runs of a study in an open file, by key; they come back in the order in which they were added.

    A run is a ``row``, JSON-ready, whose ``errors`` and ``invariants`` have the columns ``ERRORS``, and its curves,
    single precision, by name.
    """

    connection: sqlite3.Connection
    study: int
    lock: Claim | None = None  # keeps other processes out of the folder
    _numbers: dict[str, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Read the keys of the runs that the study has."""
        found = self.connection.execute("SELECT key, id FROM runs WHERE study = ? ORDER BY id", (self.study,))
        self._numbers = dict(found)

    @property
    def keys(self) -> Sequence[str]:
        """The keys of all runs, in the order of adding."""
        return list(self._numbers)

    def __contains__(self, key: object) -> bool:
        """Whether there is a run of this key."""
        return key in self._numbers

    def add(self, key: str, row: Mapping[str, Any], curves: Mapping[str, Curve] | None = None) -> None:
        """Add a run in one transaction; it takes the place of another of the same key, at the end.

        A curve is (4, samples) with the rows ``CURVE``, kept in single precision. Raises ValueError for a number of the
        row that is not finite, TypeError for a value that JSON lacks, KeyError for an error that lacks a column, and
        SQLite's errors.
        """
        with _transaction(self.connection):
            self.put(key, row, curves or {})

    def put(self, key: str, row: Mapping[str, Any], curves: Mapping[str, Curve]) -> None:
        """Add a run, replacing one of the same key, within a transaction that the caller has begun.

        Arguments and errors are those of ``add``.
        """
        facts = {name: value for name, value in row.items() if name not in ("errors", "invariants")}
        text = json.dumps(facts, ensure_ascii=False, allow_nan=False)
        execute, many = self.connection.execute, self.connection.executemany
        if key in self._numbers:
            execute("DELETE FROM runs WHERE id = ?", (self._numbers.pop(key),))
        number = execute("INSERT INTO runs (study, key, facts) VALUES (?, ?, ?)", (self.study, key, text)).lastrowid
        assert number is not None
        for is_check, part in enumerate(("errors", "invariants")):
            rows = ((number, is_check, *(error[name] for name in ERRORS)) for error in row.get(part, ()))
            many(f"INSERT INTO errors VALUES (?, ?{', ?' * len(ERRORS)})", rows)
        blobs = ((number, name, *(row.tobytes() for row in curve.astype("<f4"))) for name, curve in curves.items())
        many(f"INSERT INTO curves VALUES (?, ?{', ?' * len(CURVE)})", blobs)
        self._numbers[key] = number

    def read(self, key: str) -> tuple[dict[str, Any], Mapping[str, Curve]]:
        """The row and the curves of a run, by its key; raises KeyError for another.

        Of the row ``errors`` and ``invariants`` are lists of tuples of values, in the order of ``ERRORS``. A curve, by
        its quantity, is read from the file when it is asked for.
        """
        return next(self._read("id", self._numbers[key]))

    def every(self) -> Iterator[tuple[dict[str, Any], Mapping[str, Curve]]]:
        """Yield row and curves of every run as ``read`` has them, in the order of adding, in one pass over the file."""
        return self._read("study", self.study)

    def _read(self, column: str, number: int) -> Iterator[tuple[dict[str, Any], Mapping[str, Curve]]]:
        """Yield row and curves of the runs whose ``column``, "id" or "study", has this number, as ``read`` has them."""
        mine, select = f"FROM errors WHERE run IN (SELECT id FROM runs WHERE {column} = ?)", self.connection.execute
        counts = {
            run: (count - checks, checks)
            for run, count, checks in select(f"SELECT run, count(*), sum(is_check) {mine} GROUP BY run", (number,))
        }
        errors = select(f"SELECT {_COLUMNS} {mine} ORDER BY run, rowid", (number,))
        for run, text in select(f"SELECT id, facts FROM runs WHERE {column} = ? ORDER BY id", (number,)):
            parts = [list(islice(errors, count)) for count in counts.get(run, (0, 0))]
            yield {**json.loads(text), "errors": parts[0], "invariants": parts[1]}, _Curves(self.connection, run)

    def clear(self) -> None:
        """Remove the study and all its runs from the file; it is of no use afterwards."""
        with _transaction(self.connection):
            self.connection.execute("DELETE FROM studies WHERE id = ?", (self.study,))
        self._numbers.clear()


@dataclass(frozen=True)
class _Curves(Mapping[str, Curve]):
    """The curves of a run by quantity, left in their file."""

    connection: sqlite3.Connection
    run: int

    def __getitem__(self, name: str) -> Curve:
        """The curve of a quantity, (4, samples), single precision, read from the file; raises KeyError without one."""
        query = f"SELECT {', '.join(CURVE)} FROM curves WHERE run = ? AND name = ?"
        blobs = self.connection.execute(query, (self.run, name)).fetchone()
        if blobs is None:
            raise KeyError(name)
        return np.array([np.frombuffer(blob, dtype="<f4") for blob in blobs])

    def __iter__(self) -> Iterator[str]:
        """An iterator over the names of the quantities that have a curve, in the order of writing."""
        names = self.connection.execute("SELECT name FROM curves WHERE run = ? ORDER BY rowid", (self.run,))
        return (name for (name,) in names.fetchall())

    def __len__(self) -> int:
        """Number of curves."""
        return len(list(iter(self)))


_BEGUN: weakref.WeakValueDictionary[Path, Runs] = weakref.WeakValueDictionary()  # by folder: one connection writes


def temporary_runs() -> Runs:
    """An empty store of runs in a file without a name, deleted when the process ends."""
    import sqlite3  # noqa: PLC0415

    connection = sqlite3.connect("", isolation_level=None)
    connection.execute("PRAGMA foreign_keys = ON")
    _make_tables(connection)
    return _new_study(connection, UNFINISHED)


def begin(folder: Path, request: str, command: str) -> tuple[Runs, str]:
    """The store of a request's finished runs, and how an earlier, other request in the folder differed; "" if none.

    The folder is made if it is missing. ``request`` is the text that tells it from any other: first the command that
    began it, then, line by line, all else that decides its results, such as versions. ``command`` repeats it with every
    option. The runs of another request are removed; how it differed is its first other line, then and now. As long as
    the runs live no other process may write into the folder, and ``save_study`` writes by their connection. Raises
    LinkproofError for a folder that another command has, or that cannot be used, and for a damaged file.
    """
    lock, connection = claim(folder), _open(folder, to_write=True)
    _check_values(connection, folder)
    with store_errors(folder), _transaction(connection):
        found = connection.execute("SELECT id, request FROM studies WHERE kind = ?", (UNFINISHED,)).fetchone()
        number, begun = found or (None, request)
        lines = zip_longest(begun.splitlines(), request.splitlines(), fillvalue="nothing")
        other = next((f"`{then}`, now `{now}`" for then, now in lines if then != now), "")
        if number is None or other:
            runs = _new_study(connection, UNFINISHED, request=request)
        else:
            runs = Runs(connection, number)
        connection.execute("UPDATE studies SET command = ? WHERE id = ?", (command, runs.study))
    runs.lock = lock
    _BEGUN[folder.resolve()] = runs
    return runs, other


def save_study(
    folder: Path, kind: str, document: Mapping[str, Any], runs: Iterable[WrittenRun], instead_of: Iterable[str] = ()
) -> None:
    """Write a study in one transaction, replacing one of its kind and those of the kinds ``instead_of``.

    Each run is its key, row and curves, as for ``Runs.add``. They may come from a generator; they do not stay in
    memory. Raises LinkproofError where the folder cannot be written, or for a value that JSON cannot hold.
    """
    lock = claim(folder)
    begun = _BEGUN.get(folder.resolve())
    with ExitStack() as stack:
        connection = begun.connection if begun else stack.enter_context(closing(_open(folder, to_write=True)))
        stack.enter_context(store_errors(folder, kind))
        stack.enter_context(_transaction(connection))
        for other in instead_of:
            connection.execute("DELETE FROM studies WHERE kind = ?", (other,))
        study = _new_study(connection, kind, document=to_json(document))
        for run in runs:
            study.put(*run)
    del lock


def _new_study(connection: sqlite3.Connection, kind: str, *, request: str = "", document: str = "{}") -> Runs:
    """An empty store of a study of this kind, in place of an earlier one with all its runs.

    ``request`` is as for ``begin``, ``document`` JSON text; the command is "".
    """
    connection.execute("DELETE FROM studies WHERE kind = ?", (kind,))
    words = (kind, request, "", document)
    made = connection.execute("INSERT INTO studies (kind, request, command, document) VALUES (?, ?, ?, ?)", words)
    assert made.lastrowid is not None
    return Runs(connection, made.lastrowid)


def to_json(document: Mapping[str, Any]) -> str:
    """JSON text, indented and with a line end, of a document; data classes in it are written out as mappings.

    Raises ValueError for NaN and infinity, TypeError for other objects.
    """
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False, default=_json_value) + "\n"


def _json_value(value: object) -> object:
    """A data class as a mapping for JSON, with its ``sentence`` if it has one; raises TypeError for anything else."""
    if not is_dataclass(value) or isinstance(value, type):
        raise TypeError(f"cannot write {type(value).__name__} as JSON")
    sentence = getattr(value, "sentence", None)
    return asdict(value) | ({"sentence": sentence} if sentence is not None else {})


def has_study(folder: Path, kind: str) -> bool:
    """Whether a folder has a finished study of this kind, or one that an older version left in a folder of that name.

    Raises LinkproofError for a file that cannot be used.
    """
    return (folder / kind / BEFORE).is_file() or _first_row(
        folder, "SELECT 1 FROM studies WHERE kind = ?", kind
    ) is not None


def unfinished_command(folder: Path) -> str:
    """The command that repeats a folder's unfinished study; "" if there is none.

    Raises LinkproofError for a file that cannot be used.
    """
    found: str = _first_row(folder, "SELECT command FROM studies WHERE kind = ?", UNFINISHED) or ""
    return found


def load_study(
    folder: Path, kind: str, form: TypeAdapter[Any], read: Callable[[Mapping[str, Any], Mapping[str, Curve]], R]
) -> tuple[dict[str, Any], tuple[R, ...]]:
    """The document of a study, which has the ``form``, and its runs, of which ``read`` makes each.

    ``read(row, curves)`` is called with a run as ``Runs.read`` has it. Raises LinkproofError where the study is
    missing, damaged, or of another version.
    """
    found = _first_row(folder, "SELECT id, document FROM studies WHERE kind = ?", kind, whole=True)
    if found is None:
        raise LinkproofError(f"no results of {kind} in '{folder}': expected the folder given to {kind} --out")
    connection = _open(folder)
    _check_values(connection, folder, kind)
    with store_errors(folder, kind):
        document = json.loads(found[1])
        form.validate_python(document)
        runs = Runs(connection, found[0])
        return document, tuple(read(row, curves) for row, curves in runs.every())


def _first_row(folder: Path, query: str, kind: str, *, whole: bool = False) -> Any:  # noqa: ANN401 - what is asked for
    """The first row of a query about a kind of study, or its first value unless ``whole``; None without such a study.

    ``query`` is SQL with one ?, for the kind. Raises LinkproofError for a file that cannot be used or is an older
    version's.
    """
    check_folder(folder)
    if kind and (folder / kind / BEFORE).is_file():
        raise LinkproofError(
            f"'{folder / kind}' was made by an older version of linkproof: {REPEAT_HINT.format(kind)}, into a new "
            "folder"
        )
    if not (folder / STORE).is_file():
        return None
    with store_errors(folder, kind), closing(_open(folder)) as connection:
        found = connection.execute(query, (kind,)).fetchone()
    return found if whole or found is None else found[0]


@contextmanager
def store_errors(folder: Path, kind: str = "") -> Iterator[None]:
    """In the block, raise a LinkproofError for an error of reading or writing the folder's file.

    That is any of SQLite's, OSError, ValueError, KeyError, TypeError and RecursionError. ``kind`` names the command
    that cures it.
    """
    import sqlite3  # noqa: PLC0415

    try:
        yield
    except (sqlite3.Error, OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        cure = REPEAT_HINT.format(kind) if kind else "give another folder"
        raise LinkproofError(f"'{folder / STORE}' cannot be used: {fault_words(error)}; {cure}") from error


def fault_words(error: Exception) -> str:
    """The reason why a saved file cannot be read: a ValidationError's first fault, else the error's text."""
    if not isinstance(error, ValidationError):
        return str(error)
    first = error.errors(include_url=False, include_input=False)[0]
    return ": ".join(filter(None, (".".join(map(str, first["loc"])), first["msg"])))


def _open(folder: Path, *, to_write: bool = False) -> sqlite3.Connection:
    """A connection to the folder's file, for reading alone unless ``to_write``, which makes a missing or empty one.

    What a killed process left half-written is rolled back, which needs a folder that can be written. Raises
    LinkproofError for a missing file, or one that is not linkproof's.
    """
    import sqlite3  # noqa: PLC0415

    check_folder(folder)
    path, journal = folder / STORE, folder / f"{STORE}-journal"
    with store_errors(folder):
        is_torn = journal.is_file()
        if is_torn and journal.read_bytes()[-len(_SUPER_JOURNAL) :] == _SUPER_JOURNAL:
            raise ValueError(f"{journal.name} names another file")
        is_new = to_write and not (path.is_file() and path.stat().st_size)
        mode = "rwc" if is_new else "rw" if to_write or is_torn else "ro"
        address = f"{path.absolute().as_uri()}?mode={mode}"
        connection = sqlite3.connect(address, uri=True, isolation_level=None)
        try:
            connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST)
            connection.execute("PRAGMA trusted_schema = OFF")
            connection.execute("PRAGMA foreign_keys = ON")
            if is_new:
                _make_tables(connection)
            _check_tables(connection)
        except BaseException:
            connection.close()
            raise
        return connection


def _make_tables(connection: sqlite3.Connection) -> None:
    """Create the tables in an empty file, in one transaction, and set its format."""
    connection.execute(f"PRAGMA page_size = {PAGE}")
    connection.execute("PRAGMA auto_vacuum = FULL")
    with _transaction(connection):
        for table in _SCHEMA:
            connection.execute(table)
        connection.execute(f"PRAGMA user_version = {FORMAT}")


def _check_tables(connection: sqlite3.Connection) -> None:
    """Raise ValueError for a file whose tables are not exactly ours."""
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if version != FORMAT:
        raise ValueError("another version of linkproof, or another program, has made it")
    tables = connection.execute("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL ORDER BY rowid")
    if tuple(sql for (sql,) in tables) != _SCHEMA:
        raise ValueError("its tables are not those of linkproof")


def _check_values(connection: sqlite3.Connection, folder: Path, kind: str = "") -> None:
    """Raise LinkproofError for a file that is damaged, or has a value of another type than its column's.

    So too for a curve with rows of different lengths. ``kind`` names the command that cures it.
    """
    with store_errors(folder, kind):
        (verdict,) = connection.execute("PRAGMA quick_check(1)").fetchone()
        if verdict != "ok":
            raise ValueError(f"it is damaged ({verdict})")
        lengths = " OR ".join(f"length({name}) <> length(time)" for name in CURVE)
        if connection.execute(f"SELECT 1 FROM curves WHERE length(time) % 4 OR {lengths} LIMIT 1").fetchone():
            raise ValueError("it has a curve with rows of different lengths")


@contextmanager
def _transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """Write everything that the block does to the file or, if it raises, nothing; the exception passes."""
    with connection:
        connection.execute("BEGIN IMMEDIATE")
        yield
