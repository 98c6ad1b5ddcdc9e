"""The suite's own second derivation as an engine: constrained bodies, every instant solved exactly, NumPy alone.

It shares no formula with the closed form: no Assur groups, no angles from triangles, no transfer functions in closed
form; only joints as equations between bodies (``engines.mechanics.joints``). So where the two agree to
rounding, both are right. A prescribed motion needs no time steps: positions, velocities, accelerations and forces of an
instant depend on nothing but that instant. A free crank follows the bodies' own equation of motion
(``engines.direct_adapter.released``).
"""

from __future__ import annotations

import math
import time as clock
from dataclasses import replace
from importlib import metadata

import numpy as np

from analytic.errors import LinkproofError
from engines.contract import History, Method, Outcome, Run, Setting
from engines.direct_adapter.assembly import Equations, UnsolvableError
from engines.direct_adapter.motion import motion
from engines.direct_adapter.precision import METHODS, SETTINGS, Precision, method_precision
from engines.scene import Channel, Scene
from engines.start_check import start_misfit

DISTRIBUTION = "linkproof"
SINGULAR = 1e-9  # smallest over largest singular value of the constraint equations


class DirectEngine:
    """Constrained planar bodies in descriptor form."""

    name = "direct"
    work_unit = "linear solves"

    def version(self) -> str | None:
        try:
            return metadata.version(DISTRIBUTION)
        except metadata.PackageNotFoundError:
            return "source"  # run from a checkout that is not installed: nothing else is needed

    def obstacle(self, scene: Scene) -> str | None:
        crank = next(body for body in scene.bodies if body.name == scene.crank)
        if crank.inertia is None:
            return f"crank '{scene.crank}' has no inertia, so it cannot turn; give it one"
        equations = Equations(scene)
        given, expected = equations.rows - 1, equations.size - 1
        if given != expected:
            surplus = "some are redundant" if given > expected else "more than the crank can move"
            return f"the joints give {given} equations where {expected} leave one freedom: {surplus}"
        return _degeneracy(equations)

    def run(self, scene: Scene, setting: Setting) -> Run:
        return _run(scene, SETTINGS[setting])

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        return METHODS

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        if not 0.0 < step < math.inf:
            raise LinkproofError(f"step: expected a positive finite number of seconds, got {step:g}; correct it")
        run = _run(scene, method_precision(method, step))
        return replace(run, details={"method": method.name, **run.details})


def _run(scene: Scene, precision: Precision) -> Run:
    begin = clock.perf_counter()
    misfit = start_misfit(scene)
    if misfit is not None:
        return Run(Outcome.DIVERGED, misfit)
    equations = Equations(scene)
    ready = clock.perf_counter()
    try:
        with np.errstate(all="ignore"):  # what is not finite is found and named
            history, steps, details = motion(equations, precision)
        reason = _not_finite(history)
    except UnsolvableError as failure:
        history, steps, details, reason = None, 0, {}, str(failure)
    return Run(
        Outcome.FINISHED if reason is None else Outcome.DIVERGED,
        reason or "",
        history if reason is None else None,
        seconds=clock.perf_counter() - ready,
        setup_seconds=ready - begin,
        steps=steps,
        solver_work=equations.solves,
        details=details,
    )


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


def _not_finite(history: History) -> str | None:
    """Which channel holds something that is no number."""
    for channel in Channel:
        recorded = getattr(history, channel.value)
        signals = recorded.values() if channel is Channel.JOINT_FORCE else [recorded]
        if not all(signal is None or np.all(np.isfinite(signal.values)) for signal in signals):
            return f"the {channel.value.replace('_', ' ')} is not finite everywhere; check masses, inertias and loads"
    return None
