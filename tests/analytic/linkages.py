"""Linkages for the tests: the catalogue, the files of tests/linkages (one per feature), and families to draw from."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Linkage, LinkTorque, PointForce, RotaryDamper, Spring
from analytic.description.loading import catalogue, load, parse, read
from analytic.errors import AssemblyError, LinkproofError
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


def path_of(name: str) -> str:
    """The file of a linkage."""
    return str(FOLDER / "drives" / f"{name}.toml")


@cache
def driven(name: str) -> Mechanism:
    """A linkage of the folder."""
    return Mechanism(load(path_of(name)))


# Linkages with a motion that can be written down, and one whose crank only swings.


needs_extended_precision = pytest.mark.skipif(
    np.finfo(np.longdouble).eps > 1e-18, reason="this machine's long double is a double"
)

PENDULUM, ROTOR = file_text("pendulum"), file_text("rotor")
PENDULUM_RATE = math.sqrt(2 * 9.81 * 0.5 / (0.1 + 2 * 0.25))  # rad/s, of small oscillations
# Its crank swings between limits on both sides; turned upside down it has a place to rest.
DOUBLE_ROCKER = file_text("double-rocker")


def four_bar(ground, crank, coupler, rocker, start, *, side=1):
    """The text of a four-bar in m that is sketched at a crank angle, rad, with C left (1) or right (-1) of A→B."""
    x, y = crank * math.cos(start), crank * math.sin(start)
    gap = math.hypot(ground - x, y)
    along = (gap**2 + coupler**2 - rocker**2) / (2 * gap)
    across = side * math.sqrt(max(coupler**2 - along**2, 0.0))
    c = (x + (along * (ground - x) + across * y) / gap, y + (-along * y + across * (ground - x)) / gap)
    text = DOUBLE_ROCKER.replace('"mm"', '"m"').replace('angle = "deg"', 'angle = "rad"')
    numbers = {"B = [100": ground, "A = [80": crank, "C = [60": coupler, "C = [90": rocker}
    for old, new in numbers.items():
        text = text.replace(f"{old}, 0]", f"{old.split('[')[0]}[{new!r}, 0]")
    text = text.replace("angle = 70", f"angle = {start!r}").replace("[86, 90]", repr(list(c)))
    return text


# The linkage near toggle, far away from the origin of the drawing: 100 m cost four more digits of every coordinate.


FAR = text_of("near-toggle").replace("O1 = [0, 0]\nO2 = [79.9999", "O1 = [1e5, 0]\nO2 = [100079.9999999")
FAR = FAR.replace("[55, 30]", "[100055, 30]")


# Linkages on trial in force analysis: those of the tests, each bare and laden with every load, and some odd joints.


ODD = ("die-in-a-slot", "slider-before-its-host", "pin-in-two-slots", "carriage-and-crossed-blocks")
ON_TRIAL = tuple(itertools.product((*((name, None) for name in ODD), *EVERY), (False, True)))


@cache
def on_trial(name: str, variant: str | None, is_laden: bool) -> Mechanism:
    """A linkage by name, as it is or laden."""
    sample = from_text(file_text(name), name) if name in ODD else mechanism(name, variant)
    return Mechanism(laden(sample.linkage)) if is_laden else sample


def laden(linkage: Linkage) -> Linkage:
    """A linkage under forces at all points, torques on all links, and springs, dashpots and dampers between bodies."""
    draw = np.random.default_rng(5)
    scale = sum(link.mass for link in linkage.links.values()) * 20.0  # N, some weights
    length = linkage.extent()

    def law(size: float, parts: int) -> Law:
        values = size * draw.uniform(-1.0, 1.0, (4, parts))
        return Law(values, np.array([0.1, 1.5, 3.0, 4.9])) if draw.random() < 0.5 else Law(values[0])

    points = [(point, name) for name, link in linkage.links.items() for point in link.points]
    ends = [(point, GROUND) for point in linkage.ground] + points
    pairs = [(a, b) for a, b in itertools.combinations(ends, 2) if a[1] != b[1] and a[0] != b[0]]
    bodies = itertools.pairwise([GROUND, *linkage.links])
    return dataclasses.replace(
        linkage,
        gravity=(3.0, -9.0),
        forces=tuple(PointForce(*place, law(scale, 2)) for place in points),
        torques=tuple(LinkTorque(name, law(scale * length, 1)) for name in linkage.links if _turns(linkage, name)),
        springs=tuple(
            Spring((a[0], b[0]), (a[1], b[1]), scale / length, 0.7 * length, 0.01 * scale / length)
            for a, b in pairs[:: max(1, len(pairs) // 6)]
        ),
        dampers=tuple(RotaryDamper(pair, 0.002 * scale * length) for pair in bodies),
    )


def _turns(linkage: Linkage, name: str) -> bool:
    return linkage.links[name].inertia is not None


# A double rocker, whose crank can only swing, as a user writes it.


# Its file as a template for ``str.format``: the direction of the output is left open.
SWUNG_ROCKER = (
    file_text("swung-double-rocker").replace("{", "{{").replace("}", "}}").replace("[1, 0] }}", "[{0}, {1}] }}")
)


def double_rocker_text(along=(1.0, 0.0), regimes=""):
    """Its file; the crank reaches -74.4° to 74.4°."""
    return SWUNG_ROCKER.format(*along) + regimes


def double_rocker(along=(1.0, 0.0), regimes=""):
    """The linkage."""
    return parse(double_rocker_text(along, regimes), "double-rocker", "double-rocker.toml", None)


# A sound linkage file to spoil, and what the program says of it then.


JUKI = read("juki-mf7923d").text.split("[[published]]")[0]


def message_of(text, variant=None):
    """The one sentence with which a file is refused."""
    with pytest.raises(LinkproofError) as caught:
        Mechanism(parse(text, "sample", "sample.toml", variant))
    message = str(caught.value)
    assert "\n" not in message
    return message
