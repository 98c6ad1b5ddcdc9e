"""Coulomb friction of pins and guides, by the force of the joint in the frictional equilibrium itself.

A pin of radius r resists the relative rotation of its bodies by a moment μ r |F|, F being its force, a guide relative
sliding by a force μ |N| along it, N being its force across. The forces are linear in the frictions x, so that with one
force analysis for each joint with friction

    x = μ r |F₀ + A x|

is all that is left at every crank angle. Substitution or Newton's method solves it from x = 0, and the branch that it
has to be on, that of small μ, shows in the sign of its determinant. Where it has no such solution the linkage is
self-locking: no drive moves it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.linkage import GROUND, Guide, Vector
from analytic.dynamics import joint_forces
from analytic.dynamics.joint_forces import Reactions
from analytic.dynamics.loads import TINY, Load
from analytic.errors import LinkproofError
from analytic.kinematics import frames
from analytic.kinematics.frames import Scalar
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array, Booleans

MOST_ROUNDS, MOST_STEPS = 16, 60  # of substitution, of Newton's method
SETTLED, LAST = 4e-15, 1e-9  # a step over the largest friction of the angle, of substitution and of Newton's method
SHARES: Final = (np.arange(1, 33) / 32).tolist()  # of the coefficients


class Contact(NamedTuple):
    """A joint with friction: μ r, m, of a pin or μ of a guide, the rate of its motion over φ, what resists it.

    ``size`` is μ r or μ. ``rate`` is without unit for a pin, in m/rad for a guide. ``loads`` are of one unit of
    friction, N m or N, against a positive rate.
    """

    joint: str
    size: Scalar
    rate: Scalar
    loads: tuple[Load, Load]

    def against(self, direction: Array) -> list[Load]:
        """Loads of a unit of friction against the motion, if the driver moves by the sign of ``direction``.

        This is of the sweep's shape, 1 or -1. Where the joint does not move they are zero.
        """
        return [load.times(np.sign(self.rate) * direction) for load in self.loads]


def contacts(sweep: Sweep) -> Iterator[Contact]:
    """Yield each joint with friction as a ``Contact``: pins, then sliders, then slots.

    A pin of several joints has one for each. Raises AssemblyError where the linkage cannot be assembled or moved.
    """
    linkage, friction = sweep.linkage, sweep.linkage.friction
    for pin in linkage.pins:
        if pin.point in friction:
            size = friction[pin.point].coefficient * friction[pin.point].radius
            for joint, link in pin.joints.items():
                rate = sweep.rates(link)[2] - sweep.rates(pin.hub)[2]
                loads = Load(link, (0.0, 0.0), None, -1.0), Load(pin.hub, (0.0, 0.0), None, 1.0)
                yield Contact(joint, size, rate, loads)
    for slider in linkage.sliders:
        if slider.link in friction:
            local = linkage.links[slider.link].points[slider.point]
            along = _sliding_along(sweep, slider.guide, slider.link, local)
            yield Contact(slider.name, friction[slider.link].coefficient, *along)
    for slot in linkage.slots:
        if slot.name in friction:
            carriers = [GROUND, *linkage.links]
            body = next(b for b in carriers if b != slot.guide.host and slot.point in _points(sweep, b))
            along = _sliding_along(sweep, slot.guide, body, linkage.local(slot.point, body))
            yield Contact(slot.name, friction[slot.name].coefficient, *along)


def _points(sweep: Sweep, body: str) -> Mapping[str, Vector]:
    """The named points of a link or of the ground, in its own frame, m."""
    return sweep.linkage.ground if body == GROUND else sweep.linkage.links[body].points


def _sliding_along(sweep: Sweep, guide: Guide, body: str, local: Vector) -> tuple[Scalar, tuple[Load, Load]]:
    """The rate over φ at which a body's point ``local`` slides along a guide, m/rad, and the unit loads that resist it.

    The point is in the body's frame, m. The first load, 1 N, is on the body, its reverse on the guide's host. Raises
    AssemblyError where the linkage cannot be assembled or moved.
    """
    direction = frames.arm(sweep.poses(guide.host), guide.along)
    origin = sweep.local_point(guide.host, (0.0, 0.0))
    arm = frames.minus(sweep.local_point(body, local), origin)
    turn = sweep.rates(guide.host)[2]
    carried = frames.plus(sweep.local_point(guide.host, (0.0, 0.0), 1), (-turn * arm[1], turn * arm[0]))
    rate = frames.dot(direction, frames.minus(sweep.local_point(body, local, 1), carried))
    reverse = Load(guide.host, (0.0, 0.0), direction, frames.cross(arm, direction))
    return rate, (Load(body, local, (-direction[0], -direction[1])), reverse)


def reactions(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Reactions:
    """Forces of all joints and the drive's torque, with friction, at a crank speed, rad/s, and acceleration, rad/s².

    These are signed, of the sweep's shape or scalar. Forces are in N, the torque in N m. At rest, friction acts against
    a motion that would begin. A guide's friction comes from the part of its force across it. Where the linkage is
    self-locking, raises LinkproofError or sets the sweep's faults; AssemblyError where it cannot be put together or
    stands in a dead position.
    """
    plain = joint_forces.reactions(sweep, speed, acceleration)
    if not sweep.linkage.friction:
        return plain
    direction = np.where(np.signbit(speed), -1.0, 1.0)
    rubbing = list(contacts(sweep))
    units = [joint_forces.reactions_to(sweep, contact.against(direction)) for contact in rubbing]
    names = [contact.joint for contact in rubbing]
    count, shape = len(names), sweep.angle.shape
    sizes = np.array([np.broadcast_to(contact.size, shape) for contact in rubbing]).reshape(count, -1)
    free = np.stack([plain.forces[name] for name in names]).reshape(count, 2, -1)
    slopes = np.stack([[unit.forces[name] for unit in units] for name in names]).reshape(count, count, 2, -1)
    found, is_solved = _equilibrium(sizes, free, slopes)
    _check_not_locked(sweep, is_solved.reshape(shape))
    frictions = found.reshape(count, *shape)
    forces = {name: force + sum(x * unit.forces[name] for x, unit in zip(frictions, units, strict=True))
              for name, force in plain.forces.items()}  # fmt: skip
    share = np.sum([x * unit.torque for x, unit in zip(frictions, units, strict=True)], axis=0)
    return Reactions(forces, plain.torque + share, share)


def _equilibrium(sizes: Array, free: Array, slopes: Array) -> tuple[Array, Booleans]:
    """Solve for the frictions (m, n) under joint forces ``free`` + ``slopes`` · frictions; and where it succeeded (n,).

    ``sizes`` (m, n) are μ r or μ, ``free`` (m, 2, n) the m joints' forces without friction, N, and ``slopes`` (m, m, 2,
    n) those of a joint by a unit of friction in another. Repeated substitution finds them where friction is small, and
    finds no others; Newton's method those that are left, at last by letting the coefficients grow. Forces that are not
    finite count as solved.
    """
    frictions = np.zeros_like(sizes)
    with np.errstate(all="ignore"):  # of what is found nowhere
        for _ in range(MOST_ROUNDS):
            before, frictions = frictions, sizes * np.hypot(*_forces(free, slopes, frictions))
            is_solved = _is_settled(frictions - before, frictions)
            if np.all(is_solved):
                return frictions, is_solved
        for shares in ((1.0,), SHARES):
            left = np.flatnonzero(~is_solved & np.all(np.isfinite(free), axis=(0, 1)))
            found = _by_newton(sizes[:, left], free[..., left], slopes[..., left], shares)
            frictions[:, left], is_solved[left] = found
    return frictions, is_solved | ~np.all(np.isfinite(free), axis=(0, 1))


def _forces(free: Array, slopes: Array, frictions: Array) -> Array:
    """Forces of the joints with friction, ``free`` + ``slopes`` · frictions, as x and y, (2, m, n)."""
    return np.moveaxis(free + np.einsum("jkcn,kn->jcn", slopes, frictions), 1, 0)


def _is_settled(step: Array, frictions: Array, within: float = SETTLED) -> Booleans:
    """Whether a ``step`` (m, n) is at most the share ``within`` of the ``frictions`` (m, n) that it changes, (n,)."""
    return np.asarray(np.all(np.abs(step) <= within * np.max(np.abs(frictions), axis=0), axis=0))


def _by_newton(sizes: Array, free: Array, slopes: Array, shares: Iterable[float]) -> tuple[Array, Booleans]:
    """Solve as ``_equilibrium`` does by Newton's method, for ``shares`` of the coefficients one after the other.

    Returns the frictions (m, n) and where they are found, (n,). The branch of small coefficients has a determinant
    above zero. The step after one within LAST is rounding.
    """
    frictions, step, unit = np.zeros_like(sizes), np.ones_like(sizes), np.eye(len(sizes))
    matrix = np.broadcast_to(unit, (sizes.shape[1], *unit.shape))
    is_branch = np.ones(sizes.shape[1], dtype=bool)
    for share in shares:
        for _ in range(MOST_STEPS):
            forces = _forces(free, slopes, frictions)
            magnitudes = np.maximum(np.hypot(*forces), TINY)
            along = np.einsum("cjn,jkcn->jkn", forces / magnitudes, slopes)
            matrix = unit - np.moveaxis(share * sizes[:, None] * along, (0, 1), (-2, -1))
            matrix = np.where(np.isfinite(matrix), matrix, unit)
            rest = (frictions - share * sizes * magnitudes).T
            step = np.linalg.solve(matrix, rest[..., None])[..., 0].T
            frictions = frictions - step
            if np.all(_is_settled(step, frictions, LAST) | ~is_branch):
                break
        is_branch &= np.all(frictions >= 0.0, axis=0) & (np.linalg.det(matrix) > 0.0)
        is_branch &= _is_settled(step, frictions, LAST)
    return frictions, is_branch


def _check_not_locked(sweep: Sweep, is_solved: Booleans) -> None:
    """Raise LinkproofError where friction is not ``is_solved``, as it locks the linkage.

    If the sweep collects faults, mark it there instead and raise nothing. ``is_solved`` has the shape of the sweep's
    angles.
    """
    if sweep.faults is not None:
        sweep.faults |= ~is_solved
    elif not np.all(is_solved):
        place = float(np.ravel(sweep.angle)[np.argmin(np.ravel(is_solved))])
        raise LinkproofError(
            f"'{sweep.linkage.name}' is self-locking at {sweep.linkage.phi.named(place)}: with the friction of its "
            "joints no drive moves it there; lower the coefficients or the radii, or improve the transmission angle"
        )
