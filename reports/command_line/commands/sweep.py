"""``linkproof sweep``: figures over a space of designs, summarised, and all of them in files."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.designs.sweep import SweepStudy, reason_not_assembled
from comparisons.designs.sweep import sweep as sweep_space
from comparisons.runs.study import to_json
from reports.command_line.destination import Content, Destination, Writers, picture_writers
from reports.designs.sweep_terminal import document, netcdf, own_parameters, parts, sentence, write_csv
from reports.requests.designs import sweep_request
from reports.requests.designs_options import SweepOptions
from reports.requests.options import command_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _csv(study: SweepStudy, command: str) -> Content:
    return partial(write_csv, study)


def _json(study: SweepStudy, command: str) -> str:
    return to_json(document(study))


def _figure(study: SweepStudy, command: str) -> Figure:
    from reports.designs.sweep_picture import sweep_figure  # noqa: PLC0415 - a second that other calls save

    ends = [study.extreme(figure, way) for figure in range(len(study.values)) for way in (-1.0, 1.0)]
    always = {design for design in ends if design is not None}
    return sweep_figure(study.dataset, own_parameters(study.request), always)


WRITERS: Final[Writers] = {".csv": _csv, ".json": _json, ".nc": netcdf, **picture_writers(_figure)}


def sweep(options: SweepOptions, destination: Destination) -> None:
    """Compute a space of designs, print its summary and write the requested files."""
    table = {} if options.table is None else {"the table": options.table}
    destination.check_saves(WRITERS, {"the linkage's file": Path(options.mechanism), **table})
    request = sweep_request(load(options.mechanism, options.variant), options)
    with destination.progress() as announce:
        study = sweep_space(request, announce)
    if not np.any(study.assembles):
        raise LinkproofError(
            f"expected designs that assemble, got none of {request.space.count}, for "
            f"{reason_not_assembled(request)}; vary other ranges"
        )
    destination.write_saves(WRITERS, study, command_line("sweep", options))
    destination.write_json(document(study))
    destination.print(*([sentence(study)] if destination.quiet else parts(study)))
