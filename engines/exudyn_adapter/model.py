"""From a scene to an exudyn system: a rigid body for every link, joints, loads, springs and the drive."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import numpy as np

from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.mechanics.states import start_motion
from engines.scene import Body, Channel, GuidedJoint, PinJoint, Prescribed, Scene, SliderJoint
from engines.stepping.loop_engine import plain_law

ANGLE = 2  # number of the angle among the coordinates of a two-dimensional rigid body
USER_FUNCTIONS = {"ForceVector": "loadVectorUserFunction", "Coordinate": "loadUserFunction"}  # of loads
COORDINATES = {
    Channel.POSITION: "Coordinates",
    Channel.VELOCITY: "Coordinates_t",
    Channel.ACCELERATION: "Coordinates_tt",
}


class ExudynModel:
    """The items of an exudyn system of a scene and where to find things in it, in the order of their making.

    An item is its category, its kind and its data as exudyn has them, and what of it is a function, as the loop has it.
    ``driver`` is the number, among the objects, of the one that holds a prescribed driver; None for a free one.
    """

    def __init__(self, scene: Scene) -> None:
        self.items: list[tuple[str, str, dict[str, Any], tuple[str, str, Any] | None]] = []
        self.counts: Counter[str] = Counter()
        self.scene = scene
        self.nodes: dict[str, int] = {}
        self.objects: dict[str, int] = {GROUND: self._add_object("Ground")}
        self.angles = {GROUND: 0.0, **{body.name: body.angle for body in scene.bodies}}
        self.joints: dict[str, tuple[int, str | None]] = {}  # item, and the body in whose frame its force is, or None
        self.ground = self._add_item("Node", "PointGround", {})
        self.fixed = self._add_marker("NodeCoordinate", nodeNumber=self.ground, coordinate=0)
        for body in scene.bodies:
            self._add_body(body)
        for pin in scene.pins:
            self._add_pin(pin)
        for joint in scene.guided:
            self._add_line(joint)
        self._add_loads()
        self._add_springs()
        self.driver: int | None = None
        self._add_drive()

    def as_data(self) -> dict[str, Any]:
        """The system in plain data, its sensors among the items."""
        scene = self.scene
        segments = scene.drive.motion.segments if isinstance(scene.drive, Prescribed) else ()
        states = [values[0, :-1].ravel() for values in start_motion(scene)]
        states[0] = np.zeros_like(states[0])  # coordinates are displacements from the start
        bodies, linear = [body.name for body in scene.bodies], None
        if scene.driver_kind is not DriverKind.CRANK:  # nodes, None of the ground, and anchors of its ends
            ends = zip(scene.driver_ends[:2], scene.driver_ends[2:], strict=True)
            linear = {
                "ends": [(self.nodes.get(body), complex(*anchor)) for body, anchor in ends],
                "along": None if scene.cylinder else complex(*scene.driven_slider.along),
            }
        return {
            **add_sensors(self),
            "items": self.items,
            "driver": self.driver,
            "linear": linear,
            "crank": bodies.index(scene.crank) if scene.crank in bodies else None,
            "crank_node": self.nodes.get(scene.crank),
            "start": scene.crank_angle,
            "motion": [(segment.start, segment.end, segment.coefficients) for segment in segments],
            "states": states,
            "poses": [(*body.position, body.angle) for body in scene.bodies],
        }

    def _add_item(self, category: str, kind: str, data: dict[str, Any], law: tuple[str, str, Any] | None = None) -> int:
        """Number of a new item in its category."""
        self.items.append((category, kind, data, law))
        self.counts[category] += 1
        return self.counts[category] - 1

    def add_sensor(self, kind: str, output: str, **data: int) -> int:
        """Number of a new sensor on a node or an object."""
        return self._add_item("Sensor", kind, {**data, "outputVariableType": output, "storeInternal": True})

    def _add_object(self, kind: str, law: tuple[str, str, Any] | None = None, **data: Any) -> int:  # noqa: ANN401
        return self._add_item("Object", kind, data, law)

    def _add_marker(self, kind: str, **data: Any) -> int:  # noqa: ANN401
        return self._add_item("Marker", kind, data)

    def _add_load(self, kind: str, marker: int, law: tuple[str, str, Any] | None = None, **data: Any) -> None:  # noqa: ANN401
        self._add_item("Load", kind, {"markerNumber": marker, **data}, law)

    def _angle_marker(self, body: str) -> int:
        """Marker of a body's angle, or of the ground's."""
        if body == GROUND:
            return self.fixed
        return self._add_marker("NodeCoordinate", nodeNumber=self.nodes[body], coordinate=ANGLE)

    def _point_marker(self, body: str, anchor: Vector) -> int:
        """Marker of a point of a body together with the body's orientation."""
        return self._add_marker("BodyRigid", bodyNumber=self.objects[body], localPosition=[*anchor, 0.0])

    def _add_body(self, body: Body) -> None:
        """Add a body, with its weight if it has any; one that cannot turn needs no inertia."""
        place, rate = [*body.position, body.angle], [*body.velocity, body.angular_velocity]
        number = self._add_item("Node", "RigidBody2D", {"referenceCoordinates": place, "initialVelocities": rate})
        self.nodes[body.name], inertia = number, body.inertia or 0.0
        self.objects[body.name] = self._add_object("RigidBody2D", mass=body.mass, inertia=inertia, nodeNumber=number)
        if body.inertia is None and body.name not in {joint.body for joint in self.scene.sliders}:
            self._add_object("ConnectorCoordinate", markerNumbers=[self.fixed, self._angle_marker(body.name)])
        if any(self.scene.gravity) and body.mass > 0.0:
            marker = self._add_marker("BodyMass", bodyNumber=self.objects[body.name])
            self._add_load("MassProportional", marker, loadVector=[*self.scene.gravity, 0.0])

    def _add_pin(self, pin: PinJoint) -> None:
        """Add a revolute joint; exudyn reports the force on its first marker's body, in the ground frame."""
        markers = [self._point_marker(pin.first, pin.first_anchor), self._point_marker(pin.second, pin.second_anchor)]
        self.joints[pin.name] = self._add_object("JointRevolute2D", markerNumbers=markers), None

    def _add_line(self, joint: GuidedJoint) -> None:
        """Add exudyn's prismatic joint; a pin in a slot is one without its condition on the angle."""
        turned = self.angles[joint.host] - self.angles[joint.body]
        (x, y), c, s = joint.along, math.cos(turned), math.sin(turned)
        item = self._add_object(
            "JointPrismatic2D",
            markerNumbers=[self._point_marker(joint.body, joint.anchor), self._point_marker(joint.host, joint.through)],
            axisMarker0=[c * x - s * y, s * x + c * y, 0.0],
            normalMarker1=[-y, x, 0.0],
            constrainRotation=isinstance(joint, SliderJoint),
        )
        self.joints[joint.name] = item, joint.body

    def _add_loads(self) -> None:
        """Add the applied forces and torques; one that varies reads φ at every evaluation."""
        loads = [("ForceVector", self._point_marker(load.body, load.anchor), load.force) for load in self.scene.forces]
        loads += [("Coordinate", self._angle_marker(load.body), load.torque) for load in self.scene.torques]
        for kind, marker, law in loads:
            values = plain_law(law)
            if not law.is_constant:
                self._add_load(kind, marker, ("angle", USER_FUNCTIONS[kind], values))
            elif kind == "ForceVector":
                self._add_load(kind, marker, loadVector=[*values, 0.0])
            else:
                self._add_load(kind, marker, load=values[0])

    def _add_springs(self) -> None:
        """Add the springs between points and the dampers between bodies."""
        for spring in self.scene.springs:
            ends = [
                self._point_marker(spring.first, spring.first_anchor),
                self._point_marker(spring.second, spring.second_anchor),
            ]
            self._add_object(
                "ConnectorSpringDamper",
                markerNumbers=ends,
                stiffness=spring.stiffness,
                damping=spring.damping,
                referenceLength=spring.length,
            )
        for damper in self.scene.dampers:
            ends = [self._angle_marker(damper.first), self._angle_marker(damper.second)]
            self._add_object("ConnectorCoordinateSpringDamper", markerNumbers=ends, damping=damper.coefficient)

    def _add_drive(self) -> None:
        """Add the drive: the item that holds a prescribed driver, or a free one's torque or force."""
        scene, drive = self.scene, self.scene.drive
        turns = scene.driver_kind is DriverKind.CRANK
        if isinstance(drive, Prescribed):
            if turns:
                markers = [self.fixed, self._angle_marker(scene.crank)]
                self.driver = self._add_object("ConnectorCoordinate", markerNumbers=markers)
            else:
                nodes = [self.nodes.get(body, self.ground) for body in scene.driver_ends[:2]]
                markers = [self._add_marker("NodeCoordinates", nodeNumber=node) for node in nodes]
                self.driver = self._add_object("ConnectorCoordinateVector", ("gap", "", None), markerNumbers=markers)
            return
        times = drive.over_time and (drive.over_time.times, drive.over_time.torque)
        if turns:
            crank = self._angle_marker(scene.crank)
            if drive.torque:
                self._add_load("Coordinate", crank, load=drive.torque)
            if times:
                self._add_load("Coordinate", crank, ("time", USER_FUNCTIONS["Coordinate"], (0.0, times, [1.0])))
            return
        ends = [self._point_marker(*end) for end in zip(scene.driver_ends[:2], scene.driver_ends[2:], strict=True)]
        if scene.cylinder is not None:
            pull = ("time", "springForceUserFunction", (drive.torque, times, [-1.0]))
            self._add_object("ConnectorSpringDamper", pull, markerNumbers=ends)
        else:
            push = (drive.torque, times, [*scene.driven_slider.along])
            self._add_load("ForceVector", ends[0], ("time", USER_FUNCTIONS["ForceVector"], push))


def add_sensors(model: ExudynModel) -> dict[str, Any]:
    """Add sensors for the scene's channels to a model; returns their numbers by what they measure."""
    channels = model.scene.channels
    motion = {
        channel: [model.add_sensor("Node", output, nodeNumber=node) for node in model.nodes.values()]
        for channel, output in COORDINATES.items()
        if channel in channels
    }
    torque = None
    if model.driver is not None and Channel.TORQUE in channels:
        torque = model.add_sensor("Object", "Force", objectNumber=model.driver)
    forces = {}
    for name, (item, frame) in model.joints.items() if Channel.JOINT_FORCE in channels else ():
        turned = None
        if frame in model.nodes:
            turned = model.angles[frame], model.add_sensor("Node", "Coordinates", nodeNumber=model.nodes[frame])
        forces[name] = model.add_sensor("Object", "ForceLocal" if frame else "Force", objectNumber=item), turned
    return {
        "motion_sensors": motion, "torque_sensor": torque, "force_sensors": forces, "sensors": model.counts["Sensor"]
    }  # fmt: skip
