"""A sheet in words, as terminal, pages and pictures show it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import groupby
from typing import Final

from analytic.description.units import FileUnit
from analytic.description.written import fixed
from comparisons.designer.curves import TIME, SignalFigure
from comparisons.designer.figures import MEAN, PEAK_SPEED, SHAKING
from comparisons.designer.linkage_check import warnings
from comparisons.designer.sheet import Sheet
from reports.document.numbers import ABSENT, figure, within_turn
from reports.document.parts import Table
from reports.document.templates import plain

# Of a table of key figures the heads of what they are, and of the numbers side by side; an output's have a unit each.
HEADS: Final = {
    "drive": (("drive",), ("torque", "speed", "power")),
    "flywheel": (("flywheel",), ("",)),
    "forces": (("joint", "on"), ("force", "direction")),
    "moment": (("shaking moment",), ("",)),
    "transmission": (("group",), ("least transmission angle",)),
    "thread": (("thread",), ("feed", "contour")),
}


AT_OPEN_END: Final = "*"  # behind an extreme at an end of the motion beside a dead position


def _angle(value: float, unit: FileUnit) -> str:
    """A value, given in a unit, as text without it: degrees with two decimals, anything else with five digits.

    A dash for one that is not finite.
    """
    return fixed(value, 2) if unit.name == "deg" and math.isfinite(value) else figure(value, 5)


def number(sheet: Sheet, signal_figure: SignalFigure) -> str:
    """A key figure as text in its unit, without the unit's name, marked with * if it is an extreme at an open end."""
    return _unmarked(sheet, signal_figure) + AT_OPEN_END * signal_figure.at_open_end


def _unmarked(sheet: Sheet, signal_figure: SignalFigure) -> str:
    """A key figure's number in its unit as text, without the mark of an open end."""
    value = sheet.shown_value(signal_figure)
    return _angle(value, sheet.unit_of(signal_figure)) if signal_figure.unit == "rad" else figure(value)


def words(sheet: Sheet, signal_figure: SignalFigure) -> str:
    """A key figure with its unit, as a page prints it, marked with * if it is an extreme at an open end.

    A dash for none.
    """
    text, unit = _unmarked(sheet, signal_figure), sheet.unit_of(signal_figure).on_page
    if text == ABSENT:
        return text
    return _with_minus_sign(f"{text}°" if unit == "deg" else f"{text} {unit}") + AT_OPEN_END * signal_figure.at_open_end


def _with_minus_sign(text: str) -> str:
    """A number's text with a true minus sign in place of a hyphen at its beginning; one in its exponent stays."""
    return f"−{text[1:]}" if text.startswith("-") else text


def jeq(sheet: Sheet, end: str) -> str:
    """The "mean", least ("min") or largest ("max") Jeq of a whole turn as text with its unit.

    The sheet must have it: raises KeyError.
    """
    return words(sheet, SignalFigure(end, "Jeq", sheet.facts["Jeq"][end], sheet.units["Jeq"]))


def place(sheet: Sheet, signal_figure: SignalFigure) -> str:
    """The place of a key figure on the axis, as text with its unit, of a turn within 360°; "" without a place."""
    at = sheet.place_of(signal_figure)
    if at is None:
        return ""
    if sheet.is_turn:
        return within_turn(at / sheet.axis_unit.size)
    return _with_minus_sign(f"{at / sheet.axis_unit.size:z.4g} {sheet.axis_unit.on_page}")


def figures_table(sheet: Sheet, name: str, named: Callable[[str], str] = str) -> Table:
    """The table of key figures called ``name``, a key of ``HEADS``, the numbers of one place side by side.

    ``named`` makes names those for a reader. The sheet must have such figures: raises IndexError.
    """
    whats, labels = HEADS[name]
    if sheet.is_linear:
        labels = tuple(label.replace("torque", "force") for label in labels)
    groups = [[*part] for _, part in groupby(sheet.figures[name], key=lambda row: (row.what, row.on))]
    rows = []
    for group in groups:
        numbers = [number(sheet, row) for row in group] + [ABSENT] * (len(labels) - len(group))
        names = map(named, (group[0].what, group[0].on)[: len(whats)])
        rows.append((*names, *numbers, *place_cells(sheet, group[0])))
    units = [sheet.unit_of(row).name for row in groups[0]]
    heads = (f"{label} {unit}".strip() for label, unit in zip(labels, units, strict=True))
    return Table("", (*whats, *heads, *places(sheet, "at ")), rows, "l" * len(whats) + "r")


def places(sheet: Sheet, at: str = "") -> tuple[str, ...]:
    """The heads of the columns of places with their units: φ and, unless that is the axis, the time, s, before it.

    ``at`` stands before each.
    """
    phi = f"{at}φ {sheet.unit('phi').name}"
    return (phi,) if sheet.axis == "phi" else (f"{at}t s", phi)


def place_cells(sheet: Sheet, signal_figure: SignalFigure) -> tuple[str, ...]:
    """The cells of a key figure's place, without units: the time, s, unless φ is the axis, then φ in the file's unit.

    Dashes without one.
    """
    if signal_figure.phi is None or (sheet.axis == TIME and signal_figure.time is None):
        return (ABSENT,) * len(places(sheet))
    phi = _angle(sheet.angle(signal_figure.phi), sheet.unit("phi"))
    return (phi,) if sheet.axis == "phi" else (f"{signal_figure.time:#.6g}", phi)


def required_table(sheet: Sheet) -> Table:
    """The table of the thread's required feed, the actual one and their difference, in the file's units."""
    length = sheet.file_unit_of("m")
    columns = [sheet.required[name] / length.size for name in ("required", "actual")]
    rows = [
        (_angle(sheet.angle(phi), sheet.unit("phi")), figure(required), figure(actual), figure(actual - required))
        for phi, required, actual in zip(sheet.required["phi"].tolist(), *columns, strict=True)
    ]
    head = (f"φ {sheet.unit('phi').name}", *(f"{word} {length.name}" for word in ("required", "feed", "difference")))
    return Table("", head, rows, "r")


def key_figures(sheet: Sheet) -> tuple[tuple[str, str, str], ...]:
    """Rows of name, value with unit, and place, as text: drive, mean Jeq, flywheel, output, forces, least angle.

    The drive has torque and power, the forces are largest joint force, shaking force and moment, the angle is the least
    transmission angle. Those that the linkage lacks are left out.
    """
    drive = [
        row
        for row in sheet.figures["drive"]
        if row.what not in (MEAN, PEAK_SPEED) and row.signal == ("Peq" if "power" in row.what else "Mkr")
    ]
    rows = [(row.what, words(sheet, row), place(sheet, row)) for row in (*drive, *_further_figures(sheet))]
    inertia = [("mean Jeq", jeq(sheet, "mean"), "")] if "Jeq" in sheet.facts else []
    return (*rows[: len(drive)], *inertia, *rows[len(drive) :])


def _further_figures(sheet: Sheet) -> Iterator[SignalFigure]:
    """Yield the key figures besides those of the drive, named for a reader; those that the linkage lacks are left out.

    They are of the flywheel, the output's stroke, speed and acceleration, the largest joint force, shaking force and
    moment, and the least transmission angle.
    """
    yield from (replace(row, what=f"flywheel {row.what}") for row in sheet.figures["flywheel"])
    yield from (row for row in sheet.figures["output"] if row.signal in "va" or row.what == "stroke")
    forces = [row for row in sheet.figures["forces"] if row.unit == "N"]
    joints = [force for force in forces if force.what != SHAKING]
    if joints:
        largest = max(joints, key=lambda force: force.value or 0.0)
        yield replace(largest, what=f"largest joint force, {plain(largest.what)}")
    yield from (force for force in forces if force.what == SHAKING)
    yield from (replace(row, what="shaking moment") for row in sheet.figures["moment"])
    groups = [row for row in sheet.figures["transmission"] if row.value is not None]
    if groups:
        least = min(groups, key=lambda row: row.value or 0.0)
        yield replace(least, what=f"least transmission angle, {plain(least.what)}")


def key_table(sheet: Sheet) -> Table:
    """The key figures as a table, captioned with the conditions and the note on open ends, if there are any."""
    head = ("figure", "value", f"at {sheet.symbol}")
    conditions = sheet.conditions.partition(": ")[2]
    caption = (
        f"{conditions[:1].upper()}{conditions[1:]}.{f' {open_end_note(sheet)}.' if sheet.open_end_warning else ''}"
    )
    return Table(caption, head, key_figures(sheet), align="lrr", style="key")


def open_end_note(sheet: Sheet) -> str:
    """A clause on the mark of extremes at open ends and on how to avoid these; for a sheet that has some."""
    return f"{AT_OPEN_END} marks numbers at an open end of the motion: {sheet.open_end_warning}"


def warning_texts(sheet: Sheet) -> list[str]:
    """Sentences that warn of extremes at open ends and of probable slips of the file; [] without any."""
    return [*([open_end_note(sheet)] if sheet.open_end_warning else []), *warnings(sheet.linkage)]
