"""From a scene to an exudyn system: planar bodies, joints, loads and springs, with nothing the motion does not need.

A body that cannot turn is a point mass with two coordinates and a slider on the ground one equation between them: no
rotation, no inertia, and a quarter to a third less time than a rigid body in a prismatic joint.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.mechanics.states import start_motion
from engines.scene import Body, Channel, GuidedJoint, PinJoint, Prescribed, Scene, SliderJoint
from engines.stepping.loop_engine import plain_law

Array = NDArray[np.float64]

ANGLE = 2  # number of the angle among the coordinates of a two-dimensional rigid body
COORDINATES = {
    Channel.POSITION: "Coordinates",
    Channel.VELOCITY: "Coordinates_t",
    Channel.ACCELERATION: "Coordinates_tt",
}


@dataclass(frozen=True)
class ForceOutput:
    """Where exudyn reports a joint's force: ``matrix`` (2, k) turns its k values into the force on the first body.

    The result is in the frame of ``frame``, a body, or in the ground's.
    """

    item: int
    output: str
    matrix: Array
    frame: str = GROUND


class Model:
    """The items of an exudyn system of a scene and where to find things in it, in the order of their making.

    An item is its category, its kind and its data as exudyn has them, and what of it is a function, as the loop has it.
    ``plain`` builds it as a newcomer would, every link a rigid body. ``driver`` is the number, among the items, of the
    one that holds a prescribed driver; None for a free one.
    """

    def __init__(self, scene: Scene, *, plain: bool = False) -> None:
        self.items: list[tuple[str, str, dict[str, Any], tuple[str, Any] | None]] = []
        self.counts: Counter[str] = Counter()
        self.scene, self.plain = scene, plain
        self.nodes: dict[str, int] = {}
        self.objects: dict[str, int] = {GROUND: self._object("Ground")}
        self.angles = {GROUND: 0.0, **{body.name: body.angle for body in scene.bodies}}
        self.turning: set[str] = set()
        self.joints: dict[str, ForceOutput] = {}
        self.ground = self._add("Node", "PointGround", {})
        self.fixed = self._marker("NodeCoordinate", nodeNumber=self.ground, coordinate=0)
        for body in scene.bodies:
            self._add_body(body)
        for pin in scene.pins:
            self._add_pin(pin)
        for slider in scene.sliders:
            self._add_slider(slider)
        for slot in scene.slots:
            self._add_line(slot, turning=True)
        self._add_loads()
        self._add_springs()
        self.driver: int | None = None
        self._add_drive()
        # Which of x, y and angle of every body are coordinates of the system, in whose order they are.
        self.free = np.array([(True, True, body.name in self.turning) for body in scene.bodies])

    def described(self) -> dict[str, Any]:
        """The system in plain data, its sensors among the items."""
        scene = self.scene
        segments = scene.drive.motion.segments if isinstance(scene.drive, Prescribed) else ()
        states = [values[0, :-1][self.free] for values in start_motion(scene)]
        states[0] = np.zeros_like(states[0])  # coordinates are displacements from the start
        bodies = [body.name for body in scene.bodies]
        return {
            **add_sensors(self),
            "items": self.items,
            "driver": self.driver,
            "linear": None if scene.driver_kind is DriverKind.CRANK else self._linear_driver(),
            "crank": bodies.index(scene.crank) if scene.crank in bodies else None,
            "crank_node": self.nodes.get(scene.crank),
            "start": scene.crank_angle,
            "motion": [(segment.start, segment.end, segment.coefficients) for segment in segments],
            "free": self.free,
            "states": states,
            "poses": [(*body.position, body.angle) for body in scene.bodies],
        }

    def _linear_driver(self) -> dict[str, Any]:
        """Of the bodies at a linear driver's ends: node, whether it turns, its angle if not, and the anchor."""
        scene = self.scene
        ends = zip(scene.driver_ends[:2], scene.driver_ends[2:], strict=True)
        return {
            "ends": [
                (self.nodes.get(body), body in self.turning, self.angles[body], complex(*anchor))
                for body, anchor in ends
            ],
            "along": None if scene.cylinder else complex(*scene.driven_slider.along),
        }

    def _add(self, category: str, kind: str, data: dict[str, Any], law: tuple[str, Any] | None = None) -> int:
        """Number of a new item in its category."""
        self.items.append((category, kind, data, law))
        self.counts[category] += 1
        return self.counts[category] - 1

    def sensor(self, kind: str, output: str, **data: int) -> int:
        """Number of a new sensor on a node or an object."""
        return self._add("Sensor", kind, {**data, "outputVariableType": output, "storeInternal": True})

    def _object(self, kind: str, law: tuple[str, Any] | None = None, **data: Any) -> int:  # noqa: ANN401
        return self._add("Object", kind, data, law)

    def _marker(self, kind: str, **data: Any) -> int:  # noqa: ANN401
        return self._add("Marker", kind, data)

    def _load(self, kind: str, marker: int, law: tuple[str, Any] | None = None, **data: Any) -> None:  # noqa: ANN401
        self._add("Load", kind, {"markerNumber": marker, **data}, law)

    def _coordinate(self, body: str, number: int) -> int:
        """Marker of one coordinate of a body; the ground's for what does not move."""
        if body == GROUND or (number == ANGLE and body not in self.turning):
            return self.fixed
        return self._marker("NodeCoordinate", nodeNumber=self.nodes[body], coordinate=number)

    def _point(self, body: str, anchor: Vector) -> int:
        """Marker of a point of a body."""
        x, y = anchor
        if body != GROUND and body not in self.turning:  # a point mass has no frame of its own
            c, s = math.cos(self.angles[body]), math.sin(self.angles[body])
            x, y = c * x - s * y, s * x + c * y
        return self._marker("BodyPosition", bodyNumber=self.objects[body], localPosition=[x, y, 0.0])

    def _frame(self, body: str, anchor: Vector) -> int:
        """Marker of a point of a body together with the body's orientation."""
        return self._marker("BodyRigid", bodyNumber=self.objects[body], localPosition=[*anchor, 0.0])

    def _add_body(self, body: Body) -> None:
        """Add a body, with its weight if it has any."""
        joints = [joint for joint in self.scene.sliders if joint.body == body.name]
        straight = body.inertia is None or any(joint.host == GROUND for joint in joints)
        if straight and not self.plain and not self._needs_frame(body.name):
            node, place, rate, shape = "Point2D", [*body.position], [*body.velocity], "MassPoint2D"
            inertia: dict[str, Any] = {}
        else:
            place, rate = [*body.position, body.angle], [*body.velocity, body.angular_velocity]
            node, shape, inertia = "RigidBody2D", "RigidBody2D", {"inertia": body.inertia or 0.0}
            self.turning.add(body.name)
        number = self._add("Node", node, {"referenceCoordinates": place, "initialVelocities": rate})
        self.nodes[body.name] = number
        self.objects[body.name] = self._object(shape, mass=body.mass, nodeNumber=number, **inertia)
        held = any(self.plain or joint.host != GROUND for joint in joints)  # by a prismatic joint
        if straight and body.name in self.turning and not held:
            self._object("ConnectorCoordinate", markerNumbers=[self.fixed, self._coordinate(body.name, ANGLE)])
        if any(self.scene.gravity) and body.mass > 0.0:
            marker = self._marker("BodyMass", bodyNumber=self.objects[body.name])
            self._load("MassProportional", marker, loadVector=[*self.scene.gravity, 0.0])

    def _needs_frame(self, body: str) -> bool:
        """Whether a joint asks for the body's orientation, which a point mass cannot give."""
        fixed = [joint.name for joint in self.scene.sliders if joint.host == GROUND]
        return any(body in (joint.host, joint.body) for joint in self.scene.guided if joint.name not in fixed)

    def _add_pin(self, pin: PinJoint) -> None:
        """Add a revolute joint; exudyn reports the force on its first marker's body, in the ground frame."""
        markers = [self._point(pin.first, pin.first_anchor), self._point(pin.second, pin.second_anchor)]
        self.joints[pin.name] = ForceOutput(
            self._object("JointRevolute2D", markerNumbers=markers), "Force", np.eye(2, 3)
        )

    def _add_slider(self, joint: SliderJoint) -> None:
        """Add a prismatic joint, on the ground as one equation between the displacements x and y of the body."""
        if self.plain or joint.host != GROUND:
            self._add_line(joint, turning=False)
            return
        nx, ny = -joint.along[1], joint.along[0]
        first, second, ratio = (0, 1, ny / nx) if abs(nx) >= abs(ny) else (1, 0, nx / ny)
        markers = [self._coordinate(joint.body, first), self._coordinate(joint.body, second) if ratio else self.fixed]
        item = self._object("ConnectorCoordinate", markerNumbers=markers, factor1=-ratio if ratio else 1.0)
        direction = np.zeros((2, 1))
        direction[first], direction[second] = 1.0, ratio
        self.joints[joint.name] = ForceOutput(item, "Force", direction)

    def _add_line(self, joint: GuidedJoint, *, turning: bool) -> None:
        """Add exudyn's prismatic joint; a pin in a slot is one without its condition on the angle."""
        turned = self.angles[joint.host] - self.angles[joint.body]
        (x, y), c, s = joint.along, math.cos(turned), math.sin(turned)
        item = self._object(
            "JointPrismatic2D",
            markerNumbers=[self._frame(joint.body, joint.anchor), self._frame(joint.host, joint.through)],
            axisMarker0=[c * x - s * y, s * x + c * y, 0.0],
            normalMarker1=[-y, x, 0.0],
            constrainRotation=not turning,
        )
        self.joints[joint.name] = ForceOutput(item, "ForceLocal", np.eye(2, 3), joint.body)

    def _add_loads(self) -> None:
        """Add the applied forces and torques; one that varies reads the crank angle at every evaluation."""
        for force in self.scene.forces:
            marker, law = self._point(force.body, force.anchor), plain_law(force.force)
            if force.force.is_constant:
                self._load("ForceVector", marker, loadVector=[*law, 0.0])
            else:
                self._load("ForceVector", marker, ("angle", law))
        for torque in self.scene.torques:
            if torque.body in self.turning:  # a torque does not move what cannot turn
                marker, law = self._coordinate(torque.body, ANGLE), plain_law(torque.torque)
                if torque.torque.is_constant:
                    self._load("Coordinate", marker, load=law[0])
                else:
                    self._load("Coordinate", marker, ("angle", law))

    def _add_springs(self) -> None:
        """Add the springs between points and the dampers between bodies."""
        for spring in self.scene.springs:
            ends = [self._point(spring.first, spring.first_anchor), self._point(spring.second, spring.second_anchor)]
            self._object(
                "ConnectorSpringDamper",
                markerNumbers=ends,
                stiffness=spring.stiffness,
                damping=spring.damping,
                referenceLength=spring.length,
            )
        for damper in self.scene.dampers:
            ends = [self._coordinate(damper.first, ANGLE), self._coordinate(damper.second, ANGLE)]
            if ends[0] != ends[1]:
                self._object("ConnectorCoordinateSpringDamper", markerNumbers=ends, damping=damper.coefficient)

    def _add_drive(self) -> None:
        """Add the drive: the item that holds a prescribed driver, or a free one's torque or force."""
        scene, drive = self.scene, self.scene.drive
        turns = scene.driver_kind is DriverKind.CRANK
        if isinstance(drive, Prescribed):
            if turns:
                self._object("ConnectorCoordinate", markerNumbers=[self.fixed, self._coordinate(scene.crank, ANGLE)])
            else:
                nodes = [self.nodes.get(body, self.ground) for body in scene.driver_ends[:2]]
                markers = [self._marker("NodeCoordinates", nodeNumber=node) for node in nodes]
                self._object("ConnectorCoordinateVector", ("gap", None), markerNumbers=markers)
            self.driver = len(self.items) - 1
            return
        times = drive.over_time and (drive.over_time.times, drive.over_time.torque)
        if turns:
            crank = self._coordinate(scene.crank, ANGLE)
            if drive.torque:
                self._load("Coordinate", crank, load=drive.torque)
            if times:
                self._load("Coordinate", crank, ("time", (0.0, times, [1.0])))
            return
        ends = [self._point(*end) for end in zip(scene.driver_ends[:2], scene.driver_ends[2:], strict=True)]
        if scene.cylinder is not None:
            pull = ("time", (drive.torque, times, [-1.0]))
            self._object("ConnectorSpringDamper", pull, markerNumbers=ends)
        else:
            self._load("ForceVector", ends[0], ("time", (drive.torque, times, [*scene.driven_slider.along, 0.0])))


def add_sensors(model: Model) -> dict[str, Any]:
    """Put sensors on a model for the channels its scene asks for, and tell them by what they measure."""
    channels = model.scene.channels
    motion = {
        channel: [model.sensor("Node", output, nodeNumber=node) for node in model.nodes.values()]
        for channel, output in COORDINATES.items()
        if channel in channels
    }
    joints = model.joints if Channel.JOINT_FORCE in channels else {}
    frames = {output.frame for output in joints.values()} - {GROUND}
    angles = dict(zip(model.nodes, motion.get(Channel.POSITION, ()), strict=False))
    for name in sorted(frames - angles.keys()):
        angles[name] = model.sensor("Node", "Coordinates", nodeNumber=model.nodes[name])
    torque = None
    if model.driver is not None and Channel.TORQUE in channels:
        number = sum(category == "Object" for category, *_ in model.items[: model.driver])
        torque = model.sensor("Object", "Force", objectNumber=number)
    forces = {
        name: (
            model.sensor("Object", output.output, objectNumber=output.item),
            output.matrix,
            None if output.frame == GROUND else (model.angles[output.frame], angles[output.frame]),
        )
        for name, output in joints.items()
    }
    return {
        "motion_sensors": motion, "torque_sensor": torque, "force_sensors": forces, "sensors": model.counts["Sensor"]
    }  # fmt: skip
