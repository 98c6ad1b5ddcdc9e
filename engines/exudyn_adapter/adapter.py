"""exudyn behind the contract: constrained planar bodies, one generalised-α run or trapezoidal runs extrapolated.

J. Gerstmayr, "Exudyn - a C++-based Python package for flexible multibody systems", Multibody System Dynamics 60 (2024).

- ``naive``: a Python function for the drive, exudyn's defaults at 1 ms.
- ``tuned``: one run of generalised α with its constraints on position level: joints stay closed over any number of
  turns, and a linkage passes its change points.
- ``best``: the trapezoidal rule with its constraints on velocity level, extrapolated to eighth order: its multipliers
  are free of the rounding that the square of the step magnifies on position level.

The parts of a prescribed motion start anew (``engines.exudyn_adapter.loop``). The recipes below have the settings'
numbers and the methods that can be studied.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from analytic.description.linkage import GROUND, DriverKind
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.states import start_coordinate, start_motion
from engines.scene import GUIDES, LOADS, Body, Channel, End, Free, GuidedJoint, PinJoint, Prescribed, Scene, SliderJoint
from engines.stepping import stepped_engine
from engines.stepping.stepped_engine import LoopEngine, plain_law

# From a scene to an exudyn system: a rigid body for every link, joints, loads, springs and the drive.


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
        """List the items of exudyn's system for a scene: bodies, joints, loads, springs and drive."""
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
        """The system as plain data by name: items, poses and the numbers by which the loop finds them.

        Adds the sensors to the items: it is for one call.
        """
        scene = self.scene
        segments = scene.drive.motion.segments if isinstance(scene.drive, Prescribed) else ()
        states = [values[0, :-1].ravel() for values in start_motion(scene)]
        states[0] = np.zeros_like(states[0])  # coordinates are displacements from the start
        bodies, linear = [body.name for body in scene.bodies], None
        if scene.driver_kind is not DriverKind.CRANK:  # nodes, None of the ground, and anchors of its ends
            linear = {
                "ends": [(self.nodes.get(body), complex(*anchor)) for body, anchor in scene.driver_ends],
                "along": None if scene.cylinder else complex(*scene.driven_slider.along),
            }
        return {
            **add_sensors(self),
            "items": self.items,
            "driver": self.driver,
            "linear": linear,
            "crank": bodies.index(scene.crank) if scene.crank in bodies else None,
            "crank_node": self.nodes.get(scene.crank),
            "start": start_coordinate(scene),
            "motion": [(segment.start, segment.end, segment.coefficients) for segment in segments],
            "states": states,
            "poses": [(*body.position, body.angle) for body in scene.bodies],
        }

    def _add_item(self, category: str, kind: str, data: dict[str, Any], law: tuple[str, str, Any] | None = None) -> int:
        """Add an item to its category; returns its number there.

        ``law`` says what of it is a function: "angle" (of φ), "time" or "gap", exudyn's name of the argument, its data.
        """
        self.items.append((category, kind, data, law))
        self.counts[category] += 1
        return self.counts[category] - 1

    def add_sensor(self, kind: str, output: str, **data: int) -> int:
        """Add a sensor of an ``output`` on a node or an object, both as exudyn names them; returns its number."""
        return self._add_item("Sensor", kind, {**data, "outputVariableType": output, "storeInternal": True})

    def _add_object(self, kind: str, law: tuple[str, str, Any] | None = None, **data: Any) -> int:  # noqa: ANN401
        """Add an object with its ``data`` as exudyn has them; returns its number; ``law`` is as for ``_add_item``."""
        return self._add_item("Object", kind, data, law)

    def _add_marker(self, kind: str, **data: Any) -> int:  # noqa: ANN401
        """Add a marker with its ``data`` as exudyn has them; returns its number."""
        return self._add_item("Marker", kind, data)

    def _add_load(self, kind: str, marker: int, law: tuple[str, str, Any] | None = None, **data: Any) -> None:  # noqa: ANN401
        """Add a load at a marker, with its ``data`` as exudyn has them; a ``law``, as of any item, varies it."""
        self._add_item("Load", kind, {"markerNumber": marker, **data}, law)

    def _angle_marker(self, body: str) -> int:
        """The number of a marker of a body's angle, which is added, or of the ground's, which is there."""
        if body == GROUND:
            return self.fixed
        return self._add_marker("NodeCoordinate", nodeNumber=self.nodes[body], coordinate=ANGLE)

    def _point_markers(self, *ends: End) -> list[int]:
        """Add a marker for each end, a body's name and a point in its frame; returns their numbers."""
        return [
            self._add_marker("BodyRigid", bodyNumber=self.objects[body], localPosition=[*anchor, 0.0])
            for body, anchor in ends
        ]

    def _add_body(self, body: Body) -> None:
        """Add a body's node and object, noted by its name, and its weight if it has any.

        The angle of one without inertia is held, unless a slider holds it.
        """
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
        """Add a revolute joint and note it.

        Exudyn reports the force on its first marker's body, in the ground frame.
        """
        item = self._add_object("JointRevolute2D", markerNumbers=self._point_markers(*pin.ends))
        self.joints[pin.name] = item, None

    def _add_line(self, joint: GuidedJoint) -> None:
        """Add exudyn's prismatic joint and note it; a slot, a pin in it, has none of its condition on the angle."""
        turned = self.angles[joint.host] - self.angles[joint.body]
        (x, y), c, s = joint.along, math.cos(turned), math.sin(turned)
        item = self._add_object(
            "JointPrismatic2D",
            markerNumbers=self._point_markers(*joint.ends),
            axisMarker0=[c * x - s * y, s * x + c * y, 0.0],
            normalMarker1=[-y, x, 0.0],
            constrainRotation=isinstance(joint, SliderJoint),
        )
        self.joints[joint.name] = item, joint.body

    def _add_loads(self) -> None:
        """Add the applied forces and torques; one that varies reads φ at every evaluation."""
        forces, torques = self.scene.forces, self.scene.torques
        loads = [("ForceVector", self._point_markers((load.body, load.anchor))[0], load.force) for load in forces]
        loads += [("Coordinate", self._angle_marker(load.body), load.torque) for load in torques]
        for kind, marker, law in loads:
            values = plain_law(law)
            if not law.is_constant:
                self._add_load(kind, marker, ("angle", USER_FUNCTIONS[kind], values))
            elif kind == "ForceVector":
                self._add_load(kind, marker, loadVector=[*values, 0.0])
            else:
                self._add_load(kind, marker, load=values[0])

    def _add_springs(self) -> None:
        """Add the springs between points, with their dashpots, and the dampers between bodies."""
        for spring in self.scene.springs:
            self._add_object(
                "ConnectorSpringDamper",
                markerNumbers=self._point_markers(*spring.ends),
                stiffness=spring.stiffness,
                damping=spring.damping,
                referenceLength=spring.length,
            )
        for damper in self.scene.dampers:
            ends = [self._angle_marker(damper.first), self._angle_marker(damper.second)]
            self._add_object("ConnectorCoordinateSpringDamper", markerNumbers=ends, damping=damper.coefficient)

    def _add_drive(self) -> None:
        """Add the drive: an object, noted as ``driver``, that holds a prescribed driver, or a load on a free one."""
        scene, drive = self.scene, self.scene.drive
        turns = scene.driver_kind is DriverKind.CRANK
        if isinstance(drive, Prescribed):
            if turns:
                markers = [self.fixed, self._angle_marker(scene.crank)]
                self.driver = self._add_object("ConnectorCoordinate", markerNumbers=markers)
            else:
                nodes = [self.nodes.get(body, self.ground) for body, _ in scene.driver_ends]
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
        ends = self._point_markers(*scene.driver_ends)
        if scene.cylinder is not None:
            pull = ("time", "springForceUserFunction", (drive.torque, times, [-1.0]))
            self._add_object("ConnectorSpringDamper", pull, markerNumbers=ends)
        else:
            push = (drive.torque, times, [*scene.driven_slider.along])
            self._add_load("ForceVector", ends[0], ("time", USER_FUNCTIONS["ForceVector"], push))


def add_sensors(model: ExudynModel) -> dict[str, Any]:
    """Add sensors for the scene's channels to a model; returns their numbers as plain data for the loop.

    ``motion_sensors`` has lists of them, one a body, by channel, ``torque_sensor`` the drive's or None.
    ``force_sensors`` has pairs by joint: the number, and None or, for a force in a body's frame, the body's angle, rad,
    at the start and the number of a sensor of its coordinates. ``sensors`` is how many there are.
    """
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


# The engine.


# Recipes for exudyn: its rules for a time step, the settings, and the methods that can be studied.


EFFORT_UNIT = "relative tolerance"
ODD_RATIOS = (1, 3, 5, 7)  # steps to a sample that keep the sign of what alternates from step to step


@dataclass(frozen=True, kw_only=True)
class ExudynRecipe(stepped_engine.Recipe):
    """One of exudyn's rules for a time step.

    ``damping`` is the spectral radius at infinite frequency of the generalised α rule, whose constraints are on
    position level. None is the trapezoidal rule on velocity level: on position level nothing damps its multipliers;
    a rule ``as_shipped`` leaves every setting of exudyn's alone. ``effort`` is the tolerance of Newton's corrections,
    absolute and relative. ``adaptive`` lets exudyn halve a step in which they do not die out.
    """

    damping: float | None = None
    as_shipped: bool = False
    adaptive: bool = False

    def solver_settings(self) -> dict[str, Any]:
        """Settings of exudyn for the recipe's rule of integration, by their dotted names."""
        newton, alpha = "timeIntegration.newton", "timeIntegration.generalizedAlpha"
        table: dict[str, Any] = {"solution.file.write": False}
        if self.effort is not None:
            table |= {f"{newton}.{kind}Tolerance": self.effort for kind in ("relative", "absolute")}
        if self.as_shipped:
            return table
        if self.damping is not None:
            table[f"{alpha}.spectralRadius"] = self.damping
        return table | {
            "linearSolver.solverType": "EigenDense",
            "timeIntegration.adaptiveStep": self.adaptive,
            f"{alpha}.useNewmark": self.damping is None,
            f"{alpha}.useIndex2Constraints": self.damping is None,
            f"{alpha}.computeInitialAccelerations": False,  # exudyn leaves out the drive's own
            # Residuals hold the multipliers, which nothing fixes at a change point; the motion's corrections die out.
            f"{newton}.residualMode": 1,
            f"{newton}.useModifiedNewton": True,
            f"{newton}.modifiedNewtonJacUpdatePerStep": True,
        }


# The static solver's, which finds the start of a part: corrections are judged, not loads. The square of a correction,
# which is the next one, is rounding.
STATIC_SETTINGS = {
    "solution.file.write": False,
    "solution.sensors.active": False,
    "linearSolver.solverType": "EigenDense",
    "staticSolver.useLoadFactor": False,
    "staticSolver.newton.residualMode": 1,
    "staticSolver.newton.relativeTolerance": 1e-9,
    "staticSolver.newton.absoluteTolerance": 1e-9,
}

# Generalised α (J. Chung, G. M. Hulbert, ASME Journal of Applied Mechanics 60, 1993); exudyn has it on position level
# only. Its auxiliary accelerations start as the true ones, which leaves the multipliers first order behind every start;
# a spectral radius of 0.6, not exudyn's 0.9, forgets it within 20 steps.
ALPHA = ExudynRecipe(damping=0.6, effort=1e-10)
# Second order in the multipliers too. But these and the accelerations carry an undamped part that changes sign from
# step to step, as large as whatever does not fit at the start: 9.5 % of the peak torque for ever after a linear ramp's
# kink if nothing is done. What fresh starts leave of it goes in the extrapolation, all steps being odd fractions of the
# longest. Positions drift off the joints, by a hundred-thousandth of a link in every turn of 500 steps: 1.7 turns keep
# that below the rule's own error, and being no whole or half number bring the starts upon ever other positions.
TRAPEZOIDAL = ExudynRecipe(effort=1e-10, turns=1.7)
NAIVE = replace(ALPHA, damping=0.9, effort=None, as_shipped=True, step=1e-3, restarted=False, in_own_units=False)

# Largest errors of one run over the quintic run-up of the catalogue's five mechanisms, by steps a turn:
#     steps    Mkr     Jeq     v       a       joint force   s a run
#     1000     1.7e-3  3.4e-5  1.9e-5  6.2e-4  1.5e-3        0.1-0.2
#     2000     3.0e-5  8.6e-6  4.8e-6  2.2e-5  2.7e-5        0.2-0.4
#     4000     7.4e-6  2.1e-6  1.2e-6  5.5e-6  6.8e-6        0.3-0.7
#     8000     4.4e-6  5.4e-7  3.0e-7  1.4e-6  1.7e-6        0.5-1.3
# Made-up linkages are up to seven times sharper.
TUNED = replace(
    ALPHA,
    effort=1e-8,
    adaptive=True,
    steps_per_turn=100,
    ratios=(40,),
    graded=True,
    turns=10,
    least_steps=100,
)
BEST = replace(TRAPEZOIDAL, effort=1e-12, steps_per_turn=150, ratios=ODD_RATIOS, least_steps=100)
SETTINGS: Mapping[type, Mapping[Setting, ExudynRecipe]] = {
    Prescribed: {Setting.NAIVE: NAIVE, Setting.TUNED: TUNED, Setting.BEST: BEST},
    # A free crank adds its phase error up over all turns: 160 in 10 s of the slotted take-up, where 1600 steps a turn
    # leave 2e-7 of the angle and 7e-4 of the acceleration.
    Free: {
        Setting.NAIVE: NAIVE,
        Setting.TUNED: replace(TUNED, ratios=(16,)),
        Setting.BEST: replace(BEST, steps_per_turn=100),
    },
}


def _extrapolated_method(count: int) -> tuple[str, ExudynRecipe]:
    """The method of ``count`` extrapolated runs, 4 at most: its description in a sentence, and its recipe."""
    parts = ", 1/".join(map(str, ODD_RATIOS[:count]))
    about = f"the same at 1/{parts} of the step, extrapolated to order {2 * count}"
    return about, replace(TRAPEZOIDAL, ratios=ODD_RATIOS[:count], effort=1e-12)


STUDIED: Mapping[str, tuple[str, ExudynRecipe]] = {
    "defaults": ("the drive a Python function, exudyn's settings as shipped", NAIVE),
    "generalised alpha": (
        "generalised α (index 3) with a spectral radius of 0.6, from consistent accelerations, restarted at jumps",
        ALPHA,
    ),
    "trapezoidal": (
        "the implicit trapezoidal rule, constraints on velocity level, started anew at jumps and every 1.7 turns",
        TRAPEZOIDAL,
    ),
    **{f"trapezoidal x{count}": _extrapolated_method(count) for count in (2, 3, 4)},
}


# exudyn behind the contract: constrained planar bodies, one generalised-α run or trapezoidal runs extrapolated.

END = "of the state at the end of the step"
READOUTS: Mapping[Channel, ReadOut] = {
    **{channel: ReadOut(f"SensorNode, {name}", instant=END) for channel, name in COORDINATES.items()},
    Channel.ACCELERATION: ReadOut(
        "SensorNode, Coordinates_tt; without that of the start, which is given to exudyn but in naive", instant=END
    ),
    Channel.TORQUE: ReadOut(
        "SensorObject of the drive's ObjectConnectorCoordinate (linear: CoordinateVector), Force, with its sign turned",
        instant=END,
        drive="drive only",
    ),
    Channel.JOINT_FORCE: ReadOut(
        "SensorObject of the joint, Force; of ObjectJointPrismatic2D ForceLocal, turned by its body's angle",
        frame="ground; ForceLocal the body's",
        instant=END,
        drive="without drive",
    ),
}


class ExudynEngine(LoopEngine[ExudynRecipe]):
    """Adapter for exudyn."""

    name = "exudyn"
    package = "exudyn"
    loop = "engines.exudyn_adapter.loop"
    engine_calls = ("exudyn.MainSolverImplicitSecondOrder.SolveSystem", "exudyn.MainSystem.SolveStatic")
    oldest = "1.13.6"  # has newton.residualMode
    effort_unit = EFFORT_UNIT
    abilities: ClassVar[Abilities] = Abilities(
        readouts=READOUTS,
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS,
        drivers=frozenset(DriverKind),
    )
    settings = SETTINGS
    studied = STUDIED

    def model(self, scene: Scene, recipe: ExudynRecipe) -> Mapping[str, Any]:
        """The scene and the solver's settings as plain data by name for exudyn's loop."""
        settings = {"settings": recipe.solver_settings(), "static_settings": STATIC_SETTINGS}
        return ExudynModel(scene).as_data() | settings | {"as_shipped": recipe.as_shipped}
