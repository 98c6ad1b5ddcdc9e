"""Key figures of the closed form: they change with a linkage's file, and do not depend on any engine."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from analytic.description.linkage import Linkage
from analytic.designs.figures import STROKE, Figure
from analytic.errors import LinkproofError
from analytic.motion.thread_feed import contour_length
from analytic.signals import moving_points
from comparisons.case import Case
from comparisons.datasheet.curves import Curves
from comparisons.datasheet.figures import MechanismFigure, case_figures, figure_unit, figures_by_name
from comparisons.judging.changes import CLOSED_FORM, Place, Row

USUAL_FIGURES: Final = (
    *("Mkr.peak", "Mkr.rms", "Peq.peak", "Jeq.mean", "joint_force.peak", "transmission_angle.min", STROKE),
    *("S.min", "S.max", "v.min", "v.max", "a.min", "a.max"),
)
DIRECTION: Final = "output:direction:"  # the parts of a unit vector, which have no unit
OUTPUT: Final = "output:point:"  # m, along x and y
THREAD: Final = "thread:length@0s"  # m, of its contour


@dataclass(frozen=True)
class KeyFigure:
    """A key figure of a linkage under a motion, SI, in its ``unit``."""

    mechanism: str
    variant: str
    regime: str
    conditions: str
    figure: str
    value: float
    unit: str = ""

    @property
    def row(self) -> Row:
        """Its row beside those of errors."""
        motion = (self.mechanism, self.variant, self.regime, self.conditions)
        return Row(Place(*motion, CLOSED_FORM, "", self.figure), value=self.value, unit=self.unit)


def figures_of_case(case: Case) -> list[KeyFigure]:
    """The key figures of a case, with their names and units."""
    linkage = case.mechanism.linkage
    place = (linkage.name, linkage.variant, case.motion.regime, case.conditions)
    return [KeyFigure(*place, name, value, _figure_unit(name, linkage)) for name, value in key_figures(case).items()]


def key_figures(case: Case) -> dict[str, float]:
    """Key figures of a case over its motion, SI, by name.

    A name is one of ``comparisons.datasheet.figures``.
    ``output:point:x@0s``, ``output:direction:x`` and ``thread:length@0s`` are no figures of a signal: which point is
    the output, its direction, and the length of the thread.
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
    """Figures of the description, SI, that can change without any change of a signal."""
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
