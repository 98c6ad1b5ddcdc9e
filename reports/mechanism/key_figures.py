"""The figures that a designer chooses motor, bearings and lengths by, as a table."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from comparisons.datasheet.sheet import Sheet
from reports.document.numbers import ABSENT, figure
from reports.document.parts import Table
from reports.document.templates import plain
from reports.mechanism.shown import ShownSheet

SHAKING: Final = "shaking force"
Row = tuple[str, str, str]
# Points of the drive, and the signal of each.
DRIVE: Final = {"peak torque": "Mkr", "peak power": "Peq", "peak braking power": "Peq", "RMS torque, means": "Mkr"}


def key_figures(sheet: Sheet) -> tuple[Row, ...]:
    """Drive, output, largest forces, worst transmission angle: what, value with unit, where."""
    shown = ShownSheet(sheet)
    return (*_drive(shown), *_output(shown), *_forces(shown), *_transmission(shown))


def key_table(sheet: Sheet) -> Table:
    """The same as a table."""
    head = ("figure", "value", ShownSheet(sheet).where)
    conditions = sheet.conditions.partition(": ")[2]
    return Table(f"{conditions[:1].upper()}{conditions[1:]}.", head, key_figures(sheet), align="lrr", style="key")


def _drive(shown: ShownSheet) -> Iterator[Row]:
    force = "force" if shown.sheet.linkage.is_linear else "torque"
    for point in shown.sheet.figures["drive"]:
        signal = DRIVE.get(point["what"])
        if signal:
            value = point["torque"] if signal == "Mkr" else point["power"]
            what = point["what"].partition(",")[0].replace("torque", force)
            yield what, shown.value(signal, value), shown.place(point["at"])
    if "Jeq" in shown.sheet.facts:
        found = shown.sheet.facts["Jeq"]
        yield "mean Jeq", shown.value("Jeq", found["mean"]), ""


def _output(shown: ShownSheet) -> Iterator[Row]:
    if "stroke" in shown.sheet.figures:
        yield "stroke", shown.value("S", shown.sheet.figures["stroke"]), ""
    for one in shown.sheet.figures["output"]:
        if one["signal"] in "va":
            yield one["what"], shown.value(one["signal"], one["value"]), shown.place(one["at"])


def _forces(shown: ShownSheet) -> Iterator[Row]:
    found = shown.sheet.figures["forces"]
    joints = [one for one in found if one["joint"] != SHAKING]
    largest = max(joints, key=lambda one: one["force"] or 0.0, default=None)
    if largest:
        words = f"largest joint force, {plain(largest['joint'])}"
        yield words, force_words(shown, largest["force"]), shown.place(largest["at"])
    for one in found:
        if one["joint"] == SHAKING:
            yield SHAKING, force_words(shown, one["force"]), shown.place(one["at"])
    peak = shown.sheet.peaks.get("shaking_moment")
    if peak:
        yield "shaking moment", shown.value("shaking_moment", peak["value"]), shown.place(peak["at"])


def force_words(shown: ShownSheet, force: float | None) -> str:
    """A force, N, in the file's unit."""
    unit = shown.own("N")
    return ABSENT if force is None else f"{figure(force / unit.size)} {unit.name}"


def _transmission(shown: ShownSheet) -> Iterator[Row]:
    found = [(one["value"], one) for one in shown.sheet.figures["transmission"] if one["value"] is not None]
    angle = shown.own("rad")
    for value, one in sorted(found, key=lambda pair: pair[0])[:1]:
        size = value / angle.size
        words = f"{size:.2f}°" if angle.name == "deg" else f"{figure(size)} {angle.name}"
        yield f"least transmission angle, {plain(one['what'])}", words, shown.place(one["at"])
