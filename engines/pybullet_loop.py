"""One pass in PyBullet: bodies that move freely and are tied by constraints, its drive and loads set before every step.

A step of Bullet solves for the velocities with which it then moves the bodies: those after it are of the step's middle,
forces and the change of the velocities over it are of its start. So a run that is centred, as one with a ``lead`` is,
reads velocities half-way between samples. It begins with bodies at rest, some steps before the start: in these the
drive and the joints, closed at first, bring all bodies to the velocities that they are to have, and the joints open as
far as steps of that length leave them. As shipped, everything is taken for that of the step's end.

Data are the adapter's ``model``, in SI or the scene's own units. A course has one part of the motion, with its ``end``,
s, and a number of ``samples``, ``ratio`` steps to a sample, and the ``channels`` to record.
"""

from functools import partial
from typing import Any

import numpy as np
import pybullet

from engines.shared_loop import motion_values

UNTURNED = [0.0, 0.0, 0.0, 1.0]
# A block's mass in the lightest body's, and how soft constraints are, in own units: those that say the same twice, as
# may be out of the plane, have no solution without.
LIGHT, SOFT = 2e-8, 1e-6
UNLIMITED = {"maxForce": 1e12}  # N; a constraint gives way at 500 N unless told otherwise
UNDAMPED = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0, "maxJointVelocity": 1e12}


class PybulletWorld:
    """The bodies of a model, the ground last, in their start state.

    Their frames have the ground's axes at the start. ``links`` are the blocks of guided joints on their hosts.
    """

    def __init__(self, given: dict[str, Any]) -> None:
        """Start a PyBullet server of its own and build the adapter's model in it."""
        self.given, self.client, self.centred = given, pybullet.connect(pybullet.DIRECT), given["lead"] > 0
        self.setGravity(*given["gravity"], 0.0)
        place, rate = np.array(given["start"])[:, 0]
        self.spins, self.links = [0.0] * len(given["dampers"]), dict[int, int]()
        self.drive, self.sign = given["drive"]
        self.bodies = [self.add(number, place[:, :2]) for number in range(len(place))]
        for body, (*speed, spin) in zip(self.bodies, rate, strict=True):
            self.resetBaseVelocity(body, [*speed, 0.0], [0.0, 0.0, spin])
        self.ties = [self.tie(n, *ends) for n, ends in enumerate(zip(*given["ends"], strict=True))]
        self.turn = partial(self.changeConstraint, self.ties[self.drive], **UNLIMITED)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """The function of PyBullet with this name, bound to this world's server and kept; AttributeError for none."""
        function = partial(getattr(pybullet, name), physicsClientId=self.client)
        setattr(self, name, function)  # bound once, not in every step
        return function

    def add(self, number: int, places: Any) -> int:  # noqa: ANN401
        """Create the body of a ``number``, with the blocks that slide on it as its links.

        Returns PyBullet's number of it. ``places`` are those of all bodies, m. ``links`` notes the blocks by joint.
        """
        bodies, (owners, arms, hosts, _) = self.given["bodies"], self.given["ends"]
        (mass, inertia), place = bodies[number], places[number]
        guides = [(n, along) for n, along in self.given["guides"].items() if hosts[n] == number]
        count = len(guides)
        body = self.createMultiBody(
            mass,
            basePosition=[*place, 0.0],
            linkMasses=[LIGHT * min(each for each, _ in bodies[:-1])] * count,
            linkCollisionShapeIndices=[-1] * count,
            linkVisualShapeIndices=[-1] * count,
            linkPositions=[[*(places[owners[n]] + arms[n] - place), 0.0] for n, _ in guides],
            linkOrientations=[UNTURNED] * count,
            linkInertialFramePositions=[[0.0, 0.0, 0.0]] * count,
            linkInertialFrameOrientations=[UNTURNED] * count,
            linkParentIndices=[0] * count,
            linkJointTypes=[pybullet.JOINT_PRISMATIC] * count,
            linkJointAxis=[[*along, 0.0] for _, along in guides],
        )
        for link in range(-1, count) if self.centred else ():
            self.changeDynamics(body, link, **UNDAMPED)
        # In one call with those above PyBullet takes the inertia for 0.
        self.changeDynamics(body, -1, localInertiaDiagonal=[inertia] * 3)
        for link, (n, _) in enumerate(guides):  # a link comes with a motor that brakes it
            self.setJointMotorControl2(body, link, pybullet.VELOCITY_CONTROL, force=0.0)
            self.links[n] = link
        return int(body)

    def tie(self, n: int, body: int, here: list[float], host: int, there: list[float]) -> int:
        """Create the constraint of joint ``n`` of a body and its host, or the host's block; returns PyBullet's number.

        ``body`` and ``host`` are numbers in ``bodies``; ``here`` and ``there`` are arms from their mass centres, m.
        """
        kind = pybullet.JOINT_FIXED if n in self.given["fixed"] else pybullet.JOINT_POINT2POINT
        both = self.bodies[body], -1, self.bodies[host], self.links.get(n, -1)
        point = [0.0, 0.0, 0.0] if n in self.links else [*there, 0.0]
        tie = self.createConstraint(*both, kind, [0.0, 0.0, 0.0], [*here, 0.0], point)
        self.changeConstraint(tie, **UNLIMITED)
        return int(tie)

    def advance(self, turn: list[float]) -> None:
        """Take a step that turns the drive to an orientation, a quaternion x, y, z, w, under the loads of its start."""
        self.turn(jointChildFrameOrientation=turn)
        for body, anchor, force in self.given["forces"]:
            place = self.getBasePositionAndOrientation(self.bodies[body])
            point, _ = pybullet.multiplyTransforms(*place, [*anchor, 0.0], UNTURNED)
            self.applyExternalForce(self.bodies[body], -1, [*force, 0.0], point, pybullet.WORLD_FRAME)
        for body, moment in self.given["torques"]:
            self.applyExternalTorque(self.bodies[body], -1, [0.0, 0.0, moment], pybullet.WORLD_FRAME)
        for n, (*numbers, coefficient) in enumerate(self.given["dampers"]):
            ends = [self.bodies[number] for number in numbers if number < len(self.bodies) - 1]  # not the ground
            spin, *others = [self.getBaseVelocity(body)[1][2] for body in ends]
            last, self.spins[n] = self.spins[n], spin - sum(others)  # those of now lie half a step ahead
            drag = coefficient * (1.5 * self.spins[n] - 0.5 * last if self.centred else self.spins[n])
            for body, moment in zip(ends, (-drag, drag), strict=False):
                self.applyExternalTorque(body, -1, [0.0, 0.0, moment], pybullet.WORLD_FRAME)
        self.stepSimulation()

    def state(self) -> Any:  # noqa: ANN401
        """x, y, angle and their rates of every body but the ground, (bodies, 6); the angle is from -π to π.

        It counts from the start.
        """
        rows = []
        for body in self.bodies[:-1]:
            place, turn = self.getBasePositionAndOrientation(body)
            rate, spin = self.getBaseVelocity(body)
            rows.append([*place[:2], pybullet.getEulerFromQuaternion(turn)[2], *rate[:2], spin[2]])
        return np.array(rows)

    def forces(self) -> tuple[float, Any]:
        """The drive's torque, N m, and the forces, N, (joints, 2), on the joints' first bodies, in the last step.

        Bullet's are those on the first body of a fixed constraint, and on the second of a point-to-point one.
        """
        states = [self.getConstraintState(tie) for tie in self.ties]
        signs = [[1.0 if n in self.given["fixed"] else -1.0] for n in range(len(states))]
        return self.sign * states[self.drive][5], np.array([state[:2] for state in states]) * signs


build = PybulletWorld


def follow(world: PybulletWorld, course: dict[str, Any]) -> dict[str, Any]:
    """Step through the one part of a course and return its samples; the world's server is then gone.

    They are times, s, and values by channel, and by joint under "joint_force".
    """
    (part,), ratio, given, centred, rows = course["parts"], course["ratio"], world.given, world.centred, []
    count = ratio * part["samples"]
    step, late = part["end"] / count, 0.0 if centred else 1.0
    solver = {"constraintSolverType": pybullet.CONSTRAINT_SOLVER_LCP_DANTZIG, "erp": 1.0, "globalCFM": SOFT * step}
    world.setPhysicsEngineParameter(fixedTimeStep=step, **(solver if centred else {}))
    angles = motion_values(given["motion"], step * np.arange(1 - given["lead"], count + centred + 1))
    half = 0.5 * world.sign * (angles - given["motion"][0][1][0])
    turns = np.column_stack([np.zeros((len(half), 2)), np.sin(half), np.cos(half)]).tolist()
    for number, turn in enumerate(turns, start=-given["lead"]):
        is_read = number >= 0 and number % ratio in (0, ratio // 2)
        before = world.state() if is_read else None
        world.advance(turn)
        if is_read:
            rows.append((number, before, world.state(), *world.forces()))
    world.disconnect()
    numbers, before, after, torque, forces = map(np.array, zip(*rows, strict=True))
    before[..., 2] = np.unwrap(before[..., 2], axis=0) + np.array(given["start"])[0, 0, :-1, 2]
    samples, middles = numbers % ratio == 0, (numbers % ratio == ratio // 2) & (numbers < count)
    time = step * (numbers[samples] + late)
    seen = {
        "position": (time - late * step, before[samples, :, :3]),
        "velocity": (step * (numbers[middles] + max(0.5, late)), after[middles, :, 3:]),
        "acceleration": (time, (after - before)[samples, :, 3:] / step),
        "torque": (time, torque[samples]),
        "joint_force": {name: (time, forces[samples, n]) for n, name in enumerate(given["names"])},
    }
    return {name: seen[name] for name in course["channels"]}
