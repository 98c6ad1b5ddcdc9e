"""Writing a report's folder: every page with its figures, in worker processes; stale files are removed."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations, product
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError
from comparisons.campaign import results as campaign
from comparisons.campaign.results import Results
from comparisons.datasheet import saved as datasheet
from comparisons.datasheet.sheet import Sheet
from comparisons.folders.difference import FolderDifference, difference
from comparisons.folders.merging import MergedFolder
from comparisons.folders.studies import StudyFolder
from comparisons.runs.files import claim, write_text
from comparisons.runs.run_engine import Lost
from comparisons.runs.workers import run_jobs, usual_processes
from reports.campaign.index import FILE as INDEX
from reports.campaign.index import TITLE as INDEX_TITLE
from reports.campaign.index import index, settings_table
from reports.campaign.summary import markdown
from reports.campaign.verdict import EngineRanking
from reports.document import html
from reports.document.parts import Facts, Page, PageLink, Paragraph, Part, Section, Words
from reports.document.templates import sentence
from reports.mechanism import page as mechanism_page
from reports.records.differences import closing_line, moved_table
from reports.records.origins import environment_facts
from reports.stress import page as stress_page
from reports.work_precision import page as bench_page

# The contents of a report's folder: saved data, and the pages made of them.


BENCH, STRESS = bench_page.LINK, stress_page.LINK


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
        """Links to the pages in reading order; raises LinkproofError where the folder has no data for any page."""
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
        """A link to the page of each benchmark and stability map, with a sentence."""
        if self.bench is not None:
            yield BENCH, ": ", sentence("index_bench", points=[point for point in self.bench.points if point.errors])
        if self.stress is not None:
            yield STRESS, ": ", sentence("index_stress", cells=len(self.stress.results), count=self.stress.count())


# Writing a report's folder: every page with its figures, in worker processes; stale files are removed.

SUMMARY: Final = "RESULTS.md"
WRITTEN: Final = "assets/written.txt"  # the files of the report, so that the next one can remove those it lacks


def write_site(saved: Path, out: Path | None = None, *, processes: int | None = None, png: bool = False) -> Path:
    """Write all pages of the data in ``saved`` into ``out``, by default the same folder; returns the first page's path.

    ``processes`` worker processes write, one per core by default; with 0, or if none can be started, this process
    does. ``png`` writes every figure as PNG as well. Raises LinkproofError where another command writes there.
    """
    contents = Contents(saved)
    folder, links = out or contents.path, contents.links()
    _claimed = claim(folder)  # until the last file is written
    html.write_assets(folder)
    files = [link.href for link in (*links[1:], links[0])]  # slow pages first
    jobs = [(file,) for file in (*files, *([SUMMARY] if campaign.is_saved(saved) else []))]
    write = partial(_write, contents, folder, links, png)
    written: dict[int, tuple[str, ...]] = {}
    with suppress(LinkproofError):
        count = usual_processes(len(jobs)) if processes is None else processes
        for job, names in run_jobs(write, jobs, processes=count):
            if not isinstance(names, Lost):
                written[job] = names
    for job, (file,) in enumerate(jobs):
        if job not in written:
            written[job] = write(file)
    _replace_file_list(folder, {name for names in written.values() for name in names})
    return folder / INDEX


def _write(contents: Contents, folder: Path, links: Sequence[PageLink], png: bool, file: str) -> tuple[str, ...]:
    """Write one page; returns the names of its files. The garbage collector is off: it would take an eighth of it."""
    gc.disable()
    try:
        if file == SUMMARY and contents.campaign is not None:
            write_text(folder / SUMMARY, markdown(contents.campaign, contents.sheets))
            return (SUMMARY,)
        return tuple(html.write(contents.page(file), folder, links, png=png))
    finally:
        gc.enable()


def _replace_file_list(folder: Path, written: set[str]) -> None:
    """List the written files, and delete those of the list before that are not ``written``, with emptied folders."""
    record = folder / WRITTEN
    before = set(record.read_text(encoding="utf-8").splitlines()) if record.is_file() else set()
    for name in before - written:
        path = folder / name
        if path.resolve().is_relative_to(folder.resolve()):
            path.unlink(missing_ok=True)
            with suppress(OSError):  # something else is in there
                path.parent.rmdir()
    write_text(record, "\n".join(sorted(written)) + "\n")


# The report of folders that were merged: grouped by hardware; nothing is ranked across machines.

LEAD = (
    "Each machine has a section of its own, in the order of its name. Times hold for the machine that they were "
    "measured on: they stand beside those of the same machine alone."
)


def write_merged_site(folders: Sequence[MergedFolder], out: Path) -> Path:
    """Write the pages of every merged folder and the index page that links to them; returns the index page's path."""
    for folder in folders:
        write_site(folder.path)
    html.write_assets(out)
    links = [PageLink("Machines", INDEX), *(PageLink(folder.name, f"{folder.name}/{INDEX}") for folder in folders)]
    html.write(machines_page(folders), out, links)
    return out / INDEX


def machines_page(folders: Sequence[MergedFolder]) -> Page:
    """The index page of merged folders: a section per machine, and the errors that differ between machines."""
    machines = sorted({folder.machine for folder in folders})
    groups = [[folder for folder in folders if folder.machine == machine] for machine in machines]
    sections = [
        Section(f"machine-{number}", machine, tuple(part for folder in group for part in _folder(folder)))
        for number, (machine, group) in enumerate(zip(machines, groups, strict=True), 1)
    ]
    across = tuple(_machine_differences(groups))
    if across:
        sections.append(Section("across", "From machine to machine", across))
    count = f"{len(machines)} {'machine' if len(machines) == 1 else 'machines'}"
    return Page(INDEX, "Machines", f"Results of {count}", f"{len(folders)} folders", (Paragraph(LEAD),),
                tuple(sections))  # fmt: skip


def _folder(folder: MergedFolder) -> Iterator[Part]:
    """The link to a folder's report, its environment, and its engines with their settings, as on its first page."""
    yield Paragraph((PageLink(folder.name, f"{folder.name}/{INDEX}"), f": {'; '.join(_studies(folder))}"))
    environment = {name: value for name, value in folder.environment.items() if name != "machine"}
    yield Facts(tuple(environment_facts(environment)))
    if folder.campaign is not None:
        yield settings_table(EngineRanking(folder.campaign))


def _studies(folder: MergedFolder) -> Iterator[str]:
    """How many runs, points and cells a folder has."""
    if folder.campaign is not None:
        yield f"{len({record.run for record in folder.campaign.records})} runs held to their limits"
    if folder.bench is not None:
        yield f"{len(folder.bench.points)} points of work and precision"
    if folder.stress is not None:
        yield f"{len(folder.stress.results)} cells of stability maps"


def _machine_differences(groups: Sequence[Sequence[MergedFolder]]) -> Iterator[Part]:
    """Errors that are not the same on two machines; times are not compared."""
    for first, second in (pair for machines in combinations(groups, 2) for pair in product(*machines)):
        if moved := _difference(first.campaign, second.campaign):
            yield Paragraph(f"{first.name}, then {second.name}: {closing_line(moved)}.")
            yield from [moved_table(moved)] if moved.moves else []


def _difference(before: Results | None, after: Results | None) -> FolderDifference | None:
    """The differences between two campaigns; None if they have no run of the same linkage in common."""
    if before is None or after is None or not {r.run for r in before.records} & {r.run for r in after.records}:
        return None
    try:
        return difference(before, after)
    except LinkproofError:  # the same runs under other conditions
        return None
