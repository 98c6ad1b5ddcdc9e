"""Loads that change from step to step, and all loads of a scene as forces on the parts of its layout.

A step of pymunk first moves the bodies, then asks for forces. So what is set before a step has to be that of the positions
it will reach: the present ones moved on by the present velocities. Velocities at that instant lie half a step ahead of the
last ones known and are extrapolated from the last two, 1.5 v₁ − 0.5 v₂, which keeps dampers of second order.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analytic.laws import FULL_TURN, Law
from analytic.linkage import GROUND, Vector
from engines.contract import PointSpring, Scene, TurnDamper
from engines.pymunk_layout import STILL, Layout
from engines.pymunk_reactions import across, turned
from engines.pymunk_space import World, carried_anchor, part_number

if TYPE_CHECKING:
    import pymunk

Array = NDArray[np.float64]
Add = Callable[["pymunk.Body", float, float, float], None]


def scalar_law(law: Law, component: int) -> Callable[[float], float]:
    """One component of a load over φ as a plain function of a float: a table's cubics, read off at its angles."""
    if law.angles is None:
        constant = float(law.values[component])
        return lambda _angle: constant
    knots = law.angles.tolist()
    first = knots[0]
    cubics = [law(law.angles, k)[component] / math.factorial(k) for k in range(4)]
    pieces = list(zip(*(c.tolist() for c in cubics), strict=True))

    def value(angle: float) -> float:
        angle = first + (angle - first) % FULL_TURN
        piece = bisect_right(knots, angle) - 1
        x = angle - knots[piece]
        a, b, c, d = pieces[piece]
        return float(a + x * (b + x * (c + x * d)))

    return value


class StepLoads:
    """The loads that have to be set anew before every step of ``step`` seconds.

    ``ahead`` aims them at the positions and velocities of the step to come; else they are those of the last one, as a
    newcomer would have them.
    """

    def __init__(self, world: World, scene: Scene, step: float, *, ahead: bool) -> None:
        self._crank = world.crank
        self._ground = world.space.static_body
        self._reach = step if ahead else 0.0
        self._sums: dict[pymunk.Body, list[float]] = {}
        self._turning = any(not load.force.is_constant for load in scene.forces) or any(
            not load.torque.is_constant for load in scene.torques
        )
        self._parts: list[Callable[[float], None]] = [
            self._force(world, scene, number) for number, f in enumerate(scene.forces) if not f.force.is_constant
        ]
        self._parts += [
            self._torque(world.part(part_number(scene, load.body)), scalar_law(load.torque, 0))
            for load in scene.torques
            if not load.torque.is_constant and load.body != GROUND
        ]
        if ahead:  # otherwise pymunk's own springs damp
            self._parts += [self._damper(world, scene, damper) for damper in scene.dampers]
            self._parts += [self._dashpot(world, scene, k) for k, s in enumerate(scene.springs) if s.damping]

    def __bool__(self) -> bool:
        return bool(self._parts)

    def __call__(self) -> None:
        """Set everything for the next step."""
        angle = self._crank.angle + self._reach * self._crank.angular_velocity if self._turning else 0.0
        for total in self._sums.values():
            total[0] = total[1] = total[2] = 0.0
        for part in self._parts:
            part(angle)
        for body, (x, y, torque) in self._sums.items():
            if x or y:
                body.force = (x, y)
            body.torque = torque

    def _total(self, body: pymunk.Body) -> list[float]:
        """Where the loads on a body are summed; those on the ground go nowhere."""
        total = [0.0, 0.0, 0.0]
        return total if body is self._ground else self._sums.setdefault(body, total)

    def _force(self, world: World, scene: Scene, number: int) -> Callable[[float], None]:
        load = scene.forces[number]
        index = part_number(scene, load.body)
        if index == STILL:
            return lambda _angle: None
        body, reach, total = world.bodies[index], self._reach, self._total(world.bodies[index])
        x, y = carried_anchor(world.layout, index, load.anchor)
        along_x, along_y = scalar_law(load.force, 0), scalar_law(load.force, 1)

        def add(angle: float) -> None:
            turn = body.angle + reach * body.angular_velocity
            c, s = math.cos(turn), math.sin(turn)
            fx, fy = along_x(angle), along_y(angle)
            total[0] += fx
            total[1] += fy
            total[2] += (c * x - s * y) * fy - (s * x + c * y) * fx

        return add

    def _torque(self, body: pymunk.Body, law: Callable[[float], float]) -> Callable[[float], None]:
        total = self._total(body)

        def add(angle: float) -> None:
            total[2] += law(angle)

        return add

    def _damper(self, world: World, scene: Scene, damper: TurnDamper) -> Callable[[float], None]:
        first, second = (world.part(part_number(scene, name)) for name in (damper.first, damper.second))
        first_total, second_total = self._total(first), self._total(second)
        coefficient, last = damper.coefficient, first.angular_velocity - second.angular_velocity

        def add(_angle: float) -> None:
            nonlocal last
            rate = first.angular_velocity - second.angular_velocity
            torque = coefficient * (1.5 * rate - 0.5 * last)
            last = rate
            first_total[2] -= torque
            second_total[2] += torque

        return add

    def _dashpot(self, world: World, scene: Scene, number: int) -> Callable[[float], None]:
        """A dashpot as a change of its spring's rest length, its speed from the lengths at three instants."""
        spring, engine, reach = scene.springs[number], world.springs[number], self._reach
        ends = [(engine.a, *engine.anchor_a), (engine.b, *engine.anchor_b)]
        stretch = spring.damping / engine.stiffness

        def length(ahead: float) -> float:
            places = []
            for body, x, y in ends:
                (px, py), (vx, vy), turn = body.position, body.velocity, body.angle + ahead * body.angular_velocity
                c, s = math.cos(turn), math.sin(turn)
                places.append((px + ahead * vx + c * x - s * y, py + ahead * vy + s * x + c * y))
            return math.dist(*places)

        before: list[float] = []

        def add(_angle: float) -> None:
            now = length(reach)
            if not before:
                before.extend((length(0.0), length(-reach)))
            last, second_last = before
            speed = (3.0 * now - 4.0 * last + second_last) / (2.0 * reach)
            before[:] = now, last
            engine.rest_length = (spring.length if spring.stiffness else now) - stretch * speed

        return add


def loads_on_parts(scene: Scene, layout: Layout, state: Array, velocity: Array) -> Array:
    """Forces and torques of all loads on the parts, (n, parts, 3), at positions ``state`` and velocities ``velocity``."""
    total = np.zeros_like(state)
    masses = np.array([part.mass for part in layout.parts])
    total[:, :, :2] = masses[:, None] * np.asarray(scene.gravity)
    angle = state[:, layout.crank, 2]
    for force in scene.forces:
        _add_force(layout, state, total, part_number(scene, force.body), force.anchor, force.force(angle).T)
    for torque in scene.torques:
        _add_torque(total, part_number(scene, torque.body), torque.torque(angle)[0])
    for damper in scene.dampers:
        first, second = part_number(scene, damper.first), part_number(scene, damper.second)
        moment = damper.coefficient * (_turn_rate(velocity, second) - _turn_rate(velocity, first))
        _add_torque(total, first, moment)
        _add_torque(total, second, -moment)
    for spring in scene.springs:
        _add_spring(scene, layout, state, velocity, total, spring)
    return total


def _turn_rate(velocity: Array, number: int) -> Array:
    return np.zeros(len(velocity)) if number == STILL else velocity[:, number, 2]


def _add_torque(total: Array, number: int, torque: Array) -> None:
    if number != STILL:
        total[:, number, 2] += torque


def _add_force(layout: Layout, state: Array, total: Array, number: int, anchor: Vector, force: Array) -> None:
    if number != STILL:
        arm = turned(carried_anchor(layout, number, anchor), state[:, number, 2])
        total[:, number, :2] += force
        total[:, number, 2] += np.sum(across(arm) * force, axis=-1)


def _add_spring(
    scene: Scene, layout: Layout, state: Array, velocity: Array, total: Array, spring: PointSpring
) -> None:
    ends = (spring.first, spring.first_anchor), (spring.second, spring.second_anchor)
    places, rates = [], []
    for name, anchor in ends:
        number = part_number(scene, name)
        if number == STILL:
            places.append(np.broadcast_to(np.asarray(anchor), (len(state), 2)))
            rates.append(np.zeros((len(state), 2)))
            continue
        arm = turned(carried_anchor(layout, number, anchor), state[:, number, 2])
        places.append(state[:, number, :2] + arm)
        rates.append(velocity[:, number, :2] + velocity[:, number, 2:] * across(arm))
    span = places[1] - places[0]
    length = np.linalg.norm(span, axis=-1, keepdims=True)
    way = span / length
    speed = np.sum(way * (rates[1] - rates[0]), axis=-1, keepdims=True)
    pull = way * (spring.stiffness * (length - spring.length) + spring.damping * speed)
    for (name, anchor), force in zip(ends, (pull, -pull), strict=True):
        _add_force(layout, state, total, part_number(scene, name), anchor, force)
