"""``linkproof compare`` and ``published``: campaigns, figures of the sources."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Final

from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, literature
from comparisons.campaign.campaign import sheets
from comparisons.campaign.errata import SPEED_QUANTITY, judge_errata
from comparisons.campaign.printed_answers import engine_answers
from comparisons.campaign.results import COMPARE, load, save, with_runs, write_curves
from comparisons.campaign.standard import JudgedCampaign
from comparisons.datasheet.published import PublishedRecord, all_variants, compare_published
from comparisons.runs.run_engine import Failure
from comparisons.runs.study_folder import to_json
from engines.registry import engine_names
from reports.campaign.terminal import printout
from reports.command_line.destination import Destination, Writers, journal, report_interruption
from reports.document.terminal import Printout
from reports.mechanism import terminal
from reports.requests import PASSED, SUITE_ERROR
from reports.requests.campaign import installed, missing_engines
from reports.requests.campaign_options import CompareOptions, RunLimits, StandardOptions
from reports.requests.exit_codes import campaign_exit_code
from reports.requests.standard import DEFAULT_LIMITS, DEFAULT_STANDARD, campaign

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
    words: Callable[[JudgedCampaign], Printout] | None = None,
) -> int:
    """Run a campaign, write the requested files, print its tables, or what ``words`` makes; returns the exit code."""
    destination.check(PAGE)
    destination.check_saves(WRITERS, {f"'{name}'": Path(name) for name in options.mechanisms})
    wanted, out = campaign(options, standard, limits), destination.out
    request = wanted.request
    if destination.verbose and not options.engine:
        destination.remark(missing_engines(request.engines))
    if out:
        _ = wanted.tasks  # a run that cannot be made is refused before the folder is touched
    pool = wanted.resources.pool
    with report_interruption(out, COMPARE) as counting:
        engines, linkages = request.engines, request.linkages
        records = journal(out, wanted.command, engines, linkages, full_command=wanted.saved_command) if out else None
        with destination.progress() as announce, destination.own_stdout():
            judged = wanted.compared(pool, announce=counting(announce), journal=records)
            of_errata = linkages if (destination.json or destination.save or out) and request.own_regimes else ()
            # So that its runs serve for printed models too.
            has_speed = SPEED_QUANTITY in (request.quantities or (SPEED_QUANTITY,))
            known = records if has_speed else None
            errata = list(judge_errata(of_errata, engines, bounds=wanted.resources.bounds, pool=pool, journal=known))
        if destination.json or destination.save or out:
            saved = wanted.document(judged, errata, is_saved=out is not None)
            if destination.json:
                destination.write_json(with_runs(saved, judged.runs))
            destination.write_saves(WRITERS, saved, judged.runs)
        if out:
            resources = wanted.resources
            save(out, saved, judged.runs, sheets(request, bounds=resources.bounds, processes=resources.processes))
            destination.write_pages(resources.processes)
    if wanted.recorded:
        destination.remark(f"baseline: {wanted.recorded}")
    destination.write_junit(judged.records, judged.figures, judged.departures)
    notes = (*judged.notes, *judged.departures)
    shown = words(judged) if words else printout(judged.runs, judged.figures, notes, wanted.environment)
    destination.print_out(shown)
    code = campaign_exit_code(judged.records, errata, judged.figures, judged.departures)
    if records:
        records.clear()  # last, since the runs are read from it
    return code


def write_again(destination: Destination) -> int:
    """Write the files and the tables of the comparison that is in the folder of ``--out``; returns its exit code."""
    destination.check(PAGE)
    destination.check_saves(WRITERS)
    assert destination.out is not None
    results = load(destination.out)
    document = results.document
    departures = document.get("departures", ())
    if destination.json:
        destination.write_json(with_runs(document, results.runs))
    destination.write_saves(WRITERS, document, results.runs)
    destination.write_pages()
    every = [record for run in results.runs for record in run.every]
    destination.write_junit(every, results.figures, departures)
    notes = (*document.get("notes", ()), *departures)
    destination.print_out(printout(results.runs, results.figures, notes, document["environment"]))
    return campaign_exit_code(every, figures=results.figures, departures=departures)


def published(names: Sequence[str], destination: Destination, *, with_literature: bool = False) -> int:
    """Print or write the published figures beside ours; returns the exit code.

    ``with_literature``: the default is the linkages of the literature, and every installed engine computes the figures.
    """
    names = names or (literature() if with_literature else catalogue())
    linkages = [linkage for name in names for linkage in all_variants(name)]
    records = compare_published(linkages)
    if with_literature:
        return _print_answers(linkages, records, destination)
    errata = []
    with destination.progress() as announce:
        judged = judge_errata(linkages, installed(engine_names()))
        for number, record in enumerate(judged):
            announce(f"{record.mechanism}: {record.engine}", number, number + 1)
            errata.append(record)
    destination.print(*terminal.published(records), *(record.sentence for record in errata))
    rows = [{**asdict(record), "sentence": record.sentence} for record in errata]
    destination.write_json({"records": [asdict(record) for record in records], "errata": rows})
    return SUITE_ERROR if any(record.outcome == Failure.SUITE_ERROR for record in errata) else PASSED


def _print_answers(linkages: Sequence[Linkage], records: Sequence[PublishedRecord], destination: Destination) -> int:
    """Print or write the published figures beside those of every installed engine; returns the exit code."""
    with destination.progress() as announce:
        answers = list(engine_answers(linkages, installed(engine_names()), announce))
    sources = {linkage.name: linkage.source for linkage in linkages}
    destination.print(*terminal.answered(records, answers, sources))
    rows = [[asdict(record) for record in part] for part in (records, answers)]
    destination.write_json({"records": rows[0], "answers": rows[1], "sources": sources})
    return PASSED
