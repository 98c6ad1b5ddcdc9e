"""``linkproof stress``: make the cells of stability maps, print the counts, write the maps."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing

from analytic.errors import LinkproofError
from comparisons.trials.stress.campaign import KIND, load, make_cells, save, stress
from comparisons.trials.stress.cells import cells, chosen_axes, find_cell
from reports.api.campaign import RunResources, missing_engines, requested_engines, run_resources
from reports.api.exit_codes import stress_exit_code
from reports.api.options import RunLimits, StressOptions, command_line
from reports.command_line.destination import Destination
from reports.command_line.unfinished import finished_runs, report_interruption
from reports.stress import cell_details, printout


def run(options: StressOptions, destination: Destination, jobs: int | None = None, scheduler: str | None = None) -> int:
    """Make stability maps or single cells; returns the exit code.

    Raises LinkproofError for bad input before any run.
    """
    destination.check(f"{KIND}.html")
    if jobs is not None and jobs < 1:
        raise LinkproofError(f"--jobs: expected 1 or more worker processes, got {jobs}; a cell may not run without one")
    where = run_resources(RunLimits(jobs=jobs, scheduler=scheduler))
    named = [word for word in options.words if "/" in word]
    if named:
        return _make_named_cells(options, named, destination, where)
    engines, out, command = requested_engines(options.engine), destination.out, command_line("stress", options)
    axes = chosen_axes(options.words)
    if destination.verbose and not options.engine:
        destination.remark(missing_engines(engines))
    with closing(where.lasting_pool) as pool, report_interruption(out, KIND) as counting:
        chosen = cells(axes, engines, options.setting, quick=options.quick)
        finished = finished_runs(out, command, engines) if out else None
        with destination.progress() as announce:
            result = stress(
                chosen, command, quick=options.quick, announce=counting(announce), finished=finished, pool=pool
            )
        if destination.json:
            destination.write_json(result.as_dict)
        if out:
            save(out, result)
        if finished:
            finished.clear()
    destination.print_out(printout(result))
    destination.write_pages()
    return stress_exit_code(result.cells)


def write_again(destination: Destination) -> int:
    """Write the pages and the tables of the maps that are in the folder of ``--out``; returns the exit code."""
    destination.check(f"{KIND}.html")
    assert destination.out is not None
    result = load(destination.out)
    destination.write_json(result.as_dict)
    destination.print_out(printout(result))
    destination.write_pages()
    return stress_exit_code(result.cells)


def _make_named_cells(
    options: StressOptions, named: Sequence[str], destination: Destination, where: RunResources
) -> int:
    """Make the named cells, each separately, and print all their details."""
    if len(named) < len(options.words):
        raise LinkproofError("expected either axes or cells (AXIS/ROW/VALUE/ENGINE/USAGE), got both; ask for one kind")
    chosen = [find_cell(name) for name in named]
    results = make_cells(chosen, where.pool)
    destination.print(*map(cell_details, results))
    destination.write_json({"cells": [result.data for result in results]})
    return stress_exit_code(results)
