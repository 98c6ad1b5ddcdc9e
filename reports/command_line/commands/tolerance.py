"""``linkproof tolerance``: the change of each result with each toleranced number of a linkage."""

from __future__ import annotations

from pathlib import Path

from analytic.description.loading import load
from comparisons.designs.tolerance_study import ToleranceStudy, tolerance_study
from comparisons.designs.tolerances import read_tolerances
from comparisons.runs.study_folder import to_json
from reports.command_line.destination import (
    STDOUT,
    check_files,
    progress,
    requested_files,
    write_files,
    write_to_stdout,
)
from reports.designs.tolerance_terminal import csv_table, document, printout, tornado_chart
from reports.document.terminal import show
from reports.requests.case import check_steady
from reports.requests.designs import build_tolerance_request
from reports.requests.designs_options import ToleranceFiles, ToleranceOptions


def tolerance(options: ToleranceOptions, files: ToleranceFiles, *, quiet: bool = False) -> None:
    """Compute the effects of tolerances, print the tables and write the requested files."""
    check_steady(options)
    named = requested_files(files)
    check_files(named, {"the linkage's file": Path(options.mechanism), "the tolerances": options.tolerances})
    linkage = load(options.mechanism, options.variant)
    request = build_tolerance_request(linkage, read_tolerances(options.tolerances), options)
    with progress(visible=not quiet) as announce:
        study = tolerance_study(request, announce)
    write_files({file: _file_content(option, study) for option, file in named.items()})
    if files.json:
        write_to_stdout(to_json(document(study)))
    elif STDOUT not in named.values():
        printed = printout(study)
        show(*([] if quiet else printed.tables), *printed.closing)


def _file_content(option: str, study: ToleranceStudy) -> str:
    """The text of a file."""
    if option == "--csv":
        return csv_table(study)
    from reports.charts import draw  # noqa: PLC0415 - half a second that other calls save

    return draw.svg(draw.figure(tornado_chart(study)), page="white")
