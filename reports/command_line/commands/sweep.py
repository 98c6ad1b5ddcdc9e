"""``linkproof sweep``: figures over a space of designs, summarised, and written block by block."""

from __future__ import annotations

import hashlib
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Final

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.designs.saved_sweep import FILE, SavedSweep, dataset_attributes
from comparisons.designs.simulated_designs import engines_over_designs
from comparisons.designs.sweep import Summary, SweepRequest, figures_of_file, reason_not_assembled
from comparisons.designs.sweep import sweep as sweep_space
from comparisons.runs.files import write_file, write_text
from comparisons.runs.study import Journal
from reports.command_line.destination import (
    STDOUT,
    Destination,
    check_files,
    journal,
    report_interruption,
    requested_files,
    write_to_stdout,
)
from reports.designs.sweep_terminal import SweepSummary, csv_rows
from reports.document.terminal import Printout
from reports.requests import PASSED
from reports.requests.designs import check_sweep, simulated_campaign, sweep_request
from reports.requests.designs_options import SweepFiles, SweepOptions
from reports.requests.options import command_line

PICTURE: Final = "sweep.svg"
SIMULATED, DESIGN_FILES = "simulated", "designs"  # folders of compare's records and of the files it compares


def sweep(options: SweepOptions, files: SweepFiles, destination: Destination) -> int:
    """Compute a space of designs, print its summary and write the requested files; returns the exit code."""
    destination.check(FILE)
    destination.check(PICTURE)
    check_sweep(options)
    named, read = requested_files(files), {"the linkage's file": Path(options.mechanism)}
    check_files(named, read if options.table is None else {**read, "the table": options.table})
    request, conditions = sweep_request(load(options.mechanism, options.variant), options)
    figures, command = figures_of_file(request), command_line("sweep", options)
    with ExitStack() as stack:
        folder = destination.out
        if folder is None and (files.csv or files.svg):
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="linkproof-")))
        saved = (
            None if folder is None else SavedSweep(request, folder, dataset_attributes(request, conditions, command))
        )
        summary = SweepSummary(request, figures, _compute_designs(options, destination, request, saved), conditions)
        if saved is not None:
            _write_rows(files.csv, saved)
            _write_pictures(files.svg, destination, saved, summary)
            saved.finish(keeps=destination.out is not None)
    destination.write_json(summary.document)
    if STDOUT not in named.values():
        paths = [destination.out / name for name in (FILE, PICTURE)] if destination.out else []
        wrote = [f"wrote {path}" for path in paths if path.exists()]
        destination.print_out(
            Printout([*summary.parts, ""], [summary.sentence, *wrote] if destination.quiet else wrote)
        )
    return _simulate(options, destination, request) if options.simulate else PASSED


def _simulate(options: SweepOptions, destination: Destination, request: SweepRequest) -> int:
    """Compare engines on some of the designs, as ``linkproof compare`` does; its exit code."""
    from reports.command_line.commands.compare import compare  # noqa: PLC0415 - a second that other calls save
    from reports.designs.sweep_terminal import printout  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as temporary, destination.own_stdout():
        folder = destination.out or Path(temporary)
        designs, wanted, limits = simulated_campaign(request, options, folder / DESIGN_FILES)
        below = Destination(
            out=destination.out and destination.out / SIMULATED, resume=destination.resume, quiet=destination.quiet
        )
        return compare(
            wanted, below, limits,
            words=lambda judged: printout(engines_over_designs(designs, judged.records), options.seed),
        )  # fmt: skip


def _compute_designs(
    options: SweepOptions, destination: Destination, request: SweepRequest, saved: SavedSweep | None
) -> Summary:
    """Compute the designs that are not yet saved."""
    done: set[int] = set()
    begun = Summary(request)
    if saved is not None:
        saved.check()
        done = saved.begin(_journal(saved, options.table, resume=destination.resume))
        for number in sorted(done):
            begun.add(request.blocks[number], saved.read(number))
    with report_interruption(destination.out, "designs") as counting, destination.progress() as announce:
        heard = counting(announce)
        summary = sweep_space(
            request,
            keep=saved.keep if saved else lambda *_: None,
            done=done,
            begun=begun,
            announce=lambda number: heard("designs", number, request.space.count),
        )
    if not summary.assembled:
        if saved is not None:
            saved.forget()
        raise LinkproofError(
            f"expected designs that assemble, got none of {summary.designs}, for "
            f"{reason_not_assembled(request)}; vary other ranges"
        )
    return summary


def _journal(saved: SavedSweep, table: Path | None, *, resume: bool) -> Journal:
    """The journal of a sweep's finished blocks; with the digest of the table of designs, if there is one."""
    files = {}
    if table is not None:
        with table.open("rb") as stream:
            files[str(table)] = hashlib.file_digest(stream, "sha256").hexdigest()
    return journal(saved.folder, saved.command, linkages=[saved.request.linkage], files=files, resume=resume)


def _write_rows(place: str | None, saved: SavedSweep) -> None:
    """Write the designs as CSV, if requested."""

    def write(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as stream:
            stream.writelines(csv_rows(saved))

    if place == STDOUT:
        for text in csv_rows(saved):
            write_to_stdout(text)
    elif place is not None:
        write_file(Path(place), write)


def _write_pictures(svg: str | None, destination: Destination, saved: SavedSweep, summary: SweepSummary) -> None:
    """Write the picture if requested, and into the folder if not ``quiet``."""
    places = [] if svg is None else [svg]
    if destination.out is not None:
        picture = destination.out / PICTURE
        picture.unlink(missing_ok=True)  # that of an earlier sweep
        places += [] if destination.quiet else [str(picture)]
    if places:
        from reports.charts import draw  # noqa: PLC0415 - a second that other calls save
        from reports.designs.sweep_picture import sweep_figure  # noqa: PLC0415

        text = draw.svg(sweep_figure(saved.dataset(), summary.own_parameters, summary.summary.extremes), page="white")
        for place in places:
            write_to_stdout(text) if place == STDOUT else write_text(Path(place), text)
