"""What ``linkproof compare``, ``report`` and ``published`` do: campaigns, pages, the figures of the sources."""

from __future__ import annotations

import webbrowser
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analytic.description.loading import catalogue
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, tasks
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.errata import ErratumRecord, judge_errata
from comparisons.campaign.results import document, save
from comparisons.campaign.sheets import sheets
from comparisons.judging import baseline
from comparisons.reference.published import all_variants, compare_published
from comparisons.runs.failures import Failure
from engines.registry import engine, engine_names
from reports.campaign.terminal import printout
from reports.command_line import PASSED, SUITE_ERROR
from reports.command_line.destination import Destination
from reports.command_line.exit_codes import campaign_exit_code
from reports.command_line.interruption import interruptible, journal
from reports.command_line.requests import CampaignChoice, RunLimits, installed, request
from reports.document.terminal import show
from reports.mechanism import terminal

PAGE = "index.html"


def compare(
    choice: CampaignChoice, destination: Destination, limits: RunLimits | None = None, *, record_baseline: bool = False
) -> int:
    """Run a campaign, write what was asked for, print its tables; returns the exit code."""
    limits, out = limits or RunLimits(), destination.folder
    limits.check()
    destination.check(PAGE)
    wanted = request(choice)
    if out:
        tasks(wanted)  # what cannot run is refused before the folder is touched
    kept = journal(out, choice.command, wanted.engines, wanted.linkages, resume=destination.resume) if out else None
    with interruptible(out) as counting:
        with destination.progress() as announce:
            running: dict[str, Any] = {"bounds": limits.bounds, "processes": limits.processes, "journal": kept}
            results = list(run_campaign(wanted, counting(announce), **running))
            errata = _errata(wanted, running) if destination.json or out else []
        records = [record for result in results for record in (*result.records, *result.invariants)]
        if record_baseline:
            baseline.record_all(records)
        if destination.json or out:
            command = choice.command + limits.words + (" --out DIR" if out else "")
            readouts = {name: engine(name).abilities.told() for name in wanted.engines}
            saved = document(wanted, results, command, errata, readouts)
            destination.write_json(saved)
            if out:
                save(out, results, saved, sheets(wanted, bounds=limits.bounds, processes=limits.processes))
                destination.write_pages(limits.processes)
        if kept:
            kept.clear()
    destination.print_out(printout(results))
    return campaign_exit_code(records, errata)


def _errata(wanted: CampaignRequest, running: dict[str, Any]) -> list[ErratumRecord]:
    """The printed models of the linkages whose own regimes are asked for, put to the engines asked for."""
    asked = wanted.linkages if wanted.own_regimes else ()
    return list(judge_errata(asked, installed(wanted.engines), **running))


def report(saved: Path, out: Path | None, single: Path | None, *, opens: bool = False, png: bool = False) -> None:
    """Write the pages of what a folder holds, or one page of all of them; say where, and show them."""
    from reports.site.single_file import write_single_file  # noqa: PLC0415  figures cost a second
    from reports.site.site import write_site  # noqa: PLC0415

    if single is not None and out is not None:
        raise LinkproofError("--single-file and --out exclude each other: leave one of them out")
    if single is not None and png:
        raise LinkproofError("--single-file holds all figures itself: leave --png out")
    page = write_site(saved, out, png=png) if single is None else write_single_file(saved, single)
    show(f"report: {page}", stderr=True)
    if opens:
        webbrowser.open(page.resolve().as_uri())


def published(names: Sequence[str], destination: Destination) -> int:
    """Print or write the published figures beside ours; returns the exit code."""
    linkages = [linkage for name in names or catalogue() for linkage in all_variants(name)]
    records = compare_published(linkages)
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
