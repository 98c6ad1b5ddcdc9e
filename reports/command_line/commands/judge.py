"""``linkproof judge``: compare another tool's results with the closed form, and name the probable causes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from analytic.description.crank_motion import CrankMotion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.filejudge.judge import ImportedJudgement
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.campaign.results import document as saved_document
from comparisons.trials.campaign.results import save
from comparisons.trials.judging.records import Verdict
from comparisons.trials.runs.store import to_json
from reports.command_line.destination import Destination, Writers, picture_writers
from reports.imported import (
    document,
    judged_curves,
    judged_figure,
    printout,
    run_of_judgement,
    sentence,
    sentences,
)
from reports.requests import FAILED, PASSED
from reports.requests.judge import check_judgement, judge_files
from reports.requests.options import JudgeOptions, command_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = "index.html"


def judge(options: JudgeOptions, destination: Destination) -> int:
    """Judge result files, print and write the verdicts; returns the exit code."""
    destination.check(PAGE)
    read = {"the linkage's file": Path(options.mechanism), **{f"'{result}'": result for result in options.results}}
    destination.check_saves(WRITERS, read)
    check_judgement(options)
    linkage = load(options.mechanism, options.variant)
    destination.warn([linkage])
    judgement = judge_files(options, linkage)
    command = command_line("judge", options)
    if destination.out is not None:
        _write_page(options, judgement, command, destination.out)
    files = ", ".join(str(path) for path in options.results)
    title = f"{linkage.name} ({linkage.variant}) against {files}"
    facts = document(judgement, run_of_judgement(judgement, files), command, sentence(judgement))
    destination.write_saves(WRITERS, judgement, title, facts)
    destination.write_json(facts)
    if destination.quiet:
        destination.print(sentence(judgement))
    destination.print_out(printout(judgement, title))
    destination.write_pages(processes=0)
    if all(verdict.outcome is Verdict.UNDEFINED for verdict in judgement.verdicts):
        raise LinkproofError(f"expected a signal to judge, got none: {judgement.verdicts[0].detail}")
    return PASSED if judgement.passed else FAILED


def _figure(judgement: ImportedJudgement, title: str, _facts: object) -> Figure:
    return judged_figure(judgement, title)


def _json(_judgement: object, _title: str, facts: Mapping[str, Any]) -> str:
    return to_json(facts)


WRITERS: Final[Writers] = {".json": _json, **picture_writers(_figure)}


def _write_page(options: JudgeOptions, judgement: ImportedJudgement, command: str, folder: Path) -> None:
    """The records, curves and page of a campaign, with the files in an engine's place."""
    linkage, motion = judgement.model.linkage, judgement.model.motion
    findings = enumerate(judgement.explanation.findings, start=1)
    run = replace(
        run_of_judgement(judgement, ", ".join(path.name for path in options.results)),
        steps=max(len(verdict.truth) for verdict in judgement.verdicts),
        details={f"cause {number}": finding.likeliest.words for number, finding in findings},
        curves={verdict.name: verdict.deviation(motion).curve for verdict in judgement.verdicts},
    )
    motions = (motion,) if isinstance(motion, CrankMotion) else ()
    request = CampaignRequest((linkage,), motions, run.conditions, (run.engine,))

    lines = [*sentences(judgement), f"The crank's motion is taken from {judgement.motion_source}."]
    lines += [f"Not judged: column '{column.header}', for {reason}." for column, reason in judgement.not_judged]
    curves = [asdict(curve) for curve in judged_curves(judgement)]
    table = {**saved_document(request, command), "judgement": lines, "judged_curves": curves}
    save(folder, table, [run])
