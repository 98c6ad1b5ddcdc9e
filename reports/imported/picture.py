"""A judgement as curves to draw: those over the limit, the worst first, or all where none is."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from comparisons.datasheet.thinning import extremes
from comparisons.imported.judge import ImportedJudgement
from comparisons.imported.judging.judgement import SignalVerdict
from comparisons.judging.records import Verdict
from reports.charts import draw
from reports.charts.judged import MOST, JudgedCurve, judged_chart
from reports.imported.terminal import sentence, share

STRETCHES: Final = 300  # of a curve, of which the extremes are drawn
MOST_ON_PAGE: Final = 6


def judged_curves(judgement: ImportedJudgement, most: int = MOST_ON_PAGE) -> list[JudgedCurve]:
    """The signals to be drawn."""
    over = [verdict for verdict in judgement.verdicts if verdict.outcome is not Verdict.PASSED] or judgement.verdicts
    return [_curve(judgement, verdict) for verdict in sorted(over, key=lambda verdict: -verdict.error_max)[:most]]


def _curve(judgement: ImportedJudgement, verdict: SignalVerdict) -> JudgedCurve:
    unit, value = verdict.shown
    cause, without = judgement.without_cause(verdict)
    curves = {"file": verdict.samples.values, "truth": verdict.truth, "without": without}
    differences = [curve - verdict.truth for curve in curves.values() if curve is not None]
    shown = (verdict.truth, *(np.nan_to_num(difference) for difference in differences))
    few = np.unique(np.concatenate([*(extremes(values, STRETCHES) for values in shown), [verdict.worst]]))
    drawn: dict[str, Any] = {
        key: None if y is None else [None if np.isnan(v) else v for v in (y[few] / value).tolist()]
        for key, y in curves.items()
    }
    time, error = verdict.samples.time[few].tolist(), f"{share(verdict.error_max)} of the peak at most"
    return JudgedCurve(verdict.name, unit, time, worst=verdict.worst_time, error=error, cause=cause, **drawn)


def svg(judgement: ImportedJudgement, title: str) -> str:
    """The worst curves as an SVG file on white; ``title`` names linkage and files."""
    curves = judged_curves(judgement, MOST)
    causes = dict.fromkeys(f"Likely cause: {curve.cause}." for curve in curves if curve.cause)
    return draw.svg(draw.figure(judged_chart(curves, (title, sentence(judgement), *causes))), page="white")
