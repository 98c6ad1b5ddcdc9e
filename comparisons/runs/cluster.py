"""From the name of a scheduler to a pool of its workers, and a cluster on this machine."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import re
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any, Final, TypeVar

from analytic.errors import LinkproofError
from comparisons.runs.worker_process import inherited_path, isolated_start
from comparisons.runs.workers import Pool

# A cluster on this machine: scheduler and workers in processes of their own, which end with this one.
#
# Its keys are of this run alone: whoever can connect to a cluster can have any code run, and a port is open to all
# users.


_CLOSING_TIME: Final = 5.0  # s
_DASK_SETTINGS: Final = {
    "distributed.worker.daemon": False,  # a daemonic worker may start no process, and every engine run is one
    "distributed.scheduler.allowed-failures": 10,  # so many workers may die before their job counts as the cause
    # Scheduler and worker have a port for their pages, too, which knows no keys.
    **{f"distributed.{server}.http.routes": [] for server in ("scheduler", "worker")},
    **{f"distributed.{server}.preload": ["comparisons.runs.cluster"] for server in ("scheduler", "worker")},
}


@contextmanager
def local_cluster(workers: int, security: Any) -> Iterator[str]:  # noqa: ANN401 - Dask's, which need not be there
    """The address of a scheduler with so many workers of one thread; they ignore Ctrl-C and print nothing.

    ``security`` has the keys that all who connect to one another need.
    """
    context = multiprocessing.get_context("spawn")
    channel, far_end = context.Pipe()
    process = context.Process(target=serve, args=(far_end, workers, security))
    with isolated_start(), inherited_path():
        process.start()
    far_end.close()
    try:
        try:
            address = channel.recv()
        except EOFError as error:
            raise LinkproofError(
                f"expected to start {workers} Dask workers here, got none: run without --scheduler"
            ) from error
        yield address
    finally:
        channel.close()
        process.join(_CLOSING_TIME)
        process.kill()
        process.join()


def serve(channel: Connection, workers: int, security: Any) -> None:  # noqa: ANN401
    """Send the address of a new cluster, and run it until the channel is closed; its workers end with this process."""
    import dask  # noqa: PLC0415
    from distributed import LocalCluster  # noqa: PLC0415

    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        dask.config.set({**_DASK_SETTINGS, "temporary-directory": folder})
        cluster = LocalCluster(
            n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, memory_limit=0,
            security=security,
        )  # fmt: skip
        channel.send(cluster.scheduler_address)
        channel.poll(None)
    os._exit(0)  # which ends the workers, whatever they are doing


def dask_setup(server: Any) -> None:  # noqa: ANN401
    """Close the port for pages of a scheduler or worker; Dask calls this by its name."""
    server.http_server.stop()


# From the name of a scheduler to a pool of its workers; raises one sentence if it cannot have any jobs.

ADDRESS: Final = re.compile(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9a-fA-F:.]+\]):(\d{1,5})", re.ASCII)
LOCAL: Final = re.compile(r"local:([1-9]\d{0,3})", re.ASCII)
P = TypeVar("P", bound=Pool | None)

PATIENCE: Final = 5.0  # s for a scheduler's answer
_LOGGERS: Final = ("distributed", "distributed.client", "tornado.application", "asyncio")  # that Dask writes to


def check_scheduler(scheduler: object) -> None:
    """Raise LinkproofError for anything but an address, "local:N", a client of Dask and None."""
    if isinstance(scheduler, str):
        address = ADDRESS.fullmatch(scheduler)
        is_scheduler = LOCAL.fullmatch(scheduler) or (address and 0 < int(address[1]) < 1 << 16)
    else:
        is_scheduler = scheduler is None or isinstance(scheduler, _import_dask().Client)
    if not is_scheduler:
        raise LinkproofError(
            "--scheduler: expected an address such as tcp://host:8786, local:N for N workers here, or in Python a "
            f"distributed.Client, got {scheduler!r}; correct it"
        )


@contextmanager
def opened(scheduler: object, otherwise: P, *, alone: bool = False) -> Iterator[Pool | P]:
    """The pool of a scheduler's workers, by its address, "local:N" or a client; ``otherwise`` without a scheduler.

    ``alone`` is as in ``ClusterPool``. Raises LinkproofError if no job can run there.
    """
    check_scheduler(scheduler)
    if scheduler is None:
        yield otherwise
        return
    with ExitStack() as stack:
        client: Any = scheduler
        if isinstance(scheduler, str):
            local = LOCAL.fullmatch(scheduler)
            security = _import_dask("cryptography" if local else "distributed").Security
            stack.enter_context(warnings.catch_warnings(action="ignore"))
            for logger in map(logging.getLogger, _LOGGERS):
                stack.callback(logger.setLevel, logger.level)
                logger.setLevel(logging.CRITICAL + 1)
            # The keys of Dask's configuration, if it has any; for workers here a pair that no one else has.
            keys = security.temporary() if local else security()
            address = stack.enter_context(local_cluster(int(local[1]), keys)) if local else scheduler
            client = _connect(address, keys)
            stack.callback(client.close, timeout=PATIENCE)
        from comparisons.runs.cluster_pool import ClusterPool  # noqa: PLC0415

        pool = ClusterPool(client, alone=alone)
        pool.check()
        yield pool


def _import_dask(needed: str = "distributed") -> Any:  # noqa: ANN401 - a package that need not be there
    """Dask; raises LinkproofError if it or another package that is needed is not installed."""
    try:
        import_module(needed)
        return import_module("distributed")
    except ImportError as error:
        raise LinkproofError(
            f"expected Dask for --scheduler, got none ({error}): install it with: pip install 'linkproof[cluster]'"
        ) from error


def _connect(address: str, security: Any) -> Any:  # noqa: ANN401
    try:
        with ThreadPoolExecutor(1) as thread:  # the caller's may have a loop of its own
            greeting = asyncio.wait_for(_shake_hands(address, security.get_connection_args("client")), PATIENCE)
            thread.submit(asyncio.run, greeting).result()
        return _import_dask().Client(address, timeout=PATIENCE, set_as_default=False, security=security)
    except Exception as error:  # a server that is not Dask's can answer with anything
        raise LinkproofError(
            f"expected a Dask scheduler at {address}, got none that answers ({type(error).__name__}): start it with: "
            "dask scheduler"
        ) from error


async def _shake_hands(address: str, keys: Mapping[str, Any]) -> None:
    """Shake hands with a scheduler; a client of Dask would wait for ever for one that listens and says nothing."""
    from distributed.comm import connect  # noqa: PLC0415

    await (await connect(address, timeout=PATIENCE, **keys)).close()
