"""``linkproof results``: the closed form of a linkage over a motion, for its designer."""

from __future__ import annotations

import webbrowser
from pathlib import Path

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.datasheet.building import page_sheet, sheet
from comparisons.datasheet.linkage_warnings import check_slips
from comparisons.datasheet.saved import FILE, load_sheets, save_sheets
from comparisons.datasheet.sheet import Sheet
from comparisons.runs.files import check_writable, claim
from reports.command_line.destination import STDOUT, check_files, requested_files, write_files
from reports.designs.results_terminal import csv_table, json_text, printed
from reports.document.terminal import show
from reports.requests.case import requested_results
from reports.requests.motion_options import ResultsFiles, ResultsOptions

PAGE = "index.html"
PICTURES = ("--svg", "--png", "--pdf")


def results(
    options: ResultsOptions, files: ResultsFiles, *, opens: bool = False, strict: bool = False, quiet: bool = False
) -> None:
    """Print the key figures of a linkage, or its signals at chosen instants, and write the requested files.

    A browser ``opens`` the page of a folder. With ``strict`` a likely mistake is refused.
    """
    named = requested_files(files)
    _check(files, named, opens=opens)
    check_files(named, {"the linkage's file": Path(options.mechanism)})
    linkage = load(options.mechanism, options.variant)
    if strict:
        check_slips(linkage)
    case, chosen = requested_results(linkage, options)
    result = sheet(case, chosen, every_peak=files.json is not None)
    drawn = result
    if files.out is not None or {*PICTURES} & {*named}:
        drawn = page_sheet(case, tuple(case.mechanism.linkage.released) if files.out is not None else ())
    write_files(
        {file: _file_content(option, drawn if option in PICTURES else result, files) for option, file in named.items()}
    )
    if files.out is not None:
        _write_page(files.out, drawn, opens=opens, quiet=quiet)
    if STDOUT not in named.values() and not quiet:
        show(*printed(result))


def _check(files: ResultsFiles, named: dict[str, str], *, opens: bool) -> None:
    """Raise LinkproofError for options of files that do not go together."""
    if files.decimal not in {".", ","}:
        raise LinkproofError(f"--decimal: expected . or , in the numbers of --csv, got '{files.decimal}'; correct it")
    if files.decimal == "," and files.csv is None:
        raise LinkproofError("--decimal belongs to the table of --csv, and none is written: name a file with --csv")
    if files.figure is not None and not {*PICTURES} & {*named}:
        raise LinkproofError(f"--figure {files.figure} needs a file: name one with --svg, --png or --pdf")
    if opens and files.out is None:
        raise LinkproofError("--open shows the page that --out writes: name a folder with --out")
    if files.out is not None:
        check_writable(files.out / PAGE)


def _write_page(out: Path, sheet: Sheet, *, opens: bool, quiet: bool) -> None:
    """Save a data sheet among those of a report's folder, and write the report's pages."""
    from reports.site.site import Contents, write_site  # noqa: PLC0415  figures cost a second

    _claimed = claim(out)  # until the pages are written
    sheets = load_sheets(out) if (out / FILE).is_file() else ()
    others = [other for other in sheets if (other.name, other.variant) != (sheet.name, sheet.variant)]
    save_sheets(out, [*others, sheet])
    write_site(out, processes=0)
    page = out / Contents(out).file_of(sheet)
    if not quiet:
        show(f"page: {page}", stderr=True)
    if opens:
        webbrowser.open(page.resolve().as_uri())


def _file_content(option: str, result: Sheet, files: ResultsFiles) -> str | bytes:
    """The content of the file of an option; its writer is imported here, which takes half a second or more."""
    if option == "--xlsx":
        from reports.designs.results_workbook import workbook  # noqa: PLC0415

        return workbook(result)
    if option == "--gif":
        from reports.designs.results_drawing import gif  # noqa: PLC0415

        return gif(result)
    if option == "--dxf":
        from reports.designs.results_dxf import dxf  # noqa: PLC0415

        return dxf(result)
    if option in PICTURES:
        from reports.designs.results_drawing import picture  # noqa: PLC0415

        return picture(result, option.removeprefix("--"), files.figure)
    return csv_table(result, files.decimal) if option == "--csv" else json_text(result)
