"""The description of a planar linkage in SI units, from which the closed form and every engine are built.

All lengths are in m, masses in kg, inertias in kg m² about the mass centre, forces in N, torques in
N m, angles in rad counter-clockwise. A link's *frame* is any right-handed frame fixed in it; its points, mass
centre, guides and slots are given in that frame. The ground frame is the drawing's.

The coordinate φ is that of the driver. For a crank it is the angle of its x axis against the ground's x axis, rad;
for a slider of the ground its travel along the guide, m, for a cylinder its length, m. Quantities of the drive change
their units with it: see ``analytic.signals.unit_of``.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from html import escape
from typing import Annotated, Any, ClassVar, Final, Literal

from analytic.description.crank_motion import RPM, CrankMotion, degrees
from analytic.description.law import FULL_TURN, Law, TimeLaw
from analytic.description.schema import EyeReference, Published
from analytic.description.units import FileUnit, Kind, factor
from analytic.description.walk import ANGLES, Keys, Number, number_fields, walk
from analytic.errors import LinkproofError

GROUND: Final = "ground"

Vector = tuple[float, float]
Position = Annotated[Vector, Kind.LENGTH]
Positions = Annotated[Mapping[str, Vector], Kind.LENGTH]
Direction = Annotated[Vector, Kind.DIRECTION]  # a unit vector


def rotate(vector: Vector, turn: Vector) -> Vector:
    """A plane vector turned by an angle that is given as (cos, sin)."""
    return (vector[0] * turn[0] - vector[1] * turn[1], vector[0] * turn[1] + vector[1] * turn[0])


class DriverKind(StrEnum):
    """Kinds of drivers: a crank is turned (φ in rad); a slider of the ground or a cylinder is pushed (φ in m)."""

    CRANK = "crank"
    SLIDER = "slider"
    CYLINDER = "cylinder"


@dataclass(frozen=True)
class DriverCoordinate:
    """φ, in which the linkage moves: the angle of a crank, rad, or the travel or length of what is pushed, m.

    ``unit`` is that in which people give and read it: degrees, or the file's unit of length; likewise ``speed_unit``.
    """

    driver: DriverKind
    unit: FileUnit
    speed_unit: FileUnit

    @property
    def is_linear(self) -> bool:
        """Whether it is a length, so that the drive exerts a force."""
        return self.driver is not DriverKind.CRANK

    @property
    def axis(self) -> str:
        """The label of an axis: the coordinate's name and unit, "crank angle φ, °" or "travel of the drive, mm"."""
        return f"{'travel of the drive' if self.is_linear else 'crank angle φ'}, {self.unit.name}"

    @property
    def effort(self) -> str:
        """The word for what the drive exerts: "torque" or "force"."""
        return "force" if self.is_linear else "torque"

    def kind(self, kind: Kind) -> Kind:
        """The kind that a number of the drive has: length, velocity or force if linear, else angle, speed or torque.

        Kinds that do not depend on the driver come back unchanged.
        """
        return kind.of_driver(is_linear=self.is_linear)

    @property
    def mark(self) -> str:
        """The unit as it follows a number: "°", " mm"."""
        return f" {self.unit.name}" if self.is_linear else self.unit.name

    def text(self, value: float) -> str:
        """A value of φ, rad or m, as text with its unit, "30°" or "120 mm".

        An angle is in degrees, within a turn, a length in the file's unit; 4 digits.
        """
        return f"{value / self.unit.size:z.4g}{self.mark}" if self.is_linear else degrees(value)

    def unwrapped(self, value: float) -> str:
        """A value of φ, rad or m, in words as from ``text``, but an angle keeps its whole turns, and has 6 digits."""
        return self.text(value) if self.is_linear else f"{value / self.unit.size:.6g}{self.mark}"

    def named(self, value: float) -> str:
        """A value of φ, rad or m, in words with its name: "crank angle 30°", "a cylinder at 120 mm"."""
        return f"{f'a {self.driver} at' if self.is_linear else 'crank angle'} {self.text(value)}"


def driver_coordinate(driver: DriverKind, length: str) -> DriverCoordinate:
    """The description of φ for a kind of driver; ``length`` is the name of the file's unit of length.

    Raises UnknownNameError for an unknown unit, of a driver that is pushed.
    """
    if driver is DriverKind.CRANK:
        return DriverCoordinate(driver, FileUnit("°", math.radians(1.0)), FileUnit("rpm", RPM))
    size = factor("length", length)
    return DriverCoordinate(driver, FileUnit(length, size), FileUnit(f"{length}/s", size))


@dataclass(frozen=True)
class Guide:
    """A straight line fixed in ``host`` (a link or the ground), through a point, along a unit vector."""

    host: str
    through: Position
    along: Direction


@dataclass(frozen=True)
class Link:
    """A moving rigid body.

    ``inertia`` is about the mass centre; ``None`` is allowed for a link that cannot turn. Both may be zero.
    """

    name: str
    points: Positions
    mass: Annotated[float, Kind.MASS]
    centre: Position
    inertia: Annotated[float | None, Kind.INERTIA]


@dataclass(frozen=True)
class Pin:
    """A revolute joint: all ``links`` (sorted names, the ground may be one) share the point."""

    point: str
    links: tuple[str, ...]

    @property
    def hub(self) -> str:
        """The body all others are joined to: the ground if it has the pin, else the first by name."""
        return GROUND if GROUND in self.links else self.links[0]

    @property
    def joints(self) -> Mapping[str, str]:
        """Names of the pin's k - 1 joints, each with the link it joins to the hub and on which its force acts.

        The name is the point's, "A"; of several joints it is "A:rod", with the link.
        """
        others = [link for link in self.links if link != self.hub]
        return {self.point if len(others) == 1 else f"{self.point}:{link}": link for link in others}


@dataclass(frozen=True)
class Slider:
    """A prismatic joint: ``link`` keeps ``point`` on the guide and cannot turn against the guide's host.

    The slider's frame has its x axis along the guide.
    """

    link: str
    point: str
    guide: Guide

    @property
    def name(self) -> str:
        """Name of the slider's joint: "rod on ground"."""
        return f"{self.link} on {self.guide.host}"


@dataclass(frozen=True)
class Slot:
    """A pin in a slot: ``point`` (of another link or of the ground) stays on the guide and may turn.

    ``number`` is the slot's among those of the file, from 0, as it is of forces and torques.
    """

    point: str
    guide: Guide
    number: int = field(default=0, compare=False, repr=False)

    @property
    def name(self) -> str:
        """Name of the joint, which is that of the massless slider that stands for the pin: "E in rocker"."""
        return f"{self.point} in {self.guide.host}"


@dataclass(frozen=True)
class PointForce:
    """A force on ``link`` at ``point``, constant or a law, components in the ``frame`` of a body.

    It comes from outside, or is one between two bodies: its reverse acts on the body ``reaction`` at the same place.
    """

    point: str
    link: str
    force: Annotated[Law, Kind.FORCE]
    number: int = field(default=0, compare=False, repr=False)
    frame: str = GROUND
    reaction: str | None = None


@dataclass(frozen=True)
class LinkTorque:
    """A torque on ``link``, counter-clockwise positive, constant or a law, and its reverse on ``reaction`` if any."""

    link: str
    torque: Annotated[Law, Kind.TORQUE]
    number: int = field(default=0, compare=False, repr=False)
    reaction: str | None = None


@dataclass(frozen=True)
class Spring:
    """A linear spring with an optional dashpot along the line between two points of two different bodies."""

    points: tuple[str, str]
    links: tuple[str, str]
    stiffness: Annotated[float, Kind.STIFFNESS]
    length: Annotated[float, Kind.LENGTH]
    damping: Annotated[float, Kind.DAMPING]
    has_length: bool = True  # whether the file gives one; a spring without pulls at every length


@dataclass(frozen=True)
class RotaryDamper:
    """A viscous damper between two bodies: torque ``-coefficient`` times their relative angular velocity."""

    links: tuple[str, str]
    coefficient: Annotated[float, Kind.TURN_DAMPING]


@dataclass(frozen=True)
class TorsionSpring:
    """A torque ``-stiffness`` (N m/rad) times the angle of a body against a second one, less the free ``angle``.

    The difference counts within half a turn to either side.
    """

    links: tuple[str, str]
    stiffness: Annotated[float, Kind.TORQUE]
    angle: Annotated[float, Kind.ANGLE]


@dataclass(frozen=True)
class JointFriction:
    """Coulomb friction of a pin, about which its bodies turn at a ``radius``, or of a guide, whose radius is 0."""

    coefficient: Annotated[float, Kind.RATIO]
    radius: Annotated[float, Kind.LENGTH] = 0.0


@dataclass(frozen=True)
class CylinderDrive:
    """A massless driver between two points of two bodies: its length is φ, its force pushes them apart.

    ``shortest`` and ``longest`` bound its length, if they are known.
    """

    points: tuple[str, str]
    links: tuple[str, str]
    shortest: Annotated[float | None, Kind.LENGTH] = None
    longest: Annotated[float | None, Kind.LENGTH] = None

    @property
    def has_ends(self) -> bool:
        """Whether its shortest or its longest length is given."""
        return self.shortest is not None or self.longest is not None


@dataclass(frozen=True)
class Output:
    """The output, whose displacement, velocity and acceleration are S, v, a: a point along a unit ground vector."""

    point: str
    link: str
    along: Direction


@dataclass(frozen=True)
class ReleasedRegime:
    """A regime that the linkage file defines: the crank is released and moved by a torque, N m, and the loads.

    Starts at crank angle ``start_angle``, rad, with crank speed ``start_speed``, rad/s; lasts ``duration``, s.
    ``torque`` is the constant part of the torque; ``over_angle`` and ``over_time`` are added to it, if given.
    """

    name: str
    torque: float
    start_angle: float
    start_speed: float
    duration: float
    over_angle: Law | None = None
    over_time: TimeLaw | None = None


@dataclass(frozen=True)
class PrescribedRegime:
    """A regime that the linkage file defines: the crank follows a motion; ``conditions`` describes it in words."""

    name: str
    motion: CrankMotion
    conditions: str


FileRegime = ReleasedRegime | PrescribedRegime


# The needle thread's way through a linkage: fixed guides and eyes of moving links, in the order it runs.

Feed = Literal["shortening", "lengthening"]


@dataclass(frozen=True)
class ThreadGuide:
    """A fixed guide at a point of space, m; z runs along the main shaft, out of the linkage's plane."""

    name: str
    position: tuple[float, float, float]


@dataclass(frozen=True)
class ThreadEye:
    """An eye: a named point of the linkage, at ``z`` (m) in front of its plane."""

    point: str
    z: float = 0.0


@dataclass(frozen=True)
class ThreadPath:
    """A thread and how its feed is counted: Pd(φ) = ±(L(φ) − L(φ_ref)) + ΔP.

    ``stretch`` is ΔP, m, by which the thread gives under its tension. ``feed`` says whether a ``shortening`` contour
    gives thread, as in article 004, or a ``lengthening`` one counts, as in article 002. ``reference`` is φ_ref: a crank
    angle, rad, or an eye's highest or lowest position. ``required`` are pairs of φ, rad, and the feed that a stitch
    needs there, m.
    """

    stops: tuple[ThreadGuide | ThreadEye, ...]
    stretch: float
    feed: Feed
    reference: float | EyeReference
    required: tuple[tuple[float, float], ...] = ()

    @property
    def eyes(self) -> tuple[ThreadEye, ...]:
        """The stops that are eyes on moving links, in the thread's order."""
        return tuple(stop for stop in self.stops if isinstance(stop, ThreadEye))


# What acts on links, and of that by kind what is between two of them, whichever points these have.
LOADS: Final = ("forces", "torques", "springs", "dampers", "torsion_springs")
BETWEEN_LINKS: Final[Mapping[str, type]] = {"dampers": RotaryDamper, "torsion_springs": TorsionSpring}
# The parts with numbers that have names, in the order of the names.
NAMED_PARTS: Final = ("ground", "links", "sliders", "slots", "gravity", *LOADS, "friction", "output", "sketch")


@dataclass(frozen=True, repr=False)
class Linkage:
    """A planar linkage of one degree of freedom with its loads; every mapping is sorted by name.

    ``crank`` names the driven link; it is empty where a ``cylinder`` drives.
    ``units`` are the file's units by kind and ``text`` the file's text; all values are in SI.
    ``scales_mass`` makes masses of other designs change with lengths (``analytic.description.changes``).
    """

    name: str
    title: str
    source: str
    variant: str
    variants: tuple[str, ...]
    crank: str
    ground: Positions
    links: Mapping[str, Link]
    pins: tuple[Pin, ...]
    sliders: tuple[Slider, ...]
    slots: tuple[Slot, ...]
    sketch: Positions
    sketch_angle: Annotated[float, Kind.COORDINATE]
    gravity: Annotated[Vector, Kind.ACCELERATION] = (0.0, 0.0)
    forces: tuple[PointForce, ...] = ()
    torques: tuple[LinkTorque, ...] = ()
    springs: tuple[Spring, ...] = ()
    dampers: tuple[RotaryDamper, ...] = ()
    torsion_springs: tuple[TorsionSpring, ...] = ()
    output: Output | None = None
    thread: ThreadPath | None = None
    regimes: tuple[FileRegime, ...] = ()
    published: tuple[Published, ...] = ()
    notes: tuple[str, ...] = field(default=())
    units: Mapping[str, str] = field(default_factory=dict, repr=False)
    text: str = field(default="", repr=False)
    cylinder: CylinderDrive | None = None
    friction: Mapping[str, JointFriction] = field(default_factory=dict)  # by point, sliding link or slot
    fluctuation: float | None = None  # coefficient of fluctuation of the speed that a flywheel is wanted for
    scales_mass: bool = False
    drawing: ClassVar[Callable[[Linkage], Any] | None] = None
    """What ``plot`` draws by, which stands above this room: the package linkproof sets it."""

    def __repr__(self) -> str:
        """One line with name, variant and title."""
        return f"<Linkage: {self.name} ({self.variant}): {self.title}>"

    def _repr_html_(self) -> str:
        """Title and source as HTML for a notebook, with a table of the links, their masses and points."""
        words = [(name, f"{link.mass:g} kg", ", ".join(link.points)) for name, link in self.links.items()]
        rows = ("".join(f"<td>{escape(word)}</td>" for word in row) for row in words)
        head = "<tr><th>link</th><th>mass</th><th>points</th></tr>"
        table = "".join(f"<tr>{row}</tr>" for row in rows)
        return f"<p>{escape(repr(self)[1:-1])}; {escape(self.source)}</p><table>{head}{table}</table>"

    def plot(self) -> Any:  # noqa: ANN401 - a figure of matplotlib
        """A figure of matplotlib with the scheme in twelve positions of its range.

        Raises LinkproofError unless the package linkproof has been imported.
        """
        if Linkage.drawing is None:
            raise LinkproofError("a linkage is drawn by the package linkproof: import that first")
        return Linkage.drawing(self)

    @cached_property
    def named_numbers(self) -> Mapping[str, Number]:
        """Every number by its name; one whose name is already taken gets " #2" or a higher count behind it.

        Names are as in ``analytic.description.changes``: ``rod.B.x``. Angles of a load's table and lengths of the drive
        have none. Masses come before points, lest a point called ``centre`` take the mass centre's name.
        """
        result: dict[str, Number] = {}
        every = [number for part in NAMED_PARTS for number in self.numbers_of(part)]
        for number in sorted(every, key=lambda number: number.path[0] != "links" or number.path[2] == "points"):
            if number.kind is Kind.COORDINATE or ANGLES in number.path:
                continue
            name = _dotted_name(self, number.path)
            counted = (f"{name} #{count}" for count in itertools.count(2))
            result[name if name not in result else next(free for free in counted if free not in result)] = number
        return result

    def numbers_of(self, part: str) -> Iterator[Number]:
        """Every number of one field of the linkage, named ``part``, as an iterator of paths, kinds and values, SI.

        A path begins with the field's name. Raises AttributeError or KeyError for a field without numbers.
        """
        return walk(getattr(self, part), number_fields(Linkage)[part], (part,))

    @property
    def driver(self) -> DriverKind:
        """The crank, slider or cylinder that drives the linkage."""
        if self.cylinder is not None:
            return DriverKind.CYLINDER
        rides = any(slider.link == self.crank and slider.guide.host == GROUND for slider in self.sliders)
        return DriverKind.SLIDER if rides else DriverKind.CRANK

    @property
    def is_linear(self) -> bool:
        """Whether φ is a length, m, and the drive a force."""
        return self.driver is not DriverKind.CRANK

    @cached_property
    def phi(self) -> DriverCoordinate:
        """The description of the driver's coordinate φ: its name, units and text."""
        return driver_coordinate(self.driver, self.units.get("length", "m"))

    @property
    def applied(self) -> tuple[PointForce | LinkTorque, ...]:
        """All forces, then all torques."""
        return (*self.forces, *self.torques)

    @property
    def laws(self) -> tuple[Law, ...]:
        """The laws of all forces and torques."""
        return (*(force.force for force in self.forces), *(torque.torque for torque in self.torques))

    @property
    def has_one_way_loads(self) -> bool:
        """Whether a load acts only while the output advances, or only while it returns."""
        return any(law.when for law in self.laws)

    @property
    def has_loads_of_output(self) -> bool:
        """Whether a load depends on the output's travel S or on its direction."""
        return self.has_one_way_loads or any(law.over == "S" for law in self.laws)

    @property
    def load_period(self) -> float:
        """The angle, rad, after which loads over the crank angle repeat: a turn or two; a turn without such loads."""
        return max((law.period for law in self.laws if law.period and not law.is_constant), default=FULL_TURN)

    @property
    def released(self) -> dict[str, ReleasedRegime]:
        """The regimes of the file in which the crank is released, by name."""
        return {regime.name: regime for regime in self.regimes if isinstance(regime, ReleasedRegime)}

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of all joints that carry a force, pins first, then sliders, then slots, without solving the linkage.

        Pins are sorted by point, sliders by link, slots by name.
        """
        pins = itertools.chain.from_iterable(pin.joints for pin in self.pins)
        return (*pins, *(slider.name for slider in self.sliders), *(slot.name for slot in self.slots))

    @property
    def is_massless(self) -> bool:
        """Whether no link has a mass or an inertia."""
        return not any(link.mass or link.inertia for link in self.links.values())

    @property
    def is_idle(self) -> bool:
        """Whether no torque is needed to move it: no masses and no loads."""
        return self.is_massless and not any(getattr(self, kind) for kind in LOADS)

    def written(self, length: float) -> str:
        """A length, given in m, as text in the unit of the linkage's file, 4 digits: "12.5 mm"."""
        unit = self.units.get("length", "m")
        return f"{length / factor('length', unit):z.4g} {unit}"

    def local(self, point: str, body: str) -> Vector:
        """Coordinates of a point, m, in the frame of a body (a link's name or ``ground``) that carries it.

        Raises KeyError for another body or point.
        """
        return self.ground[point] if body == GROUND else self.links[body].points[point]

    def shortest_length(self) -> float:
        """Smallest distance between two named points of one moving link, m: the scale of joint gaps.

        If every link carries one point, it is the extent of the drawing.
        """
        lengths = [
            math.dist(a, b) for link in self.links.values() for a, b in itertools.combinations(link.points.values(), 2)
        ]
        return min(lengths, default=self.extent())

    def extent(self) -> float:
        """Largest magnitude of a coordinate in the description, m: the scale of the drawing.

        The coordinates are those of points and mass centres of links, of points of the ground, and of guides and slots,
        each in its own frame.
        """
        guides = [slider.guide for slider in self.sliders] + [slot.guide for slot in self.slots]
        places = [place for link in self.links.values() for place in (*link.points.values(), link.centre)]
        places += [*self.ground.values(), *(guide.through for guide in guides)]
        return max(abs(coordinate) for place in places for coordinate in place)


def _dotted_name(linkage: Linkage, path: Keys) -> str:
    """The dotted name of the number at a path in the linkage, such as "rod.B.x"."""
    keys: Sequence[str | int] = path
    match path:
        case ("links", link, "points", *rest) | ("links", link, *rest):
            keys = link, *rest
        case ("sliders", int(index), _, *rest):
            keys = linkage.sliders[index].link, *rest
        case ("slots", int(index), _, *rest):
            keys = linkage.slots[index].name, *rest
        case ("forces", int(index), _, row, axis):
            force = linkage.forces[index]
            keys = "forces", force.point, *_row_in_name(force.force, row), axis
        case ("torques", int(index), _, row, _):
            torque = linkage.torques[index]
            keys = "torques", torque.link, *_row_in_name(torque.torque, row)
        case ("springs", int(index), what):
            keys = "springs", *linkage.springs[index].points, what
        case (str(kind), int(index), what) if kind in BETWEEN_LINKS:
            keys = kind, *getattr(linkage, kind)[index].links, what
    return ".".join("xy"[key] if isinstance(key, int) else key for key in keys)


def _row_in_name(law: Law, row: str | int) -> tuple[str, ...]:
    """The row of a load's table as the part of a number's name that says it, as ("3",); () for a constant load."""
    return () if law.angles is None else (str(row),)
