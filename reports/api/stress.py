"""``stress``: from axes or cells to stability maps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import closing
from typing import Any

from analytic.errors import LinkproofError
from comparisons.trials.stress.campaign import Stress, make_cells, save
from comparisons.trials.stress.campaign import stress as make_maps
from comparisons.trials.stress.cells import cells, chosen_axes, find_cell
from reports.api.campaign import missing_engines, requested_engines, run_resources
from reports.api.folders import stored_runs
from reports.api.options import Bounds
from reports.studies.trials import StabilityMaps


def stability_maps(function: Callable[..., Any], given: Mapping[str, Any], command: str) -> StabilityMaps:
    """Make the maps, or the single cells, that the call of a ``function`` asks for; its folder keeps the runs.

    Raises LinkproofError for bad input before any run.
    """
    if given["jobs"] is not None and given["jobs"] < 1:
        raise LinkproofError(
            f"--jobs: expected 1 or more worker processes, got {given['jobs']}; a cell may not run without one"
        )
    where, words = run_resources(Bounds(jobs=given["jobs"], scheduler=given["scheduler"])), given["words"]
    named = [word for word in words if "/" in word]
    if named:
        if len(named) < len(words):
            raise LinkproofError(
                "expected either axes or cells (AXIS/ROW/VALUE/ENGINE/USAGE), got both; ask for one kind"
            )
        if given["out"] is not None:
            raise LinkproofError("--out takes whole maps: name axes, or leave it out")
        with closing(where.pool) as pool:
            made = make_cells([find_cell(name) for name in named], pool)
        return StabilityMaps(Stress({"command": command, "environment": {}, "quick": False}, made), are_cells=True)
    axes, engines, folder = chosen_axes(words), requested_engines(given["engine"]), given["out"]
    chosen = cells(axes, engines, given["setting"], quick=given["quick"])
    with closing(where.pool) as pool, stored_runs(function, given, engines) as (finished, announce):
        maps = make_maps(chosen, command, quick=given["quick"], announce=announce, finished=finished, pool=pool)
        if folder is not None:
            save(folder, maps)
    remark = "" if given["engine"] else missing_engines(engines)
    return StabilityMaps(maps, folder=folder, remark=remark, processes=where.processes)
