"""``linkproof optimise``: the best design of a linkage, and its file."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from analytic.description.changes import SPEED
from analytic.description.loading import load
from comparisons.designs.optimisation import Optimum
from comparisons.designs.parameters import design_file, speed_unit
from comparisons.runs.study import to_json
from reports.command_line.destination import Destination, Writers, picture_writers
from reports.designs.optimise_terminal import before_after_chart, closing, document, printed
from reports.requests.campaign_options import CompareOptions
from reports.requests.designs import find_optimum
from reports.requests.designs_options import OptimiseOptions
from reports.requests.options import command_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LINKAGE_FILE: Final = ".toml"


def _linkage(best: Optimum, conditions: str, command: str) -> str:
    return design_file(best.problem.mechanism, best.after)


def _figure(best: Optimum, conditions: str, command: str) -> Figure:
    from reports.charts.draw import figure  # noqa: PLC0415 - half a second that other calls save

    return figure(before_after_chart(best, conditions))


def _json(best: Optimum, conditions: str, command: str) -> str:
    return to_json(document(best, command, conditions))


WRITERS: Final[Writers] = {LINKAGE_FILE: _linkage, ".json": _json, **picture_writers(_figure)}


def optimise(options: OptimiseOptions, destination: Destination) -> None:
    """Find the best design, write the requested files, print the tables."""
    destination.check_saves(WRITERS, {"the linkage's file": Path(options.mechanism)})
    linkage = load(options.mechanism, options.variant)
    with destination.progress() as announce:
        best, conditions = find_optimum(linkage, options, announce)
    command = command_line("optimise", options)
    destination.write_saves(WRITERS, best, conditions, command)
    destination.write_json(document(best, command, conditions))
    destination.print(*([closing(best)] if destination.quiet else printed(best, conditions)))
    motion = replace(options.motion, variant=None)  # the new file has one variant
    if SPEED in best.after:
        unit = speed_unit(linkage)
        speed = math.copysign(float(f"{best.after[SPEED] / unit.size:.15g}"), options.rpm)
        motion = replace(motion, speed=speed)
        destination.print(f"It is the best design at {abs(speed):.6g} {unit.name}: a linkage file has no speed.")
    saved = next((str(file) for file in destination.save if file.suffix.lower() == LINKAGE_FILE), None)
    first = "" if saved else "--save best.toml writes the new file; "
    new = CompareOptions(mechanisms=(saved or "best.toml",), **vars(motion))
    destination.remark(f"To check it in an engine: {first}{command_line('compare', new)}")
