"""From a validated document to a Linkage: SI units once, pins from shared names, and the checks that need meaning."""

from __future__ import annotations

import itertools
import math

from analytic.description import linkage as lk
from analytic.description import load_tables
from analytic.description import schema as doc
from analytic.description.crank_motion.regimes import regime_of
from analytic.description.diagnosis import EXPECTED, Source
from analytic.description.linkage import GROUND, Linkage, ThreadEye, ThreadGuide, ThreadPath, Vector
from analytic.description.lookup import Reader, reader_of
from analytic.errors import UnknownNameError

# Points of one link nearer to each other than this share of the drawing's size are one point written twice.
COINCIDENT = 1e-12


def interpret(document: doc.Document, name: str, variants: tuple[str, ...], source: Source) -> Linkage:
    """Build the Linkage of a document; raises DescriptionError for an impossible or contradictory description."""
    reader = reader_of(document, source)
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
        ground={key: reader.vector(document.ground[key], f"ground.{key}") for key in sorted(document.ground)},
        links=links,
        pins=_pins(reader),
        sliders=_sliders(reader),
        slots=_slots(reader),
        sketch=_sketch(reader),
        sketch_angle=document.sketch.angle * reader.scale[reader.coordinate],
        gravity=_gravity(reader),
        forces=load_tables.forces(reader),
        torques=load_tables.torques(reader),
        springs=load_tables.springs(reader),
        dampers=load_tables.dampers(reader),
        output=_output(reader),
        thread=_thread(reader),
        regimes=tuple(regime_of(reader, name) for name in sorted(document.regimes)),
        published=tuple(document.published),
        notes=tuple(document.notes),
        units=document.units.model_dump(),
        text=source.text,
    )
    _check_lengths(reader, linkage)
    return linkage


def _thread(reader: Reader) -> ThreadPath | None:
    """The thread's way in m and rad; every eye is a point of the linkage."""
    table = reader.document.thread
    if table is None:
        return None
    stops = tuple(_stop(reader, stop, f"thread.stops.{number}") for number, stop in enumerate(table.stops))
    reference = table.reference
    if isinstance(reference, doc.EyeReference):
        _check_eye(reader, reference.eye, "thread.reference")
    else:
        reference *= reader.scale[reader.coordinate]
    required = tuple(
        (phi * reader.scale[reader.coordinate], reader.number(feed, "length", f"thread.required.{number}"))
        for number, (phi, feed) in enumerate(table.required)
    )
    return ThreadPath(stops, reader.number(table.stretch, "length", "thread.stretch"), table.feed, reference, required)


def _stop(reader: Reader, stop: doc.StopTable, where: str) -> ThreadGuide | ThreadEye:
    """A stop of the thread in m: a guide in space, or an eye on a link."""
    if (stop.guide is None) == (stop.eye is None):
        raise reader.fail(f"{where}: expected either guide = [x, y, z] or eye = 'POINT', got both or none; give one")
    if stop.eye is not None:
        _check_eye(reader, stop.eye, where)
        return ThreadEye(stop.eye, reader.number(stop.z, "length", where))
    assert stop.guide is not None
    x, y, z = (reader.number(part, "length", where) for part in stop.guide)
    return ThreadGuide(stop.name, (x, y, z))


def _check_eye(reader: Reader, eye: str, where: str) -> None:
    """Refuse an eye that is no point of the linkage."""
    if eye not in reader.carriers:
        raise reader.fail(f"{where}: {UnknownNameError('point', eye, reader.carriers)}")


def _link(reader: Reader, name: str) -> lk.Link:
    """A moving link in SI units; a massless one that turns has the inertia 0."""
    where = f"links.{name}"
    table = reader.document.links[name]
    points = {key: reader.vector(place, f"{where}.points.{key}") for key, place in sorted(reader.points(name).items())}
    mass = reader.weight(table.mass, "mass", f"{where}.mass")
    inertia = None if table.inertia is None else reader.weight(table.inertia, "inertia", f"{where}.inertia")
    if inertia is None and _turns(reader, name):
        if mass:
            raise reader.fail(f"{where}.inertia is missing: expected {EXPECTED['inertia']}, for the link turns; add it")
        inertia = 0.0
    return lk.Link(name, points, mass, reader.vector(table.centre, f"{where}.centre"), inertia)


def _check_driver(reader: Reader) -> None:
    """Check that there is one driver: a link, or a cylinder with its length at the sketch."""
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
            f"{document.sketch.angle:g}; give it"
        )


def _cylinder(reader: Reader) -> lk.CylinderDrive | None:
    """The cylinder that drives the linkage; None where a crank or a slider does."""
    table = reader.document.cylinder
    if table is None:
        return None
    ends = zip(table.between, table.links or (None, None), strict=True)
    first, second = (reader.owner(point, link, "cylinder") for point, link in ends)
    if first == second:
        raise reader.fail(f"cylinder: expected ends on two different bodies, got both on '{first}'; correct one")
    return lk.CylinderDrive(table.between, (first, second))


def _check_lengths(reader: Reader, linkage: Linkage) -> None:
    """Refuse two points of one link in one place."""
    least = COINCIDENT * linkage.extent()
    for name, link in linkage.links.items():
        for (first, a), (second, b) in itertools.combinations(link.points.items(), 2):
            if math.dist(a, b) <= least:
                raise reader.fail(
                    f"links.{name}.points: expected a positive length between '{first}' and '{second}', got 0; move "
                    "one of them, or give both one name"
                )


def _turns(reader: Reader, name: str) -> bool:
    """Whether a link can turn: a slider turns with its host, the ground does not."""
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


def _gravity(reader: Reader) -> Vector:
    """Gravity in m/s², none where the file gives none."""
    x, y = (reader.magnitude(part, "gravity", f"{part:g} m/s^2") for part in reader.document.gravity)
    return (x, y)


def _pins(reader: Reader) -> tuple[lk.Pin, ...]:
    """The revolute joints, sorted by the name of their point."""
    return tuple(lk.Pin(point, tuple(names)) for point, names in reader.carriers.items() if len(names) > 1)


def _sliders(reader: Reader) -> tuple[lk.Slider, ...]:
    """The prismatic joints, sorted by the name of the sliding link."""
    slides = [(name, table.slides) for name, table in sorted(reader.document.links.items()) if table.slides]
    for name, _ in slides:
        _turns(reader, name)  # a slider of a circle of sliders has no place
    return tuple(lk.Slider(name, table.point, _guide(reader, table, f"links.{name}.slides")) for name, table in slides)


def _guide(reader: Reader, table: doc.SlidesTable | doc.SlotTable, where: str) -> lk.Guide:
    """The line of a slider or a slot in its host, m."""
    host = reader.body(table.on, f"{where}.on")
    return lk.Guide(host, reader.vector(table.through, f"{where}.through"), reader.direction(table.along, where))


def _slots(reader: Reader) -> tuple[lk.Slot, ...]:
    """The pins in slots, sorted by the name of the slot."""
    slots: dict[str, lk.Slot] = {}
    for number, table in enumerate(reader.document.slots):
        where = f"slots.{number}"
        slot = lk.Slot(table.point, _guide(reader, table, where))
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
    """Rough positions of points, m, by their names."""
    for point in reader.document.sketch.points:
        if point not in reader.carriers:
            raise reader.fail(f"sketch.points: {UnknownNameError('point', point, reader.carriers)}")
    points = sorted(reader.document.sketch.points.items())
    return {key: reader.vector(place, f"sketch.points.{key}") for key, place in points}


def _output(reader: Reader) -> lk.Output | None:
    """The output point and its direction, by default the guide of its slider; None where the file has no output."""
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
