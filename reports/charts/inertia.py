"""The reduced moment of inertia: of all methods over the crank angle, and link by link."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.dynamics.reduced import group_inertia, link_inertia, reduced_inertia
from reports.charts.panels import draw_errors_beneath, draw_methods, over_last_turn
from reports.charts.style import DASHES, INK, PALETTE, label_ends, label_values, over_turn, panels, power_of_ten
from reports.records.views import View

Array = NDArray[np.float64]

POINTS = 361
CONSTANT = 1e-9
SHADES = ("#31506f", "#7ea0be", "#c9d8e6", "#d9a441", "#f1d9a7", "#8aa37b", "#cfdcc6", "#a5698a", "#e0c3d3")


def turn_inertia(view: View) -> tuple[Array, Array]:
    """Crank angle over one turn, degrees, and the closed form's Jeq, kg m²."""
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS)
    return np.degrees(angle), reduced_inertia(view.mechanism.sweep(angle))


def power_for(largest: float) -> tuple[float, str]:
    """Factor and power of ten for an axis of small values: 1e5 and "10⁻⁵ " for 9.1e-5 kg m²."""
    exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    return 10.0**-exponent, f"{power_of_ten(10.0**exponent)} " if exponent else ""


def methods_figure(view: View) -> Figure:
    """Jeq by every method over the last full turn of the first regime, its deviation beneath."""
    return panels("methods", draw_inertia, view=view)


def draw_inertia(upper: Axes, lower: Axes, view: View) -> None:
    """Values above, |error| over peak below, both over the crank angle."""
    traces = [over_last_turn(trace) for trace in view.traces(view.regimes[0], "Jeq")]
    angle, truth = turn_inertia(view)
    factor, prefix = power_for(float(np.max(truth)))
    draw_methods(upper, view, (angle, truth), traces, factor)
    label_values(upper, f"Jeq, {prefix}kg m²")
    draw_errors_beneath(lower, view, traces)
    over_turn(upper, "")
    over_turn(lower)


def groups_figure(view: View) -> Figure:
    """Jeq by Assur group, stacked to the whole."""
    return panels("groups", draw_groups, view=view)


def links_figure(view: View) -> Figure:
    """Jeq of the links whose share varies."""
    return panels("links", draw_links, view=view)


def draw_groups(axes: Axes, view: View) -> None:
    """Jeq of the crank and the groups over the crank angle, one on the other, each named at its right end."""
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS)
    parts = group_inertia(view.mechanism.sweep(angle))
    total = np.sum(list(parts.values()), axis=0)
    factor, prefix = power_for(float(np.max(total)))
    edges = factor * np.cumsum([np.zeros_like(angle), *parts.values()], axis=0)
    degrees, ends = np.degrees(angle), []
    for number, name in enumerate(parts):
        shade = SHADES[number % len(SHADES)]
        axes.fill_between(degrees, edges[number], edges[number + 1], color=shade, linewidth=0.0, zorder=2.0)
        axes.plot(degrees, edges[number + 1], color="white", linewidth=0.6, zorder=2.1)
        ends.append((0.5 * float(edges[number, -1] + edges[number + 1, -1]), _share(name, parts[name], total), INK))
    axes.plot(degrees, factor * total, color=INK, linewidth=1.2, zorder=3.0)
    axes.set_ylim(0.0, 1.06 * factor * float(np.max(total)) or 1.0)
    label_values(axes, f"Jeq, {prefix}kg m²")
    over_turn(axes)
    label_ends(axes, ends, lines=2)


def draw_links(axes: Axes, view: View) -> None:
    """Jeq of each link that varies over the crank angle; a constant one would only flatten the others."""
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS)
    parts = links_inertia(view, angle)
    total = np.sum(list(parts.values()), axis=0)
    varying = {name: values for name, values in parts.items() if varies(values)}
    factor, prefix = power_for(max((float(np.max(values)) for values in varying.values()), default=0.0))
    degrees, ends = np.degrees(angle), []
    for number, (name, values) in enumerate(varying.items()):
        ink, dash = PALETTE[number % len(PALETTE)], ("-", *DASHES)[number % (len(DASHES) + 1)]
        axes.plot(degrees, factor * values, color=ink, linestyle=dash, linewidth=1.4)
        ends.append((factor * float(values[-1]), _share(name, values, total), ink))
    axes.set_ylim(bottom=0.0)
    label_values(axes, f"Jeq of a link, {prefix}kg m²")
    over_turn(axes)
    label_ends(axes, ends, lines=2)


def links_inertia(view: View, angle: Array) -> dict[str, Array]:
    """Jeq of every link, kg m², at these crank angles, rad; the crank first, then as the groups follow."""
    sweep = view.mechanism.sweep(angle)
    crank = [view.linkage.crank] if view.linkage.crank else []
    order = [*crank, *(name for group in view.mechanism.structure.groups for name in group.links)]
    return {name: link_inertia(sweep, name) for name in order if name in view.linkage.links}


def varies(values: Array) -> bool:
    """Whether a link's Jeq is more than a constant."""
    return float(np.ptp(values)) > CONSTANT * float(np.max(np.abs(values)))


def _share(name: str, values: Array, total: Array) -> str:
    return f"{name.replace('_', ' ')}\n{100.0 * float(np.mean(values)) / (float(np.mean(total)) or 1.0):.1f} % of mean"
