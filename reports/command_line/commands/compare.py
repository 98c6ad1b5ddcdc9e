"""What ``linkproof compare``, ``report`` and ``published`` do: campaigns, pages, the figures of the sources."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, literature
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, tasks
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.errata import ErratumRecord, judge_errata
from comparisons.campaign.printed_answers import engine_answers
from comparisons.campaign.results import document, save
from comparisons.campaign.sheets import sheets
from comparisons.campaign.standards import JudgedCampaign, judged_campaign
from comparisons.reference.published import PublishedRecord, all_variants, compare_published
from comparisons.runs.failures import Failure
from comparisons.runs.plugins import engines
from engines.registry import engine_names
from reports.campaign.terminal import printout
from reports.command_line import PASSED, SUITE_ERROR
from reports.command_line.destination import Destination
from reports.command_line.exit_codes import campaign_exit_code
from reports.command_line.interruption import interruptible, journal
from reports.command_line.requests import CampaignChoice, RunLimits, installed, request
from reports.command_line.standard_choice import StandardChoice, in_project
from reports.document.terminal import Printout, show
from reports.mechanism import terminal

PAGE = "index.html"


def compare(
    choice: CampaignChoice,
    destination: Destination,
    limits: RunLimits | None = None,
    held: StandardChoice | None = None,
    words: Callable[[JudgedCampaign], Printout] = lambda judged: printout(
        judged.results, judged.figures, (*judged.notes, *judged.departures)
    ),
) -> int:
    """Run a campaign, write the requested files, print its tables; returns the exit code.

    What the words leave open the project says that the linkages belong to. ``words`` print something else.
    """
    limits, held, out = limits or RunLimits(), held or StandardChoice(), destination.folder
    limits.check()
    destination.check(PAGE)
    choice, limits, held, known = in_project(choice, limits, held)
    held.check()
    wanted, standard = request(choice, known), held.standard(choice)
    if out:
        tasks(wanted)  # what cannot run is refused before the folder is touched
    with limits.pool() as pool, interruptible(out) as counting:
        kept = journal(out, choice.command, wanted.engines, wanted.linkages, resume=destination.resume) if out else None
        with destination.progress() as announce, destination.own_stdout():
            running: dict[str, Any] = {"bounds": limits.bounds, "pool": pool, "journal": kept}
            results = list(run_campaign(wanted, counting(announce), **running))
            errata = _errata(wanted, running) if destination.json or out else []
        judged = judged_campaign(wanted, results, standard, held.file if held.record else None)
        if destination.json or out:
            command = choice.command + held.words + limits.words + (" --out DIR" if out else "")
            saved = campaign_document(wanted, judged, command, errata)
            saved["environment"] |= pool.place
            destination.write_json(saved)
            save_campaign(destination, wanted, judged, saved, limits)
        if kept:
            kept.clear()
    if held.record:
        destination.say(f"baseline: {held.file}")
    destination.write_junit(judged.records, judged.figures, judged.departures)
    destination.print_out(words(judged))
    return campaign_exit_code(judged.records, errata, judged.figures, judged.departures)


def campaign_document(
    wanted: CampaignRequest, judged: JudgedCampaign, command: str, errata: Sequence[ErratumRecord] = ()
) -> dict[str, Any]:
    """Everything of a judged campaign but its curves, JSON-ready."""
    readouts = {one.name: one.abilities.told() for one in engines(wanted.engines)}
    return {**document(wanted, judged.results, command, errata, readouts), **judged.told}


def save_campaign(
    destination: Destination, wanted: CampaignRequest, judged: JudgedCampaign, told: dict[str, Any], limits: RunLimits
) -> None:
    """Write a judged campaign and its pages into the folder of the destination, if it has one."""
    if destination.folder is not None:
        made = sheets(wanted, bounds=limits.bounds, processes=limits.processes)
        save(destination.folder, judged.results, told, made)
        destination.write_pages(limits.processes)


def _errata(wanted: CampaignRequest, running: dict[str, Any]) -> list[ErratumRecord]:
    """The printed models of linkages whose own regimes are requested, simulated in the requested engines."""
    asked = wanted.linkages if wanted.own_regimes else ()
    return list(judge_errata(asked, installed(wanted.engines), **running))


def report(saved: Path, out: Path | None, single: Path | None, *, opens: bool = False, png: bool = False) -> None:
    """Write the pages of what a folder holds, or one page of all of them; say where, and show them."""
    from reports.site.single_file import write_single_file  # noqa: PLC0415  figures cost a second
    from reports.site.site import write_site  # noqa: PLC0415

    if single is not None and out is not None:
        raise LinkproofError("--single-file and --out exclude each other: leave one of them out")
    if single is not None and png:
        raise LinkproofError("--single-file contains all figures: leave --png out")
    page = write_site(saved, out, png=png) if single is None else write_single_file(saved, single)
    show(f"report: {page}", stderr=True)
    if opens:
        webbrowser.open(page.resolve().as_uri())


def published(names: Sequence[str], destination: Destination, *, with_literature: bool = False) -> int:
    """Print or write the published figures beside ours; returns the exit code.

    ``with_literature`` takes the linkages of the literature where none is named, and asks every installed engine.
    """
    names = names or (literature() if with_literature else catalogue())
    linkages = [linkage for name in names for linkage in all_variants(name)]
    records = compare_published(linkages)
    if with_literature:
        return _answered(linkages, records, destination)
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


def _answered(linkages: Sequence[Linkage], records: Sequence[PublishedRecord], destination: Destination) -> int:
    """The same with every installed engine's answer."""
    with destination.progress() as announce:
        answers = list(engine_answers(linkages, installed(engine_names()), announce))
    sources = {linkage.name: linkage.source for linkage in linkages}
    destination.print(*terminal.answered(records, answers, sources))
    rows = [[asdict(one) for one in part] for part in (records, answers)]
    destination.write_json({"records": rows[0], "answers": rows[1], "sources": sources})
    return PASSED
