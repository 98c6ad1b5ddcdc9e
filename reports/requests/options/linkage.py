"""The options of the commands about one linkage under one motion: results and judge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from reports.requests.options.declaring import Argument, Option
from reports.requests.options.motion import MotionOptions

DEFAULT_LIMIT = 0.01  # of the peak


@dataclass(frozen=True, kw_only=True)
class ResultsOptions(MotionOptions):
    """The motion and the instants of ``linkproof results``."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    at: Annotated[tuple[float, ...] | None, Option("Every signal at these crank angles: 0,30,60.", "DEGREES")] = None
    time: Annotated[tuple[float, ...] | None, Option("Every signal at these times: 0.1,0.2.", "SECONDS")] = None


@dataclass(frozen=True, kw_only=True)
class WatchOptions(ResultsOptions):
    """The motion of ``linkproof watch``, its ``port``, 0 for any free one, and whether it ``opens`` a browser."""

    port: Annotated[int, Option("Port of the local server; default: a free one.", "N")] = 0
    opens: Annotated[bool, Option("Open no browser, only print the address.", flags=("--no-open",))] = True


@dataclass(frozen=True, kw_only=True)
class ResultsFiles:
    """Files that ``linkproof results`` writes: "-" is stdout, without other output.

    ``decimal`` is the point or comma in the numbers of ``csv``, ``figure`` the single picture to draw instead of
    all. ``out`` is the folder of a report.
    """

    csv: Annotated[str | None, Option("Write every signal as a table, in the file's units.", "FILE|-")] = None
    decimal: Annotated[str, Option("Decimal mark of --csv; with a comma, semicolons between columns.", ".|,")] = "."
    xlsx: Annotated[str | None, Option("Write signals and key figures as a workbook.", "FILE")] = None
    json: Annotated[str | None, Option("Write JSON to a file; - is stdout.", "FILE|-")] = None
    svg: Annotated[str | None, Option("Draw scheme, coupler curves, torque, bearing forces.", "FILE|-")] = None
    png: Annotated[str | None, Option("The same as PNG, 300 dots to the inch.", "FILE")] = None
    pdf: Annotated[str | None, Option("The same as PDF.", "FILE")] = None
    gif: Annotated[str | None, Option("Draw the linkage in motion.", "FILE")] = None
    dxf: Annotated[
        str | None,
        Option("Draw the scheme for CAD, at the first instant of --at or --time, or as sketched.", "FILE|-"),
    ] = None
    figure: Annotated[
        str | None,
        Option(
            "Draw one figure alone, as wide as a paper's column: scheme, curves, torque, power, energy, inertia, "
            "output, forces, transmission.",
            "NAME",
        ),
    ] = None
    out: Annotated[Path | None, Option("Write a page with the linkage in motion into this folder.", "DIR")] = None


@dataclass(frozen=True, kw_only=True)
class JudgeOptions(MotionOptions):
    """The results for ``linkproof judge``; ``limit`` is a share of the peak."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    results: Annotated[tuple[Path, ...], Argument("RESULTS", is_required=True)] = ()
    mapping: Annotated[Path | None, Option("The meaning of each column, and accepted corrections.", "FILE")] = None
    limit: Annotated[float, Option("Largest error allowed, as a share of the closed form's peak.", "SHARE")] = (
        DEFAULT_LIMIT
    )


@dataclass(frozen=True, kw_only=True)
class JudgeFiles:
    """Files that ``linkproof judge`` writes, besides those of every command."""

    svg: Annotated[
        str | None, Option("Draw the worst curves, the differences and what the cause leaves.", "FILE|-")
    ] = None
