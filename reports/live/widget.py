"""The interactive part of a page, or a sentence with the reason for its absence."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from analytic.description.changes import Number, named_numbers
from analytic.description.linkage import GROUND, Linkage
from analytic.description.rewriting import WrittenNumbers, written_numbers
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.sheet import Sheet
from reports.document.parts import JavaScript, Part, Widget
from reports.live.file_template import templates
from reports.live.handles import pulls
from reports.live.model import Model, is_of_table, load_of, model

ROUNDING: Final = 1e-12  # relative: what the file's units leave of a number
UNITS: Final[dict[str, str]] = {"acceleration": "m/s²"}


def model_of(sheet: Sheet) -> Model | str:
    """The model of a sheet's linkage under its motion, or why the numbers of its page cannot be changed there."""
    try:
        return model(Mechanism(sheet.linkage), sheet.motion)
    except LinkproofError as error:
        return str(error)


def live(sheet: Sheet, model: Model, instead: tuple[Part, ...]) -> Widget:
    """The widget of a model; ``instead`` stands where no script runs."""
    label = f"{sheet.linkage.title or sheet.name}: pull at points and numbers"
    data = {**model.data, **_numbers(model), **_drawn(model.mechanism)}
    return Widget("live", "live", label, data, {"model": JavaScript(model.source)}, instead=instead)


def _numbers(model: Model) -> dict[str, Any]:
    """Every number that the formulas are given or the file has, and the file as templates."""
    linkage, every = model.mechanism.linkage, named_numbers(model.mechanism.linkage)
    chosen = {name: number for name, number in every.items() if number.kind != "direction"}
    file = written_numbers(linkage.text, linkage.name, linkage.variant)
    files = templates(linkage, chosen)
    roles = dict.fromkeys(model.numbers, "given") | {
        name: "sketch" if name.startswith("sketch.") else "table"
        for name, number in chosen.items()
        if name.startswith("sketch.") or is_of_table(number, linkage)
    }
    rows = [
        _number(name, every[name], file, [template.literals[name] for template in files if name in template.literals])
        | {"role": role, "load": load_of(every[name], linkage)}
        for name, role in roles.items()
    ]
    for row in rows:
        row["offered"] &= row["role"] == "given" and row["load"] is None
    rows += [_pseudo(f"load {n + 1}", f"{label}, times", "scale", 1.0, "") for n, label in enumerate(_loads(linkage))]
    if model.data["motion"]["speed"]:
        rows.append(_pseudo("speed", "speed", "speed", model.data["motion"]["speed"], "rpm"))
    return {
        "name": linkage.name,
        "numbers": rows,
        "files": [{"parts": template.parts, "literals": template.literals} for template in files],
        "length": {"unit": file.units["length"], "size": file.scale["length"]},
        "sketch": linkage.sketch_angle,
    }


def _number(name: str, number: Number, file: WrittenNumbers, literals: list[str]) -> dict[str, Any]:
    """A number in the file's unit; what is not the file's, as gravity that is off, cannot be offered."""
    kind, *rest = number.place
    size, unit = file.scale.get(number.kind, 1.0), UNITS.get(number.kind) or str(file.units.get(number.kind, ""))
    literal = literals[0] if literals else "nan"
    is_same = abs(float(literal) * size - number.value) <= ROUNDING * abs(number.value)
    axes: dict[str | int, str] = {0: "x", 1: "y"}
    words = (axes.get(key, key) for key in rest[1:] if key not in ("points", "slides"))
    return {
        "name": name,
        "group": str(rest[0]) if kind == "links" else GROUND if kind == GROUND else "motion and loads",
        "label": " ".join(map(str, words)) if kind == "links" else name.removeprefix("ground.").replace(".", " "),
        "value": float(literal) if is_same else number.value / size,
        "si": number.value,
        "unit": unit.replace("*", " ").replace("^2", "²"),
        "size": size,
        "offered": is_same,
    }


def _loads(linkage: Linkage) -> Iterator[str]:
    yield from (f"force on {force.point}" for force in linkage.forces)
    yield from (f"torque on {torque.link}" for torque in linkage.torques)


def _pseudo(name: str, label: str, role: str, value: float, unit: str) -> dict[str, Any]:
    row = {"name": name, "group": "motion and loads", "label": label, "value": value, "si": value, "unit": unit}
    return {**row, "size": 1.0, "role": role, "load": None, "offered": True}


def _drawn(mechanism: Mechanism) -> dict[str, Any]:
    """Data of the drawing: points of bodies in their frames, m, guides, springs, effects of pulling at a point."""
    linkage = mechanism.linkage
    guides = [(slider.link, slider.point, slider.guide, slider.link) for slider in linkage.sliders]
    guides += [("", slot.point, slot.guide, slot.name) for slot in linkage.slots]
    crank = mechanism.structure.pivot
    return {
        "bodies": {name: dict(link.points) for name, link in linkage.links.items()} | {GROUND: dict(linkage.ground)},
        "centres": [name for name, link in linkage.links.items() if link.mass and link.inertia is not None],
        "guides": [
            {
                "link": link,
                "point": point,
                "host": guide.host,
                "name": name,
                "through": guide.through,
                "along": guide.along,
            }
            for link, point, guide, name in guides
        ],
        "springs": [{"points": spring.points, "bodies": spring.links} for spring in linkage.springs],
        "output": linkage.output.point if linkage.output else "",
        "crank": linkage.crank,
        "pivot": getattr(crank, "point", ""),
        "pulls": {
            point: [pull._asdict() for pull in several] for point, several in pulls(mechanism).items() if several
        },
    }
