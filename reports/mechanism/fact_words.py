"""The facts on a linkage in words, a pair of a name and its sentence each; what needs no word here is left out.

Facts are those of ``comparisons.designer.linkage_check``, SI and rad, or a part of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

from analytic.description.linkage import LOADS
from analytic.errors import listed
from comparisons.designer.open_ends import BINDS
from reports.document.numbers import within_turn

Facts = Mapping[str, Any]
Pairs = Iterator[tuple[str, str]]
MOST_GROUPS, SHOWN_GROUPS = 7, 3  # of a long structure the first few and the last are named
MOST_DYADS: Final = 5  # whose transmission angles are named, the least first
OFF: Final = 0.2  # of the linkage's extent: a sketched point farther from its place is pointed out
SLIDING: Final = (
    "RPP",
    "PRP",
    "RPR",
)  # groups that slides turn, to which the rule of transmission angles does not apply


def review_words(facts: Facts, written: Callable[[float], str]) -> Pairs:
    """Yield all facts of a review as pairs, as far as it came; ``written`` writes a length, m, in the file's unit."""
    if facts["source"]:
        yield "source", facts["source"]
    if len(facts["variants"]) > 1:
        yield "variants", ", ".join(facts["variants"])
    if "mobility" in facts:
        yield "mobility", facts["mobility"]["formula"]
    if facts["loose_points"]:
        yield "free points", f"{', '.join(facts['loose_points'])} (on no joint)"
    if "structure" in facts:
        yield "groups", _structure_words(facts["structure"])
    if facts.get("four_bar"):
        yield "four-bar", facts["four_bar"]
    if "range" in facts:
        yield from _range_words(facts["range"])
    yield from _transmission_words(facts.get("transmission", {}))
    yield "masses", _mass_words(facts["loads"])
    yield "loads", _load_words(facts["loads"])
    off = facts["sketch"]["off"] if "sketch" in facts else {}
    if off:
        farthest = max(off, key=off.__getitem__)
        yield "sketch", f"up to {written(off[farthest])} from where it is assembled ({farthest})"
    if "error_bound" in facts:
        yield from _accuracy_words(facts)
    yield from _turn_words(facts)
    if facts.get("printed"):
        yield "printed", _printed_words(facts["printed"])


def mechanism_words(facts: Facts) -> Pairs:
    """Yield the facts on the motion as pairs: the range, and what a full turn shows."""
    if "range" in facts:
        yield from _range_words(facts["range"])
    yield from _turn_words(facts)


def warning_words(facts: Facts, written: Callable[[float], str]) -> Iterator[str]:
    """Yield the warnings of a review, a sentence each, then on sketched points far from their places.

    Last come small transmission angles of a crank that turns fully, but for groups that slides turn.
    ``written`` writes a length, m, in the file's unit.
    """
    yield from facts["warnings"]
    sketch = facts.get("sketch", {"off": {}})
    for name, off in sketch["off"].items():
        if off > OFF * sketch["extent"]:
            yield f"sketch.points.{name} is {written(off)} off: correct it, or sketch.angle"
    # A crank that turns fully binds easily.
    if "transmission" in facts and facts["range"]["is_full_turn"] and not facts["range"]["change_points"]:
        for name, one in facts["transmission"].items():
            if one["least"] < BINDS and one["kind"] not in SLIDING:
                least, limit = math.degrees(one["least"]), math.degrees(BINDS)
                yield f"the transmission angle of {name} falls to {least:.1f}°: below {limit:g}° it binds easily"


def _structure_words(structure: str) -> str:
    """Driver and groups in their order as text; of more than seven the first three, the last and the number of groups.

    ``structure`` has them joined by " -> ", the driver first.
    """
    groups = structure.split(" -> ")
    if len(groups) <= MOST_GROUPS:
        return structure
    return f"{' -> '.join(groups[:SHOWN_GROUPS])} -> ... -> {groups[-1]}: {len(groups) - 1} groups"


def _range_words(found: Facts) -> Pairs:
    """Yield pairs on where the driver can go, and on the change points that it passes, from the facts on its range."""
    if found["is_full_turn"]:
        yield "crank", "turns fully"
    else:
        causes = zip(found["words"], (found["low_limit"], found["high_limit"]), strict=True)
        ends = "; ".join(f"at {place} {cause}" if cause else f"followed to {place}" for place, cause in causes)
        yield "drive" if found["is_linear"] else "crank", f"from {' to '.join(found['words'])}; {ends}"
    for point in found["change_points"]:
        yield "passes", f"a change point at {point['where']}: {point['how']}"


def _transmission_words(dyads: Mapping[str, Facts]) -> Pairs:
    """Yield pairs on the least transmission angles of the five worst dyads, the least first, and on the others' number.

    ``dyads`` has the facts on each by its name.
    """
    for name, one in sorted(dyads.items(), key=lambda dyad: dyad[1]["least"])[:MOST_DYADS]:
        good = f"; {math.degrees(BINDS):g}° or more from {' to '.join(one['good_from_to'])}" if one["good"] else ""
        yield "transmission", f"{math.degrees(one['least']):.1f}° at least in {name}, at {one['where']}{good}"
    if len(dyads) > MOST_DYADS:
        yield "", f"and more in {len(dyads) - MOST_DYADS} other groups"


def _mass_words(loads: Facts) -> str:
    """Which links have mass and inertia, and what can be computed for that, in words, from the facts on loads."""
    if len(loads["without_mass"]) == loads["links"]:
        return f"none: kinematics alone{'' if loads['is_idle'] else ', and the torques and forces of the loads'}"
    heavy = f"all but {listed(loads['without_mass'])}" if loads["without_mass"] else "of all links"
    thin = f"; without inertia: {listed(loads['without_inertia'])}" if loads["without_inertia"] else ""
    return f"{heavy}{thin}: torque, power, energy, joint forces"


def _load_words(loads: Facts) -> str:
    """The loads by their kinds, and the output, in words, from the facts on loads."""
    counts = [(loads[kind], kind.replace("_", " ")) for kind in LOADS if loads[kind]]
    kinds = [f"{count} {name[:-1] if count == 1 else name}" for count, name in counts]
    output = f"output {loads['output']}: S, v, a" if loads["output"] else "no output: without S, v and a"
    return f"{', '.join(['gravity'] * loads['gravity'] + kinds) or 'none'}; {output}"


def _accuracy_words(facts: Facts) -> Pairs:
    """Yield pairs on how well the joints close, and on the bounds of the closed form's error."""
    turns, bound = "range" not in facts or facts["range"]["is_full_turn"], facts["error_bound"]
    where = "whole turn" if turns else "range, up to 2 % from its ends"
    yield "closure", f"joints closed to {facts['closure_error']:.1e} m over the {where}"
    if None in bound.values():
        yield "accuracy", "no error bound can be given"
    else:
        own, first, second = (f"within {bound[part]:.0e}" for part in ("position", "first", "second"))
        yield "accuracy", f"closed form {own} of peak, its first derivative {first}, its second {second}"


def _turn_words(facts: Facts) -> Pairs:
    """Yield pairs on the reduced inertia of a full turn, the output's travel, and the angles of rest, where known."""

    def angle(value: float, digits: int = 1) -> str:
        """An angle, rad, in degrees within a turn, as text."""
        return within_turn(math.degrees(value), digits)

    if "Jeq" in facts:
        jeq = facts["Jeq"]
        most, least = (f"{jeq[end]:.4g} at {angle(jeq[f'{end}_at'])}" for end in ("max", "min"))
        yield "Jeq", f"mean {jeq['mean']:.4g}, max {most}, min {least} kg m²; pulsation {jeq['pulsation']:.2%}"
    if "output" in facts:
        out = facts["output"]
        top, bottom = angle(out["top_dead_centre"]), angle(out["bottom_dead_centre"])
        yield "output", f"{out['point']}, stroke {out['stroke'] * 1e3:.4g} mm, top dead centre {top}, bottom {bottom}"
    if facts.get("equilibria"):
        rests = [(angle(rest["angle"], 2), "stable" if rest["stable"] else "unstable") for rest in facts["equilibria"]]
        yield "rests at", ", ".join(f"{place} ({kind})" for place, kind in rests)


def _printed_words(printed: Facts) -> str:
    """How many of the sources' figures are reproduced, or why none can be computed, in words.

    ``printed`` has the facts on them.
    """
    if "fault" in printed:
        return f"the figures of the sources cannot be computed: {printed['fault']}"
    near = f", {printed['near']} within 6 %" if printed["near"] else ""
    rest = printed["figures"] - printed["reproduced"] - printed["near"]
    why = "; the file says why the others are not" if rest else ""
    return f"{printed['reproduced']} of {printed['figures']} figures of the sources are reproduced{near}{why}"
