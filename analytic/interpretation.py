"""From a validated document to a Linkage: SI units once, pins from shared names, and the checks that need meaning."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from analytic import document as doc
from analytic import linkage as lk
from analytic.errors import DescriptionError, UnknownNameError
from analytic.laws import FULL_TURN, Law
from analytic.linkage import GROUND, Linkage, Vector
from analytic.structure import unit
from analytic.units import UNITS, factor


@dataclass(frozen=True)
class _Reader:
    """A document with its units as SI factors."""

    document: doc.Document
    origin: str
    scale: dict[str, float]

    def fail(self, message: str) -> DescriptionError:
        return DescriptionError(f"{self.origin}: {message}")

    def vector(self, place: doc.Place) -> Vector:
        """A point in m."""
        length = self.scale["length"]
        if isinstance(place, doc.Polar):
            angle = place.angle * self.scale["angle"]
            return (place.radius * length * float(np.cos(angle)), place.radius * length * float(np.sin(angle)))
        return (place[0] * length, place[1] * length)

    def direction(self, pair: tuple[float, float], where: str) -> Vector:
        if pair == (0.0, 0.0):
            raise self.fail(f"{where}.along: expected a direction [x, y], got [0, 0]; give a vector along the line")
        return unit(pair)

    def owners(self, point: str) -> list[str]:
        """Bodies that carry a point, sorted, the ground included."""
        names = [name for name, link in self.document.links.items() if point in _points(link)]
        return sorted(names + ([GROUND] if point in self.document.ground else []))

    def owner(self, point: str, named: str | None, where: str) -> str:
        """The one body a load at a point acts on."""
        owners = self.owners(point)
        if not owners:
            raise self.fail(f"{where}: {UnknownNameError('point', point, self.all_points())}")
        if named is not None and named not in owners:
            raise self.fail(f"{where}: point '{point}' is not on '{named}': expected one of {', '.join(owners)}")
        moving = [name for name in owners if name != GROUND]
        if named is None and len(moving) > 1:
            raise self.fail(
                f"{where}: point '{point}' is on {', '.join(moving)}: say which one takes the load with link(s) = ..."
            )
        return named or (GROUND if GROUND in owners else moving[0])

    def all_points(self) -> list[str]:
        links = self.document.links.values()
        return sorted({point for link in links for point in _points(link)} | set(self.document.ground))

    def body(self, name: str, where: str) -> str:
        if name != GROUND and name not in self.document.links:
            raise self.fail(f"{where}: {UnknownNameError('link', name, [*self.document.links, GROUND])}")
        return name


def _points(link: doc.LinkTable) -> dict[str, doc.Place]:
    """Named points of a link; a slider's own point sits at its origin unless it says otherwise."""
    if link.slides is not None and link.slides.point not in link.points:
        return {link.slides.point: (0.0, 0.0), **link.points}
    return link.points


def interpret(document: doc.Document, name: str, variants: tuple[str, ...], origin: str) -> Linkage:
    """Build the Linkage of a document; raises DescriptionError for what is impossible or contradictory."""
    try:
        scale = {kind: factor(kind, getattr(document.units, kind)) for kind in UNITS}
    except UnknownNameError as error:
        raise DescriptionError(f"{origin}: units: {error}") from error
    reader = _Reader(document, origin, scale)
    if document.crank not in document.links:
        raise reader.fail(f"crank: {UnknownNameError('link', document.crank, document.links)}")
    if GROUND in document.links:
        raise reader.fail("links.ground: the ground does not move; list its fixed points under [ground]")
    links = {key: _link(reader, key) for key in sorted(document.links)}
    return Linkage(
        name=name,
        title=document.title,
        source=document.source,
        variant=document.variant,
        variants=variants,
        crank=document.crank,
        ground={key: reader.vector(document.ground[key]) for key in sorted(document.ground)},
        links=links,
        pins=_pins(reader),
        sliders=_sliders(reader),
        slots=_slots(reader),
        sketch=_sketch(reader),
        sketch_angle=document.sketch.angle * scale["angle"],
        gravity=document.gravity,
        forces=_forces(reader),
        torques=_torques(reader),
        springs=_springs(reader),
        dampers=_dampers(reader),
        output=_output(reader),
        published=tuple(lk.Published(**entry.model_dump()) for entry in document.published),
        notes=tuple(document.notes),
    )


def _link(reader: _Reader, name: str) -> lk.Link:
    table = reader.document.links[name]
    points = {key: reader.vector(place) for key, place in sorted(_points(table).items())}
    for (one, a), (two, b) in itertools.combinations(points.items(), 2):
        if a == b:
            raise reader.fail(f"links.{name}.points: '{one}' and '{two}' coincide, a length of 0; move one of them")
    if table.inertia is None and _turns(reader, name):
        raise reader.fail(
            f"links.{name}.inertia is missing: the link turns; expected {doc.EXPECTED['inertia']}; add it"
        )
    inertia = None if table.inertia is None else table.inertia * reader.scale["inertia"]
    return lk.Link(name, points, table.mass * reader.scale["mass"], reader.vector(table.centre), inertia)


def _turns(reader: _Reader, name: str) -> bool:
    """Whether a link can turn: a slider turns with its host, the ground does not."""
    seen = set()
    while name != GROUND:
        if name in seen:
            raise reader.fail(f"links.{name}.slides: sliders carry each other in a circle; let one slide on a link")
        seen.add(name)
        slides = reader.document.links[name].slides
        if slides is None:
            return True
        name = reader.body(slides.on, f"links.{name}.slides")
    return False


def _pins(reader: _Reader) -> tuple[lk.Pin, ...]:
    owners = {point: reader.owners(point) for point in reader.all_points()}
    return tuple(lk.Pin(point, tuple(names)) for point, names in owners.items() if len(names) > 1)


def _sliders(reader: _Reader) -> tuple[lk.Slider, ...]:
    found = []
    for name, table in sorted(reader.document.links.items()):
        if table.slides is not None:
            where = f"links.{name}.slides"
            if table.slides.on == name:
                raise reader.fail(f"{where}: a link cannot slide on itself; name another link or 'ground'")
            along = reader.direction(table.slides.along, where)
            host = reader.body(table.slides.on, where)
            guide = lk.Guide(host, reader.vector(table.slides.through), along)
            found.append(lk.Slider(name, table.slides.point, guide))
    return tuple(found)


def _slots(reader: _Reader) -> tuple[lk.Slot, ...]:
    found = []
    for number, table in enumerate(reader.document.slots):
        where = f"slots.{number}"
        host = reader.body(table.on, where)
        owners = reader.owners(table.point)
        if not owners:
            raise reader.fail(f"{where}: {UnknownNameError('point', table.point, reader.all_points())}")
        if host in owners:
            raise reader.fail(
                f"{where}: pin '{table.point}' is fixed to '{host}', which has the slot; name another pin"
            )
        guide = lk.Guide(host, reader.vector(table.through), reader.direction(table.along, where))
        found.append(lk.Slot(table.point, guide))
    return tuple(sorted(found, key=lambda slot: slot.name))


def _sketch(reader: _Reader) -> dict[str, Vector]:
    known = reader.all_points()
    for point in reader.document.sketch.points:
        if point not in known:
            raise reader.fail(f"sketch.points: {UnknownNameError('point', point, known)}")
    return {key: reader.vector(place) for key, place in sorted(reader.document.sketch.points.items())}


def _law(reader: _Reader, values: object, angles: list[float] | None, scale: float, where: str) -> Law:
    table = np.asarray(values, dtype=float) * scale
    if angles is None:
        if table.ndim > (1 if where.startswith("forces") else 0):
            raise reader.fail(f"{where}: a list of values needs as many angles; add angle = [...]")
        return Law(np.atleast_1d(table))
    phi = np.asarray(angles) * reader.scale["angle"]
    table = table.reshape(len(table), -1) if table.ndim else table.reshape(1, 1)
    if len(table) != len(phi) or len(phi) < 3:
        raise reader.fail(f"{where}: expected as many values as angles and at least 3, got {len(table)} and {len(phi)}")
    if np.any(np.diff(phi) <= 0.0) or phi[-1] - phi[0] >= FULL_TURN:
        raise reader.fail(
            f"{where}.angle: expected increasing angles within less than one turn; the turn closes itself"
        )
    return Law(table, phi)


def _forces(reader: _Reader) -> tuple[lk.PointForce, ...]:
    found = []
    for number, table in enumerate(reader.document.forces):
        where = f"forces.{number}"
        link = reader.owner(table.point, table.link, where)
        law = _law(reader, table.force, table.angle, reader.scale["force"], where)
        found.append(lk.PointForce(table.point, link, law))
    return tuple(force for force in found if force.link != GROUND)


def _torques(reader: _Reader) -> tuple[lk.LinkTorque, ...]:
    found = []
    for number, table in enumerate(reader.document.torques):
        where = f"torques.{number}"
        law = _law(reader, table.torque, table.angle, reader.scale["torque"], where)
        found.append(lk.LinkTorque(reader.body(table.link, where), law))
    return tuple(torque for torque in found if torque.link != GROUND)


def _springs(reader: _Reader) -> tuple[lk.Spring, ...]:
    found = []
    for number, table in enumerate(reader.document.springs):
        where = f"springs.{number}"
        names: Iterable[str | None] = table.links or (None, None)
        links = [reader.owner(p, link, where) for p, link in zip(table.between, names, strict=True)]
        if links[0] == links[1]:
            raise reader.fail(f"{where}: both ends are on '{links[0]}', so the spring never stretches; use two bodies")
        stiffness = table.stiffness * reader.scale["stiffness"]
        length, damping = table.length * reader.scale["length"], table.damping * reader.scale["damping"]
        found.append(lk.Spring(table.between, (links[0], links[1]), stiffness, length, damping))
    return tuple(found)


def _dampers(reader: _Reader) -> tuple[lk.RotaryDamper, ...]:
    scale = reader.scale["turn_damping"]
    found = []
    for number, table in enumerate(reader.document.dampers):
        one, two = (reader.body(name, f"dampers.{number}") for name in table.between)
        if one == two:
            raise reader.fail(f"dampers.{number}: both sides are '{one}'; name two different bodies")
        found.append(lk.RotaryDamper((one, two), table.coefficient * scale))
    return tuple(found)


def _output(reader: _Reader) -> lk.Output | None:
    table = reader.document.output
    if table is None:
        return None
    owners = [name for name in reader.owners(table.point) if name != GROUND]
    if not owners:
        raise reader.fail(f"output: {UnknownNameError('moving point', table.point, reader.all_points())}")
    if table.along is not None:
        return lk.Output(table.point, owners[0], reader.direction(table.along, "output"))
    for slider in _sliders(reader):
        if slider.link in owners and slider.guide.host == GROUND:
            return lk.Output(table.point, slider.link, slider.guide.along)
    raise reader.fail(f"output.along is missing: '{table.point}' is on no slider of the ground; add along = [x, y]")
