"""A check of the conformance test, what can come of it, and how it is made."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from comparisons.runs.failures import AdapterError, Failure, Lost, blamed_on
from comparisons.runs.workers import Bounds, run_jobs
from engines.contract import Engine
from engines.registry import why_unavailable

BOUNDS = Bounds(seconds=120.0)


class NotApplicableError(Exception):
    """A check of something that the engine does not claim to do; the message says what."""


class NotTestedError(Exception):
    """A check that an engine gives no hold for; the message says why."""


class Finding(StrEnum):
    """What came of a check."""

    PASSED = "passed"
    FAILED = "failed"
    EXPECTED = "expected failure"
    NOT_APPLICABLE = "not applicable"
    NOT_TESTED = "not tested"


@dataclass(frozen=True)
class Check:
    """One property that an adapter is held to.

    ``alone``: what it does may bring a process down. ``needs_engine``: not what an adapter says without its engine.
    """

    name: str
    about: str
    examine: Callable[[Engine], None]
    alone: bool = False
    needs_engine: bool = True


@dataclass(frozen=True)
class Found:
    """A check's finding, with a sentence wherever it did not pass."""

    check: str
    finding: Finding
    detail: str = ""


def examined(engine: Engine, check: Check) -> Found:
    """What comes of a check in this process."""
    try:
        with blamed_on(engine):
            reason = why_unavailable(engine)
        if reason is not None and check.needs_engine:
            raise NotApplicableError(reason)
        check.examine(engine)
    except AssertionError as failure:
        return Found(check.name, Finding.FAILED, str(failure))
    except NotApplicableError as reason:
        return Found(check.name, Finding.NOT_APPLICABLE, str(reason))
    except NotTestedError as reason:
        return Found(check.name, Finding.NOT_TESTED, str(reason))
    except AdapterError as error:
        return Found(check.name, Finding.FAILED, f"{error}: hand failures back as outcomes with a reason")
    return Found(check.name, Finding.PASSED)


def in_workers(
    examine: Callable[..., Found], engine: Engine, names: list[str], processes: int | None = None
) -> list[Found]:
    """What comes of ``examine(pickled engine, name)`` in worker processes; a check that brings one down has failed."""
    try:
        pickled = pickle.dumps(engine)
    except Exception:
        reason = "the engine cannot be sent to another process: let its class stand in a module of its own"
        return [Found(name, Finding.NOT_TESTED, reason) for name in names]
    found: dict[int, Found] = {}
    jobs: list[tuple[Any, ...]] = [(pickled, name) for name in names]
    for number, result in run_jobs(examine, jobs, bounds=BOUNDS, processes=processes):
        found[number] = _of_lost(names[number], result) if isinstance(result, Lost) else result
    return [found[number] for number in range(len(names))]


def _of_lost(name: str, lost: Lost) -> Found:
    if lost.outcome in (Failure.TIMED_OUT, Failure.CRASHED):
        what = "it" if lost.outcome is Failure.TIMED_OUT else "its process"
        return Found(name, Finding.FAILED, f"{what} {lost.reason}: end every run with an outcome and a reason")
    return Found(name, Finding.FAILED, lost.reason)


def with_expected(found: Found, expected: Mapping[str, str]) -> Found:
    """A finding where some failures are expected, by check; one that passes all the same fails."""
    reason = expected.get(found.check)
    if reason is None:
        return found
    if found.finding is Finding.FAILED:
        return replace(found, finding=Finding.EXPECTED, detail=f"{reason} ({found.detail})")
    if found.finding is Finding.PASSED:
        detail = f"it passes, though it is expected to fail ({reason}): take it from the expected failures"
        return replace(found, finding=Finding.FAILED, detail=detail)
    return found
