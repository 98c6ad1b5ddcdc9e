"""Jobs on a cluster come to what they come to here, whatever dies on the way; what is no cluster is one sentence."""

import importlib.util
import os
import signal
import socket
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import linkproof
from analytic.errors import LinkproofError
from comparisons.runs.cluster import connecting, station
from comparisons.runs.cluster import pool as pools
from comparisons.runs.cluster.connecting import check_scheduler, opened
from comparisons.runs.cluster.orders import Orders
from comparisons.runs.cluster.pool import ClusterPool
from comparisons.runs.failures import GIB, Failure, Lost
from comparisons.runs.journal import Journal
from comparisons.runs.study import Study, Task
from comparisons.runs.workers import EVERY_CORE, Bounds, PoolLostError, run_jobs
from tests.commands import refused
from tests.comparisons.faults import PATIENCE, children, job, wait_for
from tests.comparisons.runs.test_workers import runs, written

pytestmark = [
    pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="needs distributed"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="kills processes, and reads /proc"),
]
BOUNDS = Bounds(memory=GIB // 16)


@pytest.fixture(scope="module", autouse=True)
def _patient():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(connecting, "PATIENCE", PATIENCE)
        patch.setattr(pools, "ANSWER", PATIENCE)
        yield


@pytest.fixture(scope="module")
def pool():
    with opened("local:2", EVERY_CORE) as found:
        yield found


STRANGER = """
import asyncio, sys
from distributed import Client, Security
from distributed.comm import connect
file, scheduler, *servers = sys.argv[1:]
async def greet(place, keys):
    await (await connect(place, timeout=5, **keys.get_connection_args("client"))).close()
for keys in (Security(), Security.temporary()):
    for scheme in ("tcp", "tls"):
        for attempt in (
            lambda: Client(f"{scheme}://{scheduler}", timeout=5, security=keys).submit(open, file, "w").result(20),
            *(lambda place=place: asyncio.run(greet(f"{scheme}://{place}", keys)) for place in servers),
        ):
            try:
                attempt()
            except Exception as error:
                print(type(error).__name__)
            else:
                sys.exit(f"it is in at {scheme}://{scheduler}, {servers}")
"""


def test_nobody_without_the_keys_of_the_run_has_anything_run(pool, tmp_path):
    workers = pool.client.scheduler_info(n_workers=-1)["workers"]
    places = [pool.address, *workers, *(told["nanny"] for told in workers.values())]
    hosts = [place.partition("://")[2] for place in places]
    command = [sys.executable, "-c", STRANGER, str(tmp_path / "file"), *hosts]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, len(done.stdout.split())) == (0, 4 * len(hosts)), done.stderr
    assert not list(tmp_path.iterdir())
    with pytest.raises(LinkproofError, match="expected a Dask scheduler at tls://"), opened(pool.address, None):
        pass


def test_a_local_cluster_has_no_port_for_pages(pool):
    ports = list(pool.client.run(lambda dask_worker: dask_worker.http_server.port).values())
    ports.append(pool.client.run_on_scheduler(lambda dask_scheduler: dask_scheduler.http_server.port))
    for port in ports:
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", port), 5.0)


def test_an_address_is_called_with_the_keys_of_dasks_configuration(pool):
    keys = pool.client.security.get_tls_config_for_role("client")
    told = {"ca-file": keys["ca_file"], "client.key": keys["key"], "client.cert": keys["cert"]}
    configured = pytest.importorskip("dask").config.set({f"distributed.comm.tls.{name}": told[name] for name in told})
    with configured, opened(pool.address, EVERY_CORE) as other:
        assert dict(other.run(job, [("fine", 3)])) == {0: 3}


def test_every_fate_is_as_in_processes_of_this_one_and_prints_nothing(pool, capfd):
    kinds = ["abort", "leave_at_once", "leave", "swell", "fail", "unsendable", "unreadable", "write", "fine"]
    jobs = [entry for number, kind in enumerate(kinds) for entry in ((kind, number), ("fine", kind))]
    here, there = dict(run_jobs(job, jobs, bounds=BOUNDS)), dict(pool.run(job, jobs, BOUNDS))
    names = {found.host for found in there.values() if isinstance(found, Lost)}
    assert names == {pool.place["hosts"]}
    assert {n: replace(one, host="") if isinstance(one, Lost) else one for n, one in there.items()} == here
    assert capfd.readouterr() == ("", "")


def test_a_job_over_its_time_costs_itself_alone(pool):
    ((_, late),) = pool.run(job, [("spin", None)], Bounds(seconds=0.5))
    assert (late.outcome, late.reason) == (Failure.TIMED_OUT, "took longer than 0.5 s")
    assert list(pool.run(job, [("fine", 1)])) == [(0, 1)]


def test_a_process_is_kept_for_the_next_job(pool):
    processes = {found for _, found in pool.run(os.getpid, [()] * 20)}
    assert processes == {found for _, found in pool.run(os.getpid, [()] * 20)}
    assert len(processes) <= 2


def test_a_study_keeps_what_a_cluster_makes(pool, tmp_path):
    tasks = [Task(f"task {n}", ("fine", n)) for n in range(30)]
    codec = {"encode": lambda value: ({"value": value}, {}), "decode": lambda row, _: row["value"]}
    journal = Journal(tmp_path, "as tested")
    study = Study(job, lambda *_: -1, **codec, journal=journal, pool=pool)
    assert list(study.in_order(tasks)) == list(range(30))
    assert sorted(journal.records.keys) == sorted(task.key for task in tasks)


def test_timed_jobs_of_one_machine_never_overlap(pool):
    assert len(pool.stations) == 2
    with opened(pool.client, EVERY_CORE, alone=True) as alone:
        times = sorted(found for _, found in alone.run(job, [("clocked", n) for n in range(5)]))
    assert all(one[1] <= other[0] for one, other in pairwise(times))


def test_timed_jobs_want_machines_alike(pool):
    unlike = ClusterPool(pool.client, alone=True, hosts={"other": "a machine of another kind"})
    with pytest.raises(LinkproofError, match=r"expected machines of one kind.*of another kind.*linkproof merge"):
        unlike.check()


def test_closing_ends_what_jobs_have_started(pool, tmp_path):
    paths = [tmp_path / "one", tmp_path / "two"]
    results = pool.run(job, [("fine", 1), ("sign_and_sleep", str(paths[0])), ("fork_and_sleep", str(paths[1]))])
    assert next(results) == (0, 1)
    assert wait_for(lambda: all(map(written, paths)))
    processes = [int(path.read_text()) for path in paths]
    results.close()
    assert wait_for(lambda: not any(map(runs, processes)))


def test_a_client_may_be_handed_in_and_is_left_open(pool):
    with opened(pool.client, EVERY_CORE) as other:
        assert dict(other.run(job, [("fine", 3)])) == {0: 3}
    assert pool.client.status == "running"


def test_functions_of_python_take_a_client(pool):
    vary = {"rod.B.x": np.linspace(170.0, 180.0, 5)}
    here, there = (linkproof.sweep("rimoldi-164", vary, "Mkr.peak", scheduler=one) for one in (None, pool.client))
    assert here.identical(there)
    asked = {"engine": "direct", "quantity": "Jeq"}
    here, there = (linkproof.compare("juki-mf7923d", **asked, scheduler=one).records for one in (None, pool.client))
    assert {record.host for record in there} == {pool.place["hosts"]}
    assert [record.error_max for record in there] == [record.error_max for record in here]


def test_workers_that_lack_anything_are_refused(pool, monkeypatch):
    known = station.facts().environment
    for changed, told in [
        ({**known, "numpy": "1.0"}, f": expected numpy 1.0, as here, got {known['numpy']}: install the same"),
        ({**known, "direct": "9"}, f": expected direct 9, as here, got {known['direct']}: install the same"),
        ({**known, "new": "9"}, ": expected new 9, as here, got none: install the same"),
    ]:
        monkeypatch.setattr(station, "environment", lambda _, changed=changed: changed)
        with pytest.raises(LinkproofError) as error:
            ClusterPool(pool.client).check()
        assert str(error.value).startswith("worker tls://127.0.0.1:")
        assert told in str(error.value)
    monkeypatch.undo()
    monkeypatch.setattr(station, "sources", lambda: "others")
    with pytest.raises(LinkproofError, match="expected linkproof's files as they are here"):
        ClusterPool(pool.client).check()
    here = station.facts()
    assert "DASK_DISTRIBUTED__WORKER__DAEMON=False" in pools._fault(replace(here, is_daemon=True), here)


def test_another_dask_is_refused(pool, monkeypatch):
    told = pool.client.get_versions()
    told["scheduler"]["packages"]["distributed"] = "2020.1"

    async def answer():
        return told

    monkeypatch.setattr(pool.client, "_get_versions", answer)
    with pytest.raises(LinkproofError, match=r"^scheduler tls://\S+: expected distributed .* as here, got 2020.1"):
        ClusterPool(pool.client).check()


def test_a_job_whose_result_is_lost_on_its_way_is_given_out_again(pool, monkeypatch):
    bring, seen = Orders._bring, []

    async def broken(self, future):
        if not seen:
            seen.append(await future)
            self.arrived.put((future.key, OSError("stream is closed")))
        else:
            await bring(self, future)

    monkeypatch.setattr(Orders, "_bring", broken)
    assert sorted(pool.run(job, [("fine", n) for n in range(4)])) == [(n, n) for n in range(4)]
    assert seen


def test_what_listens_and_says_nothing_is_no_scheduler(monkeypatch):
    monkeypatch.setattr(connecting, "PATIENCE", 0.5)
    with (
        socket.create_server(("127.0.0.1", 0)) as silent,
        pytest.raises(LinkproofError, match=r"got none that answers \(TimeoutError\)"),
        opened(f"tcp://127.0.0.1:{silent.getsockname()[1]}", None),
    ):
        pass


@pytest.mark.parametrize(
    "words", ["local:0", "local:-1", "local:x", "local", "tcp://host", "host:8786", "tcp://h:0", "tcp://h:70000", ""]
)
def test_words_that_are_no_scheduler_are_refused(words):
    with pytest.raises(LinkproofError, match="--scheduler: expected an address such as"):
        check_scheduler(words)


def test_what_is_no_client_is_refused():
    with pytest.raises(LinkproofError, match=r"expected an address, 'local:N' or a distributed.Client, got a int"):
        check_scheduler(8786)


@pytest.mark.parametrize("package", ["distributed", "cryptography"])
def test_without_dask_or_its_keys_it_is_said_how_to_get_them(monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[cluster\]'"), opened("local:2", None):
        pass


def test_a_scheduler_that_is_not_there_is_said_and_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr(connecting, "PATIENCE", 0.5)
    told = refused("stress", "--scheduler", "tcp://127.0.0.1:1", "--out", "out", cwd=tmp_path)
    assert told.startswith("linkproof: expected a Dask scheduler at tcp://127.0.0.1:1, got none that answers")
    assert list(tmp_path.iterdir()) == []


def test_a_lost_scheduler_is_said_and_its_processes_end(tmp_path):
    path = tmp_path / "process"
    with opened("local:1", EVERY_CORE) as pool:
        workers = list(pool.client.run(os.getpid).values())
        results = pool.run(job, [("fine", 1), ("sign_and_sleep", str(path))])
        assert next(results) == (0, 1)
        assert wait_for(lambda: written(path))
        os.kill(pool.client.run_on_scheduler(os.getpid), signal.SIGKILL)
        with pytest.raises(PoolLostError, match=r"the scheduler at tls://\S+ (is gone|does not answer)"):
            next(results)
    assert wait_for(lambda: not any(map(runs, [*workers, int(path.read_text())])))


COMMAND = """
import sys
from comparisons.runs.cluster import connecting
from comparisons.runs.cluster.connecting import opened
from tests.comparisons.faults import PATIENCE, job
connecting.PATIENCE = PATIENCE
with opened("local:1", None) as pool:
    list(pool.run(job, [("sign_and_sleep", sys.argv[1])]))
"""


@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
def test_a_local_cluster_dies_with_its_command(tmp_path, by):
    path = tmp_path / "process"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen(
        [sys.executable, "-c", COMMAND, str(path)], env=environment, stderr=subprocess.DEVNULL
    ) as command:
        assert wait_for(lambda: written(path))
        cluster = children(command.pid)
        assert cluster
        command.send_signal(by)
        command.wait(PATIENCE)
    assert wait_for(lambda: not any(map(runs, [*cluster, int(path.read_text())])))
