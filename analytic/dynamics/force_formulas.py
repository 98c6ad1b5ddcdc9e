"""Forces in closed form, formulas that NumPy calls and numba compiles: loads on a link, a dyad's three joints.

A dyad is statically determinate: its six equations of equilibrium hold the six unknowns of its three joints. Each kind
reduces to a 2×2 system at most, the transpose of the one which its velocities solve; its determinant vanishes in the
same dead positions. (Kinetostatics of Assur groups: I. I. Artobolevskii, Theory of Mechanisms and Machines.)

A *wrench* is (force x, force y, N, moment, N m). What a link *needs* is the wrench that its joints together must exert
on it, about the link's reference point, which is a pin of its dyad wherever it has one. A dyad's formula takes what its
first and second link need and directions of the closure equations, and gives what the first, inner and second joint
exert on their ``far`` link. The moment of a slide is about that link's reference point; a pin exerts its force at the
pin and no moment.
"""

from __future__ import annotations

import numpy as np

from analytic.dynamics.link_sums import TINY
from analytic.kinematics.frames import Pair, Scalar, cross, dot

Wrench = tuple[Scalar, Scalar, Scalar]
JointWrenches = tuple[Wrench, Wrench, Wrench]


def charged(need: Wrench, force: Pair, arm: Pair, torque: Scalar) -> Wrench:
    """What a link needs under one load more: a force at an ``arm`` from the reference point, and a torque."""
    return (need[0] - force[0], need[1] - force[1], need[2] - cross(arm, force) - torque)


def passed_on(need: Wrench, wrench: Wrench, arm: Pair) -> Wrench:
    """What a link needs that bears a joint: the reverse of what the joint exerts acts on it, at an ``arm``."""
    return charged(need, (-wrench[0], -wrench[1]), arm, -wrench[2])


def weight_and_inertia(mass: float, gravity: Pair, acceleration: Pair) -> Pair:
    """M (g − S̈), the weight and d'Alembert's inertia force at the mass centre."""
    return (mass * (gravity[0] - acceleration[0]), mass * (gravity[1] - acceleration[1]))


def pull(span: Pair, stiffness: Scalar, free: Scalar) -> Scalar:
    """A spring's pull per unit of length, N/m; ends that meet have no line for it to act along."""
    return stiffness * (1.0 - free * _over_length(span))


def drag(span: Pair, rate: Pair, damping: Scalar) -> Scalar:
    """A dashpot's pull per unit of length, N/m; ``damping`` is times the unit of time of the span's ``rate``."""
    inverse = _over_length(span)
    return damping * dot(span, rate) * inverse * inverse


def _over_length(span: Pair) -> Scalar:
    """Reciprocal of a length, zero of none."""
    square = dot(span, span)
    return (square > 0.0) / np.sqrt(np.maximum(square, TINY))


def rrr(one: Wrench, two: Wrench, r: Pair, q: Pair) -> JointWrenches:
    """RRR: r × N = M₁ and −q × N = M₂ about the outer pins give the inner force N; r and q reach from them to it."""
    scale = 1.0 / cross(r, q)
    n = ((one[2] * q[0] + two[2] * r[0]) * scale, (one[2] * q[1] + two[2] * r[1]) * scale)
    return (one[0] - n[0], one[1] - n[1], 0.0), (n[0], n[1], 0.0), (two[0] + n[0], two[1] + n[1], 0.0)


def rrp(one: Wrench, two: Wrench, r: Pair, e: Pair) -> JointWrenches:
    """RRP: r × N = M₁ about the outer pin and −N·e = F₂·e along the slide give the inner force N = a e + b e⊥."""
    f = (two[0], two[1])
    a = -dot(e, f)
    b = (one[2] - a * cross(r, e)) / dot(r, e)
    n = (a * e[0] - b * e[1], a * e[1] + b * e[0])
    return (one[0] - n[0], one[1] - n[1], 0.0), (n[0], n[1], 0.0), across(e, cross(e, f) + b, two[2])


def rpr(one: Wrench, two: Wrench, e: Pair, d: Pair) -> JointWrenches:
    """RPR: the moments about both outer pins, M₁ + M₂ = −n d·e with d from the second to the first, give n e⊥."""
    n = across(e, -(one[2] + two[2]) / dot(d, e), one[2])
    return (one[0] - n[0], one[1] - n[1], 0.0), n, (two[0] + n[0], two[1] + n[1], 0.0)


def rpp(one: Wrench, two: Wrench, e: Pair, f: Pair, gap: Pair) -> JointWrenches:
    """RPP: F₂ = n e⊥ − k f⊥ across the outer and the inner slide; the moments are passed on.

    The ``gap`` reaches from the second link's reference point to the first one's.
    """
    scale = 1.0 / cross(e, f)
    force = (two[0], two[1])
    inner = across(f, dot(force, e) * scale, one[2])
    moment = two[2] + (one[2] + cross(gap, (inner[0], inner[1])))
    return (one[0] - inner[0], one[1] - inner[1], 0.0), inner, across(e, dot(force, f) * scale, moment)


def prp(one: Wrench, two: Wrench, e: Pair, f: Pair) -> JointWrenches:
    """PRP: N·e = F₁·e and −N·f = F₂·f along the slides give the inner force N = a e⊥ + b f⊥."""
    scale = 1.0 / cross(e, f)
    first, second = (one[0], one[1]), (two[0], two[1])
    a, b = -dot(second, f) * scale, -dot(first, e) * scale
    both = dot(e, f)
    n = (-a * e[1] - b * f[1], a * e[0] + b * f[0], 0.0)
    return (
        across(e, cross(e, first) - a - b * both, one[2]),
        n,
        across(f, cross(f, second) + a * both + b, two[2]),
    )


def across(direction: Pair, size: Scalar, moment: Scalar) -> Wrench:
    """What a slide exerts: a force square to it, on its left where ``size`` is positive, and a moment."""
    return (-size * direction[1], size * direction[0], moment)
