"""What ``linkproof published`` does: printed figures beside ours, and printed models put to the engines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from analytic.description.loading import catalogue
from comparisons.campaign.errata import judge_errata
from comparisons.reference.published import all_variants, compare_published
from comparisons.runs.failures import Failure
from engines.registry import engine_names
from reports.command_line import PASSED, SUITE_ERROR
from reports.command_line.destination import Destination
from reports.command_line.requests import installed
from reports.text import terminal
from reports.text.screen import line


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
    destination.print(terminal.published(records), *(line(record.sentence) for record in errata))
    rows = [{**asdict(record), "sentence": record.sentence} for record in errata]
    destination.write_json({"records": [asdict(record) for record in records], "errata": rows})
    return SUITE_ERROR if any(record.outcome == Failure.SUITE_ERROR for record in errata) else PASSED
