"""From the words for a scheduler to a pool of its workers; whatever keeps jobs from it is one sentence."""

from __future__ import annotations

import asyncio
import logging
import re
import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from typing import Any, Final, TypeVar

from analytic.errors import LinkproofError
from comparisons.runs.cluster.local import local_cluster
from comparisons.runs.cluster.pool import ClusterPool
from comparisons.runs.workers import Pool

ADDRESS: Final = re.compile(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9a-fA-F:.]+\]):(\d{1,5})", re.ASCII)
LOCAL: Final = re.compile(r"local:([1-9]\d{0,3})", re.ASCII)
P = TypeVar("P", bound=Pool | None)

PATIENCE: Final = 5.0  # s that a scheduler is given to answer


def check_scheduler(scheduler: object) -> None:
    """Raise LinkproofError for what is no scheduler: words that are no address, or anything but a client of Dask."""
    if scheduler is None:
        return
    if isinstance(scheduler, str):
        found = ADDRESS.fullmatch(scheduler)
        if not (LOCAL.fullmatch(scheduler) or (found and 0 < int(found[1]) < 1 << 16)):
            raise LinkproofError(
                f"--scheduler: expected an address such as tcp://host:8786, or local:N for N workers here, got "
                f"'{scheduler}'; correct it"
            )
    if not isinstance(scheduler, (str, _distributed().Client)):
        raise LinkproofError(
            f"scheduler: expected an address, 'local:N' or a distributed.Client, got a {type(scheduler).__name__}"
        )


@contextmanager
def opened(scheduler: object, otherwise: P, *, alone: bool = False) -> Iterator[Pool | P]:
    """The workers of a scheduler, words or a client, as a pool; ``otherwise`` where there is none.

    ``alone`` is as in ``ClusterPool``. Raises LinkproofError where no job can be run there.
    """
    check_scheduler(scheduler)
    if scheduler is None:
        yield otherwise
        return
    with ExitStack() as stack:
        client: Any = scheduler
        if isinstance(scheduler, str):
            stack.enter_context(_quiet())
            found = LOCAL.fullmatch(scheduler)
            security = _security(is_local=found is not None)
            address = stack.enter_context(local_cluster(int(found[1]), security)) if found else scheduler
            client = stack.enter_context(_client(address, security))
        pool = ClusterPool(client, alone=alone)
        pool.check()
        yield pool


def _distributed() -> Any:  # noqa: ANN401 - a package that need not be there
    try:
        import distributed  # noqa: PLC0415
    except ImportError as error:
        raise _lacking(error) from error
    return distributed


def _lacking(error: ImportError) -> LinkproofError:
    return LinkproofError(
        f"expected Dask for --scheduler, got none ({error}): install it with: pip install 'linkproof[cluster]'"
    )


def _security(*, is_local: bool) -> Any:  # noqa: ANN401
    """The keys of Dask's configuration, if it has any; for workers here a pair that nobody else has."""
    security = _distributed().Security
    try:
        return security.temporary() if is_local else security()
    except ImportError as error:
        raise _lacking(error) from error


@contextmanager
def _client(address: str, security: Any) -> Iterator[Any]:  # noqa: ANN401
    try:
        _greet(address, security.get_connection_args("client"))
        client = _distributed().Client(address, timeout=PATIENCE, set_as_default=False, security=security)
    except Exception as error:  # what is not Dask's answers with anything at all
        raise LinkproofError(
            f"expected a Dask scheduler at {address}, got none that answers ({type(error).__name__}): start it with: "
            "dask scheduler"
        ) from error
    try:
        yield client
    finally:
        client.close(timeout=PATIENCE)


def _greet(address: str, keys: Mapping[str, Any]) -> None:
    """Shake hands with a scheduler; raises whatever comes of it, TimeoutError where nothing does.

    A client of Dask's waits for ever where something listens and says nothing, and complains when it is thrown away.
    """
    from distributed.comm import connect  # noqa: PLC0415

    found: list[BaseException | None] = []

    async def greeted() -> None:
        await (await connect(address, timeout=PATIENCE, **keys)).close()

    def work() -> None:
        try:
            asyncio.run(greeted())
            found.append(None)
        except BaseException as error:
            found.append(error)

    greeting = threading.Thread(target=work, daemon=True)  # the caller's may have a loop of its own
    greeting.start()
    greeting.join(2.0 * PATIENCE)
    fault = found[0] if found else TimeoutError()
    if fault is not None:
        raise fault


@contextmanager
def _quiet() -> Iterator[None]:
    """Dask logs and warns of nothing, and waits for nobody long."""
    _distributed()
    import dask  # noqa: PLC0415

    names = [name for name in logging.root.manager.loggerDict if re.match(r"(distributed|tornado|asyncio)\b", name)]
    loggers = [logging.getLogger(name) for name in {*names, "distributed", "tornado", "asyncio"}]
    levels = [logger.level for logger in loggers]
    try:
        for logger in loggers:
            logger.setLevel(logging.CRITICAL + 1)
        with dask.config.set({"distributed.comm.timeouts.connect": f"{PATIENCE:g}s"}), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
