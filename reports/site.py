"""Writing a report's folder: every page with its figures, in worker processes; stale files are removed."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError
from comparisons.designer.building import page_sheet
from comparisons.designer.sheet import Sheet
from comparisons.trials.campaign import results as campaign
from comparisons.trials.campaign.campaign import sheets as campaign_sheets
from comparisons.trials.campaign.results import CampaignResults, load_cases
from comparisons.trials.runs.files import claim, write_file
from comparisons.trials.runs.run_engine import Lost
from comparisons.trials.runs.store import has_study
from comparisons.trials.runs.workers import LocalPool, usual_processes
from comparisons.trials.stress import campaign as stress_test
from comparisons.trials.stress.campaign import Stress
from comparisons.trials.work_precision import table as work_precision
from comparisons.trials.work_precision.table import Bench
from reports import bench as bench_page
from reports import stress as stress_pages
from reports.campaign.index import FILE as INDEX
from reports.campaign.index import TITLE as INDEX_TITLE
from reports.campaign.index import index
from reports.campaign.summary import markdown
from reports.document import html
from reports.document.parts import Page, PageLink, Paragraph, Words
from reports.document.templates import sentence
from reports.mechanism import page as mechanism_page

# The contents of a report's folder: saved data, data sheets computed of them, and the pages made of both.


BENCH, STRESS = bench_page.LINK, stress_pages.LINK


@dataclass(frozen=True)
class Contents:
    """The contents of a folder: the data ``sheets`` of its linkages, and its studies, each read on first use."""

    path: Path
    sheets: tuple[Sheet, ...]

    def __reduce__(self) -> tuple[type[Contents], tuple[Path, tuple[Sheet, ...]]]:
        """Pickle the folder and sheets only: another process reads the studies for itself."""
        return Contents, (self.path, self.sheets)

    @cached_property
    def kinds(self) -> frozenset[str]:
        """The kinds of the studies in the folder, of an older version too; raises LinkproofError for damaged ones."""
        every = (*campaign.KINDS, work_precision.KIND, stress_test.KIND)
        return frozenset(kind for kind in every if has_study(self.path, kind))

    @cached_property
    def campaign(self) -> CampaignResults | None:
        """The comparison or judgement in the folder; None without one.

        Raises LinkproofError for one that is damaged or of an older version.
        """
        return campaign.load(self.path) if self.kinds & {*campaign.KINDS} else None

    @property
    def comparison(self) -> CampaignResults | None:
        """The comparison of engines in the folder; None without one. Raises as ``campaign`` does."""
        return self.campaign if campaign.COMPARE in self.kinds else None

    @cached_property
    def bench(self) -> Bench:
        """The benchmark in the folder; raises LinkproofError if it is missing, damaged or of an older version."""
        return work_precision.load(self.path)

    @cached_property
    def stress(self) -> Stress:
        """The stability maps in the folder; raises LinkproofError if missing, damaged or of an older version."""
        return stress_test.load(self.path)

    @cached_property
    def pages(self) -> Mapping[PageLink, Callable[[], Page]]:
        """The functions that build the pages, by the link to each, in reading order: first page, mechanisms, studies.

        One designer's result or judgement has one page. Raises LinkproofError where there is no data for any page.
        """
        names = [sheet.name for sheet in self.sheets]
        if len(names) == 1 and self.kinds <= {campaign.JUDGE}:
            return {PageLink(names[0], INDEX): lambda: replace(self._mechanism(self.sheets[0]), file=INDEX)}
        pages: dict[PageLink, Callable[[], Page]] = {PageLink(INDEX_TITLE, INDEX): self._index}
        for name, sheet in zip(names, self.sheets, strict=True):
            title = name if names.count(name) == 1 else f"{name} ({sheet.variant})"
            pages[PageLink(title, mechanism_page.file_of(sheet))] = partial(self._mechanism, sheet)
        if work_precision.KIND in self.kinds:
            pages[BENCH] = lambda: bench_page.page(self.bench)
        if stress_test.KIND in self.kinds:
            pages[STRESS] = lambda: stress_pages.page(self.stress)
        if len(pages) == 1:
            raise LinkproofError(
                f"nothing to report in '{self.path}': expected the folder given to --out of compare, bench, stress, "
                "judge or results"
            )
        return pages

    def _mechanism(self, sheet: Sheet) -> Page:
        """The page of the mechanism of a sheet, with its part of the campaign or judgement in the folder, if any.

        Raises as ``campaign`` does.
        """
        return mechanism_page.page(sheet, self.campaign)

    def _index(self) -> Page:
        """The first page of several, with a link to benchmark and stability maps and a sentence on each, if there.

        Raises LinkproofError for a study that is damaged or of an older version.
        """
        studies: list[Words] = []
        cost: tuple[Paragraph, ...] = ()
        if work_precision.KIND in self.kinds:
            points = [point for point in self.bench.points if point.errors]
            studies.append((BENCH, ": ", sentence("index_bench", points=points)))
            cost = bench_page.cost(self.bench)
        if stress_test.KIND in self.kinds:
            words = sentence("index_stress", cells=len(self.stress.results), count=self.stress.count())
            studies.append((STRESS, ": ", words))
        return index(self.comparison, self.sheets, tuple(studies), cost)


# Writing a report's folder: every page with its figures, in worker processes; stale files are removed.

SUMMARY: Final = PageLink("Summary", "RESULTS.md")
WRITTEN: Final = "assets/written.txt"  # the files of the report, so that the next one can remove those it lacks


def write_site(folder: Path, *, processes: int | None = None) -> Path:
    """Write all pages of the data in a folder, and the files they need, into it; returns the first page's path.

    Files of an earlier report that this one lacks are deleted. ``processes`` worker processes write, one per core by
    default; with 0, or if none can be started, this process does. Raises LinkproofError where another command writes
    there, where there is no data or it is damaged, and where a file cannot be written.
    """
    contents = Contents(folder, _sheets(folder, processes))
    first, *others = contents.pages
    _claimed = claim(folder)  # until the last file is written
    html.write_assets(folder)
    jobs = [(link,) for link in (*others, first, *([SUMMARY] if contents.comparison else []))]  # slow pages first
    write = partial(_write, contents)
    written: dict[int, tuple[str, ...]] = {}
    with suppress(LinkproofError):
        count = usual_processes(len(jobs)) if processes is None else processes
        for job, names in LocalPool(count).run(write, jobs):
            if not isinstance(names, Lost):
                written[job] = names
    for job, (link,) in enumerate(jobs):
        if job not in written:
            written[job] = write(link)
    _replace_file_list(folder, {name for names in written.values() for name in names})
    return folder / INDEX


def _sheets(folder: Path, processes: int | None) -> tuple[Sheet, ...]:
    """The data sheets of a folder's linkages: those of a campaign, then of results that a designer added.

    A campaign's are made in ``processes``, one per core for None, none for 0. Raises LinkproofError for damaged data.
    """
    added = [page_sheet(case, tuple(case.mechanism.linkage.released)) for case in load_cases(folder)]
    if not campaign.is_saved(folder):
        return tuple(added)
    known, results = [(sheet.name, sheet.variant) for sheet in added], campaign.load(folder)
    linkages = [linkage for linkage in results.linkages if (linkage.name, linkage.variant) not in known]
    return (*campaign_sheets(linkages, results.motions, results.regimes, processes), *added)


def _write(contents: Contents, link: PageLink) -> tuple[str, ...]:
    """Write one page with its figures, or the summary, into the folder; returns the names of its files.

    Garbage collection is off meanwhile, which saves an eighth. Raises LinkproofError where a file cannot be written.
    """
    gc.disable()
    try:
        if link == SUMMARY and contents.comparison is not None:
            write_file(contents.path / SUMMARY.href, markdown(contents.comparison))
            return (SUMMARY.href,)
        return tuple(html.write(contents.pages[link](), contents.path, tuple(contents.pages)))
    finally:
        gc.enable()


def _replace_file_list(folder: Path, written: set[str]) -> None:
    """List the written files in ``WRITTEN``, and delete those of the list before that are not ``written``.

    Folders that this empties are deleted too. Raises LinkproofError where the list cannot be written.
    """
    record = folder / WRITTEN
    before = set(record.read_text(encoding="utf-8").splitlines()) if record.is_file() else set()
    for name in before - written:
        path = folder / name
        if path.resolve().is_relative_to(folder.resolve()):
            path.unlink(missing_ok=True)
            with suppress(OSError):  # something else is in there
                path.parent.rmdir()
    write_file(record, "\n".join(sorted(written)) + "\n")
