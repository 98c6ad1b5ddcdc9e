"""``linkproof optimise``: the best design of a linkage, its file, and its check in an engine."""

from __future__ import annotations

import math
import tempfile
from dataclasses import replace
from pathlib import Path

from analytic.description.changes import SPEED
from analytic.description.loading import load
from comparisons.designs.parameters import design_file, speed_unit
from comparisons.runs.files import write_text
from comparisons.runs.study_folder import to_json
from reports.command_line.destination import Destination
from reports.designs.optimise_terminal import before_after_chart, closing, document, printed
from reports.requests import PASSED
from reports.requests.campaign_options import CompareOptions
from reports.requests.designs import find_optimum
from reports.requests.designs_options import OptimiseOptions
from reports.requests.motion_options import MotionOptions
from reports.requests.options import command_line

JSON = "optimise.json"
CURVES = "before-after.svg"


def optimise(options: OptimiseOptions, destination: Destination) -> int:
    """Find the best design, write the requested files, print the tables; returns the exit code."""
    destination.check(JSON)
    linkage = load(options.mechanism, options.variant)
    with destination.progress() as announce:
        best, conditions = find_optimum(linkage, options, announce)
    text = design_file(best.problem.mechanism, best.after)
    name, folder = f"{linkage.name}-optimised.toml", destination.out
    saved = document(best, command_line("optimise", options), conditions)
    destination.write_json(saved)
    tables, wrote = printed(best, conditions), []
    if folder is not None:
        from reports.charts import draw  # noqa: PLC0415 - half a second that other calls save

        write_text(folder / name, text)
        write_text(folder / JSON, to_json(saved))
        write_text(folder / CURVES, draw.svg(draw.figure(before_after_chart(best, conditions)), page="white"))
        wrote.append(f"Written: {folder / name}, {JSON}, {CURVES}.")
    motion = replace(options.motion, variant=None)  # the new file has one variant
    if SPEED in best.after:
        unit = speed_unit(linkage)
        speed = math.copysign(float(f"{best.after[SPEED] / unit.size:.15g}"), options.rpm)
        motion = replace(motion, speed=speed)
        wrote.append(f"It is the best design at {abs(speed):.6g} {unit.name}: a linkage file has no speed.")
    destination.print(*([closing(best)] if destination.quiet else tables), *wrote)
    if options.simulate:
        return _simulate(options.simulate, motion, destination, name, text)
    new = CompareOptions(mechanisms=(str(folder / name) if folder else f"DIR/{name}",), **vars(motion))
    first = "" if folder else "--out DIR writes the new file; "
    destination.remark(f"To check it in an engine: {first}{command_line('compare', new)}")
    return PASSED


def _simulate(engines: tuple[str, ...], motion: MotionOptions, destination: Destination, name: str, text: str) -> int:
    """Compare the new design in engines, as ``linkproof compare`` does; returns its exit code."""
    from reports.command_line.commands.compare import compare  # noqa: PLC0415 - a second that other calls save

    with tempfile.TemporaryDirectory() as folder, destination.own_stdout():
        path = (destination.out or Path(folder)) / name
        if destination.out is None:
            write_text(path, text)
        wanted = CompareOptions(mechanisms=(str(path),), engine=engines, **vars(motion))
        return compare(wanted, Destination(quiet=destination.quiet))
