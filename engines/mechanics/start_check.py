"""Can a scene be run at all, and does its start fit the joints? Engines leave this out: most run on as nonsense.

Positions, velocities and accelerations are tried alike, since an acceleration that breaks a joint is enough to make an
undamped integrator ring for the whole run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from analytic.description.law import Law
from analytic.description.linkage import GROUND, DriverKind
from analytic.description.walk import walk
from engines.contract import Abilities
from engines.mechanics.joints import JointEquations, scene_size
from engines.mechanics.states import Reals, driven, pose_of, start_motion
from engines.scene import AppliedForce, Body, Free, Prescribed, Scene

# Numbers beyond these, SI, are taken for slips: their products and quotients are no longer finite.
LEAST, LARGEST = 1e-60, 1e60
BODY_FIELDS = ("body", "host", "first", "second")  # what parts of a scene call the bodies they act on

QUANTITIES = ("position", "velocity", "acceleration")
UNITS = ("m", "m/s", "m/s²")


@dataclass(frozen=True)
class Misfit:
    """Violation of a joint in position, velocity or acceleration (``order`` 0, 1, 2), m, m/s or m/s²."""

    joint: str
    order: int
    size: float


def misfits(scene: Scene, *motion: Reals) -> Iterator[Misfit]:
    """Yield each joint's violation in position and, where given, velocity and acceleration, each (1, bodies, 3), SI.

    The ground is the last body. A slider's turning against its host counts from the velocity on, as its angle is
    whatever it was at the start.
    """
    equations = JointEquations(scene, unit=1.0)
    pose = pose_of(motion[0])
    arms = equations.arms(pose)
    for order, values in enumerate(motion):
        if order == 0:
            residual = equations.residual(pose, arms)
        else:
            residual = (equations.jacobian(arms) @ equations.gather(values)[..., None])[..., 0]
        if order == 2:
            residual = residual - equations.bend(arms, motion[1])
        for joint, size in zip(equations.joints, equations.openings(residual)[0], strict=True):
            yield Misfit(joint, order, float(size))
        for slider in scene.sliders if order else ():
            arm = math.hypot(*slider.anchor) or scene_size(scene)
            turn = values[0, equations.index[slider.body], 2] - values[0, equations.index[slider.host], 2]
            yield Misfit(slider.name, order, arm * abs(float(turn)))


def start_misfit(scene: Scene, tolerance: float = 1e-6) -> str | None:
    """The sentence on a driver that starts off its prescribed motion, or on the joint that fits worst; None if all fit.

    ``tolerance`` is relative: to the scene's size, the fastest and the hardest motion of a body.
    """
    if isinstance(scene.drive, Prescribed):
        segment = scene.drive.motion.segments[0]
        prescribed = [float(segment.value(segment.start, order)) for order in range(3)]
        actual = [float(value[0]) for value in driven(scene, *start_motion(scene))]
        turns = scene.driver_kind is DriverKind.CRANK
        for name, expected, got in zip(QUANTITIES, prescribed, actual, strict=True):
            if abs(expected - got) > tolerance * max(1.0 if turns else scene_size(scene), abs(expected)):
                kind = "angular " if turns else ""
                return f"the {scene.driver_kind} starts with an {kind}{name} of {got:g}, its drive with {expected:g}"
    size = scene_size(scene)
    fastest = max(math.hypot(*b.velocity) + abs(b.angular_velocity) * size for b in scene.bodies)
    hardest = max(math.hypot(*b.acceleration) + abs(b.angular_acceleration) * size for b in scene.bodies)
    scales = (size, fastest or 1.0, (hardest + fastest**2 / size) or 1.0)
    violated = [
        miss for miss in misfits(scene, *start_motion(scene)) if not miss.size <= tolerance * scales[miss.order]
    ]
    if not violated:
        return None
    worst = max(violated, key=lambda miss: miss.size / scales[miss.order])
    where = f"joint '{worst.joint}' by {worst.size:.3g} {UNITS[worst.order]}"
    return f"the start state violates {where} in {QUANTITIES[worst.order]}; give one that fits every joint"


def ability_obstacle(scene: Scene, abilities: Abilities) -> str | None:
    """The first part of a scene that is beyond an engine's abilities, in a sentence; None if there is none.

    Tried in turn are the drive, friction, joints and loads; bodies without mass are not looked at.
    """
    if type(scene.drive) not in abilities.drives:
        return f"it takes no {_type_in_words(scene.drive)} drive"
    if scene.driver_kind not in abilities.drivers:
        known = " or ".join(f"a {kind}" for kind in sorted(abilities.drivers))
        return f"it takes no {scene.driver_kind} as the driver, only {known}"
    if isinstance(scene.drive, Free) and scene.drive.over_time is not None and not abilities.timed_torque:
        return "it takes no crank torque that changes with time"
    if scene.friction and not abilities.friction:
        return f"it takes no friction that follows the force of its joint, as '{scene.friction[0].name}' has"
    for part in (*scene.guided, *scene.loads):
        if type(part) not in abilities.joints | abilities.loads:
            return f"it has no {_type_in_words(part)}, which {_label(part)} asks for"
    laws: list[tuple[object, Law]] = [(load, load.force) for load in scene.forces]
    laws += [(load, load.torque) for load in scene.torques]
    return next((words for load, law in laws for words in _load_obstacles(load, law, abilities)), None)


def _load_obstacles(load: object, law: Law, abilities: Abilities) -> Iterator[str]:
    """Yield reasons, in sentences, why a force or a torque with this law is beyond an engine's abilities."""
    if not law.is_constant and not abilities.varying_loads:
        yield f"it takes no load that changes with the crank angle, as {_label(load)} does"
    if abilities.load_states:
        return
    if law.over == "S" or law.when:
        yield f"it takes no load that depends on the output's travel or direction, as {_label(load)} does"
    if isinstance(load, AppliedForce) and load.frame != GROUND:
        yield f"it takes no force that turns with a body, as {_label(load)} does with '{load.frame}'"
    if isinstance(load, AppliedForce) and load.reaction != GROUND:
        yield f"it takes no force between two bodies, as {_label(load)} has from '{load.reaction}'"


def data_obstacle(scene: Scene, *, massless: bool) -> str | None:
    """The first fault of a scene's data, or of a start that does not fit the joints, in a sentence; None without.

    ``massless`` allows bodies without mass or without a moment of inertia.
    """
    return next(_data_faults(scene, 0.0 if massless else LEAST), None) or start_misfit(scene)


def _data_faults(scene: Scene, least: float) -> Iterator[str]:
    """Yield sentences on faults of a scene's data; masses, kg, and inertias, kg m², must be at least ``least``.

    They are on names, weights, the numbers of parts, the ends and lines of joints, sliders that need an inertia, a
    crank that cannot turn or is not on the ground, gravity, springs, dampers and the duration.
    """
    names = [body.name for body in scene.bodies]
    known = {GROUND, *names}
    if len(known) != len(names) + 1:
        yield f"the bodies' names are not distinct: {', '.join(names)}"
    for body in scene.bodies:
        yield from _weight_faults(body, least)
    turns = scene.driver_kind is DriverKind.CRANK
    if turns and any(body.name == scene.crank and body.inertia is None for body in scene.bodies):
        yield f"the crank '{scene.crank}' has no inertia, so that it cannot turn"
    cylinders = [scene.cylinder] if scene.cylinder else []
    parts: tuple[object, ...] = (*scene.bodies, *scene.joints, *scene.loads, *cylinders, scene.drive)
    for part in parts:
        yield from (
            f"{_label(part)} names a body '{end}' that is not in the scene" for end in _named_bodies(part) - known
        )
        if not _has_usable_numbers(part):
            yield f"{_label(part)} has a number that is not finite"
    pairs = (*scene.joints, *cylinders)
    yield from (f"{_label(joint)} joins a body to itself" for joint in pairs if len(_named_bodies(joint)) == 1)
    yield from (f"{_label(j)} has a line without a direction" for j in scene.guided if j.along == (0.0, 0.0))
    bodies = {body.name: body for body in scene.bodies}
    for slider in scene.sliders:
        if slider.host != GROUND and bodies[slider.body].inertia is None and scene.can_turn(bodies[slider.host]):
            yield f"body '{slider.body}' turns with its host '{slider.host}' and so needs an inertia"
    if turns and not any({scene.crank, GROUND} == {pin.first, pin.second} for pin in scene.pins):
        yield f"the crank '{scene.crank}' is not pinned to the ground"
    yield from _value_faults(scene)


def _weight_faults(body: Body, least: float) -> Iterator[str]:
    """Yield sentences on faults of a body's mass and, if any, inertia, which must be at least ``least``, SI."""
    for name, value, unit in (("mass", body.mass, "kg"), ("inertia", body.inertia, "kg m²")):
        if value is not None and not least <= value < LARGEST:
            if value == 0.0:
                yield f"it holds no body without a mass and an inertia, and '{body.name}' has {name} 0 {unit}"
            needed = "positive" if least else "non-negative"
            yield f"body '{body.name}' has {name} {value:g} {unit}; expected a finite {needed} one"


def _value_faults(scene: Scene) -> Iterator[str]:
    """Yield sentences on values that no engine can take: gravity, negative springs and dampers, no duration."""
    if not all(abs(component) < LARGEST for component in scene.gravity):
        yield "gravity is not finite"
    for spring in scene.springs:
        if min(spring.stiffness, spring.length, spring.damping) < 0.0:
            yield f"{_label(spring)} has a number that is negative"
    for damper in scene.dampers:
        if damper.coefficient < 0.0:
            yield f"{_label(damper)} has a coefficient of {damper.coefficient:g}"
    drive = scene.drive
    if (drive.motion.duration if isinstance(drive, Prescribed) else drive.duration) <= 0.0:
        yield "the drive has a duration that is not positive"


def _has_usable_numbers(part: object) -> bool:
    """Whether every number of a part of a scene is finite and, SI, below LARGEST in size."""
    return all(abs(number.value) < LARGEST for number in walk(part))  # false for nan


def _named_bodies(part: object) -> set[str]:
    """Names of the bodies, or the ground, that a part of a scene joins or acts on; none for a body or a drive."""
    return {getattr(part, name) for name in BODY_FIELDS if hasattr(part, name)}


def _label(part: object) -> str:
    """A part of a scene in words, by name or bodies: "pin joint 'A'", "applied force on 'rod'", "free drive"."""
    words = _type_in_words(part)
    if hasattr(part, "name"):
        return f"{words} '{part.name}'"
    ends = " and ".join(f"'{end}'" for end in sorted(_named_bodies(part)))
    return f"{words} on {ends}" if ends else f"{words} drive"


def _type_in_words(part: object) -> str:
    """The type of a part in words, as in "pin joint"."""
    return "".join(f" {c.lower()}" if c.isupper() else c for c in type(part).__name__).strip()
