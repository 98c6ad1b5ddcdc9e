"""The data sheet as plain data: written beside a campaign's curves, read back without the closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any, Literal, NotRequired

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator
from typing_extensions import TypedDict

from analytic.description.linkage import Linkage, Vector
from analytic.description.loading import parse

DIGITS = 9  # of a number in an array


def _array(value: Any) -> NDArray[np.float64]:  # noqa: ANN401 - what a file holds
    """Numbers in lists, nothing among them for what is not finite."""
    try:
        found = np.array(value, dtype=float)
    except TypeError as error:
        raise ValueError("expected lists of numbers") from error
    if not found.ndim:
        raise ValueError("expected a list of numbers")
    return found


def _listed(values: NDArray[np.float64]) -> list[Any]:
    if values.ndim > 1:
        return [_listed(row) for row in values]
    return [float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in values.tolist()]


Array = Annotated[NDArray[np.float64], PlainValidator(_array), PlainSerializer(_listed)]


class SheetPeak(TypedDict):
    """A value and its place on the sheet's axis."""

    value: float | None
    at: float | None


class DriveFigure(TypedDict):
    """A point of the drive: torque, N m, speed, rad/s, power, W (of a linear drive N and m/s); the instant, s."""

    what: str
    torque: float | None
    speed: float | None
    power: float | None
    time: float | None
    at: float | None


class ForceFigure(TypedDict):
    """The largest force, N, of a joint on a link, or of the linkage on its ground; its direction, rad."""

    joint: str
    link: str
    force: float | None
    direction: float | None
    time: float | None
    at: float | None


class ExtremeFigure(TypedDict):
    """A named value of a signal."""

    what: str
    signal: str
    value: float | None
    time: float | None
    at: float | None


class SheetFigures(TypedDict):
    """What the table of ``linkproof results`` says; ``stroke``, m, where there is an output."""

    drive: list[DriveFigure]
    forces: list[ForceFigure]
    transmission: list[ExtremeFigure]
    output: list[ExtremeFigure]
    stroke: NotRequired[float | None]


@dataclass(frozen=True)
class Positions:
    """Where the bodies are at n instants, evenly spaced over one turn of φ or, where there is none, over the motion.

    ``over`` says which of the two ``axis`` is: "phi", rad, or "time", s, (n,); ``angle`` is φ or the travel, (n,).
    ``bodies`` has of each link, by name, the origin of its frame x, y, m, and its angle, rad, unwrapped, (3, n).
    ``carriers`` names the link that carries each point of a slot. ``closed``: the last instant is the first again.
    """

    over: str
    axis: Array
    angle: Array
    bodies: Mapping[str, Array]
    carriers: Mapping[str, str]
    closed: bool


class Eye(TypedDict):
    """Path of an eye, m, (3, n), and where it is highest and lowest, rad; None of one that does not go up and down."""

    path: Array
    top_angle: float | None
    bottom_angle: float | None


@dataclass(frozen=True)
class ThreadSheet:
    """The thread over a turn: φ, rad, feed and contour length, m, (n,); contour (stops, 3) at the reference angle, m.

    ``stops`` names the guides and eyes along the contour. ``figures`` are ``mechanism_summary``'s of the thread.
    """

    angle: Array
    feed: Array
    length: Array
    contour: Array
    stops: tuple[str, ...]
    eyes: Mapping[str, Eye]
    reference_angle: float
    figures: Mapping[str, Any]


@dataclass(frozen=True)
class Normalised:
    """Unit functions of the output over the ``phase`` from top dead centre, rad, both ends of the turn, (n,).

    ``harmonics`` are ½(1 − cos), sin and cos, ``means`` the mean absolute differences from them over a turn, as ratios;
    all three by "S", "v" and "a".
    """

    phase: Array
    functions: Mapping[str, Array]
    harmonics: Mapping[str, Array]
    means: Mapping[str, float]


class PublishedFigure(TypedDict):
    """A printed figure beside ours: the fields of ``PublishedRecord``."""

    mechanism: str
    variant: str
    quantity: str
    unit: str
    published: float
    half_digit: float
    ours: float | None
    deviation: float | None
    verdict: str
    source: str
    note: str


class Rest(TypedDict):
    """An angle, rad, at which a crank can rest."""

    angle: float
    stable: bool


class Speeds(TypedDict):
    """A crank over whole turns: mean speed over time and over φ, rad/s, and coefficient of fluctuation."""

    mean_speed: float
    mean_speed_over_angle: float
    fluctuation: float


class Coarse(TypedDict):
    """The articles' integrator in ``steps``: its largest errors of φ, rad, and ω, rad/s; None where it broke down.

    ``errors`` are its errors by "phi" and "omega" over "time", s, (n,).
    """

    steps: int
    phi: float | None
    omega: float | None
    errors: Mapping[str, Array]


@dataclass(frozen=True)
class Released:
    """A released crank: ``torque``, N m, which besides changes ``over`` the "angle" or the "time", or does not ("").

    ``rests`` are the angles at which it could rest, ``damping`` is the mean reduced coefficient, N m s/rad;
    ``error_bound`` of φ, rad, and ``balance`` of energy are the closed form's own. ``ending`` is its last whole turn,
    ``settled`` the rotation that would repeat itself, where there are such; ``end`` φ at the end within a turn, rad.
    ``motion`` has "time", s, "phi", "omega", "epsilon" (n,), ``last_turn`` the last three over the last whole turn.
    The macro ``released_sheet`` puts it in words.
    """

    torque: float
    over: Literal["", "angle", "time"]
    rests: list[Rest]
    damping: float
    error_bound: float | None
    balance: float | None
    ending: Speeds | None
    settled: Speeds | None
    coarse: Coarse | None
    end: float
    motion: Mapping[str, Array]
    last_turn: Mapping[str, Array]

    @property
    def is_steady(self) -> bool:
        """Whether the torque is constant, as the articles' and that of an angle of rest is."""
        return not self.over


@dataclass(frozen=True)
class Printed:
    """Crank speed by a model as printed and by the corrected one, rad/s, over ``time``, s, (n,)."""

    time: Array
    corrected: Array
    printed: Array


@dataclass(frozen=True)
class Sheet:
    """All that a mechanism's page shows of the closed form, SI, angles in rad.

    ``conditions``, ``axis``, ``units``, ``values``, ``peaks`` and ``figures`` are what ``linkproof results --json``
    writes; ``values``, without those of points and links, at as many of its instants as a curve needs (n,), φ
    ascending where that is the axis, not a number where there is none. ``shares`` has Jeq by Assur group ("groups") and
    by link ("links") over the same instants, kg m². ``moment_centre`` is the point that the shaking moment is about.
    ``facts`` are those of ``linkproof show --json``. ``published`` are the printed figures of all variants,
    ``released`` by regime what there is to say of a released crank, ``printed`` by erratum the motions of models as
    printed, of regimes that a campaign ran. ``missing`` says of a part why it cannot be derived.
    """

    name: str
    variant: str
    text: str
    gravity: Vector
    formula: str
    conditions: str
    axis: str
    units: Mapping[str, str]
    values: Mapping[str, Array]
    peaks: Mapping[str, SheetPeak]
    figures: SheetFigures
    facts: Mapping[str, Any]
    moment_centre: str = ""
    positions: Positions | None = None
    shares: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    normalised: Normalised | None = None
    thread: ThreadSheet | None = None
    published: tuple[PublishedFigure, ...] = ()
    released: Mapping[str, Released] = field(default_factory=dict)
    printed: Mapping[str, Printed] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def linkage(self) -> Linkage:
        """The linkage as it was described."""
        return replace(parse(self.text, self.name, self.name, self.variant), gravity=self.gravity)
