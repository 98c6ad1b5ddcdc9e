"""The results of a campaign under a user's own standard: limits, and results and key figures recorded before."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Final

from analytic.description.linkage import Linkage
from analytic.description.loading import parse
from analytic.designs.figures import STROKE, Figure
from analytic.errors import LinkproofError
from analytic.signals import contour_length, moving_points
from comparisons.designer.curves import Curves
from comparisons.designer.figures import MechanismFigure, case_figures, figure_unit, figures_by_name
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import GRAVITY, CampaignRequest, each_case
from comparisons.trials.judging.changes import CLOSED_FORM, Change, changes
from comparisons.trials.judging.records import Error
from engines.contract import Setting

USUAL_FIGURES: Final = (
    *("Mkr.peak", "Mkr.rms", "Peq.peak", "Jeq.mean", "joint_force.peak", "transmission_angle.min", STROKE),
    *("S.min", "S.max", "v.min", "v.max", "a.min", "a.max"),
)
DIRECTION: Final = "output:direction:"  # the parts of a unit vector, which have no unit
OUTPUT: Final = "output:point:"  # m, along x and y
THREAD: Final = "thread:length@0s"  # m, of its contour


def figures_of_case(case: Case) -> list[Error]:
    """The key figures of a case, SI, as Error records of the "engine" ``CLOSED_FORM``, with values as ``error_max``."""
    linkage = case.mechanism.linkage
    motion = (linkage.name, linkage.variant, case.motion.regime, case.conditions)
    return [
        Error(*motion, CLOSED_FORM, "", name, _figure_unit(name, linkage), value, outcome="")
        for name, value in key_figures(case).items()
    ]


def key_figures(case: Case) -> dict[str, float]:
    """Key figures of a case over its motion, SI, by name; those that it lacks or that are not finite are left out.

    They are ``USUAL_FIGURES`` and the places of moving points at the start, by the names of
    ``comparisons.designer.figures``, and three that are no figures of a signal: ``output:point:x@0s``,
    ``output:direction:x`` (y as well) and ``thread:length@0s`` are which point is the output, its direction, and the
    length of the thread.
    """
    mechanism, curves = case.mechanism, Curves(case)
    points = [f"point:{point}:{axis}@0s" for point in moving_points(mechanism.linkage) for axis in "xy"]
    usual: dict[str, Figure | MechanismFigure] = {}
    for name in (*USUAL_FIGURES, *points):
        with suppress(LinkproofError):
            usual |= figures_by_name(mechanism, name)
    values = case_figures(curves, usual) | dict(_description_figures(case))
    return {name: value for name, value in values.items() if math.isfinite(value)}


def _description_figures(case: Case) -> Iterator[tuple[str, float]]:
    """Yield name and value, SI, of figures of the description that may change while no signal does.

    They are the output's point and direction and the thread's length, those that the linkage has.
    """
    linkage, start = case.mechanism.linkage, case.start()
    if linkage.output is not None:
        place = start.point(linkage.output.point)
        for axis, coordinate, part in zip("xy", place, linkage.output.along, strict=True):
            yield f"{OUTPUT}{axis}@0s", float(coordinate[0])
            yield f"{DIRECTION}{axis}", part
    if linkage.thread is not None:
        yield THREAD, float(contour_length(start, linkage.thread)[0])


def _figure_unit(name: str, linkage: Linkage) -> str:
    """SI unit of a key figure by its name; empty for a direction and for unknown names."""
    if name == THREAD or name.startswith(OUTPUT):
        return "m"
    try:
        return figure_unit(name, linkage)
    except KeyError:
        return ""


def closed_form(request: CampaignRequest, *, every_variant: bool = False) -> list[Error]:
    """The key figures of a request's cases as Error records, as from ``figures_of_case``.

    ``every_variant`` adds those of the linkages' other variants; one that cannot follow a motion has none. Raises
    LinkproofError where a requested variant cannot, or has no regime to run in.
    """
    figures = [figure for case in each_case(request) for figure in figures_of_case(case)]
    for linkage in request.linkages if every_variant else ():
        for name in linkage.variants:
            if name != linkage.variant:
                other = replace(request, linkages=(parse(linkage.text, linkage.name, linkage.name, name),))
                with suppress(LinkproofError):
                    figures += [figure for case in [*each_case(other)] for figure in figures_of_case(case)]
    return figures


def changes_since(
    before: Iterable[Error], now: Iterable[Error], request: CampaignRequest, *, every_variant: bool = False
) -> tuple[Change, ...]:
    """The changes from rows ``before`` to those ``now``, of those results that a request asks for.

    They are in the order of the rows' names; ``every_variant`` and the errors raised are as for ``asked_rows``.
    """
    is_asked = asked_rows(request, every_variant=every_variant)
    return tuple(changes(filter(is_asked, before), filter(is_asked, now)))


def asked_rows(request: CampaignRequest, *, every_variant: bool = False) -> Callable[[Error], bool]:
    """The function that says whether a request asks for a row: its variant, engine, setting, quantity and motion.

    A linkage that it does not name is asked for, since its file may be deleted or renamed, and so is a motion with and
    without gravity, which is the linkage's. Naive settings decide nothing beside others, and are left out there. A
    regime of a linkage's own file is the same whatever its conditions are. ``every_variant`` asks for the closed form's
    other variants, too. Raises what ``each_case`` raises.
    """
    variants = {linkage.name: linkage.variant for linkage in request.linkages}
    motions = {(case.motion.regime, _without_gravity(case.conditions)) for case in each_case(request)}
    settings = {*request.settings, *(request.own_settings if request.own_regimes else ())}
    settings = settings - {Setting.NAIVE} or settings

    def is_asked(row: Error) -> bool:
        """Whether the request asks for this row; ``every_variant`` is the outer function's."""
        if (row.regime, _without_gravity(row.conditions)) not in motions and row.regime not in request.own_regimes:
            return False
        is_variant = variants.get(row.mechanism, row.variant) == row.variant
        if row.engine == CLOSED_FORM:
            return is_variant or every_variant
        is_quantity = not request.quantities or row.quantity.partition(":")[0] in request.quantities
        return is_variant and row.engine in request.engines and row.setting in settings and is_quantity

    return is_asked


def _without_gravity(conditions: str) -> str:
    """Conditions in words without their last part, ", gravity on" or "off"; conditions without it as they are."""
    return conditions.rpartition(GRAVITY)[0] or conditions
