"""The conformance test of an engine: every check, then every mutant, in the order of a report."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import groupby
from typing import TYPE_CHECKING, Final

from comparisons.conformance import channels, conduct
from comparisons.conformance.channels import finished, obstacle
from comparisons.conformance.findings import (
    Check,
    Finding,
    Found,
    NotApplicableError,
    NotTestedError,
    examined,
    in_workers,
    with_expected,
)
from comparisons.conformance.misreadings import MISREADINGS
from comparisons.conformance.mutants import (
    Misread,
    can_be_altered,
    failing_rows,
    mutant,
    rows_failed_unaltered,
    tuned_run,
)
from comparisons.conformance.mutations import MUTATIONS
from comparisons.conformance.samples import PLAIN, case
from engines.contract import Engine
from engines.registry import Unusable

if TYPE_CHECKING:
    import pytest

MUTANT: Final = "mutant: "
INSTALLED: Final = "installed"
FIRST: Final = ("identity", INSTALLED)  # without a name and one finished run no other check says anything


def _is_seen(engine: Engine, wrong: Engine, sample: str) -> None:
    """Raise AssertionError unless a wrong engine fails a row, of those that speak of it, that the right one passes."""
    passed_over = rows_failed_unaltered(engine, sample)
    seen = failing_rows(case(sample), wrong, tuned_run(wrong, sample))
    row = next((name for name in seen if name not in passed_over), None)
    assert row is not None, (
        f"sample '{sample}': expected a row over its limit, got none{_but(passed_over)}: read more values "
        "from the engine and compute fewer"
    )


def _but(rows: frozenset[str]) -> str:
    return f" beside {', '.join(sorted(rows))}, which it fails unaltered too" if rows else ""


def sees_altered_world(name: str, engine: Engine) -> None:
    """A world altered behind the adapter's back fails a row."""
    mutation = MUTATIONS[name]
    reason = obstacle(engine, mutation.sample)
    if reason is not None:
        raise NotApplicableError(reason)
    if not can_be_altered(engine):
        raise NotTestedError(f"{engine.name} builds no world from altered(scene), as a SteppedEngine does")
    finished(engine, mutation.sample)
    _is_seen(engine, mutant(engine, mutation), mutation.sample)


def sees_misreading(name: str, engine: Engine) -> None:
    """A channel misread fails a row."""
    misreading = MISREADINGS[name]
    if misreading.channel not in engine.abilities.readouts:
        raise NotApplicableError(f"{engine.name} offers no {misreading.channel.value}")
    run = finished(engine, PLAIN)
    assert run.history is not None
    if misreading.vectors and any(signal.values.ndim == 1 for signal in run.history.joint_force.values()):
        raise NotApplicableError(f"{engine.name} provides only magnitudes of joint forces")
    _is_seen(engine, Misread(engine, misreading), PLAIN)


CHECKS: Final[Mapping[str, Check]] = {
    check.name: check
    for check in (
        *conduct.CHECKS,
        *channels.CHECKS,
        *(Check(f"{MUTANT}{name}", "fails a row", partial(sees_altered_world, name)) for name in MUTATIONS),
        *(Check(f"{MUTANT}{name}", "fails a row", partial(sees_misreading, name)) for name in MISREADINGS),
    )
}


def examine(pickled: bytes, name: str) -> Found:
    """What comes of the check of this name of a pickled engine, in this process."""
    return examined(unpickled(pickled), CHECKS[name])


@lru_cache(maxsize=1)
def unpickled(engine: bytes) -> Engine:
    """The engine of a worker's job, the same for all its jobs, so that they share what is kept of its runs."""
    found: Engine = pickle.loads(engine)
    return found


def expected_failures(engine: Engine, named: Mapping[str, str] | None = None) -> dict[str, str]:
    """Checks that are expected to fail, each with its reason: the adapter's ``expected_failures`` and those named."""
    return {**getattr(engine, "expected_failures", {}), **(named or {})}


def check_engine(engine: Engine, processes: int | None = None) -> list[Found]:
    """The findings of all checks, each made in a worker process; nothing an engine does brings this one down.

    All others wait for what they rest on, ``FIRST``, and mutants for all others: each is tried once those before it
    pass, or fail as expected, so that one cause is named once.

    Of an engine that cannot be used, or whose adapter cannot be loaded, that is the only finding.
    """
    if isinstance(engine, Unusable):
        return [examined(engine, CHECKS[INSTALLED])]
    expected = expected_failures(engine)
    known = [name for name in expected if name in CHECKS]
    found: list[Found] = []
    for _, stage in groupby(CHECKS, lambda name: (name in FIRST, name.startswith(MUTANT))):
        wrong = [each.check for each in found if with_expected(each, expected).finding is Finding.FAILED]
        if wrong:
            reason = f"'{wrong[0]}' fails: correct the engine first"
            found += [Found(name, Finding.NOT_TESTED, reason) for name in stage]
        else:
            found += in_workers(examine, engine, [*stage], processes)
    stale = [
        Found(name, Finding.FAILED, f"expected a check, got '{name}' among the expected failures: correct the name")
        for name in expected
        if name not in known
    ]
    return [*stale, *(with_expected(each, expected) for each in found)]


@dataclass(frozen=True)
class EngineCheck:
    """One check of one engine, to be called by a test."""

    engine: Engine
    check: Check

    def __call__(self) -> None:
        """Make the check; raises AssertionError with a sentence, or has pytest skip what says nothing."""
        import pytest  # noqa: PLC0415 - whoever calls this has it; the wheel does not ask for it

        if self.check.alone:
            (found,) = in_workers(examine, self.engine, [self.check.name], 1)
        else:
            found = examined(self.engine, self.check)
        if found.finding in (Finding.NOT_APPLICABLE, Finding.NOT_TESTED):
            pytest.skip(f"{found.finding}: {found.detail}")
        assert found.finding is not Finding.FAILED, found.detail


def parametrize_engine_checks(
    engine: Engine, expected_failures: Mapping[str, str] | None = None
) -> Callable[[Callable[..., object]], Callable[..., object]]:
    """Hand a test function ``check``, to be called, once for every check of an engine.

    ``expected_failures`` names checks that fail, each with its reason; one that passes turns the test red.
    Raises KeyError for an unknown name.
    """
    import pytest  # noqa: PLC0415 - whoever calls this has it; the wheel does not ask for it

    expected = globals()["expected_failures"](engine, expected_failures)
    for name in expected:
        if name not in CHECKS:
            raise KeyError(f"expected a check, got '{name}' among the expected failures; one of {', '.join(CHECKS)}")

    def case_of(check: Check) -> pytest.ParameterSet:
        marks = [pytest.mark.xfail(reason=expected[check.name], strict=True)] if check.name in expected else []
        return pytest.param(EngineCheck(engine, check), id=check.name.replace(" ", "-"), marks=marks)

    return pytest.mark.parametrize("check", [case_of(check) for check in CHECKS.values()])
