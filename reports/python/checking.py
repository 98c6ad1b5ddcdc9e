"""``linkproof.check``, ``check_engine`` and ``judge``: reviews of a linkage, an adapter and another tool's results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from analytic.errors import LinkproofError, shortened
from comparisons.trials.conformance.trial import CheckResult
from comparisons.trials.runs.plugins import engine as registered
from comparisons.trials.runs.run_engine import AdapterError
from engines.contract import Engine
from reports.api.engine_trials import engine_findings
from reports.document.terminal import Printout
from reports.python.campaign import PrintedResult
from reports.records import printout


class EngineFindings(PrintedResult, list[CheckResult]):
    """The results of every check of an adapter, in a list; printed as the command prints them."""

    def __init__(self, engine: str, checks: Sequence[CheckResult]) -> None:
        super().__init__(checks)
        self.engine = engine

    def _printout(self) -> Printout:
        return printout(self.engine, self)

    def _rows(self) -> Sequence[Mapping[str, Any]]:
        return [asdict(result) for result in self]


def check_engine(engine: Engine | str, jobs: int | None = None) -> EngineFindings:
    """The results of every check of an adapter, given by its name or as an object, in ``jobs`` worker processes.

    Each has a ``check``, a ``finding`` and a ``detail``. Raises LinkproofError if there is nothing to check, or if
    the adapter cannot be loaded.
    """
    if not isinstance(engine, str) and not hasattr(engine, "run"):
        raise LinkproofError(f"expected the name of an engine, or an adapter, got {shortened(repr(engine))}: give one")
    try:
        adapter = registered(engine) if isinstance(engine, str) else engine
        return EngineFindings(adapter.name, engine_findings(adapter, jobs))
    except AdapterError as error:
        raise LinkproofError(f"expected an adapter that can be loaded, but {error}; correct it") from error
