"""A judgement of another tool's results: printed, as JSON, as a picture."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.written import fixed
from comparisons.filejudge.fault_ranking import FaultFinding
from comparisons.filejudge.judge import NEAR_ZERO, ImportedJudgement, SignalVerdict
from comparisons.trials.judging.limits import grouped
from comparisons.trials.judging.records import IMPORTED, Error, RunRecord, Verdict
from reports.document.numbers import figure, within_turn
from reports.document.parts import RUNS, Paragraph, Table, TableCell, Words
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = ("column", "signal", "unit", "why")
HEAD = ("signal", "error over peak", "rounding", "worst at", "crank", "file", "closed form", "unit")
NOTHING = 1e-12  # a ratio that is rounding of our own
MOST_OTHERS = 4  # causes listed besides the likeliest


def share(value: float) -> str:
    """A ratio as text in per cent, to two digits: 0.0021 %, below 1e-5 % as 3.1e-6 %; whole from 10 % on: 13 %.

    A ratio below 1e-12 is 0 %.
    """
    if value < NOTHING:
        return "0 %"
    digits = max(0, 1 - math.floor(math.log10(100.0 * value)))
    return f"{100.0 * value:.{digits}f} %" if digits <= 6 else f"{100.0 * value:.1e} %"


def printout(judgement: ImportedJudgement, title: str) -> Printout:
    """The output of ``judge``: the verdict, causes, a table of signals and one of columns.

    ``title``, printed first, names linkage and files.
    """
    verdict, *others = sentences(judgement)
    over = _names_with(judgement, Verdict.OVER_LIMIT)
    style = "green" if judgement.passed else "red" if over else "yellow"
    limit = f"The limit is {share(judgement.limit)} of a signal's peak."
    parts: list[Printed] = [Paragraph(title, colour="bold"), Paragraph(verdict, colour=style), *others, ""]
    parts += [f"The crank's motion is taken from {judgement.motion_source}. {limit}"]
    linkage = judgement.model.linkage
    head = [name.replace("crank", "drive") for name in HEAD] if linkage.is_linear else HEAD
    rows = [_row(verdict, _worst_place(judgement, verdict)) for verdict in judgement.verdicts]
    parts += [Table("", head, rows, "lrrrrrrl"), *_notes(judgement)]
    parts += [
        "",
        "What the columns were read as; --map corrects it:",
        Table("", COLUMNS, [*_columns(judgement)], "llll"),
    ]
    return Printout(parts, [])


def sentence(judgement: ImportedJudgement) -> str:
    """The verdict of a judgement in one sentence, with the signals over the limit or undecided, up to five each.

    Where all are within it, the likeliest cause of a difference that remains, or else peaks between samples are named.
    """
    count, limit = len(judgement.verdicts), f"{share(judgement.limit)} of the closed form's peak"
    over, open_ = (_names_with(judgement, outcome) for outcome in (Verdict.OVER_LIMIT, Verdict.UNDEFINED))
    still_open = f"; {len(open_)} undecided: {_first_names(open_)}" if open_ else ""
    if len(open_) == count:
        return "Nothing could be judged."
    if over:
        return f"Not right: {len(over)} of {count} signals over {limit}: {_first_names(over)}{still_open}."
    if open_:
        return f"Right within the file's digits: {count - len(open_)} of {count} signals within {limit}{still_open}."
    if judgement.explanation.findings:
        cause = judgement.explanation.findings[0]
        left = max(verdict.error_max for verdict in judgement.verdicts if verdict.name in cause.signals)
        return f"Right within {share(judgement.limit)}; a {share(left)} difference remains: {cause.likeliest.words}."
    right = f"{'the signal is' if count == 1 else f'all {count} signals are'} within {limit}"
    if judgement.missed:
        peaks = _first_names([name for name, _ in judgement.missed])
        return f"Right at the file's samples: {right}, but the peak of {peaks} lies between them."
    return f"Right: {right}."


def sentences(judgement: ImportedJudgement) -> list[str]:
    """The verdict and all that explains it, a sentence each.

    After it why signals are open, the causes, noise and signals without a cause, what to accept and what was accepted.
    """
    written = judgement.imported.written
    lines = [sentence(judgement), *_undecided_sentences(judgement)]
    lines += [_cause_in_a_sentence(judgement, finding) for finding in judgement.explanation.findings]
    lines += _unexplained_sentences(judgement)
    for name, correction in judgement.proposals.items():
        lines.append(f"If this is intended, accept it with {written(name, correction)}.")
    for name, agreed in judgement.imported.corrections.items():
        lines.append(f"Accepted and applied: {written(name, agreed)}.")
    return lines


def _cause_in_a_sentence(judgement: ImportedJudgement, finding: FaultFinding) -> str:
    """The likely cause of the difference in some signals with its rivals, and a second sentence on what it leaves.

    Of more than four rivals the first four are named; corrections that had to come first are stated as --map words.
    """
    aligned = "".join(
        f"with {name} corrected first by {judgement.imported.written(name, c)} " for name, c in finding.aligned.items()
    )
    others, more = finding.others[:MOST_OTHERS], len(finding.others) - MOST_OTHERS
    also = [f"one of {more} more"] if more > 0 else []
    words = "; or ".join([finding.likeliest.words, *(other.words for other in others), *also])
    signals, remaining = _first_names(finding.signals), _remaining_error(finding)
    return f"Likely cause of the difference in {signals}: {aligned}{words}. {remaining}"


def _names_with(judgement: ImportedJudgement, outcome: Verdict) -> list[str]:
    """Names of the signals whose verdict is ``outcome``."""
    return [verdict.name for verdict in judgement.verdicts if verdict.outcome is outcome]


def _undecided_sentences(judgement: ImportedJudgement) -> list[str]:
    """Sentences why signals are open; those with the same reason share one."""
    reasons = grouped(
        (verdict.detail, verdict.name) for verdict in judgement.verdicts if verdict.outcome is Verdict.UNDEFINED
    )
    return [
        f"{_first_names(names)} {'is' if len(names) == 1 else 'are'} undecided: {why}."
        for why, names in reasons.items()
    ]


def _unexplained_sentences(judgement: ImportedJudgement) -> Iterator[str]:
    """Yield a sentence for each unexplained signal whose difference is noise, and one on all others."""
    names = judgement.explanation.unexplained
    noisy = {verdict.name: verdict for verdict in judgement.verdicts if verdict.name in names and verdict.is_noise}
    for name, verdict in noisy.items():
        yield f"The residual of {name} is noise: no trend, RMS {share(verdict.error_rms)} of the peak."
    if others := [name for name in names if name not in noisy]:
        yield (
            f"No known cause explains the difference in {_first_names(others)}: if it shrinks with the step or the "
            "softness of the engine, it is wrong by these."
        )


def _first_names(names: Sequence[str]) -> str:
    """The names with commas; of more than five the first five, and how many more."""
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")


def _worst_place(judgement: ImportedJudgement, verdict: SignalVerdict) -> str:
    """The crank's place at the largest error as text: its angle in degrees, or the travel of a linear drive.

    The angle is within 360° if the motion makes a whole turn.
    """
    angle = verdict.worst_angle
    if judgement.model.linkage.is_linear:
        return judgement.model.linkage.phi.text(angle)
    degrees = math.degrees(angle)
    makes_a_turn = np.ptp(judgement.model.motion.angle(verdict.time)) > FULL_TURN * (1.0 - NOTHING)
    return within_turn(degrees) if makes_a_turn else f"{fixed(degrees, 1)}°"


def _row(verdict: SignalVerdict, place: str) -> tuple[TableCell | Words, ...]:
    """The cells of one signal: error, rounding, time, ``place`` and both values where it is worst, unit.

    An undecided signal has that word for its error; a name has a * where the signal is near zero.
    """
    sign, unit, value = RUNS[verdict.outcome.value], verdict.unit, verdict.unit_value
    error = f"{share(verdict.error_max)} {sign.symbol}" if verdict.outcome is not Verdict.UNDEFINED else sign.word
    moment = verdict.worst_time if abs(verdict.worst_time) > NOTHING * np.ptp(verdict.time) else 0.0
    return (
        verdict.name + ("*" if verdict.near_zero else ""), TableCell(error, colour=sign.colour), share(verdict.floor),
        f"{moment:.5g} s", place, figure(verdict.value_there / value, 5), figure(verdict.truth_there / value, 5), unit,
    )  # fmt: skip


def _columns(judgement: ImportedJudgement) -> Iterator[tuple[str, str, str, str]]:
    """Yield a row for every column: header and place, signal or "not judged", unit, and the reason."""
    every = {row[1].header: row for row in reversed(judgement.imported.read)}  # a time beside every curve once
    for name, column, _, assumption in reversed(every.values()):
        yield f"'{column.header}' ({column.place})", name, column.unit, assumption
    for column, reason in judgement.imported.not_judged:
        yield f"'{column.header}' ({column.place})", "not judged", "", reason


def _notes(judgement: ImportedJudgement) -> Iterator[Printed]:
    """Yield notes below the table, on signals near zero, samples at jumps, and peaks between samples."""
    if any(verdict.near_zero for verdict in judgement.verdicts):
        yield f"* near zero: judged over {share(NEAR_ZERO)} of the typical size of its kind in this linkage"
    left_out = sum(verdict.left_out for verdict in judgement.verdicts)
    if left_out:
        yield f"At {left_out} samples the crank's acceleration jumps; there either value is accepted."
    for name, missed in judgement.missed:
        yield f"The sample rate is too low to show the peak of {name}: {share(missed)} of it lies between samples."


def _remaining_error(finding: FaultFinding) -> str:
    """The sentence on how much of the difference a cause leaves, and whether rounding hides which it is."""
    apart = " The file's rounding does not distinguish these." if finding.others else ""
    if finding.fully:
        return f"This explains the difference down to the file's rounding.{apart}"
    rest = "another cause, or the step or the softness of the engine"
    return f"This explains most of the difference; {share(finding.left)} of a peak is left: {rest}.{apart}"


# A judgement of another tool's results as JSON: plain numbers, SI, angles in rad.


def document(judgement: ImportedJudgement, run: RunRecord, command: str, sentence: str) -> dict[str, Any]:
    """The judgement as JSON-ready data, SI, angles in rad.

    ``run`` is the judgement as a run, ``command`` repeats it, ``sentence`` is its verdict.
    """
    return {
        "command": command,
        "conditions": run.conditions,
        "verdict": sentence,
        "passed": judgement.passed,
        "limit": judgement.limit,
        "motion": judgement.motion_source,
        "records": run.rows(run.errors),
        "signals": [_signal(verdict) for verdict in judgement.verdicts],
        "causes": [_finding_as_dict(finding) for finding in judgement.explanation.findings],
        "unexplained": list(judgement.explanation.unexplained),
        "corrections": {name: asdict(correction) for name, correction in judgement.proposals.items()},
        "agreed": {name: asdict(correction) for name, correction in judgement.imported.corrections.items()},
        "missed_peaks": dict(judgement.missed),
        "not_judged": [
            {"column": column.header, "place": column.place, "reason": reason}
            for column, reason in judgement.imported.not_judged
        ],
    }


def run_of_judgement(judgement: ImportedJudgement, files: str) -> RunRecord:
    """The judgement as a run whose engine is called ``files``; each error's detail ends in its likeliest cause."""
    linkage, motion = judgement.model.linkage, judgement.model.motion
    conditions = f"crank motion from {judgement.motion_source}"
    run = RunRecord(linkage.name, linkage.variant, motion.regime, conditions, files, "", IMPORTED, runs=1)
    errors = (verdict.record(run.blank) for verdict in judgement.verdicts)
    return replace(run, errors=tuple(_with_cause(error, judgement) for error in errors))


def _with_cause(error: Error, judgement: ImportedJudgement) -> Error:
    """A copy of a record whose detail ends in the likely cause; the record itself if there is none."""
    words = [f.likeliest.words for f in judgement.explanation.findings if error.quantity in f.signals]
    detail = "; likely cause: ".join([error.detail, *words]).removeprefix("; ")
    return error._replace(detail=detail) if words else error


def _signal(verdict: SignalVerdict) -> dict[str, Any]:
    """The data of one signal: column, rounding, and time, s, crank angle, rad, and values of the worst; JSON-ready."""
    return {
        "name": verdict.name,
        "column": verdict.imported.column.header,
        "place": verdict.imported.column.place,
        "taken": verdict.imported.assumption,
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
    """A finding as JSON-ready data: signals, likeliest cause and others, share of the peak left, prior corrections."""
    return {
        "signals": list(finding.signals),
        "likeliest": _cause_as_dict(finding.likeliest.fault.name, finding.likeliest.words),
        "others": [_cause_as_dict(other.fault.name, other.words) for other in finding.others],
        "left": finding.left,
        "within_rounding": finding.fully,
        "aligned": {name: asdict(correction) for name, correction in finding.aligned.items()},
    }


def _cause_as_dict(kind: str, words: str) -> dict[str, str]:
    """A cause as JSON-ready data: its ``kind`` and words."""
    return {"kind": kind, "words": words}


# A judgement as a picture.

MOST: Final = 3  # curves of one picture
HEIGHT: Final = 4.4  # inches: of the two panels of a curve


def judged_figure(judgement: ImportedJudgement, title: str) -> Figure:
    """A figure of the three worst curves side by side, each above its difference from the closed form.

    They are curves of signals over the limit or undecided, or of all if there are none; a line is at their worst place.
    Without the likeliest cause they are drawn dashed too. ``title`` names linkage and files.
    """
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    over = [verdict for verdict in judgement.verdicts if verdict.outcome is not Verdict.PASSED] or judgement.verdicts
    shown = sorted(over, key=lambda verdict: -verdict.error_max)[:MOST]
    without = [judgement.without_cause(verdict) for verdict in shown]
    causes = dict.fromkeys(f"Likely cause: {cause}." for cause, _ in without if cause)
    lines = (title, sentence(judgement), *causes)

    def place(figure: Figure) -> None:
        """Draw each curve beside the closed form, and below it the difference, into a figure with head and legend."""
        host = draw.head(figure, lines)
        grid = host.subplots(2, len(shown), sharex="col", squeeze=False)
        for verdict, (_, corrected), above, below in zip(shown, without, *grid, strict=True):
            time, truth, value = verdict.time, verdict.truth, verdict.unit_value
            above.plot(time, truth / value, color=draw.REFERENCE, linewidth=3.4, label="closed form")
            found = [("file", verdict.values, draw.PALETTE[0], "-")]
            if corrected is not None:
                found.append(("without the cause", corrected, draw.PALETTE[2], "--"))
            for name, y, colour, line in found:
                above.plot(time, y / value, line, color=colour, linewidth=1.2, label=name)
                below.plot(time, (y - truth) / value, line, color=colour, linewidth=1.2)
            for axes in (above, below):
                axes.axvline(verdict.worst_time, color=draw.LIMIT, linestyle="--", linewidth=0.9)
            heading = f"{verdict.name}, worst at {verdict.worst_time:.5g} s"
            above.set_title(draw.wrap(heading, draw.FULL_WIDTH / len(shown) - 1.0))
            draw.finish(above, "", verdict.unit)
            draw.finish(below, "time, s", f"difference, {verdict.unit}")
        host.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=3)

    return draw.drawn(draw.FULL_WIDTH, HEIGHT + draw.LINE * len(draw.head_lines(lines, draw.FULL_WIDTH)), place)
