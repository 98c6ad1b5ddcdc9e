"""Valid linkages drawn at random: four-bars, offset slider-cranks, quick returns and six-bars, the same everywhere.

Sizes and masses are over four decades, and every transmission angle is one that a designer would accept.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic.errors import LinkproofError
from analytic.numerics.refine import grid
from analytic.signals import evaluate, names
from tests.analytic.linkages import from_text
from tests.analytic.mutations import document

KINDS = ("four-bar", "slider-crank", "quick return", "six-bar")
SEED = 9
MODERATE = 30.0  # mass ratio within a linkage up to which every engine is to hold
STEEPEST = math.radians(25.0)  # least transmission angle
HEAD = 'title = "{kind}"\nsource = "drawn"\ncrank = "crank"\ngravity = [0.7, -9.7]\n'
HEAD += 'units = {{ length = "m", mass = "kg", inertia = "kg*m^2", angle = "rad" }}\n'


@dataclass(frozen=True)
class Drawn:
    """One linkage, its kind and the ratio of its largest to its least mass."""

    kind: str
    ratio: float
    text: str


def draw(number: int, largest_ratio: float = MODERATE) -> Drawn:
    """The linkage of a number: the same on every machine."""
    kind = KINDS[number % len(KINDS)]
    for attempt in range(1000):
        text, ratio = _text(kind, np.random.default_rng([SEED, number, attempt]), largest_ratio)
        try:
            mechanism = from_text(text, f"drawn-{number}")
            mechanism.check_full_turn()
            between = [one for one in names(mechanism) if one.startswith("transmission_angle")]
            if min(float(np.min(angle)) for angle in evaluate(mechanism, grid(360), between).values()) >= STEEPEST:
                return Drawn(kind, ratio, text)
        except LinkproofError:
            continue
    raise RuntimeError(f"no valid linkage of number {number}")


SLOT = 'point = "A", on = "rocker", through = [0, 0], along = [1, 0]'


class _Drawing:
    """A linkage drawn at random: its sizes and masses, and the parts of its file so far."""

    def __init__(self, rng: np.random.Generator, largest_ratio: float) -> None:
        self.rng = rng
        self.size, base = 10.0 ** rng.uniform(-3.0, 1.0), 10.0 ** rng.uniform(-3.0, 1.0)
        self.masses = base * 10.0 ** rng.uniform(0.0, math.log10(largest_ratio), 6)
        self.links: list[str] = []
        self.ground, self.sketch, self.slots = {"O": (0.0, 0.0)}, dict[str, tuple[float, float]](), ""
        self.crank = self.size * rng.uniform(0.6, 1.0)
        self.link("crank", {"O": 0.0, "A": self.crank})
        self.frame = self.crank * rng.uniform(1.8, 4.0)

    def link(self, name: str, points: dict[str, float], slides: str = "") -> None:
        """Add a link with points on its x axis, or one that slides."""
        rng, mass = self.rng, float(self.masses[len(self.links)])
        length = max([*points.values(), 0.3 * self.size])
        centre = (0.0, 0.0) if rng.random() < 0.15 else (rng.uniform(-0.2, 1.0), rng.uniform(-0.2, 0.2))
        inertia = mass * length**2 * 10.0 ** rng.uniform(-2.7, -0.7)  # from 0.2 % of m l²
        places = ", ".join(f"{point} = [{x!r}, 0]" for point, x in points.items())
        rest = f"centre = [{centre[0] * length!r}, {centre[1] * length!r}]\ninertia = {inertia!r}"
        if slides:
            rest = f"slides = {{ {slides} }}" + (f"\ninertia = {inertia!r}" if name == "block" else "")
        shape = f"points = {{ {places} }}\n" if points else ""
        self.links.append(f"[links.{name}]\n{shape}mass = {mass!r}\n{rest}\n")

    def four_bar(self, rocker_points: Callable[[float], dict[str, float]] = lambda _: {}) -> float:
        """Add coupler and rocker, which has points by its length; returns that length."""
        coupler, rocker = (self.crank * self.rng.uniform(2.0, 4.0) for _ in range(2))
        self.ground["C"] = (self.frame, 0.0)
        self.link("coupler", {"A": 0.0, "B": coupler})
        self.link("rocker", {"C": 0.0, "B": rocker} | rocker_points(rocker))
        along = ((self.frame - self.crank) ** 2 + coupler**2 - rocker**2) / (2.0 * (self.frame - self.crank))
        self.sketch["B"] = (self.crank + along, math.sqrt(max(coupler**2 - along**2, 0.0)))
        return rocker

    def six_bar(self) -> None:
        """Add a four-bar whose rocker pushes a piston."""
        rocker = self.four_bar(lambda length: {"E": 0.8 * length})
        (x, y), share = self.sketch["B"], 0.8
        x, y = self.frame + share * (x - self.frame), share * y
        rod, height = rocker * self.rng.uniform(2.5, 5.0), rocker * self.rng.uniform(0.2, 0.6)
        self.sketch["D"] = (x + math.sqrt(rod**2 - (height - y) ** 2), height)
        self.piston({"E": 0.0, "D": rod}, height)

    def slider_crank(self) -> None:
        """Add a rod on the crank and an offset piston."""
        rod, height = self.crank * self.rng.uniform(2.5, 6.0), self.crank * self.rng.uniform(-0.8, 0.8)
        self.sketch["D"] = (self.crank + math.sqrt(rod**2 - height**2), height)
        self.piston({"A": 0.0, "D": rod}, height)

    def piston(self, rod: dict[str, float], height: float) -> None:
        """Add a rod and a piston at its point D."""
        self.link("rod", rod)
        self.link("piston", {}, f'point = "D", through = [0, {height!r}], along = [1, 0]')

    def quick_return(self) -> None:
        """Add a slotted rocker, its pin with or without a block."""
        self.ground["C"], self.sketch["E"] = (-self.frame, 0.0), (1.2 * self.crank + 0.2 * self.frame, 0.0)
        self.link("rocker", {"C": 0.0, "E": 1.2 * (self.crank + self.frame)})
        if self.rng.random() < 0.5:
            self.link("block", {}, SLOT)
        else:
            self.slots = f"slots = [{{ {SLOT} }}]\n"

    def text(self, kind: str) -> str:
        """The linkage's file."""
        ground = "".join(f"{name} = [{x!r}, {y!r}]\n" for name, (x, y) in self.ground.items())
        places = ", ".join(f"{name} = [{x!r}, {y!r}]" for name, (x, y) in self.sketch.items())
        links = "".join(self.links)
        head = HEAD.format(kind=kind) + self.slots
        return f"{head}[ground]\n{ground}{links}[sketch]\nangle = 0\npoints = {{ {places} }}\n"


def _text(kind: str, rng: np.random.Generator, largest_ratio: float) -> tuple[str, float]:
    """A linkage file and its mass ratio."""
    drawing = _Drawing(rng, largest_ratio)
    getattr(drawing, kind.replace(" ", "_").replace("-", "_"))()
    return drawing.text(kind), float(math.exp(np.ptp(np.log(drawing.masses[: len(drawing.links)]))))


def placed(
    text: str,
    *,
    turn: float = 0.0,
    shift: tuple[float, float] = (0.0, 0.0),
    unit: tuple[str, float] = ("m", 1.0),
    mirrored: bool = False,
    reverse: bool = False,
) -> str:
    """The file turned by an angle (gravity with it), shifted, in another unit of length, mirrored, listed backwards."""
    file, flip = tomllib.loads(text), np.array([1.0, -1.0 if mirrored else 1.0])
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

    def own(vector: Any) -> list[float]:
        return (np.array(vector) * flip / unit[1]).tolist()

    def there(place: Any) -> list[float]:
        return ((rotation @ (np.array(place) * flip) + shift) / unit[1]).tolist()

    file["units"]["length"], file["sketch"]["angle"] = unit[0], turn
    file["gravity"] = (rotation @ (np.array(file["gravity"]) * flip)).tolist()
    for places in (file["ground"], file["sketch"]["points"]):
        places.update({name: there(place) for name, place in places.items()})
    for link in file["links"].values():
        link["points"] = {name: own(place) for name, place in link.get("points", {}).items()}
        if "centre" in link:
            link["centre"] = own(link["centre"])
    guides = [link["slides"] for link in file["links"].values() if "slides" in link]
    for guide in (*guides, *file.get("slots", ())):
        is_fixed = "on" not in guide
        guide["through"] = (there if is_fixed else own)(guide["through"])
        guide["along"] = ((rotation if is_fixed else np.eye(2)) @ (np.array(guide["along"]) * flip)).tolist()
    if reverse:
        file["links"] = dict(reversed(file["links"].items()))
        for link in file["links"].values():
            link["points"] = dict(reversed(link["points"].items()))
    return document(file)
