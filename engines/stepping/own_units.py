"""A scene in units of its own, its size one and its largest mass a thousandth; and a history back in SI.

An iteration that weighs forces against velocities in one residual is only as good as the units they come in: in SI
exudyn's torque for a needle mechanism carries twenty times the error it has in these units at the same tolerance, and
for the same mechanism a thousand times larger its iteration does not end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from analytic.description.linkage import DriverKind
from analytic.description.units import Kind
from analytic.description.walk import walk, with_values
from engines.contract import History
from engines.mechanics.joints import scene_size
from engines.scene import LEVELS, Channel, Scene

# Largest mass in a scene's own units. Accelerations are large numbers where velocities are moderate ones; small masses
# keep forces from outweighing the velocities at which joints open. Measured: flat from 1e-4 down, a little worse at 1.
LARGEST_MASS = 1e-3


@dataclass(frozen=True)
class OwnUnits:
    """Units of a scene: a length, m, and a mass, kg; the unit of time is the second."""

    length: float
    mass: float

    def unit(self, kind: Kind, driver: DriverKind = DriverKind.CRANK) -> float:
        """Size, in SI, of these units for a kind of number; a linear driver's φ is a length, its torque a force."""
        return kind.of_driver(is_linear=driver is not DriverKind.CRANK).size(self.length, self.mass)


def own_units(scene: Scene, size: float = 1.0) -> OwnUnits:
    """The units in which the scene's size is ``size`` and its largest mass LARGEST_MASS.

    Where no body has a mass, the largest counts for 1 kg.
    """
    largest = max(body.mass for body in scene.bodies) or 1.0
    return OwnUnits(scene_size(scene) / size, largest / LARGEST_MASS if largest > 0.0 else 1.0)


def scaled(scene: Scene, units: OwnUnits) -> Scene:
    """A copy of the scene with every number, laws' and motion's included, in these units."""
    sizes = {kind: units.unit(kind, scene.driver_kind) for kind in Kind}
    values = {path: value / sizes[kind] for path, kind, value in walk(scene) if sizes[kind] != 1.0}
    result: Scene = with_values(scene, values)
    return result


def restored(history: History, units: OwnUnits, driver: DriverKind = DriverKind.CRANK) -> History:
    """A copy of a history that is in these units, in SI; the torque of a linear ``driver`` is a force."""
    sizes = dict.fromkeys(LEVELS, np.array([units.length, units.length, 1.0]))
    sizes |= {
        Channel.TORQUE: np.array(units.unit(Kind.DRIVE, driver)),
        Channel.JOINT_FORCE: np.array(units.unit(Kind.FORCE)),
    }
    signals = history.signals.items()
    return History.of({key: replace(signal, values=signal.values * sizes[key[0]]) for key, signal in signals})
