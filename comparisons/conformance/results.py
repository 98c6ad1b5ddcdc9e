"""A check of the conformance test, what can come of it, and how it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from comparisons.runs.failures import AdapterError, blamed_on
from engines.registry import why_unavailable

if TYPE_CHECKING:
    from comparisons.conformance.trial import Trial


class NotTestedError(Exception):
    """A check of what the engine does not do, or lets nobody look at; the message says why."""


class Finding(StrEnum):
    """What came of a check."""

    PASSED = "passed"
    FAILED = "failed"
    EXPECTED = "expected failure"
    NOT_TESTED = "not tested"


@dataclass(frozen=True)
class CheckResult:
    """A check's finding, with a sentence wherever it did not pass."""

    check: str
    finding: Finding
    detail: str = ""


@dataclass(frozen=True)
class Check:
    """One property that an adapter must have; ``examine`` raises AssertionError, with a sentence, where it has not."""

    name: str
    about: str
    examine: Callable[[Trial], None]

    def result(self, trial: Trial) -> CheckResult:
        """What comes of it in this process."""
        try:
            with blamed_on(trial.engine):
                reason = why_unavailable(trial.engine)
            if reason is not None:
                raise NotTestedError(reason)
            self.examine(trial)
        except AssertionError as failure:
            return CheckResult(self.name, Finding.FAILED, str(failure))
        except NotTestedError as reason:
            return CheckResult(self.name, Finding.NOT_TESTED, str(reason))
        except AdapterError as error:
            return CheckResult(self.name, Finding.FAILED, f"{error}: return failures as outcomes with a reason")
        return CheckResult(self.name, Finding.PASSED)
