"""From a scene to an exudyn system: planar bodies, joints, loads and springs, with nothing the motion does not need.

A body that cannot turn is a point mass with two coordinates and a slider on the ground one equation between them: no
rotation, no inertia, and a quarter to a third less time than a rigid body in a prismatic joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import derivative
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.export.loads import law_told
from engines.export.transcript import Sourced
from engines.exudyn_adapter.linear_drive import LinearDrive
from engines.mechanics.states import start_motion
from engines.scene import Body, GuidedJoint, PinJoint, Prescribed, Scene, SliderJoint
from engines.stepping.intervals import Interval

Array = NDArray[np.float64]
Foreign: TypeAlias = Any  # an object of exudyn, which carries no types

COORDINATES = "exudyn.OutputVariableType.Coordinates"
ANGLE = 2  # number of the angle among the coordinates of a two-dimensional rigid body


@dataclass(frozen=True)
class ForceOutput:
    """Where exudyn reports a joint's force: ``matrix`` (2, k) turns its k values into the force on the first body.

    The result is in the frame of ``frame``, a body, or in the ground's.
    """

    item: Foreign
    output: str
    matrix: Array
    frame: str = GROUND


class Model:
    """An exudyn system of a scene and where to find things in it; the caller adds sensors and assembles it.

    ``plain`` builds it as a newcomer would, every link a rigid body. ``container`` is only held: without it the
    system's memory is given back and every size silently reads zero. ``driver`` is the item that holds a prescribed
    crank, its functions of time still to be set; None for a free one.
    """

    def __init__(self, scene: Scene, *, plain: bool = False) -> None:
        import exudyn
        from exudyn import itemInterface

        self.exudyn: Foreign = exudyn
        self.items: Foreign = itemInterface
        self.container: Foreign = exudyn.SystemContainer()
        self.mbs: Foreign = self.container.AddSystem()
        self.scene, self.plain = scene, plain
        self.nodes: dict[str, Foreign] = {}
        self.objects: dict[str, Foreign] = {GROUND: self._object("Ground")}
        self.angles = {GROUND: 0.0, **{body.name: body.angle for body in scene.bodies}}
        self.turning: set[str] = set()
        self.joints: dict[str, ForceOutput] = {}
        self.ground = self.mbs.AddNode(itemInterface.NodePointGround())
        self.fixed = self._marker("NodeCoordinate", nodeNumber=self.ground, coordinate=0)
        for body in scene.bodies:
            self._add_body(body)
        for pin in scene.pins:
            self._add_pin(pin)
        for slider in scene.sliders:
            self._add_slider(slider)
        for slot in scene.slots:
            self._add_line(slot, turning=True)
        self.linear = None if scene.driver_kind is DriverKind.CRANK else LinearDrive(self)
        self._add_loads()
        self._add_springs()
        self.driver = self._add_drive()
        # Which of x, y and angle of every body are coordinates of the system, in whose order they are.
        self.free = np.array([(True, True, body.name in self.turning) for body in scene.bodies])
        self.begin = 0.0  # the time at which exudyn's is 0, s
        self.unwound = np.zeros(self.free.shape)  # whole turns, rad, that have been taken off the angles
        # Of every part so far: the polynomial of the crank's coordinate, lowest power first, the state it started
        # from, and what had been unwound.
        self.starts: list[tuple[list[float], tuple[Array, ...], Array]] = []

    def start(self, order: int) -> Array:
        """Start values of all coordinates, or their time derivatives of order 1 or 2, in exudyn's order."""
        values = start_motion(self.scene)[order][0, :-1][self.free]
        return np.asarray(values if order else np.zeros_like(values))  # coordinates are displacements from the start

    def unwind(self, position: Array) -> Array:
        """Coordinates without the whole turns of their angles.

        On position level accelerations and forces carry the rounding of angles and times over the square of the step,
        which would grow with them: 2e-5 of the torque's peak after 300 turns.
        """
        whole = np.zeros_like(self.unwound)
        whole[self.free] = position
        whole = np.round(whole / FULL_TURN) * FULL_TURN * (0.0, 0.0, 1.0)
        self.unwound += whole
        return np.asarray(position - whole[self.free])

    @property
    def crank_origin(self) -> float:
        """The crank angle φ at which the crank's coordinate is 0, rad; a linear driver has no coordinate but φ."""
        if self.linear is not None:
            return 0.0
        return self.scene.crank_angle + float(self.unwound[list(self.nodes).index(self.scene.crank), ANGLE])

    def set_drive(self, part: Interval) -> None:
        """Let the solver itself run the crank's angle and speed over the time since the start of a part.

        Python functions take a third more time.
        """
        from exudyn.advancedUtilities import CreateSymbolicUserFunction as Symbolic

        self.begin = part.start
        terms = self.drive_terms(part)
        if self.linear is not None:
            rates = [derivative(tuple(terms), order) for order in range(2)]
            self.linear.travel = lambda t, order: reduce(lambda total, term: total * t + term, rates[order])
            return
        self._functions = []  # exudyn does not keep them alive itself
        for order, name in enumerate(("offsetUserFunction", "offsetUserFunction_t")):
            self._functions.append(Symbolic(self.mbs, _polynomial(derivative(tuple(terms), order)), name, self.driver))
            self.mbs.SetObjectParameter(self.driver, name, self._functions[-1])

    def drive_terms(self, part: Interval) -> list[float]:
        """The crank's coordinate as a polynomial of the time since the start of a part, lowest power first."""
        if part.segment is None:
            return []
        terms = [
            float(part.segment.value(part.start, order)) / math.factorial(order)
            for order in range(len(part.segment.coefficients))
        ]
        terms[0] -= self.crank_origin
        return terms

    def hold_drive(self, angle: float) -> None:
        """Keep the crank at an angle, rad, or a linear driver at a travel."""
        if self.linear is not None:
            self.linear.travel = lambda _time, _order: angle
            return
        self.mbs.SetObjectParameter(self.driver, "offsetUserFunction", 0)
        self.mbs.SetObjectParameter(self.driver, "offset", angle - self.crank_origin)

    def _object(self, kind: str, **data: Foreign) -> Foreign:
        return self.mbs.AddObject(getattr(self.items, f"Object{kind}")(**data))

    def _marker(self, kind: str, **data: Foreign) -> Foreign:
        return self.mbs.AddMarker(getattr(self.items, f"Marker{kind}")(**data))

    def _load(self, kind: str, marker: Foreign, **data: Foreign) -> None:
        self.mbs.AddLoad(getattr(self.items, f"Load{kind}")(markerNumber=marker, **data))

    def _coordinate(self, body: str, number: int) -> Foreign:
        """Marker of one coordinate of a body; the ground's for what does not move."""
        if body == GROUND or (number == ANGLE and body not in self.turning):
            return self.fixed
        return self._marker("NodeCoordinate", nodeNumber=self.nodes[body], coordinate=number)

    def _point(self, body: str, anchor: Vector) -> Foreign:
        """Marker of a point of a body."""
        x, y = anchor
        if body != GROUND and body not in self.turning:  # a point mass has no frame of its own
            c, s = math.cos(self.angles[body]), math.sin(self.angles[body])
            x, y = c * x - s * y, s * x + c * y
        return self._marker("BodyPosition", bodyNumber=self.objects[body], localPosition=[x, y, 0.0])

    def _frame(self, body: str, anchor: Vector) -> Foreign:
        """Marker of a point of a body together with the body's orientation."""
        return self._marker("BodyRigid", bodyNumber=self.objects[body], localPosition=[*anchor, 0.0])

    def _add_body(self, body: Body) -> None:
        """Add a body, with its weight if it has any."""
        joints = [joint for joint in self.scene.sliders if joint.body == body.name]
        straight = body.inertia is None or any(joint.host == GROUND for joint in joints)
        if straight and not self.plain and not self._needs_frame(body.name):
            node = self.items.NodePoint2D(referenceCoordinates=[*body.position], initialVelocities=[*body.velocity])
            shape, inertia = "MassPoint2D", {}
        else:
            node = self.items.NodeRigidBody2D(
                referenceCoordinates=[*body.position, body.angle],
                initialVelocities=[*body.velocity, body.angular_velocity],
            )
            shape, inertia = "RigidBody2D", {"inertia": body.inertia or 0.0}
            self.turning.add(body.name)
        self.nodes[body.name] = number = self.mbs.AddNode(node)
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
            marker = self._point(force.body, force.anchor)
            self._add_law("ForceVector", marker, "loadVector", force.force, lambda value: [*value, 0.0])
        for torque in self.scene.torques:
            if torque.body in self.turning:  # a torque does not move what cannot turn
                marker = self._coordinate(torque.body, ANGLE)
                self._add_law("Coordinate", marker, "load", torque.torque, lambda value: value[0])

    def _add_law(
        self, kind: str, marker: Foreign, name: str, law: Law, shaped: Callable[[Sequence[float]], Foreign]
    ) -> None:
        """Add a load; ``shaped`` brings its components into exudyn's form."""
        if law.is_constant:
            self._load(kind, marker, **{name: shaped(law.values.tolist())})
            return
        over_turn = self._over_turn(law)
        told = self._over_turn_told(law, "[*{}, 0.0]" if len(law.values.T) > 1 else "{}[0]")
        function = Sourced(lambda mbs, t, _load: shaped(over_turn(mbs, t)), told)
        self._load(kind, marker, **{f"{name}UserFunction": function})

    def _over_turn(self, law: Law) -> Callable[[Foreign, float], tuple[float, ...]]:
        """A load as a function of system and time; a prescribed crank's angle is a matter of the time alone."""
        value, drive = law.of_float(), self.scene.drive
        if isinstance(drive, Prescribed):
            at_time = lru_cache(maxsize=1)(lambda t: value(_crank_angle(drive, t)))  # evaluated at every iteration
            return lambda _mbs, t: at_time(self.begin + t)
        linear = self.linear
        if linear is not None:
            return lambda mbs, _t: value(linear.reached(mbs))
        start, node = self.scene.crank_angle, self.nodes[self.scene.crank]
        coordinates = self.exudyn.OutputVariableType.Coordinates
        return lambda mbs, _t: value(start + mbs.GetNodeOutput(node, coordinates)[ANGLE])

    def _over_turn_told(self, law: Law, shape: str) -> str:
        """The same as Python source, in a shape; ``begin`` is the time at which exudyn's is 0."""
        drive, start = self.scene.drive, self.scene.crank_angle
        if self.linear is not None:
            return ""  # no script has a linear drive
        angle = f"{start!r} + mbs.GetNodeOutput({self.nodes[self.scene.crank]}, {COORDINATES})[2]"
        if isinstance(drive, Prescribed):
            angle = _angle_told(drive, "(begin + t)")
        return f"lambda mbs, t, load: {shape.format(f'at_angle({law_told(law)}, {angle})')}"

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

    def _add_drive(self) -> Foreign | None:
        """Add the drive; returns the item that holds a prescribed crank."""
        drive = self.scene.drive
        if self.linear is not None:
            return self.linear.add(drive)
        crank = self._coordinate(self.scene.crank, ANGLE)
        if isinstance(drive, Prescribed):
            driver = self._object("ConnectorCoordinate", markerNumbers=[self.fixed, crank])
            if self.plain:
                start = self.scene.crank_angle
                self.mbs.SetObjectParameter(driver, "offsetUserFunction", Sourced(
                    lambda _mbs, t, _item, _offset: _crank_angle(drive, t) - start,
                    f"lambda mbs, t, item, offset: {_angle_told(drive)} - {start!r}",
                ))  # fmt: skip
            return driver
        if drive.torque:
            self._load("Coordinate", crank, load=drive.torque)
        if drive.over_time is not None:
            at_time = drive.over_time.at
            self._load("Coordinate", crank, loadUserFunction=lambda _mbs, t, _load: at_time(self.begin + t))
        return None


def _crank_angle(drive: Prescribed, time: float) -> float:
    """φ at any time of a motion, rad."""
    segments = drive.motion.segments
    return float(next((s for s in segments if time <= s.end), segments[-1]).value(time))


def _angle_told(drive: Prescribed, time: str = "t") -> str:
    """φ at a time as Python source."""
    told = ""
    for number, segment in enumerate(drive.motion.segments, 1 - len(drive.motion.segments)):
        total = ""
        for coefficient in reversed(segment.coefficients):
            total = f"({total} * ({time} - {segment.start!r}) + {coefficient!r})" if total else repr(coefficient)
        told += f"{total} if {time} <= {segment.end!r} else " if number else total
    return f"({told})"


def _polynomial(coefficients: Sequence[float]) -> Callable[..., Foreign]:
    """A polynomial, highest power first, in the form exudyn asks a function of time to have."""

    def value(_mbs: Foreign, t: Foreign, _item: Foreign, _offset: Foreign) -> Foreign:
        result = coefficients[0] + 0.0 * t  # a symbolic function has to return a symbolic
        for coefficient in coefficients[1:]:
            result = result * t + coefficient
        return result

    return value
