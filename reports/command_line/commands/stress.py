"""``linkproof stress``: make the cells of stability maps, print the counts, write the maps."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace

from analytic.errors import LinkproofError
from comparisons.runs.workers import LastingPool
from comparisons.stress.campaign import KIND, StressRequest, load, make_cells, save, stress
from comparisons.stress.cells import chosen_axes, find_cell
from reports.command_line.destination import Destination, finished_runs, report_interruption
from reports.requests.campaign import RunResources, missing_engines, requested_engines, run_resources
from reports.requests.exit_codes import stress_exit_code
from reports.requests.options import RunLimits, StressOptions, command_line
from reports.stress import cell_details, printout


def run(options: StressOptions, destination: Destination, jobs: int | None = None) -> int:
    """Make stability maps or single cells; returns the exit code.

    Raises LinkproofError for bad input before any run.
    """
    destination.check(f"{KIND}.html")
    if jobs is not None and jobs < 1:
        raise LinkproofError(f"--jobs: expected 1 or more worker processes, got {jobs}; a cell may not run without one")
    where = run_resources(RunLimits(jobs=jobs))
    cells = [word for word in options.words if "/" in word]
    if cells:
        return _make_named_cells(options, cells, destination, where)
    wanted, out = _request(options), destination.out
    if destination.verbose and not options.engine:
        destination.remark(missing_engines(wanted.engines))
    with closing(LastingPool(where.processes)) as pool, report_interruption(out, KIND) as counting:
        wanted = replace(wanted, pool=pool)
        _ = wanted.cells  # a request without any is refused before the folder is touched
        finished = finished_runs(out, wanted.command, wanted.engines) if out else None
        with destination.progress() as announce:
            result = stress(wanted, counting(announce), finished)
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


def _request(options: StressOptions) -> StressRequest:
    """The stability maps to make; raises LinkproofError for unknown names."""
    present = requested_engines(options.engine)
    axes = tuple(chosen_axes(options.words))
    command = command_line("stress", options)
    return StressRequest(axes, present, options.setting, options.quick, command=command)


def _make_named_cells(
    options: StressOptions, cells: Sequence[str], destination: Destination, where: RunResources
) -> int:
    """Make the named cells, each separately, and print all their details."""
    if len(cells) < len(options.words):
        raise LinkproofError("expected either axes or cells (AXIS/ROW/VALUE/ENGINE/USAGE), got both; ask for one kind")
    chosen = [find_cell(name) for name in cells]
    results = make_cells(chosen, where.pool)
    destination.print(*map(cell_details, results))
    destination.write_json({"cells": [result.data for result in results]})
    return stress_exit_code(results)
