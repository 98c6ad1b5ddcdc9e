"""``linkproof verify``, ``diff``, ``merge`` and ``report``: saved results from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.campaign.results import is_saved, load
from comparisons.folders import merging
from comparisons.folders.difference import difference
from comparisons.folders.merging import MergedFolder
from comparisons.folders.studies import StudyFolder, study_differences, write_tables
from comparisons.folders.verification import verify as verify_folder
from reports.command_line.commands.compare import report as report_saved
from reports.command_line.destination import Destination
from reports.document.terminal import show
from reports.records.differences import difference_printout, study_printout, verification_printout
from reports.requests import FAILED, PASSED


def verify(saved: Path, limits: Path | None, destination: Destination) -> int:
    """Judge a folder again; returns the exit code: 1 if something differs."""
    destination.check("")
    _refuse_merged(saved)
    verification = verify_folder(saved, limits)
    destination.write_json(asdict(verification))
    destination.print_out(verification_printout(verification))
    return FAILED if verification.findings else PASSED


def diff(before: Path, after: Path, destination: Destination) -> int:
    """Print the changes between two folders; returns the exit code: 1 if a change is beyond the limits."""
    destination.check("")
    _refuse_merged(before, after)
    studies = tuple(study_differences(StudyFolder(before), StudyFolder(after)))
    campaign = None
    if (is_saved(before) and is_saved(after)) or not studies:
        campaign = difference(load(before, with_sheets=False), load(after, with_sheets=False))
    others = {study.kind: asdict(study) for study in studies}
    destination.write_json({**(campaign.as_dict if campaign else {}), **others})
    for printout in (*([difference_printout(campaign)] if campaign else []), *map(study_printout, studies)):
        destination.print_out(printout)
    is_worse = any(move.is_worse for study in studies for move in study.moves)
    return FAILED if is_worse or (campaign and campaign.beyond_count) else PASSED


def _refuse_merged(*folders: Path) -> None:
    for folder in folders:
        parts = merging.merged_folders(folder)
        if parts:
            raise LinkproofError(
                f"expected the folder of one campaign, got the merged '{folder}': name one in it, such as '{parts[0]}'"
            )


def merge(saved: Sequence[Path], out: Path) -> None:
    """Join folders into one, and write its report."""
    _write_merged_report(merging.merge(merging.folders_to_merge(saved), out), out)


def _write_merged_report(folders: Sequence[MergedFolder], out: Path) -> None:
    """Write the pages of merged folders and their index page, whose path is printed to stderr."""
    from reports.site.site import write_merged_site  # noqa: PLC0415  figures cost a second

    show(f"report: {write_merged_site(folders, out)}", stderr=True)


def report(
    saved: Path, out: Path | None, single: Path | None, csv: Path | None, *, opens: bool = False, png: bool = False
) -> None:
    """Write the pages of a folder's data, or its curves as CSV."""
    merged = merging.merged_folders(saved)
    if csv is None and merged:
        if out is not None or single is not None or opens or png:
            raise LinkproofError(f"'{saved}' is merged: leave the options out, or name one of the folders in it")
        _write_merged_report([MergedFolder(path, path.name) for path in merged], saved)
        return
    if csv is None:
        report_saved(saved, out, single, opens=opens, png=png)
        return
    if out is not None or single is not None or opens or png:
        raise LinkproofError("--csv writes curves and no pages: leave the other options out")
    paths = write_tables(load(saved, with_sheets=False), csv)
    show(f"{len(paths)} files of curves in {csv}", stderr=True)
