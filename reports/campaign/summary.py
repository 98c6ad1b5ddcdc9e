"""The summary in Markdown: verdicts and errors alone, so that two machines' summaries of one version diff cleanly.

Same rows, same order, same digits; no date, machine or time. Those stand on the first page.
"""

from __future__ import annotations

from collections.abc import Sequence

from comparisons.trials.campaign.results import CampaignResults
from reports.campaign.index import EngineRanking, families_table, verdict
from reports.document.markdown import written
from reports.document.numbers import ROUND_OFF, bound
from reports.document.parts import Mono, Paragraph, Part, Section
from reports.mechanism.engines import errors_section
from reports.records import changes_table, limit_table, views


def markdown(results: CampaignResults) -> str:
    """The summary of a campaign as Markdown text; raises LookupError for a quantity without a limit or no runs."""
    trust = EngineRanking(results)
    words = (
        f"Largest error over the reference's peak, two digits, round-off as < {bound(ROUND_OFF)}. Written by ",
        Mono(results.document["command"]),
        "; the pages beside it have curves, machine and times.",
    )
    errors = [
        Section("", f"{view.linkage.name} ({view.linkage.variant}), {regime.name}", errors_section(view, regime).parts)
        for view in views(results)
        for regime in view.regimes
    ]
    parts: tuple[Part, ...] = (
        Paragraph(words),
        Section("", "Verdict", (*map(Paragraph, verdict(trust)), families_table(trust, leads=False))),
        *_section_with_parts("Errors", errors),
        *_section_with_parts("Changes", changes_table(results.changes)),
        Section("", "Limits", (limit_table(results),)),
    )
    return f"# Engines against the closed form\n\n{written(parts)}\n"


def _section_with_parts(heading: str, parts: Sequence[Part]) -> tuple[Section, ...]:
    """The section of this heading as the only member of a tuple; () without parts."""
    return (Section("", heading, tuple(parts)),) if parts else ()
