"""The campaign that ``compare`` makes: its runs, limits of the user's own, and earlier results."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from analytic.description.loading import LinkageFile, catalogue, literature, read
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, tasks
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.results import document, load
from comparisons.campaign.standard import JudgedCampaign, JudgedRuns
from comparisons.judging.changes import Row, read_rows
from comparisons.judging.limits import Standard, check_named, read_limits, shipped_limits
from comparisons.runs.files import check_writable
from comparisons.runs.plugins import engines
from comparisons.runs.study import Task
from comparisons.runs.workers import Pool
from reports.records.origins import CONCURRENT_RUNS
from reports.requests.campaign import RunResources, files, request, run_resources
from reports.requests.campaign_options import CompareOptions, RunLimits, StandardOptions
from reports.requests.options import command_line


def check_record(file: Path | None) -> None:
    """Raise LinkproofError where results are to be recorded and cannot be."""
    if file is not None and file.suffix.lower() != ".csv":
        raise LinkproofError(f"--record {file}: the suffix must be .csv; rename the file")
    if file is not None:
        check_writable(file)


def rows_before(place: Path) -> list[Row]:
    """The rows of a file, or of the comparison in a results folder; raises LinkproofError for anything else."""
    return load(place).rows if place.is_dir() else read_rows(place)


def chosen_standard(options: CompareOptions, limits: Path | None) -> Standard:
    """The limits for results; raises LinkproofError for unknown names in them."""
    if limits is None:
        return Standard(shipped_limits())
    chosen, read_files = read_limits(limits), files(options)

    def known() -> Iterator[LinkageFile]:
        yield from read_files
        yield from _neighbours(read_files)

    check_named(chosen, lambda: _mechanism_names(known()), lambda: _regime_names(known()))
    return Standard(chosen)


def _neighbours(named: list[LinkageFile]) -> Iterator[LinkageFile]:
    """The linkages in the same folders, which a limit may name, too."""
    for folder in dict.fromkeys(Path(file.origin).parent for file in named if not file.is_known):
        for path in sorted(folder.glob("*.toml")):
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


# ``compare``: the requested campaign with its standard, and its results.


DEFAULT_STANDARD, DEFAULT_LIMITS = StandardOptions(), RunLimits()


@dataclass(frozen=True)
class Campaign:
    """A campaign whose names are all known.

    ``command`` repeats it, ``saved_command`` with its standard and limits. ``before`` are the rows that its results are
    compared with. ``every_variant``: no variant is chosen, so that figures are those of all.
    """

    request: CampaignRequest
    standard: Standard
    resources: RunResources
    command: str
    saved_command: str
    before: Sequence[Row] | None
    every_variant: bool

    def compared(self, pool: Pool, **how: Any) -> JudgedCampaign:  # noqa: ANN401 - announce and journal of a campaign
        """Make the runs in a pool and judge them."""
        runs = run_campaign(self.request, bounds=self.resources.bounds, pool=pool, todo=self.tasks, **how)
        runs.make()
        return JudgedCampaign(
            self.request, self.standard, JudgedRuns(runs, self.standard), self.before, self.every_variant
        )

    @cached_property
    def tasks(self) -> Sequence[Task]:
        """Its runs; raises LinkproofError for what cannot run."""
        return tasks(self.request)

    @property
    def environment(self) -> dict[str, str]:
        """How many runs are made side by side, where they are."""
        count = min(self.resources.processes, len(self.tasks))
        return {CONCURRENT_RUNS: str(count)} if count > 1 else {}

    def document(self, judged: JudgedCampaign, *, is_saved: bool = False) -> dict[str, Any]:
        """Everything of the judged campaign but its runs, JSON-ready."""
        readouts = {engine.name: engine.abilities.as_dict() for engine in engines(self.request.engines)}
        command = self.saved_command + (" --out DIR" if is_saved else "")
        table = document(self.request, command, readouts)
        return {**table, **judged.as_dict, "environment": table["environment"] | self.environment}


def campaign(
    options: CompareOptions, standard: StandardOptions = DEFAULT_STANDARD, limits: RunLimits = DEFAULT_LIMITS
) -> Campaign:
    """The campaign of a request; raises LinkproofError for bad input, before any run."""
    check_record(standard.record)
    return Campaign(
        request(options),
        chosen_standard(options, standard.limits),
        run_resources(limits),
        command_line("compare", options),
        command_line("compare", options, standard, limits),
        None if standard.against is None else rows_before(standard.against),
        options.variant is None and options.gravity,
    )
