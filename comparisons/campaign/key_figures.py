"""Key figures of the closed form: what tells that a linkage's file has changed, whatever engines do."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.signals import MAGNITUDE, signal
from analytic.written import change
from comparisons.datasheet.curves import Curves
from comparisons.datasheet.instants import Instants
from comparisons.judging.baseline import SAME_FIGURE, Baseline, regime_key
from comparisons.judging.records import blank_record
from comparisons.reference.case import Case

ROUNDINGS: Final = 16  # of the largest figure: what is less is not told from none


@dataclass(frozen=True)
class KeyFigure:
    """A key figure, SI, as ``recorded`` and as it is ``now``; None where there is none.

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

    @property
    def sentence(self) -> str:
        """What is recorded and what is now, in words."""
        place = f"{self.mechanism} ({self.variant}), {self.regime}: {self.figure}"
        if self.now is None:
            return f"{place} was {self.recorded:.9g} and is no figure any more"
        if self.recorded is None:
            return f"{place} is {self.now:.9g} and was not recorded"
        share = f", {change(self.share, '.2g')}" if self.share is not None else ""
        return f"{place} was {self.recorded:.9g} and is {self.now:.9g}{share}"

    @property
    def share(self) -> float | None:
        """By what share of the recorded it has changed; None where that is nothing."""
        return self.now / self.recorded - 1.0 if self.recorded and self.now is not None else None


def key_figures(case: Case) -> dict[str, float]:
    """Peaks of Mkr and Peq, mean Jeq, and the peak force of every joint over a case's motion, SI, by name."""
    curves = Curves(case, Instants(case.motion, turns=not case.mechanism.linkage.is_linear))
    names = [name for name in curves.names if name in ("Mkr", "Peq") or _is_joint_force(name)]
    found = {name.removesuffix(MAGNITUDE) + ".peak": abs(peak.value) for name, peak in curves.peaks(names).items()}
    if curves.has("Jeq"):
        (found["Jeq.mean"],) = curves.means(lambda at: signal(at, "Jeq"))
    return {name: value for name, value in found.items() if math.isfinite(value)}


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
        least = ROUNDINGS * float(np.finfo(float).eps) * max(map(abs, recorded.values()), default=0.0)
        for name in dict.fromkeys((*recorded, *now)):
            old, new = recorded.get(name), now.get(name)
            same = old is not None and new is not None and abs(new - old) <= max(SAME_FIGURE * abs(old), least)
            place = (blank.mechanism, blank.variant, blank.regime, blank.conditions)
            found.append(KeyFigure(*place, name, old, new, changed=bool(recorded) and not same))
    return found


def changes(cases: Iterable[Case], baseline: Baseline) -> list[KeyFigure]:
    """The key figures that are not as recorded."""
    return [figure for figure in compared(cases, baseline) if figure.changed]
