"""Linkages for the tests: the catalogue, the files of tests/linkages (one per feature), and families to draw from."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

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


def path_of(name: str) -> str:
    """The file of a linkage."""
    return str(FOLDER / "drives" / f"{name}.toml")


@cache
def driven(name: str) -> Mechanism:
    """A linkage of the folder."""
    return Mechanism(load(path_of(name)))
