"""Sensors on an exudyn system and the history they recorded; a channel that is not requested gets no sensor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND
from engines.contract import History, ReadOut, Signal
from engines.exudyn_adapter.model import ANGLE, Model
from engines.scene import Channel

Array = NDArray[np.float64]

COORDINATES = {
    Channel.POSITION: "Coordinates",
    Channel.VELOCITY: "Coordinates_t",
    Channel.ACCELERATION: "Coordinates_tt",
}
END = "of the state at the end of the step"
READOUTS: Mapping[Channel, ReadOut] = {
    **{channel: ReadOut(f"SensorNode, {name}", instant=END) for channel, name in COORDINATES.items()},
    Channel.ACCELERATION: ReadOut(
        "SensorNode, Coordinates_tt; without that of the start, which is given to exudyn but in naive", instant=END
    ),
    Channel.TORQUE: ReadOut(
        "SensorObject of the drive's ObjectConnectorCoordinate (linear: CoordinateVector), Force, with its sign turned",
        instant=END,
        drive="alone",
    ),
    Channel.JOINT_FORCE: ReadOut(
        "SensorObject of the joint, Force; of ObjectJointPrismatic2D ForceLocal, turned by its body's angle",
        frame="ground; ForceLocal the body's",
        instant=END,
        drive="not included",
    ),
}


@dataclass(frozen=True)
class Recorder:
    """The sensors of a model, by what they measure."""

    model: Model
    motion: Mapping[Channel, Sequence[int]]
    angles: Mapping[str, int]
    torque: int | None
    forces: Mapping[str, int]

    @property
    def sensors(self) -> tuple[int, ...]:
        """All sensors that were built."""
        motion = [sensor for sensors in self.motion.values() for sensor in sensors]
        torque = [] if self.torque is None else [self.torque]
        return tuple(dict.fromkeys([*motion, *self.angles.values(), *torque, *self.forces.values()]))

    def read(self, *, first: bool, before_jump: bool) -> History:
        """The samples of the latest solve that are exudyn's own: of the state it started from only the run's first.

        The multipliers belong to a step, not to a state: loads have no sample at the start. Nor have accelerations
        where those of the scene were given to start from. Both have none at a jump, where they have two values.
        """
        data = {sensor: self.model.mbs.GetSensorStoredData(sensor) for sensor in self.sensors}
        time = self.model.begin + next(iter(data.values()))[:, 0] if data else np.zeros(0)
        end = -1 if before_jump else None
        motion = {}
        for channel, sensors in self.motion.items():
            changes = channel is Channel.ACCELERATION
            given = not first or (changes and bool(self.model.starts))
            kept = slice(1 if given else 0, end if changes else None)
            values = self._motion(channel, [data[sensor] for sensor in sensors], len(time))
            motion[channel.value] = Signal(time[kept], values[kept])
        loaded = slice(1, end)
        torque = None  # exudyn reports what the crank does to the drive
        if self.torque is not None:
            torque = Signal(time[loaded], -data[self.torque][loaded, 1])
        forces = {name: Signal(time[loaded], self._force(name, data)[loaded]) for name in self.forces}
        return History(**motion, torque=torque, joint_force=forces)

    def _motion(self, channel: Channel, columns: Sequence[Array], samples: int) -> Array:
        result = np.zeros((samples, len(columns), 3))
        for number, (body, column) in enumerate(zip(self.model.scene.bodies, columns, strict=True)):
            result[:, number, : column.shape[1] - 1] = column[:, 1:]
            if channel is Channel.POSITION:
                result[:, number] += (*body.position, body.angle) + self.model.unwound[number]
        return result

    def _force(self, name: str, data: Mapping[int, Array]) -> Array:
        output = self.model.joints[name]
        values = data[self.forces[name]][:, 1:] @ output.matrix.T
        if output.frame == GROUND:
            return values
        angle = self.model.angles[output.frame] + data[self.angles[output.frame]][:, 1 + ANGLE]
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([c * values[:, 0] - s * values[:, 1], s * values[:, 0] + c * values[:, 1]], axis=-1)


def add_sensors(model: Model) -> Recorder:
    """Put sensors on a model for the channels its scene asks for."""
    items, mbs, outputs = model.items, model.mbs, model.exudyn.OutputVariableType
    channels = model.scene.channels

    def on_node(body: str, output: str) -> int:
        variable = getattr(outputs, output)
        sensor = items.SensorNode(nodeNumber=model.nodes[body], outputVariableType=variable, storeInternal=True)
        return int(mbs.AddSensor(sensor))

    def on_item(item: int, output: str) -> int:
        variable = getattr(outputs, output)
        sensor = items.SensorObject(objectNumber=item, outputVariableType=variable, storeInternal=True)
        return int(mbs.AddSensor(sensor))

    motion = {
        channel: [on_node(name, output) for name in model.nodes]
        for channel, output in COORDINATES.items()
        if channel in channels
    }
    joints = model.joints if Channel.JOINT_FORCE in channels else {}
    frames = {output.frame for output in joints.values()} - {GROUND}
    places = dict(zip(model.nodes, motion.get(Channel.POSITION, ()), strict=False))
    return Recorder(
        model=model,
        motion=motion,
        angles={name: places[name] if name in places else on_node(name, "Coordinates") for name in sorted(frames)},
        torque=None if model.driver is None or Channel.TORQUE not in channels else on_item(model.driver, "Force"),
        forces={name: on_item(output.item, output.output) for name, output in joints.items()},
    )
