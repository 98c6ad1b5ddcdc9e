"""What is stored comes back to the last bit, survives a kill, and is refused in one sentence where it is not ours."""

import os
import random
import signal
import sqlite3
import stat
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pydantic import TypeAdapter
from typing_extensions import TypedDict

from analytic.errors import LinkproofError
from comparisons.trials.judging.records import ERRORS, NAMES, Error
from comparisons.trials.runs.files import STORE, check_writable, write_file
from comparisons.trials.runs.store import begin, has_study, load_study, save_study, temporary_runs, unfinished_command
from comparisons.trials.runs.workers import LocalPool, Task, TaskList
from tests.comparisons.faults import job


class Form(TypedDict):
    """A document."""

    command: str
    sizes: list[int]


FORM = TypeAdapter[Any](Form)
TOLD = {"command": "linkproof bench", "sizes": [1, 2]}
CURVES = {"Mkr": np.linspace(0.0, 1.0, 20, dtype=np.float32).reshape(4, 5)}
FOUND = Error(*["?"] * len(NAMES), "Mkr", "N m", 1e-7, 1e-8, limit=1e-4, peak=0.3, samples=5, origin="read")
ERROR = dict(zip(ERRORS, FOUND[len(NAMES) :], strict=True))
RUNS = [(f"run {n}", {"number": n / 7.0, "errors": [ERROR], "invariants": [ERROR] * n}, CURVES) for n in range(4)]


def read(folder, kind="bench"):
    return load_study(folder, kind, FORM, lambda row, curves: (row, dict(curves)))


@pytest.fixture
def folder(tmp_path):
    save_study(tmp_path, "bench", TOLD, iter(RUNS))
    return tmp_path


VALUES = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
ROWS = st.dictionaries(st.text(), VALUES, max_size=4)
ANY_CURVES = st.dictionaries(st.text(), arrays(np.float32, st.tuples(st.just(4), st.integers(0, 6))), max_size=3)


@settings(max_examples=8)
@given(st.dictionaries(st.text(), st.tuples(ROWS, ANY_CURVES), max_size=5))
def test_runs_come_back_to_the_last_bit(written):
    encodable = {"".join(c for c in key if c.isprintable()): value for key, value in written.items()}
    with tempfile.TemporaryDirectory() as place:
        runs, _ = begin(Path(place), "request", "command")
        for key, (row, curves) in encodable.items():
            runs.add(key, {f"own {name}": value for name, value in row.items()}, curves)
        again, other = begin(Path(place), "request", "command")
        assert (again.keys, other) == (list(encodable), "")
        for key, (row, curves) in encodable.items():
            back, found = again.read(key)
            assert repr({name: back[f"own {name}"] for name in row}) == repr(row)
            assert {name: one.tobytes() for name, one in found.items()} == {n: c.tobytes() for n, c in curves.items()}


def test_a_second_run_of_a_key_replaces_the_first_with_its_errors():
    runs = temporary_runs()
    for key, row, curves in (*RUNS, ("run 3", {"number": 9}, {})):
        runs.add(key, row, curves)
    assert runs.keys == ["run 0", "run 1", "run 2", "run 3"]
    row, curves = runs.read("run 3")
    assert (row, dict(curves)) == ({"number": 9, "errors": [], "invariants": []}, {})
    with pytest.raises(ValueError, match="not JSON compliant"):
        runs.add("run 0", {"number": float("nan")}, {})
    assert runs.read("run 0")[0] == {"number": 0.0, "errors": [tuple(ERROR.values())], "invariants": []}


def test_a_saved_study_is_read_back_and_replaced_as_a_whole(folder):
    document, rows = read(folder)
    assert document == TOLD
    parts = ("errors", "invariants")
    for (row, curves), (_, written, known) in zip(rows, RUNS, strict=True):
        assert row == {**written, **{part: [tuple(error.values()) for error in written[part]] for part in parts}}
        assert {name: curve.tobytes() for name, curve in curves.items()} == {n: c.tobytes() for n, c in known.items()}
    save_study(folder, "judge", TOLD, RUNS[:1], instead_of={"bench"})
    assert [has_study(folder, kind) for kind in ("bench", "judge", "stress")] == [False, True, False]
    assert [path.name for path in folder.iterdir()] == [STORE]


def test_a_save_that_fails_leaves_the_study_before(folder):
    def failing():
        yield RUNS[0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        save_study(folder, "bench", TOLD, failing())
    assert len(read(folder)[1]) == len(RUNS)


REQUEST = "linkproof compare juki-mf7923d\nnumpy 2.0"


@pytest.mark.parametrize(
    ("now", "told"),
    [
        ("linkproof compare none\nnumpy 2.0", "`linkproof compare juki-mf7923d`, now `linkproof compare none`"),
        ("linkproof compare juki-mf7923d", "`numpy 2.0`, now `nothing`"),
        (REQUEST + "\nnumba 0.60", "`nothing`, now `numba 0.60`"),
    ],
)
def test_the_runs_of_another_request_or_version_are_removed(tmp_path, now, told):
    runs, _ = begin(tmp_path, REQUEST, "linkproof compare --full")
    runs.add("run", {})
    assert unfinished_command(tmp_path) == "linkproof compare --full"
    again, other = begin(tmp_path, now, "command")
    assert (again.keys, other) == ([], told)
    again.clear()
    assert unfinished_command(tmp_path) == ""


OTHER = """
import sys
from pathlib import Path
from analytic.errors import LinkproofError
from comparisons.trials.runs.store import begin
try:
    begin(Path(sys.argv[1]), "another", "command")
except LinkproofError as error:
    sys.exit(str(error))
"""
KILLED = """
import os, signal, sys
from pathlib import Path
from comparisons.trials.runs.store import _transaction, begin
runs, _ = begin(Path(sys.argv[1]), "request", "command")
for number in range(5):
    runs.add(f"run {number}", {"text": "x" * 10**6})
with _transaction(runs.connection):
    runs.put("run 5", {"text": "x" * 10**7}, {})
    os.kill(os.getpid(), signal.SIGKILL)
"""


def python(text, folder):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", text, str(folder)]
    return subprocess.run(command, capture_output=True, text=True, env=environment, check=False)


@pytest.mark.skipif(sys.platform == "win32", reason="no lock there")
def test_another_process_has_no_access_as_long_as_the_runs_live(tmp_path):
    runs, _ = begin(tmp_path, "request", "command")
    assert "another linkproof command is writing to" in python(OTHER, tmp_path).stderr
    del runs
    assert python(OTHER, tmp_path).stderr == ""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal there")
def test_a_kill_within_a_run_loses_that_run_alone(tmp_path):
    assert python(KILLED, tmp_path).returncode == -signal.SIGKILL
    assert (tmp_path / f"{STORE}-journal").is_file()  # half of the sixth run is in the file
    assert begin(tmp_path, "request", "command")[0].keys == [f"run {number}" for number in range(5)]


# -- a file that is not ours -------------------------------------------------------------------------------------------


def damaged(content, chance):
    """Bytes changed, cut out, put in or cut off at a random place."""
    place, length = chance.randrange(len(content)), chance.choice([1, 3, 40])
    instead = {
        "changed": bytes(chance.randrange(256) for _ in range(length)),
        "cut out": b"",
        "put in": content[place : place + 1] + bytes(length),
    }
    return content[:place] if chance.random() < 0.1 else (
        content[:place] + chance.choice(list(instead.values())) + content[place + length :]
    )  # fmt: skip


def refusal(folder):
    """Why a study cannot be read; empty where it can."""
    try:
        read(folder)
        return ""
    except LinkproofError as error:
        return str(error)


def test_a_damaged_file_is_read_or_refused_in_one_sentence(folder):
    chance, path, refused = random.Random(11), folder / STORE, 0
    content = path.read_bytes()
    for _ in range(150):
        path.write_bytes(damaged(content, chance))
        words = refusal(folder)
        refused += bool(words)
        assert "\n" not in words
        assert not words or words.endswith(("run bench with --out again", "give another folder", "to bench --out"))
        assert sorted(each.name for each in folder.iterdir()) == [STORE]
    assert refused > 75


def altered(*statements):
    def alter(path):
        connection = sqlite3.connect(path)
        connection.execute("PRAGMA writable_schema = ON")
        for statement in statements:
            connection.execute(statement)
        connection.commit()
        connection.close()

    return alter


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (altered("PRAGMA user_version = 5"), "another version of linkproof, or another program, has made it"),
        (altered("CREATE VIEW more AS SELECT * FROM runs"), "its tables are not those of linkproof"),
        (altered("CREATE TRIGGER t AFTER DELETE ON runs BEGIN DELETE FROM studies; END"), "its tables are not those"),
        (altered("DROP TABLE curves", "CREATE TABLE curves (run, name)"), "its tables are not those of linkproof"),
        (altered("UPDATE curves SET error = x'00'"), "it has a curve with rows of different lengths"),
        (altered("UPDATE curves SET time = x'00', angle = x'00', reference = x'00', error = x'00'"), "it has a curve"),
        (altered("UPDATE studies SET document = '" + 100_000 * "[" + "'"), "recursion"),
        (altered("UPDATE runs SET facts = '[' WHERE id = 1"), "Expecting value"),
        (altered("UPDATE studies SET document = '{}'"), "command: Field required"),
        (altered("""UPDATE studies SET document = '{"command": "c", "sizes": ["x"]}'"""), r"sizes\.0: Input should be"),
        (lambda path: path.write_bytes(b"text" * 2000), "file is not a database"),
        (lambda path: path.write_bytes(b""), "another version of linkproof, or another program"),
        (lambda path: path.with_name(f"{STORE}-journal").write_bytes(
            bytes(28) + b"/etc/passwd" + bytes.fromhex("d9d505f920a163d7")), "names another file"),
    ],
)  # fmt: skip
def test_what_another_hand_has_made_is_refused(folder, change, words):
    change(folder / STORE)
    with pytest.raises(LinkproofError, match=words):
        read(folder)


def old(path):
    """The folder of a study of an older version."""
    path.with_name("bench").mkdir()
    (path.with_name("bench") / "study.json").write_text("{}")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize(
    ("make", "words"),
    [
        (os.mkfifo, "remove it first"),
        (lambda path: path.symlink_to("/dev/zero"), "remove it first"),
        (lambda path: path.mkdir(), "expected the folder given to bench --out"),
        (lambda path: None, "expected the folder given to bench --out"),
        (old, "an older version of linkproof: run bench with --out again, into a new"),
    ],
)
def test_what_is_no_study_is_refused_with_the_cure(tmp_path, make, words):
    make(tmp_path / STORE)
    with pytest.raises(LinkproofError, match=words):
        read(tmp_path)


# A study makes its tasks once.


TASKS = [Task(f"task {n}", ("fine", n), f"label {n}", weight=n) for n in (1, 3, 2)]


def study(**changes):
    def lost(loss, kind, value):
        return f"{kind} {value}: {loss.outcome}"

    codec = {"encode": lambda value: ({"value": value}, {}), "decode": lambda row, _: row["value"]}
    return TaskList(**{"function": job, "lost": lost, **codec, "pool": LocalPool(0), **changes})


def failing(*_):
    pytest.fail("a task was made again")


def test_several_processes_begin_with_the_heaviest(monkeypatch):
    begun = []

    def run(_, function, jobs, *__):
        for number, arguments in enumerate(jobs):
            begun.append(arguments[1])
            yield number, function(*arguments)

    monkeypatch.setattr(LocalPool, "run", run)
    assert study(pool=LocalPool(2)).complete(TASKS) == [1, 3, 2]
    assert begun == [3, 2, 1]


def test_a_task_requested_twice_is_made_once():
    made = []
    twice = study(function=lambda kind, value: made.append(value) or value)
    assert twice.complete([*TASKS, TASKS[0]]) == [1, 3, 2, 1]
    assert [task.key for task in twice.make(TASKS)] == []
    assert sorted(made) == [1, 2, 3]


def test_a_lost_task_may_count_as_never_begun():
    dropping = study(lost=lambda *_: None)
    assert list(dropping.make([Task("t", ("fail", None)), TASKS[0]])) == [TASKS[0]]
    assert (dropping.has("t"), dropping.result(TASKS[0].key)) == (False, 1)


def test_finished_tasks_are_not_made_again(tmp_path):
    runs, _ = begin(tmp_path, "as tested", "command")
    first = study(finished=runs)
    next(first.make(TASKS))
    assert runs.keys == ["task 1"]
    heard = []
    again = study(finished=runs, announce=lambda *words: heard.append(words))
    assert again.complete(TASKS) == [1, 3, 2]
    assert heard == [("label 3", 1, 3), ("label 3", 2, 3), ("label 2", 2, 3), ("label 2", 3, 3)]
    assert study(finished=runs, function=failing).complete(TASKS) == [1, 3, 2]


# Files appear whole or not at all.


def test_a_failed_write_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "file.txt"
    write_file(path, "old")

    def fail(target):
        target.write_text("half")
        raise RuntimeError("power cut")

    with pytest.raises(RuntimeError):
        write_file(path, fail)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["file.txt"]


KILLED_WRITING = """
import os, pathlib, signal, sys
from comparisons.trials.runs.files import write_file
def write(target):
    target.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
write_file(pathlib.Path(sys.argv[1]), write)
"""


def test_a_kill_in_the_middle_leaves_the_old_file_and_litter_that_the_next_write_removes(tmp_path):
    path = tmp_path / "picture.svg"
    write_file(path, "old")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, "-c", KILLED_WRITING, str(path)], env=environment, check=False)
    assert done.returncode == -signal.SIGKILL
    (litter,) = {*tmp_path.iterdir()} - {path}
    assert (path.read_text(), litter.read_text()) == ("old", "half")
    (tmp_path.parent / "precious").write_text("mine")
    litter.unlink()
    litter.symlink_to(tmp_path.parent / "precious")
    write_file(path, "new")
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("picture.svg", "new")]
    assert (tmp_path.parent / "precious").read_text() == "mine"


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "old").write_text("old")
    for link, target in (("link", "old"), ("dangling", "new")):
        (tmp_path / link).symlink_to(target)
        check_writable(tmp_path / link)
        write_file(tmp_path / link, "text")
        assert (tmp_path / link).is_symlink()
        assert (tmp_path / target).read_text() == "text"
    (tmp_path / "loop").symlink_to("loop")
    for attempt in (check_writable, lambda path: write_file(path, "text")):
        with pytest.raises(LinkproofError, match=r"cannot write .*loop"):
            attempt(tmp_path / "loop")
    assert (tmp_path / "loop").is_symlink()
    assert len(list(tmp_path.iterdir())) == 5


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_what_is_no_file_is_refused_and_stays(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    for path in (tmp_path / "pipe.csv", tmp_path):
        for attempt in (check_writable, lambda path: write_file(path, "text")):
            with pytest.raises(LinkproofError, match=r"cannot write .*expected a file"):
                attempt(path)
    assert stat.S_ISFIFO((tmp_path / "pipe.csv").stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe.csv"]


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
def test_a_new_file_follows_the_umask_and_an_old_one_keeps_its_permissions(tmp_path):
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "new", "text")
    finally:
        os.umask(before)
    (tmp_path / "own").touch(mode=0o600)
    write_file(tmp_path / "own", "text")
    assert [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("new", "own")] == [0o640, 0o600]
