"""``linkproof.check``, ``check_engine`` and ``judge``: reviews of a linkage, an adapter and another tool's results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, shortened
from comparisons.designer.linkage_check import check as linkage_facts
from comparisons.filejudge.judge import ImportedJudgement
from comparisons.trials.conformance.trial import CheckResult
from comparisons.trials.judging.records import Run, Verdict
from comparisons.trials.runs.plugins import engine as registered
from comparisons.trials.runs.run_engine import AdapterError
from engines.contract import Engine
from reports.document.terminal import Printed, Printout, rendered
from reports.imported import printout as judgement_printout
from reports.imported import run_of_judgement, sentence
from reports.python.campaign import PrintedResult, failed_rows
from reports.python.keywords import load_linkage, resolve_linkage, with_keywords
from reports.records import printout
from reports.requests.engine_trials import engine_findings
from reports.requests.judge import check_judgement, judge_files
from reports.requests.options import JudgeOptions


def check(linkage: Linkage | str | Path, variant: str | None = None) -> dict[str, Any]:
    """The facts of ``linkproof check --json``: mobility, groups, range of the crank, transmission, likely mistakes.

    SI, angles in rad. ``fault`` is the sentence of the first error, or None. Raises
    LinkproofError for a file that cannot be read.
    """
    return linkage_facts(load_linkage(linkage, variant))[0]


class EngineFindings(PrintedResult, list[CheckResult]):
    """The results of every check of an adapter, in a list; printed as the command prints them."""

    def __init__(self, engine: str, checks: Sequence[CheckResult]) -> None:
        super().__init__(checks)
        self.engine = engine

    def _printout(self) -> Printout:
        return printout(self.engine, self)

    def _rows(self) -> Sequence[Mapping[str, Any]]:
        return [asdict(result) for result in self]


@dataclass(frozen=True, repr=False, kw_only=True)
class JudgedResults(PrintedResult, ImportedJudgement):
    """A judgement of other results, printed as the command prints it; ``files`` are the judged files."""

    files: str

    def _printout(self) -> Printout:
        linkage = self.model.linkage
        return judgement_printout(self, f"{linkage.name} ({linkage.variant}) against {self.files}")

    @property
    def _run(self) -> Run:
        """The judgement as a run: an error of every verdict, with its likeliest cause."""
        return run_of_judgement(self, self.files)

    def _rows(self) -> Sequence[Mapping[str, Any]]:
        return self._run.rows(self._run.errors)

    def _sentence(self) -> Printed:
        return sentence(self)

    def check(self) -> JudgedResults:
        """The judgement itself if it has passed; raises AssertionError with a line for every other signal."""
        __tracebackhide__ = True  # pytest shows the line of the test
        if self.passed:
            return self
        rows = failed_rows(record for record in self._run.errors if record.outcome != Verdict.PASSED)
        raise AssertionError("\n".join((rendered(self._sentence()).strip(), *rows)))


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


@with_keywords()
def judge(linkage: Linkage | str | Path, *results: str | Path, options: JudgeOptions) -> JudgedResults:
    """Judge the result files of another tool by the closed form, as ``linkproof judge`` does; ``limit`` is of the peak.

    The judgement has ``passed``, and ``verdicts`` of every signal; ``str`` is what the command prints. Raises
    LinkproofError for unreadable files and for columns that only the user can tell, by ``map``.
    """
    paths = tuple(map(Path, results))
    check_judgement(options)
    chosen, options = resolve_linkage(linkage, replace(options, results=paths))
    judgement = judge_files(options, chosen)
    return JudgedResults(**vars(judgement), files=", ".join(map(str, paths)))
