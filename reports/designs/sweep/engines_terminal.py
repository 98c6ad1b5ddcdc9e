"""How far engines may be trusted over the designs of a sweep, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from comparisons.designs.sweep.simulated_designs import EngineOverDesigns, TellingNumber
from comparisons.judging.records import Verdict
from reports.document.numbers import error, figure
from reports.document.parts import Paragraph
from reports.document.terminal import Printout


def printout(engines: Sequence[EngineOverDesigns], seed: int) -> Printout:
    """In sentences: on how many designs each engine is within its limits, and what tells failing designs apart."""
    count = len(engines[0].designs) if engines else 0
    head = Paragraph(f"Engines over {count} of these designs (seed {seed})", colour="bold")
    return Printout([head], [sentence for one in engines for sentence in _sentences(one)])


def _sentences(one: EngineOverDesigns) -> Iterator[str]:
    within = one.judged - len(one.failing)
    bound = "" if one.bound is None else f"; with 95 % certainty fewer than {one.bound:.0%} of such designs are not"
    yield f"{one.engine}: within limits on {within} of {one.judged} designs judged{bound}"
    if one.not_judged:
        yield f"{one.engine}: {len(one.not_judged)} designs were not judged, and have not passed"
    if one.telling is not None:
        yield f"{one.engine}: {_where(one.telling)}"
    elif one.failing and within:
        yield f"{one.engine}: no number separates the {len(one.failing)} failing designs from the others"
    if one.worst is not None:
        lost = one.worst.error_max is None or one.worst.outcome not in (Verdict.PASSED, Verdict.OVER_LIMIT)
        share = one.worst.error_max / one.worst.limit if one.worst.error_max is not None and one.worst.limit else 0.0
        worst = one.worst.detail if lost else f"{one.worst.quantity} has an error of {error(share)} of its limit"
        yield f"{one.engine}: worst in {one.worst.mechanism}: {worst}"


def _where(one: TellingNumber) -> str:
    name, _, unit = one.name.removesuffix("]").partition(" [")
    value = f"{figure(one.value)} {unit}".rstrip()
    side = f"{value} or less" if one.below else f"above {value}"
    return (
        f"fails where {name} is {side}: there lie {one.failing[0]} of {one.failing[1]} failing designs and "
        f"{one.others[0]} of {one.others[1]} others (as likely by chance: {one.chance:.1%})"
    )
