"""``compare``: the requested campaign with the standard of its project, and its results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from comparisons.campaign.campaign import CampaignRequest, tasks
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.errata import ErratumRecord
from comparisons.campaign.results import document
from comparisons.campaign.standards import JudgedCampaign, judged_campaign
from comparisons.judging.verdicts import Standard
from comparisons.runs.plugins import engines
from comparisons.runs.study import Task
from comparisons.runs.workers import Pool
from reports.records.environment import AT_A_TIME
from reports.requests.campaign import request
from reports.requests.options.campaign import CompareOptions, RunLimits, StandardOptions
from reports.requests.options.declaring import command_line
from reports.requests.running import Running, running
from reports.requests.standard import baseline_file, chosen_standard, in_project

AS_USUAL, UNBOUND = StandardOptions(), RunLimits()


@dataclass(frozen=True)
class Campaign:
    """A campaign whose names are all known.

    ``command`` repeats it, ``saved_command`` with its standard and limits. ``recorded`` is the file that its errors are
    recorded in, if they are to be. ``options`` are those that were typed; ``names_engines`` tells whether these or the
    project name the engines.
    """

    request: CampaignRequest
    standard: Standard
    running: Running
    options: CompareOptions
    command: str
    saved_command: str
    recorded: Path | None
    names_engines: bool

    def compared(self, pool: Pool, **how: Any) -> JudgedCampaign:  # noqa: ANN401 - announce and journal of a campaign
        """Make the runs in a pool and judge them; the errors are recorded as the baseline if they are to be."""
        runs = run_campaign(self.request, bounds=self.running.bounds, pool=pool, todo=self.tasks, **how)
        runs.make()
        return judged_campaign(self.request, runs, self.standard, self.recorded)

    @cached_property
    def tasks(self) -> Sequence[Task]:
        """Its runs; raises LinkproofError for what cannot run."""
        return tasks(self.request)

    @property
    def environment(self) -> dict[str, str]:
        """How many runs are made side by side on this machine, where they are."""
        count = min(self.running.processes, len(self.tasks)) if self.running.scheduler is None else 1
        return {AT_A_TIME: str(count)} if count > 1 else {}

    def document(
        self, judged: JudgedCampaign, errata: Sequence[ErratumRecord] = (), *, is_saved: bool = False
    ) -> dict[str, Any]:
        """Everything of the judged campaign but its runs, JSON-ready."""
        readouts = {engine.name: engine.abilities.as_dict() for engine in engines(self.request.engines)}
        command = self.saved_command + (" --out DIR" if is_saved else "")
        table = document(self.request, command, errata, readouts)
        return {**table, **judged.as_dict, "environment": table["environment"] | self.environment}


def campaign(options: CompareOptions, standard: StandardOptions = AS_USUAL, limits: RunLimits = UNBOUND) -> Campaign:
    """The campaign of a request; the project of the linkages completes its options.

    Raises LinkproofError for bad input, before any run.
    """
    completed = in_project(options, limits, standard)
    where = running(completed.limits)
    file = baseline_file(standard, completed.project)
    return Campaign(
        request(completed.options, completed.known),
        chosen_standard(completed, standard),
        where,
        options,
        command_line("compare", completed.options),
        command_line("compare", completed.options, standard, completed.limits),
        file if standard.record_baseline else None,
        bool(completed.options.engine),
    )
