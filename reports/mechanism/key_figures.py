"""The few of the key figures that stand first on a page, as a table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from comparisons.datasheet.curves import KeyFigure
from comparisons.datasheet.figures import MEAN, SHAKING
from comparisons.datasheet.sheet import Sheet
from reports.document.parts import Table
from reports.document.templates import plain
from reports.mechanism.shown import jeq, place, words

Row = tuple[str, str, str]


def key_figures(sheet: Sheet) -> tuple[Row, ...]:
    """Drive, output, largest forces, worst transmission angle: what, value with unit, where."""
    drive = [one for one in sheet.figures["drive"] if one.what not in (MEAN, "peak speed")]
    chosen = [one for one in drive if one.signal == ("Peq" if "power" in one.what else "Mkr")]
    rows = [(one.what, words(sheet, one), place(sheet, one)) for one in (*chosen, *_besides(sheet))]
    inertia = [("mean Jeq", jeq(sheet, "mean"), "")] if "Jeq" in sheet.facts else []
    return (*rows[: len(chosen)], *inertia, *rows[len(chosen) :])


def _besides(sheet: Sheet) -> Iterator[KeyFigure]:
    """What is not of the drive."""
    yield from (one for one in sheet.figures["output"] if one.signal in "va" or one.what == "stroke")
    forces = [one for one in sheet.figures["forces"] if one.unit == "N"]
    joints = [one for one in forces if one.what != SHAKING]
    for one in sorted(joints, key=lambda one: -(one.value or 0.0))[:1]:
        yield replace(one, what=f"largest joint force, {plain(one.what)}")
    yield from (one for one in forces if one.what == SHAKING)
    yield from (replace(one, what="shaking moment") for one in sheet.figures["moment"])
    groups = [one for one in sheet.figures["transmission"] if one.value is not None]
    for one in sorted(groups, key=lambda one: one.value or 0.0)[:1]:
        yield replace(one, what=f"least transmission angle, {plain(one.what)}")


def key_table(sheet: Sheet) -> Table:
    """The same as a table."""
    head = ("figure", "value", f"at {sheet.symbol}")
    conditions = sheet.conditions.partition(": ")[2]
    return Table(f"{conditions[:1].upper()}{conditions[1:]}.", head, key_figures(sheet), align="lrr", style="key")
