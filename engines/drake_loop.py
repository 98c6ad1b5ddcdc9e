"""One pass in Drake: a discrete plant of bodies that move freely in the plane and are joined by constraints.

Data are the adapter's ``model``, in SI or the scene's own units. A course has one part of the motion, with its ``end``,
s, and a number of ``samples``, ``ratio`` steps to a sample, and the ``channels`` to record.
"""

from typing import Any

import numpy as np
import pydrake.all as drake
from pydrake.polynomial import Polynomial

from engines.shared_loop import signals

Data = dict[str, Any]
Point = tuple[float, float]
X, Y, Z = np.eye(3)


class DrakeWorld:
    """A plant of one time step in its start state, all coordinates 0.

    A coordinate is a path along x, y or a guide, or an angle: ``paths`` (bodies, 3, coordinates) turns their changes
    into those of every body's x, y and angle. ``forces`` has for every joint of the scene the joint of the plant that
    bears its force, and the force's sign.
    """

    def __init__(self, given: Data, step: float, end: float) -> None:
        """Build Drake's diagram from the adapter's model; ``step`` and ``end``, of the motion, are in s."""
        builder, self.lead = drake.DiagramBuilder(), given["lead"] * step
        self.plant = plant = builder.AddSystem(drake.MultibodyPlant(step))
        plant.set_discrete_contact_approximation(drake.DiscreteContactApproximation.kSap)  # the others take no loops
        plant.SetUseSampledOutputPorts(not self.lead)  # as shipped ports have what was of the last step
        plant.mutable_gravity_field().set_gravity_vector(_space_vector(given["gravity"]))
        # With a constraint at the world's own body Drake 1.51 ends the process: what is welded to it stands for it.
        self.bodies, self.forces = {"ground": self.body()}, dict[str, tuple[Any, float]]()
        plant.WeldFrames(plant.world_frame(), self.bodies["ground"].body_frame())
        chains = {body[0]: self.add_with_joints(body, given) for body in given["bodies"]}
        for joint in given["joints"]:
            self.add_constraint(*joint)
        crank, _ = chains[given["crank"]][-1]
        gains = drake.PdControllerGains(p=given["stiffness"] / step**2, d=0.0)
        plant.AddJointActuator("drive", crank).set_controller_gains(gains)
        plant.Finalize()
        self.paths = np.zeros((len(chains), 3, plant.num_velocities()))
        for paths, chain in zip(self.paths, chains.values(), strict=True):
            for joint, direction in chain:
                paths[:, joint.velocity_start()] = direction
        # The controller is to reach the angle of every step's end; a newcomer's is a step late.
        starts, pieces = zip(*given["motion"], strict=True)
        motion = drake.PiecewisePolynomial([*map(Polynomial, pieces)], [*starts, end + 2.0 * step])
        motion.shiftRight(-self.lead)
        source = builder.AddSystem(drake.TrajectorySource(motion, 1))
        builder.Connect(source.get_output_port(), plant.get_desired_state_input_port(crank.model_instance()))
        self.simulator = drake.Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.start, self.rates, changes = (np.array(each)[0, :-1] for each in given["start"])
        # The rates of a step are those of its middle.
        plant.SetVelocities(self.context, np.einsum("bkn,bk->n", self.paths, self.rates - 0.5 * self.lead * changes))
        loads = drake.Value[list[drake.ExternallyAppliedSpatialForce]]([self.load(*load) for load in given["loads"]])
        plant.get_applied_spatial_force_input_port().FixValue(self.context, loads)

    def body(self, mass: float = 0.0, inertia: float = 0.0) -> Any:  # noqa: ANN401
        """Add a body, its frame at the mass centre, by mass, kg, and inertia, kg m², and return Drake's object."""
        own = drake.SpatialInertia(mass, np.zeros(3), drake.UnitInertia(*[inertia / mass if mass else 1.0] * 3))
        return self.plant.AddRigidBody(f"body {self.plant.num_bodies()}", own)

    def frame(self, body: Any, point: Point = (0.0, 0.0), angle: float = 0.0) -> Any:  # noqa: ANN401
        """Add a frame to a body of Drake's at a point of it, m, turned by an angle, rad, and return it."""
        pose = drake.RigidTransform(drake.RotationMatrix.MakeZRotation(angle), _space_vector(point))
        return self.plant.AddFrame(drake.FixedOffsetFrame(f"frame {self.plant.num_frames()}", body, pose))

    def add_with_joints(self, body: tuple[Any, ...], given: Data) -> list[tuple[Any, Any]]:
        """Add a body with a chain of joints from the ground; returns the joints, each with its axis in (x, y, angle).

        ``body`` is its name, mass, inertia or None, place and angle. A slider has its guide as the only joint, whose
        force ``forces`` keeps.
        """
        name, mass, inertia, place, angle = body
        guide, along = given["guides"].get(name, ("", None))
        damping = sum(coefficient for *ends, coefficient in given["dampers"] if name in ends)
        axes = [_space_vector(along)] if guide else [X, Y] if inertia is None else [X, Y, Z]
        own = self.bodies[name] = self.body(mass, mass if inertia is None else inertia)  # what cannot turn has any
        parent, chain = self.frame(self.bodies["ground"], place), []
        for axis in axes:
            child = self.frame(own, angle=-angle) if axis is axes[-1] else self.body().body_frame()
            ends = f"joint {self.plant.num_joints()}", parent, child, axis
            joint = drake.RevoluteJoint(*ends, damping) if axis is Z else drake.PrismaticJoint(*ends)
            chain.append((self.plant.AddJoint(joint), axis))
            parent = child
        if guide:
            self.forces[guide] = chain[0][0], 1.0
        return chain

    def add_constraint(self, name: str, first: tuple[str, Point], second: tuple[str, Point], far: float) -> None:
        """Add a pin, or with ``far`` > 0, m, a point kept at this distance, which stands for a slot.

        ``first`` and ``second`` are each a body's name and a point in its frame, m. Drake has no force of a constraint
        as output: the constraint acts on a body without mass that is welded to the joint's first body, and the weld,
        which ``forces`` keeps, has the force.
        """
        (body, here), (host, there), probe = first, second, self.body()
        weld = drake.WeldJoint(name, self.frame(self.bodies[body], here), probe.body_frame(), drake.RigidTransform())
        self.forces[name] = self.plant.AddJoint(weld), -1.0
        ends = probe, np.zeros(3), self.bodies[host], _space_vector(there)
        if far:
            self.plant.AddDistanceConstraint(*ends, far)
        else:
            self.plant.AddBallConstraint(*ends)

    def load(self, body: str, anchor: Point, force: Point) -> Any:  # noqa: ANN401
        """Create a constant force, N, ground frame, at a point of the named body, as Drake's object, not yet acting."""
        load = drake.ExternallyAppliedSpatialForce()
        load.body_index, load.p_BoBq_B = self.bodies[body].index(), _space_vector(anchor)
        load.F_Bq_W = drake.SpatialForce(tau=np.zeros(3), f=_space_vector(force))
        return load

    def read(self, time: float) -> Data:
        """Advance the plant to an instant, s, and return its motion, torque and joint forces by channel.

        Motion is (bodies, 3) in x, y and angle; forces, ground frame, are on the joints' first bodies.
        """
        self.simulator.AdvanceTo(time)
        plant, context, forces = self.plant, self.context, list[Any]()
        changes = plant.get_generalized_acceleration_output_port().Eval(context)
        reactions = plant.get_reaction_forces_output_port().Eval(context)
        for joint, sign in self.forces.values():
            axes = joint.frame_on_child().CalcRotationMatrixInWorld(context)
            forces.append(sign * (axes @ reactions[joint.index()].translational())[:2])
        return {
            "position": self.start + self.paths @ plant.GetPositions(context),
            "velocity": self.paths @ (plant.GetVelocities(context) + 0.5 * self.lead * changes),
            "acceleration": self.paths @ changes,
            "torque": plant.get_net_actuation_output_port().Eval(context)[0],
            "joint_force": forces,
        }


def _space_vector(vector: Point) -> Any:  # noqa: ANN401
    """A plane vector as an array with the third component 0."""
    return np.array([*vector, 0.0])


def build(model: Data) -> Data:
    """Return the model unchanged: a plant needs the step, which only ``follow`` knows."""
    return model


def follow(given: Data, course: Data) -> Data:
    """Build a world, step through the one part of a course and return its samples: times, s, and values by channel.

    ``given`` is the adapter's model. Forces by joint are under "joint_force". Accelerations and forces begin after the
    start. The joints, closed at first, open within some ten steps as far as the steps allow. Raises ArithmeticError
    where Drake gives up.
    """
    (part,), ratio = course["parts"], course["ratio"]
    step = part["end"] / (ratio * part["samples"])
    times = step * (ratio * np.arange(part["samples"] + 1))
    try:
        world = DrakeWorld(given, step, part["end"])
        rows = [(0.0, {"position": world.start, "velocity": world.rates})]  # a step to 0 s would leave it behind
        rows += [(time, world.read(time)) for time in times[1:]]
    except RuntimeError as error:
        raise ArithmeticError(f"Drake gives up: {error}") from error
    return signals(rows, course["channels"], world.forces)
