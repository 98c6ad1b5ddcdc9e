"""Exit codes of finished work; ``reports.command_line.main`` lists them all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from analytic.errors import LinkproofError
from comparisons.trials.judging.changes import Change
from comparisons.trials.judging.records import Error, Verdict
from comparisons.trials.runs.run_engine import Failure
from comparisons.trials.stress.cells import Cell, StressVerdict
from comparisons.trials.work_precision.study import OUT_OF_TIME
from comparisons.trials.work_precision.table import Bench
from engines.contract import Outcome, Setting
from reports.api import FAILED, PASSED, SUITE_ERROR


def campaign_exit_code(
    records: Iterable[Error],
    changes: Iterable[Change] = (),
) -> int:
    """The exit code of records; naive ones count only without other settings.

    Of ``changes`` since results were recorded those that fail count. Raises LinkproofError if no record is judged.
    """
    naive, others = set[Verdict](), set[Verdict]()
    reasons: Counter[tuple[str, str]] = Counter()
    for record in records:
        verdict = Verdict(record.outcome)
        (naive if record.setting == Setting.NAIVE else others).add(verdict)
        if not verdict.judged:
            reasons[record.outcome, record.detail] += 1
    decisive = others or naive
    is_ours = Verdict.SUITE_ERROR in naive | others
    has_failed = any(entry.failed for entry in decisive) or any(entry.fails for entry in changes)
    return _code(is_ours, has_failed, any(entry.judged for entry in decisive), reasons)


def bench_exit_code(bench: Bench, engines: Iterable[str]) -> int:
    """The exit code of a benchmark: 1 if an engine finished no point without an excuse.

    Raises LinkproofError if no point of any engine could be measured.
    """
    excused = (Outcome.FINISHED, Outcome.UNAVAILABLE, Outcome.UNSUPPORTED, Verdict.NOT_PROVIDED)
    records = list(bench.table.itertuples())
    useful = {record.engine for record in records if record.outcome in excused or record.detail == OUT_OF_TIME}
    reasons = Counter((record.outcome, record.detail) for record in records)
    is_ours = any(outcome == Failure.SUITE_ERROR for outcome, _ in reasons)
    return _code(is_ours, not useful.issuperset(engines), any(record.finished for record in records), reasons)


def stress_exit_code(cells: Iterable[Cell]) -> int:
    """The exit code of cells of stability maps: 1 if the invariants missed a wrong motion.

    Raises LinkproofError if no cell is judged.
    """
    reasons = {cell.verdict: cell.reason for cell in cells}
    is_judged = not reasons.keys() <= {StressVerdict.UNSUPPORTED, StressVerdict.UNAVAILABLE}
    counts = Counter((verdict.value, reason) for verdict, reason in reasons.items())
    return _code(StressVerdict.SUITE_ERROR in reasons, StressVerdict.MISSED in reasons, is_judged, counts)


def _code(is_ours: bool, has_failed: bool, is_judged: bool, counts: Counter[tuple[str, str]]) -> int:
    """A fault of linkproof precedes a failure; raises LinkproofError if nothing is judged, with the commonest reason.

    ``counts`` are those of outcomes that are not judged, each with its reason.
    """
    if is_ours or has_failed:
        return SUITE_ERROR if is_ours else FAILED
    if not is_judged:
        raise _nothing_judged(counts)
    return PASSED


def _nothing_judged(counts: Counter[tuple[str, str]]) -> LinkproofError:
    if not counts:
        return LinkproofError("expected something to judge, got no run at all: ask for other regimes, axes or settings")
    (outcome, reason), _ = counts.most_common(1)[0]
    others = "" if len(counts) == 1 else f" (and {len(counts) - 1} other reasons)"
    return LinkproofError(f"expected a run to judge, got none: {outcome}, {reason.rstrip('.')}{others}")
