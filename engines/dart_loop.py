"""One pass in DART: bodies that move freely in the plane, joined by constraints that act on probes without weight.

Data are the adapter's ``model``, in SI or the scene's own units. A course has one part of the motion, with its ``end``,
s, and a number of ``samples``, ``ratio`` steps to a sample, and the ``channels`` to record.
"""

from typing import Any

import dartpy as dart
import numpy as np
from numpy.typing import NDArray

from engines.shared_loop import motion_values, signals

Array = NDArray[np.float64]
Data = dict[str, Any]

TINY = 1e-15  # of what weighs nothing, in units in which a link weighs some 1e-3: DART takes no body without a mass
SHIPPED, WHOLE = (0.01, 10.0), (1.0, 1e9)  # the share of a joint's gap that a step closes, and its largest speed


class DartWorld:
    """A world of one time step in its start state; ``half`` a step is its velocities' lead over its positions, s.

    Every body is a skeleton of its own with the coordinates x, y and angle; probes on it have those that follow.
    ``bodies`` has the nodes by name, the ground's last. ``forces`` has for every joint of the scene its probe, the row
    of the body that carries it, the direction of the probe's frame there, and the force's sign.
    """

    def __init__(self, given: Data, step: float) -> None:
        """Build DART's world from the adapter's model; ``step`` is in s."""
        self.given, self.world, self.half = given, dart.simulation.World(), 0.5 * step * given["centred"]
        self.world.setTimeStep(step)
        self.world.setGravity([*given["gravity"], 0.0])
        options = self.world.getDeactivationOptions()
        options.mEnabled = not given["centred"]  # as shipped, what hardly moves falls asleep
        self.world.setDeactivationOptions(options)
        self.bodies = {name: self.new_body(name, *weights) for name, *weights in given["bodies"]}
        self.skeletons = [body.getSkeleton() for body in self.bodies.values()]
        self.start, self.rates, changes = (np.array(each)[0, :-1] for each in given["start"])
        speeds = self.rates - self.half * changes  # the rates of a step are those of its middle
        for skeleton, place, speed in zip(self.skeletons, self.start, speeds, strict=True):
            skeleton.setPositions(place)
            skeleton.setVelocities(speed)
        self.turns = {name: body.getParentJoint() for name, body in self.bodies.items()}
        self.turns[given["crank"]].setActuatorType(dart.dynamics.ActuatorType.VELOCITY)
        _, self.bodies["ground"] = self.attach(dart.dynamics.Skeleton("ground"), "WeldJoint")
        self.forces = dict[str, tuple[Any, int, complex, float]]()
        constraints = [self.new_joint(*joint) for joint in given["joints"]]
        for body in self.bodies.values():
            self.world.addSkeleton(body.getSkeleton())
        for constraint in constraints:  # what is set holds for every constraint of the process until it is set anew
            share, fastest = WHOLE if given["centred"] else SHIPPED
            constraint.setErrorReductionParameter(share)
            constraint.setMaxErrorReductionVelocity(fastest)
            self.world.getConstraintSolver().addConstraint(constraint)

    def attach(self, parent: Any, kind: str, mass: float = TINY, inertia: float = TINY) -> tuple[Any, Any]:  # noqa: ANN401
        """Create a joint and a body (kg, kg m²) on a parent, or on the ground for an empty skeleton; returns both.

        ``kind`` is DART's name of the joint's type, such as "WeldJoint".
        """
        joint, body = getattr(parent, f"create{kind}AndBodyNodePair")()
        body.setInertia(dart.dynamics.Inertia(mass, np.zeros(3), inertia * np.eye(3)))
        return joint, body

    def new_body(self, name: str, mass: float, inertia: float | None) -> Any:  # noqa: ANN401
        """Create a body, kg and kg m², in a skeleton of its own and return it.

        One without inertia has its angle locked.
        """
        _, carrier = self.attach(dart.dynamics.Skeleton(name), "TranslationalJoint2D")
        joint, body = self.attach(carrier, "RevoluteJoint", mass, inertia or mass)
        if inertia is None:
            joint.setActuatorType(dart.dynamics.ActuatorType.LOCKED)
        return body

    def new_joint(self, name: str, ends: tuple[str, str], line: Any, sign: float, keeps_angle: bool) -> Any:  # noqa: ANN401
        """Create the constraint of a pin at a point of its carrier or, with a direction in ``line``, on a line of it.

        Returns it. ``ends`` are the names of carrier and other body; ``line`` is the point, m, and the direction, or
        None for a pin, in the carrier's frame. DART has no force of a constraint to read: it acts on a probe that the
        carrier holds by a joint, which ``forces`` keeps with its ``sign``, 1.0 or -1.0. With ``keeps_angle`` the bodies
        do not turn against each other.
        """
        (carrier, other), (point, along) = (self.bodies[end] for end in ends), line
        joint, probe = self.attach(carrier, "PrismaticJoint" if along else "WeldJoint")
        x, y = along or (1.0, 0.0)
        turn = np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]])
        joint.setTransformFromParentBodyNode(dart.math.Isometry3(turn, [*point, 0.0]))
        if along:
            joint.setAxis([1.0, 0.0, 0.0])
        self.forces[name] = probe, [*self.bodies].index(ends[0]), complex(x, y), sign
        if keeps_angle:
            return dart.constraint.WeldJointConstraint(probe, other)
        return dart.constraint.BallJointConstraint(probe, other, probe.getTransform().translation())

    def spin(self, body: str) -> float:
        """Angular velocity of a body, by its name, rad/s, at the instant of its position; 0 for the ground."""
        joint = self.turns.get(body)
        return float(joint.getVelocity(0) + self.half * joint.getAcceleration(0)) if joint else 0.0

    def advance(self, speed: float) -> None:
        """Take one step with this speed of the crank, rad/s, under the model's loads and dampers."""
        self.turns[self.given["crank"]].setCommand(0, speed)
        for body, anchor, force in self.given["loads"]:
            self.bodies[body].addExtForce([*force, 0.0], [*anchor, 0.0], False, True)
        for first, second, coefficient in self.given["dampers"]:
            drag = np.array([0.0, 0.0, coefficient * (self.spin(first) - self.spin(second))])
            self.bodies[first].addExtTorque(-drag)
            self.bodies[second].addExtTorque(drag)
        self.world.step()

    def state(self, order: str) -> Array:
        """x, y and angle of the bodies, (bodies, 3), for "Positions", or their "Velocities" or "Accelerations"."""
        return np.array([getattr(skeleton, f"get{order}")()[:3] for skeleton in self.skeletons])

    def read(self, place: Array) -> Data:
        """Motion, torque and joint forces of the last step by channel, ground frame.

        ``place`` (bodies, 3) is x, y and angle of every body then. Forces are on the joints' first bodies.
        """
        changes, axes, forces = self.state("Accelerations"), np.exp(1j * np.append(place[:, 2], 0.0)), list[complex]()
        for probe, row, direction, sign in self.forces.values():
            forces.append(sign * complex(*probe.getBodyForce()[3:5]) * direction * axes[row])
        return {
            "position": place,
            "velocity": self.state("Velocities") - self.half * changes,
            "acceleration": changes,
            "torque": self.bodies[self.given["crank"]].getBodyForce()[2],
            "joint_force": [(force.real, force.imag) for force in forces],
        }


def build(model: Data) -> Data:
    """Return the model unchanged: a world needs the step, which only ``follow`` knows."""
    return model


def follow(given: Data, course: Data) -> Data:
    """Build a world, step through the one part of a course and return its samples: times, s, and values by channel.

    ``given`` is the adapter's model. Forces by joint are under "joint_force". Accelerations and forces begin after the
    start. A step ends with the velocities of its middle; its forces are those of the state before it.
    """
    (part,), ratio = course["parts"], course["ratio"]
    steps, ahead = ratio * part["samples"], int(given["centred"])
    step = part["end"] / steps
    world, times = DartWorld(given, step), step * np.arange(steps + ahead + 1)
    rows = [(0.0, {"position": world.start, "velocity": world.rates})]
    for number, speed in enumerate(np.diff(motion_values(given["motion"], times)) / step):
        sampled = number >= ahead and (number + 1 - ahead) % ratio == 0
        place = world.state("Positions") if sampled else world.start
        world.advance(speed)
        if sampled:
            rows.append((times[number + 1 - ahead], world.read(place if ahead else world.state("Positions"))))
    return signals(rows, course["channels"], world.forces)
