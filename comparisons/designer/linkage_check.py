"""The review of a linkage by ``linkproof check``: step after step, until a step fails; SI units and rad."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np

from analytic.description.changes import without
from analytic.description.crank_motion import RPM
from analytic.description.law import Law
from analytic.description.linkage import LOADS, Link, Linkage, LinkTorque, PointForce, Spring, TorsionSpring
from analytic.description.written import file_unit
from analytic.dynamics import reduced
from analytic.dynamics.reduced import drive_torque, equilibria, load_forces
from analytic.errors import LinkproofError, StructureError
from analytic.kinematics.crank_range import CrankRange, Toggle
from analytic.kinematics.dead_centres import bottom_dead_centre, stroke, top_dead_centre
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import ClosedGroup, grashof, loose_points, mobility
from analytic.kinematics.sweep import transmission_angle
from analytic.numerics.arrays import Array
from analytic.numerics.refine import extremes, grid, highest, periodic_mean
from comparisons.designer.figures import NEAR, REPRODUCED, check_published, compare_published
from comparisons.designer.open_ends import INSET, RANGE_SAMPLES, good_stretches, inset_ends

Load = PointForce | LinkTorque | Spring | TorsionSpring

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

Facts = dict[str, Any]

DYADS_AT_ONCE: Final = (
    32  # dyads whose least angles are sought together: each look solves the whole linkage before them
)


def warnings(linkage: Linkage) -> Iterator[str]:
    """Yield sentences about probable slips in a valid linkage: names, masses, loads."""
    yield from _similar_names(linkage)
    for link in linkage.links.values():
        yield from _mass_slips(linkage, link)
    yield from _load_slips(linkage)


def check_slips(linkage: Linkage) -> None:
    """Raise LinkproofError for the first warning about a linkage, if there is one, as ``--strict`` asks."""
    for sentence in warnings(linkage):
        raise LinkproofError(f"--strict: {sentence}; or leave --strict out")


def _similar_names(linkage: Linkage) -> Iterator[str]:
    """Yield sentences about points whose names differ only in capitals, and which are thus not pinned together."""
    spellings: dict[str, set[str]] = defaultdict(set)
    for name in itertools.chain(linkage.ground, *(link.points for link in linkage.links.values())):
        spellings[name.casefold()].add(name)
    for names in spellings.values():
        if len(names) > 1:
            yield f"points {' and '.join(map(repr, sorted(names)))} are two: a pin needs one spelling"


def _mass_slips(linkage: Linkage, link: Link) -> Iterator[str]:
    """Yield sentences about a mass centre, mass or inertia that does not suit the link's size.

    So too about a mass centre without a mass where other links have one.
    """
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
    """Yield sentences about an odd gravity, free length of a spring, load over the angle, or size of a load.

    So too about a spring without a free length.
    """
    pull = math.hypot(*linkage.gravity)
    if pull > LARGEST_GRAVITY:
        yield f"gravity is {pull:.4g} m/s^2, which is the unit of gravity in every file: check its size"
    if linkage.gravity[1] > 0.0:
        yield "gravity points along +y, which is up in every drawing: write [0, -9.81] unless your y points down"
    for spring in linkage.springs:
        if not spring.has_length:
            yield f"the {load_name(spring)} has no free length: it pulls at every length; add length if it has one"
        elif spring.length and not SHORTEST * linkage.extent() < spring.length < LONGEST * linkage.extent():
            yield (
                f"the {load_name(spring)} is {linkage.written(spring.length)} long when free, and the linkage "
                f"{linkage.written(linkage.extent())}: check the unit of its length"
            )
    for force in linkage.forces:
        yield from _table_slips(load_name(force), force.force)
    for torque in linkage.torques:
        yield from _table_slips(load_name(torque), torque.torque)
    yield from _oversized_loads(linkage)


def load_name(load: Load) -> str:
    """The name of a load in warnings: "force at 'D'", "spring between A and B"."""
    match load:
        case PointForce():
            return f"force at '{load.point}'"
        case LinkTorque():
            return f"torque on '{load.link}'"
        case TorsionSpring():
            return f"torsion spring between {' and '.join(load.links)}"
    return f"spring between {' and '.join(load.points)}"


def _oversized_loads(linkage: Linkage) -> Iterator[str]:
    """Yield a sentence for each load beside which gravity, inertia, damping and other loads are negligible.

    None for a linkage that cannot be assembled.
    """
    without_drag = [kind for kind in LOADS if kind != "dampers"]
    if not any(getattr(linkage, kind) for kind in without_drag):
        return
    try:
        loaded, bare = Mechanism(linkage), Mechanism(without(linkage, *without_drag))
    except LinkproofError:
        return
    places = loaded.turn.angle if linkage.is_linear else grid(PLACES)
    speed = 0.0 if linkage.is_linear else SPEED * RPM
    rest = bare.where_assembled(lambda sweep: -drive_torque(sweep, speed, 0.0), places)
    known = np.isfinite(rest)
    rest, parts = rest[known], list(load_forces(loaded.sweep(places[known])))
    for load, part in parts:
        besides = sum((other for _, other in parts if other is not part), rest)
        moved, others = (float(np.max(np.abs(values), initial=0.0)) for values in (part, besides))
        if moved > MOST_TIMES * others > NOISE * moved:
            at = "" if linkage.is_linear else f" at {SPEED:g} rpm"
            yield (
                f"the {load_name(load)} moves the drive {moved / others:.2g} times as much as all else together{at}: "
                f"check its size{_unit_slip(load, linkage)}"
            )


def _unit_slip(load: Load, linkage: Linkage) -> str:
    """Words, in brackets after a blank, that suggest a smaller unit for a load's number: " (N read as kN?)".

    "" where the file's unit has no smaller one.
    """
    si = {PointForce: "N", LinkTorque: "N m", Spring: "N/m", TorsionSpring: "N m"}[type(load)]
    unit = file_unit(si, linkage).name
    return f" ({SMALLER_UNITS[unit]} read as {unit}?)" if unit in SMALLER_UNITS else ""


def _table_slips(load: str, law: Law) -> Iterator[str]:
    """Yield sentences about a table that leaves out part of the turn, or whose spline overshoots its values.

    ``load`` is the load's name. Nothing for a law that is no table over a turn of φ.
    """
    if law.angles is None or not law.period:
        return
    steps = np.diff(np.append(law.angles, law.angles[0] + law.period))
    if np.max(steps) > max(MOST_GAP, WIDEST_STEP * float(np.median(steps))):
        at = int(np.argmax(steps))
        low, high = np.degrees([law.angles[at], law.angles[at] + steps[at]])
        yield (
            f"the {load} has no values between {low:.4g}° and {high:.4g}°, where a curve joins them: check the unit of "
            "its angles, or add values"
        )
    curve = law(np.linspace(0.0, law.period, 2000))
    low, high = np.min(law.values, axis=0), np.max(law.values, axis=0)
    beyond = np.maximum(np.max(curve, axis=-1) - high, low - np.min(curve, axis=-1))
    varies = high > low
    times = float(np.max(beyond[varies] / (high - low)[varies], initial=0.0))
    if times > OVERSHOOT:
        yield f"the {load} goes beyond its values by {times:.2g} times their range between two angles: add values there"


def _inertia_unit_slip(ratio: float) -> str:
    """Words that suggest the unit which brings a ratio of radius of gyration to size into bounds.

    They are in brackets after a blank; "" where none of UNIT_SLIPS does.
    """
    for slip, words in UNIT_SLIPS.items():
        if LEAST_GYRATION <= ratio / math.sqrt(slip) <= LARGEST_GYRATION:
            return f" ({words}?)"
    return ""


def check(linkage: Linkage) -> tuple[Facts, LinkproofError | None]:
    """All facts on a linkage up to its first fault, and that fault as an error, None without one.

    Facts are by name, SI; "fault" is the error's message, None without one. Of a structure that cannot be divided its
    part so far is "structure".
    """
    facts = file_facts(linkage)
    try:
        for step in _steps(linkage):
            facts |= step
    except LinkproofError as error:
        names = {"structure": f"{error.so_far} -> ?"} if isinstance(error, StructureError) and error.so_far else {}
        return facts | names | {"fault": str(error)}, error
    return facts | {"fault": None}, None


def _steps(linkage: Linkage) -> Iterator[Facts]:
    """Yield the facts of each step of the review, by name, in order; raises LinkproofError at the first fault."""
    yield {
        "loads": _load_facts(linkage),
        "warnings": list(warnings(linkage)),
        "loose_points": list(loose_points(linkage)),
    }
    count = mobility(linkage)
    yield {"mobility": {"degrees": count.degrees, "formula": count.formula}}
    structure = find_structure(linkage)
    yield {"structure": structure.formula, "four_bar": grashof(linkage, structure)}
    mechanism = Mechanism(linkage)
    yield {"sketch": _sketch_facts(mechanism)}
    reach = mechanism.crank_range()
    yield {"range": _range_facts(mechanism, reach)}
    yield {"transmission": _transmission_facts(mechanism, reach)}
    if not (reach.is_full_turn and reach.change_points):
        yield _accuracy_facts(mechanism)
    if reach.is_full_turn:
        yield _turn_facts(mechanism)
    check_published(mechanism)
    yield from _printed_facts(linkage)


def file_facts(linkage: Linkage) -> Facts:
    """The facts that a linkage's file gives of its origin and its links, SI."""
    return {
        "mechanism": linkage.name,
        "title": linkage.title,
        "source": linkage.source,
        "variant": linkage.variant,
        "variants": list(linkage.variants),
        "links": {
            link.name: {
                "points": {point: list(local) for point, local in link.points.items()},
                "mass": link.mass,
                "centre": list(link.centre),
                "inertia": link.inertia,
            }
            for link in linkage.links.values()
        },
        "notes": list(linkage.notes),
    }


def mechanism_facts(mechanism: Mechanism) -> Facts:
    """The facts of a linkage that assembles: those of its file, of its structure, and of a turn or its range, SI.

    Raises LinkproofError for those that cannot be derived.
    """
    reach = mechanism.crank_range()
    facts = file_facts(mechanism.linkage) | {"structure": mechanism.structure.formula}
    facts |= _accuracy_facts(mechanism)
    return facts | (_turn_facts(mechanism) if reach.is_full_turn else {"range": _range_facts(mechanism, reach)})


def _turn_facts(mechanism: Mechanism) -> Facts:
    """The facts on a full turn: reduced inertias, kg m², the output's travel, m, and the angles of rest, rad.

    They are under "Jeq", "output" and "equilibria", and under "links" those of its file, each with its mean "Jeq_mean".
    Those that the linkage lacks are left out. Raises LinkproofError where the output stands still.
    """
    linkage = mechanism.linkage
    links = file_facts(linkage)["links"]
    for name, link in links.items():
        link["Jeq_mean"] = periodic_mean(reduced.link_inertia(mechanism.turn, name))
    facts: Facts = {"links": links}
    if not linkage.is_massless:
        inertia = extremes(lambda phi: reduced.reduced_inertia(mechanism.sweep(phi)))
        facts["Jeq"] = {
            "mean": inertia.mean,
            "max": inertia.maximum,
            "min": inertia.minimum,
            "pulsation": inertia.relative_pulsation,
            "max_at": inertia.maximum_angle,
            "min_at": inertia.minimum_angle,
        }
    if any(linkage.gravity) or linkage.springs or linkage.torsion_springs:
        facts["equilibria"] = [{"angle": rest.angle, "stable": bool(rest.stable)} for rest in equilibria(mechanism)]
    if linkage.output is not None:
        facts["output"] = {
            "point": linkage.output.point,
            "stroke": stroke(mechanism),
            "top_dead_centre": top_dead_centre(mechanism).angle,
            "bottom_dead_centre": bottom_dead_centre(mechanism).angle,
        }
    return facts


def _accuracy_facts(mechanism: Mechanism) -> Facts:
    """How far joints are open, m, and bounds of the closed form's relative error, None for infinite ones.

    They are "closure_error", and under "error_bound" those of "position" and its "first" and "second" derivatives. All
    are found over a full turn, else over the range short of its ends.
    """
    reach = mechanism.crank_range()
    sweep = mechanism.turn if reach.is_full_turn else mechanism.sweep(np.linspace(*inset_ends(reach), RANGE_SAMPLES))
    bounds = (bound if np.isfinite(bound) else None for bound in relative_bounds(sweep))
    return {
        "closure_error": float(np.max(sweep.closure_error())),
        "error_bound": dict(zip(("position", "first", "second"), bounds, strict=True)),
    }


def _printed_facts(linkage: Linkage) -> Iterator[Facts]:
    """Yield the facts on printed figures: how many the variant has, and how many we meet, or why none.

    They are under "printed": "figures", "reproduced" and "near", or the "fault". Nothing for a variant without any.
    """
    try:
        verdicts = [record.verdict for record in compare_published([linkage])]
    except LinkproofError as error:  # of a linkage that was changed: it cannot make the motion of a printed figure
        yield {"printed": {"fault": str(error)}}
        return
    if verdicts:
        counts = {"reproduced": verdicts.count(REPRODUCED), "near": verdicts.count(NEAR)}
        yield {"printed": {"figures": len(verdicts), **counts}}


def _load_facts(linkage: Linkage) -> Facts:
    """The facts on masses and loads: names of links without mass, of those with a mass and inertia 0, and counts.

    Counts are of loads by kind and of links; besides, whether there is gravity, whether the linkage ``is_idle``, and
    the name of the output's point, None without one.
    """
    return {
        "without_mass": [name for name, link in linkage.links.items() if not link.mass],
        "without_inertia": [name for name, link in linkage.links.items() if link.mass and link.inertia == 0.0],
        "gravity": any(linkage.gravity),
        **{kind: len(getattr(linkage, kind)) for kind in LOADS},
        "output": linkage.output.point if linkage.output else None,
        "is_idle": linkage.is_idle,
        "links": len(linkage.links),
    }


def _sketch_facts(mechanism: Mechanism) -> Facts:
    """The sketch's φ, how far each sketched point is off its assembled place, m, and the linkage's extent, m.

    They are under "angle", rad or m, "off", by point, and "extent".
    """
    linkage, sweep = mechanism.linkage, mechanism.sweep(mechanism.linkage.sketch_angle)
    off = {name: float(np.hypot(*(sweep.point(name) - place))) for name, place in linkage.sketch.items()}
    return {"angle": linkage.sketch_angle, "off": off, "extent": linkage.extent()}


def _range_facts(mechanism: Mechanism, reach: CrankRange) -> Facts:
    """The facts on the range of φ in this assembly mode: its ends, rad or m, with their reasons, its change points.

    Besides, whether it is a full turn, whether the drive is linear, and the ends in "words".
    """
    low, high = reach.limits

    def toggle(entry: Toggle | None) -> str | None:
        """The sentence of an end of the range; None without an end."""
        return entry.sentence if entry else None

    return {
        "is_full_turn": reach.is_full_turn,
        "is_linear": reach.phi.is_linear,
        "low": low,
        "high": high,
        "low_limit": toggle(reach.low),
        "high_limit": toggle(reach.high),
        "change_points": [
            {
                "at": change_point.angle,
                "where": mechanism.linkage.phi.text(change_point.angle),
                "how": change_point.sentence,
            }
            for change_point in reach.change_points
        ],
        "words": [reach.phi.unwrapped(low), reach.phi.unwrapped(high)],
    }


def _transmission_facts(mechanism: Mechanism, reach: CrankRange) -> Facts:
    """The facts of ``_least_angles`` on all dyads, by name, over the range or the full turn."""
    low, high = reach.limits
    inset = 0.0 if reach.is_full_turn else INSET * (high - low)
    grid = np.linspace(low + inset, high - inset, RANGE_SAMPLES)
    dyads = mechanism.structure.dyads
    table: Facts = {}
    for first in range(0, len(dyads), DYADS_AT_ONCE):
        table |= _least_angles(mechanism, reach, dyads[first : first + DYADS_AT_ONCE], grid)
    return table


def _least_angles(mechanism: Mechanism, reach: CrankRange, dyads: Sequence[ClosedGroup], grid: Array) -> Facts:
    """Least transmission angle, its place and the good stretch of each dyad, by its name; ``grid`` spans the range.

    Under "least", rad, "at", rad or m, and "good", two ends or [], as over a full turn; "kind" is the dyad's; "where"
    and "good_from_to" are the places in words.
    """

    def angles(phi: Array) -> Array:
        """Transmission angles (dyads, n), rad, at values of φ, within the grid's ends."""
        sweep = mechanism.sweep(np.clip(phi, grid[0], grid[-1]))
        return np.stack([transmission_angle(sweep, dyad) for dyad in dyads])

    sampled = angles(grid)
    heights, spots = highest(lambda phi: -angles(phi), grid, -sampled)
    good = [[] for _ in dyads] if reach.is_full_turn else good_stretches(angles, grid, sampled)
    place = reach.phi.text if reach.is_full_turn else reach.phi.unwrapped
    table: Facts = {}
    for dyad, least, at, ends in zip(dyads, (-heights).tolist(), spots.tolist(), good, strict=True):
        words = {"where": place(at), "good_from_to": [place(end) for end in ends]}
        table[dyad.name] = {"least": least, "at": at, "good": ends, "kind": dyad.kind, **words}
    return table
