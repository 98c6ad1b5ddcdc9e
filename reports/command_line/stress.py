"""What ``linkproof stress`` does, once its words are parsed: make the cells, print the counts, write the maps."""

from __future__ import annotations

import math
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from analytic.errors import LinkproofError
from comparisons.judging.records import to_json
from comparisons.runs.environment import environment
from comparisons.runs.files import check_writable, write_text
from comparisons.runs.journal import Journal
from comparisons.stress.axes import chosen_axes
from comparisons.stress.campaign import Stressed, StressRequest, make_cells, stress
from comparisons.stress.cells import CellResult, find_cell
from engines.registry import engine, engine_names
from reports.command_line.exit_codes import stress_exit_code
from reports.command_line.interruption import INCIDENTAL, interruptible
from reports.command_line.progress import progress
from reports.stress.facts import FILE, Stress
from reports.stress.terminal import stress_tables


@dataclass(frozen=True)
class StressChoice:
    """What was asked for, in the user's words: axes, or cells by name; empty means the default."""

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
        words = ["linkproof", "stress", *self.words]
        for option, values in (("--engine", self.engines), ("--setting", self.settings)):
            words += [word for value in values for word in (option, value)]
        words += ["--quick"] if self.quick else []
        return shlex.join([*words, *(["--time-limit", f"{self.time_limit:g}"] if self.time_limit is not None else [])])


def run(
    choice: StressChoice, out: Path | None, target: str | None, *, resume: bool = False, jobs: int | None = None
) -> int:
    """Put engines under stress; returns the exit code.

    Raises LinkproofError for anything that does not exist, before any cell is made.
    """
    if resume and out is None:
        raise LinkproofError("--resume finishes what --out DIR has kept: name that folder with --out, or leave it out")
    if jobs is not None and jobs < 1:
        raise LinkproofError(f"--jobs: expected 1 or more worker processes, got {jobs}; a cell may not run without one")
    if choice.time_limit is not None and not 0.0 < choice.time_limit < math.inf:
        raise LinkproofError(f"--time-limit: expected a positive finite number of s, got {choice.time_limit:g}")
    for path in (*([Path(target)] if target not in (None, "-") else []), *([out / FILE] if out else [])):
        check_writable(path)
    if choice.cells:
        return _alone(choice, target)
    wanted = _request(choice, jobs)
    kept = _journal(out, choice, wanted, resume=resume) if out else None
    with interruptible(out) as counting:
        with progress() as announce:
            found = stress(wanted, counting(announce), kept)
        _written(found, choice, out, target)
        if kept:
            kept.clear()
    return stress_exit_code(found.cells)


def _request(choice: StressChoice, jobs: int | None) -> StressRequest:
    for name in choice.engines:
        engine(name)
    engines = tuple(dict.fromkeys(choice.engines)) or engine_names()
    there = tuple(name for name in engines if engine(name).version() is not None)
    if not there:
        raise LinkproofError(
            f"expected an installed engine, got {', '.join(engines) or 'none at all'}: install it with: pip install "
            f"'linkproof[{engines[0] if engines else 'pymunk'}]'"
        )
    return StressRequest(
        tuple(chosen_axes(choice.words)), there, choice.settings, choice.quick, jobs, choice.time_limit
    )


def _journal(out: Path, choice: StressChoice, wanted: StressRequest, *, resume: bool) -> Journal:
    """The journal of a request: empty, or what was kept of the same one before where it is resumed."""
    facts = {name: value for name, value in environment().items() if name not in INCIDENTAL}
    facts |= {f"engine {name}": engine(name).version() or "" for name in wanted.engines}
    kept = Journal(out, "\n".join([choice.command, *(f"{name} {value}" for name, value in facts.items())]))
    if not resume:
        kept.clear()
    return kept


def _alone(choice: StressChoice, target: str | None) -> int:
    """Make the cells that are named, each on its own, and tell all of them."""
    if len(choice.cells) < len(choice.words):
        raise LinkproofError("expected either axes or cells (AXIS/ROW/VALUE/ENGINE/USAGE), got both; ask for one kind")
    found = make_cells([find_cell(name) for name in choice.cells], choice.time_limit)
    if target == "-":
        sys.stdout.write(to_json({"cells": [one.document for one in found]}))
    else:
        Console().print(*map(_told, found), sep="\n\n", highlight=False)
    return stress_exit_code(found)


def _told(found: CellResult) -> str:
    """One cell in a few lines."""
    judged = found.judgement
    lines = [f"{found.cell.key}: {found.verdict.value}", judged.reason]
    if judged.deviation is not None:
        lines.append(f"worst deviation: {judged.quantity} {judged.deviation:.2g}, limit {judged.deviation_limit:.2g}")
    if judged.invariant_error is not None:
        lines.append(
            f"worst invariant: {judged.invariant} {judged.invariant_error:.2g}, limit {judged.invariant_limit:.2g}"
        )
    lines.append(
        f"{found.steps} steps in {found.seconds:.3g} s; {', '.join(f'{k} {v}' for k, v in found.conditions.items())}"
    )
    return "\n  ".join(filter(None, lines))


def _written(found: Stressed, choice: StressChoice, out: Path | None, target: str | None) -> None:
    document = found.document(choice.command, quick=choice.quick)
    if target != "-":
        Console().print(stress_tables(Stress(document)), highlight=False)
    if target == "-":
        sys.stdout.write(_text(document))
    elif target:
        write_text(Path(target), _text(document))
    if out:
        write_text(out / FILE, _text(document))
        _write_page(Stress(document), out)


def _text(document: dict[str, Any]) -> str:
    return to_json(document)


def _write_page(found: Stress, folder: Path) -> None:
    from reports.stress.page import write  # noqa: PLC0415  pictures cost seconds that a table does not pay

    Console(stderr=True).print(f"stability maps: {write(found, folder)}", highlight=False)
