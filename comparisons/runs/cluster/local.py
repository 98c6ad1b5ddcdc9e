"""A cluster on this machine: scheduler and workers in processes of their own, which end with this one.

Its keys are of this run alone: whoever can connect to a cluster can have any code run, and a port is open to all users.
"""

from __future__ import annotations

import multiprocessing
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any, Final

from analytic.errors import LinkproofError
from comparisons.runs.worker_process import cut_off, same_path

_CLOSING: Final = 5.0  # s
_SETTINGS: Final = {
    "distributed.worker.daemon": False,  # a daemonic worker may start no process, and every engine run is one
    "distributed.scheduler.allowed-failures": 10,  # so many workers may die before their job counts as the cause
    # Scheduler and worker have a port for their pages, too, which knows no keys.
    **{f"distributed.{server}.http.routes": [] for server in ("scheduler", "worker")},
    **{f"distributed.{server}.preload": ["comparisons.runs.cluster.local"] for server in ("scheduler", "worker")},
}


@contextmanager
def local_cluster(workers: int, security: Any) -> Iterator[str]:  # noqa: ANN401 - Dask's, which need not be there
    """The address of a scheduler with so many workers of one thread; they ignore Ctrl-C and print nothing.

    ``security`` has the keys that all who connect to one another need.
    """
    context = multiprocessing.get_context("spawn")
    channel, far_end = context.Pipe()
    process = context.Process(target=serve, args=(far_end, workers, security))
    with cut_off(), same_path():
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
        process.join(_CLOSING)
        process.kill()
        process.join()


def serve(channel: Connection, workers: int, security: Any) -> None:  # noqa: ANN401
    """Send the address of a new cluster, and run it until the channel is closed; its workers end with this process."""
    import dask  # noqa: PLC0415
    from distributed import LocalCluster  # noqa: PLC0415

    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        dask.config.set({**_SETTINGS, "temporary-directory": folder})
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
