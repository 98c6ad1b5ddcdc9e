"""Two panels that recur, a quantity by every method and every run's error beneath, and long curves made short."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from reports.charts.style import INK, LIMIT_COLOUR, REFERENCE, SETTING_LINES, colour, dashes, error_scale, label_ends
from reports.document.numbers import bound
from reports.records.views import Trace, View, engines

Array = NDArray[np.float64]

# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR = 1e-16
# An error that changes sign dips towards zero; this share of the samples may leave the axis below.
DIPS = 0.1
MOST_NAMES = 9  # that stand one above the other beside a panel
# A long curve is drawn by the extremes of so many stretches, so that no peak is hidden.
BUCKETS = 400
FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True)
class Other:
    """Error of something that is no engine: its name and colour, time, s, and |error| over the reference's peak."""

    label: str
    ink: str
    time: Array
    error: Array


def draw_methods(
    axes: Axes, view: View, truth: tuple[Array, Array], traces: Sequence[Trace], factor: float = 1.0
) -> None:
    """The closed form as a broad grey line, each engine at the view's setting as a thin dashed one on top."""
    names = engines(view.results)
    axes.plot(*thinned(truth[0], factor * truth[1]), color=REFERENCE, linewidth=3.4, solid_capstyle="round",
              label="closed form", zorder=2.0)  # fmt: skip
    for trace in traces:
        if trace.record.setting == view.setting:
            time, observed = thinned(trace.time, factor * trace.observed)
            name = trace.record.engine
            axes.plot(time, observed, color=colour(name, names), linestyle=dashes(name, names), linewidth=1.2,
                      label=name, zorder=3.0)  # fmt: skip
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.04), handlelength=1.9, handletextpad=0.5, borderaxespad=0.3,
                labelspacing=0.35)  # fmt: skip


def draw_errors_beneath(axes: Axes, view: View, traces: Sequence[Trace], others: Sequence[Other] = ()) -> None:
    """The upper envelope of |error| over peak of every run, with the limit the view's setting is held to.

    Of more runs than have room for their names, those at the view's setting. ``others`` are errors of no engine.
    """
    names, ends, seen = engines(view.results), [], []
    if len(traces) > MOST_NAMES:
        traces = [trace for trace in traces if trace.record.setting == view.setting]
    for trace in traces:
        time, error = envelope(trace.time, np.maximum(trace.error, LEAST_ERROR))
        ink = colour(trace.record.engine, names)
        axes.plot(time, error, color=ink, linestyle=SETTING_LINES.get(trace.record.setting, "-"), linewidth=1.0)
        seen += [float(np.quantile(error, DIPS)), float(np.max(error))]
        ends.append((float(np.median(error[-len(error) // 5 :])), trace.label, ink))
    for other in others:
        time, error = envelope(other.time, np.maximum(other.error, LEAST_ERROR))
        axes.plot(time, error, color=other.ink, linewidth=0.8)
        seen += [float(np.quantile(error, DIPS)), float(np.max(error))]
        ends.append((float(error[-1]), other.label, other.ink))
    limits = sorted({t.record.limit for t in traces if t.record.setting == view.setting and t.record.limit})
    for limit in limits:
        axes.axhline(limit, color=LIMIT_COLOUR, linewidth=0.9, linestyle=(0, (6, 2)))
        ends.append((limit, f"limit {bound(limit)}", LIMIT_COLOUR))
    seen += limits
    if seen:
        error_scale(axes, min(seen), max(seen))
        label_ends(axes, ends, size=7.0)
    else:
        axes.text(0.5, 0.5, "no run gave a curve", transform=axes.transAxes, ha="center", va="center", color=INK)
        axes.set_yticks([])
    axes.set_ylabel("|error| / peak")


def thinned(time: Array, values: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Lowest and highest sample of every bucket, in their order, and both ends; short curves come back whole."""
    if len(time) <= 2 * buckets:
        return time, values
    kept = [np.array([0, len(time) - 1]), _highest(values, buckets), _highest(-values, buckets)]
    chosen = np.unique(np.concatenate(kept))
    return time[chosen], values[chosen]


def envelope(time: Array, values: Array, buckets: int = BUCKETS // 2) -> tuple[Array, Array]:
    """The largest value of every bucket, at its own instant; NaN samples are ignored, zeros left out."""
    seen = np.flatnonzero(~np.isnan(values) & (values > 0.0))
    time, values = time[seen], values[seen]
    chosen = _highest(values, buckets)
    return time[chosen], values[chosen]


def _highest(values: Array, buckets: int) -> NDArray[np.intp]:
    """Index of the highest sample of every bucket; the last bucket may be shorter."""
    size = -(-len(values) // buckets) or 1
    whole = len(values) // size
    found = np.argmax(values[: whole * size].reshape(whole, size), axis=1) + size * np.arange(whole)
    rest = values[whole * size :]
    last = [whole * size + int(np.argmax(rest))] if len(rest) else []
    return np.array([*found, *last], dtype=np.intp)


def last_turn(angle: Array) -> NDArray[np.intp]:
    """Indices of the last full turn of a crank angle, rad, in order of the angle within it; all if it made none."""
    inside = np.flatnonzero(np.abs(angle - angle[-1]) < FULL_TURN)
    return inside[np.argsort(angle[inside] % FULL_TURN, kind="stable")]


def over_last_turn(trace: Trace) -> Trace:
    """A trace over the last turn of its crank, its time replaced by the crank angle in degrees."""
    order = last_turn(trace.angle)
    return replace(
        trace,
        time=np.degrees(trace.angle[order]) % 360.0,
        observed=trace.observed[order],
        reference=trace.reference[order],
        error=trace.error[order],
    )
