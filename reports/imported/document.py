"""A judgement of another tool's results as JSON: plain numbers, SI, angles in rad."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from comparisons.faults.ranking import FaultFinding
from comparisons.imported.judge import ImportedJudgement
from comparisons.imported.judging.judgement import SETTING, SignalVerdict
from comparisons.judging.records import Record


def document(judgement: ImportedJudgement, blank: Record, command: str, sentence: str) -> dict[str, Any]:
    """The JSON document of ``judge``."""
    return {
        "command": command,
        "conditions": blank.conditions,
        "verdict": sentence,
        "passed": judgement.passed,
        "limit": judgement.limit,
        "motion": judgement.motion_source,
        "records": [asdict(with_cause(verdict.record(blank), judgement)) for verdict in judgement.verdicts],
        "signals": [_signal(verdict) for verdict in judgement.verdicts],
        "causes": [_finding(finding) for finding in judgement.explanation.findings],
        "unexplained": list(judgement.explanation.unexplained),
        "corrections": {name: asdict(correction) for name, correction in judgement.proposals.items()},
        "agreed": {name: asdict(correction) for name, correction in judgement.imported.corrections.items()},
        "missed_peaks": dict(judgement.missed),
        "not_judged": [
            {"column": column.header, "place": column.place, "reason": reason}
            for column, reason in judgement.not_judged
        ],
    }


def blank_of(judgement: ImportedJudgement, files: str) -> Record:
    """The common fields of all records of a judgement; the files stand in an engine's place."""
    linkage, motion = judgement.model.linkage, judgement.model.motion
    conditions = f"crank motion from {judgement.motion_source}"
    return Record(linkage.name, linkage.variant, motion.regime, conditions, files, "", SETTING)


def with_cause(record: Record, judgement: ImportedJudgement) -> Record:
    """A record whose detail names the likeliest cause of its error, if any."""
    words = [f.likeliest.words for f in judgement.explanation.findings if record.quantity in f.signals]
    return (
        replace(record, detail="; likely cause: ".join([record.detail, *words]).removeprefix("; ")) if words else record
    )


def _signal(verdict: SignalVerdict) -> dict[str, Any]:
    return {
        "name": verdict.name,
        "column": verdict.samples.imported.column.header,
        "place": verdict.samples.imported.column.place,
        "taken": verdict.samples.imported.taken,
        "rounding": verdict.floor,
        "near_zero": verdict.near_zero,
        "worst": {
            "time": verdict.worst_time,
            "phi": verdict.worst_angle,
            "value": verdict.value_there,
            "closed_form": verdict.truth_there,
        },
    }


def _finding(finding: FaultFinding) -> dict[str, Any]:
    return {
        "signals": list(finding.signals),
        "likeliest": _cause(finding.likeliest.fault.name, finding.likeliest.words),
        "others": [_cause(other.fault.name, other.words) for other in finding.others],
        "left": finding.left,
        "within_rounding": finding.fully,
        "aligned": {name: asdict(correction) for name, correction in finding.aligned.items()},
    }


def _cause(kind: str, words: str) -> dict[str, str]:
    return {"kind": kind, "words": words}
