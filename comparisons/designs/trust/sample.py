"""A sample of a space of designs, each a linkage with a file of its own: the designs that engines are tried on."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import numbers, with_numbers
from analytic.description.crank_motion import CrankMotion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.loading import parse
from analytic.description.rewriting import rewritten
from analytic.errors import AssemblyError, LinkproofError, StructureError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.kinematics.transmission import transmission_angle
from comparisons.designs.parameters import Parameter
from comparisons.reference.case import Case

Array = NDArray[np.float64]
Draw = Callable[[int], Array]  # the next so many designs, (designs, parameters) in the file's units; fewer at the end

DIGITS: Final = 4  # behind the first one of a range, to which its values are drawn
TRIES: Final = 20  # designs drawn for each one wanted, before it is given up
ANGLES: Final = 720  # at which the least transmission angle is looked for


@dataclass(frozen=True)
class SampledDesign:
    """A design as a linkage; ``values`` are its parameters in the units of the file.

    ``transmission`` is the least angle, degrees, by which a group of two links keeps from a dead position, over 720
    places of the driver; nan where there is no such group. Number 0 is the design of the file itself.
    """

    number: int
    linkage: Linkage
    values: tuple[float, ...]
    transmission: float

    @property
    def name(self) -> str:
        """How it is called in tables."""
        return self.linkage.name if self.number else f"{self.linkage.name} itself"


@dataclass(frozen=True)
class DesignSample:
    """Designs of a space, and how many were drawn in vain, since they cannot move."""

    parameters: tuple[Parameter, ...]
    designs: tuple[SampledDesign, ...]
    in_vain: int


def hypercube(ends: Array, seed: int) -> Draw:
    """Latin hypercubes over ranges (parameters, 2): each time as many intervals of every range as designs are drawn."""
    from scipy.stats.qmc import LatinHypercube  # noqa: PLC0415 - a second that only a sample pays for

    cube = LatinHypercube(len(ends), seed=seed)
    low, size = ends[:, 0], ends[:, 1] - ends[:, 0]
    digits = [DIGITS - math.floor(math.log10(one)) if one > 0.0 else DIGITS for one in size]

    def draw(count: int) -> Array:
        values = low + size * np.asarray(cube.random(count))
        rounded = [np.round(column, place) for column, place in zip(values.T, digits, strict=True)]
        return np.asarray(np.clip(np.stack(rounded, axis=1), ends[:, 0], ends[:, 1]))

    return draw


def rows(count: int, row: Callable[[int], Array], seed: int) -> Draw:
    """Designs of a list by their numbers, each once, in an order drawn at random; ``row`` gives the values of one."""
    order = iter(np.random.default_rng(seed).permutation(count).tolist())

    def draw(wanted: int) -> Array:
        return np.array([row(number) for number in itertools.islice(order, wanted)])

    return draw


def sample(
    linkage: Linkage,
    parameters: Sequence[Parameter],
    draw: Draw,
    wanted: int,
    motions: Sequence[CrankMotion],
) -> DesignSample:
    """So many designs that can follow the motions, besides the linkage's own; those that cannot are drawn again.

    There are fewer where the designs are used up. Raises LinkproofError where a design is none or none can move.
    """
    if wanted < 1:
        raise LinkproofError(f"--designs: expected 1 design or more, got {wanted}; give more")
    own = tuple(one.value / one.unit.size for one in parameters)
    found = [SampledDesign(0, linkage, own, angle)] if (angle := _movable(linkage, motions)) is not None else []
    made = _Designs(Mechanism(linkage), parameters)
    number, tried = 0, 0
    while number < wanted and tried < TRIES * wanted:
        values = draw(wanted - number)
        if not len(values):
            break
        tried += len(values)
        for row in values.tolist():
            design = made.linkage(number + 1, row)
            angle = None if design is None else _movable(design, motions)
            if design is not None and angle is not None:
                number += 1
                found.append(SampledDesign(number, design, tuple(row), angle))
    if not number:
        raise LinkproofError(
            f"expected designs of '{linkage.name}' that can be assembled all the way, got none among {tried} drawn; "
            "vary less"
        )
    return DesignSample(tuple(parameters), tuple(found), tried - number)


@dataclass(frozen=True)
class _Designs:
    """Linkages of designs, in the assembly modes of the one they are made from."""

    mechanism: Mechanism
    parameters: Sequence[Parameter]

    def linkage(self, number: int, values: Sequence[float]) -> Linkage | None:
        """The design of these values; None where its sketch cannot be drawn in the assembly modes."""
        own, structure = self.mechanism.linkage, self.mechanism.structure
        wanted = {name: value for name, value in numbers(own).items() if name.startswith("gravity.")}
        wanted |= {one.name: value * one.unit.size for one, value in zip(self.parameters, values, strict=True)}
        signs = tuple(dyad.sign for dyad in structure.dyads)
        try:
            found = self._written(number, wanted)
            if structure.is_numerical or _signs(found) == signs:
                return found
            design = with_numbers(own, wanted)
            return self._written(number, wanted | _sketched(design, signs))
        except AssemblyError:
            return None

    def _written(self, number: int, wanted: Mapping[str, float]) -> Linkage:
        own = self.mechanism.linkage
        text = rewritten(own.text, own.name, own.variant, wanted, new_variant=f"design {number}")
        name = f"{own.name}-d{number:03d}"
        return parse(text, name, name)


def _signs(linkage: Linkage) -> tuple[int, ...] | None:
    """The assembly modes that a linkage's sketch picks; None where it leaves one open."""
    try:
        return tuple(dyad.sign for dyad in Mechanism(linkage).structure.dyads)
    except StructureError:
        return None


def _sketched(design: Linkage, signs: tuple[int, ...]) -> dict[str, float]:
    """The sketch as the design stands in these assembly modes."""
    structure = find_structure(design).with_signs(signs)
    sweep = Sweep(design, structure, np.asarray(design.sketch_angle))
    places = {point: sweep.point(point) for point in design.sketch}
    return {f"sketch.{point}.{axis}": float(value) for point, place in places.items()
            for axis, value in zip("xy", place, strict=True)}  # fmt: skip


def _movable(linkage: Linkage, motions: Sequence[CrankMotion]) -> float | None:
    """The least transmission angle, degrees, of a linkage that can follow the motions; None if it cannot."""
    try:
        mechanism = Mechanism(linkage)
        cases = [Case(mechanism, motion) for motion in motions]
        for case in cases:
            case.check_motion()
    except AssemblyError:
        return None
    angles = [angle for case in cases for angle in _transmission(case)]
    return math.degrees(min(angles, default=math.nan))


def _transmission(case: Case) -> Iterator[float]:
    low, high = case.reach
    turn = FULL_TURN if not case.mechanism.linkage.is_linear else math.inf
    sweep = case.mechanism.sweep(np.linspace(low, min(high, low + turn), ANGLES))
    for dyad in case.mechanism.structure.dyads:
        yield float(np.min(transmission_angle(sweep, dyad)))
