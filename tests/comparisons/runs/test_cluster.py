"""Jobs on a cluster have the results of jobs in this process, also where workers die; refusals are one sentence."""

import os
import signal
import socket
import subprocess
import sys
from dataclasses import replace
from itertools import count, islice, pairwise

import pytest

from analytic.errors import LinkproofError
from comparisons.runs import cluster as connecting
from comparisons.runs.cluster import check_scheduler, opened
from comparisons.runs.run_engine import GIB, Failure, Lost
from comparisons.runs.workers import EVERY_CORE, Bounds, PoolLostError, run_jobs
from tests.comparisons.faults import PATIENCE, children, job, wait_for
from tests.comparisons.runs.test_workers import runs, written

pools = pytest.importorskip("comparisons.runs.cluster_pool", exc_type=ImportError)
pytestmark = [
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="kills processes, and reads /proc"),
]
BOUNDS = Bounds(memory=GIB // 16)


@pytest.fixture(scope="module", autouse=True)
def _patient():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(connecting, "PATIENCE", PATIENCE)
        patch.setattr(pools, "STARTUP_TIMEOUT", PATIENCE)
        yield


@pytest.fixture(scope="module")
def pool():
    with opened("local:2", EVERY_CORE) as found:
        yield found


STRANGER = """
import asyncio, os, sys
from distributed import Client, Security
from distributed.comm import connect
Client.__del__ = lambda _: None  # one that never got in would wait ten seconds to leave
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
                print(type(error).__name__, flush=True)
            else:
                sys.exit(f"it is in at {scheme}://{scheduler}, {servers}")
os._exit(0)  # likewise
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


def test_timed_jobs_of_one_machine_never_overlap_and_a_client_stays_open(pool):
    assert len(pool.machines) == 2
    with opened(pool.client, EVERY_CORE, alone=True) as alone:
        times = sorted(found for _, found in alone.run(job, [("clocked", n) for n in range(5)]))
    assert all(one[1] <= other[0] for one, other in pairwise(times))
    assert pool.client.status == "running"


def test_jobs_of_a_place_stay_on_its_machine_as_long_as_it_is_there(pool):
    kind, versions = pool.here.kind, pool.here.versions
    machines = {address: pools.DaskMachine(f"host of {address}", kind, versions, is_daemon=False) for address in "12"}
    timed = pools.ClusterPool(pool.client, alone=True, machines=machines)
    assert [timed.preferred_worker(place) for place in "abcb"] == ["1", "2", "1", "2"]
    del machines["2"]
    assert timed.workers_for(("b", 1)) == ["1"]


def test_closing_ends_what_jobs_have_started(pool, tmp_path):
    paths = [tmp_path / "one", tmp_path / "two"]
    results = pool.run(job, [("fine", 1), ("sign_and_sleep", str(paths[0])), ("fork_and_sleep", str(paths[1]))])
    assert next(results) == (0, 1)
    assert wait_for(lambda: all(map(written, paths)))
    processes = [int(path.read_text()) for path in paths]
    results.close()
    assert wait_for(lambda: not any(map(runs, processes)))


@pytest.mark.parametrize(
    ("name", "expected", "got"),
    [("numpy", "1.0", "[0-9.]+"), ("linkproof's files", "others", "[0-9a-f]+")],
)
def test_workers_that_lack_anything_are_refused_and_late_ones_left_alone(pool, name, expected, got):
    unlike = pools.ClusterPool(pool.client, here=replace(pool.here, versions={**pool.here.versions, name: expected}))
    message = rf"^worker tls://127.0.0.1:\d+: expected {name} {expected}, as here, got {got}: install the same"
    with pytest.raises(LinkproofError, match=message):
        unlike.check()
    assert not unlike.machines


def test_another_dask_is_refused(pool, monkeypatch):
    told = pool.client.get_versions()
    told["scheduler"]["packages"]["distributed"] = "2020.1"

    async def answer():
        return told

    monkeypatch.setattr(pool.client, "_get_versions", answer)
    with pytest.raises(LinkproofError, match=r"^scheduler tls://\S+: expected distributed .* as here, got 2020.1"):
        pools.ClusterPool(pool.client).check()


def test_a_job_whose_result_is_lost_on_its_way_is_given_out_again(pool, monkeypatch):
    gather, lost = pool.client._gather, []

    async def broken(futures, *args, **words):
        if not lost:
            lost.append(futures)
            raise OSError("stream is closed")
        return await gather(futures, *args, **words)

    monkeypatch.setattr(pool.client, "_gather", broken)
    assert sorted(pool.run(job, [("fine", n) for n in range(4)])) == [(n, n) for n in range(4)]
    assert lost


def test_few_jobs_are_in_dasks_hands_at_a_time(pool):
    taken = count()
    results = pool.run(job, (("fine", n) for n in taken))
    assert all(number == value for number, value in islice(results, 20))
    results.close()
    assert next(taken) <= 20 + 2 * pool.room + 1


def test_a_job_whose_workers_are_all_gone_is_given_to_others_and_not_for_ever(pool, monkeypatch):
    monkeypatch.setattr(pools, "PULSE", 0.0)
    dispatch, gone = pools.ClusterPool.workers_for, iter([True] * 12)
    monkeypatch.setattr(
        pools.ClusterPool, "workers_for",
        lambda self, one: ["tcp://127.0.0.1:1"] if one == ("fine", 0) and next(gone) else dispatch(self, one),
    )  # fmt: skip
    results = dict(pool.run(job, [("fine", 0), ("fine", 1)]))
    assert results == {0: Lost(Failure.CRASHED, "all Dask workers that ran it have died"), 1: 1}


def test_no_worker_for_long_ends_the_run(pool, monkeypatch):
    async def none():
        return {}

    lonely = pools.ClusterPool(pool.client)
    monkeypatch.setattr(pool.client.scheduler, "ncores", none, raising=False)
    with pytest.raises(LinkproofError, match=r"expected workers at tls://\S+, got none: start some with: dask worker"):
        lonely.check()
    monkeypatch.setattr(pools, "PULSE", 0.0)
    monkeypatch.setattr(pools, "NO_WORKER_TIMEOUT", 0.0)
    with pytest.raises(PoolLostError, match=r"^no worker is left at tls://"):
        list(lonely.run(job, [("fine", 1)]))


def test_what_listens_and_says_nothing_is_no_scheduler(monkeypatch):
    monkeypatch.setattr(connecting, "PATIENCE", 0.5)
    with (
        socket.create_server(("127.0.0.1", 0)) as silent,
        pytest.raises(LinkproofError, match=r"got none that answers \(TimeoutError\)"),
        opened(f"tcp://127.0.0.1:{silent.getsockname()[1]}", None),
    ):
        pass


@pytest.mark.parametrize(
    "words",
    ["local:0", "local:x", "tcp://host", "host:8786", "tcp://h:70000", 8786],
)
def test_words_that_are_no_scheduler_are_refused(words):
    with pytest.raises(LinkproofError, match=f"--scheduler: expected an address such as .* got {words!r}; correct it"):
        check_scheduler(words)


@pytest.mark.parametrize("package", ["distributed", "cryptography"])
def test_without_dask_or_its_keys_the_message_says_how_to_install_them(monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[cluster\]'"), opened("local:2", None):
        pass


@pytest.mark.nightly
def test_a_lost_scheduler_is_an_error_and_its_processes_end(tmp_path):
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
from comparisons.runs import cluster as connecting
from comparisons.runs.cluster import opened
from tests.comparisons.faults import PATIENCE, job
connecting.PATIENCE = PATIENCE
with opened("local:1", None) as pool:
    list(pool.run(job, [("sign_and_sleep", sys.argv[1])]))
"""


@pytest.mark.nightly
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


def test_daemonic_workers_and_those_without_linkproof_are_refused(pool):
    assert "DASK_DISTRIBUTED__WORKER__DAEMON=False" in pool._why_unusable(replace(pool.here, is_daemon=True))
    assert pool._why_unusable(ImportError("no")).startswith("expected linkproof, as here, got none (no)")
