"""Linkages for the tests: the catalogue, the files of tests/linkages (one per feature), and families to draw from."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from analytic.description.loading import catalogue, load, parse
from analytic.errors import AssemblyError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep

FOLDER = Path(__file__).parents[1] / "linkages"
MADE_UP = tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))
CATALOGUE = tuple((name, variant) for name in catalogue() for variant in load(name).variants)
EVERY = (*((name, None) for name in MADE_UP), *CATALOGUE)
# Its crank passes change points at 0° and 180°, which tests that take a full turn leave aside.
FULL_TURN = tuple((name, variant) for name, variant in EVERY if name != "parallelogram")


@cache
def mechanism(name: str, variant: str | None = None) -> Mechanism:
    """A linkage of the tests or of the catalogue."""
    return Mechanism(load(str(FOLDER / f"{name}.toml") if name in MADE_UP else name, variant))


def from_text(text: str, name: str = "sample") -> Mechanism:
    """A linkage written out in a test."""
    return Mechanism(parse(text, name, f"{name}.toml"))


def text_of(name: str) -> str:
    """The file of a made-up linkage."""
    return (FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def angles(count: int, seed: int = 1) -> np.ndarray:
    """Crank angles of no special kind, rad."""
    return np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, count)


def modes(mechanism: Mechanism, angle: float) -> Iterator[Sweep]:
    """The linkage at one crank angle in every assembly mode it has there."""
    choices = [(1, -1) if dyad.has_two_modes else (0,) for dyad in mechanism.structure.dyads]
    for signs in itertools.product(*choices):
        sweep = Sweep(mechanism.linkage, mechanism.structure.with_signs(signs), np.asarray(angle))
        try:
            for body in mechanism.structure.bodies:
                sweep.rates(body)
        except AssemblyError:
            continue
        yield sweep


def file_text(name: str) -> str:
    """The text of a linkage of the folder ``files``, which is there for these tests alone."""
    return (Path(__file__).parent / "files" / f"{name}.toml").read_text(encoding="utf-8")


IN_LINE = file_text("slider-crank-in-line")

FOUR_BAR = """
title = "four-bar"
source = "drawn at random"
units = {{ length = "{length}", mass = "kg", inertia = "kg*m^2", angle = "rad" }}
crank = "crank"
gravity = [{gravity[0]!r}, {gravity[1]!r}]
ground = {{ O1 = {o1}, O2 = {o2} }}
{links}
[sketch]
angle = {angle!r}
points = {{ B = {b} }}
"""

LINK = """
[links.{name}]
points = {{ {points} }}
mass = {mass!r}
centre = {centre}
inertia = {inertia!r}
"""


def _pair(place: np.ndarray, scale: float) -> str:
    return f"[{float(place[0] * scale)!r}, {float(place[1] * scale)!r}]"


class FourBar:
    """A crank-rocker with every figure its own; ``text`` writes it in any placement, unit, order and handedness."""

    def __init__(self, lengths: tuple[float, float, float, float], inertias: np.ndarray, mode: int) -> None:
        self.frame, self.crank, self.coupler, self.rocker = lengths
        self.inertias = inertias  # rows: mass, centre x, centre y, inertia
        self.mode = mode

    def sketch(self) -> np.ndarray:
        """The pin B at crank angle 0, frame along x."""
        a, o2 = np.array([self.crank, 0.0]), np.array([self.frame, 0.0])
        d = o2 - a
        gap = np.hypot(*d)
        along = (gap**2 + self.coupler**2 - self.rocker**2) / (2.0 * gap)
        across = self.mode * np.sqrt(self.coupler**2 - along**2)
        return a + (along * d + across * np.array([-d[1], d[0]])) / gap

    def text(
        self,
        *,
        turn: float = 0.0,
        shift: tuple[float, float] = (0.0, 0.0),
        unit: tuple[str, float] = ("m", 1.0),
        mirrored: bool = False,
        reverse: bool = False,
    ) -> str:
        """The linkage turned by an angle (gravity with it), shifted, in other units, mirrored, listed backwards."""
        name, scale = unit[0], 1.0 / unit[1]
        flip = np.array([1.0, -1.0 if mirrored else 1.0])
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

        def placed(x: float, y: float) -> str:
            return _pair(rotation @ (np.array([x, y]) * flip) + shift, scale)

        ends = {
            "crank": ("O1", "A", self.crank),
            "coupler": ("A", "B", self.coupler),
            "rocker": ("O2", "B", self.rocker),
        }
        links = []
        for (link, (one, two, length)), row in zip(ends.items(), self.inertias, strict=True):
            points = [f"{one} = [0, 0]", f"{two} = {_pair(np.array([length, 0.0]), scale)}"]
            links.append(
                LINK.format(
                    name=link,
                    points=", ".join(reversed(points) if reverse else points),
                    mass=float(row[0]),
                    centre=_pair(row[1:3] * flip, scale),
                    inertia=float(row[3]),
                )
            )
        gravity = rotation @ (np.array([1.3, -9.7]) * flip)
        return FOUR_BAR.format(
            length=name,
            gravity=[float(part) for part in gravity],
            o1=placed(0.0, 0.0),
            o2=placed(self.frame, 0.0),
            links="".join(reversed(links) if reverse else links),
            angle=turn,
            b=placed(*self.sketch()),
        )


@st.composite
def four_bars(draw: st.DrawFn) -> FourBar:
    """Crank-rockers by Grashof: the crank is shortest, and shortest + longest < the other two by a good margin."""
    crank = 0.01 * draw(st.floats(1.0, 3.0))
    sizes = [crank * draw(st.floats(1.6, 4.0)) for _ in range(2)]
    longest = crank * draw(st.floats(1.7, 4.5))
    longest = min(longest, sum(sizes) - 1.4 * crank)
    longest = max(longest, abs(sizes[0] - sizes[1]) + 1.4 * crank)
    frame, coupler, rocker = draw(st.permutations([*sizes, longest]))
    row = st.tuples(st.floats(0.05, 1.0), st.floats(-0.02, 0.03), st.floats(-0.02, 0.02), st.floats(1e-5, 1e-4))
    inertias = np.array([draw(row) for _ in range(3)])
    return FourBar((frame, crank, coupler, rocker), inertias, draw(st.sampled_from([1, -1])))


SLIDER_CRANK = """
title = "slider-crank"
source = "drawn at random"
units = {{ length = "m", mass = "kg", inertia = "kg*m^2", angle = "rad" }}
crank = "crank"
gravity = [0.4, -9.7]
ground = {{ O = [0.3, -0.2] }}
output = {{ point = "D" }}
[links.crank]
points = {{ O = [0, 0], A = [{crank!r}, 0] }}
mass = 0.4
centre = [0.002, 0.001]
inertia = 1e-4
[links.rod]
points = {{ A = [0, 0], D = [{rod!r}, 0] }}
mass = {mass!r}
centre = [{centre!r}, 0.003]
inertia = 2e-4
[links.slider]
slides = {{ point = "D", through = {through}, along = {along} }}
mass = 0.2
[sketch]
points = {{ D = {d} }}
"""


@st.composite
def slider_cranks(draw: st.DrawFn) -> str:
    """Offset slider-cranks that make a full turn, in any direction."""
    crank = draw(st.floats(0.01, 0.05))
    offset = crank * draw(st.floats(-1.0, 1.0))
    rod = crank * draw(st.floats(2.3, 6.0))
    turn = draw(st.floats(0.0, 6.28))
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    through = np.array([0.3, -0.2]) + offset * across
    return SLIDER_CRANK.format(
        crank=crank,
        rod=rod,
        mass=draw(st.floats(0.05, 1.0)),
        centre=rod * draw(st.floats(-0.2, 1.0)),
        through=_pair(through, 1.0),
        along=_pair(along, 1.0),
        d=_pair(through + rod * along, 1.0),
    )


def path_of(name: str) -> str:
    """The file of a linkage."""
    return str(FOLDER / "drives" / f"{name}.toml")


@cache
def driven(name: str) -> Mechanism:
    """A linkage of the folder."""
    return Mechanism(load(path_of(name)))
