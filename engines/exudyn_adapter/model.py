"""From a scene to an exudyn system: planar bodies, joints, loads and springs, with nothing the motion does not need.

A body that cannot turn is a point mass with two coordinates and a slider on the ground one equation between them: no
rotation, no inertia, and a quarter to a third less time than a rigid body in a prismatic joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Vector
from engines.exudyn_adapter.drive import Foreign, crank_angle
from engines.scene import Body, Free, PinJoint, Prescribed, Scene, SliderJoint, SlotJoint

Array = NDArray[np.float64]

ANGLE = 2  # number of the angle among the coordinates of a two-dimensional rigid body


@dataclass(frozen=True)
class ForceOutput:
    """Where exudyn reports a joint's force: ``matrix`` (2, k) turns its k values into the force on the first body.

    The result is in the frame of ``frame``, a body, or in the ground's.
    """

    item: int
    output: str
    matrix: Array
    frame: str = GROUND


@dataclass(frozen=True)
class Model:
    """An exudyn system and where to find things in it.

    ``container`` is only held: without it the system's memory is given back and every size silently reads zero.
    """

    exudyn: Foreign
    container: Foreign
    mbs: Foreign
    scene: Scene
    nodes: Mapping[str, int]
    turning: frozenset[str]
    driver: Foreign | None
    joints: Mapping[str, ForceOutput]

    def start(self, order: int) -> Array:
        """Start values of all coordinates, or their time derivatives of order 1 or 2, in exudyn's order."""
        if order == 0:  # coordinates are displacements from the start
            return np.zeros(sum(3 if body.name in self.turning else 2 for body in self.scene.bodies))
        parts = []
        for body in self.scene.bodies:
            vector, angular = (
                (body.velocity, body.angular_velocity) if order == 1 else (body.acceleration, body.angular_acceleration)
            )
            parts += [*vector, angular] if body.name in self.turning else [*vector]
        return np.array(parts)


@dataclass
class Assembly:
    """A system being put together; ``plain`` builds it as a newcomer would, every link a rigid body."""

    scene: Scene
    plain: bool
    nodes: dict[str, int] = field(default_factory=dict)
    objects: dict[str, int] = field(default_factory=dict)
    turning: set[str] = field(default_factory=set)
    joints: dict[str, ForceOutput] = field(default_factory=dict)

    def __post_init__(self) -> None:
        import exudyn
        from exudyn import itemInterface

        self.exudyn: Foreign = exudyn
        self.items: Foreign = itemInterface
        self.container: Foreign = exudyn.SystemContainer()
        self.mbs: Foreign = self.container.AddSystem()
        self.objects[GROUND] = self.mbs.AddObject(itemInterface.ObjectGround())
        node = self.mbs.AddNode(itemInterface.NodePointGround())
        self.fixed = self.mbs.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=0))

    def coordinate(self, body: str, number: int) -> int:
        """Marker of one coordinate of a body; the ground's for what does not move."""
        if body == GROUND or (number == ANGLE and body not in self.turning):
            return int(self.fixed)
        marker = self.items.MarkerNodeCoordinate(nodeNumber=self.nodes[body], coordinate=number)
        return int(self.mbs.AddMarker(marker))

    def point(self, body: str, anchor: Vector) -> int:
        """Marker of a point of a body."""
        marker = self.items.MarkerBodyPosition(bodyNumber=self.objects[body], localPosition=self._local(body, anchor))
        return int(self.mbs.AddMarker(marker))

    def frame(self, body: str, anchor: Vector) -> int:
        """Marker of a point of a body together with the body's orientation."""
        marker = self.items.MarkerBodyRigid(bodyNumber=self.objects[body], localPosition=[*anchor, 0.0])
        return int(self.mbs.AddMarker(marker))

    def _local(self, body: str, anchor: Vector) -> list[float]:
        if body == GROUND or body in self.turning:
            return [*anchor, 0.0]
        angle = next(b.angle for b in self.scene.bodies if b.name == body)  # a point mass has no frame of its own
        c, s = math.cos(angle), math.sin(angle)
        return [c * anchor[0] - s * anchor[1], s * anchor[0] + c * anchor[1], 0.0]

    def add_body(self, body: Body) -> None:
        """Add a body, with its weight if it has any."""
        joints = [joint for joint in self.scene.sliders if joint.body == body.name]
        straight = body.inertia is None or any(joint.host == GROUND for joint in joints)
        if straight and not self.plain and not self._needs_frame(body.name):
            node = self.items.NodePoint2D(referenceCoordinates=[*body.position], initialVelocities=[*body.velocity])
            self.nodes[body.name] = number = self.mbs.AddNode(node)
            shape = self.items.ObjectMassPoint2D(mass=body.mass, nodeNumber=number)
        else:
            node = self.items.NodeRigidBody2D(
                referenceCoordinates=[*body.position, body.angle],
                initialVelocities=[*body.velocity, body.angular_velocity],
            )
            self.nodes[body.name] = number = self.mbs.AddNode(node)
            shape = self.items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia or 0.0, nodeNumber=number)
            self.turning.add(body.name)
        self.objects[body.name] = self.mbs.AddObject(shape)
        if straight and body.name in self.turning and not self._turned_by_joint(joints):
            lock = [self.fixed, self.coordinate(body.name, ANGLE)]
            self.mbs.AddObject(self.items.ObjectConnectorCoordinate(markerNumbers=lock))
        if any(self.scene.gravity) and body.mass > 0.0:
            marker = self.mbs.AddMarker(self.items.MarkerBodyMass(bodyNumber=self.objects[body.name]))
            weight = self.items.LoadMassProportional(markerNumber=marker, loadVector=[*self.scene.gravity, 0.0])
            self.mbs.AddLoad(weight)

    def _needs_frame(self, body: str) -> bool:
        """Whether a joint asks for the body's orientation, which a point mass cannot give."""
        fixed = [joint for joint in self.scene.sliders if joint.host == GROUND]
        asking = [joint for joint in self.scene.guided if joint not in fixed]
        return any(body in (joint.host, joint.body) for joint in asking)

    def _turned_by_joint(self, joints: list[SliderJoint]) -> bool:
        """Whether a prismatic joint already holds the body's angle."""
        return any(self.plain or joint.host != GROUND for joint in joints)

    def add_pin(self, pin: PinJoint) -> None:
        """Add a revolute joint; exudyn reports the force on its first marker's body, in the ground frame."""
        markers = [self.point(pin.first, pin.first_anchor), self.point(pin.second, pin.second_anchor)]
        item = self.mbs.AddObject(self.items.ObjectJointRevolute2D(markerNumbers=markers))
        self.joints[pin.name] = ForceOutput(item, "Force", np.eye(2, 3))

    def add_slider(self, joint: SliderJoint) -> None:
        """Add a prismatic joint, on the ground as one equation between the displacements x and y of the body."""
        if self.plain or joint.host != GROUND:
            self._add_line(joint, turning=False)
            return
        nx, ny = -joint.along[1], joint.along[0]
        first, second, ratio = (0, 1, ny / nx) if abs(nx) >= abs(ny) else (1, 0, nx / ny)
        markers = [
            self.coordinate(joint.body, first),
            self.coordinate(joint.body, second) if ratio else self.fixed,
        ]
        equation = self.items.ObjectConnectorCoordinate(markerNumbers=markers, factor1=-ratio if ratio else 1.0)
        direction = np.zeros((2, 1))
        direction[first], direction[second] = 1.0, ratio
        self.joints[joint.name] = ForceOutput(self.mbs.AddObject(equation), "Force", direction)

    def add_slot(self, joint: SlotJoint) -> None:
        """Add a pin in a slot: exudyn's prismatic joint without its condition on the angle."""
        self._add_line(joint, turning=True)

    def _add_line(self, joint: SliderJoint | SlotJoint, *, turning: bool) -> None:
        angles = {body.name: body.angle for body in self.scene.bodies}
        turned = angles.get(joint.host, 0.0) - angles.get(joint.body, 0.0)
        (x, y), c, s = joint.along, math.cos(turned), math.sin(turned)
        item = self.items.ObjectJointPrismatic2D(
            markerNumbers=[self.frame(joint.body, joint.anchor), self.frame(joint.host, joint.through)],
            axisMarker0=[c * x - s * y, s * x + c * y, 0.0],
            normalMarker1=[-y, x, 0.0],
            constrainRotation=not turning,
        )
        self.joints[joint.name] = ForceOutput(self.mbs.AddObject(item), "ForceLocal", np.eye(2, 3), joint.body)

    def add_loads(self) -> None:
        """Add the applied forces and torques; one that varies reads the crank angle at every evaluation."""
        for force in self.scene.forces:
            marker = self.point(force.body, force.anchor)
            if force.force.is_constant:
                vector = [float(component) for component in force.force.values]
                load = self.items.LoadForceVector(markerNumber=marker, loadVector=[*vector, 0.0])
            else:
                load = self.items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=self._vector(force.force))
            self.mbs.AddLoad(load)
        for torque in self.scene.torques:
            if torque.body not in self.turning:
                continue  # a torque does not move what cannot turn
            marker = self.coordinate(torque.body, ANGLE)
            if torque.torque.is_constant:
                load = self.items.LoadCoordinate(markerNumber=marker, load=float(torque.torque.values[0]))
            else:
                load = self.items.LoadCoordinate(markerNumber=marker, loadUserFunction=self._first(torque.torque))
            self.mbs.AddLoad(load)

    def _over_turn(self, law: Law) -> Callable[[Foreign, float, Foreign], tuple[float, ...]]:
        """A load's function in exudyn's form; a prescribed crank's angle is a matter of the time alone."""
        value, drive = law.of_float(), self.scene.drive
        if isinstance(drive, Prescribed):
            segments = drive.motion.segments
            at_time = lru_cache(maxsize=1)(lambda t: value(crank_angle(segments, t)))  # asked for at every iteration
            return lambda _mbs, t, _load: at_time(t)
        start, node = self.scene.crank_angle, self.nodes[self.scene.crank]
        coordinates = self.exudyn.OutputVariableType.Coordinates
        return lambda mbs, _t, _load: value(start + mbs.GetNodeOutput(node, coordinates)[ANGLE])

    def _vector(self, law: Law) -> Callable[[Foreign, float, Foreign], list[float]]:
        over_turn = self._over_turn(law)
        return lambda mbs, t, load: [*over_turn(mbs, t, load), 0.0]  # exudyn's vectors are three-dimensional

    def _first(self, law: Law) -> Callable[[Foreign, float, Foreign], float]:
        over_turn = self._over_turn(law)
        return lambda mbs, t, load: over_turn(mbs, t, load)[0]

    def add_springs(self) -> None:
        """Add the springs between points and the dampers between bodies."""
        for spring in self.scene.springs:
            ends = [self.point(spring.first, spring.first_anchor), self.point(spring.second, spring.second_anchor)]
            item = self.items.ObjectConnectorSpringDamper(
                markerNumbers=ends, stiffness=spring.stiffness, damping=spring.damping, referenceLength=spring.length
            )
            self.mbs.AddObject(item)
        for damper in self.scene.dampers:
            markers = [self.coordinate(damper.first, ANGLE), self.coordinate(damper.second, ANGLE)]
            if markers[0] != markers[1]:
                item = self.items.ObjectConnectorCoordinateSpringDamper(
                    markerNumbers=markers, damping=damper.coefficient
                )
                self.mbs.AddObject(item)

    def add_drive(self) -> Foreign | None:
        """Add the drive; returns the item that holds a prescribed crank, its functions of time still to be set."""
        crank = self.coordinate(self.scene.crank, ANGLE)
        drive = self.scene.drive
        if isinstance(drive, Free):
            if drive.torque:
                self.mbs.AddLoad(self.items.LoadCoordinate(markerNumber=crank, load=drive.torque))
            return None
        return self.mbs.AddObject(self.items.ObjectConnectorCoordinate(markerNumbers=[self.fixed, crank]))


def build_model(scene: Scene, *, plain: bool = False) -> Model:
    """Put the scene together; the caller adds its sensors and then calls ``mbs.Assemble()``."""
    assembly = Assembly(scene, plain)
    for body in scene.bodies:
        assembly.add_body(body)
    for pin in scene.pins:
        assembly.add_pin(pin)
    for slider in scene.sliders:
        assembly.add_slider(slider)
    for slot in scene.slots:
        assembly.add_slot(slot)
    assembly.add_loads()
    assembly.add_springs()
    driver = assembly.add_drive()
    return Model(
        assembly.exudyn,
        assembly.container,
        assembly.mbs,
        scene,
        assembly.nodes,
        frozenset(assembly.turning),
        driver,
        assembly.joints,
    )
