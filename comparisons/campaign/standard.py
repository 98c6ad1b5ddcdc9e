"""A user's own standard: limits of a file, a baseline beside the linkages, and what results are under it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analytic.description.loading import LinkageFile, parse
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases, each_case
from comparisons.campaign.key_figures import KeyFigure, compared, present_figures
from comparisons.judging.baseline import Baseline, Coverage, Place, departures, read_baseline
from comparisons.judging.limits import Standard, read_limits, shipped_limits
from comparisons.judging.records import Record, RunRecord, blank_record
from comparisons.reference.case import Case


def places(files: Iterable[LinkageFile], folder: Path) -> dict[str, Place]:
    """The places of linkages in a baseline in a folder, by name: the path from there, or the catalogue's own name."""
    return {file.name: Place(_baseline_path(file, folder), checksum(file.text)) for file in files}


def _baseline_path(file: LinkageFile, folder: Path) -> str:
    if file.is_known:
        return file.name
    return Path(os.path.relpath(Path(file.origin).resolve(), folder.resolve())).as_posix()


def checksum(text: str) -> str:
    """A checksum of a linkage file's text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def standard(
    files: Iterable[LinkageFile],
    limits: Path | None = None,
    baseline: Path | None = None,
    *,
    may_lack: bool = False,
    coverage: Coverage = Coverage(),  # noqa: B008 - frozen
) -> Standard:
    """The standard for results of these files; without limits or baseline the suite's limits alone.

    ``coverage`` says how much of the baseline is compared. Raises LinkproofError for what cannot be read, and for a
    baseline that is not there, unless it ``may_lack``.
    """
    table = read_limits(limits) if limits is not None else shipped_limits()
    if baseline is None:
        return Standard(table)
    if not may_lack and not baseline.exists():
        raise LinkproofError(
            f"expected a baseline at '{baseline}', got no such file: correct its name, or add --record-baseline"
        )
    home = baseline.parent
    result = read_baseline(baseline, places(files, home))
    lost = (path for path in sorted(result.linkages) if path.endswith(".toml") and not (home / path).is_file())
    return Standard(table, replace(result, lost=tuple(lost), coverage=coverage))


def notes(baseline: Baseline) -> tuple[str, ...]:
    """Notes on the files of a baseline that are no failures, a sentence each."""
    if not baseline.is_recorded:
        return ("the baseline is empty: --record-baseline writes it",)
    return tuple(f"{path} has changed since its baseline was recorded" for path in baseline.changed())


@dataclass(frozen=True)
class JudgedCampaign:
    """The results of a campaign under a standard, its key figures beside the recorded, and what the baseline says.

    ``departures`` are sentences that fail it: linkages and motions that are missing, new or renamed.
    """

    standard: Standard
    runs: Iterable[RunRecord]
    figures: Sequence[KeyFigure]
    notes: Sequence[str]
    departures: Sequence[str] = ()

    @property
    def records(self) -> Iterator[Record]:
        """Every record and invariant, run by run."""
        return (record for run in self.runs for record in run.every)

    @property
    def as_dict(self) -> dict[str, Any]:
        """The parts of a campaign's document besides the records, JSON-ready."""
        return {
            "limits": self.standard.limits.as_dict,
            "figures": list(self.figures),
            "notes": list(self.notes),
            "departures": list(self.departures),
        }


@dataclass(frozen=True)
class JudgedRuns(Iterable[RunRecord]):
    """Runs judged by a standard, one by one in every pass over them; runs read from a file do not stay in memory."""

    runs: Iterable[RunRecord]
    standard: Standard

    def __iter__(self) -> Iterator[RunRecord]:
        return (run.judged(self.standard.judge) for run in self.runs)


def compared_cases(request: CampaignRequest, baseline: Baseline) -> Iterator[Case]:
    """The cases of a request, and as far as the baseline covers them those of its linkages' other variants.

    A variant that cannot follow a motion has no case: no engine is to run it.
    """
    yield from each_case(request)
    for linkage in request.linkages if baseline.coverage.every_variant else ():
        for name in linkage.variants:
            if name != linkage.variant:
                variant = parse(linkage.text, linkage.name, linkage.name, name)
                with suppress(LinkproofError):
                    yield from cases(replace(request, linkages=(variant,)))


def judged_campaign(
    request: CampaignRequest, runs: Iterable[RunRecord], standard: Standard, record_into: Path | None = None
) -> JudgedCampaign:
    """Runs, which can be gone through again, under a standard.

    With ``record_into`` they are judged by its limits alone, and written there as its baseline.
    """
    baseline = standard.baseline
    seen: list[Record] = []  # one record for each case: there may be thousands of cases
    beside = compared(with_noted_records(compared_cases(request, baseline), seen), baseline)
    departed = departures(request.linkages, seen, baseline)
    if record_into is not None:
        standard = replace(standard, baseline=Baseline())
        records = (record for run in JudgedRuns(runs, standard) for record in run.every)
        gone = [departure.place for departure in departed if departure.is_recorded]
        baseline = baseline.recorded(records, present_figures(beside), gone)
        baseline.write(record_into)
        beside, departed = (
            [replace(figure, recorded=figure.now, changed=False) for figure in beside if figure.now is not None],
            (),
        )
    return JudgedCampaign(
        replace(standard, baseline=baseline),
        JudgedRuns(runs, standard),
        beside,
        (*notes(baseline), *(departure.sentence for departure in departed if departure.is_allowed)),
        tuple(departure.sentence for departure in departed if not departure.is_allowed),
    )


def with_noted_records(each: Iterable[Case], seen: list[Record]) -> Iterator[Case]:
    """Cases as they come; a blank record of each is appended to ``seen``."""
    for case in each:
        seen.append(blank_record(case, ""))
        yield case
