"""A cluster on this machine: scheduler and workers in processes of their own, which end with whoever started them.

``python -m comparisons.runs.cluster.local N`` reads its keys, prints its address and serves until its input ends. The
keys are of this run alone: whoever can connect to a cluster can have any code run, and a port is open to all users.
"""

from __future__ import annotations

import logging
import os
import pickle
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, Final

from analytic.errors import LinkproofError
from comparisons.runs.worker_process import same_path

MODULE: Final = "comparisons.runs.cluster.local"
_CLOSING = 5.0  # s


@contextmanager
def local_cluster(workers: int, security: Any) -> Iterator[str]:  # noqa: ANN401 - Dask's, which need not be there
    """The address of a scheduler with so many workers of one thread; they hear no Ctrl-C and print nothing.

    ``security`` has the keys that all who connect to one another need.
    """
    command = [sys.executable, "-m", MODULE, str(workers)]
    with same_path():
        process = subprocess.Popen(
            command, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            start_new_session=True,
        )  # fmt: skip
    assert process.stdin is not None
    assert process.stdout is not None
    with process.stdin, process.stdout:
        try:
            with suppress(BrokenPipeError):  # of one that has ended, and says no address
                process.stdin.write(pickle.dumps(security))
            address = process.stdout.readline().decode().strip()
            if not address:
                raise LinkproofError(
                    f"expected to start {workers} Dask workers here, got none: run without --scheduler"
                )
            yield address
        finally:
            _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    assert process.stdin is not None
    process.stdin.close()
    with suppress(subprocess.TimeoutExpired):
        process.wait(2.0 * _CLOSING)
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


def serve(workers: int) -> None:
    """Be the cluster until the input ends."""
    import dask  # noqa: PLC0415
    from distributed import LocalCluster  # noqa: PLC0415

    security = pickle.load(sys.stdin.buffer)
    with tempfile.TemporaryDirectory() as folder:
        # A Dask worker that is daemonic may start no process, and every engine run is one.
        dask.config.set({"distributed.worker.daemon": False, "temporary-directory": folder})
        for server in ("scheduler", "worker"):  # each has a port for its pages, too, which knows no keys
            dask.config.set({f"distributed.{server}.http.routes": [], f"distributed.{server}.preload": [MODULE]})
        cluster = LocalCluster(
            n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, memory_limit=0,
            silence_logs=logging.CRITICAL, security=security,
        )  # fmt: skip
        sys.stdout.write(f"{cluster.scheduler_address}\n")
        sys.stdout.flush()
        sys.stdin.read()
        with suppress(Exception):
            cluster.close(timeout=_CLOSING)


def dask_setup(server: Any) -> None:  # noqa: ANN401
    """Close the port for pages of a scheduler or worker; Dask calls this by its name."""
    server.http_server.stop()


if __name__ == "__main__":
    try:
        serve(int(sys.argv[1]))
    finally:
        if hasattr(os, "killpg"):
            os.killpg(0, signal.SIGKILL)
