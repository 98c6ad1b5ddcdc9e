"""The part of a page that can be pulled at: its linkage computed anew in the browser, its file with new numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any, Final, Literal

import numpy as np

from analytic import signals
from analytic.description import loading
from analytic.description.changes import SPEED, named_numbers
from analytic.description.crank_motion import RPM, CrankMotion
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import GROUND, Linkage
from analytic.description.loading import WrittenNumbers, with_variant_written, written_numbers
from analytic.description.walk import Keys, Number
from analytic.description.written import file_unit
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Revolute
from analytic.machine_code import (
    ACCELERATION,
    PHI,
    ZERO_OF_S,
    LinkageTrace,
    Program,
    is_traceable,
    linkage_trace,
    plain_program,
)
from comparisons.designer.building import OVER_RANGE
from comparisons.designer.open_ends import MARGIN, open_ends
from comparisons.designer.sheet import Sheet
from reports.document.packed import Array, packed
from reports.document.parts import Part, Widget

# A linkage's file as a template, in which a page puts other numbers: text and the places of numbers by turns.


MARK: Final = "\0"  # around the name of a number: no linkage file has this character


@dataclass(frozen=True)
class FileTemplate:
    """A file's text: every second one of the ``parts`` is the name of a number, which ``literals`` has as written."""

    parts: tuple[str, ...]
    literals: Mapping[str, str]


def templates(linkage: Linkage, names: Iterable[str]) -> list[FileTemplate]:
    """The linkage file as templates: as it is, if its own values are meant, and with the variant's numbers written out.

    ``names`` are those of the numbers in them. A number that the first one lacks, as its file leaves it out or has it
    in another form, is in the second one, which there is if the file can be written so. There may be one of them or
    none.
    """
    text, name, names = linkage.text, linkage.name, tuple(names)
    own_variant = loading.document(text, name, name)[0].get("variant", "base")
    texts = [text] if linkage.variant == own_variant else []
    with suppress(LinkproofError):
        texts.append(with_variant_written(text, name, linkage.variant))
    return [_file_template(key, written_numbers(key, name, None).places, names) for key in texts]


def _file_template(text: str, places: Mapping[str, Keys], names: Iterable[str]) -> FileTemplate:
    """The text of a file as a template of these numbers, whose ``places`` are given, the keys down to each.

    Those that the file lacks, or has in another form than a plain number, are left out. Raises KeyError for a name
    without a place.
    """
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
    """The effects of pulling at each point, by the point: one for every "body" that carries it, JSON-ready.

    The "way" is "place", which moves the point in the body's frame, "length", its distance from the point "about"
    there, or "crank", that distance while the crank turns with it. A point by which a group hangs on placed links
    belongs to those; a slider's own point, and links of groups without a closed form, have none.
    """
    linkage, structure = mechanism.linkage, mechanism.structure
    groups = {point: [{"body": GROUND, "way": "place", "about": ""}] for point in linkage.ground}

    def add_pull(point: str, body: str, way: Literal["place", "length", "crank"], about: str = "") -> None:
        """Add an effect of pulling at a point to ``groups``, unless the point is on the ground."""
        if point not in linkage.ground:
            groups.setdefault(point, []).append({"body": body, "way": way, "about": about})

    if isinstance(structure.pivot, Revolute):
        for point in linkage.links[linkage.crank].points:
            add_pull(point, linkage.crank, "crank", structure.pivot.point)
    own = {slider.link: slider.point for slider in linkage.sliders}
    for group in structure.dyads:
        inner = next((joint.point for joint in group.joints[1:-1] if isinstance(joint, Revolute)), "")
        for name, outer in zip(group.links, (group.joints[0], group.joints[-1]), strict=False):
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


def model_of(sheet: Sheet) -> Model | str:
    """The model of a sheet's linkage and motion, or, as a text, the reason why its page can change no numbers."""
    try:
        return model(Mechanism(sheet.linkage), sheet.motion)
    except LinkproofError as error:
        return str(error)


def live_widget(sheet: Sheet, model: Model | str, instead: tuple[Part, ...]) -> Widget:
    """The widget with the drawing and curves of a sheet; ``instead`` is shown where no script runs.

    Without a model, but a reason as ``model_of`` gives it, it holds samples of the motion, and nothing can be changed.
    """
    label = f"{sheet.linkage.title or sheet.name} in motion"
    mechanism, length = Mechanism(sheet.linkage), sheet.file_unit_of("m")
    data = {
        "name": sheet.linkage.name,
        "length": {"unit": length.name, "size": length.size},
        "results": [_result_data(name, mechanism) for name in results(mechanism)],
        **_drawing_data(mechanism),
    }
    if isinstance(model, str):
        further, columns = _samples(sheet, mechanism)
        data |= {**_sampled(sheet), "pulls": {}, "further": further}
        return Widget("live", "live", label, data, {"model": {"samples": columns}}, instead=instead)
    data |= {**model.data, **_numbers(model)}
    return Widget("live", "live", label, data, {"model": model.program}, instead=instead)


FEWEST, MOST, PER_TURN = 721, 2401, 181  # samples of a motion that is not computed anew
MOST_NUMBERS: Final = 200_000  # of all its results


def _sampled(sheet: Sheet) -> dict[str, Any]:
    """The data of a widget without formulas, JSON-ready: no numbers, and a motion with its duration, s, and kind."""
    time = sheet.values["time"]
    motion = {
        "duration": float(time.max() - time.min()),
        "steady": sheet.axis == "phi",
        "linear": sheet.linkage.is_linear,
        "turns": sheet.is_turn,
        "speed": 0.0,
        "range": 0.0,
    }
    return {"isSampled": True, "motion": motion, "numbers": [], "groups": []}


def _samples(sheet: Sheet, mechanism: Mechanism) -> tuple[list[str], dict[str, Any]]:
    """The names of sampled arrows, and the packed values of φ, results and arrows at instants evenly spaced in time.

    Arrows are the components of velocities, accelerations and loads, SI. Poses follow from φ.
    """
    order = np.argsort(sheet.values["time"])
    known = {name: values[order] for name, values in sheet.values.items()}
    turns = float(np.sum(np.abs(np.diff(known["phi"])))) / FULL_TURN
    names = results(mechanism)
    count = min(max(FEWEST, PER_TURN * turns), MOST, MOST_NUMBERS / len(names))
    time = np.linspace(known["time"][0], known["time"][-1], int(count))
    phi, omega, epsilon = (np.interp(time, known["time"], known[name]) for name in ("phi", "omega", "epsilon"))
    sweep = mechanism.sweep(phi)
    arrows: dict[str, Array] = {}
    for point in {name.split(":")[1]: None for name in names if name.startswith("point:")}:
        first, second = (np.asarray(sweep.point(point, order)) for order in (1, 2))
        arrows |= _pair(f"velocity:{point}", first * omega)
        arrows |= _pair(f"acceleration:{point}", second * omega**2 + first * epsilon)
    for n, load in enumerate(mechanism.linkage.forces):
        x, y = sweep.load(load.force, omega)
        angle = 0.0 if load.frame == GROUND else sweep.angles(load.frame)
        c, s = np.cos(angle), np.sin(angle)
        arrows |= _pair(f"load:{n}", np.broadcast_to(np.array([c * x - s * y, s * x + c * y]), (2, len(phi))))

    def curve(name: str) -> Array:
        """A signal (n,), SI, at the instants: a link's angle, a point's coordinate, or one of the sheet's by name.

        Raises KeyError for one that the sheet lacks.
        """
        kind, _, rest = name.partition(":")
        if kind == "link":
            return np.asarray(sweep.angles(rest.removesuffix(":angle")))
        if kind == "point":
            return np.asarray(sweep.point(rest[:-2])["xy".index(rest[-1])])
        return np.interp(time, known["time"], known[name])

    return list(arrows), packed(phi, *(curve(name) for name in names), *arrows.values())


def _pair(name: str, values: Array) -> dict[str, Array]:
    """The components of a vector (2, n) by name, ``name:x`` and ``name:y``."""
    return {f"{name}:{axis}": value for axis, value in zip("xy", values, strict=True)}


def _numbers(model: Model) -> dict[str, Any]:
    """The data of every number of the formulas and the file, with the file as templates, JSON-ready.

    Under "numbers" a row for each, "files" the templates, "sketch" the angle of the sketch, rad.
    """
    linkage, every = model.mechanism.linkage, named_numbers(model.mechanism.linkage)
    chosen = {name: number for name, number in every.items() if number.kind != "direction"}
    file = written_numbers(linkage.text, linkage.name, linkage.variant)
    files = templates(linkage, chosen)
    roles = dict.fromkeys(model.numbers, "given") | {
        name: "sketch" if name.startswith("sketch.") else "table"
        for name, number in chosen.items()
        if name.startswith("sketch.") or is_of_table(number, linkage)
    }
    rows = []
    for name, role in roles.items():
        literals = [template.literals[name] for template in files if name in template.literals]
        row, load = _number_row(name, every[name], file, literals), load_of(every[name], linkage)
        rows.append({**row, "role": role, "load": load, "offered": row["offered"] and role == "given" and load is None})
    labels = [f"force on {force.point}" for force in linkage.forces]
    labels += [f"torque on {torque.link}" for torque in linkage.torques]
    rows += [_extra_number(f"load {n}", f"{label}, times", "scale", 1.0, "") for n, label in enumerate(labels, start=1)]
    if model.data["motion"]["speed"]:
        rows.append(_extra_number("speed", "speed", "speed", model.data["motion"]["speed"], "rpm"))
    return {
        "numbers": rows,
        "files": [{"parts": template.parts, "literals": template.literals} for template in files],
        "sketch": linkage.sketch_angle,
    }


def _number_row(name: str, number: Number, file: WrittenNumbers, literals: list[str]) -> dict[str, Any]:
    """The row of a number: group, label, unit, and its value in the file's unit and in SI.

    ``literals`` are its texts in the file's templates, as written: it is "offered" for change where the first is its
    value.
    """
    kind, *rest = file.places[name]
    unit = file.unit(number.kind)
    literal = literals[0] if literals else "nan"
    is_same = abs(float(literal) * unit.size - number.value) <= ROUNDING * abs(number.value)
    axes: dict[str | int, str] = {0: "x", 1: "y"}
    words = (axes.get(key, key) for key in rest[1:] if key not in ("points", "slides"))
    return {
        "name": name,
        "group": str(rest[0]) if kind == "links" else GROUND if kind == GROUND else "motion and loads",
        "label": " ".join(map(str, words)) if kind == "links" else name.removeprefix("ground.").replace(".", " "),
        "value": float(literal) if is_same else number.value / unit.size,
        "si": number.value,
        "unit": unit.on_page,
        "size": unit.size,
        "offered": is_same,
    }


def _extra_number(name: str, label: str, role: str, value: float, unit: str) -> dict[str, Any]:
    """The row of a number that the file lacks but the page offers: a load's factor, or the speed; JSON-ready.

    ``role`` is "scale" or "speed", ``value`` is in the ``unit``.
    """
    row = {"name": name, "group": "motion and loads", "label": label, "value": value, "si": value, "unit": unit}
    return {**row, "size": 1.0, "role": role, "load": None, "offered": True}


def _drawing_data(mechanism: Mechanism) -> dict[str, Any]:
    """Data of the drawing, JSON-ready: points of bodies and mass centres in their frames, m, guides, springs, cylinder.

    And joints, loads, output, crank with its pivot, and ``pulls``.
    """
    linkage = mechanism.linkage
    guides = [(slider.link, slider.point, slider.guide, slider.link) for slider in linkage.sliders]
    guides += [("", slot.point, slot.guide, slot.name) for slot in linkage.slots]
    crank = mechanism.structure.pivot
    return {
        "bodies": {name: dict(link.points) for name, link in linkage.links.items()} | {GROUND: dict(linkage.ground)},
        "centres": {
            name: list(link.centre) for name, link in linkage.links.items() if link.mass and link.inertia is not None
        },
        "guides": [{"link": link, "point": point, "name": name} | asdict(guide) for link, point, guide, name in guides],
        "springs": [{"points": spring.points, "bodies": spring.links} for spring in linkage.springs],
        "cylinder": linkage.cylinder.points if linkage.cylinder else None,
        "joints": list(_joints(linkage)),
        "loads": [
            {
                "number": n,
                "point": load.point,
                "frame": load.frame,
                "force": load.force(0.0).tolist() if load.force.is_constant else None,
                "law": _law_data(load.force, mechanism) if load.force.over == "S" else None,
                "when": load.force.when,
            }
            for n, load in enumerate(linkage.forces)
        ],
        "output": linkage.output.point if linkage.output else "",
        "crank": linkage.crank,
        "pivot": getattr(crank, "point", ""),
        "pulls": pulls(mechanism),
    }


def _joints(linkage: Linkage) -> Iterator[dict[str, str]]:
    """Yield a dict for every joint, for the arrows of forces: its "name", its "point", the loaded link as "on"."""
    for pin in linkage.pins:
        yield from ({"name": joint, "point": pin.point, "on": link} for joint, link in pin.joints.items())
    for slider in linkage.sliders:
        yield {"name": slider.name, "point": slider.point, "on": slider.link}
    carriers = {point: name for name, link in linkage.links.items() for point in link.points}
    for slot in linkage.slots:
        yield {"name": slot.name, "point": slot.point, "on": carriers.get(slot.point, GROUND)}


# A linkage as a page computes it: its formulas printed in JavaScript, its numbers, loads and motion as plain data.


MOST_OPERATIONS: Final = 12_000
LEFT_OUT: Final = ("phi", "omega", "epsilon", signals.THREAD_FEED)  # the motion itself; what needs a search
VELOCITIES: Final = (":vx", ":vy", ":ax", ":ay", ":omega", ":alpha")
ALWAYS: Final = (PHI, SPEED, ACCELERATION, ZERO_OF_S)  # of a row, in this order


@dataclass(frozen=True)
class Model:
    """The ``program`` of a linkage's function, the ``numbers`` that it is given by name, and what else it takes.

    That is ``data``, JSON-ready: laws of loads, motion, and the groups of the linkage.
    """

    mechanism: Mechanism
    program: Program
    numbers: tuple[str, ...]
    data: Mapping[str, Any]


def model(mechanism: Mechanism, motion: CrankMotion | None) -> Model | str:
    """The Model of a linkage under a motion, or the reason in words why it has none; motion None is a released crank.

    Raises LinkproofError where its dead positions cannot be computed.
    """
    if mechanism.is_numerical:
        return "one of its groups has no formula and is solved by Newton's method"
    if not is_traceable(mechanism):
        branches = "it passes change points, where its formulas branch"
        return "its joints have friction, which is found by iteration" if mechanism.linkage.friction else branches
    if motion is None:
        return "its crank is released, so that the motion follows from masses and loads"
    if not motion.peak_speed:
        return "its crank stands still"
    listed = _trace_signals(mechanism, motion)
    looked_up = [hashable for hashable in listed.trace.inputs if isinstance(hashable, tuple)]
    if len(listed.trace.operations) > MOST_OPERATIONS or any(order for _, order, _ in looked_up):
        return "its formulas are too many to be computed while a number is pulled"
    needed = set(listed.trace.lines_needed(listed.lines))
    numbers = tuple(name for name in sorted(listed.varied) if listed.trace.inputs[name] in needed)
    lines = [listed.trace.inputs.get(entries, -1) for entries in (*ALWAYS, *looked_up)]
    program = plain_program(listed.trace, [listed.trace.inputs[name] for name in numbers], lines, listed.lines)
    laws = list(dict.fromkeys(law for law, _, _ in looked_up))
    cylinder = mechanism.linkage.cylinder
    has_ends = cylinder is not None and cylinder.has_ends
    data = {
        "rows": [[laws.index(law), component] for law, _, component in looked_up],
        "laws": [_law_data(law, mechanism) for law in laws],
        "overTravel": ZERO_OF_S in listed.trace.inputs,
        "motion": {
            **_motion(motion, is_linear=mechanism.linkage.is_linear, has_ends=has_ends),
            "open": _open_places(mechanism, motion),
        },
        "groups": [
            {"name": dyad.name, "point": getattr(dyad.joints[1], "point", "")} for dyad in mechanism.structure.dyads
        ],
    }
    return Model(mechanism, program, numbers, data)


def results(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the signals that a page computes: those it draws, plots or tells in key figures."""
    every = signals.names_with_magnitudes(mechanism)
    return tuple(name for name in every if name not in LEFT_OUT and not name.endswith(VELOCITIES))


def loads(linkage: Linkage) -> list[Law]:
    """The laws of all forces, then of all torques, in the order in which the page scales them."""
    return [*(load.force for load in linkage.forces), *(load.torque for load in linkage.torques)]


def load_of(number: Number, linkage: Linkage) -> int | None:
    """The index, among ``loads``, of the load that a number of the linkage belongs to; None for any other number."""
    kind, index, *_ = number.path
    if kind not in ("forces", "torques") or not isinstance(index, int):
        return None
    return index if kind == "forces" else len(linkage.forces) + index


def is_of_table(number: Number, linkage: Linkage) -> bool:
    """Whether a number belongs to the table of a load over φ, which the page looks up."""
    load = load_of(number, linkage)
    return load is not None and loads(linkage)[load].angles is not None and loads(linkage)[load].over == "phi"


def _trace_signals(mechanism: Mechanism, motion: CrankMotion) -> LinkageTrace:
    """The list of operations of the page's signals; the numbers that a page may change are its inputs.

    Raises LinkproofError for a linkage that is not traceable.
    """
    every = named_numbers(mechanism.linkage).items()
    free = {
        name for name, number in every
        if number.kind != "direction" and number.path[0] != "sketch" and not is_of_table(number, mechanism.linkage)
    }  # fmt: skip
    accelerates = any(len(segment.coefficients) > 2 for segment in motion.segments)
    return linkage_trace(mechanism, free, results(mechanism), accelerates=accelerates)


def _law_data(law: Law, mechanism: Mechanism) -> dict[str, Any]:
    """A load's law for the page: knots, cubics, period, 0 without one, corners, and its index among the loads.

    Raises ValueError for a law that is none of the mechanism's loads, each compared by identity.
    """
    knots, pieces = law.pieces()
    load = [curve is law for curve in loads(mechanism.linkage)].index(True)
    return {"knots": knots, "pieces": pieces, "period": law.period or 0, "corners": law.corners, "load": load}


def _motion(motion: CrankMotion, *, is_linear: bool, has_ends: bool) -> dict[str, Any]:
    """The data of a motion: its pieces and, if it has only one speed, that speed, rpm, to be changed; JSON-ready.

    That speed is 0 for others. ``has_ends`` is a cylinder's. "range" is the share by which the ends of a motion over
    the crank's range stay short of its limits, else 0.
    """
    segments = [[segment.start, segment.end, list(segment.coefficients)] for segment in motion.segments]
    first = motion.segments[0].coefficients
    is_steady = len(segments) == 1 and len(first) == 2
    turns = is_steady and not is_linear and abs(abs(first[1]) * motion.duration - FULL_TURN) < 1e-9
    speed = first[1] if is_steady else motion.peak_speed if motion.regime == OVER_RANGE else 0.0
    return {
        "segments": segments,
        "duration": motion.duration,
        "speed": 0.0 if is_linear else float(f"{speed / RPM:.12g}"),
        "steady": is_steady,
        "range": MARGIN if is_steady and not (turns or has_ends) and motion.regime == OVER_RANGE else 0.0,
        "turns": turns,
        "linear": is_linear,
    }


def _open_places(mechanism: Mechanism, motion: CrankMotion) -> list[float]:
    """The ends, φ in rad or m, of a motion that lie beside a dead position, lower first; [] without any."""
    first, last = (float(motion.angle(np.array([time]))[0]) for time in (0.0, motion.duration))
    return [end.place for end in open_ends(mechanism, first, last)]


def _result_data(name: str, mechanism: Mechanism) -> dict[str, Any]:
    """A signal for the page: its name, its unit in the file, and the unit's size, SI; JSON-ready."""
    unit = file_unit(signals.unit(name, mechanism.linkage), mechanism.linkage)
    return {"name": name, "unit": unit.on_page, "size": unit.size}
