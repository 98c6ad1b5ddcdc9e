"""Key figures of the closed form: they change with a linkage's file, and do not depend on any engine."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.linkage import Linkage
from analytic.designs.figures import STROKE, Figure
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.thread_feed import contour_length
from analytic.signals import moving_points
from analytic.written import change
from comparisons.datasheet.curves import Curves
from comparisons.datasheet.figures import MechanismFigure, case_figures, figure_unit, figures_by_name
from comparisons.judging.baseline import SAME_FIGURE, Baseline, regime_key
from comparisons.judging.records import blank_record
from comparisons.reference.case import Case

ROUNDINGS: Final = 16  # of the largest figure of a unit: a smaller figure counts as zero
USUAL_FIGURES: Final = (
    *("Mkr.peak", "Mkr.rms", "Peq.peak", "Jeq.mean", "joint_force.peak", "transmission_angle.min", STROKE),
    *("S.min", "S.max", "v.min", "v.max", "a.min", "a.max"),
)
DIRECTION: Final = "output:direction:"  # the parts of a unit vector, which have no unit
OUTPUT: Final = "output:point:"  # m, along x and y
THREAD: Final = "thread:length@0s"  # m, of its contour


@dataclass(frozen=True)
class KeyFigure:
    """A key figure, SI, in its ``unit``, as ``recorded`` and as it is ``now``; None if it is missing.

    ``changed`` says that it is not as recorded; where nothing is recorded of its motion it cannot be.
    """

    mechanism: str
    variant: str
    regime: str
    conditions: str
    figure: str
    recorded: float | None
    now: float | None
    changed: bool
    unit: str = ""

    @property
    def sentence(self) -> str:
        """The recorded and the present value, in words."""
        place = f"{self.mechanism} ({self.variant}), {self.regime}: {self.figure}"
        recorded, now = (
            "" if value is None else f"{value:.9g} {self.unit}".rstrip() for value in (self.recorded, self.now)
        )
        if self.now is None:
            return f"{place} was {recorded} and is no figure any more"
        if self.recorded is None:
            return f"{place} is {now} and was not recorded"
        share = f", {change(self.share, '.2g')}" if self.share is not None else ""
        return f"{place} was {recorded} and is {now}{share}"

    @property
    def share(self) -> float | None:
        """Relative change since the recording; None if the recorded value is zero or missing."""
        return self.now / self.recorded - 1.0 if self.recorded and self.now is not None else None


def key_figures(case: Case, names: Iterable[str] = ()) -> dict[str, float]:
    """Key figures of a case over its motion, SI, by name, and those of further ``names`` that it has.

    A name is one of ``comparisons.datasheet.figures``. One at a place that the motion does not pass is left out.
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
    for name in (name for name in names if name not in values):
        with suppress(LinkproofError):
            values |= case_figures(curves, figures_by_name(mechanism, name))
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


def check_figures(names: Sequence[str], linkages: Iterable[Linkage]) -> None:
    """Raise LinkproofError for a figure that no linkage has; as many linkages are looked into as it takes."""
    lacking: dict[str, LinkproofError | None] = dict.fromkeys(names)
    for linkage in linkages if lacking else ():
        mechanism = Mechanism(linkage)
        for name in [*lacking]:
            try:
                figures_by_name(mechanism, name)
            except LinkproofError as error:
                lacking[name] = lacking[name] or error
            else:
                del lacking[name]
        if not lacking:
            return
    for name, why in lacking.items():
        raise LinkproofError(f"figures: no linkage has '{name}': {why}")


def present_figures(figures: Iterable[KeyFigure]) -> dict[tuple[str, str, str], dict[str, float]]:
    """Present values of key figures, SI, by name; by mechanism, variant and ``regime_key``."""
    groups: dict[tuple[str, str, str], dict[str, float]] = {}
    for figure in figures:
        if figure.now is not None:
            place = (figure.mechanism, figure.variant, regime_key(figure.regime, figure.conditions))
            groups.setdefault(place, {})[figure.figure] = figure.now
    return groups


def compared(cases: Iterable[Case], baseline: Baseline) -> list[KeyFigure]:
    """Every key figure beside a baseline's: changed is what differs by more than ``SAME_FIGURE`` of the recorded.

    So is every further figure that the baseline's coverage names, or that is recorded.
    """
    figures = []
    for case in cases:
        blank = blank_record(case, "")
        recorded = baseline.figures(blank)
        now = key_figures(case, (*baseline.coverage.figures, *recorded))
        units = {name: _figure_unit(name, case.mechanism.linkage) for name in (*recorded, *now)}
        least = _rounding_errors(recorded, units)
        for name, key in units.items():
            old, new = recorded.get(name), now.get(name)
            same = old is not None and new is not None and abs(new - old) <= max(SAME_FIGURE * abs(old), least[key])
            place = (blank.mechanism, blank.variant, blank.regime, blank.conditions)
            figures.append(KeyFigure(*place, name, old, new, changed=bool(recorded) and not same, unit=key))
    return figures


def _rounding_errors(recorded: Mapping[str, float], units: Mapping[str, str]) -> dict[str, float]:
    """By unit, the rounding error of the largest figure in that unit."""
    values = dict.fromkeys(units.values(), 0.0) | {"rad": SAME_FIGURE}  # a transmission angle of zero is rounding
    for name, value in recorded.items():
        values[units[name]] = max(values[units[name]], ROUNDINGS * float(np.finfo(float).eps) * abs(value))
    return values


def changes(cases: Iterable[Case], baseline: Baseline) -> list[KeyFigure]:
    """The key figures that are not as recorded."""
    return [figure for figure in compared(cases, baseline) if figure.changed]
