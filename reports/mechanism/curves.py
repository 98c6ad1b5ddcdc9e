"""The curves of every run of a mechanism, and all its errors, as the page's chart takes them: few samples, packed."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from comparisons.datasheet.instants import extreme_samples, highest_samples
from comparisons.judging.quantities import JOINT_FORCE
from reports.charts.judged import LEAST_ERROR
from reports.records.views import Regime, Trace, View, setting_rank, short_title
from reports.records.views import engines as all_engines

Array = NDArray[np.float64]

# The closed form is shown by the extremes of so many stretches, a run by the worst sample of each of these.
EXTREMES: Final = 400
STRETCHES: Final = 300
# A packed number is one of so many steps between two ends, or none.
STEPS: Final = 65534
NOT_A_NUMBER: Final = 65535
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
        "jumps": list(regime.jumps),
        "setting": view.shown_setting(regime),
        "quantities": [
            {
                "title": view.title(name),
                "short": short_title(name),
                "unit": first[name].unit,
                "curves": (regime.name, name) in view.curved,
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
    truth = pack(longest.time[chosen], longest.angle[chosen], longest.reference[chosen])
    return {"truth": truth, "runs": [_run(trace) for trace in traces]}


def _run(trace: Trace) -> dict[str, Any]:
    chosen = worst_samples(trace.error, STRETCHES)
    decades = np.log10(np.clip(trace.error[chosen], LEAST_ERROR, GREATEST_ERROR))
    return {
        "engine": trace.record.engine,
        "setting": trace.record.setting,
        "limit": trace.record.limit,
        "largest": digits(trace.record.error_max or 0.0),
        **pack(trace.time[chosen], trace.observed[chosen], decades),
    }


def pack(*columns: Array) -> dict[str, Any]:
    """Columns (n,) as 16-bit steps between the ``ends`` of each, the lower byte first, all in one text of base64."""
    ends = [_ends(column) for column in columns]
    steps = [_steps(column, *between) for column, between in zip(columns, ends, strict=True)]
    return {"ends": ends, "samples": base64.b64encode(np.concatenate(steps).tobytes()).decode("ascii")}


def _ends(values: Array) -> tuple[float, float]:
    """The least and the greatest finite number, which differ."""
    finite = values[np.isfinite(values)]
    low, high = (float(np.min(finite)), float(np.max(finite))) if len(finite) else (0.0, 0.0)
    return (low, high) if high > low else (low, low + (abs(low) or 1.0))


def _steps(values: Array, low: float, high: float) -> NDArray[np.uint16]:
    share = np.where(np.isfinite(values), (values - low) / (high - low), np.nan)
    return np.where(np.isnan(share), NOT_A_NUMBER, np.round(share * STEPS)).astype("<u2")


def worst_samples(errors: Array, stretches: int) -> NDArray[np.intp]:
    """Indices of the sample with the largest error in every stretch; samples that were not compared are left out."""
    compared = np.flatnonzero(~np.isnan(errors))
    return compared[highest_samples(errors[compared], stretches)]
