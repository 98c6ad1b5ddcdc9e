"""Dead centres of the output, its stroke, and the zero of S: its displacement from the top dead centre."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.dyads import ROUNDING
from analytic.kinematics.mechanism import Mechanism, once_per_mechanism
from analytic.numerics.arrays import Array
from analytic.numerics.refine import highest


@dataclass(frozen=True)
class DeadCentre:
    """A reversal of the output: the crank angle, rad in [0, 2π), and the coordinate along the output's direction, m."""

    angle: float
    coordinate: float


@once_per_mechanism
def dead_centres(mechanism: Mechanism) -> tuple[DeadCentre, ...]:
    """Every reversal of the output over one turn, by ascending crank angle; kept for each mechanism.

    Raises LinkproofError without an output or where it stands still, AssemblyError where the linkage cannot be
    assembled or moved over a turn.
    """
    angles = mechanism.output_reversals
    if not len(angles):
        raise _still_output(mechanism)
    coordinates = mechanism.sweep(angles).output()
    if np.ptp(coordinates) <= ROUNDING * mechanism.linkage.extent():
        raise _still_output(mechanism)
    return tuple(DeadCentre(float(a), float(c)) for a, c in zip(angles, coordinates, strict=True))


def _still_output(mechanism: Mechanism) -> LinkproofError:
    """The LinkproofError, not raised, for an output that does not move along its direction."""
    output = mechanism.linkage.output
    assert output is not None
    return LinkproofError(
        f"output of '{mechanism.linkage.name}': expected a point that moves along its direction, got '{output.point}', "
        "which stands still along it; choose another point or direction"
    )


def top_dead_centre(mechanism: Mechanism) -> DeadCentre:
    """The reversal with the largest coordinate along the output's direction: S = 0 there.

    Raises as ``dead_centres`` does.
    """
    return max(dead_centres(mechanism), key=lambda centre: centre.coordinate)


def bottom_dead_centre(mechanism: Mechanism) -> DeadCentre:
    """The reversal with the smallest coordinate along the output's direction: S is the stroke there.

    Raises as ``dead_centres`` does.
    """
    return min(dead_centres(mechanism), key=lambda centre: centre.coordinate)


def stroke(mechanism: Mechanism) -> float:
    """Distance between the outermost dead centres, m; raises as ``dead_centres`` does."""
    return top_dead_centre(mechanism).coordinate - bottom_dead_centre(mechanism).coordinate


# The zero of S: the top dead centre, or the farthest position of a crank that cannot turn fully.

RANGE_POINTS = 721  # of a range of angles, at which its highest place is looked for


@once_per_mechanism
def top_of_turn(mechanism: Mechanism) -> float | None:
    """The output's coordinate at the top dead centre, m; None where the crank cannot turn fully to show it.

    A linear driver never does. It is kept for each mechanism. Raises LinkproofError without an output or where it
    stands still over a full turn.
    """
    if mechanism.linkage.is_linear:
        return None
    try:
        mechanism.check_full_turn()
        return top_dead_centre(mechanism).coordinate
    except AssemblyError:
        return None


def farthest_between(mechanism: Mechanism, angle: Array) -> float:
    """The output's coordinate at which S is 0, m, where the crank moves between the least and the largest angle, rad.

    It is that of the top dead centre where the crank can turn fully, else the highest between them; 0 without an angle.
    The angles, of any shape, are travels, m, of a linear driver. Raises LinkproofError without an output and where that
    of a full turn stands still along its direction, AssemblyError where the linkage cannot be assembled between them.
    """
    top = top_of_turn(mechanism)
    if top is not None:
        return top
    if not angle.size:
        return 0.0  # there is no S to count
    places = np.linspace(np.min(angle), np.max(angle), RANGE_POINTS)
    return float(
        highest(lambda phi: mechanism.sweep(phi).output()[None], places, mechanism.sweep(places).output()[None])[0][0]
    )
