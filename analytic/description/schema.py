"""The linkage file as a validated document: what may be written, before units and meaning (see ``loading``)."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, FailFast, Field

from analytic.description.units import Kind

# Strict: a quoted number or a true is a slip of the pen, not a number.
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False, strict=True)]
Pair = tuple[Finite, Finite]
_T = TypeVar("_T")
Tables = Annotated[list[_T], FailFast()]  # the first fault is enough for the message


class TomlTable(BaseModel):
    """A TOML table that accepts no key it does not know."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class Polar(TomlTable):
    """A point by its distance and direction from ``about``, the frame's origin if that is not given."""

    radius: Annotated[Positive, Kind.LENGTH]
    angle: Annotated[Finite, Kind.ANGLE]
    about: Annotated[Pair, Kind.LENGTH] = (0.0, 0.0)


Place = Annotated[Pair, Kind.LENGTH] | Polar
Coordinate = Annotated[Finite, Kind.COORDINATE]
Drive = Annotated[Finite, Kind.DRIVE]
Speed = Annotated[Positive, Kind.SPEED]


class UnitsTable(TomlTable):
    """Units of the file; length, mass, inertia and angle have to be stated."""

    length: str
    mass: str
    inertia: str
    angle: str
    force: str = "N"
    torque: str = "N*m"
    stiffness: str = "N/m"
    damping: str = "N*s/m"
    turn_damping: str = "N*m*s"


class SlidesTable(TomlTable):
    """A prismatic joint: the link moves with ``point`` on a line of ``on`` and does not rotate relative to ``on``."""

    point: str
    on: str = "ground"
    through: Place
    along: Pair


class LinkTable(TomlTable):
    """A moving link."""

    points: dict[str, Place] = Field(default_factory=dict)
    mass: Annotated[NotNegative, Kind.MASS] = 0.0
    centre: Place = (0.0, 0.0)
    inertia: Annotated[NotNegative, Kind.INERTIA] | None = None
    slides: SlidesTable | None = None


class SlotTable(TomlTable):
    """A pin in a slot."""

    point: str
    on: str = "ground"
    through: Place
    along: Pair


class LoadTable(TomlTable):
    """A load: one value, or a list over ``angle`` or ``travel``, joined by a spline or by straight lines."""

    over: Literal["phi", "S"] = "phi"
    angle: list[Coordinate] | None = None
    travel: Annotated[list[Finite], Kind.LENGTH] | None = None
    period: Annotated[Finite, Kind.ANGLE] | None = None
    interpolation: Literal["spline", "linear"] | None = None
    when: Literal["advance", "return"] | None = None
    between: tuple[str, str] | None = None


class ForceTable(LoadTable):
    """A force at a point of a link, its components along the axes of the ground or of the link ``frame``."""

    point: str
    link: str | None = None
    force: Annotated[Pair | list[Pair], Kind.FORCE]
    frame: str = "ground"


class TorqueTable(LoadTable):
    """A torque on a link."""

    link: str | None = None
    torque: Annotated[Finite | list[Finite], Kind.TORQUE]


class SpringTable(TomlTable):
    """A linear spring, and dashpot, between two points; ``links`` where a point belongs to several."""

    between: tuple[str, str]
    links: tuple[str, str] | None = None
    stiffness: Annotated[NotNegative, Kind.STIFFNESS] = 0.0
    length: Annotated[NotNegative, Kind.LENGTH] = 0.0
    damping: Annotated[NotNegative, Kind.DAMPING] = 0.0


class DamperTable(TomlTable):
    """A viscous damper between two bodies that turn against each other."""

    between: tuple[str, str]
    coefficient: Annotated[NotNegative, Kind.TURN_DAMPING]


class TorsionSpringTable(TomlTable):
    """A torsion spring between two bodies, without torque at this angle of the first against the second."""

    between: tuple[str, str]
    stiffness: Annotated[NotNegative, Kind.TORQUE]  # per radian
    angle: Annotated[Finite, Kind.ANGLE]


class FrictionTable(TomlTable):
    """Coulomb friction of a joint; a pin has a ``radius`` besides."""

    coefficient: Annotated[NotNegative, Kind.RATIO]
    radius: Annotated[Positive, Kind.LENGTH] | None = None


class CylinderTable(TomlTable):
    """A cylinder between two points as the driver: its length is given, from ``min`` to ``max``.

    ``links`` stands where a point belongs to several.
    """

    between: tuple[str, str]
    links: tuple[str, str] | None = None
    min: Annotated[Positive, Kind.LENGTH] | None = None
    max: Annotated[Positive, Kind.LENGTH] | None = None


class OutputTable(TomlTable):
    """The point of S, v and a, and the direction along which they are measured."""

    point: str
    along: Pair | None = None


class SketchTable(TomlTable):
    """Rough positions of points at one crank angle."""

    angle: Coordinate = 0.0
    points: Annotated[dict[str, Pair], Kind.LENGTH] = Field(default_factory=dict)


class SegmentTable(TomlTable):
    """A part of a crank's motion: ``to`` an angle by a ``law`` in a ``time`` or at a ``speed``, or a ``dwell``."""

    to: Coordinate | None = None
    time: Positive | None = None
    speed: Speed | None = None
    law: str | None = None
    dwell: Positive | None = None


class RegimeTable(TomlTable):
    """A regime of the linkage.

    Either the crank is released (``torque``, a number or a list over ``angle`` or ``time``; ``start_angle``,
    ``start_speed``, ``duration``), or it follows a motion: ``from`` one angle ``to`` another, ``segments`` one after
    the other, or a table of ``angle`` over ``time``. Which keys belong together is checked on conversion.
    """

    torque: Drive | list[Drive] | None = None
    start_angle: Coordinate | None = None
    start_speed: Annotated[Finite, Kind.COORDINATE_SPEED] | None = None
    duration: Positive | None = None
    begin: Coordinate | None = Field(default=None, alias="from")
    to: Coordinate | None = None
    speed: Speed | None = None
    time: Positive | list[Finite] | None = None
    law: str | None = None
    dwell: NotNegative | None = None
    back: Annotated[bool, Field(strict=True)] | None = None
    segments: list[SegmentTable] | None = None
    angle: list[Coordinate] | None = None


class StopTable(TomlTable):
    """A stop of the thread: a fixed ``guide`` [x, y, z] with a name, or an ``eye``, a named point, at height ``z``."""

    guide: Annotated[tuple[Finite, Finite, Finite], Kind.LENGTH] | None = None
    name: str = ""
    eye: str | None = None
    z: Annotated[Finite, Kind.LENGTH] = 0.0


class EyeReference(TomlTable):
    """The crank angle at which an eye is at its ``highest`` or ``lowest``, +y up."""

    eye: str
    extreme: Literal["highest", "lowest"]


class ThreadTable(TomlTable):
    """The thread's path, its stretch, the sign and zero of its feed, and the feed that a stitch requires."""

    stops: list[StopTable] = Field(min_length=2)
    stretch: Annotated[NotNegative, Kind.LENGTH] = 0.0
    feed: Literal["shortening", "lengthening"] = "shortening"
    reference: Coordinate | EyeReference = 0.0
    required: list[Pair] = Field(default_factory=list)


class Published(TomlTable):
    """A figure printed in a source, in ``unit``, by default SI or a plain ratio.

    ``half_digit`` is half a unit of its last digit, ``accuracy`` the known error of the source where that is larger. It
    is a figure of a ``regime``, or of a crank that turns with ``speed``, rpm, by default with 1 rad/s. ``less`` and
    ``relative_to`` name another signal, or another mechanism, whose same figure is subtracted, or is the divisor.
    """

    quantity: str
    value: Finite
    place: str
    unit: str | None = None
    half_digit: NotNegative = 0.0
    accuracy: NotNegative = 0.0
    regime: str | None = None
    speed: Finite | None = None
    variant: str | None = None
    less: str | None = None
    relative_to: str | None = None
    note: str = ""


class Document(TomlTable):
    """A whole linkage file with the values of one variant."""

    title: str
    source: str = ""
    units: UnitsTable
    crank: str = ""
    cylinder: CylinderTable | None = None
    gravity: Annotated[Pair, Kind.ACCELERATION] = (0.0, 0.0)
    fluctuation: Annotated[float, Field(gt=0.0, lt=2.0, strict=True)] | None = None
    variant: str = "base"
    ground: dict[str, Place]
    links: dict[str, LinkTable]
    slots: Tables[SlotTable] = Field(default_factory=list)
    forces: Tables[ForceTable] = Field(default_factory=list)
    torques: Tables[TorqueTable] = Field(default_factory=list)
    springs: Tables[SpringTable] = Field(default_factory=list)
    dampers: Tables[DamperTable] = Field(default_factory=list)
    torsion_springs: Tables[TorsionSpringTable] = Field(default_factory=list)
    friction: dict[str, FrictionTable] = Field(default_factory=dict)
    output: OutputTable | None = None
    sketch: SketchTable = SketchTable()
    regimes: dict[str, RegimeTable] = Field(default_factory=dict)
    thread: ThreadTable | None = None
    published: Tables[Published] = Field(default_factory=list)
    notes: list[str] = Field(default_factory=list)
    format: Literal[1] = 1
