"""What ``linkproof tolerance`` does: which number of a linkage moves which result by how much."""

from __future__ import annotations

from pathlib import Path

from analytic.description.loading import load
from comparisons.designs.tolerance.tolerance_study import ToleranceStudy, tolerance_study
from comparisons.designs.tolerance.tolerances import read_tolerances
from comparisons.runs.study_folder import to_json
from reports.command_line.destination import STDOUT, check_files, files_of, write_files
from reports.command_line.progress import progress
from reports.designs.tolerance.tolerance_files import csv_table, document
from reports.designs.tolerance.tolerance_terminal import printout
from reports.document.terminal import show
from reports.requests.options.designs import ToleranceFiles, ToleranceOptions
from reports.requests.steady import check_steady
from reports.requests.tolerance import tolerance_request_of


def tolerance(options: ToleranceOptions, files: ToleranceFiles, *, quiet: bool = False) -> None:
    """Work the tolerances through, print the tables and write the requested files."""
    check_steady(options)
    named = files_of(files)
    check_files(named, {"the linkage's file": Path(options.mechanism), "the tolerances": options.tolerances})
    linkage = load(options.mechanism, options.variant)
    request = tolerance_request_of(linkage, read_tolerances(options.tolerances), options)
    with progress(visible=not quiet) as announce:
        study = tolerance_study(request, announce)
    write_files({file: _content(option, study) for option, file in named.items()})
    if STDOUT not in named.values():
        printed = printout(study)
        show(*([] if quiet else printed.tables), *printed.closing)


def _content(option: str, study: ToleranceStudy) -> str:
    """The text of a file."""
    if option == "--json":
        return to_json(document(study))
    if option == "--csv":
        return csv_table(study)
    from reports.charts.draw import svg  # noqa: PLC0415 - half a second that nothing else pays for
    from reports.designs.tolerance.tornado_picture import tornado_figure  # noqa: PLC0415

    rows = range(len(study.request.figures))
    return svg(tornado_figure([study.tornado(row) for row in rows], study.request.conditions), page="white")
