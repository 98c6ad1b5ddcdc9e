"""What a report's folder holds beside the campaign's curves: a benchmark, costs, stability maps; a section for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from comparisons.work_precision import records
from reports.document import html
from reports.stress import facts as stress_facts
from reports.stress import page as stress_page
from reports.work_precision import page as bench_page


@dataclass(frozen=True)
class ExtraSection:
    """A section of the report's page; ``page`` is a file of its own that says more, if there is one."""

    key: str
    title: str
    body: Markup
    page: str = ""


def extra_sections(folder: Path) -> tuple[ExtraSection, ...]:
    """Sections for all that a folder holds; none for what it lacks."""
    return (*_benchmark(folder), *_stability(folder))


def rebuild_pages(saved: Path, folder: Path) -> None:
    """Write the pages of their own again, from what ``saved`` holds into ``folder``."""
    if (saved / records.FILE).is_file():
        bench_page.write(records.load(saved), folder)
    if (saved / stress_facts.FILE).is_file():
        html.write(stress_page.page(stress_facts.load(saved)), folder, [])


def _benchmark(folder: Path) -> Iterator[ExtraSection]:
    if not (folder / records.FILE).is_file():
        return
    yield ExtraSection("cost", bench_page.TITLE, Markup("<h2>{}</h2>").format(bench_page.TITLE), bench_page.FILE_NAME)


def _stability(folder: Path) -> Iterator[ExtraSection]:
    if (folder / stress_facts.FILE).is_file():
        yield ExtraSection(
            "stability", stress_page.TITLE, Markup("<h2>{}</h2>").format(stress_page.TITLE), stress_page.PAGE
        )
