"""What ``linkproof check`` says of a linkage: a line for each thing that was looked at."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

from analytic.errors import listed
from reports.document.parts import Paragraph
from reports.document.terminal import Printed

Facts = Mapping[str, Any]
Written = Callable[[float], str]
BINDS: Final = 40.0  # degrees of transmission angle below which four-bars and slider-cranks bind easily (Alt)
MOST_GROUPS: Final = 5
ACCURACY: Final = (
    "closed form within {position:.0e} of peak, its first derivative within {first:.0e}, its second within {second:.0e}"
)
FAR: Final = 0.2  # of the drawing's size: a sketched point farther off is worth a look
TURNED_BY_SLIDES: Final = ("RPP", "PRP", "RPR")  # kinds to which that rule does not apply


def printed(facts: Facts, written: Written) -> list[Printed]:
    """Everything found out; ``written`` writes a length, m, in the file's unit."""
    heading = Paragraph(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", colour="bold")
    said = [f"{label:<13}{text}" for label, text in _lines(facts, written)]
    warnings = [Paragraph(f"warning: {text}", colour="yellow") for text in _warnings(facts, written)]
    return [heading, *said, *warnings]


def _lines(facts: Facts, written: Written) -> Iterator[tuple[str, str]]:
    if "mobility" in facts:
        yield "mobility", facts["mobility"]["formula"]
    if facts["loose_points"]:
        yield "free points", f"{', '.join(facts['loose_points'])} (on no joint)"
    if "structure" in facts:
        yield "groups", _formula(facts["structure"])
    if facts.get("four_bar"):
        yield "four-bar", facts["four_bar"]
    if "range" in facts:
        yield from range_lines(facts["range"])
    yield from _transmission(facts.get("transmission", {}))
    yield "masses", _masses(facts["loads"])
    yield "loads", _loads(facts["loads"])
    if facts.get("sketch", {}).get("off"):
        off = facts["sketch"]["off"]
        worst = max(off, key=lambda name: float(off[name]))
        yield "sketch", f"up to {written(off[worst])} from where it is assembled ({worst})"
    if "error_bound" in facts:
        bound = facts["error_bound"]
        yield "closure", f"joints closed to {facts['closure_error']:.1e} m over the whole turn"
        yield "accuracy", "no error bound can be given" if None in bound.values() else ACCURACY.format(**bound)


def _formula(structure: str) -> str:
    """The structural formula, of a long chain its beginning and its end."""
    parts = structure.split(" -> ")
    if len(parts) <= MOST_GROUPS + 2:
        return structure
    return " -> ".join([*parts[:3], "...", parts[-1]]) + f": {len(parts) - 1} groups"


def range_lines(found: Facts) -> Iterator[tuple[str, str]]:
    """How far the crank, or the drive along a line, can be moved, and which change points it passes."""
    low, high = found["words"]
    if found["is_full_turn"]:
        yield "crank", "turns fully"
    else:
        limits = zip((low, high), (found["low_limit"], found["high_limit"]), strict=True)
        causes = [f"at {place} {cause}" if cause else f"followed to {place}" for place, cause in limits]
        yield ("drive" if found["is_linear"] else "crank"), f"from {low} to {high}; {'; '.join(causes)}"
    for point in found["change_points"]:
        yield "passes", f"a change point at {point['where']}: {point['how']}"


def _transmission(found: Facts) -> Iterator[tuple[str, str]]:
    """The groups of the least transmission angles."""
    worst = sorted(found, key=lambda name: float(found[name]["least"]))
    for name in worst[:MOST_GROUPS]:
        one = found[name]
        good = f"; {BINDS:g}° or more from {' to '.join(one['good_from_to'])}" if one["good"] else ""
        yield "transmission", f"{math.degrees(one['least']):.1f}° at least in {name}, at {one['where']}{good}"
    if len(worst) > MOST_GROUPS:
        yield "", f"and more in {len(worst) - MOST_GROUPS} other groups"


def _masses(loads: Facts) -> str:
    without, points = loads["without_mass"], loads["without_inertia"]
    if len(without) == loads["links"]:
        told = "none: kinematics alone" + ("" if loads["is_idle"] else ", and the torques and forces of the loads")
        return told
    parts = [f"all but {listed(without)}" if without else "of all links"]
    parts += [f"without inertia: {listed(points)}"] if points else []
    return f"{'; '.join(parts)}: torque, power, energy, joint forces"


def _loads(loads: Facts) -> str:
    kinds = ["gravity"] if loads["gravity"] else []
    counts = {kind: loads[kind] for kind in ("forces", "torques", "springs", "dampers")}
    kinds += [f"{count} {kind.removesuffix('s') if count == 1 else kind}" for kind, count in counts.items() if count]
    output = f"output {loads['output']}: S, v, a" if loads["output"] else "no output: without S, v and a"
    return f"{', '.join(kinds) or 'none'}; {output}"


def _warnings(facts: Facts, written: Written) -> Iterator[str]:
    yield from facts["warnings"]
    sketch = facts.get("sketch", {"off": {}, "extent": 0.0})
    for name, off in sketch["off"].items():
        if off > FAR * sketch["extent"]:
            yield f"sketch.points.{name} is {written(off)} off: correct it, or sketch.angle"
    if "transmission" in facts and facts["range"]["is_full_turn"] and not facts["range"]["change_points"]:
        for name, found in facts["transmission"].items():
            least = math.degrees(found["least"])
            if least < BINDS and found["kind"] not in TURNED_BY_SLIDES:
                yield f"the transmission angle of {name} falls to {least:.1f}°: below {BINDS:g}° it binds easily"
