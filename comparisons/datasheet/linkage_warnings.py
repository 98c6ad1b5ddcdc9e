"""What looks like a slip in a linkage that can be computed all the same: sizes, units, names."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Final

from analytic.description.linkage import Link, Linkage

FAR: Final = 2.0  # of a link's size: how far outside of its points a mass centre may be
# Radius of gyration of a link over its size: of parts of linkages between 0.02 and 2.
LEAST_GYRATION, LARGEST_GYRATION = 0.005, 5.0
DENSEST: Final = 1e7  # kg/m³ in a cube of a link's size: crank discs of sewing machines have up to 2e5
UNIT_SLIPS: Final = {1e6: "kg*mm^2 read as kg*m^2", 1e-6: "kg*m^2 read as kg*mm^2"}


def warnings(linkage: Linkage) -> Iterator[str]:
    """One sentence for each."""
    yield from _names(linkage)
    for link in linkage.links.values():
        yield from _masses(linkage, link)


def _names(linkage: Linkage) -> Iterator[str]:
    """Points whose names differ by capitals only, which are not pinned together."""
    spellings: dict[str, set[str]] = defaultdict(set)
    for name in itertools.chain(linkage.ground, *(link.points for link in linkage.links.values())):
        spellings[name.casefold()].add(name)
    for names in spellings.values():
        if len(names) > 1:
            yield f"points {' and '.join(map(repr, sorted(names)))} are two: a pin needs one spelling"


def _masses(linkage: Linkage, link: Link) -> Iterator[str]:
    """Mass centre, mass and inertia beside the link's size."""
    size = max((math.dist(a, b) for a, b in itertools.combinations(link.points.values(), 2)), default=0.0)
    if not link.mass or not size:
        return
    nearest = min(math.dist(link.centre, place) for place in link.points.values())
    if nearest > FAR * size:
        yield (
            f"mass centre of '{link.name}' is {linkage.written(nearest)} from its nearest point, and the link "
            f"{linkage.written(size)} long: check links.{link.name}.centre"
        )
    if link.mass > DENSEST * size**3:
        yield f"'{link.name}' weighs {link.mass:.4g} kg at a length of {linkage.written(size)}: check the unit of mass"
    if link.inertia:
        gyration = math.sqrt(link.inertia / link.mass)
        reach = max(size, *(math.dist(link.centre, place) for place in link.points.values()))
        if not LEAST_GYRATION * reach <= gyration <= LARGEST_GYRATION * reach:
            yield (
                f"inertia of '{link.name}' is that of its mass {linkage.written(gyration)} from the mass centre, and "
                f"its points are within {linkage.written(reach)}: check the unit of inertia{_slip(gyration / reach)}"
            )


def _slip(ratio: float) -> str:
    """The unit that would bring a radius of gyration into the link."""
    for slip, words in UNIT_SLIPS.items():
        if LEAST_GYRATION <= ratio / math.sqrt(slip) <= LARGEST_GYRATION:
            return f" ({words}?)"
    return ""
