"""What ``linkproof compare``, ``report`` and ``published`` do: campaigns, their pages, the figures of the sources."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analytic.description.loading import catalogue
from comparisons.campaign.campaign import CampaignRequest, tasks
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.errata import ErratumRecord, judge_errata
from comparisons.campaign.results import document, save
from comparisons.campaign.results import load as load_results
from comparisons.campaign.sheets import sheets
from comparisons.judging import baseline
from comparisons.reference.published import all_variants, compare_published
from comparisons.runs.failures import Failure
from comparisons.runs.files import write_text
from engines.registry import engine, engine_names
from reports.campaign.terminal import printout
from reports.command_line import PASSED, SUITE_ERROR
from reports.command_line.destination import Destination
from reports.command_line.exit_codes import campaign_exit_code
from reports.command_line.interruption import interruptible, journal
from reports.command_line.requests import CampaignChoice, RunLimits, installed, request
from reports.document.terminal import show
from reports.mechanism import terminal

PAGE, SUMMARY = "index.html", "RESULTS.md"


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
                destination.say(f"report: {rebuild(out, processes=limits.processes)}")
        if kept:
            kept.clear()
    destination.print_out(printout(results))
    return campaign_exit_code(records, errata)


def _errata(wanted: CampaignRequest, running: dict[str, Any]) -> list[ErratumRecord]:
    """The printed models of the linkages whose own regimes are asked for, put to the engines asked for."""
    asked = wanted.linkages if wanted.own_regimes else ()
    return list(judge_errata(asked, installed(wanted.engines), **running))


def report(saved: Path, out: Path | None) -> None:
    """Write the page and the summary of a saved campaign, and the pages of what lies beside it; say where."""
    from reports.campaign.extra_sections import rebuild_pages  # noqa: PLC0415

    page = rebuild(saved, out)
    rebuild_pages(saved if saved.is_dir() else saved.parent, page.parent)
    show(f"report: {page}", stderr=True)


def rebuild(saved: Path, out: Path | None = None, processes: int | None = None) -> Path:
    """Write the page and the summary of a saved campaign; returns the path of the page.

    Its figures are drawn in ``processes`` worker processes, by default one per core; with 0, here.
    """
    from reports.campaign.extra_sections import extra_sections  # noqa: PLC0415
    from reports.campaign.page import write_page  # noqa: PLC0415  figures cost a second that other commands do not pay
    from reports.campaign.summary import markdown  # noqa: PLC0415

    results = load_results(saved)
    kept = saved if saved.is_dir() else saved.parent
    folder = out or kept
    write_page(results, folder / PAGE, extra_sections(kept), processes=processes)
    write_text(folder / SUMMARY, markdown(results))
    return folder / PAGE


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
