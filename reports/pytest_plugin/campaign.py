"""The campaign of a linkage file under the options of its project, run by run."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest

from comparisons.campaign.campaign import CampaignRequest, judged, lost, tasks
from comparisons.campaign.key_figures import KeyFigure, compared
from comparisons.campaign.project import Project, compared_cases, notes, standard
from comparisons.invariants.checks import NEEDED_CHANNELS as INVARIANTS
from comparisons.judging.baseline import Departure, file_departures, motion_departures
from comparisons.judging.limits import Standard, deciding
from comparisons.judging.records import Record, RunRecord, Verdict, blank_record
from comparisons.reference.case import Case, unpickle_case
from comparisons.runs.plugins import engine
from comparisons.runs.study import Study, Task
from comparisons.runs.workers import Bounds, LocalPool
from engines.contract import Setting
from engines.registry import engine_names, why_unavailable
from reports.python.campaign import Comparison, compare
from reports.python.keywords import words
from reports.requests.campaign import files, request, run_resources
from reports.requests.campaign_options import CompareOptions, RunLimits, StandardOptions
from reports.requests.options import command_line
from reports.requests.standard import chosen_standard, complete_request, coverage_of


@dataclass(frozen=True)
class FileCampaign:
    """The runs of a linkage file and the standard that judges them; ``options`` are for the commands in messages."""

    options: CompareOptions
    request: CampaignRequest
    standard: Standard
    bounds: Bounds

    @property
    def runs(self) -> tuple[CampaignRun, ...]:
        """Every run; none if the linkage has none of the requested regimes."""
        return tuple(CampaignRun(self, task) for task in tasks(self.request)) if self._has_motions else ()

    def figures(self) -> list[KeyFigure]:
        """Every key figure with its recorded value, if there is a baseline."""
        return compared(self._cases, self.standard.baseline) if self._has_motions else []

    def departures(self) -> tuple[Departure, ...]:
        """Motions of the file that are new or missing in the baseline."""
        seen = (blank_record(case, "") for case in self._cases) if self._has_motions else ()
        return motion_departures(self.request.linkages, seen, self.standard.baseline)

    @cached_property
    def _cases(self) -> list[Case]:
        return list(compared_cases(self.request, self.standard.baseline))

    @property
    def _has_motions(self) -> bool:
        (linkage,) = self.request.linkages
        regimes = {regime.name for regime in linkage.regimes}
        return bool(self.request.motions or regimes & {*self.request.own_regimes})

    def decides(self, setting: str) -> bool:
        """Whether a failure in a setting counts: in naive only without other settings."""
        return setting != Setting.NAIVE or {*self.request.settings, *self.request.own_settings} == {Setting.NAIVE}

    @property
    def notes(self) -> tuple[str, ...]:
        """Further remarks on the file, in sentences."""
        baseline = self.standard.baseline
        return notes(baseline) if baseline.is_recorded else ()


@dataclass(frozen=True)
class CampaignRun:
    """One run of a campaign."""

    campaign: FileCampaign
    task: Task

    @property
    def case(self) -> Case:
        """The case that is run."""
        return unpickle_case(self.task.job[0])

    @property
    def engine(self) -> str:
        """The engine's name."""
        return str(self.task.job[1])

    @property
    def setting(self) -> str:
        """The setting's name."""
        return str(self.task.job[2])

    @property
    def quantities(self) -> tuple[str, ...]:
        """Its judged quantities and invariants."""
        *_, names, with_invariants = self.task.job
        return (*names, *(INVARIANTS if with_invariants else ()))

    def records(self) -> tuple[Record, ...]:
        """Make the run in a worker process, within its bounds, and judge it; no invariants where it failed."""
        study = Study(judged, lost, RunRecord.written, RunRecord.from_row, pool=LocalPool(1))
        (run,) = study.in_order([self.task], self.campaign.bounds)
        return run.judged(self.campaign.standard.judge).every


def project_departures(project: Project) -> tuple[Departure, ...] | None:
    """Linkage files that are new or missing in a project's baseline; None without a recorded baseline."""
    chosen = CompareOptions(mechanisms=tuple(map(str, project.linkages)))
    coverage = coverage_of(CompareOptions(), StandardOptions(), project)
    baseline = standard(files(chosen), project, coverage=coverage).baseline
    return file_departures(baseline) if baseline.is_recorded else None


def file_campaign(path: Path, folder: Path) -> FileCampaign:
    """The campaign of a linkage file under the options of its project, with paths relative to ``folder``.

    Engines need not be installed. Raises LinkproofError for bad input.
    """
    words, usual = CompareOptions(mechanisms=(str(path),)), StandardOptions()
    completed = complete_request(words, RunLimits(), usual)
    names = tuple(dict.fromkeys(completed.options.engine)) or engine_names()
    for name in names:
        engine(name)
    requested = request(completed.options, completed.known, names)
    options = replace(words, mechanisms=(_relative_path(path, folder),))
    bounds = run_resources(completed.limits).bounds
    return FileCampaign(options, requested, chosen_standard(completed, usual), bounds)


def _relative_path(path: Path, folder: Path) -> str:
    try:
        return os.path.relpath(path, folder)
    except ValueError:  # another drive
        return str(path)


def failure_text(record: Record, options: CompareOptions, notes: Iterable[str] = ()) -> str:
    """Why a requested record failed; ``notes`` are further remarks on the file."""
    again = replace(
        options,
        engine=(record.engine,),
        setting=(record.setting,),
        regime=(record.regime,),
        quantity=() if record.quantity in INVARIANTS else (record.quantity,),
    )
    run = (record.regime, f"{record.engine} {record.engine_version}".rstrip(), record.setting)
    place = f"{record.mechanism} ({record.variant}), {', '.join(run)}: {record.quantity}"
    return "\n".join(
        (place, record.detail, *_error_size(record), *notes, f"repeat it: {command_line('compare', again)}")
    )


def _error_size(record: Record) -> tuple[str, ...]:
    if record.error_max is None or record.peak is None:
        return ()
    at = "" if record.worst_time is None else f", worst at {record.worst_time:.4g} s"
    return (f"error {record.error_max:.3e} of the peak, {record.peak:.6g} {record.unit}".rstrip() + at,)


def changed(figure: KeyFigure, options: CompareOptions, notes: Iterable[str] = ()) -> str:
    """The change of a key figure, and the command that records its present value."""
    again = replace(options, regime=(figure.regime,))
    return "\n".join(
        (
            figure.sentence,
            *notes,
            f"repeat it: {command_line('compare', again)}",
            f"if it is meant: {recording_command(again)}",
        )
    )


def recording_command(options: CompareOptions) -> str:
    """The command that records the requested baseline."""
    return f"{command_line('compare', options)} --record-baseline"


# The comparison of the fixture: as ``linkproof.compare``; the test fails if the comparison does not pass.


@dataclass
class Assertion:
    """Comparisons of a session, each made once."""

    made: dict[str, Comparison] = field(default_factory=dict)

    def __call__(self, *mechanisms: str | Path, **options: Any) -> Comparison:  # noqa: ANN401 - the options of compare
        """Compare mechanisms under the options of ``linkproof.compare``; fail the test with every failed record.

        Skips the test if a named engine is not installed, and if no record is judged.
        """
        for name in words(options.get("engine", ())):
            absent = why_unavailable(engine(name))
            if absent is not None:
                pytest.skip(absent)
        key = repr((mechanisms, sorted(options.items())))
        if key not in self.made:
            self.made[key] = compare(*mechanisms, **{"jobs": 1, **options})
        comparison = self.made[key]
        requested = comparison.campaign.options
        texts = [
            failure_text(record, requested, comparison.notes)
            for record in deciding(comparison.records)
            if _counts_as_failed(record.outcome)
        ]
        texts += [changed(figure, requested, comparison.notes) for figure in comparison.figures if figure.changed]
        texts += comparison.departures
        if texts:
            pytest.fail("\n\n".join(texts), pytrace=False)
        if not any(Verdict(record.outcome).judged for record in comparison.records):
            pytest.skip("; ".join(sorted({f"{record.outcome}: {record.detail}" for record in comparison.records})))
        return comparison


def _counts_as_failed(outcome: str) -> bool:
    return Verdict(outcome).failed or outcome == Verdict.SUITE_ERROR
