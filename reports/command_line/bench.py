"""What ``linkproof bench`` does, once its words are parsed: measure, print, write."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.campaign.campaign import Request, cases
from comparisons.judging.quantities import QUANTITIES as COMPARED
from comparisons.judging.quantities import check_defined
from comparisons.reference.case import Case
from comparisons.runs.environment import environment
from comparisons.runs.files import check_writable, write_text
from comparisons.runs.timing import WORK, first_use_seconds
from comparisons.work_precision import costs
from comparisons.work_precision.measure import JOINTS, chosen
from comparisons.work_precision.points import FULL, QUICK, Extent
from comparisons.work_precision.records import FILE, FORMAT, Bench, rows, save, text
from comparisons.work_precision.records import load as load_bench
from comparisons.work_precision.study import QUANTITIES, BenchRequest, Measured, methods_told
from comparisons.work_precision.study import bench as measure_all
from engines.registry import engine
from reports.command_line.exit_codes import bench_exit_code
from reports.command_line.interruption import interruptible, journal
from reports.command_line.progress import progress
from reports.command_line.requests import Choice, request, texts
from reports.work_precision.cost_section import cost_tables
from reports.work_precision.terminal import bench_tables

REGIMES, QUICK_REGIMES = ("run-up-quintic", "run-up"), ("run-up-quintic",)


@dataclass(frozen=True)
class BenchChoice:
    """What was asked for, in the user's words; empty means the default."""

    mechanisms: tuple[str, ...] = ()
    regimes: tuple[str, ...] = ()
    engines: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    quick: bool = False
    costs: bool = False

    @property
    def campaign(self) -> Choice:
        """The same as a campaign's choice."""
        regimes = self.regimes or (QUICK_REGIMES if self.quick else REGIMES)
        return Choice(mechanisms=self.mechanisms, regimes=regimes, engines=self.engines)

    @property
    def extent(self) -> Extent:
        """How far to go."""
        return QUICK if self.quick else FULL

    @property
    def command(self) -> str:
        """The command that asks for the same."""
        words = ["linkproof", "bench", *self.mechanisms]
        for option, values in (
            ("--regime", self.regimes),
            ("--engine", self.engines),
            ("--quantity", self.quantities),
        ):
            words += [word for value in values for word in (option, value)]
        words += [*(["--quick"] if self.quick else []), *(["--costs"] if self.costs else [])]
        return shlex.join(words)


def bench(choice: BenchChoice, out: Path | None, target: str | None, *, resume: bool = False) -> int:
    """Measure, print the tables, write what was asked for; returns the exit code.

    Raises LinkproofError for anything that does not exist or cannot be, before any run is made.
    """
    if resume and out is None:
        raise LinkproofError("--resume finishes what --out DIR has kept: name that folder with --out, or leave it out")
    for path in (*([Path(target)] if target not in (None, "-") else []), *([out / FILE] if out else [])):
        check_writable(path)
    asked = request(choice.campaign)
    wanted = _request(choice, asked)
    files = texts(choice.campaign, asked.linkages)
    kept = journal(out, choice.command, asked, files, resume=resume) if out else None
    with interruptible(out) as counting:
        with progress() as announce:
            measured = measure_all(wanted, counting(announce), kept)
        found = Bench(_document(choice, wanted, measured))
        _written(found, choice, out, target)
        if kept:
            kept.clear()
    return bench_exit_code(measured.records, wanted.engines)


def rebuild(saved: Path, out: Path | None = None) -> None:
    """Write the page of a saved benchmark again; needs no engine."""
    _write_page(load_bench(saved), out or (saved if saved.is_dir() else saved.parent))


def _request(choice: BenchChoice, asked: Request) -> BenchRequest:
    every = tuple(cases(asked))
    quantities = tuple(dict.fromkeys(choice.quantities)) or QUANTITIES
    for name in quantities:
        if name not in (*COMPARED, JOINTS):
            raise UnknownNameError("quantity", name, (*COMPARED, JOINTS))
    for case in every:
        found = chosen(case, quantities)
        if not found:
            raise LinkproofError(_nothing_to_measure(case, quantities))
        check_defined(case, [quantity for family in found.values() for quantity in family])
    return BenchRequest(every, asked.engines, quantities, extent=choice.extent)


def _nothing_to_measure(case: Case, quantities: Iterable[str]) -> str:
    return (
        f"none of {', '.join(quantities)} is a result of '{case.mechanism.linkage.name}' in regime "
        f"'{case.motion.regime}': ask for another quantity, or leave the regime out"
    )


def _document(choice: BenchChoice, wanted: BenchRequest, measured: Measured) -> dict[str, Any]:
    """Everything of a finished benchmark, ready for JSON."""
    noise = measured.noise
    linkages = {case.mechanism.linkage.name: case.mechanism.linkage for case in wanted.cases}
    extent = {name: value for name, value in asdict(wanted.extent).items() if value != float("inf")}
    return {
        "format": FORMAT,
        "command": choice.command,
        "conditions": choice.campaign.conditions,
        "environment": environment(),
        "extent": extent,
        "noise": {"work": WORK, "samples": [round(one, 9) for one in noise.samples]},
        "first_use": [
            {"engine": name, "seconds": first_use_seconds(name, 1 if choice.quick else 3)} for name in wanted.engines
        ],
        "mechanisms": [{"name": one.name, "title": one.title, "variant": one.variant} for one in linkages.values()],
        "methods": methods_told(wanted),
        "costs": _costs(list(linkages.values()), wanted.engines) if choice.costs else [],
        "quantities": list(measured.quantities),
        "records": rows(measured.points),
    }


def _costs(linkages: Sequence[Linkage], engines: Iterable[str]) -> list[dict[str, Any]]:
    """What each output and load costs, in the linkage with most to leave out and the engines that are installed."""
    installed = [name for name in engines if engine(name).version() is not None]
    return rows(costs.measure(costs.most_reducible(linkages), installed))


def _written(found: Bench, choice: BenchChoice, out: Path | None, target: str | None) -> None:
    """Print and write a finished benchmark."""
    if target != "-":
        Console().print(bench_tables(found, choice.quantities), *cost_tables(found.costs), highlight=False)
    if target == "-":
        sys.stdout.write(text(found.document))
    elif target:
        write_text(Path(target), text(found.document))
    if out:
        save(out / FILE, found.document)
        _write_page(found, out)


def _write_page(found: Bench, folder: Path) -> None:
    from reports.work_precision.page import write  # noqa: PLC0415  plots cost seconds that a table does not pay

    Console(stderr=True).print(f"benchmark: {write(found, folder)}", highlight=False)
