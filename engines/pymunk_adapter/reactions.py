"""The constraints of a layout as linear algebra: joint gaps, joint forces, and how fast pymunk's solver converges.

pymunk tells the magnitude of a constraint's impulse, not its direction. The vectors follow from what the solver did to
the bodies: over one step every part obeys m (v⁺ − v⁻)/h = load + Σ joint forces, with the joints' directions at the
positions of that instant, and a linkage whose crank is driven has exactly as many unknown forces as equations. The
solution is the impulses that the solver applied, to rounding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Vector
from engines.pymunk_adapter.layout import STILL, Hold, Kind, Layout

Array = NDArray[np.float64]

# Samples whose joint forces are solved for at once.
BLOCK = 10_000


def turned(vector: Vector, angle: Array) -> Array:
    """A vector of a body's frame in the ground frame, (n, 2), for angles (n,)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]], axis=-1)


def across(vector: Array) -> Array:
    """Vectors turned by a right angle, counter-clockwise."""
    return np.stack([-vector[..., 1], vector[..., 0]], axis=-1)


def _angle(state: Array, number: int) -> Array:
    return np.zeros(len(state)) if number == STILL else np.asarray(state[:, number, 2])


def _arm(state: Array, number: int, anchor: Vector) -> Array:
    return turned(anchor, _angle(state, number))


def _place(state: Array, number: int, arm: Array) -> Array:
    return arm if number == STILL else state[:, number, :2] + arm


def _span(hold: Hold, state: Array) -> tuple[Array, Array, Array]:
    """Arms of both anchors and the vector from the second anchor to the first."""
    first = _arm(state, hold.first, hold.first_anchor)
    second = _arm(state, hold.second, hold.second_anchor)
    return first, second, _place(state, hold.first, first) - _place(state, hold.second, second)


def gaps(layout: Layout, state: Array) -> Array:
    """How far each pin or groove is open, m, (n, holds); 0 for gears. ``state`` is (n, parts, 3): x, y, θ."""
    result = np.zeros((len(state), len(layout.holds)))
    for column, hold in enumerate(layout.holds):
        if hold.kind is Kind.GEAR:
            continue
        span = _span(hold, state)[2]
        if hold.kind is Kind.GROOVE:
            span = np.sum(span * _normal(hold, state), axis=-1, keepdims=True)
        result[:, column] = np.linalg.norm(span, axis=-1)
    return result


def _normal(hold: Hold, state: Array) -> Array:
    return turned((-hold.along[1], hold.along[0]), _angle(state, hold.second))


def directions(layout: Layout, state: Array) -> tuple[Array, list[int]]:
    """The constraints' directions: unit joint forces as generalised forces on the parts.

    Returns (n, rows, parts, 3) and the first row of each hold, the last entry being the row of the drive on the crank.
    A pin has two rows (force on its first part along x and y), a groove one (along its normal), a gear one (a torque).
    """
    starts = [0]
    for hold in layout.holds:
        starts.append(starts[-1] + (2 if hold.kind is Kind.PIN else 1))
    rows = np.zeros((len(state), starts[-1] + 1, *state.shape[1:]))
    for hold, start in zip(layout.holds, starts[:-1], strict=True):
        if hold.kind is Kind.GEAR:
            _fill_gear(rows[:, start], hold)
        else:
            _fill_forces(rows, start, hold, state)
    rows[:, -1, layout.crank, 2] = 1.0
    return rows, starts


def _fill_gear(row: Array, hold: Hold) -> None:
    for number, sign in ((hold.first, 1.0), (hold.second, -1.0)):
        if number != STILL:
            row[:, number, 2] = sign


def _fill_forces(rows: Array, start: int, hold: Hold, state: Array) -> None:
    first, second, span = _span(hold, state)
    if hold.kind is Kind.PIN:
        ways = [np.array([1.0, 0.0]), np.array([0.0, 1.0])]
    else:
        ways = [_normal(hold, state)]
        second = second + span  # the groove pushes on its host where the pin is
    for number, arm, sign in ((hold.first, first, 1.0), (hold.second, second, -1.0)):
        if number != STILL:
            for row, way in enumerate(ways, start):
                rows[:, row, number, :2] = sign * way
                rows[:, row, number, 2] = sign * np.einsum("nk,nk->n", across(arm), np.broadcast_to(way, arm.shape))


def _inertias(layout: Layout) -> Array:
    """(parts, 3): mass, mass and inertia; infinite where a part cannot turn."""
    return np.array([(p.mass, p.mass, np.inf if p.inertia is None else p.inertia) for p in layout.parts])


def joint_forces(layout: Layout, state: Array, acceleration: Array, load: Array) -> dict[str, Array]:
    """Force of every joint of the scene on its first body, N, ground frame, (n, 2) by name.

    ``acceleration`` (n, parts, 3) is (v⁺ − v⁻)/h at the instants of ``state``; ``load`` (n, parts, 3) the forces and
    torques of everything but joints and drive. Under a free drive the drive's row comes out as zero. Solved block by
    block: the equations of a sample take a hundred times the room of its forces.
    """
    blocks = [
        _joint_forces(layout, *(values[start : start + BLOCK] for values in (state, acceleration, load)))
        for start in range(0, max(1, len(state)), BLOCK)
    ]
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def _joint_forces(layout: Layout, state: Array, acceleration: Array, load: Array) -> dict[str, Array]:
    rows, starts = directions(layout, state)
    inertias = _inertias(layout)
    free = np.isfinite(inertias)
    demand = (np.where(free, inertias, 0.0) * acceleration - load)[:, free]
    solved = np.linalg.solve(np.swapaxes(rows[:, :, free], 1, 2), demand[..., None])
    forces = np.asarray(solved[..., 0], dtype=np.float64)
    result: dict[str, Array] = {}
    for hold, start in zip(layout.holds, starts[:-1], strict=True):
        if hold.joint is not None:
            pin = hold.kind is Kind.PIN
            result[hold.joint] = forces[:, start : start + 2] if pin else forces[:, start, None] * _normal(hold, state)
    return result


def contraction(layout: Layout, state: Array) -> Array:
    """Factor by which one iteration of pymunk's solver shrinks its error in the long run, (n,), at given positions.

    The solver is a block Gauss-Seidel iteration on A = G M⁻¹ Gᵀ, constraint by constraint in the order of the holds,
    the motor last; this is the spectral radius of its iteration matrix. Raises LinAlgError where A has an empty row.
    """
    rows, starts = directions(layout, state)
    mobility = np.einsum("nipk,pk,njpk->nij", rows, 1.0 / _inertias(layout), rows)
    block = np.repeat(np.arange(len(starts)), np.diff([*starts, rows.shape[1]]))
    lower = np.where(block[:, None] >= block[None, :], mobility, 0.0)
    return np.asarray(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - mobility))), axis=1))
