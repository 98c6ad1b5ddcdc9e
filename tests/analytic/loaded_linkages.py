"""Linkages on trial in force analysis: those of the tests, each bare and laden with every load, and some odd joints."""

import dataclasses
import itertools
from functools import cache

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Linkage, LinkTorque, PointForce, RotaryDamper, Spring
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import EVERY, file_text, from_text, mechanism

ODD = ("die-in-a-slot", "slider-before-its-host", "pin-in-two-slots", "carriage-and-crossed-blocks")
ALL = tuple(itertools.product((*((name, None) for name in ODD), *EVERY), (False, True)))


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
