"""A user's project: the folder of a ``linkproof.toml``, with the linkages, engines and limits to compare."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import Annotated, Any, Final

from pydantic import Field, StrictBool

from analytic.description.loading import LinkageFile, parse, read_document
from analytic.description.schema import Positive, TomlTable
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases, each_case
from comparisons.campaign.key_figures import KeyFigure, compared, present_figures
from comparisons.judging.baseline import Baseline, Coverage, Place, departures, read_baseline
from comparisons.judging.limits import LimitRows, LimitTable, Standard, read_limits, shipped_limits, with_rows
from comparisons.judging.records import Record, RunRecord, blank_record
from comparisons.reference.case import Case

FILE: Final = "linkproof.toml"
BASELINE: Final = "linkproof-baseline.json"
Words = Annotated[tuple[Annotated[str, Field(min_length=1)], ...], Field(description="a list of words in quotes")]


class ProjectDocument(TomlTable):
    """A ``linkproof.toml`` as it is written."""

    linkages: Words = ()
    engines: Words = ()
    settings: Words = ()
    regimes: Words = ()
    figures: Words = ()
    time_limit: Positive | None = None
    memory_limit: Positive | None = None
    baseline: Annotated[str | None, Field(min_length=1, description="the name of a file in quotes")] = None
    allow_new: StrictBool = False
    allow_missing: StrictBool = False
    limit: LimitRows = Field(default_factory=list)


@dataclass(frozen=True)
class Project:
    """The contents of a ``linkproof.toml``; an empty field means the command's default.

    ``linkages`` are the files that its patterns match, ``engines``, ``settings`` and ``regimes`` names as the commands
    take them, ``time_limit`` s and ``memory_limit`` GiB of each run, ``baseline`` the file of what was recorded,
    ``names_baseline`` whether it is named; ``allow_new`` and ``allow_missing`` let linkages and motions differ from it.
    ``figures`` are names of figures that are recorded in it and compared besides the key figures.
    """

    folder: Path
    baseline: Path
    linkages: tuple[Path, ...] = ()
    engines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    regimes: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    time_limit: float | None = None
    memory_limit: float | None = None
    limits: LimitTable = field(default_factory=shipped_limits)
    names_baseline: bool = False
    allow_new: bool = False
    allow_missing: bool = False


def find_project(start: Path) -> Project | None:
    """The project that a file or folder belongs to: the nearest ``linkproof.toml`` there or above; else None."""
    here = start.resolve()
    for folder in (here, *here.parents):
        if (folder / FILE).is_file():
            return read_project(folder / FILE)
    return None


def read_project(path: Path) -> Project:
    """A project from its file; raises LinkproofError for a wrong one."""
    document, folder = read_document(path, "a project's file", ProjectDocument), path.parent
    return Project(
        folder=folder,
        baseline=_check_beneath(folder, document.baseline or BASELINE, "baseline", path),
        linkages=tuple(file for pattern in document.linkages for file in _matching_files(folder, pattern, path)),
        limits=with_rows(document.limit, str(path)) if document.limit else shipped_limits(),
        names_baseline=document.baseline is not None,
        **document.model_dump(exclude={"baseline", "linkages", "limit"}),
    )


def _check_beneath(folder: Path, place: str, key: str, path: Path) -> Path:
    """A place beneath the project's folder; raises LinkproofError for one elsewhere, also if links lead there."""
    try:
        result = Path(os.path.realpath(folder / place))
    except ValueError:  # a null character
        result = Path(os.sep)
    if ".." in PurePath(place).parts or not result.is_relative_to(os.path.realpath(folder)):
        raise LinkproofError(f"{path}: {key}: expected a place beneath its folder, got '{place}'; give one there")
    return folder / place


def _matching_files(folder: Path, pattern: str, path: Path) -> list[Path]:
    """The files that a pattern matches, sorted; raises LinkproofError without one, or for one outside the folder."""
    _check_beneath(folder, pattern, "linkages", path)
    try:
        paths = sorted(file for file in folder.glob(pattern) if file.is_file() and file.name != FILE)
    except (ValueError, NotImplementedError) as error:  # an absolute pattern, or a double star beside letters
        raise LinkproofError(f"{path}: linkages: expected a pattern beneath its folder, got '{pattern}'") from error
    if not paths:
        raise LinkproofError(f"{path}: linkages: expected linkage files, got none that match '{pattern}'; correct it")
    return [_check_beneath(folder, str(file.relative_to(folder)), "linkages", path) for file in paths]


# A user's own standard: limits of a file, a baseline beside the linkages, and what results are under it.


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
    project: Project | None = None,
    limits: Path | None = None,
    baseline: Path | None = None,
    *,
    may_lack: bool = False,
    coverage: Coverage = Coverage(),  # noqa: B008 - frozen
) -> Standard:
    """The standard for results of these files: limits and a baseline, each with precedence over the project's.

    Without any of them the suite's limits alone. ``coverage`` says how much of the baseline is compared. Raises
    LinkproofError for what cannot be read, and for a baseline named by its path that is not there, unless it
    ``may_lack``.
    """
    table = read_limits(limits) if limits is not None else project.limits if project else shipped_limits()
    file = baseline or (project.baseline if project else None)
    if file is None:
        return Standard(table)
    is_named = baseline is not None or (project is not None and project.names_baseline)
    if is_named and not may_lack and not file.exists():
        raise LinkproofError(
            f"expected a baseline at '{file}', got no such file: correct its name, or add --record-baseline"
        )
    home = project.folder if project else file.parent
    result = read_baseline(file, places(files, home))
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
