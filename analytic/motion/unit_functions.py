"""Unit functions of the output against harmonics (article 003, section "unit functions", Fig. 4).

S is the output's displacement from its top dead centre, positive away from it; the phase runs from the crank angle of
that centre in the direction of rotation. The unit functions S/stroke, v/max|v| and a/max|a| depend on the geometry
alone and are compared with 0.5 (1 - cos), sin and cos of the phase.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.dyads.closure import ROUNDING
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.refine import Array, grid, highest, largest, periodic_mean, zeros

# The mean of a modulus has kinks, where the trapezoid rule errs by h²: 7200 points leave eight digits.
POINTS = 7200


@dataclass(frozen=True)
class DeadCentre:
    """A reversal of the output: the crank angle, rad in [0, 2π), and the coordinate along the output's direction, m."""

    angle: float
    coordinate: float


@dataclass(frozen=True)
class UnitFunctions:
    """Dimensionless displacement, velocity and acceleration over the ``phase`` from top dead centre, rad; all (n,)."""

    phase: Array
    displacement: Array
    velocity: Array
    acceleration: Array

    @property
    def harmonics(self) -> tuple[Array, Array, Array]:
        """The unit functions of a harmonic drive: 0.5 (1 - cos), sin and cos of the phase."""
        return 0.5 * (1.0 - np.cos(self.phase)), np.sin(self.phase), np.cos(self.phase)

    @property
    def differences(self) -> tuple[Array, Array, Array]:
        """ΔS, Δv, Δa: unit function less harmonic."""
        s, v, a = self.harmonics
        return self.displacement - s, self.velocity - v, self.acceleration - a

    @property
    def deviations(self) -> tuple[float, float, float]:
        """Mean absolute differences over the turn, as ratios; article 003 prints them in per cent."""
        s, v, a = (periodic_mean(np.abs(difference)) for difference in self.differences)
        return s, v, a


@lru_cache(maxsize=64)
def dead_centres(mechanism: Mechanism) -> tuple[DeadCentre, ...]:
    """Every reversal of the output over one turn, by crank angle; roots of its first derivative, not grid points."""
    angles = zeros(lambda phi: mechanism.sweep(phi).output(1), turns=round(mechanism.period / FULL_TURN))
    if not len(angles):
        raise _still_output(mechanism)
    coordinates = mechanism.sweep(angles).output()
    if np.ptp(coordinates) <= ROUNDING * mechanism.linkage.extent():
        raise _still_output(mechanism)
    return tuple(DeadCentre(float(a), float(c)) for a, c in zip(angles, coordinates, strict=True))


def _still_output(mechanism: Mechanism) -> LinkproofError:
    """The error for an output that does not move along its direction."""
    output = mechanism.linkage.output
    assert output is not None
    return LinkproofError(
        f"output of '{mechanism.linkage.name}': expected a point that moves along its direction, got '{output.point}', "
        "which stands still along it; choose another point or direction"
    )


def top_dead_centre(mechanism: Mechanism) -> DeadCentre:
    """The reversal with the largest coordinate along the output's direction: S = 0 there."""
    return max(dead_centres(mechanism), key=lambda centre: centre.coordinate)


def bottom_dead_centre(mechanism: Mechanism) -> DeadCentre:
    """The reversal with the smallest coordinate along the output's direction: S is the stroke there."""
    return min(dead_centres(mechanism), key=lambda centre: centre.coordinate)


def stroke(mechanism: Mechanism) -> float:
    """Distance between the outermost dead centres, m."""
    return top_dead_centre(mechanism).coordinate - bottom_dead_centre(mechanism).coordinate


def unit_functions(mechanism: Mechanism, points: int = POINTS, *, clockwise: bool = False) -> UnitFunctions:
    """The output's unit functions over one turn from top dead centre, at ``points`` equal steps of the phase."""
    top, direction = top_dead_centre(mechanism), -1.0 if clockwise else 1.0
    phase = grid(points)
    sweep = mechanism.sweep(top.angle + direction * phase)
    return UnitFunctions(
        phase=phase,
        displacement=(top.coordinate - sweep.output()) / stroke(mechanism),
        velocity=-direction * sweep.output(1) / largest(lambda phi: mechanism.sweep(phi).output(1)),
        acceleration=-sweep.output(2) / largest(lambda phi: mechanism.sweep(phi).output(2)),
    )


# The zero of S: the top dead centre, or the farthest position of a crank that cannot turn fully.

RANGE_POINTS = 721  # of a range of angles, at which its highest place is looked for


@lru_cache(maxsize=64)
def top_of_turn(mechanism: Mechanism) -> float | None:
    """The output's coordinate at the top dead centre, m; None where the crank cannot turn fully to show it."""
    if mechanism.linkage.is_linear:
        return None
    try:
        mechanism.check_full_turn()
        return top_dead_centre(mechanism).coordinate
    except AssemblyError:
        return None


def farthest_between(mechanism: Mechanism, angle: Array) -> float:
    """The output's coordinate at which S is 0, m, where the crank moves between the least and the largest angle, rad.

    It is that of the top dead centre where the crank can turn fully, else the highest between them. Raises
    LinkproofError where the output of a full turn stands still along its direction.
    """
    top = top_of_turn(mechanism)
    if top is not None:
        return top
    places = np.linspace(np.min(angle), np.max(angle), RANGE_POINTS)
    return float(
        highest(lambda phi: mechanism.sweep(phi).output()[None], places, mechanism.sweep(places).output()[None])[0][0]
    )
