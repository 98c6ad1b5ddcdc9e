"""The interactive part of a page, or a sentence with the reason for its absence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any, Final, Literal

from analytic.description import loading
from analytic.description.changes import Number, Place, named_numbers
from analytic.description.linkage import GROUND, Linkage
from analytic.description.loading import WrittenNumbers, with_variant_written, written_numbers
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Revolute
from comparisons.datasheet.sheet import Sheet
from reports.document.parts import Part, Widget
from reports.live.model import Model, is_of_table, load_of, model

# A linkage's file as a template, in which a page puts other numbers: text and the places of numbers by turns.


MARK: Final = "\0"  # around the name of a number: no linkage file has this character


@dataclass(frozen=True)
class FileTemplate:
    """A file's text: every second one of the ``parts`` is the name of a number, which ``literals`` has as written."""

    parts: tuple[str, ...]
    literals: Mapping[str, str]


def templates(linkage: Linkage, names: Iterable[str]) -> list[FileTemplate]:
    """The file as it is, if its own values are meant, and the file with all numbers of the variant written out.

    A number that the first one lacks, as its file leaves it out or has it in another form, is in the second one.
    """
    text, name, names = linkage.text, linkage.name, tuple(names)
    own_variant = loading.document(text, name, name)[0].get("variant", "base")
    texts = [text] if linkage.variant == own_variant else []
    with suppress(LinkproofError):
        texts.append(with_variant_written(text, name, linkage.variant))
    return [_file_template(key, written_numbers(key, name, None).places, names) for key in texts]


def _file_template(text: str, places: Mapping[str, Place], names: Iterable[str]) -> FileTemplate:
    import tomlkit  # noqa: PLC0415 - only a page that can be pulled at pays for it
    from tomlkit.items import Float, Integer, Trivia  # noqa: PLC0415

    document = tomlkit.parse(text.removeprefix(loading.BYTE_ORDER_MARK))
    literals: dict[str, str] = {}
    for name in names:
        table: Any = document
        try:
            for key in places[name][:-1]:
                table = table[key]
            number = table[places[name][-1]]
        except (LookupError, TypeError):
            continue
        if isinstance(number, Float | Integer):
            literals[name] = number.as_string()
            table[places[name][-1]] = Float(0.0, Trivia(), f"{MARK}{name}{MARK}")
    return FileTemplate(tuple(tomlkit.dumps(document).split(MARK)), literals)


# Which numbers change where a point of a moving linkage is pulled: lengths about placed pins, places in a frame.


def pulls(mechanism: Mechanism) -> Mapping[str, list[dict[str, str]]]:
    """Of each point the effects of pulling at it on every "body" that has it; a pin that two links place has two.

    The "way" is "place", which moves the point in the body's frame, "length", its distance from the point "about"
    there, or "crank", that distance while the crank turns with it. A point by which a group hangs on placed links
    belongs to those.
    """
    linkage, structure = mechanism.linkage, mechanism.structure
    groups = {point: [{"body": GROUND, "way": "place", "about": ""}] for point in linkage.ground}

    def add_pull(point: str, body: str, way: Literal["place", "length", "crank"], about: str = "") -> None:
        if point not in linkage.ground:
            groups.setdefault(point, []).append({"body": body, "way": way, "about": about})

    if isinstance(structure.pivot, Revolute):
        for point in linkage.links[linkage.crank].points:
            add_pull(point, linkage.crank, "crank", structure.pivot.point)
    own = {slider.link: slider.point for slider in linkage.sliders}
    for dyad in structure.dyads:
        inner = dyad.inner_joint.point if isinstance(dyad.inner_joint, Revolute) else ""
        for name, outer in ((dyad.first, dyad.first_joint), (dyad.second, dyad.second_joint)):
            hangs = outer.point if isinstance(outer, Revolute) else ""
            for point in linkage.links[name].points if name in linkage.links else ():
                if point == inner:
                    if hangs:
                        add_pull(point, name, "length", hangs)
                elif point not in (hangs, own.get(name)):
                    add_pull(point, name, "place")
    return groups


# The interactive part of a page, or a sentence with the reason for its absence.

ROUNDING: Final = 1e-12  # relative: what the file's units leave of a number
UNITS: Final[dict[str, str]] = {"acceleration": "m/s²"}


def model_of(sheet: Sheet) -> Model | str:
    """The model of a sheet's linkage under its motion, or why the numbers of its page cannot be changed there."""
    try:
        return model(Mechanism(sheet.linkage), sheet.motion)
    except LinkproofError as error:
        return str(error)


def live_widget(sheet: Sheet, model: Model, instead: tuple[Part, ...]) -> Widget:
    """The widget of a model; ``instead`` stands where no script runs."""
    label = f"{sheet.linkage.title or sheet.name}: pull at points and numbers"
    data = {**model.data, **_numbers(model), **_drawing_data(model.mechanism)}
    return Widget("live", "live", label, data, {"model": model.source}, instead=instead)


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
        _number_row(
            name, every[name], file, [template.literals[name] for template in files if name in template.literals]
        )
        | {"role": role, "load": load_of(every[name], linkage)}
        for name, role in roles.items()
    ]
    for row in rows:
        row["offered"] &= row["role"] == "given" and row["load"] is None
    rows += [
        _extra_number(f"load {n + 1}", f"{label}, times", "scale", 1.0, "")
        for n, label in enumerate(_load_labels(linkage))
    ]
    if model.data["motion"]["speed"]:
        rows.append(_extra_number("speed", "speed", "speed", model.data["motion"]["speed"], "rpm"))
    return {
        "name": linkage.name,
        "numbers": rows,
        "files": [{"parts": template.parts, "literals": template.literals} for template in files],
        "length": {"unit": file.units["length"], "size": file.scale["length"]},
        "sketch": linkage.sketch_angle,
    }


def _number_row(name: str, number: Number, file: WrittenNumbers, literals: list[str]) -> dict[str, Any]:
    """The row of a number: group, label, unit, and its value in the file's unit and in SI.

    ``literals`` are its places in the file, as written: it is ``offered`` for change where the first is its value.
    """
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


def _load_labels(linkage: Linkage) -> Iterator[str]:
    yield from (f"force on {force.point}" for force in linkage.forces)
    yield from (f"torque on {torque.link}" for torque in linkage.torques)


def _extra_number(name: str, label: str, role: str, value: float, unit: str) -> dict[str, Any]:
    """A number that the page offers and the file does not have: a load's factor, or the speed."""
    row = {"name": name, "group": "motion and loads", "label": label, "value": value, "si": value, "unit": unit}
    return {**row, "size": 1.0, "role": role, "load": None, "offered": True}


def _drawing_data(mechanism: Mechanism) -> dict[str, Any]:
    """Data of the drawing: points of bodies in their frames, m, guides, springs, effects of pulling at a point."""
    linkage = mechanism.linkage
    guides = [(slider.link, slider.point, slider.guide, slider.link) for slider in linkage.sliders]
    guides += [("", slot.point, slot.guide, slot.name) for slot in linkage.slots]
    crank = mechanism.structure.pivot
    return {
        "bodies": {name: dict(link.points) for name, link in linkage.links.items()} | {GROUND: dict(linkage.ground)},
        "centres": [name for name, link in linkage.links.items() if link.mass and link.inertia is not None],
        "guides": [{"link": link, "point": point, "name": name} | asdict(guide) for link, point, guide, name in guides],
        "springs": [{"points": spring.points, "bodies": spring.links} for spring in linkage.springs],
        "output": linkage.output.point if linkage.output else "",
        "crank": linkage.crank,
        "pivot": getattr(crank, "point", ""),
        "pulls": pulls(mechanism),
    }
