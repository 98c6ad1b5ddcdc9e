"""The curves of every run of a mechanism, and all its errors, as the page's chart takes them: few samples, packed."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from comparisons.datasheet.curves import extreme_samples, highest_samples
from comparisons.judging.quantities import JOINT_FORCE
from reports.charts.judged import LEAST_ERROR
from reports.document.chart import Array
from reports.records.views import Regime, Trace, View, setting_rank, short_title
from reports.records.views import engines as all_engines

# The closed form is shown by the extremes of so many stretches, a run by the worst sample of each of these.
EXTREMES: Final = 400
STRETCHES: Final = 300
# Errors lie between ``LEAST_ERROR`` and this on their scale.
GREATEST_ERROR: Final = 1e8


def chart_data(view: View) -> dict[str, Any]:
    """Data of the chart when the page opens: every regime's quantities and errors, and the engines, JSON-ready.

    Of each error there are the numbers of its quantity, engine and setting, its size and its limit.
    """
    engines = list(all_engines(view.results))  # an engine has its colour by its place among all
    settings = sorted({record.setting for record in view.records}, key=setting_rank)
    regimes = [_regime(view, regime, engines, settings) for regime in view.regimes]
    axis = ["travel of the drive, m", 1.0] if view.linkage.is_linear else ["crank angle φ, °", math.degrees(1.0)]
    return {"engines": engines, "settings": settings, "axis": axis, "regimes": regimes}


def curves(view: View) -> dict[str, dict[str, Any]]:
    """The curves of each quantity under each regime that any run gave one of, by regime and quantity as in its data."""
    return {
        f"{number}-{place}": _curves(traces)
        for number, regime in enumerate(view.regimes)
        for place, name in enumerate(view.quantities(regime))
        if (traces := view.traces(regime, name))
    }


def _regime(view: View, regime: Regime, engines: Sequence[str], settings: Sequence[str]) -> dict[str, Any]:
    records = view.of(regime)
    names = view.quantities(regime)
    first = {record.quantity: record for record in reversed(records)}
    return {
        "name": regime.name,
        "conditions": regime.conditions,
        "jumps": list(regime.motion.jumps) if regime.motion else [],
        "setting": view.shown_setting(regime),
        "quantities": [
            {
                "title": view.title(name),
                "short": short_title(name),
                "unit": first[name].unit,
                "curves": bool(view.curved(regime, name)),
                "vector": name.startswith(JOINT_FORCE),
            }
            for name in names
        ],
        "errors": [
            [names.index(r.quantity), engines.index(r.engine), settings.index(r.setting), digits(r.error_max), r.limit]
            for r in records
            if r.error_max is not None and r.limit
        ],
    }


def digits(value: float) -> float:
    """An error to two digits, as it is printed."""
    return float(f"{max(value, LEAST_ERROR):.1e}")


def _curves(traces: Sequence[Trace]) -> dict[str, Any]:
    """JSON for the page's chart of one quantity: the closed form and the runs.

    The closed form has time (s), crank angle (rad) and value, a run its time, value and decade of the error.
    """
    longest = max(traces, key=lambda trace: len(trace.time))
    chosen = extreme_samples(longest.reference, EXTREMES)
    truth = packed(longest.time[chosen], longest.angle[chosen], longest.reference[chosen])
    return {"truth": truth, "runs": [_run(trace) for trace in traces]}


def _run(trace: Trace) -> dict[str, Any]:
    compared = np.flatnonzero(~np.isnan(trace.error))
    chosen = compared[highest_samples(trace.error[compared], STRETCHES)]
    decades = np.log10(np.clip(trace.error[chosen], LEAST_ERROR, GREATEST_ERROR))
    return {
        "engine": trace.record.engine,
        "setting": trace.record.setting,
        "limit": trace.record.limit,
        "largest": digits(trace.record.error_max or 0.0),
        "samples": packed(trace.time[chosen], trace.observed[chosen], decades),
    }


def packed(*columns: Array) -> str:
    """Three columns (n,) after each other as numbers of 32 bits, the lower byte first, in base64."""
    with np.errstate(over="ignore"):  # what is too large becomes infinite, and is not drawn
        return base64.b64encode(np.concatenate(columns).astype("<f4").tobytes()).decode("ascii")
