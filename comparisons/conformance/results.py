"""A check of the conformance test and its result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from comparisons.runs.failures import AdapterError, blamed_on
from engines.registry import why_unavailable

if TYPE_CHECKING:
    from comparisons.conformance.trial import EngineTrial


class NotTestedError(Exception):
    """A check that cannot be made: the engine lacks a feature, or a hook for the test; the message gives the reason."""


class Finding(StrEnum):
    """Result of a check."""

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
    examine: Callable[[EngineTrial], None]

    def result(self, trial: EngineTrial) -> CheckResult:
        """Result of the check, made in this process."""
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
