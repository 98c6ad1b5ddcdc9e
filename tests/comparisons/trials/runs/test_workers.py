"""A job in a worker can fail, hang, crash or use up memory, and no other job is lost."""

import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from analytic.errors import LinkproofError
from comparisons.trials.runs import cluster, worker_process
from comparisons.trials.runs.cluster import DaskPool
from comparisons.trials.runs.run_engine import GIB, SHOW_OUTPUT, Failure, Lost, RunBounds
from comparisons.trials.runs.workers import LocalPool
from tests.comparisons.faults import PATIENCE, Clock, job, wait_for

ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
BOUNDS = RunBounds(memory=GIB // 16)

FATES = [
    ("abort", None, Failure.CRASHED, "died by signal 6 (SIGABRT)"),
    ("crash", None, Failure.CRASHED, "died by signal 11 (SIGSEGV)"),
    ("leave_at_once", 3, Failure.CRASHED, "exited with code 3"),
    ("leave", None, Failure.CRASHED, "exited with code 0"),
    ("leave", "words", Failure.CRASHED, "exited with code 1"),
    ("swell", None, Failure.CRASHED, "needed more than 0.0625 GiB of memory"),
    ("swell_in_c", None, Failure.CRASHED, "needed more than 0.0625 GiB of memory"),
    ("fail", None, Failure.SUITE_ERROR, "this is a fault of linkproof: ValueError: first line second line ("),
    ("unsendable", None, Failure.SUITE_ERROR, "this is a fault of linkproof: "),
    ("unreadable", None, Failure.CRASHED, "sent an answer that cannot be read (ValueError)"),
]


@pytest.fixture
def clock(monkeypatch):
    """The clock that the time of jobs is measured by."""
    found = Clock()
    monkeypatch.setattr("pebble.pool.process.time", found)
    return found


def runs(process):
    """Whether a process is there and no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def written(path):
    return path.exists() and path.read_text() != ""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="bounds on memory and the C++ library are Linux's")
def test_every_fault_costs_its_own_job_and_prints_nothing(capfd):
    jobs = [one for kind, value, *_ in FATES for one in ((kind, value), ("fine", kind), ("write", kind))]
    results = dict(LocalPool().run(job, jobs, bounds=BOUNDS))
    assert sorted(results) == list(range(len(jobs)))
    for number, (kind, _, outcome, reason) in enumerate(FATES):
        lost = results[3 * number]
        assert isinstance(lost, Lost), kind
        assert (kind, lost.outcome) == (kind, outcome)
        assert lost.reason.startswith(reason)
        assert results[3 * number + 1] == results[3 * number + 2] == kind
    assert capfd.readouterr() == ("", "")


def test_a_job_that_writes_into_its_pipe_costs_itself_alone_and_prints_nothing(monkeypatch, capfd):
    monkeypatch.setattr(worker_process, "_EXIT_TIMEOUT", 0.1)
    results = dict(LocalPool(1).run(job, [("fine", 1), ("garble", None), ("fine", 2)]))
    assert results == {0: 1, 1: Lost(Failure.CRASHED, "broke its connection"), 2: 2}
    assert capfd.readouterr() == ("", "")


def test_a_job_does_not_pay_for_what_another_did_to_its_worker():
    jobs = [("spoil", 1), *(("clocked", None),) * 3, ("fine", 3)]
    results = dict(LocalPool(1).run(job, jobs))
    assert (len(results), results[0], results[4]) == (5, 1, 3)
    assert not any(isinstance(one, Lost) for one in results.values())


def test_a_job_that_brings_down_any_worker_is_tried_no_more_than_twice():
    begun = []
    jobs = [("fine", 1), ("abort", None), ("abort", None), ("fine", 2)]
    results = dict(LocalPool(1).run(job, jobs, begun=begun.append))
    assert [results[0], results[3]] == [1, 2]
    assert {results[1].reason, results[2].reason} == {"died by signal 6 (SIGABRT)"}
    assert begun == [0, 1, 1, 2, 3]


def test_results_come_as_they_complete_and_jobs_begin_in_order(tmp_path):
    begun, path = [], tmp_path / "at last"
    results = LocalPool(2).run(job, [("slow", str(path)), ("fine", 1), ("fine", 2)], begun=begun.append)
    assert [next(results), next(results)] == [(1, 1), (2, 2)]
    path.touch()
    assert list(results) == [(0, str(path))]
    assert begun == [0, 1, 2]


def test_output_is_shown_on_request(monkeypatch, capfd):
    monkeypatch.setenv("LINKPROOF_WORKER_START", "spawn")
    monkeypatch.setenv(SHOW_OUTPUT, "1")
    list(LocalPool(1).run(job, [("write", None)]))
    assert all("noise" in text for text in capfd.readouterr())


def test_workers_import_what_their_parent_does_and_nothing_from_the_working_folder(tmp_path):
    for name in ("program", "elsewhere"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "probe.py").write_text(f"def where():\n    return '{name}'\n")
    words = (
        "from comparisons.trials.runs.workers import EVERY_CORE; import probe; "
        "print(list(EVERY_CORE.run(probe.where, [()])))"
    )
    (tmp_path / "program" / "script.py").write_text(words)
    command = [sys.executable, str(tmp_path / "program" / "script.py")]
    done = subprocess.run(
        command, cwd=tmp_path / "elsewhere", env=ENVIRONMENT, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[(0, 'program')]\n"


def test_a_worker_that_has_ended_between_two_jobs_costs_none():
    with closing(LocalPool(1, lasts=True)) as pool:
        ((_, first),) = pool.run(os.getpid, [()])
        os.kill(first, signal.SIGTERM)
        ((_, second),) = pool.run(os.getpid, [()])
        assert isinstance(second, int)


def test_a_worker_does_not_hear_ctrl_c():
    assert list(LocalPool().run(job, [("interrupt_itself", 7)])) == [(0, 7)]


def test_without_processes_jobs_run_here_and_what_they_raise_is_caught():
    jobs = [("fine", 1), ("fail", None), ("leave", 3)]
    (_, fine), (_, failed), (_, left) = LocalPool(0).run(job, jobs)
    assert fine == 1
    assert failed.outcome is Failure.SUITE_ERROR
    assert "ValueError: first line second line (comparisons/trials/runs/workers.py, line " in failed.reason
    assert left == Lost(Failure.CRASHED, "exited with code 3")
    with pytest.raises(KeyboardInterrupt):
        list(LocalPool(0).run(job, [("interrupt_itself", None)]))


def test_a_lasting_worker_serves_list_after_list_until_one_is_interrupted(tmp_path):
    def signed(pool, name):
        assert list(pool.run(job, [("sign", str(tmp_path / name))], BOUNDS)) == [(0, None)]
        return int((tmp_path / name).read_text())

    with closing(LocalPool(1, lasts=True)) as pool:
        first = signed(pool, "first")
        assert first == signed(pool, "second") != os.getpid()
        assert runs(first)
        left = pool.run(job, [("fine", 1), ("sign_and_sleep", str(tmp_path / "left"))], BOUNDS)
        assert next(left) == (0, 1)
        left.close()
        assert not runs(first)
        third = signed(pool, "third")
        assert third != first
        assert [lost.outcome for _, lost in pool.run(job, [("abort", None)], BOUNDS)] == [Failure.CRASHED]
    assert not runs(third)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_a_job_over_its_time_costs_itself_alone_and_what_it_has_started_dies(tmp_path, clock):
    path = tmp_path / "child"
    results = LocalPool(1).run(job, [("fine", 1), ("fork_and_sleep", str(path))])
    assert next(results) == (0, 1)
    assert wait_for(lambda: written(path))
    assert runs(int(path.read_text()))
    clock.rate = 1000.0
    assert list(results) == [(1, Lost(Failure.TIMED_OUT, "took longer than 600 s"))]
    assert wait_for(lambda: not runs(int(path.read_text())))


PARENT = """
import sys
from comparisons.trials.runs.workers import LocalPool
from tests.comparisons.faults import job
list(LocalPool(2).run(job, zip(["sign_and_sleep", "fork_and_sleep"], sys.argv[1:])))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("by", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_no_worker_and_nothing_that_it_has_started_outlives_the_command(tmp_path, by):
    paths = [tmp_path / name for name in ("one", "two")]
    command = [sys.executable, "-c", PARENT, *map(str, paths)]
    with subprocess.Popen(command, env=ENVIRONMENT, stderr=subprocess.PIPE, start_new_session=True) as parent:
        assert wait_for(lambda: parent.poll() is not None or all(map(written, paths)))
        assert parent.returncode is None, parent.stderr.read()
        started = [int(path.read_text()) for path in paths]
        assert all(map(runs, started))
        os.kill(parent.pid, by)
        parent.wait(PATIENCE)
    assert wait_for(lambda: not any(map(runs, started)))


# Runs on a Dask scheduler with two workers, one of which is killed, are all made once.


@pytest.fixture
def port():
    """A port of this machine that nobody listens to."""
    pytest.importorskip("distributed")
    with socket.create_server(("127.0.0.1", 0)) as found:
        return found.getsockname()[1]


@pytest.fixture
def workers(port):
    """Two workers, of one thread each, of a scheduler at the port."""
    tool = [sys.executable, "-m", "distributed.cli.dask_worker", f"tcp://127.0.0.1:{port}", "--nthreads", "1"]
    scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port)]
    with ExitStack() as stack:
        started = [
            stack.enter_context(
                subprocess.Popen(
                    [*command, "--no-dashboard"], env=ENVIRONMENT, stderr=subprocess.DEVNULL, start_new_session=True
                )
            )
            for command in (scheduler, tool, tool)
        ]
        yield started[1:]
        for process in started:
            os.killpg(process.pid, signal.SIGKILL)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_runs_of_a_worker_that_is_killed_are_made_by_the_other(port, workers, tmp_path):
    def kill():
        assert wait_for(lambda: len(os.listdir(tmp_path)) == 2)
        first = [int(name) for name in os.listdir(tmp_path)]
        os.killpg(workers[0].pid, signal.SIGKILL)
        assert wait_for(lambda: sum(map(runs, first)) == 1)  # nothing outlives the worker
        (tmp_path / "go").touch()

    killing, begun = threading.Thread(target=kill), []
    killing.start()
    jobs = [*[("sign_and_wait", str(tmp_path))] * 5, ("abort", None), ("fine", 7)]
    found = list(DaskPool(f"tcp://127.0.0.1:{port}").run(job, jobs, begun=begun.append))
    killing.join()
    results = dict(found)
    assert sorted(number for number, _ in found) == begun == list(range(len(jobs)))
    assert (results[5], results[6]) == (Lost(Failure.CRASHED, "died by signal 6 (SIGABRT)"), 7)
    assert not any(isinstance(results[number], Lost) for number in range(5))


def test_an_address_without_a_scheduler_is_refused(port, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_TIMEOUT", 0.5)
    with pytest.raises(LinkproofError, match="--scheduler: no workers at 'tcp:"):
        list(DaskPool(f"tcp://127.0.0.1:{port}").run(job, [("fine", 1)]))
