"""The commands about saved results: ``linkproof report | verify | diff | merge``.

They are added to the commands of ``app``; what they need is imported when they run.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from reports.command_line.app import Json, Quiet, app, destination
from reports.command_line.parameters import command
from reports.requests.options import Argument, Option, OutputOptions

Folder = Annotated[Path, Argument("DIR")]
WITHOUT_FOLDER = ("out", "junit", "resume")


@command(app, summary="Write the pages of saved results again, or the curves as CSV.")
def report(
    saved: Folder,
    out: Annotated[Path | None, Option("Where to write the pages; default: the same folder.", "DIR")] = None,
    single_file: Annotated[Path | None, Option("Write one page with everything in it, to mail.", "FILE")] = None,
    csv: Annotated[Path | None, Option("Write only the curves, a CSV file per run.", "DIR")] = None,
    png: Annotated[bool, Option("Write every figure as PNG beside its SVG.")] = False,
    show: Annotated[bool, Option("Open the report in the browser.", flags=("--open",))] = False,
) -> None:
    """Write the pages of saved results again; needs no engine.

    DIR is a folder that compare, bench, stress or judge wrote with --out, the curves.nc in it, or a merged folder.
    """
    from reports.command_line.commands import folders

    folders.report(saved, out, single_file, csv, opens=show, png=png)


@command(app, summary="Check a results folder from someone else.")
def verify(
    saved: Folder,
    limits: Annotated[Path | None, Option("Judge by these limits; default: those saved in DIR.", "FILE")] = None,
    json: Json = None,
    quiet: Quiet = False,
) -> int:
    """Check a results folder: texts, curves and records are compared with each other and the closed form.

    DIR is the folder that compare wrote with --out; no engine is needed.

    Exit codes: 0 nothing differs, whatever the verdicts, 1 something differs, 2 bad input.
    """
    from reports.command_line.commands import folders

    return folders.verify(saved, limits, destination(OutputOptions(json=json, quiet=quiet)))


@command(app, summary="Show the changes between two results folders.", without=WITHOUT_FOLDER)
def diff(before: Folder, after: Folder, output: OutputOptions) -> int:
    """Show the changes between two results folders: after an engine's upgrade, for two designs or variants.

    Each DIR is a folder that compare wrote with --out; name the earlier one first.

    Exit codes: 0 no change is beyond the limits; 1 a run newly fails, or in the same linkage an error has tripled or a
    key figure has changed; 2 bad input or nothing in common.
    """
    from reports.command_line.commands import folders

    return folders.diff(before, after, destination(output))


@command(app, summary="Join folders from several machines into one report.")
def merge(
    saved: Annotated[tuple[Path, ...], Argument("DIR", is_required=True)],
    out: Annotated[Path, Option("The new folder.", "DIR")],
) -> None:
    """Join folders from several machines into one report, grouped by hardware; nothing is ranked across machines.

    DIR is a folder that compare, bench or stress wrote with --out, or a merged folder.
    """
    from reports.command_line.commands import folders

    folders.merge(saved, out)
