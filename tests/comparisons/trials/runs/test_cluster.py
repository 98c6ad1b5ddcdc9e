"""Runs on a Dask scheduler with two workers, one of which is killed, are all made once."""

import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import ExitStack

import pytest

from analytic.errors import LinkproofError
from comparisons.trials.runs import cluster
from comparisons.trials.runs.cluster import DaskPool
from comparisons.trials.runs.run_engine import Failure, Lost
from tests.comparisons.faults import job, wait_for
from tests.comparisons.trials.runs.test_workers import ENVIRONMENT, runs

pytest.importorskip("distributed")


@pytest.fixture
def port():
    """A port of this machine that nobody listens to."""
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
