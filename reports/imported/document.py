"""A judgement of another tool's results as JSON: plain numbers, SI, angles in rad."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from comparisons.datasheet.curves import extreme_samples
from comparisons.faults.ranking import FaultFinding
from comparisons.imported.judge import SETTING, ImportedJudgement, SignalVerdict
from comparisons.judging.records import Record, Verdict
from reports.charts import draw
from reports.charts.judged import MOST, JudgedCurve, judged_chart
from reports.imported.terminal import sentence, share


def document(judgement: ImportedJudgement, blank: Record, command: str, sentence: str) -> dict[str, Any]:
    """The JSON document of ``judge``."""
    return {
        "command": command,
        "conditions": blank.conditions,
        "verdict": sentence,
        "passed": judgement.passed,
        "limit": judgement.limit,
        "motion": judgement.motion_source,
        "records": [asdict(add_cause(verdict.record(blank), judgement)) for verdict in judgement.verdicts],
        "signals": [_signal(verdict) for verdict in judgement.verdicts],
        "causes": [_finding_as_dict(finding) for finding in judgement.explanation.findings],
        "unexplained": list(judgement.explanation.unexplained),
        "corrections": {name: asdict(correction) for name, correction in judgement.proposals.items()},
        "agreed": {name: asdict(correction) for name, correction in judgement.imported.corrections.items()},
        "missed_peaks": dict(judgement.missed),
        "not_judged": [
            {"column": column.header, "place": column.place, "reason": reason}
            for column, reason in judgement.not_judged
        ],
    }


def blank_record_of(judgement: ImportedJudgement, files: str) -> Record:
    """The common fields of all records of a judgement; the files stand in an engine's place."""
    linkage, motion = judgement.model.linkage, judgement.model.motion
    conditions = f"crank motion from {judgement.motion_source}"
    return Record(linkage.name, linkage.variant, motion.regime, conditions, files, "", SETTING)


def add_cause(record: Record, judgement: ImportedJudgement) -> Record:
    """A record whose detail names the likeliest cause of its error, if any."""
    words = [f.likeliest.words for f in judgement.explanation.findings if record.quantity in f.signals]
    return (
        replace(record, detail="; likely cause: ".join([record.detail, *words]).removeprefix("; ")) if words else record
    )


def _signal(verdict: SignalVerdict) -> dict[str, Any]:
    """The JSON of one signal: its column, and where its error is largest, s and rad."""
    return {
        "name": verdict.name,
        "column": verdict.samples.imported.column.header,
        "place": verdict.samples.imported.column.place,
        "taken": verdict.samples.imported.assumption,
        "rounding": verdict.floor,
        "near_zero": verdict.near_zero,
        "worst": {
            "time": verdict.worst_time,
            "phi": verdict.worst_angle,
            "value": verdict.value_there,
            "closed_form": verdict.truth_there,
        },
    }


def _finding_as_dict(finding: FaultFinding) -> dict[str, Any]:
    return {
        "signals": list(finding.signals),
        "likeliest": _cause_as_dict(finding.likeliest.fault.name, finding.likeliest.words),
        "others": [_cause_as_dict(other.fault.name, other.words) for other in finding.others],
        "left": finding.left,
        "within_rounding": finding.fully,
        "aligned": {name: asdict(correction) for name, correction in finding.aligned.items()},
    }


def _cause_as_dict(kind: str, words: str) -> dict[str, str]:
    return {"kind": kind, "words": words}


# A judgement as curves to draw: those over the limit, the worst first, or all where none is.

STRETCHES: Final = 300  # of a curve, of which the extremes are drawn
MOST_ON_PAGE: Final = 6


def judged_curves(judgement: ImportedJudgement, most: int = MOST_ON_PAGE) -> list[JudgedCurve]:
    """Curves of the signals over the limit, the worst first, at most ``most``; of all signals if none is over it."""
    over = [verdict for verdict in judgement.verdicts if verdict.outcome is not Verdict.PASSED] or judgement.verdicts
    return [_curve(judgement, verdict) for verdict in sorted(over, key=lambda verdict: -verdict.error_max)[:most]]


def _curve(judgement: ImportedJudgement, verdict: SignalVerdict) -> JudgedCurve:
    """One signal's curves in the file's unit, thinned to their extremes and the worst sample."""
    unit, value = verdict.shown
    cause, without = judgement.without_cause(verdict)
    curves = {"file": verdict.samples.values, "truth": verdict.truth, "without": without}
    differences = [curve - verdict.truth for curve in curves.values() if curve is not None]
    shown = (verdict.truth, *(np.nan_to_num(difference) for difference in differences))
    few = np.unique(np.concatenate([*(extreme_samples(values, STRETCHES) for values in shown), [verdict.worst]]))
    drawn: dict[str, Any] = {
        key: None if y is None else [None if np.isnan(v) else v for v in (y[few] / value).tolist()]
        for key, y in curves.items()
    }
    time, error = verdict.samples.time[few].tolist(), f"{share(verdict.error_max)} of the peak at most"
    return JudgedCurve(verdict.name, unit, time, worst=verdict.worst_time, error=error, cause=cause, **drawn)


def judged_figure(judgement: ImportedJudgement, title: str) -> Figure:
    """The worst curves; ``title`` names linkage and files."""
    curves = judged_curves(judgement, MOST)
    causes = dict.fromkeys(f"Likely cause: {curve.cause}." for curve in curves if curve.cause)
    return draw.figure(judged_chart(curves, (title, sentence(judgement), *causes)))
