"""The output over a turn: S, v and a at the final speed, and its unit functions against harmonics."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator
from numpy.typing import NDArray

from analytic.description.crank_motion import crank_motion
from analytic.turn.unit_functions import UnitFunctions, unit_functions
from comparisons.judging.quantities import QUANTITIES
from comparisons.reference.case import Case
from reports.charts.style import INK, MUTED, PALETTE, label_ends, label_values, over_turn, panels
from reports.document.numbers import figure as digits
from reports.records.views import View

Array = NDArray[np.float64]

# Extremes are marked from the fine grid; a drawing needs one point per degree.
POINTS, THINNING = 3601, 10
# S, v, a: what the panel says on its axis, and the factor from SI to that unit.
PANELS = (("S", "S, mm", 1e3), ("v", "v, m/s", 1.0), ("a", "a, m/s²", 1.0))
COLOURS = (PALETTE[0], PALETTE[1], PALETTE[2])


def turn_at_final_speed(view: View) -> tuple[Array, dict[str, Array]]:
    """Crank angle over one turn, degrees, and S, v, a in SI at the final speed of the first regime."""
    speed = abs(view.final_speed)
    turn = 2.0 * math.pi / speed
    motion = crank_motion(
        "constant-speed", speed=speed, ramp_time=turn, hold_time=0.0, clockwise=view.final_speed < 0.0
    )
    time = np.linspace(0.0, turn, POINTS)
    case = Case(view.mechanism, motion)
    values = {name: QUANTITIES[name].reference(case, time) for name, _, _ in PANELS}
    angle = np.degrees(motion.angle(time)) % 360.0
    angle[-1] = 0.0 if speed != view.final_speed else 360.0
    angle[0] = 360.0 - angle[-1]
    order = np.argsort(angle)
    return angle[order], {name: found[order] for name, found in values.items()}


def output_figure(view: View) -> Figure:
    """S, v and a, one under the other."""
    return panels("output", draw_output, view=view)


def draw_output(*axes_of: Axes, view: View) -> None:
    """S, v and a on three axes, their extremes marked with value and crank angle."""
    angle, values = turn_at_final_speed(view)
    for axes, (name, label, factor), ink in zip(axes_of, PANELS, COLOURS, strict=True):
        shown = factor * values[name]
        axes.axhline(0.0, color=MUTED, linewidth=0.6)
        axes.plot(angle[::THINNING], shown[::THINNING], color=ink, linewidth=1.5)
        label_values(axes, label)
        axes.margins(y=0.22)
        _mark_extremes(axes, angle, shown, ink)
        over_turn(axes, "crank angle φ, °" if name == "a" else "")


def _mark_extremes(axes: Axes, angle: Array, values: Array, ink: str) -> None:
    scale = float(np.max(np.abs(values)))
    for place, below in ((int(np.argmax(values)), False), (int(np.argmin(values)), True)):
        x, y = float(angle[place]), float(values[place])
        axes.plot([x], [y], marker="o", markersize=3.2, color=ink)
        side = "left" if x < 45.0 else "right" if x > 315.0 else "center"
        axes.annotate(
            f"{digits(y) if abs(y) > 1e-5 * scale else '0'} at {x:.0f}°".replace("-", "−"),
            (x, y),
            xytext=(0, -4 if below else 4),
            textcoords="offset points",
            ha=side,
            va="top" if below else "bottom",
            fontsize=7.5,
            color=INK,
        )


def unit_figure(view: View) -> Figure:
    """The unit functions beside the harmonics they are held against."""
    found = unit_functions(view.mechanism, clockwise=view.final_speed < 0.0)
    return panels("units", draw_units, found=found)


def draw_units(*axes_of: Axes, found: UnitFunctions) -> None:
    """Unit functions in colour, harmonics dashed."""
    phase = np.degrees(found.phase)
    ours = (found.displacement, found.velocity, found.acceleration)
    words = ("S / stroke", "v / max |v|", "a / max |a|"), ("½(1 − cos)", "sin", "cos")
    step = max(1, THINNING * len(phase) // POINTS)
    for number, axes in enumerate(axes_of):
        harmonic, ink = found.harmonics[number], COLOURS[number]
        axes.plot(phase[::step], harmonic[::step], color=MUTED, linewidth=1.0, linestyle=(0, (4, 2)))
        axes.plot(phase[::step], ours[number][::step], color=ink, linewidth=1.5)
        axes.set_ylabel(words[0][number])
        axes.set_ylim(-0.08 if number == 0 else -1.15, 1.08 if number == 0 else 1.15)
        axes.yaxis.set_major_locator(
            FixedLocator([0.0, 0.25, 0.5, 0.75, 1.0] if number == 0 else [-1.0, -0.5, 0.0, 0.5, 1.0])
        )
        over_turn(axes, "crank angle from top dead centre, °" if number == len(axes_of) - 1 else "")
        place = 0.62 if number == 0 else 0.25
        label_ends(axes, [(place, "mechanism", ink), (place - 0.2, words[1][number], MUTED)])


def difference_figure(view: View) -> Figure:
    """Unit functions less harmonics, with the mean absolute difference of each."""
    found = unit_functions(view.mechanism, clockwise=view.final_speed < 0.0)
    return panels("differences", draw_differences, found=found)


def draw_differences(axes: Axes, found: UnitFunctions) -> None:
    """ΔS, Δv and Δa on one axis."""
    phase, ends = np.degrees(found.phase), []
    step = max(1, THINNING * len(phase) // POINTS)
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    styles = ("-", (0, (5, 2)), (0, (1.5, 1.5)))
    for name, values, mean, ink, dash in zip(
        ("ΔS", "Δv", "Δa"), found.differences, found.deviations, COLOURS, styles, strict=True
    ):
        axes.plot(phase[::step], values[::step], color=ink, linewidth=1.5, linestyle=dash)
        ends.append((float(values[-1]), f"{name}, mean |{name}|\n{100.0 * mean:.2f} %", ink))
    axes.set_ylabel("unit function − harmonic")
    over_turn(axes, "crank angle from top dead centre, °")
    label_ends(axes, ends, lines=2)
