"""Runs on the workers of a Dask scheduler that the user has started, each isolated there as it is on this machine."""

from __future__ import annotations

import logging
import multiprocessing
import threading
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any, Final, TypeVar
from uuid import uuid4

from analytic.errors import LinkproofError, install_words
from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, Failure, Lost, RunBounds
from comparisons.trials.runs.workers import Begun, LocalPool

R = TypeVar("R")

CONNECT_TIMEOUT: Final = 20.0  # s within which a scheduler answers and has a worker
_THREAD: Final = threading.local()  # each thread of a Dask worker has a worker process of its own


@dataclass(frozen=True)
class DaskPool:
    """The workers of the scheduler at an ``address``.

    Where a worker dies, the scheduler has another make its runs again, until the third has died of one.
    """

    address: str

    def run(
        self,
        function: Callable[..., R],
        jobs: Iterable[tuple[Any, ...]],
        bounds: RunBounds = DEFAULT_BOUNDS,
        begun: Begun = lambda _: None,
    ) -> Generator[tuple[int, R | Lost], None, None]:
        """Yield number and result of each ``function(*job)``, as a ``Pool`` does, as they end.

        ``bounds`` and ``begun`` are as there, but ``begun`` is called as a job is sent to the scheduler; two a thread
        are under way. Raises LinkproofError where there is no scheduler, no worker, or one of another version, and
        where the scheduler ends.
        """
        with self._client() as client:
            size = 2 * sum(client.nthreads().values())
            left, numbers, ended = enumerate(jobs), {}, _as_completed(client)

            def submit() -> None:
                """Call ``begun`` for the next of the jobs left, if there is one, submit it, and note its number."""
                for number, job in left:
                    begun(number)
                    future = client.submit(_isolated, function, job, bounds, key=f"linkproof-{uuid4().hex}")
                    numbers[future.key] = number
                    ended.add(future)
                    return

            for _ in range(size):
                submit()
            for future in ended:
                result = self._result(future)
                submit()
                yield numbers.pop(future.key), result

    def close(self) -> None:
        """Do nothing: no state is left behind by a list of jobs."""

    def _client(self) -> Any:  # noqa: ANN401 - distributed has no types
        """A connection to the scheduler, to be closed, by the security that the user's configuration of Dask names.

        The log of Dask is silenced. Raises LinkproofError without Dask, scheduler or workers, or for workers of another
        version.
        """
        try:
            from distributed import Client  # noqa: PLC0415
        except ModuleNotFoundError as error:
            raise LinkproofError(f"--scheduler: {error}; {install_words('dask')} brings it") from error
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is wrong is said below
        try:
            client = Client(self.address, timeout=CONNECT_TIMEOUT, set_as_default=False)
            client.wait_for_workers(1, CONNECT_TIMEOUT)
            versions = client.run(version, "linkproof")
        except Exception as error:  # of its configuration, its network, its workers
            raise LinkproofError(
                f"--scheduler: no workers at '{self.address}' ({type(error).__name__}: {error}); give the address of a "
                "Dask scheduler that runs and has workers with linkproof"
            ) from error
        others = sorted({found for found in versions.values() if found != version("linkproof")})
        if others:
            raise LinkproofError(f"--scheduler: its workers have linkproof {', '.join(others)}: install the same there")
        return client

    def _result(self, future: Any) -> Any:  # noqa: ANN401
        """The result of a job from its Dask ``future``, or a Lost one if its workers died.

        Raises LinkproofError for every other failure, as where the scheduler has ended.
        """
        from distributed import KilledWorker  # noqa: PLC0415

        try:
            return future.result()
        except KilledWorker:
            return Lost(Failure.CRASHED, "every Dask worker that it was given to died")
        except Exception as error:
            raise LinkproofError(f"--scheduler: '{self.address}' gave no result: {error}; run again") from error


def _as_completed(client: Any) -> Any:  # noqa: ANN401
    """Dask's iterator over results as they come, on the loop of this client."""
    from distributed import as_completed  # noqa: PLC0415

    return as_completed(loop=client.loop)


def _isolated(function: Callable[..., R], job: tuple[Any, ...], bounds: RunBounds) -> R | Lost:
    """On a Dask worker: run a job in a process of this thread's own, started with its first job.

    Its result, or a Lost one that says how it was lost. The worker's own process is no daemon any more. Raises
    LinkproofError where no process can start.
    """
    multiprocessing.current_process().daemon = False  # one that Dask has started may start none otherwise
    pool: LocalPool = _THREAD.__dict__.setdefault("pool", LocalPool(1, lasts=True))
    return next(result for _, result in pool.run(function, [job], bounds))
