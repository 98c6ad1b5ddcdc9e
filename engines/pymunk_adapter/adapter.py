"""pymunk behind the contract: the scene as bodies, pins and grooves, stepped and extrapolated (see ``plans``)."""

from __future__ import annotations

import numpy as np

from engines.contract import History, Method, Outcome, Run, Setting
from engines.installed import installed_version, why_absent
from engines.pymunk_adapter.checks import freedom_obstacle
from engines.pymunk_adapter.layout import PartLayout, exact_layout, plain_layout
from engines.pymunk_adapter.passes import ORDERS, naive_pass, prescribed_passes
from engines.pymunk_adapter.plans import METHODS, Aim, PlainPlan, Plan, method_plan, setting_plan
from engines.pymunk_adapter.released import WINDOW, free_history
from engines.pymunk_adapter.solver import iterations_for
from engines.pymunk_adapter.space import Rig
from engines.scene import Prescribed, Scene
from engines.start_check import data_obstacle
from engines.stepping.cost import Cost
from engines.stepping.driver import DivergedError, UnsupportedError, run_stepping
from engines.stepping.richardson import extrapolate


class PymunkEngine:
    """Adapter for pymunk (Chipmunk2D)."""

    name = "pymunk"
    work_unit = "constraint visits"

    def version(self) -> str | None:
        return installed_version(self.name)

    def run(self, scene: Scene, setting: Setting) -> Run:
        return self._run(scene, setting_plan(scene.drive, setting), Cost())

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        return METHODS

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        return self._run(scene, method_plan(method, step), Cost(details={"method": method.name}))

    def _run(self, scene: Scene, plan: PlainPlan | Plan, cost: Cost) -> Run:
        absent = why_absent(self.name)
        if absent is not None:
            return Run(Outcome.UNAVAILABLE, absent)
        reason = data_obstacle(scene, massless=False)
        if reason is not None:
            return Run(Outcome.UNSUPPORTED, reason)
        return run_stepping(cost, lambda: _history(scene, plan, cost))


def _history(scene: Scene, plan: PlainPlan | Plan, cost: Cost) -> History:
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            return _plain(scene, plan, cost) if isinstance(plan, PlainPlan) else _extrapolated(scene, plan, cost)
    except np.linalg.LinAlgError as error:
        raise DivergedError("the motion came to a state from which it cannot be read out") from error


def _laid_out(layout: PartLayout) -> PartLayout:
    """A layout that pymunk can hold; raises UnsupportedError for any other."""
    reason = freedom_obstacle(layout)
    if reason is not None:
        raise UnsupportedError(reason)
    return layout


def _plain(scene: Scene, plan: PlainPlan, cost: Cost) -> History:
    cost.details["iterations"] = plan.iterations or "pymunk's default"
    cost.details["error_bias"] = "pymunk's default"
    cost.details["torque"] = "size of the motor's impulse over the step; pymunk does not tell its sign"
    with cost.building():
        layout = _laid_out(plain_layout(scene))
    run = naive_pass(layout, plan, cost)
    cost.details["step"] = run.step
    return run.history


def _extrapolated(scene: Scene, plan: Plan, cost: Cost) -> History:
    with cost.building():
        layout = _laid_out(exact_layout(scene))
        iterations = plan.iterations or iterations_for(scene, layout, plan.remaining)
    rig = Rig(scene, layout, iterations, checked=isinstance(plan.pace, Aim))
    details = cost.details
    details["iterations"] = iterations
    details["error_bias"] = 0.0
    details["cut_off_parts"] = len(layout.inner)
    ratios = plan.ratios
    if isinstance(scene.drive, Prescribed):
        passes = prescribed_passes(rig, scene.drive.motion, plan, cost)
        history, sample_step = extrapolate(passes, ORDERS), passes[0].step * ratios[0]
        ratios = tuple(round(sample_step / each.step) for each in passes)
    else:
        history, sample_step = free_history(rig, scene.drive, plan, cost)
        if len(ratios) > 1:
            details["samples_to_release"] = WINDOW
    details["sample_step"] = sample_step
    details["ratios"] = " ".join(map(str, ratios))
    return history
