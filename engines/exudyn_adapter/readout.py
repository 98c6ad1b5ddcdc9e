"""Sensors on an exudyn system and the history they recorded; a channel that is not asked for gets no sensor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND
from engines.contract import History, Signal
from engines.exudyn_adapter.model import ANGLE, Model
from engines.scene import Channel

Array = NDArray[np.float64]

COORDINATES = {
    Channel.POSITION: "Coordinates",
    Channel.VELOCITY: "Coordinates_t",
    Channel.ACCELERATION: "Coordinates_tt",
}


@dataclass(frozen=True)
class Recorder:
    """The sensors of a model, by what they measure."""

    model: Model
    motion: Mapping[Channel, tuple[int, ...]]
    angles: Mapping[str, int]
    torque: int | None
    forces: Mapping[str, int]
    crank: tuple[int, ...]

    @property
    def sensors(self) -> tuple[int, ...]:
        """All sensors that were built."""
        motion = [sensor for sensors in self.motion.values() for sensor in sensors]
        torque = [] if self.torque is None else [self.torque]
        return tuple(dict.fromkeys([*motion, *self.angles.values(), *torque, *self.forces.values(), *self.crank]))

    def pace(self) -> float:
        """Natural rate of the crank in the latest solve, rad/s: how fast it turns and how fast its speed changes."""
        speed, second = (np.abs(self.model.mbs.GetSensorStoredData(s)[:, 1 + ANGLE]).max() for s in self.crank)
        return float(speed + second / speed) if speed > 0.0 else 0.0

    def read(self, *, last: bool, before_jump: bool) -> History:
        """The samples of the latest solve, without those that belong to the interval after it.

        Where two intervals meet, the motion is taken from the later one: an acceleration at a jump is the value just
        after it. The multipliers belong to a step, not to a state: loads have no sample at a start, and none at a
        jump, where they have two values.
        """
        data = {sensor: self.model.mbs.GetSensorStoredData(sensor) for sensor in self.sensors}
        time = next(iter(data.values()))[:, 0] if data else np.zeros(0)
        moving = slice(None) if last else slice(None, -1)
        loaded = slice(1, -1) if before_jump else slice(1, None)
        motion = {
            channel.value: Signal(
                time[moving], self._motion(channel, [data[sensor] for sensor in sensors], len(time))[moving]
            )
            for channel, sensors in self.motion.items()
        }
        torque = None  # exudyn reports what the crank does to the drive
        if self.torque is not None:
            torque = Signal(time[loaded], -data[self.torque][loaded, 1])
        forces = {name: Signal(time[loaded], self._force(name, data)[loaded]) for name in self.forces}
        return History(**motion, torque=torque, joint_force=forces)

    def samples(self) -> int | None:
        """Number of samples of the latest solve; None where nothing is recorded."""
        sensors = self.sensors
        return len(self.model.mbs.GetSensorStoredData(sensors[0])) if sensors else None

    def _motion(self, channel: Channel, columns: Sequence[Array], samples: int) -> Array:
        result = np.zeros((samples, len(columns), 3))
        for number, (body, column) in enumerate(zip(self.model.scene.bodies, columns, strict=True)):
            result[:, number, : column.shape[1] - 1] = column[:, 1:]
            if channel is Channel.POSITION:
                result[:, number] += (*body.position, body.angle)
        return result

    def _force(self, name: str, data: Mapping[int, Array]) -> Array:
        output = self.model.joints[name]
        values = data[self.forces[name]][:, 1:] @ output.matrix.T
        if output.frame == GROUND:
            return values
        start = next(body.angle for body in self.model.scene.bodies if body.name == output.frame)
        angle = start + data[self.angles[output.frame]][:, 1 + ANGLE]
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([c * values[:, 0] - s * values[:, 1], s * values[:, 0] + c * values[:, 1]], axis=-1)


def add_sensors(model: Model) -> Recorder:
    """Put sensors on a model for the channels its scene asks for."""
    items, mbs, outputs = model.exudyn.itemInterface, model.mbs, model.exudyn.OutputVariableType
    channels = model.scene.channels

    def on_node(body: str, output: str) -> int:
        variable = getattr(outputs, output)
        sensor = items.SensorNode(nodeNumber=model.nodes[body], outputVariableType=variable, storeInternal=True)
        return int(mbs.AddSensor(sensor))

    def on_item(item: int, output: str) -> int:
        variable = getattr(outputs, output)
        sensor = items.SensorObject(objectNumber=item, outputVariableType=variable, storeInternal=True)
        return int(mbs.AddSensor(sensor))

    names = [body.name for body in model.scene.bodies]
    motion = {
        channel: tuple(on_node(name, output) for name in names)
        for channel, output in COORDINATES.items()
        if channel in channels
    }
    number = names.index(model.scene.crank)
    pace = [
        motion[channel][number] if channel in motion else on_node(model.scene.crank, COORDINATES[channel])
        for channel in (Channel.VELOCITY, Channel.ACCELERATION)
        if model.driver is None  # only a free crank's speed is not known beforehand
    ]
    joints = model.joints if Channel.JOINT_FORCE in channels else {}
    frames = {output.frame for output in joints.values()} - {GROUND}
    places = dict(zip(names, motion.get(Channel.POSITION, ()), strict=False))
    return Recorder(
        model=model,
        motion=motion,
        angles={name: places[name] if name in places else on_node(name, "Coordinates") for name in sorted(frames)},
        torque=None if model.driver is None or Channel.TORQUE not in channels else on_item(model.driver, "Force"),
        forces={name: on_item(output.item, output.output) for name, output in joints.items()},
        crank=tuple(pace),
    )
