"""What a mechanism's page says to its designer: motion, drive, Jeq, forces, links, published figures."""

from __future__ import annotations

from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Link
from comparisons.datasheet.sheet import Normalised
from reports.charts.scheme import scheme_figure
from reports.document.chart import Chart, Curve, Note, Panel
from reports.document.numbers import ABSENT, figure, printed
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
from reports.mechanism.check import range_lines
from reports.mechanism.key_figures import force_words
from reports.mechanism.shown import ROUNDING, ShownSheet

Array = NDArray[np.float64]

OUTPUT: Final = ("S", "v", "a")
DRIVE: Final = ("Mkr", "Peq", "Teq")
# Before the reason why a part of a sheet is missing, where the part has its place on the page.
WORDS: Final = {
    "normalised": "",
    "shares": "There is no Jeq by group and by link: ",
    "values": "There is no motion to show: ",
}
TALL: Final = 3.9  # inches, of panels one under the other
MOST_CURVES, MOST_HODOGRAPHS, PER_ROW = 10, 12, 4
CONSTANT: Final = 1e-6  # share of its largest value that a link's Jeq varies by at least, else it is a constant
DOTS, QUARTERS = 30, 90  # degrees of the crank between dots of a hodograph, and between those that are named


def sections(shown: ShownSheet) -> tuple[Section, ...]:
    """Every section that the sheet has something for, in the order of a designer's questions."""
    every = (_motion(shown), _drive(shown), _forces(shown), _links(shown))
    return tuple(section for section in every if section.parts)


def told(shown: ShownSheet, *keys: str) -> tuple[Part, ...]:
    """Why parts of the sheet cannot be derived."""
    reasons = {key: shown.sheet.missing[key] for key in keys if key in shown.sheet.missing}
    words = {key: f"{WORDS.get(key, f'There is no {key}: ')}{reason}" for key, reason in reasons.items()}
    return tuple(Paragraph(f"{text.removesuffix('.')}.", "small") for text in words.values())


def _motion(shown: ShownSheet) -> Section:
    """S, v and a, and the normalised motion against harmonics."""
    figures, normalised = [], shown.sheet.normalised
    if shown.has("S"):
        caption = "Displacement S, velocity v and acceleration a of the output; dots are peaks."
        chart = shown.stacked(OUTPUT, TALL, wide=normalised is None)
        figures.append(shown.figure("output", caption, "S, v and a", chart))
    if normalised:
        figures.append(_normalised(shown, normalised))
    parts: tuple[Part, ...] = (FigureGroup(tuple(figures)),) if figures else ()
    if not shown.has("S"):
        parts += (Paragraph("The file names no output: there is no S, v and a.", "small"),)
    return Section("motion", "Motion of the output", (*parts, *told(shown, "normalised")))


def _normalised(shown: ShownSheet, found: Normalised) -> PageFigure:
    """Unit functions in colour, harmonics dashed, both from top dead centre."""
    phase, words = np.degrees(found.phase), ("S / stroke", "v / max |v|", "a / max |a|")
    panels = []
    for number, name in enumerate(OUTPUT):
        ours = Curve(phase, found.functions[name], "mechanism", number)
        harmonic = Curve(phase, found.harmonics[name], "harmonic", "muted", "--", 1.0)
        label = "crank angle from top dead centre, °" if name == "a" else ""
        panels.append(Panel((harmonic, ours), label, words[number], turn=True))
    means = ", ".join(f"{name} {100.0 * found.means[name]:.2f} %" for name in OUTPUT)
    caption = f"Normalised motion against simple harmonic motion (dashed); mean difference over a turn: {means}."
    return shown.figure("normalised", caption, "normalised motion", Chart(tuple(panels), TALL))


def _drive(shown: ShownSheet) -> Section:
    """Torque, power and kinetic energy, and where the inertia behind them comes from."""
    names = [name for name in DRIVE if shown.has(name)]
    if not names:
        sentence = "No link has mass and there are no loads: there is no torque, power or joint force."
        return Section("drive", "Drive", (Paragraph(sentence, "small"),))
    force = "force" if shown.sheet.linkage.is_linear else "torque"
    caption = f"Driving {force} Mkr, power Peq and kinetic energy Teq; dots are peaks."
    drive = shown.figure("drive", caption, caption, shown.stacked(names, TALL))
    words = (Paragraph(_jeq(shown)),) if "Jeq" in shown.sheet.facts else ()
    figures = FigureGroup((drive, *_inertia(shown)))
    return Section("drive", "Torque, power and inertia", (*words, figures, *told(shown, "shares")))


def _jeq(shown: ShownSheet) -> str:
    """The reduced moment of inertia in words."""
    found = {name: shown.value("Jeq", shown.sheet.facts["Jeq"][name]) for name in ("min", "max", "mean")}
    return sentence("sheet_inertia", facts=shown.sheet.facts["Jeq"], **found)


def _inertia(shown: ShownSheet) -> tuple[PageFigure, ...]:
    """Jeq by group, one on the other, and by link."""
    groups, links = shown.shares("groups"), shown.shares("links")
    whole = sum((float(np.mean(values)) for values in links.values()), 0.0)
    if not whole:
        return ()
    constant = [plain(name) for name, values in links.items() if float(np.ptp(values)) <= CONSTANT * np.max(values)]
    varying = {name: values for name, values in links.items() if plain(name) not in constant}
    stack, total = [], np.zeros_like(shown.x)
    for number, (name, values) in enumerate(groups.items()):
        total = total + values
        stack.append(Curve(shown.x, total, _share(name, values, whole), number, stacked=True))
    curves = [
        Curve(shown.x, values, _share(name, values, whole), number)
        for number, (name, values) in enumerate(varying.items())
    ]
    unit = shown.unit("Jeq").name
    panels = [shown.panel(stack, f"Jeq, {unit}", is_last=not curves)]
    panels += [shown.panel(curves, f"Jeq of a link, {unit}")] if curves else []
    left_out = f"; constant and left out: {', '.join(constant)}" if constant else ""
    caption = "Where Jeq comes from: the crank and each Assur group, one on the other"
    caption += f", and beneath it every link by itself{left_out}. Per cent are of the mean." if curves else "."
    return (shown.figure("inertia", caption, "Jeq by Assur group and by link", shown.chart(panels, TALL)),)


def _share(name: str, values: Array, whole: float) -> str:
    return f"{plain(name)}, {100.0 * float(np.mean(values)) / whole:.1f} %"


def _forces(shown: ShownSheet) -> Section:
    """In every joint by magnitude and as hodographs, on the frame with its moment."""
    joints = shown.joints()
    if not joints:
        return Section("forces", "Forces in the joints and on the frame", told(shown, "forces"))
    most = f" of the {MOST_CURVES} joints with the largest" if len(joints) > MOST_CURVES else " in every joint"
    curves = []
    for number, joint in enumerate(joints[:MOST_CURVES]):
        signal = f"joint_force:{joint}:magnitude"
        curves.append(Curve(shown.x, shown.y(signal), f"{plain(joint)}, {shown.peak(signal)}", number))
    unit = shown.own("N").name
    caption = f"Force{most}, named with its peak."
    magnitudes = shown.chart([shown.panel(curves, f"|F|, {unit}")], 3.2, wide=True)
    parts = (
        FigureGroup((shown.figure("joint-forces", caption, caption, magnitudes), *_on_frame(shown, unit))),
        _hodographs(shown, joints, unit),
        Fold("Largest force of every joint, in figures", (_force_table(shown),)),
    )
    return Section("forces", "Forces in the joints and on the frame", parts)


def _on_frame(shown: ShownSheet, unit: str) -> tuple[PageFigure, ...]:
    """Shaking force and shaking moment."""
    if not shown.has("shaking_moment"):
        return ()
    tip = Chart((hodograph(shown, "shaking_force", 0, unit),), 3.2)
    moment = Curve(shown.x, shown.y("shaking_moment"), ink=1)
    label = f"shaking moment, {shown.unit('shaking_moment').name}"
    force_caption = f"Shaking force on the frame{_dots(shown)}."
    moment_caption = f"Shaking moment on the frame about {shown.sheet.moment_centre}, the drive's reaction included."
    over = shown.chart([shown.panel([moment], label)], 3.2)
    return (
        shown.figure("shaking-force", force_caption, "hodograph of the shaking force", tip),
        shown.figure("shaking-moment", moment_caption, "shaking moment", over),
    )


def _dots(shown: ShownSheet) -> str:
    return f": dots are {DOTS}° of the crank apart, the quarters of the turn named" if shown.is_turn else ""


def _hodographs(shown: ShownSheet, joints: list[str], unit: str) -> PageFigure:
    """The tip of every joint's force, each to its own scale."""
    drawn = joints[:MOST_HODOGRAPHS]
    panels = [hodograph(shown, f"joint_force:{name}", number, unit) for number, name in enumerate(drawn)]
    rows = -(-len(drawn) // PER_ROW)
    which = f"the {MOST_HODOGRAPHS} joints with the largest forces" if len(joints) > MOST_HODOGRAPHS else "every joint"
    caption = f"Fx against Fy of {which}, each to its own scale{_dots(shown)}."
    chart = Chart(tuple(panels), 2.5 * rows, columns=min(PER_ROW, len(drawn)), wide=True)
    return shown.figure("hodographs", caption, "hodographs of the joint forces", chart)


def hodograph(shown: ShownSheet, vector: str, ink: int, unit: str) -> Panel:
    """Fx against Fy from the origin; of a turn a dot every 30° and the quarters named."""
    force = shown.vector(vector)
    title = plain(vector.partition(":")[2])
    curves = [Curve(force[0], force[1], ink=ink)]
    notes: tuple[Note, ...] = ()
    if shown.is_turn:
        degrees = np.arange(0, 360, DOTS)
        dots = np.stack([np.interp(degrees, shown.x, values, period=360.0) for values in force])
        curves.append(Curve(dots[0], dots[1], ink=ink, line="", marker="o"))
        quarters = zip(degrees, dots.T, strict=True)
        notes = tuple(Note(float(x), float(y), f"{at}°") for at, (x, y) in quarters if not at % QUARTERS)
    return Panel(tuple(curves), f"Fx, {unit}", f"Fy, {unit}", (), notes, "equal", names="", title=title)


def _force_table(shown: ShownSheet) -> Table:
    """Size, direction and place of every joint's largest force."""
    angle = shown.own("rad")
    rows = tuple(
        (
            plain(one["joint"]),
            plain(one["link"]),
            force_words(shown, one["force"]),
            ABSENT if one["direction"] is None else f"{figure(one['direction'] / angle.size)} {angle.name}",
            shown.place(one["at"]),
        )
        for one in shown.sheet.figures["forces"]
    )
    head = ("joint", "on", "force", "direction", shown.where)
    return Table("A joint's force acts on the link named; directions count from x.", head, rows, align="llr")


def _links(shown: ShownSheet) -> Section:
    """The linkage in several positions, its links in the file's units with what each gives to the mean Jeq, notes."""
    linkage, facts = shown.sheet.linkage, shown.sheet.facts.get("links", {})
    units = [shown.own(si) for si in ("kg", "kg m²", "m")]
    means = {name: link["Jeq_mean"] for name, link in facts.items() if "Jeq_mean" in link}
    whole = sum(means.values())
    head = ("link", *(f"{word}, {unit.name}" for word, unit in zip(("m", "J", "mass centre"), units, strict=True)))
    rows = [_link_row(link, [unit.size for unit in units]) for link in linkage.links.values()]
    if whole:
        head += ("of mean Jeq",)
        shares = [f"{100.0 * means.get(name, 0.0) / whole:.1f} %" for name in linkage.links]
        rows = [(*row, share) for row, share in zip(rows, shares, strict=True)]
    note = f"Mass centres in the link's own frame; J about the mass centre, {ABSENT} where the link cannot turn."
    table = Table("The moving links as described.", head, tuple(rows), note=note)
    notes = (Bullets(linkage.notes),) if linkage.notes else ()
    cards = (*_scheme(shown), Card("Links", (table, *notes)))
    return Section(
        "made-of", "What it is made of", (Cards(cards, wide=True), *told(shown, *(shown.sheet.missing.keys() - WORDS)))
    )


def _scheme(shown: ShownSheet) -> tuple[Card, ...]:
    """The linkage to scale in positions of its motion."""
    sheet, positions = shown.sheet, shown.sheet.positions
    if positions is None:
        return ()
    output = f"; the blue line is the path of {sheet.linkage.output.point}" if sheet.linkage.output else ""
    caption = f"To scale in twelve positions, one of them drawn out; quartered discs are mass centres{output}."
    drawing = partial(scheme_figure, sheet.linkage, positions)
    return (Card("Positions", (shown.figure("scheme", caption, "kinematic scheme", drawing),)),)


def _link_row(link: Link, sizes: list[float]) -> tuple[str, ...]:
    mass, inertia, length = sizes
    least = ROUNDING * max(map(abs, link.centre))
    places = (0.0 if abs(value) <= least else value / length for value in link.centre)
    centre = ", ".join(f"{place:.4g}".replace("-", "−") for place in places)
    turning = ABSENT if link.inertia is None else printed(link.inertia / inertia)
    return plain(link.name), printed(link.mass / mass), turning, f"({centre})"


def facts(shown: ShownSheet) -> Facts:
    """The facts on the mechanism that hold for every motion: structure, range, output, rest, thread."""
    sheet = shown.sheet
    told = {"equilibria": [], **sheet.facts}
    said = [text.partition(": ")[::2] for text in lines("mechanism", facts=told) if not text.startswith("Jeq: ")]
    reach = range_lines(sheet.facts["range"]) if "range" in sheet.facts else ()
    structure = sheet.formula.replace("->", "→").replace("_", " ")
    return Facts((("structure", structure), *reach, *said))
