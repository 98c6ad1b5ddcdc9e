"""Loads that change from step to step and have to be set before each.

A step of pymunk first moves the bodies, then asks for forces. So what is set before a step has to be that of the
positions it will reach: the present ones moved on by the present velocities. Velocities at that instant lie half a step
ahead of the last ones known and are extrapolated from the last two, 1.5 v₁ − 0.5 v₂: dampers are of second order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from analytic.description.law import TimeLaw
from analytic.description.linkage import GROUND
from engines.pymunk_adapter.linear_drive import Line, set_push
from engines.pymunk_adapter.space import PymunkWorld
from engines.scene import AppliedForce, Free, PointSpring, TurnDamper

if TYPE_CHECKING:
    import pymunk


class StepLoads:
    """The loads that have to be set anew before every step.

    ``ahead`` aims them at the positions and velocities of the step to come; else they are those of the last one, as a
    newcomer would have them.
    """

    def __init__(self, world: PymunkWorld, *, ahead: bool) -> None:
        scene = world.layout.scene
        self._ahead, self.reach = ahead, 0.0
        self._travel = world.travel
        self._ground = world.space.static_body
        self._sums: dict[pymunk.Body, list[float]] = {}
        self._turning = any(not load.force.is_constant for load in scene.forces) or any(
            not load.torque.is_constant for load in scene.torques
        )
        self._parts: list[Callable[[float], None]] = [
            self._force(world, load) for load in scene.forces if not load.force.is_constant
        ]
        self._parts += [
            self._torque(world.ends[load.body], load.torque.of_float())
            for load in scene.torques
            if not load.torque.is_constant and load.body != GROUND
        ]
        self._time, drive = 0.0, scene.drive
        if isinstance(drive, Free) and drive.over_time is not None:
            law = drive.over_time
            self._parts.append(self._pushed(world, world.line, law) if world.line else self._timed(world.crank, law))
        if ahead:  # otherwise pymunk's own springs damp
            self._parts += [self._damper(world, damper) for damper in scene.dampers]
            self._parts += [
                self._dashpot(spring, engine)
                for spring, engine in zip(scene.springs, world.springs, strict=True)
                if spring.damping
            ]

    def __bool__(self) -> bool:
        return bool(self._parts)

    def __call__(self, step: float) -> None:
        """Set everything for the next step, s."""
        self.reach = step if self._ahead else 0.0
        angle = self._travel(self.reach) if self._turning else 0.0
        for total in self._sums.values():
            total[0] = total[1] = total[2] = 0.0
        for part in self._parts:
            part(angle)
        for body, (x, y, torque) in self._sums.items():
            if x or y:
                body.force = (x, y)
            body.torque = torque
        self._time += step

    def _total(self, body: pymunk.Body) -> list[float]:
        """Where the loads on a body are summed; those on the ground go nowhere."""
        total = [0.0, 0.0, 0.0]
        return total if body is self._ground else self._sums.setdefault(body, total)

    def _force(self, world: PymunkWorld, load: AppliedForce) -> Callable[[float], None]:
        body = world.ends[load.body]
        (x, y), total = load.anchor, self._total(body)
        law = load.force.of_float()

        def add(angle: float) -> None:
            turn = body.angle + self.reach * body.angular_velocity
            c, s = math.cos(turn), math.sin(turn)
            fx, fy = law(angle)
            total[0] += fx
            total[1] += fy
            total[2] += (c * x - s * y) * fy - (s * x + c * y) * fx

        return add

    def _torque(self, body: pymunk.Body, law: Callable[[float], tuple[float, ...]]) -> Callable[[float], None]:
        total = self._total(body)

        def add(angle: float) -> None:
            total[2] += law(angle)[0]

        return add

    def _timed(self, crank: pymunk.Body, law: TimeLaw) -> Callable[[float], None]:
        total = self._total(crank)

        def add(_angle: float) -> None:
            total[2] += law.at(self._time + self.reach)

        return add

    def _pushed(self, world: PymunkWorld, line: Line, law: TimeLaw) -> Callable[[float], None]:
        spring = line.push(0.0)
        world.space.add(spring)

        def add(_travel: float) -> None:
            set_push(spring, law.at(self._time + self.reach))

        return add

    def _damper(self, world: PymunkWorld, damper: TurnDamper) -> Callable[[float], None]:
        first, second = world.ends[damper.first], world.ends[damper.second]
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

    def _dashpot(self, spring: PointSpring, engine: pymunk.DampedSpring) -> Callable[[float], None]:
        """A dashpot as a change of its spring's rest length, its speed from the lengths at three instants."""
        ends = [(engine.a, *engine.anchor_a), (engine.b, *engine.anchor_b)]
        stretch = spring.damping / engine.stiffness

        def length(ahead: float) -> float:
            places = []
            for body, x, y in ends:
                (px, py), (vx, vy), turn = body.position, body.velocity, body.angle + ahead * body.angular_velocity
                c, s = math.cos(turn), math.sin(turn)
                places.append((px + ahead * vx + c * x - s * y, py + ahead * vy + s * x + c * y))
            return math.dist(*places)

        last = second_last = math.nan

        def add(_angle: float) -> None:
            nonlocal last, second_last
            if math.isnan(last):
                last, second_last = length(0.0), length(-self.reach)
            now = length(self.reach)
            speed = (3.0 * now - 4.0 * last + second_last) / (2.0 * self.reach)
            last, second_last = now, last
            engine.rest_length = (spring.length if spring.stiffness else now) - stretch * speed

        return add
