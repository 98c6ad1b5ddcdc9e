"""How far engines may be trusted over a space of designs, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from comparisons.designs.trust.trust import TRANSMISSION, DesignRun, DesignStanding, EngineTrust, Side, SpaceTrust
from reports.document.numbers import error, figure
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printout

HEAD = ("engine", *(standing.value for standing in DesignStanding), "worst error over its limit", "of", "in design")


def printout(trust: SpaceTrust, drawn: str, conditions: str) -> Printout:
    """A row per engine, then in sentences where each gives way; ``drawn`` and ``conditions`` say of what, in words."""
    sample = trust.sample
    own = " and that of the file" if any(one.number == 0 for one in sample.designs) else ""
    again = f"; {sample.in_vain} more were drawn that cannot make this motion" if sample.in_vain else ""
    count = sum(one.number > 0 for one in sample.designs)
    table = Table(
        f"Designs simulated: {count} {drawn}{own}{again}. {conditions}",
        HEAD,
        [_row(trust, one) for one in trust.engines],
        "lrrrrrll",
    )
    closing = [sentence for one in trust.engines for sentence in _sentences(trust, one)]
    if any(one.count(DesignStanding.NOT_JUDGED) for one in trust.engines):
        closing.append("What was not judged has not passed.")
    return Printout([Paragraph("Trust in engines over these designs", colour="bold"), table, ""], closing)


def _row(trust: SpaceTrust, one: EngineTrust) -> tuple[str, ...]:
    counts = (f"{one.count(standing)}" for standing in DesignStanding)
    return (_name(one), *counts, error(one.worst.share), one.worst.quantity, _design(trust, one.worst))


def _name(one: EngineTrust) -> str:
    return f"{one.engine} {one.setting}"


def _design(trust: SpaceTrust, run: DesignRun) -> str:
    return next(one.name for one in trust.sample.designs if one.number == run.design)


def _sentences(trust: SpaceTrust, one: EngineTrust) -> Iterator[str]:
    """Where an engine gives way, and where it does not."""
    failing = [run for run in one.runs if run.gives_way]
    judged = [run for run in one.runs if run.standing is not DesignStanding.NOT_JUDGED]
    if not judged:
        yield f"{_name(one)}: not judged on any design: {one.runs[0].reason}"
    elif not failing:
        bound = "" if one.bound is None else f"; with 95 % certainty fewer than {one.bound:.0%} of such designs are not"
        yield f"{_name(one)}: all {len(judged)} designs that were judged are within their limits{bound}"
    elif len(failing) == len(judged):
        yield f"{_name(one)}: gives way on all {len(judged)} designs that were judged: {failing[0].reason}"
    elif one.rule is None or not one.rule.tells:
        chance = "" if one.rule is None else f", none better than chance finds in {one.rule.chance:.0%} of all cases"
        yield f"{_name(one)}: gives way on {len(failing)} of {len(judged)} designs, which nothing tells apart{chance}"
    else:
        (failed, of), (also, others) = one.rule.failing, one.rule.others
        yield (
            f"{_name(one)}: gives way where {_where(one.rule.side)}: there lie {failed} of {of} failing designs and "
            f"{also} of {others} others (chance does as well in {one.rule.chance:.1%} of all cases)"
        )
    if failing and one.safe is not None:
        side, count = one.safe
        yield f"{_name(one)}: within limits on all {count} designs where {_up_to(side)}, a range read off this sample"
    yield from (f"{_name(one)}, {_design(trust, run)}: {run.reason}" for run in _worst(failing))


def _worst(failing: list[DesignRun]) -> list[DesignRun]:
    """The failing design that is farthest from its limit, and the first without a result."""
    lost = [run for run in failing if run.standing is DesignStanding.NO_RESULT][:1]
    over = [run for run in failing if run.standing is DesignStanding.OVER]
    return [*([max(over, key=lambda run: run.share)] if over else []), *lost]


def _where(side: Side) -> str:
    return f"{_feature(side)} is {'below' if side.below else 'above'} {_value(side)}"


def _up_to(side: Side) -> str:
    return f"{_feature(side)} is {_value(side)} or {'less' if side.below else 'more'}"


def _feature(side: Side) -> str:
    return f"the {side.feature}" if side.feature == TRANSMISSION else side.feature


def _value(side: Side) -> str:
    unit = "°" if side.unit == "deg" else f" {side.unit}" if side.unit else ""
    return f"{figure(side.value)}{unit}"
