"""``linkproof compare``: campaigns."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Final

from comparisons.trials.campaign.results import COMPARE, load, save, with_runs, write_curves
from comparisons.trials.judging.changes import write_rows
from comparisons.trials.runs.store import to_json
from reports.api.campaign import DEFAULT_LIMITS, DEFAULT_STANDARD, campaign, check_record, missing_engines
from reports.api.exit_codes import campaign_exit_code
from reports.api.options import CompareOptions, RunLimits, StandardOptions
from reports.campaign.terminal import printout
from reports.command_line.destination import Destination, Writers
from reports.command_line.unfinished import finished_runs, report_interruption

PAGE = "index.html"
WRITERS: Final[Writers] = {
    ".json": lambda saved, runs: to_json(with_runs(saved, runs)),
    ".csv": lambda _, runs: partial(write_curves, runs),
}


def compare(
    options: CompareOptions,
    destination: Destination,
    limits: RunLimits = DEFAULT_LIMITS,
    standard: StandardOptions = DEFAULT_STANDARD,
) -> int:
    """Run a campaign, write the requested files, print its tables; returns the exit code."""
    destination.check(PAGE)
    destination.check_saves(WRITERS, {f"'{name}'": Path(name) for name in options.mechanisms})
    wanted, out = campaign(options, standard, limits), destination.out
    request = wanted.request
    destination.warn(request.linkages)
    if destination.verbose and not options.engine:
        destination.remark(missing_engines(request.engines))
    if out:
        _ = wanted.tasks  # a run that cannot be made is refused before the folder is touched
    pool = wanted.resources.pool
    with report_interruption(out, COMPARE) as counting:
        engines, linkages = request.engines, request.linkages
        full = wanted.saved_command
        finished = finished_runs(out, wanted.command, engines, linkages, full_command=full) if out else None
        with destination.progress() as announce, destination.own_stdout():
            judged = wanted.compared(pool, announce=counting(announce), finished=finished)
        if destination.json or destination.save or out:
            saved = wanted.document(judged, is_saved=out is not None)
            if destination.json:
                destination.write_json(with_runs(saved, judged.runs))
            destination.write_saves(WRITERS, saved, judged.runs)
        if out:
            save(out, saved, judged.runs)
    if standard.record:
        write_rows(judged.rows, standard.record)
    destination.write_junit(judged.runs, judged.changes)
    destination.print_out(printout(judged.runs, judged.changes, wanted.environment))
    code = campaign_exit_code(judged.records, judged.changes)
    if finished:
        finished.clear()  # now that no run is read from it any more
    destination.write_pages(wanted.resources.processes)
    return code


def write_again(destination: Destination, record: Path | None = None) -> int:
    """Write the files and the tables of the comparison that is in the folder of ``--out``; returns its exit code."""
    destination.check(PAGE)
    destination.check_saves(WRITERS)
    assert destination.out is not None
    check_record(record)
    results = load(destination.out)
    document = results.document
    if destination.json:
        destination.write_json(with_runs(document, results.runs))
    destination.write_saves(WRITERS, document, results.runs)
    if record:
        write_rows(results.rows, record)
    destination.write_junit(results.runs, results.changes)
    destination.print_out(printout(results.runs, results.changes, document["environment"]))
    destination.write_pages()
    return campaign_exit_code((error for run in results.runs for error in run.every), results.changes)
