"""``check-engine``: every check of an engine's adapter."""

from __future__ import annotations

from analytic.errors import LinkproofError
from comparisons.conformance.conformance import INSTALLED, check_engine
from comparisons.conformance.results import CheckResult, Finding
from comparisons.runs.failures import blamed_on
from engines.contract import Engine
from engines.registry import Unusable


def engine_findings(adapter: Engine, processes: int | None = None) -> list[CheckResult]:
    """The results of every check of an engine.

    Raises LinkproofError if nothing can be checked, AdapterError for an engine that cannot be loaded.
    """
    if isinstance(adapter, Unusable):
        if adapter.error is None:
            raise LinkproofError(adapter.reason)
        with blamed_on(adapter):
            raise adapter.error
    results = check_engine(adapter, processes)
    absent = next(
        (each.detail for each in results if each.check == INSTALLED and each.finding is Finding.NOT_TESTED), None
    )
    if absent is not None:
        raise LinkproofError(f"expected an engine to check, got none: {absent}")
    return results
