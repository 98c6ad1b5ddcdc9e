"""Results for a terminal: key figures of a motion, or every signal at chosen instants, in the units of the file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

from analytic.signals import COMPONENTS, MAGNITUDE
from analytic.written import fixed
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.figures import NEGLIGIBLE, stroke
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.units import FileUnit, file_unit
from reports.document.numbers import ABSENT, figure
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed

CRANK: Final = (("omega", "epsilon", "Mkr", "Peq"), ("Teq", "Jeq", "S", "v", "a"))  # two tables of the crank's instants


def key_figures(results: DesignerResults) -> list[Printed]:
    """Drive, forces, transmission angles and output, each with where its peak is."""
    parts: list[Printed] = [Paragraph(results.conditions, colour="bold")]
    for part in (_drive(results), _forces(results), _transmission(results), _output(results)):
        parts += ["", *part] if part else []
    return [*parts, "", *_remarks(results), *_warnings(results)]


def _warnings(results: DesignerResults) -> list[Printed]:
    """What looks like a slip in the file, as ``linkproof check`` has it."""
    return [Paragraph(f"warning: {text}", colour="yellow") for text in warnings(results.linkage)]


def _where(results: DesignerResults) -> tuple[str, ...]:
    """Heads of the columns that say where a peak is."""
    angle = f"at φ {results.unit('phi').name}"
    return (angle,) if results.axis == "phi" else ("at t s", angle)


def _place(results: DesignerResults, time: float | None) -> tuple[str, ...]:
    if time is None:
        return (ABSENT,) * len(_where(results))
    angle = _angle(results.shown_angle(time), results.unit("phi"))
    return (angle,) if results.axis == "phi" else (f"{time:#.6g}", angle)


def _angle(value: float, unit: FileUnit) -> str:
    """Degrees to two decimals, radians and lengths to five digits."""
    return fixed(value, 2) if unit.name == "deg" and math.isfinite(value) else figure(value, 5)


def _drive(results: DesignerResults) -> list[Printed]:
    if not results.drive:
        return []
    torque, speed = results.unit("Mkr"), results.speed_unit
    name = "force" if results.is_linear else "torque"
    head = ("drive", f"{name} {torque.name}", f"speed {speed.name}", "power W", *_where(results))
    rows = []
    for point in results.drive:
        what = point.what.replace("torque", name)
        power = point.power if abs(point.power) > NEGLIGIBLE * results.scale("Peq") else 0.0
        values = (point.torque / torque.size, point.speed / speed.size, power)
        rows.append((what, *map(figure, values), *_place(results, point.time)))
    return [Table("", head, rows)]


def _forces(results: DesignerResults) -> list[Printed]:
    if not results.forces:
        return []
    force, angle = file_unit("N", results.linkage), file_unit("rad", results.linkage)
    head = ("joint", "on", f"force {force.name}", f"direction {angle.name}", *_where(results))
    rows = [
        (
            p.joint,
            p.link,
            figure(p.force / force.size),
            _angle(p.direction / angle.size, angle),
            *_place(results, p.time),
        )
        for p in results.forces
    ]
    value, time = results.curves.peaks(["shaking_moment"])["shaking_moment"]
    moment = results.unit("shaking_moment")
    head_moment = ("shaking moment", f"{moment.name}", *_where(results))
    about = f"about {results.moment_centre}"
    row = (about, figure(value / moment.size), *_place(results, time))
    return [Table("", head, rows, "llr"), "", Table("", head_moment, [row])]


def _transmission(results: DesignerResults) -> list[Printed]:
    if not results.transmission:
        return []
    angle = file_unit("rad", results.linkage)
    head = ("group", f"least transmission angle {angle.name}", *_where(results))
    rows = [
        (one.what, _angle(one.value / angle.size, angle), *_place(results, one.time)) for one in results.transmission
    ]
    return [Table("", head, rows)]


def _output(results: DesignerResults) -> list[Printed]:
    output = results.linkage.output
    if output is None:
        return []
    head = (f"output {output.point}", "", "", *_where(results))
    length = results.unit("S")
    rows = [("stroke", figure(stroke(results.output) / length.size), length.name, *_place(results, None))]
    for one in results.output:
        unit = results.unit(one.signal)
        value = one.value if abs(one.value) > NEGLIGIBLE * results.scale(one.signal) else 0.0
        rows.append((one.what, figure(value / unit.size), unit.name, *_place(results, one.time)))
    return [Table("", head, rows, "lrlr")]


def _remarks(results: DesignerResults) -> Iterator[Printed]:
    """Signs, and what the file does not give and so has no row."""
    if results.drive:
        turning = "along the drive" if results.is_linear else "counter-clockwise"
        yield f"Positive is {turning}; a joint's force acts on the link named; directions count from x."
    else:
        yield "No torques and forces: no link has mass, and there are no loads."
    if not all(math.isfinite(peak.force) for peak in results.forces):
        yield "Joint forces have no bound at the change point that the motion passes, so none are given there."
    if results.case.mechanism.is_numerical:
        yield "A group without a formula is solved by Newton's method: the figures are a numerical reference."
    if results.linkage.output is None:
        yield "No S, v and a: the file names no output."


def at_instants(results: DesignerResults) -> list[Printed]:
    """Every signal at the chosen instants: crank and output, points, links, joints."""
    parts: list[Printed] = [Paragraph(results.conditions, colour="bold")]
    for names in CRANK:
        parts += _of_crank(results, [name for name in names if results.curves.has(name)])
    for kind, head in (("point", "point"), ("link", "link"), ("joint_force", "force in"), ("shaking_force", "force")):
        parts += _of_kind(results, kind, head)
    return [*parts, "", *_remarks(results), *_warnings(results)]


def _of_crank(results: DesignerResults, names: Sequence[str]) -> list[Printed]:
    if not names:
        return []
    head = [*_instant_head(results), *(_headed(results, name, name) for name in names)]
    columns = [_column(results, name) for name in names]
    rows = [(*where, *cells) for where, cells in zip(_instants(results), zip(*columns, strict=True), strict=True)]
    return ["", Table("", head, rows, "r")]


def _of_kind(results: DesignerResults, kind: str, title: str) -> list[Printed]:
    """A table of all signals of a kind, a row for every part and instant."""
    parts = dict.fromkeys(name.rpartition(":")[0] for name in results.curves.names if name.startswith(f"{kind}:"))
    if not parts:
        return []
    components = [f":{component}" for component in COMPONENTS[kind]] + ([MAGNITUDE] if "force" in kind else [])
    first = next(iter(parts))
    labels = ["|F|" if one == MAGNITUDE else f"F{one[1:]}" if "force" in kind else one[1:] for one in components]
    head = [title, *_instant_head(results)]
    head += [_headed(results, first + one, label) for one, label in zip(components, labels, strict=True)]
    rows: list[tuple[str, ...]] = []
    for part in parts:
        columns = [_column(results, part + one) for one in components]
        name = part.partition(":")[2] or "shaking"
        for row, (where, cells) in enumerate(zip(_instants(results), zip(*columns, strict=True), strict=True)):
            rows.append(("" if row else name, *where, *cells))
    return ["", Table("", head, rows)]


def _headed(results: DesignerResults, name: str, label: str) -> str:
    return f"{label} {results.unit(name).name}"


def _instant_head(results: DesignerResults) -> tuple[str, ...]:
    angle = f"φ {results.unit('phi').name}"
    return (angle,) if results.axis == "phi" else ("t s", angle)


def _instants(results: DesignerResults) -> list[tuple[str, ...]]:
    angles = [f"{round(results.shown_angle(float(time)), 9) + 0.0:.6g}" for time in results.instants.shown]
    if results.axis == "phi":
        return [(angle,) for angle in angles]
    return [(f"{time:.6g}", angle) for time, angle in zip(results.instants.shown, angles, strict=True)]


def _column(results: DesignerResults, name: str) -> list[str]:
    """A signal at the chosen instants; what is zero but for rounding beside the others of its kind is zero."""
    values, size = results.curves.of(results.shown, name), results.unit(name).size
    least = NEGLIGIBLE * results.scale(name)
    return [figure(0.0 if abs(value) <= least else value / size) for value in values]
