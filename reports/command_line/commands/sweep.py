"""What ``linkproof sweep`` does: figures over a space of designs, summed up, and written as they come."""

from __future__ import annotations

import hashlib
import math
import tempfile
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from analytic.description.changes import SPEED
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.datasheet.units import file_unit
from comparisons.designs.named_figures import named_figures
from comparisons.designs.parameters import mass_words
from comparisons.designs.sweep.saved_sweep import FILE, SavedSweep
from comparisons.designs.sweep.simulated_designs import SimulatedDesigns, engines_over_designs, simulated_designs
from comparisons.designs.sweep.space import DesignSpace, Grid, steps
from comparisons.designs.sweep.sweep import Summary, SweepRequest, own_figures, sweep, usual_figures, why_not
from comparisons.designs.sweep.table import read_table
from comparisons.judging.records import Record
from comparisons.runs.cluster.connecting import opened
from comparisons.runs.files import write_file, write_text
from comparisons.runs.journal import Journal
from comparisons.runs.workers import Pool
from reports.command_line import PASSED
from reports.command_line.destination import STDOUT, Destination, check_files, write_out
from reports.command_line.interruption import interruptible, journal
from reports.command_line.requests import RunLimits, command_line, named
from reports.command_line.steady_choice import SteadyChoice, steady_case
from reports.designs.sweep.sweep_table import csv_rows
from reports.designs.sweep.sweep_terminal import SweepSummary
from reports.document.terminal import Printout

PICTURE: Final = "sweep.svg"
SIMULATED, DESIGN_FILES = "simulated", "designs"  # folders of compare's records and of the files it compares
DESIGNS: Final = 24  # that are simulated


@dataclass(frozen=True, kw_only=True)
class SweepChoice(SteadyChoice):
    """The request, in the user's words; ``csv``, ``json`` and ``svg`` are files, or "-" for stdout."""

    vary: tuple[str, ...] = ()
    table: Path | None = None
    quantities: tuple[str, ...] = ()
    csv: str | None = None
    json: str | None = None
    svg: str | None = None
    jobs: int | None = None
    simulate: tuple[str, ...] = ()
    designs: int = DESIGNS
    seed: int = 0
    scheduler: str | None = None

    @property
    def files(self) -> dict[str, str]:
        """Files to be written, by option."""
        named = {"--csv": self.csv, "--json": self.json, "--svg": self.svg}
        return {option: file for option, file in named.items() if file is not None}

    @property
    def command(self) -> str:
        """The command that asks for the same figures."""
        table = [] if self.table is None else [str(self.table)]
        options = {"vary": self.vary, "table": table, "quantity": self.quantities, **self.words}
        return command_line("sweep", [self.mechanism], options, self.flags)

    def check(self) -> None:
        """Raise LinkproofError for what cannot be, before anything is worked out."""
        super().check()
        self.check_simulation()
        if bool(self.vary) == (self.table is not None):
            got = "both" if self.vary else "neither"
            raise LinkproofError(f"expected designs by --vary NAME=FIRST:LAST:COUNT or by --table FILE, got {got}: "
                                 "give one of the two")  # fmt: skip
        if self.jobs is not None and self.jobs < 1:
            raise LinkproofError(f"--jobs: expected 1 or more cores, got {self.jobs}; correct it")
        RunLimits(jobs=self.jobs, scheduler=self.scheduler).check()
        read = {"the linkage's file": Path(self.mechanism)}
        check_files(self.files, read if self.table is None else {**read, "the table": self.table})

    def check_simulation(self) -> None:
        """Raise LinkproofError for designs that cannot be simulated."""
        if self.designs < 1:
            raise LinkproofError(f"--designs: expected 1 design or more to simulate, got {self.designs}; give more")
        if self.seed < 0:
            raise LinkproofError(f"--seed: expected a whole number, 0 or more, got {self.seed}; give another")
        if not self.simulate and (self.designs, self.seed) != (DESIGNS, 0):
            option = "--designs" if self.designs != DESIGNS else "--seed"
            raise LinkproofError(f"{option} is for designs that are simulated: name an engine with --simulate")
        named(self.simulate)


def run(choice: SweepChoice, destination: Destination) -> int:
    """Work a space through, print its summary and write the requested files; returns the exit code."""
    destination.check(FILE)
    destination.check(PICTURE)
    choice.check()
    request, conditions = sweep_request(load(choice.mechanism, choice.variant), choice)
    own = own_figures(request)
    with ExitStack() as stack:
        folder = destination.folder
        if folder is None and (choice.csv or choice.svg):
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="linkproof-")))
        saved = None if folder is None else SavedSweep(request, folder, described(request, conditions, choice.command))
        found = SweepSummary(request, own, _worked(choice, destination, request, saved), conditions)
        if saved is not None:
            _write_rows(choice.csv, saved)
            _write_pictures(choice, destination, saved, found)
            saved.finish(keeps=destination.folder is not None)
    destination.write_json(found.document)
    if STDOUT not in choice.files.values():
        there = [destination.folder / name for name in (FILE, PICTURE)] if destination.folder else []
        wrote = [f"wrote {path}" for path in there if path.exists()]
        destination.print_out(Printout([*found.parts, ""], [found.sentence, *wrote] if destination.quiet else wrote))
    if not choice.simulate:
        return PASSED
    from reports.designs.sweep.engines_terminal import printout  # noqa: PLC0415

    return simulate(
        choice, destination, request,
        lambda designs, records: printout(engines_over_designs(designs, records), choice.seed),
    )  # fmt: skip


def simulate(
    choice: SweepChoice,
    destination: Destination,
    request: SweepRequest,
    words: Callable[[SimulatedDesigns, Sequence[Record]], Printout],
) -> int:
    """Compare engines on some of the designs, as ``linkproof compare`` does, and print ``words``; its exit code."""
    from reports.command_line.commands.compare import compare  # noqa: PLC0415 - what no other call pays for
    from reports.command_line.requests import CampaignChoice  # noqa: PLC0415

    if any(one.kind == SPEED for one in request.space.parameters):
        raise LinkproofError("--simulate: expected designs of one speed, got several; leave --vary speed out")
    designs, motion = simulated_designs(request, choice.designs, choice.seed), request.motion
    if not (motion.is_full_turn or choice.swings):
        unit = file_unit("m", request.linkage).size if request.linkage.is_linear else math.radians(1.0)
        ends = (motion.places[[0, -1]] / unit).tolist()
        choice = replace(choice, from_angle=ends[0], to_angle=ends[1])
    with tempfile.TemporaryDirectory() as temporary, destination.own_stdout():
        folder = (destination.folder or Path(temporary)) / DESIGN_FILES
        for name, text in designs.files.items():
            write_text(folder / f"{name}.toml", text)
        wanted = CampaignChoice(
            tuple(str(folder / f"{name}.toml") for name in designs.files), engines=choice.simulate,
            **choice.of_written_file,
        )  # fmt: skip
        below = Destination(
            folder=destination.folder and destination.folder / SIMULATED, resume=destination.resume,
            quiet=destination.quiet,
        )  # fmt: skip
        return compare(
            wanted, below, RunLimits(jobs=choice.jobs, scheduler=choice.scheduler),
            words=lambda judged: words(designs, judged.records),
        )  # fmt: skip


def sweep_request(linkage: Linkage, choice: SweepChoice) -> tuple[SweepRequest, str]:
    """The request, and its conditions in words; raises LinkproofError for unknown names."""
    mechanism, motion, conditions = steady_case(linkage, choice)
    figures = named_figures(mechanism, choice.quantities) if choice.quantities else usual_figures(mechanism)
    if not figures:
        raise LinkproofError(f"expected a figure of '{linkage.name}', got none: name one with --quantity")
    space = designs_of(mechanism.linkage, choice)
    conditions += mass_words(mechanism.linkage, (one.name for one in space.parameters))
    return SweepRequest(mechanism.linkage, space, figures, motion, choice.refine, choice.jobs).on_one_path(), conditions


def designs_of(linkage: Linkage, choice: SweepChoice) -> DesignSpace:
    """The grid of ``--vary``, or the list of ``--table``."""
    if choice.table is not None:
        return read_table(choice.table, linkage)
    return Grid(*zip(*(steps(linkage, text) for text in choice.vary), strict=True))


def described(request: SweepRequest, conditions: str, command: str) -> dict[str, str | int]:
    """What a sweep's dataset says of itself."""
    return {
        "mechanism": request.linkage.name,
        "variant": request.linkage.variant,
        "conditions": conditions,
        "angles": len(request.motion.places),
        "refined": int(request.refine),
        "command": command,
    }


def _worked(choice: SweepChoice, destination: Destination, request: SweepRequest, saved: SavedSweep | None) -> Summary:
    """Work the space through, or what is left of it, here or on the workers of a scheduler."""
    with opened(choice.scheduler, None) as pool:
        return _worked_in(pool, choice, destination, request, saved)


def _worked_in(
    pool: Pool | None, choice: SweepChoice, destination: Destination, request: SweepRequest, saved: SavedSweep | None
) -> Summary:
    done: set[int] = set()
    begun = Summary(request)
    if saved is not None:
        saved.check(choice.command)
        done = saved.begin(_journal(saved.folder, request, choice, resume=destination.resume))
        for number in sorted(done):
            begun.add(request.blocks[number], saved.read(number))
    with interruptible(destination.folder, "designs") as counting, destination.progress() as announce:
        heard = counting(announce)
        found = sweep(
            request if pool is None else replace(request, cores=1),
            pool=pool,
            keep=saved.keep if saved else lambda *_: None,
            done=done,
            begun=begun,
            announce=lambda number: heard("designs", number, request.space.count),
        )
    if not found.assembled:
        if saved is not None:
            saved.forget()
        raise LinkproofError(
            f"expected designs that assemble, got none of {found.designs}, for {why_not(request)}; vary other ranges"
        )
    return found


def _journal(folder: Path, request: SweepRequest, choice: SweepChoice, *, resume: bool) -> Journal:
    files = {}
    if choice.table is not None:
        with choice.table.open("rb") as table:
            files[str(choice.table)] = hashlib.file_digest(table, "sha256").hexdigest()
    return journal(folder, choice.command, linkages=[request.linkage], files=files, resume=resume)


def _write_rows(place: str | None, saved: SavedSweep) -> None:
    """Write the designs as CSV, if requested."""

    def write(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as stream:
            stream.writelines(csv_rows(saved))

    if place == STDOUT:
        for text in csv_rows(saved):
            write_out(text)
    elif place is not None:
        write_file(Path(place), write)


def _write_pictures(choice: SweepChoice, destination: Destination, saved: SavedSweep, found: SweepSummary) -> None:
    """Write the picture if requested, and into the folder if not ``quiet``."""
    places = [] if choice.svg is None else [choice.svg]
    if destination.folder is not None:
        picture = destination.folder / PICTURE
        picture.unlink(missing_ok=True)  # that of an earlier sweep
        places += [] if destination.quiet else [str(picture)]
    if places:
        from reports.designs.sweep.sweep_picture import sweep_svg  # noqa: PLC0415 - a second that nothing else pays for

        text = sweep_svg(saved.dataset(), found.own_parameters, found.summary.extremes)
        for place in places:
            write_out(text) if place == STDOUT else write_text(Path(place), text)
