"""The joints of a scene as equations, and how far off a state is that does not fit them.

Coordinates are x, y of every mass centre and the angle of every body that can turn. Equations are two per pin, one per
guided point, one per slider that turns with its host, and the crank's: as many as coordinates. Lengths are counted in
the scene's size, so that every number here is a ratio or an angle.

No formula is shared with the closed form (no dyad is solved, no triangle), and no code with any engine.
"""

from __future__ import annotations

import itertools
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Vector
from comparisons.observation.body_states import Pair, States
from engines.scene import Scene, SliderJoint, SlotJoint
from engines.start_check import scene_size

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class JointEquations:
    """Φ(q) of a scene; rows are pins, guided points, turning sliders, crank."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.size = scene_size(scene)
        self.numbers = {body.name: number for number, body in enumerate(scene.bodies)}
        turning = np.array([body.inertia is not None for body in scene.bodies])
        self.free = np.stack([np.ones_like(turning), np.ones_like(turning), turning], axis=1)
        self.coordinates = int(self.free.sum())
        self.columns = np.full(self.free.shape, self.coordinates, dtype=np.intp)  # a spare one takes what is fixed
        self.columns[self.free] = np.arange(self.coordinates)
        self.turning_sliders = [s for s in scene.sliders if self._turns(s.body) or self._turns(s.host)]
        self.pin_rows = 2 * np.arange(len(scene.pins))
        self.line_rows = 2 * len(scene.pins) + np.arange(len(scene.guided))
        self.count = 2 * len(scene.pins) + len(scene.guided) + len(self.turning_sliders) + 1
        angle = {**{body.name: body.angle for body in scene.bodies}, GROUND: 0.0}
        self._held = [angle[slider.body] - angle[slider.host] for slider in self.turning_sliders]

    def _turns(self, body: str) -> bool:
        return body != GROUND and bool(self.free[self.numbers[body], 2])

    @property
    def still(self) -> tuple[tuple[int, float], ...]:
        """Bodies that slide without turning, by number, with the angle they keep, rad."""
        guided = {slider.body for slider in self.scene.sliders}
        bodies = self.scene.bodies
        return tuple((n, b.angle) for n, b in enumerate(bodies) if b.name in guided and b.inertia is None)

    @cached_property
    def groups(self) -> tuple[tuple[Indices, Indices], ...]:
        """Rows and columns of each Assur group: the fewest bodies not yet placed that their joints place.

        Their joints among each other and with what is placed give as many equations as they have coordinates. What
        cannot be divided further is one group, whatever its class. Rows come in pairs (2, k): the equation is the first
        one less the second, where ``count`` and more stand for none.
        """
        placed, left, found = {GROUND, self.scene.crank}, list(self.numbers), []
        left.remove(self.scene.crank)
        while left:
            sets = (chosen for k in range(1, len(left) + 1) for chosen in itertools.combinations(left, k))
            chosen = next(some for some in sets if len(some) == len(left) or self._places(some, placed))
            columns = self.columns[[self.numbers[name] for name in chosen]]
            rows = np.array(self._rows_of(chosen, placed), dtype=np.intp).T
            found.append((rows, columns[columns != self.coordinates]))
            placed |= {*chosen}
            left = [name for name in left if name not in chosen]
        return tuple(found)

    def _places(self, chosen: tuple[str, ...], placed: set[str]) -> bool:
        unknown = int(self.free[[self.numbers[name] for name in chosen]].sum())
        return len(self._rows_of(chosen, placed)) == unknown

    def _rows_of(self, chosen: tuple[str, ...], placed: set[str]) -> list[tuple[int, int]]:
        """Equations of the joints of these bodies with each other and with what is placed."""
        found = []
        for ends in self._pin_points():
            known = [row for body, row in ends if body in placed]
            new = [row for body, row in ends if body in chosen]
            seat, others = (known[0], new) if known else (new[0], new[1:]) if new else (0, [])
            found += [(min(row, seat) + part, max(row, seat) + part) for row in others for part in (0, 1)]
        known_bodies = placed | {*chosen}
        held = [*self.scene.guided, *self.turning_sliders]
        for row, joint in enumerate(held, 2 * len(self.scene.pins)):
            pair = {joint.body, joint.host}
            if pair <= known_bodies and pair & {*chosen}:
                found.append((row, self.count))
        return found

    def _pin_points(self) -> list[list[tuple[str, int]]]:
        """The bodies on every pin with the first of their two rows: any of them can be the others' seat."""
        points: dict[tuple[str, Vector], list[tuple[str, int]]] = {}
        for number, pin in enumerate(self.scene.pins):
            seat = points.setdefault((pin.second, pin.second_anchor), [(pin.second, self.count)])
            seat.append((pin.first, 2 * number))
        return list(points.values())

    def jacobian(self, states: States) -> Array:
        """G = ∂Φ/∂q, (instants, equations, coordinates)."""
        entries = np.zeros((len(states.position), self.count, self.coordinates + 1))
        for row, pin in zip(self.pin_rows, self.scene.pins, strict=True):
            for body, anchor, sign in ((pin.first, pin.first_anchor, 1.0), (pin.second, pin.second_anchor, -1.0)):
                self._add(entries[:, row], states, body, anchor, (sign, 0.0))
                self._add(entries[:, row + 1], states, body, anchor, (0.0, sign))
        for row, joint in zip(self.line_rows, self.scene.guided, strict=True):
            x, y = states.turned(joint.host, joint.along)
            self._add(entries[:, row], states, joint.body, joint.anchor, (-y, x))
            self._add(entries[:, row], states, joint.host, joint.through, (y, -x))
            if joint.host != GROUND:  # the line turns with its host, and its normal by −θ' along
                gap = states.gap((joint.body, joint.anchor), (joint.host, joint.through))
                entries[:, row, self.columns[self.numbers[joint.host], 2]] -= x * gap[0] + y * gap[1]
        for number, slider in enumerate(self.turning_sliders, self.count - 1 - len(self.turning_sliders)):
            for body, sign in ((slider.body, 1.0), (slider.host, -1.0)):
                if body != GROUND:
                    entries[:, number, self.columns[self.numbers[body], 2]] = sign
        entries[:, -1, self.columns[self.numbers[self.scene.crank], 2]] = 1.0
        return entries[:, :, :-1]

    def _add(self, entries: Array, states: States, body: str, anchor: Vector, normal: Pair) -> None:
        """What moving a body moves one of its points along a direction."""
        if body != GROUND:
            x, y = states.arm(body, anchor)
            first, second, third = self.columns[self.numbers[body]]
            entries[:, first], entries[:, second] = normal
            entries[:, third] = normal[1] * x - normal[0] * y

    def residual(self, states: States, order: int) -> Array:
        """Φ or its time derivative of this order, (instants, equations); the crank's row is its angle or rate."""
        rows: list[Array | float] = []
        for pin in self.scene.pins:
            rows += states.gap((pin.first, pin.first_anchor), (pin.second, pin.second_anchor), order)
        rows += [_off_line(states, joint, order) for joint in self.scene.guided]
        for slider, held in zip(self.turning_sliders, self._held, strict=True):
            turn = states.angle(slider.body, order) - states.angle(slider.host, order)
            rows.append(np.sin(turn - held) if order == 0 else turn)
        rows.append(states.angle(self.scene.crank, order))
        result = np.empty((len(states.position), self.count))
        for number, row in enumerate(rows):
            result[:, number] = row
        return result

    def spread(self, coordinates: Array) -> Array:
        """Coordinates (instants, k) as (instants, bodies, 3), 0 where fixed."""
        result = np.zeros((len(coordinates), *self.free.shape))
        result[:, self.free] = coordinates
        return result

    def group_determinants(self, jacobian: Array) -> Array:
        """Determinant of every group's equations over the product of its rows' lengths, (instants, groups): no unit.

        Its sign tells the two assembly modes of a group apart; it is 0 where they meet.
        """
        found = [np.ones(len(jacobian))]
        for rows, columns in self.groups:
            block = jacobian[:, rows[0][:, None], columns]
            seated = np.flatnonzero(rows[1] < self.count)
            block[:, seated] -= jacobian[:, rows[1][seated][:, None], columns]
            lengths = np.sqrt(np.einsum("nrc,nrc->nr", block, block))
            found.append(np.linalg.det(block / lengths[:, :, None]))
        return np.stack(found, axis=1)


def _off_line(states: States, joint: SliderJoint | SlotJoint, order: int) -> Array:
    """How far a guided point is off its line, or a time derivative of that; the line's normal turns by −θ' along."""
    x, y = states.turned(joint.host, joint.along)

    def across(order: int) -> Array:
        gap = states.gap((joint.body, joint.anchor), (joint.host, joint.through), order)
        return np.asarray(x * gap[1] - y * gap[0])

    def along(order: int) -> Array:
        gap = states.gap((joint.body, joint.anchor), (joint.host, joint.through), order)
        return np.asarray(x * gap[0] + y * gap[1])

    if order == 0 or joint.host == GROUND:
        return across(order)
    rate = states.angle(joint.host, 1)
    if order == 1:
        return across(1) - rate * along(0)
    return across(2) - 2.0 * rate * along(1) - states.angle(joint.host, 2) * along(0) - rate**2 * across(0)
