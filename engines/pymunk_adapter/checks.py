"""What pymunk does not tell: scenes that end the process or run on as nonsense, and motions that are not the scene's.

pymunk's C core aborts the interpreter on masses, moments and iteration counts it does not like, and runs on with nan,
with joints that cannot close and with a crank that does not follow its motor. So data are checked before anything is
built, and the motion after every pass.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import Segment
from analytic.description.law import Law
from analytic.description.linkage import GROUND
from engines.contract import History
from engines.pymunk_adapter.layout import PartLayout
from engines.pymunk_adapter.recording import WATCHED, Recording, gaps
from engines.scene import Free, PinJoint, Scene
from engines.start_check import start_misfit
from engines.stepping.driver import DivergedError
from engines.stepping.histories import labelled

Array = NDArray[np.float64]

# A joint open by more than this share of the scene's size, or a crank off by more than this, rad, is another motion.
# The suite has closer limits; these are for motions that no longer are a linkage's.
OPEN_JOINT = 1e-2
LOST_CRANK = 0.05

# Numbers beyond these, SI, are taken for slips: their products and quotients are no longer finite.
LEAST, LARGEST = 1e-60, 1e60

# Share of the torque added for its sign below which the drive's impulse leaves the sign in doubt.
DOUBT = 0.05


def data_obstacle(scene: Scene) -> str | None:
    """What of a scene's data pymunk cannot hold, in one sentence; None where it can."""
    return next(_obstacles(scene), None)


def freedom_obstacle(layout: PartLayout) -> str | None:
    """Whether the joints of a layout leave a linkage's one degree of freedom, by count, in one sentence if not."""
    freedom = _freedom(layout)
    return None if freedom == 1 else f"the joints leave {freedom} degrees of freedom by count, where a linkage has one"


def _obstacles(scene: Scene) -> Iterator[str]:
    yield from _body_obstacles(scene)
    yield from _joint_obstacles(scene)
    yield from _load_obstacles(scene)
    yield from _drive_obstacles(scene)
    misfit = start_misfit(scene)
    if misfit is not None:
        yield misfit


def _finite(*values: float) -> bool:
    return all(abs(value) < LARGEST for value in values)  # false for nan


def _body_obstacles(scene: Scene) -> Iterator[str]:
    names = [body.name for body in scene.bodies]
    if len({*names, GROUND}) != len(names) + 1:
        yield f"the bodies' names are not distinct: {', '.join(names)}"
    for body in scene.bodies:
        if not LEAST < body.mass < LARGEST:
            yield f"body '{body.name}' has mass {body.mass:g} kg; pymunk needs a finite positive one"
        if body.inertia is not None and not LEAST < body.inertia < LARGEST:
            yield f"body '{body.name}' has inertia {body.inertia:g} kg m²; pymunk needs a finite positive one"
        if body.inertia is None and body.name == scene.crank:
            yield f"the crank '{body.name}' has no inertia, so that pymunk cannot turn it"
        start = (*body.position, body.angle, *body.velocity, body.angular_velocity)
        if not _finite(*start, *body.acceleration, body.angular_acceleration):
            yield f"body '{body.name}' has a start state that is not finite"


def _joint_obstacles(scene: Scene) -> Iterator[str]:
    known = {GROUND, *(body.name for body in scene.bodies)}
    ends: list[tuple[str, str, str, tuple[float, ...]]] = [
        (p.name, p.first, p.second, (*p.first_anchor, *p.second_anchor)) for p in scene.pins
    ]
    ends += [(j.name, j.body, j.host, (*j.anchor, *j.through, *j.along)) for j in scene.guided]
    for name, first, second, numbers in ends:
        for body in (first, second):
            if body not in known:
                yield f"joint '{name}' names a body '{body}' that is not in the scene"
        if first == second:
            yield f"joint '{name}' joins '{first}' to itself"
        if not _finite(*numbers):
            yield f"joint '{name}' has coordinates that are not finite"
    for joint in scene.guided:
        if joint.along == (0.0, 0.0):
            yield f"joint '{joint.name}' has a line without a direction"
    bodies = {body.name: body for body in scene.bodies}
    for slider in scene.sliders:
        if slider.host != GROUND and bodies[slider.body].inertia is None and scene.can_turn(bodies[slider.host]):
            yield f"body '{slider.body}' turns with its host '{slider.host}' and so needs an inertia"
    if not any({scene.crank, GROUND} == {p.first, p.second} for p in scene.pins):
        yield f"the crank '{scene.crank}' is not pinned to the ground"


def _load_obstacles(scene: Scene) -> Iterator[str]:
    if not _finite(*scene.gravity):
        yield "gravity is not finite"
    for force in scene.forces:
        if not (_law_is_finite(force.force) and _finite(*force.anchor)):
            yield f"the force on '{force.body}' is not finite"
    for torque in scene.torques:
        if not _law_is_finite(torque.torque):
            yield f"the torque on '{torque.body}' is not finite"
    for spring in scene.springs:
        numbers = (spring.stiffness, spring.length, spring.damping)
        if not (_finite(*numbers, *spring.first_anchor, *spring.second_anchor) and min(numbers) >= 0.0):
            yield f"the spring from '{spring.first}' to '{spring.second}' has a number that is negative or not finite"
    for damper in scene.dampers:
        if not (_finite(damper.coefficient) and damper.coefficient >= 0.0):
            yield f"the damper from '{damper.first}' to '{damper.second}' has a coefficient of {damper.coefficient:g}"
    known = {GROUND, *(body.name for body in scene.bodies)}
    loaded = {force.body for force in scene.forces} | {torque.body for torque in scene.torques}
    loaded |= {end for spring in scene.springs for end in (spring.first, spring.second)}
    loaded |= {end for damper in scene.dampers for end in (damper.first, damper.second)}
    for name in sorted(loaded - known):
        yield f"a load acts on a body '{name}' that is not in the scene"


def _law_is_finite(law: Law) -> bool:
    return _finite(*law.values.ravel(), *(() if law.angles is None else law.angles))


def _drive_obstacles(scene: Scene) -> Iterator[str]:
    drive = scene.drive
    if isinstance(drive, Free):
        if not (_finite(drive.torque, drive.duration) and drive.duration > 0.0):
            yield "the free drive has a torque or a duration that is not finite and positive"
        return
    for segment in drive.motion.segments:
        if not (_finite(segment.start, segment.end, *segment.coefficients) and segment.end > segment.start):
            yield f"the crank's motion is not finite between {segment.start:g} and {segment.end:g} s"


def _freedom(layout: PartLayout) -> int:
    """Degrees of freedom by count, the free turning of parts without inertia left out."""
    coordinates = sum(2 if part.inertia is None else 3 for part in layout.parts)
    return coordinates - sum(2 if isinstance(hold, PinJoint) else 1 for hold in layout.holds)


def check_finite(times: Array, seen: Array) -> None:
    """Raise DivergedError where the parts' states (n, parts, 2, 3) are not finite."""
    finite = np.isfinite(seen).all(axis=(1, 2, 3))
    if not finite.all():
        raise DivergedError(f"the motion is not finite from {max(0.0, times[np.argmin(finite)]):.4g} s on")


def check_joints(times: Array, seen: Array, layout: PartLayout, share: float = OPEN_JOINT) -> None:
    """Raise DivergedError where a joint is open by more than a share of the scene's size.

    Looks are thinned out: a joint that opens stays open.
    """
    thin = slice(None, None, max(1, len(times) // WATCHED))
    opened = gaps(layout, seen[thin, :, 0])
    look, number = np.unravel_index(np.argmax(opened), opened.shape)
    if opened[look, number] > share * layout.reach:
        joint, gap = layout.equations.joints[number], opened[look, number]
        raise DivergedError(f"joint '{joint}' is open by {gap:.2g} m at {times[thin][look]:.4g} s")


def check_read_out(history: History) -> None:
    """Raise DivergedError where a signal is not finite: states may be, and their products not."""
    for name, signal in labelled(history):
        if not np.isfinite(signal.values).all():
            raise DivergedError(f"the {name} is no longer a finite number")


def check_crank(recording: Recording, layout: PartLayout, segment: Segment) -> None:
    """Raise DivergedError where the crank is not where its motion has it."""
    off = np.abs(recording.state[:, layout.crank, 2] - segment.value(recording.times))
    worst = int(np.argmax(off))
    if off[worst] > LOST_CRANK:
        raise DivergedError(f"the crank is {off[worst]:.2g} rad from its motion at {recording.times[worst]:.4g} s")


def check_impulses(recording: Recording, offset: float) -> None:
    """Raise DivergedError where the drive's impulse is too near to zero to tell its sign."""
    left = offset - recording.torque
    worst = int(np.argmin(left))
    if left[worst] < DOUBT * offset:
        torque, time = recording.torque[worst], recording.times[worst]
        raise DivergedError(f"the drive torque grew beyond all bounds: {torque:.3g} N m at {time:.4g} s")
