"""The suite's own second derivation as an engine: constrained bodies, every instant solved exactly, by NumPy and SciPy.

It shares no formula with the closed form: no Assur groups, no angles from triangles, no transfer functions in closed
form; only joints as equations between bodies (``engines.mechanics.joints``). So where the two agree to
rounding, both are right. A prescribed motion needs no time steps: positions, velocities, accelerations and forces of an
instant depend on nothing but that instant. A free crank follows the bodies' own equation of motion
(``engines.direct_adapter.released``).
"""

from __future__ import annotations

import numpy as np

from analytic.description.linkage import DriverKind
from analytic.errors import UnknownNameError
from engines.contract import Abilities, History, Method, ReadOut, Run, Setting
from engines.direct_adapter.equations import Equations
from engines.direct_adapter.motion import motion
from engines.installed import installed_version
from engines.mechanics.start_check import data_obstacle
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene
from engines.stepping.driver import Cost, DivergedError, UnsupportedError, check_step, run_stepping

DISTRIBUTION = "linkproof"
METHODS = (Method("exact", "every instant by Newton's method and linear systems; a free crank by DOP853"),)
SINGULAR = 1e-9  # smallest over largest singular value of the constraint equations


class DirectEngine:
    """Constrained planar bodies in descriptor form."""

    name = "direct"
    work_unit = "linear solves"
    is_control = True
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("the joints' equations, closed by Newton's method"),
            Channel.VELOCITY: ReadOut("their first derivative over the crank angle, times its speed"),
            Channel.ACCELERATION: ReadOut("their second derivative"),
            Channel.TORQUE: ReadOut("multiplier of the crank's equation", drive="it is the drive's"),
            Channel.JOINT_FORCE: ReadOut("multipliers of the joint's equations", drive="left out"),
        },
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS,
        drivers=frozenset(DriverKind),
    )

    def version(self) -> str | None:
        return installed_version(DISTRIBUTION) or "source"  # run from a checkout: nothing else is needed

    def run(self, scene: Scene, setting: Setting) -> Run:
        return _run(scene, None, Cost())  # a control has no defaults to be naive with, and nothing left to extrapolate

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        return METHODS

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        check_step(step)
        if method.name != METHODS[0].name:
            raise UnknownNameError("method", method.name, [METHODS[0].name])
        return _run(scene, step, Cost(details={"method": method.name}))


def _run(scene: Scene, spacing: float | None, cost: Cost) -> Run:
    return run_stepping(cost, lambda: _history(scene, spacing, cost))


def _history(scene: Scene, spacing: float | None, cost: Cost) -> History:
    turns = scene.driver_kind is DriverKind.CRANK
    if turns and any(body.name == scene.crank and body.inertia is None for body in scene.bodies):
        raise UnsupportedError(f"crank '{scene.crank}' has no inertia, so it cannot turn; give it one")
    with cost.building():
        reason = data_obstacle(scene, massless=True)
        if reason is not None:
            raise DivergedError(reason)
        equations = _equations(scene)
    try:
        with cost.stepping(), np.errstate(all="ignore"):  # numbers that are not finite are named later
            history, cost.steps = motion(equations, spacing)
    finally:
        cost.solver_work = equations.solves
    return history


def _equations(scene: Scene) -> Equations:
    """The scene's equations; raises UnsupportedError where they do not fix its motion."""
    equations = Equations(scene)
    given, expected = equations.rows - 1, equations.size - 1
    if given != expected:
        surplus = "some are redundant" if given > expected else "more than the crank can move"
        raise UnsupportedError(f"the joints give {given} equations where {expected} leave one freedom: {surplus}")
    reason = _degeneracy(equations)
    if reason is not None:
        raise UnsupportedError(reason)
    return equations


def _degeneracy(equations: Equations) -> str | None:
    """Why as many equations as coordinates do not fix the motion at the start, if they do not."""
    matrix = equations.jacobian(equations.arms(equations.start()))[0]
    if not np.all(np.isfinite(matrix)):
        return "the start state is not finite"
    for rows, meaning in (
        (slice(0, equations.crank_row), "the joints are redundant, or at a change point, in the start state"),
        (slice(0, None), "the crank cannot move the linkage from its start state: it is at a dead point"),
    ):
        sizes = np.linalg.svd(matrix[rows], compute_uv=False)
        if not sizes[-1] > SINGULAR * sizes[0]:
            return f"{meaning} (singular values {sizes[-1]:.2g} to {sizes[0]:.2g})"
    return None
