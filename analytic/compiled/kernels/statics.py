"""Force analysis on a block of crank angles: loads on the links, then the dyads from the last one back to the crank.

Formulas are those of ``analytic.dynamics.force_formulas``; the books are kept as in ``analytic.dynamics.link_balance``.
They are wrenches, three rows each, behind the bodies in the scratch memory: first what every body needs, by number,
then what the three joints of every dyad exert, last the force and moment on the frame and rows for whoever wants them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import analytic.compiled.kernels.formulas  # noqa: F401 - lets the loops call the formulas
from analytic.compiled.flat_linkage import CRANK_BODY, GROUND_BODY, PRP, RPP, RPR, RRP, RRR, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.dyads import closure_at
from analytic.compiled.kernels.jit import inlined, kernel
from analytic.compiled.kernels.layout import BLOCK, BODY, DDW, DW, LAW, LAWS, ROW, SECOND
from analytic.compiled.kernels.rows import pose, rate, second
from analytic.compiled.kernels.solution import body_at, fill, pair
from analytic.dynamics import force_formulas
from analytic.dynamics.force_formulas import Wrench, charged, drag, passed_on, pull, weight_and_inertia
from analytic.kinematics.dyads.closure import Closure
from analytic.kinematics.frames import Pair, arm, cross, minus, point, point_acceleration, point_rate

Array = NDArray[np.float64]

WRENCH: Final = 3 * ROW
JOINTS: Final = 3 * WRENCH  # of a dyad


@inlined
def wrench(row: Array, i: int) -> Wrench:
    """A wrench at the block's i-th angle."""
    return row[i], row[ROW + i], row[2 * ROW + i]


@inlined
def put(row: Array, i: int, values: Wrench) -> None:
    """Write it."""
    row[i], row[ROW + i], row[2 * ROW + i] = values


@inlined
def books_at(tables: Tables) -> int:
    """Where the books start in the scratch memory: behind the bodies."""
    return body_at(tables, len(tables.references))


@inlined
def first_joint(tables: Tables) -> int:
    """Where the dyads' joints start in the books."""
    return WRENCH * len(tables.references)


@inlined
def frame_at(tables: Tables) -> int:
    """Where the wrench on the frame is."""
    return first_joint(tables) + JOINTS * len(tables.dyads)


@inlined
def _of(tables: Tables, design: Array, body: int, at: int) -> Pair:
    """A point of a body from the body's reference point, in the body's frame."""
    return minus(pair(design, at), pair(design, tables.references[body]))


@kernel
def charge_mass(
    n: int, mass: float, inertia: float, centre: Pair, to: Pair, gravity: Pair, square: float, body: Array, needs: Array
) -> None:
    """Weight, inertia force and inertia torque of a link at a constant crank speed, whose ``square`` is given."""
    for i in range(min(n, BLOCK)):
        x, y = point_acceleration(pose(body, i), rate(body, i), second(body, i), centre)
        force = weight_and_inertia(mass, gravity, (square * x, square * y))
        torque = -inertia * (square * body[DDW + i])
        put(needs, i, charged(wrench(needs, i), force, arm(pose(body, i), to), torque))


@kernel
def charge_force(n: int, to: Pair, law: Array, body: Array, needs: Array) -> None:
    """A force at a point."""
    for i in range(min(n, BLOCK)):
        put(needs, i, charged(wrench(needs, i), (law[i], law[ROW + i]), arm(pose(body, i), to), 0.0))


@kernel
def charge_torque(n: int, law: Array, needs: Array) -> None:
    """A torque."""
    for i in range(min(n, BLOCK)):
        needs[2 * ROW + i] -= law[i]


@kernel
def charge_spring(
    n: int, end: Pair, other: Pair, to: Pair, law: tuple[float, float, float], one: Array, two: Array, needs: Array
) -> None:
    """A spring's pull on the first of its two bodies; the law is stiffness, free length, and damping times speed."""
    for i in range(min(n, BLOCK)):
        span = minus(point(pose(one, i), end), point(pose(two, i), other))
        rates = minus(point_rate(pose(one, i), rate(one, i), end), point_rate(pose(two, i), rate(two, i), other))
        tension = -(pull(span, law[0], law[1]) + drag(span, rates, law[2]))
        force = (tension * span[0], tension * span[1])
        put(needs, i, charged(wrench(needs, i), force, arm(pose(one, i), to), 0.0))


@kernel
def charge_damper(n: int, coefficient: float, one: Array, two: Array, needs: Array) -> None:
    """A rotary damper's torque on the first of its two bodies; the coefficient is times the crank's speed."""
    for i in range(min(n, BLOCK)):
        needs[2 * ROW + i] += coefficient * (one[DW + i] - two[DW + i])


@inlined
def charge_outside(tables: Tables, design: Array, n: int, speed: float, work: Array, books: Array) -> None:
    """What acts on the links from outside: ``link_loads.LoadedSweep.from_outside``."""
    gravity, square = pair(design, tables.gravity[0]), speed * speed
    for row in range(3 * len(tables.references)):
        fill(n, 0.0, books[ROW * row : ROW * row + BLOCK])
    for number in range(-1, len(tables.masses)):
        if number < 0:
            body, at = CRANK_BODY, tables.crank[layout.CRANK_MASS :]
        else:
            body, at = tables.masses[number, 0], tables.masses[number, 1:]
        mass, inertia = design[at[0]], design[at[2]]
        if mass != 0.0 or inertia != 0.0:
            centre, to, rows = pair(design, at[1]), _of(tables, design, body, at[1]), body_at(tables, body)
            needs = books[WRENCH * body : WRENCH * (body + 1)]
            charge_mass(n, mass, inertia, centre, to, gravity, square, work[rows : rows + BODY], needs)
    for number in range(len(tables.forces)):
        body, at, law = tables.forces[number]
        values, rows = LAWS + LAW * law, body_at(tables, body)
        to, needs = _of(tables, design, body, at), books[WRENCH * body : WRENCH * (body + 1)]
        charge_force(n, to, work[values : values + LAW], work[rows : rows + BODY], needs)
    for number in range(len(tables.torques)):
        body, law = tables.torques[number]
        values = LAWS + LAW * law
        charge_torque(n, work[values : values + LAW], books[WRENCH * body : WRENCH * (body + 1)])


@inlined
def charge_between(tables: Tables, design: Array, n: int, speed: float, work: Array, books: Array) -> None:
    """Springs, dashpots and dampers, on either of their bodies; what the ground then needs is of no use."""
    for end in range(2):
        for number in range(len(tables.springs)):
            spring = tables.springs[number]
            body, at, other, to = spring[2 * end], spring[2 * end + 1], spring[2 - 2 * end], spring[3 - 2 * end]
            law = (design[spring[4]], design[spring[5]], design[spring[6]] * speed)
            one, two, needs = body_at(tables, body), body_at(tables, other), WRENCH * body
            near, far = work[one : one + BODY], work[two : two + BODY]
            place, its = pair(design, at), _of(tables, design, body, at)
            charge_spring(n, place, pair(design, to), its, law, near, far, books[needs : needs + WRENCH])
        for number in range(len(tables.dampers)):
            damper = tables.dampers[number]
            one, two, needs = body_at(tables, damper[end]), body_at(tables, damper[1 - end]), WRENCH * damper[end]
            near, far = work[one : one + BODY], work[two : two + BODY]
            charge_damper(n, design[damper[2]] * speed, near, far, books[needs : needs + WRENCH])


@kernel
def _resultant(n: int, reference: Pair, about: Pair, body: Array, needs: Array, frame: Array) -> None:
    for i in range(min(n, BLOCK)):
        x, y, moment = wrench(needs, i)
        gap = minus(point(pose(body, i), reference), about)
        put(frame, i, (frame[i] - x, frame[ROW + i] - y, frame[2 * ROW + i] - moment - cross(gap, (x, y))))


@inlined
def load_frame(tables: Tables, design: Array, n: int, work: Array, books: Array) -> None:
    """Force on the frame and its moment about the crank's pivot: the reverse of what links need from outside loads."""
    at, about = frame_at(tables), pair(design, tables.crank[layout.CRANK_NEAR])
    frame = books[at : at + WRENCH]
    for row in range(3):
        fill(n, 0.0, frame[ROW * row : ROW * row + BLOCK])
    for body in range(CRANK_BODY, len(tables.references)):
        rows, needs = body_at(tables, body), books[WRENCH * body : WRENCH * (body + 1)]
        _resultant(n, pair(design, tables.references[body]), about, work[rows : rows + BODY], needs, frame)


def _dyad(formula: Any) -> Callable[[int, Pair, Array, Array, Array, Array], None]:
    """Kernel of one kind: what the joints exert, from what the two links need; ``second`` is its reference point."""

    @kernel
    def solved(n: int, reference: Pair, own: Array, one: Array, two: Array, joints: Array) -> None:
        for i in range(min(n, BLOCK)):
            of = closure_at(own, i)
            first, inner, other = formula(wrench(one, i), wrench(two, i), of, point(pose(own, SECOND + i), reference))
            put(joints, i, first)
            put(joints, WRENCH + i, inner)
            put(joints, 2 * WRENCH + i, other)

    return solved


def _plain(formula: Any) -> Any:
    """A formula that takes the closure's two vectors."""

    @inlined
    def of_closure(one: Wrench, two: Wrench, closure: Closure, place: Pair) -> force_formulas.JointWrenches:
        return formula(one, two, closure.u, closure.v)  # type: ignore[no-any-return]

    return of_closure


@inlined
def _crossing(one: Wrench, two: Wrench, closure: Closure, place: Pair) -> force_formulas.JointWrenches:
    """RPP: the closure has the inner slide's direction reversed, and the outer pin."""
    f = (-closure.v[0], -closure.v[1])
    return force_formulas.rpp(one, two, closure.u, f, minus(closure.pin, place))


_rrr, _rrp = _dyad(_plain(force_formulas.rrr)), _dyad(_plain(force_formulas.rrp))
_rpr, _prp = _dyad(_plain(force_formulas.rpr)), _dyad(_plain(force_formulas.prp))
_rpp = _dyad(_crossing)


@kernel
def _joints(kind: int, n: int, reference: Pair, own: Array, one: Array, two: Array, joints: Array) -> None:
    if kind == RRR:
        _rrr(n, reference, own, one, two, joints)
    elif kind == RRP:
        _rrp(n, reference, own, one, two, joints)
    elif kind == RPR:
        _rpr(n, reference, own, one, two, joints)
    elif kind == RPP:
        _rpp(n, reference, own, one, two, joints)
    else:
        _prp(n, reference, own, one, two, joints)


@kernel
def _on_pin(n: int, to: Pair, near: Array, joint: Array, needs: Array) -> None:
    for i in range(min(n, BLOCK)):
        put(needs, i, passed_on(wrench(needs, i), wrench(joint, i), arm(pose(near, i), to)))


@kernel
def _on_guide(n: int, reference: Pair, own: Pair, near: Array, far: Array, joint: Array, needs: Array) -> None:
    for i in range(min(n, BLOCK)):
        gap = minus(point(pose(far, i), own), point(pose(near, i), reference))
        put(needs, i, passed_on(wrench(needs, i), wrench(joint, i), gap))


@inlined
def solve_joints(tables: Tables, design: Array, n: int, work: Array, books: Array) -> None:
    """What the joints of all dyads exert, once all loads are entered; what the crank then needs is its pivot's part."""
    for number in range(len(tables.dyads) - 1, -1, -1):
        dyad, one = tables.dyads[number], CRANK_BODY + 1 + 2 * number
        kind, at = dyad[layout.KIND], first_joint(tables) + JOINTS * number
        rows, needs, joints = body_at(tables, one), WRENCH * one, books[at : at + JOINTS]
        own, reference = work[rows : rows + 2 * BODY], pair(design, tables.references[one + 1])
        first, other = books[needs : needs + WRENCH], books[needs + WRENCH : needs + 2 * WRENCH]
        _joints(kind, n, reference, own, first, other, joints)
        for outer in range(2):
            near = dyad[layout.NEAR_ONE + outer]
            if near != GROUND_BODY:
                rows, host = body_at(tables, near), books[WRENCH * near : WRENCH * (near + 1)]
                body, joint = work[rows : rows + BODY], joints[2 * outer * WRENCH : (2 * outer + 1) * WRENCH]
                if kind == PRP or (outer == 1 and kind in (RRP, RPP)):
                    itself = pair(design, tables.references[one + outer])
                    its = own[BODY * outer : BODY * (outer + 1)]
                    _on_guide(n, pair(design, tables.references[near]), itself, body, its, joint, host)
                else:
                    pin = dyad[layout.FIRST_JOINT + (layout.SECOND_JOINT - layout.FIRST_JOINT) * outer]
                    _on_pin(n, _of(tables, design, near, pin), body, joint, host)
