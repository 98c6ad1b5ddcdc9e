"""``linkproof sweep``, ``optimise`` and ``tolerance``: many designs of a linkage, the best one, what tolerances do."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from analytic.description.changes import SPEED
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.designer.optimisation import Optimum
from comparisons.designer.parameters import design_file, speed_unit
from comparisons.designer.sweep import SweepStudy, reason_not_assembled
from comparisons.designer.sweep import sweep as sweep_space
from comparisons.designer.tolerances import ToleranceStudy, read_tolerances, tolerance_study
from comparisons.trials.runs.store import to_json
from reports.command_line.destination import Content, Destination, Writers, picture_writers
from reports.designs import optimise_terminal, sweep_terminal, tolerance_terminal
from reports.requests.designs import build_tolerance_request, find_optimum, sweep_request
from reports.requests.options import CompareOptions, OptimiseOptions, SweepOptions, ToleranceOptions, command_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _sweep_csv(study: SweepStudy, command: str) -> Content:
    return partial(sweep_terminal.write_csv, study)


def _sweep_json(study: SweepStudy, command: str) -> str:
    return to_json(sweep_terminal.document(study))


def _sweep_figure(study: SweepStudy, command: str) -> Figure:
    from reports.designs.sweep_picture import sweep_figure  # noqa: PLC0415 - a second that other calls save

    ends = [study.extreme(figure, way) for figure in range(len(study.values)) for way in (-1.0, 1.0)]
    always = {design for design in ends if design is not None}
    return sweep_figure(study.dataset, sweep_terminal.own_parameters(study.request), always)


SWEEP_WRITERS: Final[Writers] = {
    ".csv": _sweep_csv,
    ".json": _sweep_json,
    ".nc": sweep_terminal.netcdf,
    **picture_writers(_sweep_figure),
}


def sweep(options: SweepOptions, destination: Destination) -> None:
    """Compute a space of designs, print its summary and write the requested files."""
    table = {} if options.table is None else {"the table": options.table}
    destination.check_saves(SWEEP_WRITERS, {"the linkage's file": Path(options.mechanism), **table})
    request = sweep_request(load(options.mechanism, options.variant), options)
    with destination.progress() as announce:
        study = sweep_space(request, announce)
    if not np.any(study.assembles):
        raise LinkproofError(
            f"expected designs that assemble, got none of {request.space.count}, for "
            f"{reason_not_assembled(request)}; vary other ranges"
        )
    destination.warn([request.linkage], *request.warnings)
    destination.write_saves(SWEEP_WRITERS, study, command_line("sweep", options))
    destination.write_json(sweep_terminal.document(study))
    destination.print(*([sweep_terminal.sentence(study)] if destination.quiet else sweep_terminal.parts(study)))


LINKAGE_FILE: Final = ".toml"


def _optimise_linkage(best: Optimum, conditions: str, command: str) -> str:
    return design_file(best.problem.mechanism, best.written)


def _optimise_figure(best: Optimum, conditions: str, command: str) -> Figure:
    from reports.charts.draw import figure  # noqa: PLC0415 - half a second that other calls save

    return figure(optimise_terminal.before_after_chart(best, conditions))


def _optimise_json(best: Optimum, conditions: str, command: str) -> str:
    return to_json(optimise_terminal.document(best, command, conditions))


OPTIMISE_WRITERS: Final[Writers] = {
    LINKAGE_FILE: _optimise_linkage,
    ".json": _optimise_json,
    **picture_writers(_optimise_figure),
}


def optimise(options: OptimiseOptions, destination: Destination) -> None:
    """Find the best design, write the requested files, print the tables."""
    destination.check_saves(OPTIMISE_WRITERS, {"the linkage's file": Path(options.mechanism)})
    linkage = load(options.mechanism, options.variant)
    with destination.progress() as announce:
        best, conditions = find_optimum(linkage, options, announce)
    command = command_line("optimise", options)
    destination.warn([linkage], *best.warnings)
    destination.write_saves(OPTIMISE_WRITERS, best, conditions, command)
    destination.write_json(optimise_terminal.document(best, command, conditions))
    destination.print(
        *([optimise_terminal.closing(best)] if destination.quiet else optimise_terminal.printed(best, conditions))
    )
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


def _tolerance_figure(study: ToleranceStudy) -> Figure:
    from reports.charts.draw import figure  # noqa: PLC0415 - half a second that other calls save

    return figure(tolerance_terminal.tornado_chart(study))


def _tolerance_json(study: ToleranceStudy) -> str:
    return to_json(tolerance_terminal.document(study))


TOLERANCE_WRITERS: Final[Writers] = {
    ".csv": tolerance_terminal.csv_table,
    ".json": _tolerance_json,
    **picture_writers(_tolerance_figure),
}


def tolerance(options: ToleranceOptions, destination: Destination) -> None:
    """Compute the effects of tolerances, print the tables and write the requested files."""
    destination.check_saves(
        TOLERANCE_WRITERS, {"the linkage's file": Path(options.mechanism), "the tolerances": options.tolerances}
    )
    linkage = load(options.mechanism, options.variant)
    request = build_tolerance_request(linkage, read_tolerances(options.tolerances), options)
    with destination.progress() as announce:
        study = tolerance_study(request, announce)
    destination.warn([linkage], request.at_open_end.sentence)
    destination.write_saves(TOLERANCE_WRITERS, study)
    destination.write_json(tolerance_terminal.document(study))
    destination.print_out(tolerance_terminal.printout(study))
