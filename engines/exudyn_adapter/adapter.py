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

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from engines.contract import History, Method, Outcome, Run, Setting
from engines.exudyn_adapter.checks import assemble
from engines.exudyn_adapter.model import Model
from engines.exudyn_adapter.passes import follow
from engines.exudyn_adapter.readout import add_sensors
from engines.exudyn_adapter.recipes import Recipe, method_recipe, setting_recipe, studied_methods
from engines.exudyn_adapter.stepping import Stepper
from engines.installed import installed_version, why_absent
from engines.scene import Scene
from engines.start_check import data_obstacle
from engines.stepping.cost import Cost
from engines.stepping.driver import check_step, run_stepping
from engines.stepping.own_units import own_units, restored, scaled


class ExudynEngine:
    """Adapter for exudyn."""

    name = "exudyn"
    work_unit = "Newton iterations"

    def version(self) -> str | None:
        return installed_version(self.name)

    def run(self, scene: Scene, setting: Setting) -> Run:
        return self._run(scene, setting_recipe(scene, setting), checked=True)

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        return studied_methods()

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        check_step(step)
        run = self._run(scene, method_recipe(method, step), checked=False)
        return replace(run, details={"method": method.name, **run.details})

    def _run(self, scene: Scene, recipe: Recipe, *, checked: bool) -> Run:
        """A run by a recipe, if exudyn is there and can hold the scene."""
        absent = why_absent(self.name)
        if absent is not None:
            return Run(Outcome.UNAVAILABLE, absent)
        reason = data_obstacle(scene, massless=True)
        if reason is not None:
            return Run(Outcome.UNSUPPORTED, reason)
        cost = Cost()
        with _silent():
            return run_stepping(cost, lambda: _history(scene, recipe, cost, checked=checked))


def _history(scene: Scene, recipe: Recipe, cost: Cost, *, checked: bool) -> History:
    if recipe.rule.as_shipped:
        return follow(recipe, _stepper(scene, recipe, cost, checked=checked))
    units = own_units(scene)
    return restored(follow(recipe, _stepper(scaled(scene, units), recipe, cost, checked=checked)), units)


def _stepper(scene: Scene, recipe: Recipe, cost: Cost, *, checked: bool) -> Stepper:
    with cost.building():
        model = Model(scene, plain=recipe.rule.as_shipped)
        stepper = Stepper(model, add_sensors(model), cost, checked=checked)
        assemble(model)
        stepper.prepare(recipe)
        return stepper


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
