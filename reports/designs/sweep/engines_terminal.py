"""How far engines may be trusted over the designs of a sweep, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from comparisons.designs.sweep.simulated_designs import EngineOverDesigns, TellingNumber
from comparisons.judging.records import Verdict
from reports.document.numbers import error, figure
from reports.document.parts import Paragraph
from reports.document.terminal import Printout


def printout(engines: Sequence[EngineOverDesigns], seed: int) -> Printout:
    """In sentences: the designs on which each engine is within its limits, and the number that separates the others."""
    count = len(engines[0].designs) if engines else 0
    head = Paragraph(f"Engines over {count} of these designs (seed {seed})", colour="bold")
    return Printout([head], [sentence for engine in engines for sentence in _sentences(engine)])


def _sentences(designs: EngineOverDesigns) -> Iterator[str]:
    within = designs.judged - len(designs.failing)
    bound = (
        "" if designs.bound is None else f"; with 95 % certainty fewer than {designs.bound:.0%} of such designs are not"
    )
    yield f"{designs.engine}: within limits on {within} of {designs.judged} designs judged{bound}"
    if designs.not_judged:
        yield f"{designs.engine}: {len(designs.not_judged)} designs were not judged, and have not passed"
    if designs.telling is not None:
        yield f"{designs.engine}: {_where(designs.telling)}"
    elif designs.failing and within:
        yield f"{designs.engine}: no number separates the {len(designs.failing)} failing designs from the others"
    if designs.worst is not None:
        lost = designs.worst.error_max is None or designs.worst.outcome not in (Verdict.PASSED, Verdict.OVER_LIMIT)
        share = (
            designs.worst.error_max / designs.worst.limit
            if designs.worst.error_max is not None and designs.worst.limit
            else 0.0
        )
        worst = (
            designs.worst.detail if lost else f"{designs.worst.quantity} has an error of {error(share)} of its limit"
        )
        yield f"{designs.engine}: worst in {designs.worst.mechanism}: {worst}"


def _where(number: TellingNumber) -> str:
    name, _, unit = number.name.removesuffix("]").partition(" [")
    value = f"{figure(number.value)} {unit}".rstrip()
    side = f"{value} or less" if number.below else f"above {value}"
    return (
        f"fails where {name} is {side}: there lie {number.failing[0]} of {number.failing[1]} failing designs and "
        f"{number.others[0]} of {number.others[1]} others (as likely by chance: {number.chance:.1%})"
    )
