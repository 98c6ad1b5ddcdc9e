"""Results for a terminal: key figures of a motion, or every signal at chosen instants, in the units of the file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Final

from analytic.signals import COMPONENTS, MAGNITUDE
from comparisons.datasheet.curves import TIME
from comparisons.datasheet.figures import KeyFigure
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.sheet import Sheet
from reports.document.numbers import ABSENT, figure
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed
from reports.mechanism.shown import angle, number

CRANK: Final = (("omega", "epsilon", "Mkr", "Peq"), ("Teq", "Jeq", "S", "v", "a"))  # two tables of the crank's instants
# Of a table of key figures the heads of what they are, and of the numbers side by side; an output's have a unit each.
HEADS: Final = {
    "drive": (("drive",), ("torque", "speed", "power")),
    "forces": (("joint", "on"), ("force", "direction")),
    "moment": (("shaking moment",), ("",)),
    "transmission": (("group",), ("least transmission angle",)),
}


def key_figures(sheet: Sheet) -> list[Printed]:
    """Drive, forces, transmission angles and output, each with where its peak is."""
    tables = (*(_table(sheet, name) for name in HEADS if sheet.figures[name]), *_output(sheet))
    return [*_head(sheet), *(part for table in tables for part in ("", table)), *_remarks(sheet)]


def _head(sheet: Sheet) -> list[Printed]:
    return [Paragraph(sheet.conditions, colour="bold")]


def _remarks(sheet: Sheet) -> list[Printed]:
    """Signs, what the file does not give, and what looks like a slip in it, as ``linkproof check`` has it."""
    slips = [Paragraph(f"warning: {text}", colour="yellow") for text in warnings(sheet.linkage)]
    return ["", *sheet.remarks, *slips]


def _table(sheet: Sheet, name: str) -> Table:
    """A table of key figures: the numbers of one place side by side."""
    whats, labels = HEADS[name]
    if sheet.is_linear:
        labels = tuple(label.replace("torque", "force") for label in labels)
    groups = [[*part] for _, part in groupby(sheet.figures[name], key=lambda one: (one.what, one.on))]
    rows = []
    for group in groups:
        numbers = [number(sheet, one) for one in group] + [ABSENT] * (len(labels) - len(group))
        rows.append((*(group[0].what, group[0].on)[: len(whats)], *numbers, *_place(sheet, group[0])))
    units = [sheet.unit_of(one).name for one in groups[0]]
    heads = (f"{label} {unit}".strip() for label, unit in zip(labels, units, strict=True))
    return Table("", (*whats, *heads, *_places(sheet, "at ")), rows, "l" * len(whats) + "r")


def _output(sheet: Sheet) -> Iterator[Table]:
    if sheet.linkage.output is not None:
        head = (f"output {sheet.linkage.output.point}", "", "", *_places(sheet, "at "))
        rows = [
            (one.what, number(sheet, one), sheet.unit_of(one).name, *_place(sheet, one))
            for one in sheet.figures["output"]
        ]
        yield Table("", head, rows, "lrlr")


def _places(sheet: Sheet, at: str = "") -> tuple[str, ...]:
    """Heads of the columns that say where something is."""
    phi = f"{at}φ {sheet.unit('phi').name}"
    return (phi,) if sheet.axis == "phi" else (f"{at}t s", phi)


def _place(sheet: Sheet, one: KeyFigure) -> tuple[str, ...]:
    if one.time is None or one.phi is None:
        return (ABSENT,) * len(_places(sheet))
    phi = angle(sheet.angle(one.phi), sheet.unit("phi"))
    return (phi,) if sheet.axis == "phi" else (f"{one.time:#.6g}", phi)


def at_instants(sheet: Sheet) -> list[Printed]:
    """Every signal at the chosen instants: crank and output, points, links, joints."""
    tables = [_of_crank(sheet, [name for name in names if sheet.has(name)]) for names in CRANK]
    for kind, head in (("point", "point"), ("link", "link"), ("joint_force", "force in"), ("shaking_force", "force")):
        tables += _of_kind(sheet, kind, head)
    return [*_head(sheet), *(part for table in tables if table.rows for part in ("", table)), *_remarks(sheet)]


def _of_crank(sheet: Sheet, names: Sequence[str]) -> Table:
    head = [*_places(sheet), *(_headed(sheet, name, name) for name in names)]
    columns = [_column(sheet, name) for name in names]
    rows = [(*where, *cells) for where, cells in zip(_instants(sheet), zip(*columns, strict=True), strict=False)]
    return Table("", head, rows, "r")


def _of_kind(sheet: Sheet, kind: str, title: str) -> Iterator[Table]:
    """A table of all signals of a kind, a row for every part and instant."""
    parts = dict.fromkeys(name.rpartition(":")[0] for name in sheet.units if name.startswith(f"{kind}:"))
    components = [f":{component}" for component in COMPONENTS[kind]] + ([MAGNITUDE] if "force" in kind else [])
    labels = ["|F|" if one == MAGNITUDE else f"F{one[1:]}" if "force" in kind else one[1:] for one in components]
    rows: list[tuple[str, ...]] = []
    for part in parts:
        columns = [_column(sheet, part + one) for one in components]
        name = part.partition(":")[2] or "shaking"
        for row, (where, cells) in enumerate(zip(_instants(sheet), zip(*columns, strict=True), strict=True)):
            rows.append(("" if row else name, *where, *cells))
    if parts:
        first = next(iter(parts))
        named = (_headed(sheet, first + one, label) for one, label in zip(components, labels, strict=True))
        yield Table("", (title, *_places(sheet), *named), rows)


def _headed(sheet: Sheet, name: str, label: str) -> str:
    return f"{label} {sheet.unit(name).name}"


def _instants(sheet: Sheet) -> list[tuple[str, ...]]:
    angles = [f"{round(sheet.angle(phi), 9) + 0.0:.6g}" for phi in sheet.table["phi"].tolist()]
    times = [f"{time:.6g}" for time in sheet.table[TIME].tolist()]
    return [(phi,) for phi in angles] if sheet.axis == "phi" else [*zip(times, angles, strict=True)]


def _column(sheet: Sheet, name: str) -> list[str]:
    return [figure(sheet.rounded(name, value) / sheet.unit(name).size) for value in sheet.table[name].tolist()]
