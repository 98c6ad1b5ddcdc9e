"""A user's standard: limits, a baseline, and the project that completes the options."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, literature, load, read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.campaign.campaign import CampaignRequest, tasks
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.errata import ErratumRecord
from comparisons.campaign.key_figures import check_figures
from comparisons.campaign.project import FILE, JudgedCampaign, Project, find_project, judged_campaign
from comparisons.campaign.project import standard as standard_of
from comparisons.campaign.results import document
from comparisons.judging.baseline import Coverage
from comparisons.judging.limits import Standard, check_named
from comparisons.runs.files import check_writable
from comparisons.runs.plugins import engines
from comparisons.runs.study import Task
from comparisons.runs.workers import Pool
from engines.registry import engine_names
from reports.records.origins import CONCURRENT_RUNS
from reports.requests.campaign import RunResources, files, request, run_resources, with_variant
from reports.requests.campaign_options import (
    BenchOptions,
    CompareOptions,
    RunLimits,
    RunsOptions,
    StandardOptions,
    StressOptions,
)
from reports.requests.motion_options import MotionOptions
from reports.requests.motions import EVERYTHING, OWN, offered_regimes
from reports.requests.options import command_line

Study = TypeVar("Study", CompareOptions, BenchOptions, StressOptions)
INSTALLATIONS = {"site-packages", "dist-packages"}  # the next installation removes the files in them


class CompletedRequest(NamedTuple):
    """Options, completed from the linkages' ``project``.

    ``known`` are the project's linkages, if a regime of the project may belong to a linkage that is not named.
    ``coverage`` is the part of a baseline that is compared.
    """

    options: CompareOptions
    limits: RunLimits
    project: Project | None
    coverage: Coverage
    known: tuple[Linkage, ...] = ()


def complete_request(options: CompareOptions, limits: RunLimits, standard: StandardOptions) -> CompletedRequest:
    """The options as the linkages' project completes them; raises LinkproofError for a project that cannot be read."""
    project = _project_of(options.mechanisms)
    coverage = coverage_of(options, standard, project)
    if project is None:
        return CompletedRequest(options, limits, None, coverage)
    known = _known_linkages(options, project)
    return CompletedRequest(
        _complete_options(options, project), _complete_limits(limits, project), project, coverage, known
    )


def baseline_file(standard: StandardOptions, project: Project | None) -> Path | None:
    """The file of the baseline; raises LinkproofError where it is to be recorded and cannot be."""
    file = standard.baseline or (project.baseline if project else None)
    if not standard.record_baseline:
        return file
    if file is None:
        raise LinkproofError(
            "--record-baseline: expected a file to record into, got none: name one with --baseline, or put a "
            f"{FILE} beside your linkages"
        )
    if {*file.resolve().parts} & INSTALLATIONS:
        raise LinkproofError(
            f"--record-baseline: expected a file of your own, got '{file}' among installed packages: "
            "give a place beside your linkages"
        )
    check_writable(file)
    return file


def chosen_standard(completed: CompletedRequest, standard: StandardOptions) -> Standard:
    """The limits and the baseline for results; raises LinkproofError for unknown names in them."""
    read_files, project = files(completed.options), completed.project
    chosen = standard_of(
        read_files, project, standard.limits, standard.baseline,
        may_lack=standard.record_baseline, coverage=completed.coverage,
    )  # fmt: skip

    def known() -> Iterator[LinkageFile]:
        yield from read_files
        yield from _further_linkages(read_files, project)

    recorded = chosen.baseline.linkages  # a recorded linkage that is missing has its own message
    check_named(
        chosen.limits,
        lambda: [*_mechanism_names(known()), *(Path(path).stem for path in recorded)],
        lambda: [*_regime_names(known()), *chosen.baseline.regimes],
    )
    if not chosen.baseline.lost:
        check_figures(chosen.baseline.coverage.figures, (file.linkage() for file in known()))
    return chosen


def _further_linkages(named: list[LinkageFile], project: Project | None) -> Iterator[LinkageFile]:
    """Further linkages that a limit may name: those of the project, or those in the same folder."""
    folders = dict.fromkeys(Path(file.origin).parent for file in named if not file.is_known)
    paths = project.linkages if project else [path for folder in folders for path in sorted(folder.glob("*.toml"))]
    yield from files(CompareOptions(mechanisms=tuple(map(str, paths)))) if project and paths else ()
    for path in paths:
        with suppress(LinkproofError):  # another file of the folder need not be a linkage
            yield read(path)


def _mechanism_names(known: Iterable[LinkageFile]) -> list[str]:
    return [*(file.name for file in known), *catalogue(), *literature()]


def _regime_names(known: Iterable[LinkageFile]) -> list[str]:
    names = []
    for file in known:
        with suppress(LinkproofError):
            names += [regime.name for regime in file.linkage().regimes]
    return names


def coverage_of(options: CompareOptions, standard: StandardOptions, project: Project | None) -> Coverage:
    """The part of a baseline that is compared: all of it, or the linkages and motions that are named.

    A named motion may be missing in the project's baseline, but not in a baseline that is named itself.
    """
    names_motion = options.motion != MotionOptions()
    return Coverage(
        every_linkage=not options.mechanisms and options.variant is None,
        every_motion=project is not None and not names_motion,
        every_variant=options.variant is None and options.gravity,
        new_motions=not names_motion or standard.baseline is not None,
        allow_new=standard.allow_new or (project is not None and project.allow_new),
        allow_missing=standard.allow_missing or (project is not None and project.allow_missing),
        figures=project.figures if project is not None else (),
    )


def _project_of(names: tuple[str, ...]) -> Project | None:
    """The project of the first linkage that is a user's file, or of the working folder if none is named."""
    if not names:
        return find_project(Path())
    origins = (file.origin for file in map(read, names) if not file.is_known)
    first = next(origins, None)
    return None if first is None else find_project(Path(first).resolve().parent)


def complete_study(options: Study) -> Study:
    """A study's options, with the linkages and engines of the project where none are named.

    The project is that of the first named linkage, or of the working folder. Raises LinkproofError if it cannot be
    read.
    """
    project = _project_of(options.mechanisms if isinstance(options, RunsOptions) else ())
    return options if project is None else _complete_options(options, project)


def _complete_options(options: Study, project: Project) -> Study:
    """Options with the project's values where none are given; raises UnknownNameError for an engine of the project."""
    for name in () if options.engine else project.engines:
        if name not in engine_names():
            raise UnknownNameError(f"engine of {project.folder / FILE}", name, engine_names())
    more: dict[str, Any] = {"engine": options.engine or project.engines}
    if isinstance(options, RunsOptions) and not options.mechanisms and project.linkages:
        more["mechanisms"] = with_variant([os.path.relpath(path) for path in project.linkages], options.variant)
    if isinstance(options, CompareOptions):
        more["setting"] = options.setting or project.settings
        more["regime"] = options.regime or (() if options.swings else project.regimes)
    return replace(options, **more)


def _known_linkages(options: CompareOptions, project: Project) -> tuple[Linkage, ...]:
    """The project's linkages, whose regimes may be requested; empty unless the project names such a regime."""
    known = {*offered_regimes(options), OWN, EVERYTHING}
    if options.regime or not options.mechanisms or {*project.regimes} <= known:
        return ()
    return tuple(load(str(path)) for path in project.linkages)


def _complete_limits(limits: RunLimits, project: Project) -> RunLimits:
    """Limits of time and memory with the project's values where none are given."""
    if limits.jobs == 0:
        return limits  # without worker processes nothing is bounded
    return replace(
        limits,
        time_limit=project.time_limit if limits.time_limit is None else limits.time_limit,
        memory_limit=project.memory_limit if limits.memory_limit is None else limits.memory_limit,
    )


# ``compare``: the requested campaign with the standard of its project, and its results.


DEFAULT_STANDARD, DEFAULT_LIMITS = StandardOptions(), RunLimits()


@dataclass(frozen=True)
class Campaign:
    """A campaign whose names are all known.

    ``command`` repeats it, ``saved_command`` with its standard and limits. ``recorded`` is the file that its errors are
    recorded in, if they are to be. ``options`` are those that were typed; ``names_engines`` tells whether these or the
    project name the engines.
    """

    request: CampaignRequest
    standard: Standard
    resources: RunResources
    options: CompareOptions
    command: str
    saved_command: str
    recorded: Path | None
    names_engines: bool

    def compared(self, pool: Pool, **how: Any) -> JudgedCampaign:  # noqa: ANN401 - announce and journal of a campaign
        """Make the runs in a pool and judge them; the errors are recorded as the baseline if they are to be."""
        runs = run_campaign(self.request, bounds=self.resources.bounds, pool=pool, todo=self.tasks, **how)
        runs.make()
        return judged_campaign(self.request, runs, self.standard, self.recorded)

    @cached_property
    def tasks(self) -> Sequence[Task]:
        """Its runs; raises LinkproofError for what cannot run."""
        return tasks(self.request)

    @property
    def environment(self) -> dict[str, str]:
        """How many runs are made side by side on this machine, where they are."""
        count = min(self.resources.processes, len(self.tasks)) if self.resources.scheduler is None else 1
        return {CONCURRENT_RUNS: str(count)} if count > 1 else {}

    def document(
        self, judged: JudgedCampaign, errata: Sequence[ErratumRecord] = (), *, is_saved: bool = False
    ) -> dict[str, Any]:
        """Everything of the judged campaign but its runs, JSON-ready."""
        readouts = {engine.name: engine.abilities.as_dict() for engine in engines(self.request.engines)}
        command = self.saved_command + (" --out DIR" if is_saved else "")
        table = document(self.request, command, errata, readouts)
        return {**table, **judged.as_dict, "environment": table["environment"] | self.environment}


def campaign(
    options: CompareOptions, standard: StandardOptions = DEFAULT_STANDARD, limits: RunLimits = DEFAULT_LIMITS
) -> Campaign:
    """The campaign of a request; the project of the linkages completes its options.

    Raises LinkproofError for bad input, before any run.
    """
    completed = complete_request(options, limits, standard)
    where = run_resources(completed.limits)
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
