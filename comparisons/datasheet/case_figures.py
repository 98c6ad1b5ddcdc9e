"""Figures of a case by name, SI: of signals over its motion, and of the mechanism alone.

A signal's figure has the name of ``analytic.designs.figure_names``, and its means are over the time. Of a mechanism, in
any motion, there are

``Jeq.pulsation``       half the range of Jeq over a turn, over its mean
``equilibrium``         crank angle, rad, of the undriven linkage's stable rest with the least potential energy
``top_dead_centre``     crank angle, rad, at which the output is highest along its direction
``time_ratio``          crank angle of the output's slower stroke over that of its faster one
``range.low .high``     ends, rad, of the range of a crank that cannot turn fully
``S.harmonic_deviation``  mean distance of the unit function from a harmonic, likewise v and a
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.designs.figure_names import STROKE, figures_named
from analytic.designs.figures import Figure, SignalExtreme
from analytic.dynamics import reduced
from analytic.dynamics.equilibrium import equilibria
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.extremes import extremes
from analytic.signals import unit
from analytic.turn.unit_functions import bottom_dead_centre, top_dead_centre, unit_functions
from comparisons.datasheet.curves import Curves, Measure

Array = NDArray[np.float64]
MechanismFigure = Callable[[Mechanism], float]


def _resting_angle(mechanism: Mechanism) -> float:
    stable = [rest.angle for rest in equilibria(mechanism) if rest.stable]
    if not stable:
        raise LinkproofError(f"'{mechanism.linkage.name}' has no stable equilibrium: its loads balance at no angle")
    return min(stable, key=lambda angle: float(reduced.potential_energy(mechanism.sweep(angle)))) % FULL_TURN


def _time_ratio(mechanism: Mechanism) -> float:
    stroke = (bottom_dead_centre(mechanism).angle - top_dead_centre(mechanism).angle) % FULL_TURN
    strokes = sorted((stroke, FULL_TURN - stroke))
    return strokes[1] / strokes[0]


def _limit(mechanism: Mechanism, end: int) -> float:
    reach = mechanism.crank_range()
    if reach.is_full_turn:
        raise LinkproofError(f"'{mechanism.linkage.name}': its crank turns fully, so its range has no limits")
    return reach.limits[end]


def _pulsation(mechanism: Mechanism) -> float:
    return extremes(lambda phi: reduced.reduced_inertia(mechanism.sweep(phi))).relative_pulsation


# Each with its SI unit.
OF_A_MECHANISM: Final[Mapping[str, tuple[str, MechanismFigure]]] = {
    "Jeq.pulsation": ("", _pulsation),
    "equilibrium": ("rad", _resting_angle),
    "top_dead_centre": ("rad", lambda mechanism: top_dead_centre(mechanism).angle),
    "time_ratio": ("", _time_ratio),
    "range.low": ("rad", lambda mechanism: _limit(mechanism, 0)),
    "range.high": ("rad", lambda mechanism: _limit(mechanism, 1)),
    "S.harmonic_deviation": ("", lambda mechanism: unit_functions(mechanism).deviations[0]),
    "v.harmonic_deviation": ("", lambda mechanism: unit_functions(mechanism).deviations[1]),
    "a.harmonic_deviation": ("", lambda mechanism: unit_functions(mechanism).deviations[2]),
}


def named(mechanism: Mechanism, name: str) -> Mapping[str, Figure | MechanismFigure]:
    """The figures that a name stands for, by the name of each; raises LinkproofError for an unknown figure."""
    return {name: OF_A_MECHANISM[name][1]} if name in OF_A_MECHANISM else figures_named(mechanism, name, in_time=True)


def figure_unit(name: str, linkage: Linkage) -> str:
    """SI unit of a figure of the linkage."""
    if name in OF_A_MECHANISM:
        return OF_A_MECHANISM[name][0]
    return unit("S" if name == STROKE else name.rpartition("@")[0] or name.rpartition(".")[0], linkage)


def case_figures(curves: Curves, figures: Mapping[str, Figure | MechanismFigure]) -> dict[str, float]:
    """Values of the figures of ``named`` over the motion, SI.

    Raises LinkproofError for a place that the motion does not pass, and for what the mechanism lacks.
    """
    of_signals = {name: entry for name, entry in figures.items() if isinstance(entry, Figure)}
    values = {name: entry(curves.case.mechanism) for name, entry in figures.items() if not isinstance(entry, Figure)}

    def height(end: SignalExtreme) -> Measure:
        return lambda at: end.height(curves.of(at, end.signal))

    places = curves.places({end: height(end) for quantity in of_signals.values() for end in quantity.extremes})
    at_places = curves.at(np.array([*places.values()]))
    ends = {end: curves.of(at_places, end.signal)[row] for row, end in enumerate(places)}
    means = {
        quantity: lambda at, entry=quantity: entry.integrand(curves.of(at, entry.signal))
        for quantity in of_signals.values()
        if quantity.is_mean
    }
    averages = dict(zip(means, curves.means(*means.values()) if means else (), strict=True))
    for name, figure in of_signals.items():
        if figure.extremes:
            values[name] = float(figure.of([ends[end] for end in figure.extremes]))
        elif figure.is_mean:
            values[name] = float(figure.of_mean(np.array(averages[figure])))
        else:
            values[name] = float(curves.of(curves.at(_instant(curves, figure)), figure.signal)[0])
    return values


def _instant(curves: Curves, figure: Figure) -> Array:
    """The instant (1,), s, of a figure at a place or a time; raises LinkproofError where the motion has none."""
    if math.isnan(figure.time):
        return curves.instants.at_angles(np.array([figure.angle]), "", 1.0)
    return curves.instants.at_times(np.array([figure.time]))
