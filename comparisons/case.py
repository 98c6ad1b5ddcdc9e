"""A case: one mechanism under one motion of its crank, the truth an engine is held against."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError
from analytic.free_motion import FreeMotion, free_motion
from analytic.kinetostatics import joint_forces
from analytic.linkage import Output, OwnRegime, Vector
from analytic.mechanism import Mechanism
from analytic.regimes import CrankMotion
from analytic.sweep import Sweep
from comparisons.scenes import scene
from engines.contract import Channel, Drive, Free, Prescribed, Scene

Array = NDArray[np.float64]

# Jeq = 2T/ω² says nothing near standstill: samples slower than this share of the peak speed are left out.
SLOW_SHARE = 0.05


class Motion(Protocol):
    """A crank motion, prescribed or found by integration."""

    @property
    def regime(self) -> str:
        """Name of the regime."""
        ...

    @property
    def duration(self) -> float:
        """Time at which it ends, s; it starts at 0."""
        ...

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        ...

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        ...

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        ...

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        ...

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²."""
        ...


@dataclass(frozen=True)
class Case:
    """One mechanism under one crank motion; ``drive`` is what an engine is given, the motion itself by default."""

    mechanism: Mechanism
    motion: Motion
    drive: Drive | None = None
    conditions: str = ""
    _seen: dict[bytes, Sweep] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_prescribed(self) -> bool:
        """Whether the crank's motion is given, so that the torque is what is asked for."""
        return self.drive is None or isinstance(self.drive, Prescribed)

    @property
    def output(self) -> Output:
        """The linkage's output; S, v and a need one."""
        output = self.mechanism.linkage.output
        if output is None:
            raise LinkproofError(
                f"'{self.mechanism.linkage.name}' names no output, so S, v and a are undefined: add "
                "output = { point = ..., along = [x, y] } to its file, or leave these quantities out"
            )
        return output

    @property
    def least_speed(self) -> float:
        """Crank speed, rad/s, below which quantities divided by ω are left out."""
        return SLOW_SHARE * self.motion.peak_speed

    def scene(self, channels: Iterable[Channel]) -> Scene:
        """What an engine is given of the case."""
        drive = self.drive
        if drive is None:
            assert isinstance(self.motion, CrankMotion)
            drive = Prescribed(self.motion)
        start = np.zeros(())
        angle, speed = float(self.motion.angle(start)), float(self.motion.speed(start))
        return scene(self.mechanism, drive, channels, start_angle=angle, speed=speed)

    def sweep(self, time: Array) -> Sweep:
        """The closed form along the motion, kept so that all quantities on one clock share its work."""
        key = time.tobytes()
        if key not in self._seen:
            self._seen[key] = self.mechanism.sweep(self.motion.angle(time))
        return self._seen[key]

    def joint_names(self) -> tuple[str, ...]:
        """Names of all joints that carry a force."""
        return tuple(joint_forces(self.mechanism.sweep(self.motion.angle(np.zeros(1))), 0.0, 0.0))

    def output_anchor(self) -> Vector:
        """The output point relative to its link's mass centre, link frame, m."""
        link = self.mechanism.linkage.links[self.output.link]
        point = link.points[self.output.point]
        return (point[0] - link.centre[0], point[1] - link.centre[1])

    def along(self, vectors: Array) -> Array:
        """Component of (n, 2) vectors along the output's direction."""
        return np.asarray(vectors @ np.asarray(self.output.along))


def own_motion(mechanism: Mechanism, own: OwnRegime, half_slope: str = "exact") -> FreeMotion:
    """The motion of a regime of the linkage's own; ``half_slope`` names the model of ½ Jeq'."""
    motion = free_motion(
        mechanism,
        torque=own.torque,
        start_angle=own.start_angle,
        start_speed=own.start_speed,
        duration=own.duration,
        half_slope=half_slope,
    )
    return replace(motion, regime=own.name)


def own_case(mechanism: Mechanism, own: OwnRegime) -> Case:
    """The case of a regime of the linkage's own: a released crank, its motion by the equation of motion."""
    motion = own_motion(mechanism, own)
    conditions = (
        f"released at {math.degrees(own.start_angle):g}° with {own.start_speed:g} rad/s, crank torque {own.torque:g} "
        f"N m, {own.duration:g} s, {'gravity on' if any(mechanism.linkage.gravity) else 'gravity off'}"
    )
    return Case(mechanism, motion, Free(own.torque, own.duration), conditions)
