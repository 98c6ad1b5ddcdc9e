"""A study makes its tasks once, and comes back as it was saved or is refused in one sentence."""

import random
import shutil
import subprocess
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from typing_extensions import TypedDict

from analytic.errors import LinkproofError
from comparisons.runs.study import SUMS, Journal, Study, Task, has_study, load_study, save_study
from comparisons.runs.workers import LocalPool
from tests.comparisons.faults import job

TASKS = [Task(f"task {n}", ("fine", n), f"label {n}", weight=n) for n in (1, 3, 2)]


def study(**changes):
    def lost(loss, kind, value):
        return f"{kind} {value}: {loss.outcome}"

    codec = {"encode": lambda value: ({"value": value}, {}), "decode": lambda row, _: row["value"]}
    return Study(**{"function": job, "lost": lost, **codec, "pool": LocalPool(0), **changes})


def failing(*_):
    pytest.fail("a task was made again")


def test_several_processes_begin_with_the_heaviest(monkeypatch):
    begun = []

    def run_jobs(function, jobs, **_):
        for number, arguments in enumerate(jobs):
            begun.append(arguments[1])
            yield number, function(*arguments)

    monkeypatch.setattr("comparisons.runs.workers.run_jobs", run_jobs)
    assert list(study(pool=LocalPool(2)).in_order(TASKS)) == [1, 3, 2]
    assert begun == [3, 2, 1]


def test_a_task_requested_twice_is_made_once():
    made = []
    twice = study(function=lambda kind, value: made.append(value) or value)
    assert list(twice.in_order([*TASKS, TASKS[0]])) == [1, 3, 2, 1]
    assert [task.key for task in twice.make(TASKS)] == []
    assert sorted(made) == [1, 2, 3]


def test_a_lost_task_may_count_as_never_begun():
    dropping = study(lost=lambda *_: None)
    assert list(dropping.make([Task("t", ("fail", None)), TASKS[0]])) == [TASKS[0]]
    assert list(dropping.results()) == [1]


def test_tasks_in_the_journal_are_not_made_again(tmp_path):
    journal = Journal(tmp_path, "as tested")
    first = study(journal=journal)
    next(first.make(TASKS))
    assert journal.records.keys == ["task 1"]
    heard = []
    again = study(journal=journal, announce=lambda *words: heard.append(words))
    assert list(again.in_order(TASKS)) == [1, 3, 2]
    assert heard == [("label 3", 1, 3), ("label 3", 2, 3), ("label 2", 2, 3), ("label 2", 3, 3)]
    assert list(study(journal=journal, function=failing).in_order(TASKS)) == [1, 3, 2]


class Form(TypedDict):
    """A document."""

    command: str
    sizes: list[int]


FORM = TypeAdapter[Any](Form)
TOLD = {"command": "linkproof bench", "sizes": [1, 2]}
RECORDS = [(f"run {n}", {"error": n / 7.0}, {"Mkr": np.linspace(0.0, n, 5)}) for n in range(4)]


@pytest.fixture
def folder(tmp_path):
    save_study(tmp_path, "bench", TOLD, iter(RECORDS))
    return tmp_path


def read(folder):
    return load_study(folder, "bench", FORM, lambda row, curves: (row["key"], row["error"], curves["Mkr"].tobytes()))


def test_what_is_saved_is_read_back_and_replaced_as_a_whole(folder):
    document, rows = read(folder)
    assert document == TOLD
    assert list(rows) == [(key, row["error"], curves["Mkr"].tobytes()) for key, row, curves in RECORDS]
    save_study(folder, "bench", TOLD, RECORDS[:1])
    assert len(read(folder)[1]) == 1
    assert [path.name for path in folder.iterdir()] == ["bench"]
    assert has_study(folder, "bench")
    assert not has_study(folder, "stress")


def test_a_save_that_fails_leaves_the_study_before(folder):
    def failing():
        yield RECORDS[0]
        raise KeyboardInterrupt

    before = read(folder)
    with pytest.raises(KeyboardInterrupt):
        save_study(folder, "bench", TOLD, failing())
    assert read(folder) == before


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="no sha256sum here")
def test_the_checksums_are_those_of_sha256sum(folder):
    done = subprocess.run(["sha256sum", "-c", SUMS], cwd=folder / "bench", capture_output=True, text=True, check=True)
    assert done.stdout.count(": OK") == 3


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


def outcome(folder):
    try:
        return str(read(folder))
    except LinkproofError as error:
        return str(error)


def test_whatever_is_damaged_is_refused_in_one_sentence(folder):
    chance, whole = random.Random(11), read(folder)
    for _ in range(100):
        path = chance.choice(sorted((folder / "bench").iterdir()))
        content = path.read_bytes()
        other = damaged(content, chance)
        path.write_bytes(other)
        found = outcome(folder)
        assert found == str(whole) or ("\n" not in found and found.endswith("run bench with --out again"))
        assert found != str(whole) or other == content or path.name == SUMS  # a line added to the sums
        path.write_bytes(content)


@pytest.mark.parametrize("name", [SUMS, "curves.npy"])
def test_a_file_that_is_missing_is_missed(folder, name):
    (folder / "bench" / name).unlink()
    with pytest.raises(LinkproofError, match=r"run bench with --out again|expected the folder given to bench --out"):
        read(folder)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({**TOLD, "sizes": ["x"]}, r"sizes\.0: Input should be a valid integer"),
        ({"command": "c"}, "sizes: Field required"),
        ({**TOLD, "format": 9}, "bench' was made by another version of linkproof: run bench with --out again"),
    ],
)
def test_a_document_of_another_form_is_refused_by_its_key(tmp_path, told, words):
    save_study(tmp_path, "bench", told, RECORDS)
    with pytest.raises(LinkproofError, match=words):
        read(tmp_path)


def test_an_empty_folder_is_refused_with_the_cure(tmp_path):
    with pytest.raises(LinkproofError, match="expected the folder given to bench --out"):
        load_study(tmp_path, "bench", FORM, dict)
