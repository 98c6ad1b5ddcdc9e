"""The contents of a report's folder: saved data, and the pages made of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.datasheet import saved as datasheet
from comparisons.datasheet.sheet import Sheet
from comparisons.folders.studies import StudyFolder
from reports.campaign.index import FILE as INDEX
from reports.campaign.index import TITLE as INDEX_TITLE
from reports.campaign.index import index
from reports.document.parts import Page, PageLink, Words
from reports.document.templates import sentence
from reports.mechanism import page as mechanism_page
from reports.stress import page as stress_page
from reports.work_precision import page as bench_page

BENCH, STRESS = PageLink("Work-precision", "bench.html"), PageLink("Stability", "stress.html")


@dataclass(frozen=True)
class Contents(StudyFolder):
    """The contents of a folder, read when needed."""

    def __reduce__(self) -> tuple[type[Contents], tuple[Path]]:
        """Another process reads for itself."""
        return Contents, (self.path,)

    @cached_property
    def sheets(self) -> tuple[Sheet, ...]:
        """The data sheets of its mechanisms."""
        if self.campaign is not None:
            return self.campaign.sheets
        return datasheet.load_sheets(self.path) if (self.path / datasheet.FILE).is_file() else ()

    @property
    def is_single(self) -> bool:
        """Whether it is a designer's results or a judgement of one linkage, whose page is the first one."""
        judged = self.campaign is None or "judgement" in self.campaign.document
        return len(self.sheets) == 1 and judged and self.bench is None and self.stress is None

    def file_of(self, sheet: Sheet) -> str:
        """The file of the page of a mechanism."""
        return INDEX if self.is_single else mechanism_page.file_of(sheet)

    def links(self) -> tuple[PageLink, ...]:
        """Its pages in the order of a reader; raises LinkproofError if the folder has no data for a page."""
        if self.is_single:
            return (PageLink(self.sheets[0].name, INDEX),)
        studies = ((BENCH, self.bench), (STRESS, self.stress))
        names = [sheet.name for sheet in self.sheets]
        page_links = (
            *(
                PageLink(name if names.count(name) == 1 else f"{name} ({sheet.variant})", self.file_of(sheet))
                for name, sheet in zip(names, self.sheets, strict=True)
            ),
            *(link for link, study in studies if study is not None),
        )
        if not page_links:
            raise LinkproofError(
                f"nothing to report in '{self.path}': expected the folder given to --out of compare, bench, stress, "
                "judge or results"
            )
        return (PageLink(INDEX_TITLE, INDEX), *page_links)

    def page(self, file: str) -> Page:
        """One of the pages, by its file."""
        if file == INDEX and not self.is_single:
            return index(self.campaign, self.sheets, tuple(self._studies()))
        if file == BENCH.href and self.bench is not None:
            return bench_page.page(self.bench)
        if file == STRESS.href and self.stress is not None:
            return stress_page.page(self.stress)
        sheet = next(sheet for sheet in self.sheets if self.file_of(sheet) == file)
        return replace(mechanism_page.page(sheet, self.campaign), file=file)

    def _studies(self) -> Iterator[Words]:
        if self.bench is not None:
            yield BENCH, ": ", sentence("index_bench", points=[point for point in self.bench.points if point.errors])
        if self.stress is not None:
            yield STRESS, ": ", sentence("index_stress", cells=len(self.stress.results), count=self.stress.count())
