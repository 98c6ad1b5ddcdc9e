"""A scene in units of its own, its size one and its largest mass a thousandth; and a history back in SI.

An iteration that weighs forces against velocities in one residual is only as good as the units they come in: in SI
exudyn's torque for a needle mechanism carries twenty times the error it has in these units at the same tolerance, and
for the same mechanism a thousand times larger its iteration does not end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import Law
from analytic.description.linkage import Vector
from engines.contract import History, Signal
from engines.mechanics.joints import scene_size
from engines.scene import Body, Free, PinJoint, PointSpring, Scene, SliderJoint, SlotJoint

Array = NDArray[np.float64]

# Largest mass in a scene's own units. Accelerations are large numbers where velocities are moderate ones; small masses
# keep forces from outweighing the velocities at which joints open. Measured: flat from 1e-4 down, a little worse at 1.
LARGEST_MASS = 1e-3


@dataclass(frozen=True)
class Units:
    """What counts as one: a length, m, and a mass, kg; the unit of time stays the second."""

    length: float
    mass: float

    @property
    def force(self) -> float:
        """Unit of force, N."""
        return self.mass * self.length

    @property
    def torque(self) -> float:
        """Unit of torque, N m, and of inertia, kg m²."""
        return self.mass * self.length**2

    def vector(self, vector: Vector) -> Vector:
        """A length, velocity or acceleration in these units."""
        return (vector[0] / self.length, vector[1] / self.length)

    def body(self, body: Body) -> Body:
        """A body in these units; angles have none."""
        return replace(
            body,
            mass=body.mass / self.mass,
            inertia=None if body.inertia is None else body.inertia / self.torque,
            position=self.vector(body.position),
            velocity=self.vector(body.velocity),
            acceleration=self.vector(body.acceleration),
        )

    def pin(self, pin: PinJoint) -> PinJoint:
        """A pin in these units."""
        return replace(pin, first_anchor=self.vector(pin.first_anchor), second_anchor=self.vector(pin.second_anchor))

    def slider(self, slider: SliderJoint) -> SliderJoint:
        """A slider in these units."""
        return replace(slider, anchor=self.vector(slider.anchor), through=self.vector(slider.through))

    def slot(self, slot: SlotJoint) -> SlotJoint:
        """A slot in these units."""
        return replace(slot, anchor=self.vector(slot.anchor), through=self.vector(slot.through))

    def spring(self, spring: PointSpring) -> PointSpring:
        """A spring in these units; N/m is kg/s²."""
        return replace(
            spring,
            first_anchor=self.vector(spring.first_anchor),
            second_anchor=self.vector(spring.second_anchor),
            stiffness=spring.stiffness / self.mass,
            damping=spring.damping / self.mass,
            length=spring.length / self.length,
        )


def own_units(scene: Scene) -> Units:
    """The units in which the scene's size is one and its largest mass is LARGEST_MASS."""
    largest = max(body.mass for body in scene.bodies)
    return Units(scene_size(scene), largest / LARGEST_MASS if largest > 0.0 else 1.0)


def scaled(scene: Scene, units: Units) -> Scene:
    """The same scene with every number in the units given."""
    drive = scene.drive
    if isinstance(drive, Free):
        drive = replace(drive, torque=drive.torque / units.torque)
    return replace(
        scene,
        bodies=tuple(map(units.body, scene.bodies)),
        pins=tuple(map(units.pin, scene.pins)),
        sliders=tuple(map(units.slider, scene.sliders)),
        slots=tuple(map(units.slot, scene.slots)),
        gravity=units.vector(scene.gravity),
        drive=drive,
        forces=tuple(
            replace(f, anchor=units.vector(f.anchor), force=_over(f.force, units.force)) for f in scene.forces
        ),
        torques=tuple(replace(t, torque=_over(t.torque, units.torque)) for t in scene.torques),
        springs=tuple(map(units.spring, scene.springs)),
        dampers=tuple(replace(d, coefficient=d.coefficient / units.torque) for d in scene.dampers),
    )


def _over(law: Law, unit: float) -> Law:
    return Law(law.values / unit, law.angles)


def restored(history: History, units: Units) -> History:
    """A history of a scaled scene in SI."""
    coordinates = np.array([units.length, units.length, 1.0])
    forces: Mapping[str, Signal] = {
        name: Signal(signal.time, signal.values * units.force) for name, signal in history.joint_force.items()
    }
    return History(
        position=_times(history.position, coordinates),
        velocity=_times(history.velocity, coordinates),
        acceleration=_times(history.acceleration, coordinates),
        torque=_times(history.torque, np.array(units.torque)),
        joint_force=forces,
    )


def _times(signal: Signal | None, factor: Array) -> Signal | None:
    return None if signal is None else Signal(signal.time, signal.values * factor)
