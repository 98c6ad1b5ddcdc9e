"""``linkproof tolerance``: the change of each result with each toleranced number of a linkage."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from analytic.description.loading import load
from comparisons.designs.tolerances import ToleranceStudy, read_tolerances, tolerance_study
from comparisons.runs.study import to_json
from reports.command_line.destination import Destination, Writers, picture_writers
from reports.designs.tolerance_terminal import csv_table, document, printout, tornado_chart
from reports.requests.designs import build_tolerance_request
from reports.requests.designs_options import ToleranceOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _figure(study: ToleranceStudy) -> Figure:
    from reports.charts.draw import figure  # noqa: PLC0415 - half a second that other calls save

    return figure(tornado_chart(study))


def _json(study: ToleranceStudy) -> str:
    return to_json(document(study))


WRITERS: Final[Writers] = {".csv": csv_table, ".json": _json, **picture_writers(_figure)}


def tolerance(options: ToleranceOptions, destination: Destination) -> None:
    """Compute the effects of tolerances, print the tables and write the requested files."""
    destination.check_saves(
        WRITERS, {"the linkage's file": Path(options.mechanism), "the tolerances": options.tolerances}
    )
    linkage = load(options.mechanism, options.variant)
    request = build_tolerance_request(linkage, read_tolerances(options.tolerances), options)
    with destination.progress() as announce:
        study = tolerance_study(request, announce)
    destination.write_saves(WRITERS, study)
    destination.write_json(document(study))
    destination.print_out(printout(study))
