"""pymunk behind the contract: the scene as bodies, pins and grooves, stepped and extrapolated (see pymunk_plans)."""

from __future__ import annotations

from importlib import metadata

import numpy as np

from engines.contract import History, Method, Outcome, Run, Setting
from engines.pymunk_adapter import checks
from engines.pymunk_adapter.checks import DivergedError, check_read_out
from engines.pymunk_adapter.cost import Cost
from engines.pymunk_adapter.disagreement import extrapolated
from engines.pymunk_adapter.layout import exact_layout
from engines.pymunk_adapter.naive import naive_pass
from engines.pymunk_adapter.passes import prescribed_passes
from engines.pymunk_adapter.plans import METHODS, Aim, PlainPlan, Plan, method_plan, setting_plan
from engines.pymunk_adapter.release import WINDOW
from engines.pymunk_adapter.released import free_history
from engines.pymunk_adapter.solver import SlowSolverError, iterations_for
from engines.pymunk_adapter.space import Rig
from engines.scene import Prescribed, Scene

Details = dict[str, str | int | float]


class PymunkEngine:
    """Adapter for pymunk (Chipmunk2D)."""

    name = "pymunk"
    work_unit = "constraint visits"

    def version(self) -> str | None:
        try:
            return metadata.version("pymunk")
        except metadata.PackageNotFoundError:
            return None

    def obstacle(self, scene: Scene) -> str | None:
        return checks.obstacle(scene)

    def run(self, scene: Scene, setting: Setting) -> Run:
        return self._run(scene, setting_plan(scene.drive, setting), {})

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        return METHODS

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        return self._run(scene, method_plan(method, step), {"method": method.name})

    def _run(self, scene: Scene, plan: PlainPlan | Plan, details: Details) -> Run:
        reason = self.obstacle(scene)
        if reason is not None:
            return Run(Outcome.UNSUPPORTED, reason)
        try:
            import pymunk  # noqa: F401
        except ModuleNotFoundError as error:
            if error.name != "pymunk":
                raise
            return Run(Outcome.UNAVAILABLE, "engine 'pymunk' is not installed; pip install 'linkproof[pymunk]'")
        return _stepped(scene, plan, details)


def _stepped(scene: Scene, plan: PlainPlan | Plan, details: Details) -> Run:
    """What came of a plan; what it cost is told however it ends, and ``details`` are added to as they are settled."""
    outcome, reason, history = Outcome.FINISHED, "", None
    cost = Cost()
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            if isinstance(plan, PlainPlan):
                history = _plain(scene, plan, cost, details)
            else:
                history = _extrapolated(scene, plan, cost, details)
        check_read_out(history)
    except DivergedError as error:
        outcome, reason, history = Outcome.DIVERGED, str(error), None
    except np.linalg.LinAlgError:
        outcome, reason = Outcome.DIVERGED, "the motion came to a state from which it cannot be read out"
    except SlowSolverError as error:
        outcome, reason = Outcome.UNSUPPORTED, str(error)
    return Run(outcome, reason, history, cost.seconds, cost.setup_seconds, cost.steps, cost.visits, details)


def _plain(scene: Scene, plan: PlainPlan, cost: Cost, details: Details) -> History:
    details["iterations"] = plan.iterations or "pymunk's default"
    details["error_bias"] = "pymunk's default"
    details["torque"] = "size of the motor's impulse over the step; pymunk does not tell its sign"
    done = naive_pass(scene, plan, cost)
    details["step"] = done.step
    return done.history


def _extrapolated(scene: Scene, plan: Plan, cost: Cost, details: Details) -> History:
    with cost.building():
        layout = exact_layout(scene)
        iterations = plan.iterations or iterations_for(scene, layout, plan.remaining)
    rig = Rig(scene, layout, iterations, judged=isinstance(plan.pace, Aim))
    details["iterations"] = iterations
    details["error_bias"] = 0.0
    details["cut_off_parts"] = len(layout.parts) - len(scene.bodies)
    drive = scene.drive
    ratios = plan.ratios
    if isinstance(drive, Prescribed):
        passes = prescribed_passes(rig, drive.motion, plan, cost)
        history, details["sample_step"] = extrapolated(passes), passes[0].step * ratios[0]
        ratios = tuple(round(passes[0].step * ratios[0] / done.step) for done in passes)
    else:
        history, details["sample_step"] = free_history(rig, drive, plan, cost)
        if len(ratios) > 1:
            details["samples_to_release"] = WINDOW
    details["ratios"] = " ".join(map(str, ratios))
    return history
