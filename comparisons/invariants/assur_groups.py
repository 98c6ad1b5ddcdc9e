"""The Assur groups of a scene, from its joints' equations, and their assembly modes."""

from __future__ import annotations

import itertools

import numpy as np

from analytic.description.linkage import GROUND, Vector
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import Numbers, Reals


class AssurGroups:
    """The groups: each the fewest bodies not yet placed that their joints place.

    Their joints among each other and with placed bodies give as many equations as they have coordinates. What cannot
    be divided further is one group, whatever its class. ``blocks`` holds the rows and columns of each; rows come in
    pairs (2, k): the equation is the first one less the second, where ``equations.rows`` and more stand for none.
    """

    def __init__(self, equations: JointEquations) -> None:
        self.equations = equations
        self._pins = self._pin_points()
        self.blocks: list[tuple[Numbers, Numbers]] = []
        self.members: list[tuple[str, ...]] = []
        placed = {GROUND, equations.scene.crank} if equations.scene.crank else {GROUND}
        left = [name for name in equations.index if name not in placed]
        while left:
            sets = (bodies for k in range(1, len(left) + 1) for bodies in itertools.combinations(left, k))
            group = next(bodies for bodies in sets if len(bodies) == len(left) or self._places(bodies, placed))
            rows = np.array(self._rows_of(group, placed), dtype=np.intp).T
            self.blocks.append((rows, self._columns(group)))
            self.members.append(group)
            placed |= {*group}
            left = [name for name in left if name not in group]

    def _columns(self, bodies: tuple[str, ...]) -> Numbers:
        columns = self.equations.column[[self.equations.index[name] for name in bodies]]
        return np.asarray(columns[columns != self.equations.size])

    def _places(self, bodies: tuple[str, ...], placed: set[str]) -> bool:
        return len(self._rows_of(bodies, placed)) == len(self._columns(bodies))

    def _rows_of(self, bodies: tuple[str, ...], placed: set[str]) -> list[tuple[int, int]]:
        """Equations of the joints of these bodies with each other and with placed bodies."""
        equations, none = self.equations, self.equations.rows
        rows = []
        for ends in self._pins:
            known = [pin for body, pin in ends if body in placed]
            new = [pin for body, pin in ends if body in bodies]
            seat, others = (known[0], new) if known else (new[0], new[1:]) if new else (none, [])
            for pin in others:
                for first in (equations.x_rows, equations.y_rows):
                    pair = sorted(int(first[number]) if number < none else none for number in (pin, seat))
                    rows.append((pair[0], pair[1]))
        known_bodies = {equations.index[name] for name in placed | {*bodies}}
        new_bodies = {equations.index[name] for name in bodies}
        constrained = [
            *zip(equations.line_rows, equations.body[equations.pins :], equations.host[equations.pins :], strict=True),
            *zip(equations.turn_rows, equations.turn_body, equations.turn_host, strict=True),
        ]
        if equations.scene.cylinder is not None:
            constrained.append((equations.crank_row, *equations.driver.ends))
        for row, *ends in constrained:
            if {*ends} <= known_bodies and {*ends} & new_bodies:
                rows.append((int(row), none))
        return rows

    def _pin_points(self) -> list[list[tuple[str, int]]]:
        """The bodies on every pin with the number of their joint: any of them can be the others' seat."""
        points: dict[tuple[str, Vector], list[tuple[str, int]]] = {}
        for number, pin in enumerate(self.equations.scene.pins):
            seat = points.setdefault((pin.second, pin.second_anchor), [(pin.second, self.equations.rows)])
            seat.append((pin.first, number))
        return list(points.values())

    def determinants(self, jacobian: Reals) -> Reals:
        """Determinant of every group's equations over the product of its rows' lengths, (instants, groups): no unit.

        Its sign tells the two assembly modes of a group apart; it is 0 where they meet.
        """
        groups = [np.ones(len(jacobian))]
        for rows, columns in self.blocks:
            block = jacobian[:, rows[0][:, None], columns]
            seated = np.flatnonzero(rows[1] < self.equations.rows)
            block[:, seated] -= jacobian[:, rows[1][seated][:, None], columns]
            lengths = np.sqrt(np.einsum("nrc,nrc->nr", block, block))
            groups.append(np.linalg.det(block / lengths[:, :, None]))
        return np.stack(groups, axis=1)
