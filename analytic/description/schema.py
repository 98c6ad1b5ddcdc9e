"""The linkage file as a validated document: what may be written, before units and meaning (see ``loading``)."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, FailFast, Field

from analytic.description.units import UNITS

# Strict: a quoted number or a true is a slip of the pen, not a number.
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False, strict=True)]
Pair = tuple[Finite, Finite]
_T = TypeVar("_T")
Tables = Annotated[list[_T], FailFast()]  # the first fault is told: the others need not be looked for


class TomlTable(BaseModel):
    """A TOML table that accepts no key it does not know."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Polar(TomlTable):
    """A point by its distance and direction from ``about``, the frame's origin if that is not given."""

    radius: Positive
    angle: Finite
    about: Pair = (0.0, 0.0)


Place = Pair | Polar


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
    """A prismatic joint: the link keeps ``point`` on a line of ``on`` and does not turn against it."""

    point: str
    on: str = "ground"
    through: Place
    along: Pair


class LinkTable(TomlTable):
    """A moving link."""

    points: dict[str, Place] = Field(default_factory=dict)
    mass: Positive
    centre: Place = (0.0, 0.0)
    inertia: Positive | None = None
    slides: SlidesTable | None = None


class SlotTable(TomlTable):
    """A pin in a slot."""

    point: str
    on: str = "ground"
    through: Place
    along: Pair


class ForceTable(TomlTable):
    """A force at a point: one pair, or a list of pairs over ``angle``."""

    point: str
    link: str | None = None
    force: Pair | list[Pair]
    angle: list[Finite] | None = None


class TorqueTable(TomlTable):
    """A torque on a link: a number, or a list of numbers over ``angle``."""

    link: str
    torque: Finite | list[Finite]
    angle: list[Finite] | None = None


class SpringTable(TomlTable):
    """A linear spring, and dashpot, between two points; ``links`` where a point belongs to several."""

    between: tuple[str, str]
    links: tuple[str, str] | None = None
    stiffness: NotNegative = 0.0
    length: NotNegative = 0.0
    damping: NotNegative = 0.0


class DamperTable(TomlTable):
    """A viscous damper between two bodies that turn against each other."""

    between: tuple[str, str]
    coefficient: NotNegative


class OutputTable(TomlTable):
    """The point whose S, v and a are wanted, and the direction they are measured along."""

    point: str
    along: Pair | None = None


class SketchTable(TomlTable):
    """Rough positions of points at one crank angle."""

    angle: Finite = 0.0
    points: dict[str, Pair] = Field(default_factory=dict)


class RegimeTable(TomlTable):
    """A regime of the linkage's own: released at an angle, moved by a constant crank torque and the loads."""

    torque: Finite = 0.0
    start_angle: Finite
    start_speed: Finite = 0.0
    duration: Positive


class StopTable(TomlTable):
    """A stop of the thread: a fixed ``guide`` [x, y, z] with a name, or an ``eye``, a named point, at height ``z``."""

    guide: tuple[Finite, Finite, Finite] | None = None
    name: str = ""
    eye: str | None = None
    z: Finite = 0.0


class ReferenceTable(TomlTable):
    """The crank angle at which an eye is highest or lowest."""

    eye: str
    extreme: Literal["highest", "lowest"]


class ThreadTable(TomlTable):
    """The thread's way, its stretch, and how its feed is counted."""

    stops: list[StopTable] = Field(min_length=2)
    stretch: NotNegative = 0.0
    feed: Literal["shortening", "lengthening"] = "shortening"
    reference: Finite | ReferenceTable = 0.0


class ErratumTable(TomlTable):
    """A model as printed, by its ½ Jeq', as a variant or by fixed Runge-Kutta ``steps``, held against this file's."""

    name: str
    place: str
    regime: str
    half_slope: Literal["exact", "moduli"] = "exact"
    variant: str | None = None
    steps: Annotated[int, Field(gt=9)] | None = None
    note: str = ""


class PublishedTable(TomlTable):
    """A printed figure: SI units, ratios as plain numbers; ``half_digit`` is half a unit of its last printed digit."""

    quantity: str
    value: Finite
    place: str
    half_digit: NotNegative = 0.0
    variant: str | None = None
    relative_to: str | None = None
    note: str = ""


class Document(TomlTable):
    """A whole linkage file with one variant already laid over it."""

    title: str
    source: str
    units: UnitsTable
    crank: str
    gravity: Pair = (0.0, 0.0)
    variant: str = "base"
    ground: dict[str, Place]
    links: dict[str, LinkTable]
    slots: Tables[SlotTable] = Field(default_factory=list)
    forces: Tables[ForceTable] = Field(default_factory=list)
    torques: Tables[TorqueTable] = Field(default_factory=list)
    springs: Tables[SpringTable] = Field(default_factory=list)
    dampers: Tables[DamperTable] = Field(default_factory=list)
    output: OutputTable | None = None
    sketch: SketchTable = SketchTable()
    regimes: dict[str, RegimeTable] = Field(default_factory=dict)
    thread: ThreadTable | None = None
    errata: Tables[ErratumTable] = Field(default_factory=list)
    published: Tables[PublishedTable] = Field(default_factory=list)
    notes: list[str] = Field(default_factory=list)
    format: Literal[1] = 1


# What to write instead, by the key at fault, if need be with the outermost key before it; ".*" is what lies inside one.
EXPECTED: dict[str, str] = {
    "title": "a title in quotes",
    "source": "the source in quotes",
    "crank": "the name of the link that is the crank",
    "mass": "a positive finite mass in the file's mass unit",
    "inertia": "a positive finite moment of inertia about the mass centre in the file's inertia unit",
    "centre": "the mass centre as [x, y] or { radius, angle }, finite numbers",
    "points": "named points, each [x, y] or { radius, angle }",
    "points.*": "a point as [x, y] or { radius, angle }, finite numbers",
    "ground": "named fixed points, each [x, y] or { radius, angle }",
    "ground.*": "a point as [x, y] or { radius, angle }, finite numbers",
    "links": "a table [links.NAME] for every moving link",
    "links.*": "a table [links.NAME] with the link's mass, points, mass centre and inertia",
    "slides": "{ point, on, through, along }",
    "through": "a point of the line as [x, y] or { radius, angle }, finite numbers",
    "along": "a direction [x, y], finite numbers",
    "gravity": "the gravity vector [x, y] in m/s^2, finite numbers",
    "radius": "a positive finite length in the file's length unit",
    "angle": "a finite angle in the file's angle unit",
    "forces.angle": "a list of finite angles in the file's angle unit",
    "torques.angle": "a list of finite angles in the file's angle unit",
    "units": "{ length, mass, inertia, angle }, each the name of a unit in quotes",
    "stiffness": "a finite stiffness of zero or more",
    "length": "a finite length of zero or more",
    "damping": "a finite damping of zero or more",
    "coefficient": "a finite viscous coefficient of zero or more",
    "force": "[x, y], or a list of such pairs with as many angles, finite numbers",
    "torque": "a finite number, or a list of them with as many angles",
    "regimes.torque": "a finite torque in the file's torque unit",
    "point": "the name of a point",
    "on": "the name of a link, or 'ground'",
    "link": "the name of a link",
    "between": "a pair of names [one, two]",
    "springs.links": "the two links that carry the ends, [one, two]",
    "duration": "a positive finite time in s",
    "format": "the number 1, the only format so far",
} | {
    f"units.{kind}": f"the name of a unit of {kind.replace('_', ' ')} in quotes: {', '.join(UNITS[kind])}"
    for kind in UNITS
}

# The same by the validator's name for the fault, where the key has no phrase of its own.
PLAIN: dict[str, str] = {
    "missing": "a value",
    "string_type": "a text in quotes",
    "float_type": "a number",
    "finite_number": "a finite number",
    "greater_than": "a positive number",
    "greater_than_equal": "a number of zero or more",
    "dict_type": "a table",
    "model_type": "a table",
    "list_type": "a list",
    "tuple_type": "a list of two",
}
