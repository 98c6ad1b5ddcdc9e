"""A cluster on this machine: scheduler and workers in processes of their own, which end with whoever started them.

``python -m comparisons.runs.cluster.local N`` says its address and serves until its input ends.
"""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from analytic.errors import LinkproofError
from comparisons.runs.worker_process import same_path

_CLOSING = 5.0  # s


@contextmanager
def local_cluster(workers: int) -> Iterator[str]:
    """The address of a scheduler with so many workers of one thread; they hear no Ctrl-C and print nothing."""
    command = [sys.executable, "-m", "comparisons.runs.cluster.local", str(workers)]
    with same_path():
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True
        )
    assert process.stdin is not None
    assert process.stdout is not None
    with process.stdin, process.stdout:
        try:
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

    with tempfile.TemporaryDirectory() as folder:
        # A Dask worker that is daemonic may start no process, and every engine run is one.
        dask.config.set({"distributed.worker.daemon": False, "temporary-directory": folder})
        cluster = LocalCluster(
            n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, memory_limit=0,
            silence_logs=logging.CRITICAL,
        )  # fmt: skip
        sys.stdout.write(f"{cluster.scheduler_address}\n")
        sys.stdout.flush()
        sys.stdin.read()
        with suppress(Exception):
            cluster.close(timeout=_CLOSING)


if __name__ == "__main__":
    try:
        serve(int(sys.argv[1]))
    finally:
        if hasattr(os, "killpg"):
            os.killpg(0, signal.SIGKILL)
