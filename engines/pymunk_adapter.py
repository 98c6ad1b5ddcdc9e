"""pymunk behind the contract: the scene as bodies, pins and grooves, stepped and extrapolated.

- ``naive`` is what a newcomer writes: defaults, 1e-4 s, every read-out at face value.
- ``tuned`` makes the stepping second order (see pymunk_passes) and extrapolates three passes with h, h/3 and h/5.
- ``best`` extrapolates four passes, at closer samples.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import metadata
from time import perf_counter

from engines import pymunk_checks
from engines.contract import Outcome, Prescribed, Run, Scene, Setting
from engines.pymunk_checks import DivergedError
from engines.pymunk_doubt import Pass, extrapolated
from engines.pymunk_free import free_passes
from engines.pymunk_layout import exact_layout
from engines.pymunk_naive import naive_pass
from engines.pymunk_passes import Plan, prescribed_passes
from engines.pymunk_solver import SlowSolverError, iterations_for
from engines.pymunk_space import Rig

PRESCRIBED: Mapping[Setting, Plan] = {
    Setting.TUNED: Plan(150, 200, (1, 3, 5), 0.03, 1e-4),
    Setting.BEST: Plan(200, 200, (1, 3, 5, 7), 0.01, 1e-6),
}

# A free crank adds up its error of phase over all turns, and a prescribed one has none: it takes smaller steps.
FREE: Mapping[Setting, Plan] = {
    Setting.TUNED: Plan(100, 1000, (1, 3, 5), 0.2, 0.05),
    Setting.BEST: Plan(120, 1000, (7, 9, 11), 0.2, 0.002),
}


class PymunkEngine:
    """Adapter for pymunk (Chipmunk2D)."""

    name = "pymunk"

    def version(self) -> str | None:
        try:
            return metadata.version("pymunk")
        except metadata.PackageNotFoundError:
            return None

    def obstacle(self, scene: Scene) -> str | None:
        return pymunk_checks.obstacle(scene)

    def run(self, scene: Scene, setting: Setting) -> Run:
        reason = self.obstacle(scene)
        if reason is not None:
            return Run(Outcome.UNSUPPORTED, reason)
        try:
            import pymunk  # noqa: F401
        except ModuleNotFoundError as error:
            if error.name != "pymunk":
                raise
            return Run(Outcome.UNAVAILABLE, "engine 'pymunk' is not installed; pip install 'linkproof[pymunk]'")
        try:
            return _naive(scene) if setting is Setting.NAIVE else _extrapolated(scene, setting)
        except DivergedError as error:
            return Run(Outcome.DIVERGED, str(error))
        except SlowSolverError as error:
            return Run(Outcome.UNSUPPORTED, str(error))


def _naive(scene: Scene) -> Run:
    done = naive_pass(scene)
    details: dict[str, str | int | float] = {
        "step": done.step,
        "iterations": "pymunk's default",
        "error_bias": "pymunk's default",
        "torque": "size of the motor's impulse over the step; pymunk does not tell its sign",
    }
    return Run(Outcome.FINISHED, "", done.history, done.seconds, done.setup_seconds, done.steps, details)


def _extrapolated(scene: Scene, setting: Setting) -> Run:
    begun = perf_counter()
    layout = exact_layout(scene)
    drive = scene.drive
    plan = (PRESCRIBED if isinstance(drive, Prescribed) else FREE)[setting]
    rig = Rig(scene, layout, iterations_for(scene, layout, plan.remaining))
    built = perf_counter() - begun
    trials: list[Pass] = []
    if isinstance(drive, Prescribed):
        passes = prescribed_passes(rig, drive.motion, plan)
    else:
        trials, passes = free_passes(rig, drive, plan)
    details: dict[str, str | int | float] = {
        "sample_step": passes[0].step * plan.ratios[0],
        "ratios": " ".join(str(round(passes[0].step * plan.ratios[0] / done.step)) for done in passes),
        "iterations": rig.iterations,
        "error_bias": 0.0,
        "cut_off_parts": len(layout.parts) - len(scene.bodies),
    }
    everything = (*trials, *passes)
    seconds, setup_seconds = sum(p.seconds for p in everything), built + sum(p.setup_seconds for p in everything)
    steps = sum(p.steps for p in everything)
    return Run(Outcome.FINISHED, "", extrapolated(passes), seconds, setup_seconds, steps, details)
