"""The loads of a scene on its bodies, at n instants at once: gravity, applied forces and torques, springs, dampers."""

from __future__ import annotations

import numpy as np

from analytic.description.linkage import Vector
from engines.direct_adapter.equations import Equations, Pose, Reals, across, dot
from engines.scene import PointSpring, Scene


def applied_loads(scene: Scene, equations: Equations, pose: Pose, rate: Reals, angle: Reals) -> Reals:
    """Forces, N, and torques, N m, (n, bodies, 3), for rates (n, bodies, 3) in SI and crank angles (n,).

    ``scene`` gives the loads: the equations' own scene, or one with some of its loads left out.
    """
    index = equations.index
    loads = np.zeros_like(rate)
    loads[..., :2] = equations.mass[:, :2] * np.asarray(scene.gravity)
    crank_angle = np.asarray(angle, dtype=float)
    for applied in scene.forces:
        force = applied.force(crank_angle).T
        _push(loads, index[applied.body], _arm(equations, pose, applied.body, applied.anchor), force)
    for torque in scene.torques:
        loads[:, index[torque.body], 2] += torque.torque(crank_angle)[0]
    for damper in scene.dampers:
        first, second = index[damper.first], index[damper.second]
        drag = damper.coefficient * (rate[:, first, 2] - rate[:, second, 2])
        loads[:, first, 2] -= drag
        loads[:, second, 2] += drag
    for spring in scene.springs:
        _pull(equations, loads, spring, pose, rate)
    return loads


def _arm(equations: Equations, pose: Pose, body: str, anchor: Vector) -> Reals:
    """From a body's mass centre to an anchor, m, (n, 2)."""
    return pose.turned(np.array([anchor]), np.array([equations.index[body]]))[:, 0]


def _push(loads: Reals, body: int, arm: Reals, force: Reals) -> None:
    loads[:, body, :2] += force
    loads[:, body, 2] += dot(across(arm), force)


def _pull(equations: Equations, loads: Reals, spring: PointSpring, pose: Pose, rate: Reals) -> None:
    """A spring's and dashpot's pull on both of its ends."""
    ends = []
    for name, anchor in ((spring.first, spring.first_anchor), (spring.second, spring.second_anchor)):
        body = equations.index[name]
        arm = _arm(equations, pose, name, anchor)
        place = pose.place[:, body] * equations.unit + arm
        ends.append((body, arm, place, rate[:, body, :2] + rate[:, body, 2:] * across(arm)))
    (first, first_arm, here, here_rate), (second, second_arm, there, there_rate) = ends
    span, span_rate = here - there, here_rate - there_rate
    length = np.sqrt(dot(span, span))
    # Ends that meet have no direction to pull in; without a free length there is no pull either.
    direction = span / np.where(length > 0.0, length, 1.0)[:, None]
    tension = spring.stiffness * (length - spring.length) + spring.damping * dot(direction, span_rate)
    pull = -tension[:, None] * direction
    _push(loads, first, first_arm, pull)
    _push(loads, second, second_arm, -pull)
