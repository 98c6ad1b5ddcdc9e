"""A study makes its tasks once."""

import pytest

from comparisons.trials.runs.store import begin
from comparisons.trials.runs.study import Study, Task
from comparisons.trials.runs.workers import LocalPool
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

    def run(_, function, jobs, *__):
        for number, arguments in enumerate(jobs):
            begun.append(arguments[1])
            yield number, function(*arguments)

    monkeypatch.setattr(LocalPool, "run", run)
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
    assert (dropping.has("t"), dropping.result(TASKS[0].key)) == (False, 1)


def test_finished_tasks_are_not_made_again(tmp_path):
    runs, _ = begin(tmp_path, "as tested", "command")
    first = study(finished=runs)
    next(first.make(TASKS))
    assert runs.keys == ["task 1"]
    heard = []
    again = study(finished=runs, announce=lambda *words: heard.append(words))
    assert list(again.in_order(TASKS)) == [1, 3, 2]
    assert heard == [("label 3", 1, 3), ("label 3", 2, 3), ("label 2", 2, 3), ("label 2", 3, 3)]
    assert list(study(finished=runs, function=failing).in_order(TASKS)) == [1, 3, 2]
