"""exudyn behind the contract: constrained planar bodies, the trapezoidal rule, extrapolated over the step.

J. Gerstmayr, "Exudyn - a C++-based Python package for flexible multibody systems", Multibody System Dynamics 60 (2024).
Settings:

- ``naive``: a rigid body for every link, prismatic joints, a Python function for the drive, exudyn's defaults at 1 ms.
- ``tuned``: the trapezoidal rule at 50 and 150 steps per turn, extrapolated to fourth order; to sixth and eighth with
  250 and 350 where the estimated error asks for it, or with more still.
- ``best``: to eighth order always.

Both start anew every other turn from a state that fits all joints. ``engines.exudyn_adapter.recipes`` has their numbers
and the methods that can be studied.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import metadata

from analytic.errors import LinkproofError
from engines.contract import History, Method, Outcome, Run, Setting
from engines.exudyn_adapter.checks import assembly_obstacle, data_obstacle
from engines.exudyn_adapter.model import build_model
from engines.exudyn_adapter.passes import follow
from engines.exudyn_adapter.readout import add_sensors
from engines.exudyn_adapter.recipes import Recipe, method_recipe, setting_recipe, studied_methods
from engines.exudyn_adapter.stepping import Stepper, StoppedError
from engines.scene import Scene
from engines.stepping.own_units import Units, own_units, restored, scaled


class ExudynEngine:
    """Adapter for exudyn."""

    name = "exudyn"
    work_unit = "Newton iterations"

    def version(self) -> str | None:
        try:
            return metadata.version("exudyn")
        except metadata.PackageNotFoundError:
            return None

    def obstacle(self, scene: Scene) -> str | None:
        reason = data_obstacle(scene)
        if reason is not None or _missing() is not None:
            return reason
        with _silent():
            return assembly_obstacle(build_model(scene))

    def run(self, scene: Scene, setting: Setting) -> Run:
        return _attempted(scene, setting_recipe(scene, setting), checked=True)

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        return studied_methods()

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        if not 0.0 < step < math.inf:
            raise LinkproofError(f"step: expected a positive finite number of seconds, got {step:g}; correct it")
        run = _attempted(scene, method_recipe(method, step), checked=False)
        return replace(run, details={"method": method.name, **run.details})


def _attempted(scene: Scene, recipe: Recipe, *, checked: bool) -> Run:
    """A run by a recipe, if exudyn is there and can hold the scene."""
    missing = _missing()
    if missing is not None:
        return Run(Outcome.UNAVAILABLE, missing)
    reason = data_obstacle(scene)
    if reason is not None:
        return Run(Outcome.UNSUPPORTED, reason)
    with _silent():
        return _run(scene, recipe, checked=checked)


def _run(scene: Scene, recipe: Recipe, *, checked: bool) -> Run:
    began = time.perf_counter()
    plain = recipe.rule.as_shipped
    units = Units(1.0, 1.0) if plain else own_units(scene)
    model = build_model(scene if plain else scaled(scene, units), plain=plain)
    stepper = Stepper(model, add_sensors(model), checked=checked)
    reason = assembly_obstacle(model)
    if reason is not None:
        return Run(Outcome.UNSUPPORTED, reason)
    stepper.prepare(recipe)
    built = time.perf_counter() - began
    outcome, reason, history = _stepped(stepper, recipe)
    if history is not None and not plain:
        history = restored(history, units)
    return Run(
        outcome,
        reason,
        history,
        seconds=stepper.seconds,
        setup_seconds=built,
        steps=stepper.steps,
        solver_work=stepper.iterations,
        details=stepper.details,
    )


def _stepped(stepper: Stepper, recipe: Recipe) -> tuple[Outcome, str, History | None]:
    try:
        return Outcome.FINISHED, "", follow(recipe, stepper)
    except StoppedError as stop:
        return Outcome.DIVERGED, str(stop), None


def _missing() -> str | None:
    """Why exudyn cannot be imported; an error inside an installed exudyn is not hidden by this."""
    try:
        import exudyn  # noqa: F401
    except ModuleNotFoundError as error:
        if error.name != "exudyn":
            raise
        return "exudyn is not installed: pip install 'linkproof[exudyn]' brings it"
    return None


@contextmanager
def _silent() -> Iterator[None]:
    """Keep exudyn from writing to the console, and leave its switch as it was found."""
    import exudyn

    before = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield
    finally:
        exudyn.config.printToConsole = before
