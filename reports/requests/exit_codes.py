"""Exit codes of finished work; ``reports.command_line.main`` lists them all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from analytic.errors import LinkproofError
from comparisons.campaign.errata import ErratumRecord
from comparisons.campaign.key_figures import KeyFigure
from comparisons.judging.records import Record, Verdict
from comparisons.runs.failures import Failure
from comparisons.stress.cell_result import CellResult, StressVerdict
from comparisons.work_precision.points import OUT_OF_TIME
from comparisons.work_precision.records import BenchRecord
from engines.contract import Outcome, Setting
from reports.requests import FAILED, PASSED, SUITE_ERROR


def campaign_exit_code(
    records: Iterable[Record],
    errata: Iterable[ErratumRecord] = (),
    figures: Iterable[KeyFigure] = (),
    departures: Sequence[str] = (),
) -> int:
    """Of judged records; naive ones count only where nothing else ran, errata only where they are a fault of ours.

    A key figure that is not as recorded fails, and so do ``departures`` from a baseline. Raises LinkproofError where no
    record says anything of an engine.
    """
    naive, others = set[Verdict](), set[Verdict]()
    reasons: Counter[tuple[str, str]] = Counter()
    for record in records:
        verdict = Verdict(record.outcome)
        (naive if record.setting == Setting.NAIVE else others).add(verdict)
        if not verdict.judged:
            reasons[record.outcome, record.detail] += 1
    decisive = others or naive
    if Verdict.SUITE_ERROR in naive | others or any(one.outcome == Failure.SUITE_ERROR for one in errata):
        return SUITE_ERROR
    if any(verdict.failed for verdict in decisive) or any(figure.changed for figure in figures) or departures:
        return FAILED
    if not any(verdict.judged for verdict in decisive):
        raise _nothing_judged(reasons)
    return PASSED


def bench_exit_code(records: Sequence[BenchRecord], engines: Iterable[str]) -> int:
    """Of a benchmark's records: 1 where an engine finished no point and nothing excuses it.

    Raises LinkproofError where no point of any engine could be measured.
    """
    if any(record.outcome == Failure.SUITE_ERROR for record in records):
        return SUITE_ERROR
    excused = (Outcome.FINISHED, Outcome.UNAVAILABLE, Outcome.UNSUPPORTED, Verdict.NOT_PROVIDED)
    useful = {record.engine for record in records if record.outcome in excused or record.detail == OUT_OF_TIME}
    if not useful.issuperset(engines):
        return FAILED
    if not any(record.finished for record in records):
        raise _nothing_judged(Counter((record.outcome, record.detail) for record in records))
    return PASSED


def stress_exit_code(cells: Iterable[CellResult]) -> int:
    """Of the cells of stability maps: 1 where our invariants missed a wrong motion.

    Raises LinkproofError where not one cell says anything of an engine.
    """
    reasons = {cell.verdict: cell.reason for cell in cells}
    if StressVerdict.SUITE_ERROR in reasons:
        return SUITE_ERROR
    if reasons.keys() <= {StressVerdict.UNSUPPORTED, StressVerdict.UNAVAILABLE}:
        raise _nothing_judged(Counter((verdict.value, reason) for verdict, reason in reasons.items()))
    return FAILED if StressVerdict.MISSED in reasons else PASSED


def _nothing_judged(counts: Counter[tuple[str, str]]) -> LinkproofError:
    """What to raise where no run can be judged; ``counts`` are of their outcomes, each with its reason."""
    if not counts:
        return LinkproofError("expected something to judge, got no run at all: ask for other regimes, axes or settings")
    (outcome, reason), _ = counts.most_common(1)[0]
    others = "" if len(counts) == 1 else f" (and {len(counts) - 1} other reasons)"
    return LinkproofError(f"expected a run to judge, got none: {outcome}, {reason.rstrip('.')}{others}")
