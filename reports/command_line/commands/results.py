"""What ``linkproof results`` does: the closed form of one linkage over one motion, for its designer."""

from __future__ import annotations

import math
import webbrowser
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import without
from analytic.description.crank_motion import RPM, CrankMotion, Segment
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import STEADY, page_sheet, range_motion, sheet
from comparisons.datasheet.instants import Instants
from comparisons.datasheet.linkage_warnings import check_slips
from comparisons.datasheet.saved import FILE, load_sheets, save_sheets
from comparisons.datasheet.sheet import Sheet
from comparisons.datasheet.units import file_unit
from comparisons.reference.case import Case, own_case
from comparisons.runs.files import check_writable, write_bytes, write_text
from reports.command_line.destination import STDOUT, check_files, write_out
from reports.command_line.linear_drive import prescribed
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.motions import EVERYTHING, OWN, own_regimes
from reports.designs.results.files import csv_table, json_text
from reports.document.terminal import show

Array = NDArray[np.float64]

PAGE = "index.html"
PICTURES = ("svg", "png", "pdf")
FILES = ("csv", "xlsx", "json", *PICTURES, "gif", "dxf")


@dataclass(frozen=True, kw_only=True)
class ResultsChoice(MotionChoice):
    """The request, in the user's words; ``at`` are degrees and ``time`` seconds, with commas between them.

    ``csv``, ``json``, ``svg`` and ``dxf`` are files, or "-" for stdout, which then holds nothing else; ``xlsx``,
    ``png``, ``pdf`` and ``gif`` are files. ``decimal`` is the point or comma in the numbers of ``csv``, ``figure`` the
    one picture that is drawn in place of all. ``out`` is the folder of a report, whose page of the mechanism a browser
    ``opens``. With ``strict`` what looks like a slip is refused.
    """

    mechanism: str
    at: str | None = None
    time: str | None = None
    csv: str | None = None
    decimal: str = "."
    xlsx: str | None = None
    json: str | None = None
    figure: str | None = None
    svg: str | None = None
    png: str | None = None
    pdf: str | None = None
    gif: str | None = None
    dxf: str | None = None
    out: Path | None = None
    opens: bool = False
    strict: bool = False

    @property
    def files(self) -> dict[str, str]:
        """Files to be written, by option."""
        named = {f"--{name}": getattr(self, name) for name in FILES}
        return {option: file for option, file in named.items() if file is not None}

    def check(self) -> None:
        """Raise LinkproofError for what cannot be, before anything is worked out."""
        super().check()
        if self.at is not None and self.time is not None:
            raise LinkproofError("--at and --time both choose the instants of the table: leave one of the two out")
        if self.decimal not in {".", ","}:
            raise LinkproofError(
                f"--decimal: expected . or , in the numbers of --csv, got '{self.decimal}'; correct it"
            )
        if self.decimal == "," and self.csv is None:
            raise LinkproofError("--decimal belongs to the table of --csv, and none is written: name a file with --csv")
        if self.figure is not None and not {f"--{kind}" for kind in PICTURES} & {*self.files}:
            raise LinkproofError(f"--figure {self.figure} needs a file: name one with --svg, --png or --pdf")
        if self.opens and self.out is None:
            raise LinkproofError("--open shows the page that --out writes: name a folder with --out")
        if self.out is not None:
            check_writable(self.out / PAGE)
        check_files(self.files, {"the linkage's file": Path(self.mechanism)})


def results(choice: ResultsChoice, *, quiet: bool = False) -> None:
    """Print the key figures of a linkage, or its signals at chosen instants, and write the requested files."""
    choice.check()
    linkage = load(choice.mechanism, choice.variant)
    if choice.strict:
        check_slips(linkage)
    case, chosen = designer_case(linkage, choice)
    found = sheet(case, chosen, every_peak=choice.json is not None)
    contents = {file: _content(option, found, case, choice) for option, file in choice.files.items()}
    for file, content in contents.items():
        if isinstance(content, bytes):
            write_bytes(Path(file), content)
        elif file != STDOUT:
            write_text(Path(file), content)
    if choice.out is not None:
        _write_page(choice.out, case, opens=choice.opens, quiet=quiet)
    on_screen = contents.get(STDOUT)
    if isinstance(on_screen, str):
        write_out(on_screen)
    elif not quiet:
        from reports.designs.results import terminal  # noqa: PLC0415 - JSON and CSV need no tables

        show(*(terminal.key_figures(found) if found.chosen is None else terminal.at_instants(found)))


def designer_case(linkage: Linkage, choice: ResultsChoice) -> tuple[Case, Array | None]:
    """A linkage under the requested motion, and the requested instants, s; None for the whole motion."""
    case = chosen_case(Mechanism(linkage if choice.gravity else without(linkage, "gravity")), choice)
    return case, _instants(case, choice)


def _write_page(out: Path, case: Case, *, opens: bool, quiet: bool) -> None:
    """Save the data sheet of a case among those of a report's folder, and write the report's pages."""
    from reports.site.contents import contents  # noqa: PLC0415 - seconds that nothing else pays for
    from reports.site.site import write_site  # noqa: PLC0415

    own = page_sheet(case, tuple(case.mechanism.linkage.released))
    sheets = load_sheets(out) if (out / FILE).is_file() else ()
    others = [one for one in sheets if (one.name, one.variant) != (own.name, own.variant)]
    save_sheets(out, [*others, own])
    write_site(out, processes=0)
    page = out / contents(out).file_of(own)
    if not quiet:
        show(f"page: {page}", stderr=True)
    if opens:
        webbrowser.open(page.resolve().as_uri())


def _content(option: str, found: Sheet, case: Case, choice: ResultsChoice) -> str | bytes:
    """What the file of an option holds; what writes it is imported where it is needed: half a second or more."""
    if option == "--xlsx":
        from reports.designs.results.workbook import workbook  # noqa: PLC0415

        return workbook(found)
    if option == "--gif":
        from reports.designs.results.animation import gif  # noqa: PLC0415

        return gif(found)
    if option == "--dxf":
        from reports.designs.results.dxf import dxf  # noqa: PLC0415

        return dxf(found)
    if option.removeprefix("--") in PICTURES:
        from reports.designs.results.drawing import picture  # noqa: PLC0415

        return picture(page_sheet(case), option.removeprefix("--"), choice.figure)
    return csv_table(found, choice.decimal) if option == "--csv" else json_text(found)


def chosen_case(mechanism: Mechanism, choice: MotionChoice) -> Case:
    """The linkage under the one requested motion: by default a turn at constant speed, or the range of the crank."""
    linkage = mechanism.linkage
    own = own_regimes(choice, [linkage])
    if len(choice.regimes) > 1 or {EVERYTHING, OWN} & {*choice.regimes}:
        raise LinkproofError(f"expected one motion, got --regime {', '.join(choice.regimes)}: choose one of them")
    if own:
        case = own_case(mechanism, next(regime for regime in linkage.regimes if regime.name == own[0]))
        return replace(case, mechanism=mechanism)  # a torque over the angle is the drive's, not a load
    if linkage.is_linear or choice.swings or choice.regimes not in ((), (STEADY,)) or _is_timed(choice):
        ((motion,), _) = prescribed(choice, [linkage])
        return Case(mechanism, motion)
    return _usual_case(mechanism, choice)


def _is_timed(choice: MotionChoice) -> bool:
    """Whether the time of a motion was given."""
    default = MotionChoice()
    times = (choice.ramp_time, choice.hold_time) != (default.ramp_time, default.hold_time)
    if times and not choice.regimes:
        raise LinkproofError(
            "--ramp-time and --hold-time apply only to a motion over time: add --regime run-up, or "
            "leave them out for a turn at constant speed"
        )
    return times


def _usual_case(mechanism: Mechanism, choice: MotionChoice) -> Case:
    """Constant speed over a full turn, or over the range of a crank that makes none, short of its limits."""
    start = math.radians(choice.start_angle)
    speed, backwards = abs(choice.rpm) * RPM, choice.turns_back
    reach = mechanism.crank_range(start if choice.start_angle else None)
    if reach.is_full_turn:
        motion = CrankMotion(STEADY, (Segment(0.0, FULL_TURN / speed, (start, -speed if backwards else speed)),))
        return Case(mechanism, motion)
    return Case(mechanism, range_motion(reach, speed, backwards=backwards))


def _instants(case: Case, choice: ResultsChoice) -> Array | None:
    """The requested instants, s; None for the whole motion."""
    linkage = case.mechanism.linkage
    instants = Instants(case.motion, turns=not linkage.is_linear)
    if choice.at is not None:
        length = file_unit("m", linkage)
        unit, size = (f" {length.name}", length.size) if linkage.is_linear else ("°", math.radians(1.0))
        return instants.at_angles(
            _numbers("--at", choice.at, length.name if linkage.is_linear else "degrees"), unit, size
        )
    if choice.time is not None:
        return instants.at_times(_numbers("--time", choice.time, "seconds"))
    return None


def _numbers(option: str, text: str, unit: str) -> Array:
    """Numbers with commas between them."""
    numbers = []
    for word in text.split(","):
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise LinkproofError(
                f"{option}: expected finite numbers of {unit} with commas between them, such as 0,30,60, got "
                f"'{word.strip()}'; correct it"
            )
        numbers.append(number)
    return np.array(numbers)
