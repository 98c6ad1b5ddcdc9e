"""The results of a campaign under a user's own standard: limits, and results recorded before."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

from analytic.description.loading import parse
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases, each_case
from comparisons.campaign.key_figures import KeyFigure, figures_of_case
from comparisons.case import Case
from comparisons.judging.changes import Change, Row, changes, error_row
from comparisons.judging.limits import Standard
from comparisons.judging.records import Record, RunRecord
from engines.contract import Setting


@dataclass(frozen=True)
class JudgedRuns(Iterable[RunRecord]):
    """Runs judged by a standard, one by one in every pass over them; runs read from a file do not stay in memory."""

    runs: Iterable[RunRecord]
    standard: Standard

    def __iter__(self) -> Iterator[RunRecord]:
        return (run.judged(self.standard.judge) for run in self.runs)


@dataclass(frozen=True)
class JudgedCampaign:
    """The ``runs`` of a request, judged by a standard; ``before`` are the rows that they are compared with, if any.

    ``every_variant``: the figures of the closed form are also those of the linkages' other variants.
    """

    request: CampaignRequest
    standard: Standard
    runs: Iterable[RunRecord]
    before: Sequence[Row] | None = None
    every_variant: bool = False

    @property
    def records(self) -> Iterator[Record]:
        """Every record and invariant, run by run."""
        return (record for run in self.runs for record in run.every)

    @cached_property
    def figures(self) -> tuple[KeyFigure, ...]:
        """The key figures of the closed form."""
        return tuple(figure for case in self._cases() for figure in figures_of_case(case))

    @property
    def rows(self) -> list[Row]:
        """The rows of all errors and figures."""
        return [*map(error_row, self.records), *(figure.row for figure in self.figures)]

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """What has changed of what was requested; empty if there is nothing to compare with."""
        if self.before is None:
            return ()
        is_asked = asked_rows(self.request, every_variant=self.every_variant)
        return tuple(changes(*(filter(is_asked, rows) for rows in (self.before, self.rows))))

    @property
    def as_dict(self) -> dict[str, Any]:
        """The parts of a campaign's document besides the records, JSON-ready."""
        return {
            "limits": self.standard.limits.as_dict,
            "figures": [asdict(figure) for figure in self.figures],
            "changes": [{**asdict(entry), "sentence": entry.sentence} for entry in self.changes],
        }

    def _cases(self) -> Iterator[Case]:
        """The cases of the request, and those of other variants; a variant that cannot follow a motion has none."""
        yield from each_case(self.request)
        for linkage in self.request.linkages if self.every_variant else ():
            for name in linkage.variants:
                if name != linkage.variant:
                    variant = parse(linkage.text, linkage.name, linkage.name, name)
                    with suppress(LinkproofError):
                        yield from cases(replace(self.request, linkages=(variant,)))


def asked_rows(request: CampaignRequest, *, every_variant: bool = False) -> Callable[[Row], bool]:
    """Whether a request asks for a row: of its linkages, engines, settings, quantities and motions.

    Naive settings decide nothing beside others, and are left out there. A regime of a linkage's own file is the same
    whatever its conditions are.
    """
    linkages = {(linkage.name, linkage.variant) for linkage in request.linkages}
    names = {linkage.name for linkage in request.linkages}
    motions = {(case.motion.regime, case.conditions) for case in each_case(request)}
    settings = {*request.settings, *(request.own_settings if request.own_regimes else ())}
    settings = settings - {Setting.NAIVE} or settings

    def is_asked(row: Row) -> bool:
        place = row.place
        if (place.regime, place.conditions) not in motions and place.regime not in request.own_regimes:
            return False
        if row.is_figure:
            return place.mechanism in names if every_variant else place[:2] in linkages
        quantity = place.quantity.partition(":")[0]
        return (
            place[:2] in linkages
            and place.engine in request.engines
            and place.setting in settings
            and (not request.quantities or quantity in request.quantities)
        )

    return is_asked
