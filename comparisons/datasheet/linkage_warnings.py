"""Warnings about probable slips in a valid linkage: sizes, units, names."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Final

import numpy as np

from analytic.description.changes import without
from analytic.description.crank_motion import RPM
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import Link, Linkage, LinkTorque, PointForce, Spring
from analytic.description.written import file_unit
from analytic.dynamics.reduced import drive_torque, load_forces
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.refine import grid
from analytic.numerics.roots import evaluate_assembled

Load = PointForce | LinkTorque | Spring
LOADS: Final = ("forces", "torques", "springs")

FARTHEST_CENTRE: Final = 2.0  # of a link's size: how far outside of its points a mass centre may be
# Radius of gyration of a link over its size: of parts of linkages between 0.02 and 2.
LEAST_GYRATION, LARGEST_GYRATION = 0.005, 5.0
DENSEST: Final = 1e7  # kg/m³ in a cube of a link's size: crank discs of sewing machines have up to 2e5
# A link this heavy for its length is a disc, whose radius of gyration is no small share of its length.
HEAVY, CONCENTRATED = 1e5, 0.1
LARGEST_GRAVITY: Final = 100.0  # m/s²: what pulls harder is a slip of the unit, which is always m/s²
WIDEST_STEP: Final = 4.0  # times the usual step of a load's table: a wider one is a part of the turn without values
MOST_GAP: Final = math.radians(60.0)
OVERSHOOT: Final = 0.5  # of the range of a load's values: how far its spline may leave it
SHORTEST, LONGEST = 2e-3, 50.0  # a spring's free length over the linkage's size
# Of a load beside all else: rpm, crank angles, times as much, what rounding leaves of it.
SPEED, PLACES, MOST_TIMES, NOISE = 1000.0, 120, 100.0, 1e-9
SMALLER_UNITS: Final = {"N/mm": "N/m", "kN": "N", "N*m": "N*mm", "N m": "N*mm"}
UNIT_SLIPS: Final = {1e6: "kg*mm^2 read as kg*m^2", 1e-6: "kg*m^2 read as kg*mm^2"}


def warnings(linkage: Linkage) -> Iterator[str]:
    """Sentences about probable slips in a valid linkage: names, masses, loads."""
    yield from _similar_names(linkage)
    for link in linkage.links.values():
        yield from _mass_slips(linkage, link)
    yield from _load_slips(linkage)


def check_slips(linkage: Linkage) -> None:
    """Raise LinkproofError for the first warning about a linkage, as ``--strict`` asks."""
    for sentence in warnings(linkage):
        raise LinkproofError(f"--strict: {sentence}; or leave --strict out")


def _similar_names(linkage: Linkage) -> Iterator[str]:
    """Points whose names differ by capitals only, which are not pinned together."""
    spellings: dict[str, set[str]] = defaultdict(set)
    for name in itertools.chain(linkage.ground, *(link.points for link in linkage.links.values())):
        spellings[name.casefold()].add(name)
    for names in spellings.values():
        if len(names) > 1:
            yield f"points {' and '.join(map(repr, sorted(names)))} are two: a pin needs one spelling"


def _mass_slips(linkage: Linkage, link: Link) -> Iterator[str]:
    """Mass centre, mass and inertia beside the link's size."""
    size = max((math.dist(a, b) for a, b in itertools.combinations(link.points.values(), 2)), default=0.0)
    if not link.mass and any(link.centre) and any(body.mass for body in linkage.links.values()):
        yield f"'{link.name}' has a mass centre and no mass: it weighs nothing; add links.{link.name}.mass"
    if not link.mass or not size:
        return
    nearest = min(math.dist(link.centre, place) for place in link.points.values())
    if nearest > FARTHEST_CENTRE * size:
        yield (
            f"mass centre of '{link.name}' is {linkage.written(nearest)} from its nearest point, and the link "
            f"{linkage.written(size)} long: check links.{link.name}.centre"
        )
    concentrated = link.inertia and link.inertia < link.mass * (CONCENTRATED * size) ** 2
    if link.mass > (HEAVY if concentrated else DENSEST) * size**3:
        yield f"'{link.name}' weighs {link.mass:.4g} kg at a length of {linkage.written(size)}: check the unit of mass"
    if link.inertia:
        gyration = math.sqrt(link.inertia / link.mass)
        reach = max(size, *(math.dist(link.centre, place) for place in link.points.values()))
        if not LEAST_GYRATION * reach <= gyration <= LARGEST_GYRATION * reach:
            yield (
                f"inertia of '{link.name}' is that of its mass {linkage.written(gyration)} from the mass centre, and "
                f"its points are within {linkage.written(reach)}: check the unit of inertia"
                f"{_inertia_unit_slip(gyration / reach)}"
            )


def _load_slips(linkage: Linkage) -> Iterator[str]:
    """Size of gravity, free lengths of springs, tables of loads over the angle."""
    pull = math.hypot(*linkage.gravity)
    if pull > LARGEST_GRAVITY:
        yield f"gravity is {pull:.4g} m/s^2, which is the unit of gravity in every file: check its size"
    if linkage.gravity[1] > 0.0:
        yield "gravity points along +y, which is up in every drawing: write [0, -9.81] unless your y points down"
    for spring in linkage.springs:
        if not spring.has_length:
            yield f"the {_load_name(spring)} has no free length: it pulls at every length; add length if it has one"
        elif spring.length and not SHORTEST * linkage.extent() < spring.length < LONGEST * linkage.extent():
            yield (
                f"the {_load_name(spring)} is {linkage.written(spring.length)} long when free, and the linkage "
                f"{linkage.written(linkage.extent())}: check the unit of its length"
            )
    for force in linkage.forces:
        yield from _table_slips(_load_name(force), force.force)
    for torque in linkage.torques:
        yield from _table_slips(_load_name(torque), torque.torque)
    yield from _oversized_loads(linkage)


def _load_name(load: Load) -> str:
    """A load as warnings call it."""
    match load:
        case PointForce():
            return f"force at '{load.point}'"
        case LinkTorque():
            return f"torque on '{load.link}'"
    return f"spring between {' and '.join(load.points)}"


def _oversized_loads(linkage: Linkage) -> Iterator[str]:
    """A load beside which gravity, inertia, damping and the other loads together are nothing."""
    loads: tuple[Load, ...] = (*linkage.forces, *linkage.torques, *linkage.springs)
    if not loads:
        return
    try:
        loaded, bare = Mechanism(linkage), Mechanism(without(linkage, *LOADS))
    except LinkproofError:
        return
    places = loaded.turn.angle if linkage.is_linear else grid(PLACES)
    speed = 0.0 if linkage.is_linear else SPEED * RPM
    rest = evaluate_assembled(lambda angle: -drive_torque(bare.sweep(angle), speed, 0.0), places)
    known = np.isfinite(rest)
    rest, parts = rest[known], [part for _, part in load_forces(loaded.sweep(places[known]))]
    for load, part in zip(loads, parts, strict=True):
        besides = sum((other for other in parts if other is not part), rest)
        moved, others = (float(np.max(np.abs(values), initial=0.0)) for values in (part, besides))
        if moved > MOST_TIMES * others > NOISE * moved:
            at = "" if linkage.is_linear else f" at {SPEED:g} rpm"
            yield (
                f"the {_load_name(load)} moves the drive {moved / others:.2g} times as much as all else together{at}: "
                f"check its size{_unit_slip(load, linkage)}"
            )


def _unit_slip(load: Load, linkage: Linkage) -> str:
    """Words on the smaller unit that a load's number may be in; "" for none."""
    si = {PointForce: "N", LinkTorque: "N m", Spring: "N/m"}[type(load)]
    unit = file_unit(si, linkage).name
    return f" ({SMALLER_UNITS[unit]} read as {unit}?)" if unit in SMALLER_UNITS else ""


def _table_slips(load: str, law: Law) -> Iterator[str]:
    """A table that leaves out a part of the turn, and one whose spline goes far beyond its values."""
    if law.angles is None or not law.periodic:
        return
    steps = np.diff(np.append(law.angles, law.angles[0] + FULL_TURN))
    if np.max(steps) > max(MOST_GAP, WIDEST_STEP * float(np.median(steps))):
        at = int(np.argmax(steps))
        low, high = np.degrees([law.angles[at], law.angles[at] + steps[at]])
        yield (
            f"the {load} has no values between {low:.4g}° and {high:.4g}°, where a curve joins them: check the unit of "
            "its angles, or add values"
        )
    curve = law(np.linspace(0.0, FULL_TURN, 2000))
    low, high = np.min(law.values, axis=0), np.max(law.values, axis=0)
    beyond = np.maximum(np.max(curve, axis=-1) - high, low - np.min(curve, axis=-1))
    varies = high > low
    times = float(np.max(beyond[varies] / (high - low)[varies], initial=0.0))
    if times > OVERSHOOT:
        yield f"the {load} goes beyond its values by {times:.2g} times their range between two angles: add values there"


def _inertia_unit_slip(ratio: float) -> str:
    """Words on the unit that would bring a radius of gyration, over the link's size, into the link; "" for none."""
    for slip, words in UNIT_SLIPS.items():
        if LEAST_GYRATION <= ratio / math.sqrt(slip) <= LARGEST_GYRATION:
            return f" ({words}?)"
    return ""
