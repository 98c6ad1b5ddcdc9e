"""The conformance test of an engine: every check, then every mutant, in the order of a report."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final

from comparisons.trials.conformance import conduct, mutants
from comparisons.trials.conformance.mutants import MUTANT
from comparisons.trials.conformance.trial import CheckResult, EngineCheck, EngineTrial, Finding
from comparisons.trials.runs.run_engine import Failure, Lost, RunBounds
from comparisons.trials.runs.workers import LocalPool
from engines.contract import Engine
from engines.registry import Unusable

if TYPE_CHECKING:
    import pytest

INSTALLED: Final = "installed"
FIRST: Final = ("identity", INSTALLED)  # without a name and one finished run no other check has a meaning
DANGEROUS: Final = "bad data"  # may bring a process down
BOUNDS = RunBounds(seconds=120.0)
CHECKS: Final[Mapping[str, EngineCheck]] = {
    check.name: check for check in (*conduct.CHECKS, *conduct.CHANNEL_CHECKS, *mutants.CHECKS)
}


def examine(pickled: bytes, name: str) -> CheckResult:
    """The result of the check of this name, made with a pickled engine in this process, which keeps its runs."""
    return CHECKS[name].result(_unpickle_trial(pickled))


@lru_cache(maxsize=1)
def _unpickle_trial(engine: bytes) -> EngineTrial:
    """The trial of a worker's engine, the same object for all jobs, so that they share its runs."""
    return EngineTrial(pickle.loads(engine))


def run_in_workers(engine: Engine, names: list[str], processes: int | None = None) -> list[CheckResult]:
    """The results of checks by name, in their order, made in worker processes; a check that brings one down has failed.

    ``processes`` is their number, as many as cores by default.
    """
    try:
        pickled = pickle.dumps(engine)
    except Exception:
        reason = "the engine cannot be sent to another process: let its class stand in a module of its own"
        return [CheckResult(name, Finding.NOT_TESTED, reason) for name in names]
    jobs: list[tuple[Any, ...]] = [(pickled, name) for name in names]
    results = dict(LocalPool(processes).run(examine, jobs, bounds=BOUNDS))
    return [_check_result(name, results[number]) for number, name in enumerate(names)]


def _check_result(name: str, result: CheckResult | Lost) -> CheckResult:
    """The result of a check made in a worker: a failure if the worker was lost."""
    if not isinstance(result, Lost):
        return result
    gives_up = "end every run with an outcome and a reason"
    what, cure = {
        Failure.TIMED_OUT: ("it ", f": take fewer or cheaper steps, and {gives_up}"),
        Failure.CRASHED: ("its process ", f": {gives_up}"),
    }.get(result.outcome, ("", ""))
    return CheckResult(name, Finding.FAILED, f"{what}{result.reason}{cure}")


def expected_failures(engine: Engine, named: Mapping[str, str] | None = None) -> dict[str, str]:
    """Checks that are expected to fail, by name with the reason: the adapter's and those ``named``."""
    return {**getattr(engine, "expected_failures", {}), **(named or {})}


def with_expected(result: CheckResult, expected: Mapping[str, str]) -> CheckResult:
    """The result, as an expected failure if its check is in ``expected``; one there that passes becomes a failure."""
    reason = expected.get(result.check)
    if reason is None:
        return result
    if result.finding is Finding.FAILED:
        return replace(result, finding=Finding.EXPECTED, detail=f"{reason} ({result.detail})")
    if result.finding is Finding.PASSED:
        detail = f"it passes, though it is expected to fail ({reason}): take it from the expected failures"
        return replace(result, finding=Finding.FAILED, detail=detail)
    return result


def check_engine(engine: Engine, processes: int | None = None) -> list[CheckResult]:
    """The results of all checks, each made in a worker process; nothing an engine does brings this one down.

    All others wait for what they rest on, ``FIRST``, and mutants for all others: each is tried once those before it
    pass, or fail as expected, so that one cause is named once. Of an engine that cannot be used, or whose adapter
    cannot be loaded, that is the only result. ``processes`` is the number of workers.
    """
    if isinstance(engine, Unusable):
        return [CHECKS[INSTALLED].result(EngineTrial(engine))]
    expected = expected_failures(engine)
    results = [
        CheckResult(name, Finding.FAILED, f"expected a check, got '{name}' among the expected failures: correct it")
        for name in expected
        if name not in CHECKS
    ]
    wrong = ""
    for _, stage in groupby(CHECKS, lambda name: (name in FIRST, name.startswith(MUTANT))):
        if wrong:
            reason = f"'{wrong}' fails: correct the engine first"
            results += [CheckResult(name, Finding.NOT_TESTED, reason) for name in stage]
            continue
        done = [with_expected(result, expected) for result in run_in_workers(engine, [*stage], processes)]
        wrong = next((result.check for result in done if result.finding is Finding.FAILED), "")
        results += done
    return results


def _make(trial: EngineTrial, check: EngineCheck) -> None:
    """Make a check; raise AssertionError if it fails, and skip the test in pytest if it cannot be made."""
    import pytest  # noqa: PLC0415 - whoever calls this has it; the wheel does not ask for it

    dangerous = check.name == DANGEROUS
    result = run_in_workers(trial.engine, [check.name], 1)[0] if dangerous else check.result(trial)
    if result.finding is Finding.NOT_TESTED:
        pytest.skip(result.detail)
    assert result.finding is not Finding.FAILED, result.detail


def parametrize_engine_checks(
    engine: Engine, expected_failures: Mapping[str, str] | None = None
) -> Callable[[Callable[..., object]], Callable[..., object]]:
    """A decorator: its test function gets ``check``, to be called, once for every check of an engine.

    ``expected_failures`` names checks that fail, each with its reason; one that passes turns the test red. Raises
    KeyError for an unknown name.
    """
    import pytest  # noqa: PLC0415 - whoever calls this has it; the wheel does not ask for it

    expected, trial = globals()["expected_failures"](engine, expected_failures), EngineTrial(engine)
    for name in expected:
        if name not in CHECKS:
            raise KeyError(f"expected a check, got '{name}' among the expected failures; one of {', '.join(CHECKS)}")

    def case_of(check: EngineCheck) -> pytest.ParameterSet:
        """A check as pytest's parameter, marked if it is expected to fail."""
        marks = [pytest.mark.xfail(reason=expected[check.name], strict=True)] if check.name in expected else []
        return pytest.param(partial(_make, trial, check), id=check.name.replace(" ", "-"), marks=marks)

    return pytest.mark.parametrize("check", [case_of(check) for check in CHECKS.values()])
