"""Key figures of the closed form: what tells that a linkage's file has changed, whatever engines do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from comparisons.datasheet.curves import MAGNITUDE, Curves
from comparisons.datasheet.instants import Instants
from comparisons.judging.baseline import SAME_FIGURE, Baseline, regime_key
from comparisons.judging.records import blank_record
from comparisons.reference.case import Case
from comparisons.reference.signals import signal


@dataclass(frozen=True)
class FigureChange:
    """A key figure that is not as recorded: SI; ``now`` or ``recorded`` is None where there is none."""

    mechanism: str
    variant: str
    regime: str
    figure: str
    recorded: float | None
    now: float | None

    @property
    def sentence(self) -> str:
        """The change in words."""
        place = f"{self.mechanism} ({self.variant}), {self.regime}: {self.figure}"
        if self.now is None:
            return f"{place} was {self.recorded:.7g} and is no figure any more"
        if self.recorded is None:
            return f"{place} is {self.now:.7g} and was not recorded"
        share = f", {self.now / self.recorded - 1.0:+.2g} of it" if self.recorded else ""
        return f"{place} was {self.recorded:.9g} and is {self.now:.9g}{share}"


def key_figures(case: Case) -> dict[str, float]:
    """Peaks of Mkr and Peq, mean Jeq, and the peak force of every joint over a case's motion, SI, by name."""
    curves = Curves(case, Instants(case.motion, turns=not case.mechanism.linkage.is_linear))
    names = [name for name in curves.names if name in ("Mkr", "Peq") or _is_joint_force(name)]
    found = {name.removesuffix(MAGNITUDE) + ".peak": abs(peak.value) for name, peak in curves.peaks(names).items()}
    if curves.has("Jeq"):
        found["Jeq.mean"] = curves.mean(lambda at: signal(at, "Jeq"))
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


def changes(cases: Iterable[Case], baseline: Baseline) -> list[FigureChange]:
    """The key figures that differ from a baseline by more than ``SAME_FIGURE`` of themselves; none it has not."""
    found = []
    for case in cases:
        blank = blank_record(case, "")
        recorded = baseline.figures(blank)
        now: Mapping[str, float] = key_figures(case) if recorded else {}
        least = float(np.finfo(float).eps) * max(map(abs, recorded.values()), default=0.0)
        for name in dict.fromkeys((*recorded, *now)):
            old, new = recorded.get(name), now.get(name)
            if old is None or new is None or abs(new - old) > SAME_FIGURE * max(abs(old), least):
                found.append(FigureChange(blank.mechanism, blank.variant, blank.regime, name, old, new))
    return found
