"""What ``linkproof optimise`` does: the best of a linkage's designs, a file of it, and its check in an engine."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from analytic import signals
from analytic.description.changes import SPEED
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.signals import MAGNITUDE
from comparisons.datasheet.units import file_unit
from comparisons.designs.design_file import design_file
from comparisons.designs.optimum.optimisation import Optimum, Wish, optimise
from comparisons.designs.parameters import mass_words, speed_unit
from comparisons.judging.records import to_json
from comparisons.runs.files import write_text
from reports.command_line import PASSED
from reports.command_line.destination import Destination
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.requests import RunLimits, command_line, named
from reports.command_line.steady_choice import SteadyChoice, steady_case
from reports.designs.optimum.optimise_terminal import aim, closing, document, printed

JSON = "optimise.json"
CURVES = "before-after.svg"


@dataclass(frozen=True, kw_only=True)
class OptimiseChoice(SteadyChoice):
    """The request, in the user's words; ``simulate`` are engines."""

    wish: Wish
    refine: bool = True
    simulate: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The command that asks for the same."""
        options: dict[str, Sequence[str]] = {
            "minimise" if self.wish.is_least else "maximise": [self.wish.figure],
            "over": self.wish.over,
            "keep": self.wish.keep,
            **self.words,
            "starts": [str(self.wish.starts)] if self.wish.starts > 1 else [],
            "seed": [str(self.wish.seed)] if self.wish.seed else [],
            "round": [self.wish.step] if self.wish.step else [],
            "simulate": self.simulate,
        }
        flags = {**super().flags, "refine": False, "global": self.wish.everywhere}
        return command_line("optimise", [self.mechanism], options, flags)

    def check(self) -> None:
        """Raise LinkproofError for what cannot be, before anything is worked out."""
        super().check()
        self.wish.check()
        named(self.simulate)


def wish(
    minimise: str | None, maximise: str | None, over: Sequence[str], keep: Sequence[str], how: Mapping[str, Any]
) -> Wish:
    """The request; ``how`` are further fields of a Wish. Raises LinkproofError unless one figure is to be optimised."""
    if (minimise is None) == (maximise is None):
        got = "neither" if minimise is None else "both"
        raise LinkproofError(f"expected --minimise FIGURE or --maximise FIGURE, got {got}; give one, such as Mkr.peak")
    return Wish(minimise or maximise or "", tuple(over), tuple(keep), is_least=minimise is not None, **how)


def optimum(linkage: Linkage, choice: OptimiseChoice, destination: Destination) -> tuple[Optimum, str]:
    """The best design, and the conditions in words."""
    mechanism, motion, conditions = steady_case(linkage, choice)
    with destination.progress() as announce:
        found = optimise(mechanism, motion, choice.wish, announce)
    return found, conditions + mass_words(mechanism.linkage, found.after)


def run(choice: OptimiseChoice, destination: Destination, limits: RunLimits | None = None) -> int:
    """Look for the best design, write the requested files, print the tables; returns the exit code."""
    destination.check(JSON)
    choice.check()
    linkage = load(choice.mechanism, choice.variant)
    found, conditions = optimum(linkage, choice, destination)
    text = design_file(found.problem.mechanism, found.after)
    name = f"{linkage.name}-optimised.toml"
    saved = document(found, choice.command, conditions)
    destination.write_json(saved)
    tables = printed(found, conditions)
    wrote = []
    if destination.folder is not None:
        write_text(destination.folder / name, text)
        write_text(destination.folder / JSON, to_json(saved))
        write_text(destination.folder / CURVES, _picture(found, conditions))
        wrote.append(f"Written: {destination.folder / name}, {JSON}, {CURVES}.")
    if SPEED in found.after:
        unit = speed_unit(linkage)
        speed = math.copysign(float(f"{found.after[SPEED] / unit.size:.15g}"), choice.rpm)
        choice = replace(choice, speed=speed)
        wrote.append(f"It is the best design at {abs(speed):.6g} {unit.name}: a linkage file has no speed.")
    destination.print(*([closing(found)] if destination.quiet else tables), *wrote)
    if not choice.simulate:
        where = str(destination.folder / name) if destination.folder else f"DIR/{name}"
        moved = MotionChoice(**choice.of_written_file)
        first = "" if destination.folder else "--out DIR writes the new file; "
        destination.say(
            f"To check it in an engine: {first}{command_line('compare', [where], moved.words, moved.flags)}"
        )
        return PASSED
    return _simulate(choice, destination, name, text, limits)


def _picture(found: Optimum, conditions: str) -> str:
    """The curves before and after."""
    from reports.charts.draw import svg  # noqa: PLC0415 - half a second that nothing else pays for
    from reports.designs.optimum.before_after_picture import Change, before_after_figure  # noqa: PLC0415

    linkage, grid = found.problem.mechanism.linkage, found.problem.tops.grid
    places = grid / file_unit("m", linkage).size if linkage.is_linear else np.degrees(grid)
    changes = {}
    for name, (before, after) in found.curves().items():
        unit = file_unit(signals.unit(name, linkage), linkage)
        changes[name.removesuffix(MAGNITUDE)] = Change(places, before / unit.size, after / unit.size, unit.name)
    axis = f"travel of the drive, {file_unit('m', linkage).name}" if linkage.is_linear else "crank angle φ, °"
    return svg(before_after_figure(changes, aim(found), conditions, axis=axis), page="white")


def _simulate(choice: OptimiseChoice, destination: Destination, name: str, text: str, limits: RunLimits | None) -> int:
    """What the engines say of the new design, as ``linkproof compare`` does; its exit code."""
    from reports.command_line.commands.compare import compare  # noqa: PLC0415 - what no other call pays for
    from reports.command_line.requests import CampaignChoice  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as folder, destination.own_stdout():
        path = (destination.folder or Path(folder)) / name
        if destination.folder is None:
            write_text(path, text)
        asked = CampaignChoice((str(path),), engines=choice.simulate, **choice.of_written_file)
        return compare(asked, Destination(quiet=destination.quiet), limits)
