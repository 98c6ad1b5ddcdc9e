"""A user's own standard on the command line: limits, a baseline, and the project that stands behind the options."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, installed, literature, load, read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.campaign.project import FILE, Project, find_project
from comparisons.campaign.standards import standard
from comparisons.judging.baseline import Coverage
from comparisons.judging.limits import check_named
from comparisons.judging.verdicts import Standard
from comparisons.runs.files import check_writable
from engines.registry import engine_names
from reports.command_line.motions import EVERYTHING, OWN, offered
from reports.command_line.requests import CampaignChoice, RunLimits, files, having

INSTALLATIONS = {"site-packages", "dist-packages"}  # what stands there is gone with the next installation


@dataclass(frozen=True)
class StandardChoice:
    """Files of limits and of a baseline, each before the ``project``'s; ``record`` writes the baseline anew.

    ``allow_new`` and ``allow_missing`` let linkages and motions differ from it, of which ``coverage`` is compared.
    """

    limits: Path | None = None
    baseline: Path | None = None
    record: bool = False
    allow_new: bool = False
    allow_missing: bool = False
    project: Project | None = None
    coverage: Coverage = field(default_factory=Coverage)

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
        """What the results of a choice are held against; raises LinkproofError for a limit of what does not exist."""
        read_files, project = files(choice), self.project
        found = standard(read_files, project, self.limits, self.baseline, may_lack=self.record, coverage=self.coverage)

        def known() -> list[LinkageFile]:
            return [*read_files, *_others(read_files, project)]

        recorded = found.baseline.linkages  # what is recorded and missing is told as that
        check_named(
            found.limits,
            lambda: [*_mechanisms(known()), *(Path(path).stem for path in recorded)],
            lambda: [*_regimes(known()), *found.baseline.regimes],
        )
        return found

    @property
    def words(self) -> str:
        """The options that verdicts depend on, as they follow a command."""
        given = (("--limits", self.limits), ("--baseline", self.baseline))
        allowed = (("--allow-new", self.allow_new), ("--allow-missing", self.allow_missing))
        files_words = (f" {option} {shlex.quote(str(path))}" for option, path in given if path is not None)
        return "".join((*files_words, *(f" {option}" for option, is_given in allowed if is_given)))


def _others(named: list[LinkageFile], project: Project | None) -> Iterator[LinkageFile]:
    """Linkages that a limit may be for besides those named: the project's, or those beside them."""
    folders = dict.fromkeys(Path(file.origin).parent for file in named if not file.is_known)
    paths = project.linkages if project else [path for folder in folders for path in sorted(folder.glob("*.toml"))]
    yield from files(CampaignChoice(tuple(map(str, paths)))) if project and paths else ()
    for path in paths:
        with suppress(LinkproofError):  # a file beside a linkage need not be one
            yield read(path)


def _mechanisms(known: list[LinkageFile]) -> list[str]:
    return [*(file.name for file in known), *catalogue(), *literature(), *installed()]


def _regimes(known: list[LinkageFile]) -> list[str]:
    found = []
    for file in known:
        with suppress(LinkproofError):
            found += [regime.name for regime in file.linkage().regimes]
    return found


def project_coverage(project: Project) -> Coverage:
    """What is compared of a project's baseline where nothing is named."""
    return _coverage(CampaignChoice(), StandardChoice(), project)


def _coverage(choice: CampaignChoice, held: StandardChoice, project: Project | None) -> Coverage:
    """What of a baseline is compared: linkages and motions that are named are a part of it.

    A motion that is named may be new to the project's baseline, not to one that is named itself.
    """
    names_motion = bool(any(choice.words.values()) or choice.clockwise or not choice.gravity)
    return Coverage(
        every_linkage=not choice.mechanisms and choice.variant is None,
        every_motion=project is not None and not names_motion,
        new_motions=not names_motion or held.baseline is not None,
        allow_new=held.allow_new or (project is not None and project.allow_new),
        allow_missing=held.allow_missing or (project is not None and project.allow_missing),
    )


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
    held = replace(held, project=project, coverage=_coverage(choice, held, project))
    if project is None:
        return choice, limits, held, ()
    known = _known_linkages(choice, project)
    return _completed(choice, project), _bounded(limits, project), held, known


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
    known = {*offered(choice), OWN, EVERYTHING}
    if choice.regimes or not choice.mechanisms or {*project.regimes} <= known:
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
