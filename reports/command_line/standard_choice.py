"""A user's own standard on the command line: limits, a baseline, and the project that stands behind the options."""

from __future__ import annotations

import os
import shlex
from dataclasses import dataclass, replace
from pathlib import Path

from analytic.description.linkage import Linkage
from analytic.description.loading import load, read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.campaign.project import FILE, Project, find_project
from comparisons.campaign.standards import standard
from comparisons.judging.verdicts import Standard
from comparisons.runs.files import check_writable
from engines.registry import engine_names
from reports.command_line.motion_choice import EVERYTHING, OWN
from reports.command_line.requests import CampaignChoice, RunLimits, files, having

INSTALLATIONS = {"site-packages", "dist-packages"}  # what stands there is gone with the next installation


@dataclass(frozen=True)
class StandardChoice:
    """Files of limits and of a baseline, each before the ``project``'s; ``record`` writes the baseline anew."""

    limits: Path | None = None
    baseline: Path | None = None
    record: bool = False
    project: Project | None = None

    @property
    def file(self) -> Path | None:
        """The file of the baseline."""
        return self.baseline or (self.project.baseline if self.project else None)

    def check(self) -> None:
        """Raise LinkproofError where a baseline is to be recorded and cannot be."""
        if not self.record:
            return
        if self.file is None:
            raise LinkproofError(
                "--record-baseline: expected a file to record into, got none: name one with --baseline, or put a "
                f"{FILE} beside your linkages"
            )
        if {*self.file.resolve().parts} & INSTALLATIONS:
            raise LinkproofError(
                f"--record-baseline: expected a file of your own, got '{self.file}' among installed packages: "
                "give a place beside your linkages"
            )
        check_writable(self.file)

    def standard(self, choice: CampaignChoice) -> Standard:
        """What the results of a choice are held against."""
        return standard(files(choice), self.project, self.limits, self.baseline, may_lack=self.record)

    @property
    def words(self) -> str:
        """The options that verdicts depend on, as they follow a command."""
        given = (("--limits", self.limits), ("--baseline", self.baseline))
        return "".join(f" {option} {shlex.quote(str(path))}" for option, path in given if path is not None)


def _project_of(names: tuple[str, ...]) -> Project | None:
    """The project of the first linkage that is a file of a user's; of the working folder where none is named."""
    if not names:
        return find_project(Path())
    origins = (file.origin for file in map(read, names) if not file.is_known)
    first = next(origins, None)
    return None if first is None else find_project(Path(first).resolve().parent)


def in_project(
    choice: CampaignChoice, limits: RunLimits, held: StandardChoice
) -> tuple[CampaignChoice, RunLimits, StandardChoice, tuple[Linkage, ...]]:
    """What was asked for, with the words of the linkages' project wherever it says nothing.

    Last the project's linkages, where one of its regimes may be another linkage's than those that are named.
    """
    project = _project_of(choice.mechanisms)
    if project is None:
        return choice, limits, held, ()
    known = _known_linkages(choice, project)
    return _completed(choice, project), _bounded(limits, project), replace(held, project=project), known


def _completed(choice: CampaignChoice, project: Project) -> CampaignChoice:
    for name in () if choice.engines else project.engines:
        if name not in engine_names():
            raise UnknownNameError(f"engine of {project.folder / FILE}", name, engine_names())
    paths = [os.path.relpath(path) for path in project.linkages]
    return replace(
        choice,
        mechanisms=choice.mechanisms or (having(paths, choice.variant) if paths else ()),
        engines=choice.engines or project.engines,
        settings=choice.settings or project.settings,
        regimes=choice.regimes or (() if choice.swings else project.regimes),
    )


def _known_linkages(choice: CampaignChoice, project: Project) -> tuple[Linkage, ...]:
    offered = {*choice.offered, OWN, EVERYTHING}
    if choice.regimes or not choice.mechanisms or {*project.regimes} <= offered:
        return ()
    return tuple(load(str(path)) for path in project.linkages)


def _bounded(limits: RunLimits, project: Project) -> RunLimits:
    if limits.jobs == 0:
        return limits  # without worker processes nothing is bounded
    return replace(
        limits,
        time_limit=project.time_limit if limits.time_limit is None else limits.time_limit,
        memory_limit=project.memory_limit if limits.memory_limit is None else limits.memory_limit,
    )
