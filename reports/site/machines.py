"""The report of folders that were merged: grouped by hardware; nothing is ranked across machines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import combinations
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.campaign.results import Results
from comparisons.folders.difference import FolderDifference, difference
from comparisons.folders.merging import MergedFolder
from comparisons.judging.records import Verdict
from reports.campaign.index import FILE as INDEX
from reports.document import html
from reports.document.numbers import error as error_words
from reports.document.numbers import seconds
from reports.document.parts import Facts, Page, PageLink, Paragraph, Part, Section, Table
from reports.records.differences import closing_line, moved_table
from reports.records.environment import environment_facts
from reports.site.site import write_site

LEAD = (
    "Each machine has a section of its own, in the order of its name. Times hold for the machine that they were "
    "measured on: they stand beside those of the same machine alone."
)


def write_machines(folders: Sequence[MergedFolder], out: Path) -> Path:
    """Write the pages of every folder and one that leads to them; returns its path."""
    for folder in folders:
        write_site(folder.path)
    html.write_assets(out)
    links = [PageLink("Machines", INDEX), *(PageLink(folder.name, f"{folder.name}/{INDEX}") for folder in folders)]
    return html.write(page(folders), out, links)


def page(folders: Sequence[MergedFolder]) -> Page:
    """The page that leads to the folders: a section per machine, and where machines differ."""
    machines = sorted({folder.machine for folder in folders})
    groups = [[folder for folder in folders if folder.machine == machine] for machine in machines]
    sections = [
        Section(f"machine-{number}", machine, tuple(part for folder in group for part in _folder(folder)))
        for number, (machine, group) in enumerate(zip(machines, groups, strict=True), 1)
    ]
    across = tuple(_across(groups))
    if across:
        sections.append(Section("across", "From machine to machine", across))
    count = f"{len(machines)} {'machine' if len(machines) == 1 else 'machines'}"
    return Page(INDEX, "Machines", f"Results of {count}", f"{len(folders)} folders", (Paragraph(LEAD),),
                tuple(sections))  # fmt: skip


def _folder(folder: MergedFolder) -> Iterator[Part]:
    yield Paragraph((PageLink(folder.name, f"{folder.name}/{INDEX}"), f": {'; '.join(_studies(folder))}"))
    environment = {name: value for name, value in folder.environment.items() if name != "machine"}
    yield Facts(tuple(environment_facts(environment)))
    if folder.campaign is not None:
        yield _engines(folder.campaign)


def _studies(folder: MergedFolder) -> Iterator[str]:
    if folder.campaign is not None:
        yield f"{len({record.run for record in folder.campaign.records})} runs held to their limits"
    if folder.bench is not None:
        yield f"{len(folder.bench.points)} points of work and precision"
    if folder.stress is not None:
        yield f"{len(folder.stress.results)} cells of stability maps"


def _engines(results: Results) -> Table:
    """Engines and settings by name: verdicts, the error that takes most of its limit, the time of all runs."""
    rows = []
    every = (*results.records, *results.invariants)
    for engine, setting in sorted({(record.engine, record.setting) for record in every}):
        mine = [record for record in every if (record.engine, record.setting) == (engine, setting)]
        counts = Counter(Verdict(record.outcome) for record in mine)
        spent = {record.run: (record.setup_seconds, record.seconds) for record in mine}
        shares = [r.error_max / r.limit for r in mine if r.error_max is not None and r.limit]
        rows.append((
            engine, mine[0].engine_version, setting, f"{len({record.run for record in mine})}",
            f"{counts[Verdict.PASSED]}", f"{sum(n for verdict, n in counts.items() if verdict.failed)}",
            f"{sum(n for verdict, n in counts.items() if not verdict.judged)}", error_words(max(shares, default=None)),
            *(seconds(sum(times)) for times in zip(*spent.values(), strict=True)),
        ))  # fmt: skip
    head = (
        *("engine", "version", "setting", "runs", "passed", "failed", "not judged", "worst error / limit"),
        *("set-up", "stepping"),
    )
    return Table("Verdicts of every engine, and the times of its runs together, on this machine.", head, rows, "lllr")


def _across(groups: Sequence[Sequence[MergedFolder]]) -> Iterator[Part]:
    """Errors that are not the same on two machines; times are not compared."""
    for folders, other in combinations(groups, 2):
        for first in folders:
            for second in other:
                folder_difference = _difference(first.campaign, second.campaign)
                if folder_difference is not None:
                    yield Paragraph(f"{first.name}, then {second.name}: {closing_line(folder_difference)}.")
                    yield from [moved_table(folder_difference)] if folder_difference.moves else []


def _difference(before: Results | None, after: Results | None) -> FolderDifference | None:
    """The differences between two campaigns; None if they have no run of the same linkage in common."""
    if before is None or after is None or not {r.run for r in before.records} & {r.run for r in after.records}:
        return None
    try:
        return difference(before, after)
    except LinkproofError:  # the same runs under other conditions
        return None
