"""What ``linkproof judge`` does: read another tool's results, compare them with the closed form, say what is wrong."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from analytic.description.changes import without
from analytic.description.crank_motion import RPM, CrankMotion, crank_motion
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import CampaignRequest
from comparisons.campaign.results import document as saved_document
from comparisons.campaign.results import save
from comparisons.datasheet.building import usual_sheet
from comparisons.imported.columns import ImportedResults, MappingNeededError
from comparisons.imported.judge import ImportedJudgement
from comparisons.imported.judge import judge as judge_results
from comparisons.imported.mapping.writing import with_proposals
from comparisons.imported.reading import read_results
from comparisons.judging.records import Verdict
from comparisons.judging.run_result import RunResult
from comparisons.reference.case import own_case
from comparisons.reference.motion import Motion
from comparisons.runs.files import check_writable, write_text
from reports.command_line import FAILED, PASSED
from reports.command_line.destination import Destination
from reports.command_line.linear_drive import prescribed
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.motions import own_regimes
from reports.command_line.requests import command_line
from reports.imported.document import blank_of, document, with_cause
from reports.imported.terminal import printout, sentence, sentences

PAGE = "index.html"


@dataclass(frozen=True)
class JudgeChoice:
    """What to judge, in the user's words; ``limit`` is a share of the peak."""

    mechanism: str
    results: tuple[Path, ...]
    motion: MotionChoice
    limit: float
    mapping: Path | None = None
    write_mapping: Path | None = None

    def check(self) -> None:
        """Raise LinkproofError for what cannot be, before anything is read."""
        self.motion.check()
        if not 0.0 < self.limit < math.inf:
            raise LinkproofError(f"--limit: expected a positive share of the peak, such as 0.01, got {self.limit:g}")

    def model(self, linkage: Linkage) -> Linkage:
        """A linkage under the requested gravity."""
        return linkage if self.motion.gravity else without(linkage, "gravity")

    @property
    def command(self) -> str:
        """The command that asks for the same."""
        options = {
            **self.motion.words,
            "mapping": [str(self.mapping)] if self.mapping else [],
            "limit": [f"{self.limit:g}"],
        }
        return command_line("judge", (self.mechanism, *map(str, self.results)), options, self.motion.flags)


def judge(choice: JudgeChoice, destination: Destination) -> int:
    """Judge result files, print and write what came of it; returns the exit code."""
    destination.check(PAGE)
    choice.check()
    if choice.write_mapping is not None:
        _check_is_new(choice.write_mapping, choice.mapping)
    linkage = choice.model(load(choice.mechanism, choice.motion.variant))
    judgement = judgement_of(choice, linkage, _read(choice, linkage, destination))
    imported = judgement.imported
    if choice.write_mapping is not None:
        write_text(choice.write_mapping, with_proposals(imported.mapping_text, judgement.proposals, imported.units))
        destination.say(f"mapping: {choice.write_mapping}")
    if destination.folder is not None:
        _write_page(choice, judgement, destination.folder, destination)
    files = ", ".join(str(path) for path in choice.results)
    destination.write_json(document(judgement, blank_of(judgement, files), choice.command, sentence(judgement)))
    if destination.quiet:
        destination.print(sentence(judgement))
    destination.print_out(printout(judgement, f"{linkage.name} ({linkage.variant}) against {files}"))
    if all(verdict.outcome is Verdict.UNDEFINED for verdict in judgement.verdicts):
        raise LinkproofError(f"expected a signal to judge, got none: {judgement.verdicts[0].detail}")
    return PASSED if judgement.passed else FAILED


def judgement_of(choice: JudgeChoice, linkage: Linkage, imported: ImportedResults) -> ImportedJudgement:
    """The judgement of a tool's results against the closed form of a linkage under the requested motion."""
    return judge_results(
        linkage,
        imported,
        _motion(choice, linkage, imported),
        limit=choice.limit,
        start_angle=math.radians(choice.motion.start_angle),
        gives_speed=choice.motion.speed is not None,
    )


def _check_is_new(path: Path, mapping: Path | None) -> None:
    """Raise LinkproofError where a mapping, in which a user may have agreed to something, would be overwritten."""
    check_writable(path)
    if path.exists() and (mapping is None or path.resolve() != mapping.resolve()):
        raise LinkproofError(f"--write-mapping: '{path}' exists already: use it with --mapping, or give another name")


def _read(choice: JudgeChoice, linkage: Linkage, destination: Destination) -> ImportedResults:
    """The results; where the user has to tell what a column is, the mapping to fill in is written."""
    try:
        return read_results(choice.results, linkage, choice.mapping)
    except MappingNeededError as error:
        if choice.write_mapping is None:
            raise LinkproofError(f"{error}; --write-mapping FILE writes one to fill in") from error
        write_text(choice.write_mapping, error.mapping_text)
        destination.say(f"mapping to fill in: {choice.write_mapping}")
        raise


def _motion(choice: JudgeChoice, linkage: Linkage, imported: ImportedResults) -> Motion | None:
    """The requested regime; over the crank angle a constant speed; else None: the file's columns give the motion."""
    asked = choice.motion
    if len(asked.regimes) > 1:
        raise LinkproofError(f"--regime: expected one motion of the crank, got {', '.join(asked.regimes)}; name one")
    own = own_regimes(asked, [linkage])
    if own:
        regime = next(regime for regime in linkage.regimes if regime.name == own[0])
        return own_case(Mechanism(linkage), regime).motion
    if asked.regimes or asked.swings:
        ((motion, *_), _) = prescribed(asked, [linkage])
        return motion
    if imported.signals and all(one.axis == "phi" for one in imported.signals):
        return crank_motion("constant-speed", speed=abs(asked.rpm) * RPM, clockwise=asked.turns_back)
    return None


def _write_page(choice: JudgeChoice, judgement: ImportedJudgement, folder: Path, destination: Destination) -> None:
    """The records, curves and page of a campaign, with the files in an engine's place."""
    linkage, motion = judgement.model.linkage, judgement.model.motion
    blank = blank_of(judgement, ", ".join(path.name for path in choice.results))
    blank = replace(blank, steps=max(len(verdict.truth) for verdict in judgement.verdicts))
    result = RunResult(
        tuple(with_cause(verdict.record(blank), judgement) for verdict in judgement.verdicts),
        tuple(check.record(blank) for check in judgement.checks),
        {verdict.name: verdict.deviation(motion) for verdict in judgement.verdicts},
        {f"cause {n}": finding.likeliest.words for n, finding in enumerate(judgement.explanation.findings, start=1)},
    )
    motions = (motion,) if isinstance(motion, CrankMotion) else ()
    request = CampaignRequest((linkage,), motions, blank.conditions, (blank.engine,))
    told = {**saved_document(request, [result], choice.command), "judgement": sentences(judgement)}
    save(folder, [result], told, [usual_sheet(linkage, motions, choice.motion.regimes)])
    destination.write_pages(processes=0)
