"""The linkage file as a validated document: what may be written, before units and meaning (see ``loading``)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False, strict=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Pair = tuple[Finite, Finite]


class Table(BaseModel):
    """A TOML table that accepts no key it does not know."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Polar(Table):
    """A point by its distance from the frame's origin and its direction."""

    radius: Positive
    angle: Finite


Place = Pair | Polar


class Units(Table):
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


class Slides(Table):
    """A prismatic joint: the link keeps ``point`` on a line of ``on`` and does not turn against it."""

    point: str
    on: str = "ground"
    through: Place
    along: Pair


class LinkTable(Table):
    """A moving link."""

    points: dict[str, Place] = Field(default_factory=dict)
    mass: Positive
    centre: Place = (0.0, 0.0)
    inertia: Positive | None = None
    slides: Slides | None = None


class SlotTable(Table):
    """A pin in a slot."""

    point: str
    on: str = "ground"
    through: Place
    along: Pair


class ForceTable(Table):
    """A force at a point: one pair, or a list of pairs over ``angle``."""

    point: str
    link: str | None = None
    force: Pair | list[Pair]
    angle: list[Finite] | None = None


class TorqueTable(Table):
    """A torque on a link: a number, or a list of numbers over ``angle``."""

    link: str
    torque: Finite | list[Finite]
    angle: list[Finite] | None = None


class SpringTable(Table):
    """A linear spring, and dashpot, between two points; ``links`` where a point belongs to several."""

    between: tuple[str, str]
    links: tuple[str, str] | None = None
    stiffness: NotNegative = 0.0
    length: NotNegative = 0.0
    damping: NotNegative = 0.0


class DamperTable(Table):
    """A viscous damper between two bodies that turn against each other."""

    between: tuple[str, str]
    coefficient: NotNegative


class OutputTable(Table):
    """The point whose S, v and a are wanted, and the direction they are measured along."""

    point: str
    along: Pair | None = None


class Sketch(Table):
    """Rough positions of points at one crank angle."""

    angle: Finite = 0.0
    points: dict[str, Pair] = Field(default_factory=dict)


class PublishedTable(Table):
    """A printed figure: SI units, ratios as plain numbers; ``half_digit`` is half a unit of its last printed digit."""

    quantity: str
    value: Finite
    place: str
    half_digit: NotNegative = 0.0
    variant: str | None = None
    relative_to: str | None = None
    note: str = ""


class Document(Table):
    """A whole linkage file with one variant already laid over it."""

    title: str
    source: str
    units: Units
    crank: str
    gravity: Pair = (0.0, 0.0)
    variant: str = "base"
    ground: dict[str, Place]
    links: dict[str, LinkTable]
    slots: list[SlotTable] = Field(default_factory=list)
    forces: list[ForceTable] = Field(default_factory=list)
    torques: list[TorqueTable] = Field(default_factory=list)
    springs: list[SpringTable] = Field(default_factory=list)
    dampers: list[DamperTable] = Field(default_factory=list)
    output: OutputTable | None = None
    sketch: Sketch = Sketch()
    published: list[PublishedTable] = Field(default_factory=list)
    notes: list[str] = Field(default_factory=list)
    format: Literal[1] = 1


# What to write instead, by the key at fault; read into the error message.
EXPECTED: dict[str, str] = {
    "mass": "a positive finite mass in the file's mass unit",
    "inertia": "a positive finite moment of inertia about the mass centre in the file's inertia unit",
    "centre": "the mass centre as [x, y] or { radius, angle }",
    "points": "named points, each [x, y] or { radius, angle }",
    "ground": "named fixed points, each [x, y] or { radius, angle }",
    "through": "a point of the line as [x, y] or { radius, angle }",
    "along": "a direction [x, y]",
    "gravity": "the gravity vector [x, y] in m/s^2",
    "radius": "a positive finite length",
    "units": "{ length, mass, inertia, angle }, each a unit's name",
    "stiffness": "a stiffness of zero or more",
    "length": "a length of zero or more",
    "damping": "a damping of zero or more",
    "coefficient": "a viscous coefficient of zero or more",
    "force": "[x, y], or a list of them with as many angles",
    "torque": "a number, or a list of them with as many angles",
}
