"""From a validated document to a Linkage: SI units once, pins from shared names, and the checks that need meaning."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Final

import numpy as np

from analytic.description import linkage as lk
from analytic.description import schema as doc
from analytic.description.crank_motion import (
    LAWS,
    REGIMES,
    CrankMotion,
    Move,
    check_times,
    sequence,
    swing,
    table_motion,
)
from analytic.description.diagnosis import EXPECTED, Source
from analytic.description.law import Law, TimeLaw
from analytic.description.linkage import (
    BETWEEN_LINKS,
    GROUND,
    LOADS,
    FileRegime,
    Linkage,
    LinkTorque,
    PointForce,
    PrescribedRegime,
    ReleasedRegime,
    Spring,
    ThreadEye,
    ThreadGuide,
    ThreadPath,
    Vector,
)
from analytic.description.lookup import Reader, interpolated_law, law_over_angle, position, reader_of
from analytic.description.units import Kind
from analytic.description.walk import number_fields
from analytic.errors import LinkproofError, UnknownNameError, listed

# The loads of a linkage file: forces at points, torques on links, springs and dampers, in SI units, in its order.

PAIR = "links = [...]"  # names the bodies of two points


def loads(reader: Reader) -> dict[str, Any]:
    """All loads of the file, SI: by kind, one of ``LOADS``, those of this kind as a tuple in the file's order.

    A force or torque on the ground has no effect and is left out. Raises DescriptionError for wrong bodies, points or
    tables.
    """
    makers: dict[str, Callable[..., Any]] = {"forces": _force, "torques": _torque, "springs": _spring}
    result = {}
    for kind in LOADS:
        maker: Callable[..., Any] = makers.get(kind, _between_links)
        tables = enumerate(getattr(reader.document, kind))
        every = [maker(reader, table, f"{kind}.{number}", number) for number, table in tables]
        result[kind] = tuple(load for load in every if getattr(load, "link", None) != GROUND)
    return result


def _force(reader: Reader, table: doc.ForceTable, where: str, number: int) -> PointForce:
    """A force at a point, SI, from its table, the file's ``number``, from 0.

    ``where`` is its key, "forces.0", for messages. Raises DescriptionError for wrong bodies, an unknown point, and keys
    that do not go together.
    """
    rows = table.force if isinstance(table.force, list) else [table.force]
    link, reaction = _bodies_of_load(reader, table, table.link, where)
    link = reader.owner(table.point, link, where)
    frame = reader.body(table.frame, f"{where}.frame")
    return PointForce(table.point, link, interpolated_law(reader, table, rows, where), number, frame, reaction)


def _torque(reader: Reader, table: doc.TorqueTable, where: str, number: int) -> LinkTorque:
    """A torque on a link, SI, from its table, the file's ``number``, from 0.

    ``where`` is its key, "torques.0", for messages. Raises DescriptionError for wrong bodies or none, and for keys that
    do not go together.
    """
    values = table.torque if isinstance(table.torque, list) else [table.torque]
    law = interpolated_law(reader, table, [(value,) for value in values], where)
    link, reaction = _bodies_of_load(reader, table, table.link, where)
    if link is None:
        raise reader.fail(f"{where}.link is missing: expected {EXPECTED['link']}; add it, or between = [link, other]")
    return LinkTorque(reader.body(link, where), law, number, reaction)


def _bodies_of_load(
    reader: Reader, table: doc.LoadTable, link: str | None, where: str
) -> tuple[str | None, str | None]:
    """The body on which a load acts and the one on which its reverse acts, each None if the file names none.

    ``link`` is what the table names as such, ``where`` the load's key, for messages; without ``between`` the link is
    returned as it is. Raises DescriptionError for a wrong ``between``.
    """
    if table.between is None:
        return link, None
    first, second = (reader.body(name, f"{where}.between") for name in table.between)
    if first == second or link not in (None, first):
        raise reader.fail(
            f"{where}.between: expected the loaded link and another body that takes the reaction, got '{first}' and "
            f"'{second}'{f' beside link = {link!r}' if link else ''}; correct it"
        )
    if first == GROUND:
        raise reader.fail(f"{where}.between: expected a link first, on which the load acts, got '{GROUND}'; swap them")
    return first, second


def _spring(reader: Reader, table: doc.SpringTable, where: str, _: int) -> Spring:
    """A spring with its dashpot, SI, from its table; ``where`` is its key, "springs.0", for messages.

    Raises DescriptionError for an unknown point, a body that does not carry it, or both ends on one body.
    """
    ends = zip(table.between, table.links or (None, None), strict=True)
    first, second = (reader.owner(point, link, where, PAIR) for point, link in ends)
    if first == second:
        raise reader.fail(
            f"{where}: expected ends on two different bodies, got both on '{first}', where nothing stretches; attach "
            "the other end elsewhere"
        )
    given = "length" in table.model_fields_set
    return Spring(table.between, (first, second), table.stiffness, table.length, table.damping, given)


def _between_links(reader: Reader, table: Any, where: str, _: int) -> Any:  # noqa: ANN401 - as the kind has it
    """A torsion spring or damper, SI, from its table; ``where`` is its key, "dampers.0", which also says the kind.

    Raises DescriptionError for an unknown body, or one named twice.
    """
    first, second = (reader.body(name, where) for name in table.between)
    if first == second:
        raise reader.fail(f"{where}: expected two different bodies, got '{first}' twice; correct one of them")
    kind = BETWEEN_LINKS[where.partition(".")[0]]
    return kind((first, second), **{name: getattr(table, name) for name in number_fields(kind)})


# The regimes of a linkage file: a released crank, or a motion that its crank follows, in SI units.


USUAL_LAW: Final = "constant-speed"
# Of each kind of regime, the keys that it takes, the first of them what tells it from the others.
KINDS: Final[Mapping[str, tuple[str, ...]]] = {
    "segments": ("segments", "start_angle"),
    "swing": ("to", "from", "speed", "time", "law", "dwell", "back"),
    "table": ("angle", "time"),
    "released crank": ("torque", "start_angle", "start_speed", "duration", "angle", "time"),
}


def regime_of(reader: Reader, name: str) -> FileRegime:
    """The regime of this name in a linkage file, SI.

    Raises DescriptionError for the name of a prescribed motion, for keys that do not belong together or are missing,
    and for numbers that make no motion.
    """
    table, where = reader.document.regimes[name], f"regimes.{name}"
    if name in (*REGIMES, *LAWS):
        raise reader.fail(f"{where}: expected a name of its own, got that of a prescribed regime; choose another")
    given = _written_keys(table)
    kind = _kind_of_regime(given)
    for key in given:
        if key not in KINDS[kind]:
            raise reader.fail(
                f"{where}.{key}: expected the keys of a {kind}, {listed(KINDS[kind])}, got '{key}' beside them; leave "
                "it out, or make it a regime of its own"
            )
    if kind == "released crank":
        return _released_regime(reader, name, table, where)
    makers = {"segments": _segments_motion, "swing": _swing_motion, "table": _table_motion}
    with _errors_at(reader, where):
        motion, conditions = makers[kind](reader, name, table, where)
    return PrescribedRegime(name, motion, conditions)


def _written_keys(table: doc.RegimeTable) -> list[str]:
    """The keys that the regime's table has in the file, spelt as there, in the order of ``RegimeTable``."""
    return [field.alias or name for name, field in type(table).model_fields.items() if name in table.model_fields_set]


def _kind_of_regime(keys: Sequence[str]) -> str:
    """The kind of a regime by its keys, a key of ``KINDS``: swing, segments, table, or released crank."""
    if "segments" in keys:
        return "segments"
    if "to" in keys or "from" in keys:
        return "swing"
    return "table" if "angle" in keys and "torque" not in keys else "released crank"


@contextmanager
def _errors_at(reader: Reader, where: str) -> Iterator[None]:
    """In the block, turn an error of a motion into a DescriptionError.

    Its message begins with ``where``, the motion's place in the file. Only a plain LinkproofError and an
    UnknownNameError are turned; all else passes.
    """
    try:
        yield
    except LinkproofError as error:
        if type(error) in (LinkproofError, UnknownNameError):
            raise reader.fail(f"{where}: {error}") from error
        raise


def _required(reader: Reader, value: float | None, where: str, meaning: str) -> float:
    """The ``value`` that a regime needs; raises DescriptionError where it is None.

    The message begins with ``where``, the value's key, and says its ``meaning``.
    """
    if value is None:
        raise reader.fail(f"{where} is missing: expected {meaning}; add it")
    return value


def _phi_text(reader: Reader, place: float) -> str:
    """A value of φ, given in rad or m, as text in the file's unit: "30°", "120 mm"."""
    return f"{place / reader.phi.unit.size:.10g}{reader.phi.mark}"


def _peak_speed_text(reader: Reader, motion: CrankMotion) -> str:
    """The motion's largest speed as text, with its unit: "at most 1000 rpm"."""
    unit = reader.phi.speed_unit
    return f"at most {motion.peak_speed / unit.size:.6g} {unit.name}"


def _swing_motion(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> tuple[CrankMotion, str]:
    """The motion of a regime with ``from`` and ``to`` and its conditions in words; ``where`` is the regime's key.

    Raises DescriptionError where one of these keys is missing or for a list of times, LinkproofError or
    UnknownNameError for values that make no motion.
    """
    start = _required(reader, table.begin, f"{where}.from", "the angle at which the swing begins")
    end = _required(reader, table.to, f"{where}.to", "the angle at which the swing ends")
    law, dwell, back = table.law or USUAL_LAW, table.dwell or 0.0, bool(table.back)
    if isinstance(table.time, list):
        raise reader.fail(f"{where}.time: expected the time of one way in s, got a list; give one number")
    motion = swing(law, start, end, speed=table.speed, time=table.time, dwell=dwell, back=back, regime=name)
    pause = f", {dwell:g} s there" if dwell else ""
    ways = f"from {_phi_text(reader, start)} to {_phi_text(reader, end)}{pause}{' and back' if back else ''}"
    return motion, f"{law} {ways}, {_peak_speed_text(reader, motion)}"


def _segments_motion(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> tuple[CrankMotion, str]:
    """The motion of a regime with ``segments``, and its conditions in words; ``where`` is the regime's key.

    Raises DescriptionError for a wrong segment, LinkproofError for none, or for a speed that jumps between two.
    """
    begin = table.start_angle or 0.0
    moves: list[Move] = []
    angle = begin
    for number, segment in enumerate(table.segments or ()):
        place = f"{where}.segments.{number}"
        with _errors_at(reader, place):
            move = _move(reader, segment, angle, place)
        moves.append(move)
        angle = angle if move.to is None else move.to
    motion = sequence(name, begin, moves)
    stops = " to ".join(_phi_text(reader, each) for each in (begin, *(m.to for m in moves if m.to is not None)))
    return motion, f"{len(moves)} segments, {stops}, {motion.duration:.6g} s, {_peak_speed_text(reader, motion)}"


def _move(reader: Reader, segment: doc.SegmentTable, angle: float, place: str) -> Move:
    """A segment of a motion that is at ``angle``, rad or m: a move by a law, or a dwell.

    ``place`` is the segment's key, for messages. Raises DescriptionError for neither or both, or keys beside a dwell;
    LinkproofError or UnknownNameError as ``swing`` does for a move that cannot be.
    """
    if (segment.to is None) == (segment.dwell is None):
        raise reader.fail(f"{place}: expected either an angle to go to or a dwell, got both or none; give one of them")
    if segment.dwell is not None:
        beside = [key for key in ("time", "speed", "law") if getattr(segment, key) is not None]
        if beside:
            raise reader.fail(f"{place}: expected a dwell alone, got {listed(beside)} beside it; leave that out")
        return Move(segment.dwell)
    assert segment.to is not None
    law = segment.law or USUAL_LAW
    return Move(swing(law, angle, segment.to, speed=segment.speed, time=segment.time).duration, segment.to, law)


def _table_motion(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> tuple[CrankMotion, str]:
    """The motion of a regime with ``angle`` over ``time``, and its conditions in words; ``where`` is the regime's key.

    Raises DescriptionError for wrong lists.
    """
    times = table.time if isinstance(table.time, list) else None
    if times is None:
        raise reader.fail(f"{where}.time: expected a list of times in s beside the angles, got none; add time = [...]")
    angles = table.angle or []
    with _errors_at(reader, f"{where}.time"):
        check_times(np.array(times or [0.0]))
    with _errors_at(reader, f"{where}.angle"):
        motion = table_motion(name, times, angles)
    low, high = motion.reach
    words = f"table of {len(times)} points between {_phi_text(reader, low)} and {_phi_text(reader, high)}"
    return motion, f"{words}, {motion.duration:.6g} s, {_peak_speed_text(reader, motion)}"


def _released_regime(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> ReleasedRegime:
    """The regime of a released crank, SI, from its table; ``where`` is the regime's key.

    Raises DescriptionError without ``start_angle`` or ``duration``, or for a wrong torque.
    """
    start = _required(reader, table.start_angle, f"{where}.start_angle", "a finite angle in the file's angle unit")
    duration = _required(reader, table.duration, f"{where}.duration", "a positive finite time in s")
    torque, over_angle, over_time = _regime_torque(reader, table, where)
    return ReleasedRegime(name, torque, start, table.start_speed or 0.0, duration, over_angle, over_time)


def _regime_torque(reader: Reader, table: doc.RegimeTable, where: str) -> tuple[float, Law | None, TimeLaw | None]:
    """The crank's torque, N m: its constant part, its law over the angle or None, its law over time or None.

    Of a driver that is pushed it is a force, N, and over time or constant. ``where`` is the regime's key. Raises
    DescriptionError for keys that do not go together, and for wrong lists.
    """
    if not isinstance(table.torque, list):
        if table.angle is not None or table.time is not None:
            key = "angle" if table.angle is not None else "time"
            raise reader.fail(f"{where}.{key}: expected a list of torques beside it, got none; add torque = [...]")
        return table.torque or 0.0, None, None
    if (table.angle is None) == (table.time is None):
        raise reader.fail(
            f"{where}.torque: expected a list of torques over angle = [...] or over time = [...], got both or none; "
            "give one of them"
        )
    if table.angle is not None:
        if reader.phi.is_linear:
            raise reader.fail(
                f"{where}.angle: expected a force over time of a linear drive, which has no angle, got one over the "
                "angle; give time = [...]"
            )
        return 0.0, law_over_angle(reader, [(value,) for value in table.torque], table.angle, where), None
    return 0.0, None, _time_law(reader, table.torque, table.time, where)


def _time_law(reader: Reader, values: list[float], times: float | list[float] | None, where: str) -> TimeLaw:
    """The torque over time, N m and s, from values joined by straight lines; ``where`` is the regime's key.

    Raises DescriptionError for lists of other lengths, fewer than 2 values, or times that do not increase.
    """
    if not isinstance(times, list) or len(times) != len(values) or len(times) < 2:
        count = len(times) if isinstance(times, list) else 1
        raise reader.fail(
            f"{where}: expected as many times as torques and 2 or more of each, got {count} times and {len(values)} "
            "torques; complete the shorter list"
        )
    if np.any(np.diff(times) <= 0.0):
        number = int(np.argmax(np.diff(times) <= 0.0))
        raise reader.fail(
            f"{where}.time: expected times that increase, got {times[number + 1]:g} s after {times[number]:g} s; sort "
            "them, and give a step a short time of its own"
        )
    return TimeLaw(tuple(times), tuple(values))


# The linkage.


# Points of one link nearer to each other than this share of the drawing's size are one point written twice.
COINCIDENT = 1e-12


def interpret(document: doc.Document, name: str, variants: tuple[str, ...], source: Source) -> Linkage:
    """Build the Linkage of a document; raises DescriptionError for an impossible or contradictory description.

    ``name`` is the mechanism's, ``variants`` are the names of all its variants, ``source`` is the file, for messages
    and for its text.
    """
    reader = reader_of(document, source)
    document = reader.document
    _check_driver(reader)
    if GROUND in document.links:
        raise reader.fail(
            "links.ground: expected only moving links under [links], got the ground; list its points under [ground]"
        )
    links = {key: _link(reader, key) for key in sorted(document.links)}
    linkage = Linkage(
        name=name,
        title=document.title,
        source=document.source,
        variant=document.variant,
        variants=variants,
        crank=document.crank,
        cylinder=_cylinder(reader),
        ground={key: position(document.ground[key]) for key in sorted(document.ground)},
        links=links,
        pins=_pins(reader),
        sliders=_sliders(reader),
        slots=_slots(reader),
        sketch=_sketch(reader),
        sketch_angle=document.sketch.angle,
        gravity=document.gravity,
        fluctuation=document.fluctuation,
        **loads(reader),
        friction=_friction(reader),
        output=_output(reader),
        thread=_thread(reader),
        regimes=tuple(regime_of(reader, name) for name in sorted(document.regimes)),
        published=tuple(document.published),
        notes=tuple(document.notes),
        units=reader.units,
        text=source.text,
    )
    _check_lengths(reader, linkage)
    return linkage


def _thread(reader: Reader) -> ThreadPath | None:
    """The thread's path in m and rad; None without a thread.

    Raises DescriptionError for a wrong stop, or an unknown eye.
    """
    table = reader.document.thread
    if table is None:
        return None
    stops = tuple(_stop(reader, stop, f"thread.stops.{number}") for number, stop in enumerate(table.stops))
    reference = table.reference
    if isinstance(reference, doc.EyeReference):
        _check_eye(reader, reference.eye, "thread.reference")
    angle, length = (reader.unit(kind).size for kind in (Kind.COORDINATE, Kind.LENGTH))
    required = tuple((phi * angle, feed * length) for phi, feed in table.required)
    return ThreadPath(stops, table.stretch, table.feed, reference, required)


def _stop(reader: Reader, stop: doc.StopTable, where: str) -> ThreadGuide | ThreadEye:
    """A stop of the thread from its table, m: a guide in space, or an eye on a link.

    ``where`` is its key, for messages. Raises DescriptionError for both or none, or an unknown eye.
    """
    if (stop.guide is None) == (stop.eye is None):
        raise reader.fail(f"{where}: expected either guide = [x, y, z] or eye = 'POINT', got both or none; give one")
    if stop.eye is not None:
        _check_eye(reader, stop.eye, where)
        return ThreadEye(stop.eye, stop.z)
    assert stop.guide is not None
    return ThreadGuide(stop.name, stop.guide)


def _check_eye(reader: Reader, eye: str, where: str) -> None:
    """Raise DescriptionError, which begins with the key ``where``, for an eye that is no point of the linkage."""
    if eye not in reader.carriers:
        raise reader.fail(f"{where}: {UnknownNameError('point', eye, reader.carriers)}")


def _link(reader: Reader, name: str) -> lk.Link:
    """A moving link, SI, from its table; one that turns without mass has the inertia 0.

    One that cannot turn has None if the file gives none. Raises DescriptionError for a mass that turns without inertia.
    """
    where = f"links.{name}"
    table = reader.document.links[name]
    points = {key: position(place) for key, place in sorted(reader.points(name).items())}
    inertia = table.inertia
    if inertia is None and _turns(reader, name):
        if table.mass:
            raise reader.fail(f"{where}.inertia is missing: expected {EXPECTED['inertia']}, for the link turns; add it")
        inertia = 0.0
    return lk.Link(name, points, table.mass, position(table.centre), inertia)


def _check_driver(reader: Reader) -> None:
    """Raise DescriptionError unless there is one driver: a link, or a cylinder with its length at the sketch.

    Refused are both, none, an unknown link, and a cylinder without a positive ``sketch.angle``.
    """
    document = reader.document
    if not document.crank and document.cylinder is None:
        raise reader.fail(f"crank is missing: expected {EXPECTED['crank']}; add it, or a cylinder")
    if document.crank and document.cylinder is not None:
        raise reader.fail("cylinder: expected one driver, got crank and cylinder; leave one of them out")
    if document.crank and document.crank not in document.links:
        raise reader.fail(f"crank: {UnknownNameError('link', document.crank, document.links)}")
    if document.cylinder is not None and document.sketch.angle <= 0.0:
        raise reader.fail(
            "sketch.angle: expected the length of the cylinder at which the sketch is drawn, in the file's unit, got "
            f"{document.sketch.angle / reader.unit(Kind.COORDINATE).size:g}; give it"
        )


def _friction(reader: Reader) -> dict[str, lk.JointFriction]:
    """Friction, SI, by joint: the point of a pin, the sliding link, or the slot, "E in rocker".

    Raises DescriptionError for an unknown joint, a pin without ``radius`` or a guide with one.
    """
    pins = {pin.point for pin in _pins(reader)}
    guides = {*(slider.link for slider in _sliders(reader)), *(slot.name for slot in _slots(reader))}
    result = {}
    for joint, table in sorted(reader.document.friction.items()):
        where = f"friction.{joint}"
        if joint not in pins | guides:
            raise reader.fail(f"{where}: {UnknownNameError('pin, slider or slot', joint, pins | guides)}")
        if joint in pins & guides or (table.radius is None) != (joint in guides):
            wanted = "coefficient alone, of a guide" if joint in guides else "radius and coefficient, of a pin"
            raise reader.fail(f"{where}: expected {wanted}, got other keys; correct them")
        result[joint] = lk.JointFriction(table.coefficient, table.radius or 0.0)
    return result


def _cylinder(reader: Reader) -> lk.CylinderDrive | None:
    """The cylinder that drives the linkage, SI; None where a crank or a slider does.

    Raises DescriptionError for unknown ends or ends on one body, or a drawn length outside its range.
    """
    table = reader.document.cylinder
    if table is None:
        return None
    ends = zip(table.between, table.links or (None, None), strict=True)
    first, second = (reader.owner(point, link, "cylinder", PAIR) for point, link in ends)
    if first == second:
        raise reader.fail(f"cylinder: expected ends on two different bodies, got both on '{first}'; correct one")
    unit, drawn = reader.unit(Kind.LENGTH), reader.document.sketch.angle
    shortest, longest = table.min or 0.0, table.max or math.inf
    if not (shortest < longest and shortest <= drawn <= longest):
        raise reader.fail(
            f"cylinder.{'max' if drawn > longest or shortest >= longest else 'min'}: expected a length between min and "
            f"max in the sketch, got min {shortest / unit.size:g}, max {longest / unit.size:g} and sketch.angle "
            f"{drawn / unit.size:g} {unit.name}; correct one of them"
        )
    return lk.CylinderDrive(table.between, (first, second), table.min, table.max)


def _check_lengths(reader: Reader, linkage: Linkage) -> None:
    """Raise DescriptionError for two points of one link in one place: nearer than COINCIDENT of the drawing's size."""
    least = COINCIDENT * linkage.extent()
    for name, link in linkage.links.items():
        for (first, a), (second, b) in itertools.combinations(link.points.items(), 2):
            if math.dist(a, b) <= least:
                raise reader.fail(
                    f"links.{name}.points: expected a positive length between '{first}' and '{second}', got 0; move "
                    "one of them, or give both one name"
                )


def _turns(reader: Reader, name: str) -> bool:
    """Whether a link can turn: a slider as its host does, the ground not.

    Raises DescriptionError for sliders in a circle, or an unknown host.
    """
    seen: list[str] = []
    while name != GROUND:
        if name in seen:
            raise reader.fail(
                f"links.{name}.slides.on: expected a host that does not itself hang on '{name}', got a circle of "
                f"{' on '.join([*seen, name])}; let one of them slide on another link"
            )
        seen.append(name)
        slides = reader.document.links[name].slides
        if slides is None:
            return True
        name = reader.body(slides.on, f"links.{name}.slides.on")
    return False


def _pins(reader: Reader) -> tuple[lk.Pin, ...]:
    """All revolute joints, sorted by the name of their point: the names that points of two bodies or more share."""
    return tuple(lk.Pin(point, tuple(names)) for point, names in reader.carriers.items() if len(names) > 1)


def _sliders(reader: Reader) -> tuple[lk.Slider, ...]:
    """All prismatic joints, sorted by the name of the sliding link.

    Raises DescriptionError for a circle of sliders, an unknown host, or a direction without length.
    """
    slides = [(name, table.slides) for name, table in sorted(reader.document.links.items()) if table.slides]
    for name, _ in slides:
        _turns(reader, name)  # a slider of a circle of sliders has no place
    return tuple(lk.Slider(name, table.point, _guide(reader, table, f"links.{name}.slides")) for name, table in slides)


def _guide(reader: Reader, table: doc.SlidesTable | doc.SlotTable, where: str) -> lk.Guide:
    """The line of a slider or a slot in its host: a point, m, and a unit vector.

    ``where`` is the table's key, for messages. Raises DescriptionError for an unknown host, or a direction without
    length.
    """
    host = reader.body(table.on, f"{where}.on")
    return lk.Guide(host, position(table.through), reader.direction(table.along, where))


def _slots(reader: Reader) -> tuple[lk.Slot, ...]:
    """The pins in slots, sorted by name, SI.

    Raises DescriptionError for an unknown point, a pin that the slot's own host carries, or a second slot of one name.
    """
    slots: dict[str, lk.Slot] = {}
    for number, table in enumerate(reader.document.slots):
        where = f"slots.{number}"
        slot = lk.Slot(table.point, _guide(reader, table, where), number)
        owners = reader.carriers.get(table.point)
        if owners is None:
            raise reader.fail(f"{where}: {UnknownNameError('point', table.point, reader.carriers)}")
        if slot.guide.host in owners:
            raise reader.fail(
                f"{where}: expected a pin that another body carries, got '{table.point}' of '{slot.guide.host}', which "
                "has the slot; name another point"
            )
        if slot.name in slots or slot.name in reader.document.links:
            raise reader.fail(f"{where}: expected one slot for '{slot.name}', got a second one; leave it out")
        slots[slot.name] = slot
    return tuple(slot for _, slot in sorted(slots.items()))


def _sketch(reader: Reader) -> dict[str, Vector]:
    """Rough positions of points, m, by their names; raises DescriptionError for an unknown point."""
    for point in reader.document.sketch.points:
        if point not in reader.carriers:
            raise reader.fail(f"sketch.points: {UnknownNameError('point', point, reader.carriers)}")
    points = sorted(reader.document.sketch.points.items())
    return {key: position(place) for key, place in points}


def _output(reader: Reader) -> lk.Output | None:
    """The output point, a body that carries it, and its direction; None where the file has no output.

    The direction is by default the guide of its slider. Raises DescriptionError for a point that does not move, or
    without a direction.
    """
    table = reader.document.output
    if table is None:
        return None
    owners = [name for name in reader.carriers.get(table.point, ()) if name != GROUND]
    if not owners:
        moving = {point for link in reader.document.links for point in reader.points(link)}
        raise reader.fail(f"output: {UnknownNameError('moving point', table.point, moving)}")
    guided = [s for s in _sliders(reader) if s.link in owners and s.guide.host == GROUND]
    carrier = guided[0].link if guided else owners[0]  # on a slider a point moves without turning: nothing to convert
    if table.along is not None:
        return lk.Output(table.point, carrier, reader.direction(table.along, "output"))
    if guided:
        return lk.Output(table.point, carrier, guided[0].guide.along)
    raise reader.fail(
        f"output.along is missing: expected a direction [x, y], since '{table.point}' is on no slider of the ground; "
        "add it"
    )
