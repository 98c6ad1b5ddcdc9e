"""What the commands do, once their words are parsed: load, compute, print, write."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypedDict

import numpy as np
from rich.console import Console

from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.turn.required_feed import compare_feed, read_required_feed
from comparisons.campaign.campaign import Request
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.errata import ErratumRecord, judge_errata
from comparisons.campaign.results import described, document, save
from comparisons.campaign.results import load as load_results
from comparisons.judging import baseline
from comparisons.judging.records import to_json
from comparisons.reference.published import all_variants, compare_published
from comparisons.runs.files import check_writable, write_text
from comparisons.runs.journal import Journal
from comparisons.runs.workers import Bounds
from engines.registry import engine, engine_names
from reports.command_line.exit_codes import campaign_exit_code
from reports.command_line.interruption import interruptible, journal
from reports.command_line.progress import progress
from reports.command_line.requests import DEFAULT_EFFORT, Choice, Effort, request, texts
from reports.facts.mechanism_summary import portrait, thread_facts
from reports.text import terminal

PAGE, SUMMARY = "index.html", "RESULTS.md"


def _write_json(target: str, data: Mapping[str, Any]) -> None:
    text = to_json(data)
    if target == "-":
        sys.stdout.write(text)
    else:
        write_text(Path(target), text)


def list_mechanisms(target: str | None) -> None:
    """Print or write the catalogue."""
    linkages = [load(name) for name in catalogue()]
    if target is None:
        Console().print(terminal.catalogue(linkages))
        return
    rows = [{"mechanism": k.name, "title": k.title, "source": k.source, "variants": list(k.variants)} for k in linkages]
    _write_json(target, {"records": rows})


def show(name: str, variant: str | None, target: str | None) -> None:
    """Print or write the portrait of a mechanism."""
    facts = portrait(load(name, variant))
    if target is None:
        Console().print(terminal.portrait(facts))
    else:
        _write_json(target, facts)


def thread(name: str, variant: str | None, required: Path | None, target: str | None) -> None:
    """Print or write contour and feed of a mechanism's thread, and its difference from a required curve."""
    linkage = load(name, variant)
    if linkage.thread is None:
        raise LinkproofError(f"'{linkage.name}' has no thread: add a [thread] with its stops to its file")
    mechanism = Mechanism(linkage)
    facts = {"mechanism": linkage.name, "variant": linkage.variant, **thread_facts(mechanism, linkage.thread)}
    held = compare_feed(mechanism, linkage.thread, read_required_feed(required)) if required else None
    if target is not None:
        curves = (
            {}
            if held is None
            else {
                "angle": np.degrees(held.angle).tolist(),
                "required": held.required.tolist(),
                "actual": held.actual.tolist(),
                "difference": held.difference.tolist(),
            }
        )
        _write_json(target, {**facts, **({"comparison": curves} if held else {})})
        return
    Console().print(*terminal.thread_lines(facts), sep="\n", highlight=False)
    if held is not None:
        Console().print(terminal.feed_table(held))


def published(names: Sequence[str], target: str | None) -> None:
    """Print or write the published figures beside ours."""
    linkages = [linkage for name in names or catalogue() for linkage in all_variants(name)]
    records = compare_published(linkages)
    with progress() as announce:
        errata = []
        variants = {(linkage.name, linkage.variant): linkage for linkage in linkages}
        judged = judge_errata(linkages, installed(engine_names()), lambda one, variant: variants[one.name, variant])
        for number, record in enumerate(judged):
            announce(f"{record.mechanism}: {record.engine}", number, number + 1)
            errata.append(record)
    if target is None:
        Console().print(terminal.published(records), *(record.sentence for record in errata), sep="\n", highlight=False)
    else:
        rows = [{**asdict(record), "sentence": record.sentence} for record in errata]
        _write_json(target, {"records": [asdict(record) for record in records], "errata": rows})


def installed(engines: Sequence[str]) -> list[str]:
    """Those of the engines that are installed."""
    return [name for name in engines if engine(name).version() is not None]


def compare(
    choice: Choice, out: Path | None, target: str | None, *, record_baseline: bool, effort: Effort = DEFAULT_EFFORT
) -> int:
    """Run a campaign, print its table, write what was asked for; returns the exit code."""
    effort.check()
    if effort.resume and out is None:
        raise LinkproofError("--resume finishes what --out DIR has kept: name that folder with --out, or leave it out")
    wanted = request(choice)
    for path in (*([Path(target)] if target not in (None, "-") else []), *([out / PAGE] if out else [])):
        check_writable(path)
    files = texts(choice, wanted.linkages)
    kept = journal(out, choice.command, wanted, files, resume=effort.resume) if out else None
    with interruptible(out) as counting:
        with progress() as announce:
            limits: _Limits = {"bounds": effort.bounds, "processes": effort.processes, "journal": kept}
            results = list(run_campaign(wanted, counting(announce), **limits))
            errata = _errata(wanted, files, limits) if target or out else []
        records = [record for result in results for record in (*result.records, *result.invariants)]
        if record_baseline:
            baseline.record_all(records)
        if target != "-":
            Console().print(terminal.campaign(results))
        if target or out:
            command = choice.command + effort.words + (" --out DIR" if out else "")
            told = document(wanted, results, files, command, errata)
            if target:
                _write_json(target, told)
            if out:
                save(out, results, told)
                rebuild(out, None)
        if kept:
            kept.clear()
    return campaign_exit_code(records)


class _Limits(TypedDict):
    """How engines are run, as campaigns and errata take it."""

    bounds: Bounds
    processes: int
    journal: Journal | None


def _errata(wanted: Request, files: Sequence[str], limits: _Limits) -> list[ErratumRecord]:
    """The printed models of the linkages whose own regimes are asked for, put to the engines asked for."""
    by_name = dict(zip((linkage.name for linkage in wanted.linkages), files, strict=True))

    def variant_of(linkage: Linkage, variant: str) -> Linkage:
        return described(by_name[linkage.name], linkage.name, variant, linkage.gravity)

    asked = wanted.linkages if wanted.own_regimes else ()
    return list(judge_errata(asked, installed(wanted.engines), variant_of, **limits))


def rebuild(saved: Path, out: Path | None) -> None:
    """Write the page and the summary of a saved campaign."""
    from reports.campaign.extra_sections import extra_sections, rebuild_pages  # noqa: PLC0415
    from reports.campaign.page import write_page  # noqa: PLC0415  figures cost a second that other commands do not pay
    from reports.campaign.summary import markdown  # noqa: PLC0415

    results = load_results(saved)
    kept = saved if saved.is_dir() else saved.parent
    folder = out or kept
    write_page(results, folder / PAGE, extra_sections(kept))
    write_text(folder / SUMMARY, markdown(results))
    rebuild_pages(kept, folder)
    Console(stderr=True).print(f"report: {folder / PAGE}", highlight=False)
