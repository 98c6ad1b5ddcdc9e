"""What ``linkproof stress`` does, once its words are parsed: make the cells, print the counts, write the maps."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from analytic.errors import LinkproofError
from comparisons.judging.records import to_json
from comparisons.runs.files import write_text
from comparisons.stress.axes import chosen_axes
from comparisons.stress.campaign import StressRequest, make_cells, stress
from comparisons.stress.cells import find_cell
from comparisons.stress.saved import FILE, Stress
from engines.registry import engine_names
from reports.command_line.destination import Destination
from reports.command_line.exit_codes import stress_exit_code
from reports.command_line.interruption import interruptible, journal
from reports.command_line.requests import RunLimits, command_line, installed, named
from reports.stress.terminal import cell_details, printout


@dataclass(frozen=True)
class StressChoice:
    """The request, in the user's words: axes, or cells by name; empty means the default."""

    words: tuple[str, ...] = ()
    engines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    quick: bool = False
    time_limit: float | None = None

    @property
    def cells(self) -> tuple[str, ...]:
        """Those words that name a cell."""
        return tuple(word for word in self.words if "/" in word)

    @property
    def command(self) -> str:
        """The command that asks for the same."""
        limit = [] if self.time_limit is None else [f"{self.time_limit:g}"]
        options = {"engine": self.engines, "setting": self.settings, "time-limit": limit}
        return command_line("stress", self.words, options, {"quick": self.quick})


def run(choice: StressChoice, destination: Destination, jobs: int | None = None, scheduler: str | None = None) -> int:
    """Put engines under stress, on the workers of a ``scheduler`` where there is one; returns the exit code.

    Raises LinkproofError for anything that does not exist, before any cell is made.
    """
    destination.check(FILE)
    if jobs is not None and jobs < 1:
        raise LinkproofError(f"--jobs: expected 1 or more worker processes, got {jobs}; a cell may not run without one")
    if choice.time_limit is not None and not 0.0 < choice.time_limit < math.inf:
        raise LinkproofError(f"--time-limit: expected a positive finite number of s, got {choice.time_limit:g}")
    where = RunLimits(jobs=jobs, scheduler=scheduler)
    where.check()
    if choice.cells:
        return _alone(choice, destination, where)
    wanted, out = _request(choice), destination.folder
    with where.pool() as pool, interruptible(out) as counting:
        kept = journal(out, choice.command, wanted.engines, resume=destination.resume) if out else None
        with destination.progress() as announce:
            found = stress(replace(wanted, pool=pool), counting(announce), kept)
        told = found.document(choice.command, quick=choice.quick)
        maps = Stress({**told, "environment": {**told["environment"], **pool.place}})
        destination.write_json(maps.document)
        if out:
            write_text(out / FILE, to_json(maps.document))
            destination.write_pages()
        if kept:
            kept.clear()
    destination.print_out(printout(maps))
    return stress_exit_code(found.cells)


def _request(choice: StressChoice) -> StressRequest:
    engines = named(choice.engines) or engine_names()
    present = tuple(installed(engines))
    if not present:
        raise LinkproofError(
            f"expected an installed engine, got {', '.join(engines) or 'none at all'}: install it with: pip install "
            f"'linkproof[{engines[0] if engines else 'pymunk'}]'"
        )
    axes = tuple(chosen_axes(choice.words))
    return StressRequest(axes, present, choice.settings, choice.quick, time_limit=choice.time_limit)


def _alone(choice: StressChoice, destination: Destination, where: RunLimits) -> int:
    """Make the cells that are named, each on its own, and print all that is known of them."""
    if len(choice.cells) < len(choice.words):
        raise LinkproofError("expected either axes or cells (AXIS/ROW/VALUE/ENGINE/USAGE), got both; ask for one kind")
    chosen = [find_cell(name) for name in choice.cells]
    with where.pool() as pool:
        results = make_cells(chosen, choice.time_limit, pool)
    destination.print(*map(cell_details, results))
    destination.write_json({"cells": [result.document for result in results]})
    return stress_exit_code(results)
