"""The campaign that ``compare`` makes: its runs, and the user's standard, which is limits and a baseline."""

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
from comparisons.campaign.results import document
from comparisons.campaign.standard import JudgedCampaign, judged_campaign
from comparisons.campaign.standard import standard as standard_of
from comparisons.judging.baseline import Coverage
from comparisons.judging.limits import Standard, check_named
from comparisons.runs.files import check_writable
from comparisons.runs.plugins import engines
from comparisons.runs.study import Task
from comparisons.runs.workers import Pool
from reports.records.origins import CONCURRENT_RUNS
from reports.requests.campaign import RunResources, files, request, run_resources
from reports.requests.campaign_options import CompareOptions, RunLimits, StandardOptions
from reports.requests.options import command_line

INSTALLATIONS = {"site-packages", "dist-packages"}  # the next installation removes the files in them


def check_recorded(standard: StandardOptions) -> None:
    """Raise LinkproofError where a baseline is to be recorded and cannot be."""
    file = standard.baseline
    if not standard.record_baseline:
        return
    if file is None:
        raise LinkproofError("--record-baseline: expected a file to record into, got none: name one with --baseline")
    if {*file.resolve().parts} & INSTALLATIONS:
        raise LinkproofError(
            f"--record-baseline: expected a file of your own, got '{file}' among installed packages: "
            "give a place beside your linkages"
        )
    check_writable(file)


def chosen_standard(options: CompareOptions, standard: StandardOptions) -> Standard:
    """The limits and the baseline for results; raises LinkproofError for unknown names in them."""
    read_files = files(options)
    chosen = standard_of(
        read_files, standard.limits, standard.baseline,
        may_lack=standard.record_baseline, coverage=_coverage(options, standard),
    )  # fmt: skip

    def known() -> Iterator[LinkageFile]:
        yield from read_files
        yield from _neighbours(read_files)

    recorded = chosen.baseline.linkages  # a recorded linkage that is missing has its own message
    check_named(
        chosen.limits,
        lambda: [*_mechanism_names(known()), *(Path(path).stem for path in recorded)],
        lambda: [*_regime_names(known()), *chosen.baseline.regimes],
    )
    return chosen


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


def _coverage(options: CompareOptions, standard: StandardOptions) -> Coverage:
    """The part of a baseline that is compared: all of it, or the linkages and motions that are named."""
    return Coverage(
        every_linkage=not options.mechanisms and options.variant is None,
        every_variant=options.variant is None and options.gravity,
        allow_new=standard.allow_new,
        allow_missing=standard.allow_missing,
    )


# ``compare``: the requested campaign with the standard of its project, and its results.


DEFAULT_STANDARD, DEFAULT_LIMITS = StandardOptions(), RunLimits()


@dataclass(frozen=True)
class Campaign:
    """A campaign whose names are all known.

    ``command`` repeats it, ``saved_command`` with its standard and limits. ``recorded`` is the file that its errors are
    recorded in, if they are to be.
    """

    request: CampaignRequest
    standard: Standard
    resources: RunResources
    command: str
    saved_command: str
    recorded: Path | None

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
    check_recorded(standard)
    return Campaign(
        request(options),
        chosen_standard(options, standard),
        run_resources(limits),
        command_line("compare", options),
        command_line("compare", options, standard, limits),
        standard.baseline if standard.record_baseline else None,
    )
