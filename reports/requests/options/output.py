"""The files of a command's results, and the amount of its output."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from reports.requests.options.declaring import Option


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """``json`` is a file, or "-" for stdout, without other output; ``out`` is a folder for all files of a command.

    ``junit`` is a file of test cases for CI services. ``resume`` finishes an interrupted command whose results are in
    ``out``; ``quiet`` prints no progress and no tables, ``verbose`` adds every record's details.
    """

    out: Annotated[Path | None, Option("Write records, curves and pages into this folder.", "DIR")] = None
    json: Annotated[str | None, Option("Write JSON to a file; - is stdout.", "FILE|-")] = None
    junit: Annotated[Path | None, Option("Write every verdict as a test case, in JUnit's XML.", "FILE")] = None
    resume: Annotated[bool, Option("Finish an interrupted run of the same command in --out.")] = False
    quiet: Annotated[bool, Option("No progress and no tables, only the closing line.", flags=("-q", "--quiet"))] = False
    verbose: Annotated[bool, Option("Add the details of every record.", flags=("-v", "--verbose"))] = False
