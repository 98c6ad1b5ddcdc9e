"""The review of a linkage by ``linkproof check``: step after step, until a step fails; SI units and rad."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.dynamics import reduced
from analytic.dynamics.equation_of_motion import equilibria
from analytic.errors import LinkproofError, StructureError
from analytic.kinematics.crank_range import CrankRange, Toggle
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Dyad, grashof, loose_points, mobility
from analytic.kinematics.sweep import transmission_angle
from analytic.motion.dead_centres import bottom_dead_centre, stroke, top_dead_centre
from analytic.numerics.refine import extremes, highest, periodic_mean
from analytic.numerics.roots import roots
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.published import NEAR, REPRODUCED, compare_published

Array = NDArray[np.float64]
Facts = dict[str, Any]

RANGE_SAMPLES: Final = 721
BINDS: Final = float(np.radians(40.0))  # transmission angle below which four-bars and slider-cranks bind easily (Alt)
INSET: Final = 1e-9  # of a range that ends in dead positions, so that its ends are assembled
DYADS_AT_ONCE: Final = (
    32  # dyads whose least angles are sought together: each look solves the whole linkage before them
)


def check(linkage: Linkage) -> tuple[Facts, LinkproofError | None]:
    """The facts of the review of a linkage, and the fault that ended it; None without a fault."""
    facts = file_facts(linkage)
    try:
        for step in _steps(linkage):
            facts |= step
    except LinkproofError as error:
        names = {"structure": f"{error.so_far} -> ?"} if isinstance(error, StructureError) and error.so_far else {}
        return facts | names | {"fault": str(error)}, error
    return facts | {"fault": None}, None


def _steps(linkage: Linkage) -> Iterator[Facts]:
    """The facts that each step adds; raises LinkproofError at the first fault."""
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
    if reach.is_full_turn and not reach.change_points:
        yield _accuracy_facts(mechanism)
    if reach.is_full_turn:
        yield _turn_facts(mechanism)
    yield from _printed_facts(linkage)


def file_facts(linkage: Linkage) -> Facts:
    """What a linkage's file says of its origin and its links."""
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
    """The facts of a linkage that can be assembled: those of its file, of its structure, and of a turn or its range."""
    reach = mechanism.crank_range()
    facts = file_facts(mechanism.linkage) | {"structure": mechanism.structure.formula}
    if reach.is_full_turn:
        return facts | _accuracy_facts(mechanism) | _turn_facts(mechanism)
    return facts | {"range": _range_facts(mechanism, reach)}


def _turn_facts(mechanism: Mechanism) -> Facts:
    """Figures of a full turn: inertias reduced to the crank, the output's travel, and where the linkage rests."""
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
    if any(linkage.gravity) or linkage.springs:
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
    """How far joints are open over a full turn, m, and how far the closed form can be wrong; None beyond all bounds."""
    bounds = (bound if np.isfinite(bound) else None for bound in mechanism.error_bound())
    return {
        "closure_error": float(np.max(mechanism.turn.closure_error())),
        "error_bound": dict(zip(("position", "first", "second"), bounds, strict=True)),
    }


def _printed_facts(linkage: Linkage) -> Iterator[Facts]:
    """How many figures the sources print for the variant, and how many are reproduced or near, or why none is."""
    try:
        verdicts = [record.verdict for record in compare_published([linkage])]
    except LinkproofError as error:  # of a linkage that was changed: it cannot make the motion of a printed figure
        yield {"printed": {"fault": str(error)}}
        return
    if verdicts:
        counts = {"reproduced": verdicts.count(REPRODUCED), "near": verdicts.count(NEAR)}
        yield {"printed": {"figures": len(verdicts), **counts}}


def _load_facts(linkage: Linkage) -> Facts:
    """Which links have mass and inertia, and what acts on them."""
    return {
        "without_mass": [name for name, link in linkage.links.items() if not link.mass],
        "without_inertia": [name for name, link in linkage.links.items() if link.mass and link.inertia == 0.0],
        "gravity": any(linkage.gravity),
        **{kind: len(getattr(linkage, kind)) for kind in ("forces", "torques", "springs", "dampers")},
        "output": linkage.output.point if linkage.output else None,
        "is_idle": linkage.is_idle,
        "links": len(linkage.links),
    }


def _sketch_facts(mechanism: Mechanism) -> Facts:
    """How far each sketched point is from where it is assembled, m, and how far the linkage extends."""
    linkage, sweep = mechanism.linkage, mechanism.sweep(mechanism.linkage.sketch_angle)
    off = {name: float(np.hypot(*(sweep.point(name) - place))) for name, place in linkage.sketch.items()}
    return {"angle": linkage.sketch_angle, "off": off, "extent": linkage.extent()}


def _range_facts(mechanism: Mechanism, reach: CrankRange) -> Facts:
    """Range of φ in this assembly mode, the reason for its ends, and its change points."""
    low, high = reach.limits

    def toggle(entry: Toggle | None) -> str | None:
        return entry.sentence if entry else None

    return {
        "is_full_turn": reach.is_full_turn,
        "is_linear": reach.is_linear,
        "low": low,
        "high": high,
        "low_limit": toggle(reach.low),
        "high_limit": toggle(reach.high),
        "change_points": [
            {
                "at": change_point.angle,
                "where": mechanism.linkage.place(change_point.angle),
                "how": change_point.sentence,
            }
            for change_point in reach.change_points
        ],
        "words": [reach.place(low), reach.place(high)],
    }


def _transmission_facts(mechanism: Mechanism, reach: CrankRange) -> Facts:
    """By group the least transmission angle, rad, and where the range has it."""
    low, high = reach.limits
    inset = 0.0 if reach.is_full_turn else INSET * (high - low)
    grid = np.linspace(low + inset, high - inset, RANGE_SAMPLES)
    dyads = mechanism.structure.dyads
    table: Facts = {}
    for first in range(0, len(dyads), DYADS_AT_ONCE):
        table |= _least_angles(mechanism, reach, dyads[first : first + DYADS_AT_ONCE], grid)
    return table


def _least_angles(mechanism: Mechanism, reach: CrankRange, dyads: Sequence[Dyad], grid: Array) -> Facts:
    """Least transmission angle, its place and the good stretch of each dyad, by its name; ``grid`` spans the range."""

    def angles(phi: Array) -> Array:
        """Transmission angles (dyads, n), rad, at values of φ."""
        sweep = mechanism.sweep(np.clip(phi, grid[0], grid[-1]))
        return np.stack([transmission_angle(sweep, dyad) for dyad in dyads])

    sampled = angles(grid)
    heights, spots = highest(lambda phi: -angles(phi), grid, -sampled)
    good = [[] for _ in dyads] if reach.is_full_turn else _good_stretches(angles, grid, sampled)
    place = mechanism.linkage.place if reach.is_full_turn else reach.place
    table: Facts = {}
    for dyad, least, at, ends in zip(dyads, (-heights).tolist(), spots.tolist(), good, strict=True):
        words = {"where": place(at), "good_from_to": [place(end) for end in ends]}
        table[dyad.name] = {"least": least, "at": at, "good": ends, "kind": dyad.kind, **words}
    return table


def _good_stretches(function: Callable[[Array], Array], grid: Array, angles: Array) -> list[list[float]]:
    """By dyad the ends, rad or m, of the stretch around its best place where it does not bind; [] if it always does."""
    brackets = np.zeros((2, 2, len(angles)))  # the last place where it is enough and the first where it is not
    for number, angle in enumerate(angles):
        enough, best = angle >= BINDS, int(np.argmax(angle))
        for side, direction in enumerate((-1, 1)):
            short = np.flatnonzero(~enough[best::direction])
            last = best + direction * (int(short[0]) - 1) if len(short) else (-1 if direction > 0 else 0)
            brackets[side, :, number] = grid[last], grid[last + direction] if len(short) else grid[last]
    ends = [
        roots(lambda phi: np.diagonal(function(phi)) - BINDS, inside, inside, outside) for inside, outside in brackets
    ]
    is_good = [bool(np.max(angle) >= BINDS) for angle in angles]
    return [[float(low), float(high)] if good else [] for low, high, good in zip(*ends, is_good, strict=True)]
