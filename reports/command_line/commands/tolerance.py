"""What ``linkproof tolerance`` does: which number of a linkage moves which result by how much."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from analytic.description.linkage import Linkage
from analytic.description.loading import load
from comparisons.designs.tolerance.tolerance_request import ToleranceRequest, tolerance_request
from comparisons.designs.tolerance.tolerance_study import ToleranceStudy, tolerance_study
from comparisons.designs.tolerance.tolerances import Tolerances, read_tolerances
from comparisons.judging.records import to_json
from comparisons.runs.files import write_text
from reports.command_line.destination import STDOUT, check_files, write_out
from reports.command_line.progress import progress
from reports.command_line.steady_choice import SteadyChoice, steady_case
from reports.designs.tolerance.tolerance_files import csv_table, document
from reports.designs.tolerance.tolerance_terminal import printout
from reports.document.terminal import show


@dataclass(frozen=True, kw_only=True)
class ToleranceChoice(SteadyChoice):
    """The request, in the user's words; ``json``, ``csv`` and ``svg`` are files, or "-" for stdout."""

    tolerances: Path
    refine: bool = True
    samples: int | None = None
    seed: int = 0
    json: str | None = None
    csv: str | None = None
    svg: str | None = None
    quiet: bool = False

    @property
    def files(self) -> dict[str, str]:
        """Files to be written, by option."""
        named = {"--json": self.json, "--csv": self.csv, "--svg": self.svg}
        return {option: file for option, file in named.items() if file is not None}


def run(choice: ToleranceChoice) -> None:
    """Work the tolerances through, print the tables and write the requested files."""
    choice.check()
    check_files(choice.files, {"the linkage's file": Path(choice.mechanism), "the tolerances": choice.tolerances})
    request = request_of(load(choice.mechanism, choice.variant), read_tolerances(choice.tolerances), choice,
                         samples=choice.samples, seed=choice.seed)  # fmt: skip
    with progress(visible=not choice.quiet) as announce:
        found = tolerance_study(request, announce)
    for option, file in choice.files.items():
        text = _written(option, found)
        if file == STDOUT:
            write_out(text)
        else:
            write_text(Path(file), text)
    if STDOUT in choice.files.values():
        return
    printed = printout(found)
    show(*([] if choice.quiet else printed.tables), *printed.closing)


def request_of(
    linkage: Linkage, asked: Tolerances, choice: SteadyChoice, *, samples: int | None, seed: int
) -> ToleranceRequest:
    """The request, at the speed of the file of tolerances if it has one."""
    if asked.speed is not None:
        choice = replace(choice, speed=asked.speed)
    mechanism, motion, conditions = steady_case(linkage, choice)
    return tolerance_request(mechanism, motion, asked, samples=samples, seed=seed, conditions=conditions)


def _written(option: str, found: ToleranceStudy) -> str:
    """The text of a file."""
    if option == "--json":
        return to_json(document(found))
    if option == "--csv":
        return csv_table(found)
    from reports.charts.draw import svg  # noqa: PLC0415 - half a second that nothing else pays for
    from reports.designs.tolerance.tornado_picture import tornado_figure  # noqa: PLC0415

    rows = range(len(found.request.figures))
    return svg(tornado_figure([found.tornado(row) for row in rows], found.request.conditions), page="white")
