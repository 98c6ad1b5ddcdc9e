"""Writing a report's folder: every page with its figures, in worker processes; stale files are removed."""

from __future__ import annotations

import gc
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError
from comparisons.campaign import results as campaign
from comparisons.runs.failures import Lost
from comparisons.runs.files import claim, write_text
from comparisons.runs.workers import run_jobs, usual_processes
from reports.campaign.index import FILE as INDEX
from reports.campaign.summary import markdown
from reports.document import html
from reports.document.parts import PageLink
from reports.site.contents import BENCH, STRESS, Contents

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
    files = sorted((link.href for link in links), key=_turn)
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
    _remove_stale(folder, {name for names in written.values() for name in names})
    return folder / INDEX


def _turn(file: str) -> int:
    """The rank of a page in the order of writing: slow pages first."""
    return {BENCH.href: 1, STRESS.href: 2, INDEX: 3}.get(file, 0)


def _write(contents: Contents, folder: Path, links: Sequence[PageLink], png: bool, file: str) -> tuple[str, ...]:
    """Write one page; returns the names of its files. The garbage collector is off, since it is slow."""
    gc.disable()
    try:
        if file == SUMMARY and contents.campaign is not None:
            write_text(folder / SUMMARY, markdown(contents.campaign, contents.sheets))
            return (SUMMARY,)
        return tuple(html.write_all(contents.page(file), folder, links, png=png))
    finally:
        gc.enable()


def _remove_stale(folder: Path, written: set[str]) -> None:
    """Remove the files of the report before this one that it no longer has; no other file is touched."""
    record = folder / WRITTEN
    before = set(record.read_text(encoding="utf-8").splitlines()) if record.is_file() else set()
    for name in before - written:
        path = folder / name
        if path.resolve().is_relative_to(folder.resolve()):
            path.unlink(missing_ok=True)
            with suppress(OSError):  # something else is in there
                path.parent.rmdir()
    write_text(record, "\n".join(sorted(written)) + "\n")
