"""A linkage ready to be evaluated: its structure found, its assembly modes chosen from the sketch."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from analytic import dyads
from analytic.dyads import Pose
from analytic.errors import StructureError
from analytic.groups import group
from analytic.linkage import GROUND, Linkage, Vector
from analytic.structure import Dyad, Structure, find_structure
from analytic.sweep import Sweep, assembled, crank_pose

# Two assembly modes closer to the sketch than this ratio of each other are not told apart by it.
AMBIGUITY = 0.9
FULL_TURN = 2.0 * np.pi


class Mechanism:
    """The closed form of one linkage.

    Raises StructureError if the linkage cannot be taken apart or its sketch leaves an assembly mode open, and
    AssemblyError if it cannot be put together at the sketch's crank angle.
    """

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = linkage
        self.structure: Structure = _signed(linkage, find_structure(linkage))

    def sweep(self, angle: ArrayLike) -> Sweep:
        """The linkage at every crank angle (rad, any shape); nothing is computed until it is asked for."""
        return Sweep(self.linkage, self.structure, np.asarray(angle, dtype=float))

    @cached_property
    def turn(self) -> Sweep:
        """One full turn in half-degree steps: extremes are refined from here."""
        return self.sweep(np.linspace(0.0, FULL_TURN, 720, endpoint=False))

    def check_full_turn(self) -> None:
        """Raise AssemblyError where the crank cannot make a full turn."""
        for body in self.structure.bodies:
            self.turn.poses(body)


def _signed(linkage: Linkage, structure: Structure) -> Structure:
    """Choose each dyad's sign as the mode that lies nearer to the sketch, one dyad after the other."""
    poses: dict[str, Pose] = {
        GROUND: (0.0, 0.0, 1.0, 0.0),
        linkage.crank: crank_pose(structure.pivot, linkage.sketch_angle),
    }
    signs = []
    for dyad in structure.dyads:
        dyad = _nearest_mode(linkage, structure, dyad, poses)
        signs.append(dyad.sign)
        poses[dyad.first], poses[dyad.second] = group(dyad).poses(poses)
    return structure.with_signs(tuple(signs))


def _nearest_mode(linkage: Linkage, structure: Structure, dyad: Dyad, poses: dict[str, Pose]) -> Dyad:
    if not dyad.has_two_modes:
        return dyad
    modes = {sign: _mode(dyad, sign) for sign in (1, -1)}
    distance = {}
    for sign, mode in modes.items():
        solver = group(mode)
        pair = dict(zip((mode.first, mode.second), solver.poses(poses), strict=True))
        assembled(linkage, structure, solver, mode, poses, np.asarray(linkage.sketch_angle))
        distance[sign] = _distance_to_sketch(linkage, structure, pair)
    nearer, farther = sorted(modes, key=lambda sign: distance[sign])
    if not distance[nearer] < AMBIGUITY * distance[farther]:
        raise StructureError(
            f"the sketch of '{linkage.name}' leaves open how '{dyad.first}' and '{dyad.second}' are assembled: give a "
            f"rough position at crank angle {math.degrees(linkage.sketch_angle):g}° of "
            f"{_helpful_points(structure, dyad)}"
        )
    return modes[nearer]


def _mode(dyad: Dyad, sign: int) -> Dyad:
    """The dyad in one of its two assembly modes."""
    return replace(dyad, sign=sign)


def _distance_to_sketch(linkage: Linkage, structure: Structure, pair: dict[str, Pose]) -> float:
    square = 0.0
    for name, pose in pair.items():
        for point, local in structure.bodies[name].points.items():
            if point in linkage.sketch:
                x, y = dyads.point(pose, local)
                target: Vector = linkage.sketch[point]
                square += float((x - target[0]) ** 2 + (y - target[1]) ** 2)
    return math.sqrt(square)


def _helpful_points(structure: Structure, dyad: Dyad) -> str:
    points = sorted({p for name in (dyad.first, dyad.second) for p in structure.bodies[name].points})
    return "one of " + ", ".join(f"'{p}'" for p in points)
