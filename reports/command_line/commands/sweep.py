"""What ``linkproof sweep`` does: figures over a space of designs, summed up, and written as they come."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import reduce
from pathlib import Path
from typing import Final

from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.named_figures import named_figures
from comparisons.designs.sweep.saved_sweep import SavedSweep
from comparisons.designs.sweep.space import DesignSpace, Grid, steps
from comparisons.designs.sweep.sweep import Summary, SweepRequest, own_figures, sweep, usual_figures, why_not
from comparisons.designs.sweep.sweep_file import FILE, SweepFile, saved_sweep
from comparisons.designs.sweep.table import TableFile, table_file
from comparisons.runs.cluster.connecting import opened
from comparisons.runs.files import write_file, write_text
from comparisons.runs.journal import Journal
from comparisons.runs.workers import Pool
from reports.command_line.commands.trust_choice import NOTHING, TrustChoice, Trusted
from reports.command_line.destination import STDOUT, Destination, check_files, write_out
from reports.command_line.interruption import interruptible, journal
from reports.command_line.requests import RunLimits, command_line
from reports.command_line.steady_choice import SteadyChoice, steady_case
from reports.designs.sweep.sweep_table import csv_rows
from reports.designs.sweep.sweep_terminal import SweepSummary
from reports.document.terminal import Printout

PICTURE: Final = "sweep.svg"
DRAWN: Final = 10**6  # designs of which a picture is drawn without being asked for, in half a second or so


@dataclass(frozen=True, kw_only=True)
class SweepChoice(SteadyChoice):
    """What was asked for, in the user's words; ``csv``, ``json`` and ``svg`` are files, or "-" for stdout."""

    vary: tuple[str, ...] = ()
    table: Path | None = None
    quantities: tuple[str, ...] = ()
    csv: str | None = None
    json: str | None = None
    svg: str | None = None
    jobs: int | None = None
    trial: TrustChoice = field(default_factory=TrustChoice)
    scheduler: str | None = None

    @property
    def files(self) -> dict[str, str]:
        """Files to be written, by option."""
        named = {"--csv": self.csv, "--json": self.json, "--svg": self.svg}
        return {option: file for option, file in named.items() if file is not None}

    @property
    def command(self) -> str:
        """The command that asks for the same figures."""
        return self._written({})

    @property
    def trial_command(self) -> str:
        """The command that tries engines on the same designs."""
        return self._written(self.trial.words)

    def _written(self, more: Mapping[str, Sequence[str]]) -> str:
        table = [] if self.table is None else [str(self.table)]
        options = {"vary": self.vary, "table": table, "quantity": self.quantities, **self.words, **more}
        return command_line("sweep", [self.mechanism], options, self.flags)

    def check(self) -> None:
        """Raise LinkproofError for what cannot be, before anything is worked out."""
        super().check()
        self.trial.check()
        if bool(self.vary) == (self.table is not None):
            got = "both" if self.vary else "neither"
            raise LinkproofError(f"expected designs by --vary NAME=FIRST:LAST:COUNT or by --table FILE, got {got}: "
                                 "give one of the two")  # fmt: skip
        if self.jobs is not None and self.jobs < 1:
            raise LinkproofError(f"--jobs: expected 1 or more cores, got {self.jobs}; correct it")
        RunLimits(jobs=self.jobs, scheduler=self.scheduler).check()
        read = {"the linkage's file": Path(self.mechanism)}
        check_files(self.files, read if self.table is None else {**read, "the table": self.table})


def run(choice: SweepChoice, destination: Destination) -> int:
    """Work a space through, print its summary and write the files asked for; returns the exit code."""
    destination.check(FILE)
    destination.check(PICTURE)
    choice.check()
    request, conditions = sweep_request(load(choice.mechanism, choice.variant), choice)
    own = own_figures(request)
    with ExitStack() as stack:
        folder = destination.folder
        if folder is None and (choice.csv or choice.svg):
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="linkproof-")))
        about = described(request, conditions, choice.command)
        saved = None if folder is None else SavedSweep(request, folder, about)
        found = SweepSummary(request, own, _worked(choice, destination, request, saved), conditions)
        if saved is not None:
            _write_rows(choice.csv, saved.file)
            _write_pictures(choice, destination, saved.file, found.own_parameters)
        try:
            trusted = _simulated(choice, destination, request)
        except LinkproofError:  # the figures are there all the same
            if saved is not None:
                saved.finish()
            raise
        if saved is not None:
            saved.finish()
    destination.write_json(found.document)
    if STDOUT not in choice.files.values():
        there = [destination.folder / name for name in (FILE, PICTURE)] if destination.folder else []
        wrote = [f"wrote {path}" for path in there if path.exists()]
        closing = [found.sentence, *wrote] if destination.quiet else wrote
        destination.print_out(
            Printout([*found.parts, "", *trusted.printout.tables], [*trusted.printout.closing, *closing])
        )
    return trusted.exit_code


def _simulated(choice: SweepChoice, destination: Destination, request: SweepRequest) -> Trusted:
    """A sample of the designs in the engines that are named; nothing where none is."""
    if not choice.trial.engines:
        return NOTHING
    from reports.command_line.commands.trust import simulate  # noqa: PLC0415 - engines cost time that figures do not

    limits = RunLimits(jobs=choice.jobs, scheduler=choice.scheduler)
    return simulate(
        Mechanism(request.linkage), request.space, choice.trial, choice,
        command=choice.trial_command, destination=destination, limits=limits,
    )  # fmt: skip


def sweep_request(linkage: Linkage, choice: SweepChoice) -> tuple[SweepRequest, str]:
    """What is asked for, and its conditions in words; raises LinkproofError for anything that is not there."""
    mechanism, motion, conditions = steady_case(linkage, choice)
    figures = named_figures(mechanism, choice.quantities) if choice.quantities else usual_figures(mechanism)
    if not figures:
        raise LinkproofError(f"expected a figure of '{linkage.name}', got none: name one with --quantity")
    space = designs_of(mechanism.linkage, choice)
    return SweepRequest(mechanism.linkage, space, figures, motion, choice.refine, choice.jobs).on_one_path(), conditions


def designs_of(linkage: Linkage, choice: SweepChoice) -> DesignSpace:
    """The grid of ``--vary``, or the list of ``--table``."""
    if choice.table is not None:
        return table_file(choice.table, linkage)
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
    done: dict[int, Summary] = {}
    if saved is not None:
        saved.check(choice.command)
        done = saved.begin(_journal(saved.folder, request, choice.command, resume=destination.resume))
        request = saved.request
    begun = reduce(Summary.plus, done.values(), Summary())
    with interruptible(destination.folder, "designs") as counting, destination.progress() as announce:
        heard = counting(announce)
        try:
            found = sweep(
                request if pool is None else replace(request, cores=1),
                pool=pool,
                keep=saved.keep if saved else lambda *_: None,
                done=done.keys(),
                begun=begun,
                announce=lambda number: heard("designs", number, request.space.count),
            )
        except LinkproofError:
            if saved is not None and not saved.holds_work:
                saved.forget()
            raise
    if not found.assembled:
        if saved is not None:
            saved.forget()
        raise LinkproofError(
            f"expected designs that assemble, got none of {found.designs}, for {why_not(request)}; vary other ranges"
        )
    return found


def _journal(folder: Path, request: SweepRequest, command: str, *, resume: bool) -> Journal:
    files = {str(request.space.path): request.space.digest} if isinstance(request.space, TableFile) else {}
    return journal(folder, command, linkages=[request.linkage], files=files, resume=resume)


def _write_rows(place: str | None, file: SweepFile) -> None:
    """Write the designs as CSV, where that is asked for."""

    def write(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as stream:
            stream.writelines(csv_rows(file))

    if place == STDOUT:
        for text in csv_rows(file):
            write_out(text)
    elif place is not None:
        write_file(Path(place), write)


def _write_pictures(choice: SweepChoice, destination: Destination, file: SweepFile, own: Mapping[str, float]) -> None:
    """Write the picture where it is asked for, and into the folder where it is cheap and not ``quiet``."""
    places = [] if choice.svg is None else [choice.svg]
    if destination.folder is not None:
        picture = destination.folder / PICTURE
        picture.unlink(missing_ok=True)  # that of an earlier sweep
        if not destination.quiet and file.request.space.count <= DRAWN:
            places.append(str(picture))
    if places:
        from reports.designs.sweep.sweep_picture import sweep_svg  # noqa: PLC0415 - a second that nothing else pays for

        with saved_sweep(file.path) as dataset:
            text = sweep_svg(dataset, own)
        for place in places:
            write_out(text) if place == STDOUT else write_text(Path(place), text)
