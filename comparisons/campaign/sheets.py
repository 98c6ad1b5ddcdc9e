"""The data sheets of a campaign's linkages, made in worker processes."""

from __future__ import annotations

from contextlib import closing

from comparisons.campaign.campaign import CampaignRequest
from comparisons.datasheet.building import bare_sheet, usual_sheet
from comparisons.datasheet.sheet import Sheet
from comparisons.runs.failures import Lost
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, run_jobs, usual_processes


def sheets(
    request: CampaignRequest, *, bounds: Bounds = DEFAULT_BOUNDS, processes: int | None = None
) -> tuple[Sheet, ...]:
    """A sheet of every linkage, in the order of the request; one whose process failed contains the reason."""
    jobs = [(linkage, request.motions, request.own_regimes) for linkage in request.linkages]
    count = usual_processes(len(jobs)) if processes is None else processes
    with closing(run_jobs(usual_sheet, jobs, bounds=bounds, processes=count)) as ended:
        table = dict(ended)
    return tuple(
        bare_sheet(jobs[number][0], entry.reason) if isinstance(entry, Lost) else entry
        for number, entry in sorted(table.items())
    )
