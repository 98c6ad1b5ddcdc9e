"""Two panels that recur: a quantity by every method, and under it the deviation of every run on a logarithmic scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from reports.drawing.curves import envelope, thinned
from reports.drawing.style import INK, LIMIT_COLOUR, REFERENCE, SETTING_LINES, colour, dashes, error_scale, label_ends
from reports.facts.views import Trace, View, engines
from reports.text.numbers import bound

Array = NDArray[np.float64]

# Nothing below round-off is worth a decade of the axis.
LEAST_ERROR = 1e-16
# An error that changes sign dips towards zero; this share of the samples may leave the axis below.
DIPS = 0.1


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

    ``others`` are errors of no engine.
    """
    names, ends, seen = engines(view.results), [], []
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
