"""Key figures of the closed form: what tells that a linkage's file has changed, whatever engines do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.linkage import Linkage
from analytic.designs.figure_names import STROKE
from analytic.signals import COMPONENTS, MAGNITUDE, ONE_OF_ITS_KIND, moving_points, signal, unit
from analytic.turn.thread_feed import contour_length
from analytic.written import change
from comparisons.datasheet.curves import TRANSMISSION, Curves
from comparisons.judging.baseline import SAME_FIGURE, Baseline, regime_key
from comparisons.judging.records import blank_record
from comparisons.reference.case import Case

ROUNDINGS: Final = 16  # of the largest figure of a unit: what is less is not told from none
DIRECTION: Final = "output:direction:"  # the parts of a unit vector, which have no unit
OUTPUT: Final = "output:point:"  # m, along x and y
THREAD: Final = "thread:length"  # m, of its contour


@dataclass(frozen=True)
class KeyFigure:
    """A key figure, SI, in its ``unit``, as ``recorded`` and as it is ``now``; None where there is none.

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
        """What is recorded and what is now, in words."""
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
        """By what share of the recorded it has changed; None where that is nothing."""
        return self.now / self.recorded - 1.0 if self.recorded and self.now is not None else None


def key_figures(case: Case) -> dict[str, float]:
    """Key figures of a case over its motion, SI, by name; ``figure_unit`` has the unit of each.

    Peaks of Mkr, Peq and every joint force (``Mkr.peak``, ``joint_force:A.peak``), mean Jeq, root mean square of Mkr;
    ``.min`` and ``.max`` of S, v and a, ``stroke``; ``.min`` of the transmission angle of every group. Where every
    moving point is in the first instant (``point:C:x.first``): a point moved in its link moves there as far; the
    thread's length there. Which point is the output, and its direction (``output:point:x.first``,
    ``output:direction:x``).
    """
    curves = Curves(case)
    found = {**_extremes(curves), **_means(curves), **dict(_places(case))}
    least = curves.peaks(name for name in curves.names if name.startswith(TRANSMISSION))
    found |= {f"{name}.min": peak.value for name, peak in least.items() if peak.value is not None}
    return {name: value for name, value in found.items() if math.isfinite(value)}


def _extremes(curves: Curves) -> dict[str, float]:
    """Peaks of the loads, both ends of the output's motion."""
    peaks = [name for name in curves.names if name in ("Mkr", "Peq") or _is_joint_force(name)]
    measures = {name.removesuffix(MAGNITUDE) + ".peak": (lambda at, of=name: abs(curves.of(at, of))) for name in peaks}
    for name in (name for name in ("S", "v", "a") if name in curves.names):
        measures[f"{name}.min"] = lambda at, of=name: -signal(at, of)
        measures[f"{name}.max"] = lambda at, of=name: signal(at, of)
    places = curves.places(measures)
    truth = curves.at(np.array([*places.values()]))
    heights = {name: float(measures[name](truth)[row]) for row, name in enumerate(places)}
    found = {name: -height if name.endswith(".min") else height for name, height in heights.items()}
    return found | ({STROKE: found["S.max"] - found["S.min"]} if "S" in curves.names else {})


def _means(curves: Curves) -> dict[str, float]:
    if "Jeq" not in curves.names:
        return {}
    inertia, square = curves.means(lambda at: signal(at, "Jeq"), lambda at: np.square(signal(at, "Mkr")))
    return {"Jeq.mean": inertia, "Mkr.rms": math.sqrt(square)}


def _places(case: Case) -> Iterator[tuple[str, float]]:
    """Where moving points are in the first instant and how long the thread is, m; the output's point and direction."""
    linkage, start = case.mechanism.linkage, case.start()
    points = [(f"point:{point}:", point) for point in moving_points(linkage)]
    for name, point in [*points, *([(OUTPUT, linkage.output.point)] if linkage.output else [])]:
        for axis, coordinate in zip("xy", start.point(point), strict=True):
            yield f"{name}{axis}.first", float(coordinate[0])
    if linkage.thread is not None:
        yield f"{THREAD}.first", float(contour_length(start, linkage.thread)[0])
    for axis, part in zip("xy", linkage.output.along if linkage.output else (), strict=False):
        yield f"{DIRECTION}{axis}", part


def figure_unit(name: str, linkage: Linkage) -> str:
    """SI unit of a key figure by its name; none of a direction, and of what is no key figure of this version."""
    stem = name.rpartition(".")[0]
    kind = stem.partition(":")[0]
    if name == STROKE or name.startswith((OUTPUT, THREAD)):
        return "m"
    if kind not in {*ONE_OF_ITS_KIND, *COMPONENTS}:
        return ""
    return unit(f"{stem}:x" if kind == "joint_force" else stem, linkage)


def _is_joint_force(name: str) -> bool:
    return name.startswith("joint_force:") and name.endswith(MAGNITUDE)


def figures(cases: Iterable[Case]) -> dict[tuple[str, str, str], dict[str, float]]:
    """Key figures by mechanism, variant and ``regime_key``."""
    found = {}
    for case in cases:
        linkage = case.mechanism.linkage
        key = regime_key(case.motion.regime, case.conditions)
        found[linkage.name, linkage.variant, key] = key_figures(case)
    return found


def compared(cases: Iterable[Case], baseline: Baseline) -> list[KeyFigure]:
    """Every key figure beside a baseline's: changed is what differs by more than ``SAME_FIGURE`` of the recorded."""
    found = []
    for case in cases:
        blank = blank_record(case, "")
        recorded, now = baseline.figures(blank), key_figures(case)
        units = {name: figure_unit(name, case.mechanism.linkage) for name in (*recorded, *now)}
        least = _roundings(recorded, units)
        for name, one in units.items():
            old, new = recorded.get(name), now.get(name)
            same = old is not None and new is not None and abs(new - old) <= max(SAME_FIGURE * abs(old), least[one])
            place = (blank.mechanism, blank.variant, blank.regime, blank.conditions)
            found.append(KeyFigure(*place, name, old, new, changed=bool(recorded) and not same, unit=one))
    return found


def _roundings(recorded: Mapping[str, float], units: Mapping[str, str]) -> dict[str, float]:
    """By unit what is rounding of the largest figure that has it."""
    found = dict.fromkeys(units.values(), 0.0) | {"rad": SAME_FIGURE}  # a transmission angle of zero is rounding
    for name, value in recorded.items():
        found[units[name]] = max(found[units[name]], ROUNDINGS * float(np.finfo(float).eps) * abs(value))
    return found


def changes(cases: Iterable[Case], baseline: Baseline) -> list[KeyFigure]:
    """The key figures that are not as recorded."""
    return [figure for figure in compared(cases, baseline) if figure.changed]
