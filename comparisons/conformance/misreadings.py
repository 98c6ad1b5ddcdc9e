"""Ways to hand back what an engine says wrongly: a history as a slip in an adapter's read-out would leave it.

Each takes a whole history and its scene, and changes one channel of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from comparisons.observation.interpolation import resample
from engines.contract import History, Signal
from engines.scene import Channel, Scene

Array = NDArray[np.float64]
Change = Callable[[History, Scene], History]


@dataclass(frozen=True)
class Misreading:
    """What is changed, and the channel that it takes; ``vectors``: joint forces have to be vectors."""

    channel: Channel
    change: Change
    vectors: bool = False


def _values(channel: Channel, change: Callable[[Signal], Array]) -> Misreading:
    def changed(history: History, _: Scene) -> History:
        signal = getattr(history, channel.value)
        return replace(history, **{channel.value: replace(signal, values=change(signal))})

    return Misreading(channel, changed)


def _scaled(channel: Channel, factor: float) -> Misreading:
    return _values(channel, lambda signal: factor * signal.values)


def _earlier(channel: Channel, samples: float) -> Misreading:
    """Every value belongs to an instant so many samples before its time."""

    def late(signal: Signal) -> Array:
        time = signal.time
        steps = np.append(np.diff(time), time[-1] - time[-2])
        return resample(signal, np.maximum(time - samples * steps, time[0]))

    return _values(channel, late)


def _mirrored(signal: Signal) -> Array:
    values = signal.values.copy()
    values[:, -1, 2] *= -1.0
    return values


def _force(change: Callable[[Mapping[str, Signal], History, Scene], Mapping[str, Signal]]) -> Misreading:
    def changed(history: History, scene: Scene) -> History:
        return replace(history, joint_force=change(history.joint_force, history, scene))

    return Misreading(Channel.JOINT_FORCE, changed)


def _of_one(change: Callable[[Signal, Array], Array]) -> Misreading:
    """The force of the joint with the largest force: its values changed, beside its first body's angle."""

    def changed(forces: Mapping[str, Signal], history: History, scene: Scene) -> Mapping[str, Signal]:
        firsts = {joint.name: joint.first for joint in scene.pins} | {joint.name: joint.body for joint in scene.guided}
        numbers = {body.name: number for number, body in enumerate(scene.bodies)}
        name = max(forces, key=lambda joint: float(np.abs(forces[joint].values).max()))
        signal, angle = forces[name], np.zeros(len(forces[name].time))
        if history.position is not None and firsts[name] in numbers:
            angle = resample(history.position, signal.time)[:, numbers[firsts[name]], 2]
        return {**forces, name: replace(signal, values=change(signal, angle))}

    return _force(changed)


def _in_body_frame(signal: Signal, angle: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    x, y = signal.values.T
    return np.column_stack([c * x + s * y, c * y - s * x])


def _exchanged(forces: Mapping[str, Signal], _: History, __: Scene) -> Mapping[str, Signal]:
    sizes = {name: float(np.abs(signal.values).max()) for name, signal in forces.items()}
    least, largest = min(sizes, key=sizes.__getitem__), max(sizes, key=sizes.__getitem__)
    return {**forces, least: forces[largest], largest: forces[least]}


def _felt(history: History, scene: Scene) -> History:
    """What an accelerometer shows."""
    signal = history.acceleration
    assert signal is not None
    return replace(history, acceleration=replace(signal, values=signal.values - np.array([*scene.gravity, 0.0])))


MISREADINGS: Final[Mapping[str, Misreading]] = {
    "positions of a sample before": _earlier(Channel.POSITION, 1.0),
    "angle of a body mirrored": _values(Channel.POSITION, _mirrored),
    "positions 1 % too large": _scaled(Channel.POSITION, 1.01),
    "velocities of half a sample before": _earlier(Channel.VELOCITY, 0.5),
    "velocities reversed": _scaled(Channel.VELOCITY, -1.0),
    "velocities 0.1 % too large": _scaled(Channel.VELOCITY, 1.001),
    "accelerations of a sample before": _earlier(Channel.ACCELERATION, 1.0),
    "accelerations without gravity": Misreading(Channel.ACCELERATION, _felt),
    "drive torque reversed": _scaled(Channel.TORQUE, -1.0),
    "drive torque of half a sample before": _earlier(Channel.TORQUE, 0.5),
    "drive torque 0.1 % too large": _scaled(Channel.TORQUE, 1.001),
    "a joint's force on its other body": replace(_of_one(lambda signal, _: -signal.values), vectors=True),
    "a joint's force in its body's frame": replace(_of_one(_in_body_frame), vectors=True),
    "a joint's force 1 % too large": _of_one(lambda signal, _: 1.01 * signal.values),
    "two joints' forces exchanged": _force(_exchanged),
}
