"""``linkproof results``: the closed form of a linkage over a motion, for its designer."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Final

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.designer.building import page_sheet, sheet
from comparisons.designer.linkage_check import check_slips
from comparisons.designer.sheet import Sheet
from comparisons.motion.case import Case
from comparisons.trials.campaign.saved_linkages import save_case
from comparisons.trials.runs.files import claim
from reports.command_line.destination import PICTURES, Destination, Writers, picture_writers, write_to_stdout
from reports.designs.results_terminal import csv_table, json_text, printed
from reports.document.terminal import show
from reports.mechanism.shown import warning_texts
from reports.requests.motions import requested_results
from reports.requests.options import ResultsFiles, ResultsOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = "index.html"


def results(
    options: ResultsOptions,
    files: ResultsFiles,
    destination: Destination,
    *,
    opens: bool = False,
    strict: bool = False,
) -> None:
    """Print the key figures of a linkage, or its signals at chosen instants, and write the requested files.

    A browser ``opens`` the page of a folder. With ``strict`` a likely mistake is refused.
    """
    _check(files, destination, opens=opens)
    destination.check_saves(WRITERS, {"the linkage's file": Path(options.mechanism)})
    linkage, out = load(options.mechanism, options.variant), destination.out
    if strict:
        check_slips(linkage)
    case, chosen = requested_results(linkage, options)
    result = sheet(case, chosen, every_peak=destination.json or destination.saves(".json"))
    destination.warn((), *warning_texts(result))
    drawn = page_sheet(case) if destination.saves(*PICTURES) else result
    destination.write_saves(WRITERS, result, drawn, files)
    if out is not None:
        _write_page(out, case, opens=opens, quiet=destination.quiet)
    if destination.json:
        write_to_stdout(json_text(result))
    elif not destination.quiet:
        show(*printed(result))


def _check(files: ResultsFiles, destination: Destination, *, opens: bool) -> None:
    """Raise LinkproofError for options of files that do not go together."""
    if files.decimal not in {".", ","}:
        raise LinkproofError(f"--decimal: expected . or , in the numbers of a .csv, got '{files.decimal}'; correct it")
    if files.decimal == "," and not destination.saves(".csv"):
        raise LinkproofError("--decimal belongs to a table, and none is written: name a file with --save FILE.csv")
    if files.figure is not None and not destination.saves(*PICTURES):
        raise LinkproofError("--figure needs a file: name a .svg, .png or .pdf with --save")
    if opens and destination.out is None:
        raise LinkproofError("--open shows the page that --out writes: name a folder with --out")
    destination.check(PAGE)


def _write_page(out: Path, case: Case, *, opens: bool, quiet: bool) -> None:
    """Save a case among those of a report's folder, and write the report's pages."""
    from reports.mechanism.page import file_of  # noqa: PLC0415  figures cost a second
    from reports.site import write_site  # noqa: PLC0415

    _claimed = claim(out)  # until the pages are written
    save_case(out, case)
    index, page = write_site(out, processes=0), out / file_of(case.mechanism.linkage)
    page = page if page.is_file() else index  # the only one
    if not quiet:
        show(f"page: {page}", stderr=True)
    if opens:
        webbrowser.open(page.resolve().as_uri())


# The writers of the files: each is called with the results, the results of a page, and the form of the files.


def _csv(result: Sheet, _drawn: Sheet, files: ResultsFiles) -> str:
    return csv_table(result, files.decimal)


def _json(result: Sheet, *_: object) -> str:
    return json_text(result)


def _workbook(result: Sheet, *_: object) -> bytes:
    from reports.designs.results_workbook import workbook  # noqa: PLC0415 - half a second that other files save

    return workbook(result)


def _figure(_result: Sheet, drawn: Sheet, files: ResultsFiles) -> Figure:
    from reports.designs.results_drawing import results_figure  # noqa: PLC0415 - a second that other files save

    return results_figure(drawn, files.figure)


def _dxf(result: Sheet, *_: object) -> str:
    from reports.designs.results_dxf import dxf  # noqa: PLC0415 - half a second that other files save

    assert result.positions is not None
    return dxf(result.linkage, result.positions, None if result.chosen is None else float(result.chosen["phi"][0]))


WRITERS: Final[Writers] = {
    ".csv": _csv, ".json": _json, ".xlsx": _workbook, **picture_writers(_figure), ".dxf": _dxf,
}  # fmt: skip
