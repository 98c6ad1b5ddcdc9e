"""A scene in units of its own, its size one and its largest mass a thousandth; and a history back in SI.

An iteration that weighs forces against velocities in one residual is only as good as the units they come in: in SI
exudyn's torque for a needle mechanism carries twenty times the error it has in these units at the same tolerance, and
for the same mechanism a thousand times larger its iteration does not end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import Law
from analytic.description.linkage import DriverKind
from engines.contract import History, Signal
from engines.mechanics.joints import scene_size
from engines.scene import Drive, Prescribed, Scene

# Largest mass in a scene's own units. Accelerations are large numbers where velocities are moderate ones; small masses
# keep forces from outweighing the velocities at which joints open. Measured: flat from 1e-4 down, a little worse at 1.
LARGEST_MASS = 1e-3


# Powers of length and mass in the unit of what a scene's parts call so; everything else has none, or that of time.
POWERS: Mapping[str, tuple[int, int]] = {
    **dict.fromkeys(("position", "velocity", "acceleration", "gravity", "length"), (1, 0)),
    **dict.fromkeys(("anchor", "first_anchor", "second_anchor", "through"), (1, 0)),
    **dict.fromkeys(("mass", "stiffness", "damping"), (0, 1)),  # N/m is kg/s²
    **dict.fromkeys(("inertia", "torque", "coefficient"), (2, 1)),
    "force": (1, 1),
}


@dataclass(frozen=True)
class OwnUnits:
    """Units of a scene: a length, m, and a mass, kg; the unit of time is the second."""

    length: float
    mass: float

    def unit(self, name: str) -> float:
        """The unit, in SI, of a quantity by its name in ``POWERS``."""
        length, mass = POWERS[name]
        return float(self.length**length * self.mass**mass)


def own_units(scene: Scene, size: float = 1.0) -> OwnUnits:
    """The units in which the scene's size is ``size`` and its largest mass is LARGEST_MASS."""
    largest = max(body.mass for body in scene.bodies) or 1.0
    return OwnUnits(scene_size(scene) / size, largest / LARGEST_MASS if largest > 0.0 else 1.0)


def scaled(scene: Scene, units: OwnUnits) -> Scene:
    """The same scene with every number in the units given."""
    result: Scene = _scaled(scene, "", units)
    return result if scene.driver_kind is DriverKind.CRANK else _scale_linear_driver(result, units)


def _scale_linear_driver(scene: Scene, units: OwnUnits) -> Scene:
    """A scene in own units with a φ that is a length: φ, the drive's force and the loads' laws over φ as well."""
    drive: Drive
    if isinstance(scene.drive, Prescribed):
        motion = scene.drive.motion
        segments = [
            replace(segment, coefficients=tuple(c / units.length for c in segment.coefficients))
            for segment in motion.segments
        ]
        drive = Prescribed(replace(motion, segments=tuple(segments)))
    else:
        torque, pace = scene.drive.torque * units.length, scene.drive.pace / units.length
        timed = scene.drive.over_time
        if timed is not None:
            timed = replace(timed, torque=tuple(value * units.length for value in timed.torque))
        drive = replace(scene.drive, torque=torque, pace=pace, over_time=timed)

    def over_length(law: Law) -> Law:
        return law if law.angles is None else replace(law, angles=law.angles / units.length)

    return replace(
        scene,
        drive=drive,
        forces=tuple(replace(load, force=over_length(load.force)) for load in scene.forces),
        torques=tuple(replace(load, torque=over_length(load.torque)) for load in scene.torques),
    )


def _scaled(value: Any, name: str, units: OwnUnits) -> Any:  # noqa: ANN401 - a scene, or anything in one
    """A part of a scene, or a number by the ``name`` of its quantity, in the units given."""
    if name in POWERS and value is not None:
        unit = units.unit(name)
        if isinstance(value, Law):
            return replace(value, values=value.values / unit)
        return tuple(number / unit for number in value) if isinstance(value, tuple) else value / unit
    if isinstance(value, tuple):
        return tuple(_scaled(each, "", units) for each in value)
    if is_dataclass(value) and not isinstance(value, (type, CrankMotion)):
        return replace(value, **{f.name: _scaled(getattr(value, f.name), f.name, units) for f in fields(value)})
    return value


def restored(history: History, units: OwnUnits, driver: DriverKind = DriverKind.CRANK) -> History:
    """A history of a scaled scene in SI; the torque of a linear ``driver`` is a force."""
    coordinates = np.array([units.length, units.length, 1.0])

    def times(signal: Signal | None, factor: object) -> Signal | None:
        return None if signal is None else replace(signal, values=signal.values * np.asarray(factor))

    return History(
        position=times(history.position, coordinates),
        velocity=times(history.velocity, coordinates),
        acceleration=times(history.acceleration, coordinates),
        torque=times(history.torque, units.unit("torque" if driver is DriverKind.CRANK else "force")),
        joint_force={
            name: replace(signal, values=signal.values * units.unit("force"))
            for name, signal in history.joint_force.items()
        },
    )
