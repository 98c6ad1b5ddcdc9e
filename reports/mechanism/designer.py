"""The sections of a mechanism's page for its designer: motion, drive, Jeq, forces, links, published figures."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from analytic.description.linkage import Link
from comparisons.designer.sheet import JOINT, ROUNDING, Sheet
from reports.charts.scheme import scheme_figure
from reports.document.chart import Array, Chart, Curve, Note, Panel
from reports.document.numbers import ABSENT, printed
from reports.document.parts import (
    Bullets,
    Card,
    Cards,
    Facts,
    FigureGroup,
    Fold,
    PageFigure,
    Paragraph,
    Part,
    Section,
    Table,
)
from reports.document.templates import lines, plain, sentence
from reports.mechanism.shown import figures_table, jeq, page_figure, panel

OUTPUT: Final = ("S", "v", "a")
DRIVE: Final = ("Mkr", "Peq", "Teq")
# Before the reason why a part of a sheet is missing, where the part has its place on the page.
WORDS: Final = {"values": "There is no motion to show: "}
TALL: Final = 3.9  # inches, of panels one under the other
MOST_CURVES, MOST_HODOGRAPHS, PER_ROW = 10, 12, 4
CONSTANT: Final = 1e-6  # share of its largest value that a link's Jeq varies by at least, else it is a constant
ACTS: Final = "A joint's force acts on the link named; directions count from x."
DOTS, QUARTERS = 30, 90  # degrees of the crank between dots of a hodograph, and between those that are named


def sections(sheet: Sheet) -> tuple[Section, ...]:
    """Every section that the sheet has something for, in the order of a designer's questions."""
    every = (_drive(sheet), _forces(sheet), _links(sheet))
    return tuple(section for section in every if section.parts)


def sentences(sheet: Sheet, *keys: str) -> tuple[Part, ...]:
    """Why parts of the sheet cannot be derived."""
    reasons = {key: sheet.missing[key] for key in keys if key in sheet.missing}
    words = {key: f"{WORDS.get(key, f'There is no {key}: ')}{reason}" for key, reason in reasons.items()}
    return tuple(Paragraph(f"{text.removesuffix('.')}.", "small") for text in words.values())


def _drive(sheet: Sheet) -> Section:
    """Where the inertia behind the torque comes from, or why there is none."""
    words = [] if sheet.linkage.output else ["The file names no output: there is no S, v and a."]
    if not any(name in sheet.values for name in DRIVE):
        words += ["No link has mass and there are no loads: there is no torque, power or joint force."]
    parts: list[Part] = [Paragraph(text, "small") for text in words]
    if "Jeq" in sheet.facts:
        ends = {end: jeq(sheet, end) for end in ("min", "max", "mean")}
        parts.append(Paragraph(sentence("sheet_inertia", facts=sheet.facts["Jeq"], **ends)))
    figures = _inertia(sheet) if sheet.shares else ()
    return Section("drive", "Drive and inertia", (*parts, *([FigureGroup(figures)] if figures else [])))


def _inertia(sheet: Sheet) -> tuple[PageFigure, ...]:
    """Jeq by group, one on the other, and by link."""
    unit = sheet.unit("Jeq")
    groups, links = (
        {name: sheet.sorted_by_axis(values) / unit.size for name, values in sheet.shares.get(kind, {}).items()}
        for kind in ("groups", "links")
    )
    whole = sum((float(np.mean(values)) for values in links.values()), 0.0)
    if not whole:
        return ()
    constant = [plain(name) for name, values in links.items() if float(np.ptp(values)) <= CONSTANT * np.max(values)]
    varying = {name: values for name, values in links.items() if plain(name) not in constant}
    stack, total = [], np.zeros_like(sheet.x)
    for number, (name, values) in enumerate(groups.items()):
        total = total + values
        stack.append(Curve(sheet.x, total, _share(name, values, whole), number, stacked=True))
    curves = [
        Curve(sheet.x, values, _share(name, values, whole), number)
        for number, (name, values) in enumerate(varying.items())
    ]
    panels = [panel(sheet, stack, f"Jeq, {unit.on_page}", is_last=not curves)]
    panels += [panel(sheet, curves, f"Jeq of a link, {unit.on_page}")] if curves else []
    caption = "Share of each group in Jeq (stacked)"
    caption += "; below, each moving link alone" if curves else ""
    caption += f". Constant and not drawn: {', '.join(constant)}" if constant else ""
    caption += ". Per cent are of the mean."
    chart = Chart(tuple(panels), TALL, wide=True)
    return (page_figure(sheet, "inertia", caption, "Jeq by Assur group and by link", chart),)


def _share(name: str, values: Array, whole: float) -> str:
    return f"{plain(name)}, {100.0 * float(np.mean(values)) / whole:.1f} %"


def _forces(sheet: Sheet) -> Section:
    """In every joint and on the frame, as hodographs and in figures."""
    joints = sheet.joints
    if not joints:
        return Section("forces", "Forces in the joints and on the frame", ())
    table = figures_table(sheet, "forces", plain)
    parts = (
        _hodographs(sheet, joints),
        Fold("Largest force of every joint, in figures", (replace(table, caption=ACTS),)),
    )
    return Section("forces", "Forces in the joints and on the frame", parts)


def _dots_in_words(sheet: Sheet) -> str:
    """The end of a hodograph's caption: how far its dots are apart; empty unless the motion is a full turn."""
    return f": dots are {DOTS}° of the crank apart, the quarters of the turn named" if sheet.is_turn else ""


def _hodographs(sheet: Sheet, joints: list[str]) -> PageFigure:
    """The tip of every joint's force and of that on the frame, each to its own scale."""
    vectors = [f"{JOINT}{name}" for name in joints[:MOST_HODOGRAPHS]]
    vectors += ["shaking_force"] if "shaking_force:x" in sheet.values else []
    panels = [hodograph(sheet, vector, number) for number, vector in enumerate(vectors)]
    rows = -(-len(vectors) // PER_ROW)
    which = f"the {MOST_HODOGRAPHS} joints with the largest forces" if len(joints) > MOST_HODOGRAPHS else "every joint"
    caption = f"Fx against Fy of {which} and on the frame, each to its own scale{_dots_in_words(sheet)}."
    chart = Chart(tuple(panels), 2.5 * rows, columns=min(PER_ROW, len(vectors)), wide=True)
    return page_figure(sheet, "hodographs", caption, "hodographs of the joint forces", chart)


def hodograph(sheet: Sheet, vector: str, ink: int) -> Panel:
    """Fx against Fy from the origin; of a turn a dot every 30° and the quarters named."""
    unit = sheet.unit(f"{vector}:x").on_page
    force = [sheet.y(f"{vector}:{component}") for component in "xy"]
    title = plain(vector.partition(":")[2] or vector)
    curves = [Curve(force[0], force[1], ink=ink)]
    notes: tuple[Note, ...] = ()
    if sheet.is_turn:
        degrees = np.arange(0, 360, DOTS)
        dots = np.stack([np.interp(degrees, sheet.x, values, period=360.0) for values in force])
        curves.append(Curve(dots[0], dots[1], ink=ink, line="", marker="o"))
        quarters = zip(degrees, dots.T, strict=True)
        notes = tuple(Note(float(x), float(y), f"{at}°") for at, (x, y) in quarters if not at % QUARTERS)
    return Panel(tuple(curves), f"Fx, {unit}", f"Fy, {unit}", (), notes, "equal", names="", title=title)


def _links(sheet: Sheet) -> Section:
    """The linkage in several positions, its links in the file's units with what each gives to the mean Jeq, notes."""
    linkage, facts = sheet.linkage, sheet.facts.get("links", {})
    units = [sheet.file_unit_of(si) for si in ("kg", "kg m²", "m")]
    means = {name: link["Jeq_mean"] for name, link in facts.items() if "Jeq_mean" in link}
    whole = sum(means.values())
    head = ("link", *(f"{word}, {unit.on_page}" for word, unit in zip(("m", "J", "mass centre"), units, strict=True)))
    rows = [_link_row(link, [unit.size for unit in units]) for link in linkage.links.values()]
    if whole:
        head += ("of mean Jeq",)
        shares = [f"{100.0 * means.get(name, 0.0) / whole:.1f} %" for name in linkage.links]
        rows = [(*row, share) for row, share in zip(rows, shares, strict=True)]
    note = f"Mass centres in the link's own frame; J about the mass centre, {ABSENT} where the link cannot turn."
    table = Table("The moving links as described.", head, tuple(rows), note=note)
    notes = (Bullets(linkage.notes),) if linkage.notes else ()
    cards = (*_scheme(sheet), Card("Links", (table, *notes)))
    return Section(
        "made-of", "What it is made of", (Cards(cards, wide=True), *sentences(sheet, *(sheet.missing.keys() - WORDS)))
    )


def _scheme(sheet: Sheet) -> tuple[Card, ...]:
    """The linkage to scale in positions of its motion."""
    positions = sheet.positions
    if positions is None:
        return ()
    output = f"; the blue line is the path of {sheet.linkage.output.point}" if sheet.linkage.output else ""
    caption = f"To scale in twelve positions, one of them drawn out; quartered discs are mass centres{output}."
    drawing = partial(scheme_figure, sheet.linkage, positions)
    return (Card("Positions", (page_figure(sheet, "scheme", caption, "kinematic scheme", drawing),)),)


def _link_row(link: Link, sizes: list[float]) -> tuple[str, ...]:
    mass, inertia, length = sizes
    least = ROUNDING * max(map(abs, link.centre))
    places = (0.0 if abs(value) <= least else value / length for value in link.centre)
    centre = ", ".join(f"{place:.4g}".replace("-", "−") for place in places)
    turning = ABSENT if link.inertia is None else printed(link.inertia / inertia)
    return plain(link.name), printed(link.mass / mass), turning, f"({centre})"


def facts(sheet: Sheet) -> Facts:
    """The facts on the mechanism that hold for every motion: structure, range, output, rest."""
    table = {"equilibria": [], **sheet.facts}
    pairs = [text.partition(": ")[::2] for text in lines("mechanism", facts=table) if not text.startswith("Jeq: ")]
    structure = sheet.facts.get("structure", "").replace("->", "→").replace("_", " ")
    return Facts((("structure", structure), *pairs))
