"""What a report's folder holds beside the campaign's curves: a benchmark, costs, stability maps; a section for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from markupsafe import Markup

from comparisons.work_precision import records
from reports.stress import page as stress_page
from reports.stress import section as stability
from reports.work_precision import economy_section
from reports.work_precision import page as bench_page
from reports.work_precision import section as costs


@dataclass(frozen=True)
class Beside:
    """A section for the page and for the summary; ``page`` is a file of its own that says more, if there is one."""

    key: str
    title: str
    body: Markup
    markdown: str
    page: str = ""
    style: Markup = field(default_factory=Markup)


def besides(folder: Path) -> tuple[Beside, ...]:
    """Sections for all that a folder holds; none for what it lacks."""
    return (*_benchmark(folder), *_stability(folder))


def rebuild_pages(saved: Path, folder: Path) -> None:
    """Write the pages of their own again, from what ``saved`` holds into ``folder``."""
    if (saved / records.FILE).is_file():
        bench_page.write(records.load(saved), folder)
    if (saved / stability.FILE).is_file():
        stress_page.write(stability.load(saved), folder)


def _benchmark(folder: Path) -> Iterator[Beside]:
    if not (folder / records.FILE).is_file():
        return
    bench = records.load(folder)
    yield Beside(
        "cost",
        costs.TITLE,
        costs.fragment(bench, only_first=True),
        costs.markdown(bench),
        bench_page.PAGE,
        costs.bench_style(),
    )
    if measured := bench.costs:
        yield Beside(
            "costs",
            economy_section.TITLE,
            economy_section.fragment(measured),
            economy_section.markdown(measured),
        )


def _stability(folder: Path) -> Iterator[Beside]:
    if not (folder / stability.FILE).is_file():
        return
    stress = stability.load(folder)
    yield Beside(
        "stability",
        stability.TITLE,
        stability.fragment(stress),
        stability.markdown(stress),
        stress_page.PAGE,
    )
