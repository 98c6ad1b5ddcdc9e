"""Does a state fit the joints? The check that engines leave out: most run a broken linkage on and report success.

Positions, velocities and accelerations are tried alike, since an acceleration that breaks a joint is enough to make an
undamped integrator ring for the whole run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from analytic.description.linkage import GROUND, Vector
from engines.scene import Body, Prescribed, Scene, SliderJoint, SlotJoint

QUANTITIES = ("position", "velocity", "acceleration")
UNITS = ("m", "m/s", "m/s²")
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class State:
    """One body's x, y, angle and their first and second time derivatives, each (3,)."""

    position: Triple
    velocity: Triple = (0.0, 0.0, 0.0)
    acceleration: Triple = (0.0, 0.0, 0.0)


STILL = State((0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Misfit:
    """How far a joint is violated in position, velocity or acceleration (``order`` 0, 1, 2)."""

    joint: str
    order: int
    size: float


def start_state(scene: Scene) -> dict[str, State]:
    """The state the scene starts from, by body."""
    return {body.name: _body_state(body) for body in scene.bodies}


def _body_state(body: Body) -> State:
    return State(
        (*body.position, body.angle),
        (*body.velocity, body.angular_velocity),
        (*body.acceleration, body.angular_acceleration),
    )


def misfits(scene: Scene, states: Mapping[str, State], orders: int = 3) -> Iterator[Misfit]:
    """Every joint's violation at the first ``orders`` levels; a slider's includes its turning against the host."""
    everyone = {GROUND: STILL, **states}
    for pin in scene.pins:
        first = _anchor(everyone[pin.first], pin.first_anchor)
        second = _anchor(everyone[pin.second], pin.second_anchor)
        for order in range(orders):
            yield Misfit(pin.name, order, math.dist(first[order], second[order]))
    for joint in scene.guided:
        body, host = everyone[joint.body], everyone[joint.host]
        for order, size in enumerate(_offsets(joint, body, host)[:orders]):
            yield Misfit(joint.name, order, abs(size))
    if orders == 1:
        return  # a slider's angle against its host is whatever it was at the start
    for slider in scene.sliders:
        body, host = everyone[slider.body], everyone[slider.host]
        arm = math.hypot(*slider.anchor) or scene_size(scene)
        yield Misfit(slider.name, 1, arm * abs(body.velocity[2] - host.velocity[2]))
        if orders > 2:
            yield Misfit(slider.name, 2, arm * abs(body.acceleration[2] - host.acceleration[2]))


def _anchor(state: State, anchor: Vector) -> tuple[Vector, Vector, Vector]:
    """Position, velocity and acceleration of a point fixed in a body."""
    (x, y, angle), (vx, vy, rate), (ax, ay, second) = state.position, state.velocity, state.acceleration
    c, s = math.cos(angle), math.sin(angle)
    rx, ry = c * anchor[0] - s * anchor[1], s * anchor[0] + c * anchor[1]
    return (
        (x + rx, y + ry),
        (vx - rate * ry, vy + rate * rx),
        (ax - second * ry - rate * rate * rx, ay + second * rx - rate * rate * ry),
    )


def _offsets(joint: SliderJoint | SlotJoint, body: State, host: State) -> Triple:
    """Distance of the joint's anchor from the host's line, n·(p − q), and its two time derivatives."""
    p, q = _anchor(body, joint.anchor), _anchor(host, joint.through)
    d, v, a = ((one[0] - other[0], one[1] - other[1]) for one, other in zip(p, q, strict=True))
    c, s = math.cos(host.position[2]), math.sin(host.position[2])
    tx, ty = c * joint.along[0] - s * joint.along[1], s * joint.along[0] + c * joint.along[1]
    rate, second = host.velocity[2], host.acceleration[2]

    def across(u: Vector) -> float:
        return tx * u[1] - ty * u[0]

    def along(u: Vector) -> float:
        return tx * u[0] + ty * u[1]

    # The normal turns with the host: n' = -ω t, t' = ω n.
    return (
        across(d),
        across(v) - rate * along(d),
        across(a) - 2.0 * rate * along(v) - second * along(d) - rate * rate * across(d),
    )


def scene_size(scene: Scene) -> float:
    """Largest distance of a joint's anchor from its body's mass centre, m: the scale of what a gap may be."""
    anchors = [pin.first_anchor for pin in scene.pins]
    anchors += [pin.second_anchor for pin in scene.pins if pin.second != GROUND]
    return max((math.hypot(*anchor) for anchor in anchors), default=0.0) or 1.0


def start_misfit(scene: Scene, tolerance: float = 1e-6) -> str | None:
    """One sentence on the joint the start state fits worst, or on a crank that is not where its drive has it."""
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    if isinstance(scene.drive, Prescribed):
        segment = scene.drive.motion.segments[0]
        wanted = [float(segment.value(segment.start, order)) for order in range(3)]
        got = [crank.angle, crank.angular_velocity, crank.angular_acceleration]
        for order, (one, other) in enumerate(zip(wanted, got, strict=True)):
            if abs(one - other) > tolerance * max(1.0, abs(one)):
                return f"the crank starts with an angular {QUANTITIES[order]} of {other:g}, its drive with {one:g}"
    size = scene_size(scene)
    fastest = max(math.hypot(*b.velocity) + abs(b.angular_velocity) * size for b in scene.bodies)
    hardest = max(math.hypot(*b.acceleration) + abs(b.angular_acceleration) * size for b in scene.bodies)
    scales = (size, fastest or 1.0, (hardest + fastest**2 / size) or 1.0)
    found = [miss for miss in misfits(scene, start_state(scene)) if not miss.size <= tolerance * scales[miss.order]]
    if not found:
        return None
    worst = max(found, key=lambda miss: miss.size / scales[miss.order])
    where = f"joint '{worst.joint}' by {worst.size:.3g} {UNITS[worst.order]}"
    return f"the start state violates {where} in {QUANTITIES[worst.order]}; give one that fits every joint"
