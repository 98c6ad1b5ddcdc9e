"""What a report's folder holds beside the campaign's curves: a benchmark, costs, stability maps; a section for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from markupsafe import Markup

from comparisons import bench_records
from comparisons.economy_records import Economy
from reports import bench_page, bench_section, economy_section, stress_page, stress_section


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
    if (saved / bench_records.FILE).is_file():
        bench_page.write(bench_records.load(saved), folder)
    if (saved / stress_section.FILE).is_file():
        stress_page.write(stress_section.load(saved), folder)


def _benchmark(folder: Path) -> Iterator[Beside]:
    if not (folder / bench_records.FILE).is_file():
        return
    bench = bench_records.load(folder)
    yield Beside(
        "cost",
        bench_section.TITLE,
        bench_section.fragment(bench, only_first=True),
        bench_section.markdown(bench),
        bench_page.PAGE,
        bench_section.bench_style(),
    )
    if rows := bench.document.get("economy"):
        economy = Economy.from_rows(rows)
        yield Beside(
            "economy",
            economy_section.TITLE,
            economy_section.fragment(economy),
            economy_section.markdown(economy),
        )


def _stability(folder: Path) -> Iterator[Beside]:
    if not (folder / stress_section.FILE).is_file():
        return
    stress = stress_section.load(folder)
    yield Beside(
        "stability",
        stress_section.TITLE,
        stress_section.fragment(stress),
        stress_section.markdown(stress),
        stress_page.PAGE,
    )
