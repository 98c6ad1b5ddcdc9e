"""exudyn behind the contract: constrained planar bodies, the trapezoidal rule, extrapolated over the step.

J. Gerstmayr, "Exudyn - a C++-based Python package for flexible multibody systems", Multibody System Dynamics 60 (2024).
Settings:

- ``naive``: a rigid body for every link, prismatic joints, a Python function for the drive, exudyn's defaults at 1 ms.
- ``tuned``: the trapezoidal rule at 72 and 216 steps per turn of the fastest speed, extrapolated to fourth order.
- ``best``: the same at 72, 216 and 360 steps, extrapolated to sixth order.

A free crank adds up its phase error over all turns, which a higher order pays for: see ``FREE``.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import metadata
from itertools import pairwise

from engines.consistency import start_misfit
from engines.contract import Free, History, Outcome, Prescribed, Run, Scene, Setting
from engines.exudyn_drive import meeting
from engines.exudyn_model import Model, build_model
from engines.exudyn_readout import add_sensors
from engines.exudyn_stepping import Recipe, Stepper, StoppedError
from engines.scaling import Units, own_units, restored, scaled

PRESCRIBED: Mapping[Setting, Recipe] = {
    Setting.TUNED: Recipe((1, 3, 5), 2, 72, 2e-6, 1e-9, 1e-11),
    Setting.BEST: Recipe((1, 3, 5), 3, 72, 2e-6, 1e-12, 1e-14),
}
FREE: Mapping[Setting, Recipe] = {
    Setting.TUNED: Recipe((1, 3, 5), 3, 30, 2e-2, 1e-10, 1e-12),
    Setting.BEST: Recipe((1, 3, 5), 3, 60, 2e-4, 1e-12, 1e-14),
}
NAIVE_STEP = 1e-3  # s


class ExudynEngine:
    """Adapter for exudyn."""

    name = "exudyn"

    def version(self) -> str | None:
        try:
            return metadata.version("exudyn")
        except metadata.PackageNotFoundError:
            return None

    def obstacle(self, scene: Scene) -> str | None:
        reason = _data_obstacle(scene)
        if reason is not None or _missing() is not None:
            return reason
        with _silent():
            return _assembly_obstacle(build_model(scene))

    def run(self, scene: Scene, setting: Setting) -> Run:
        missing = _missing()
        if missing is not None:
            return Run(Outcome.UNAVAILABLE, missing)
        reason = _data_obstacle(scene)
        if reason is not None:
            return Run(Outcome.UNSUPPORTED, reason)
        with _silent():
            return _run(scene, setting)


def _run(scene: Scene, setting: Setting) -> Run:
    began = time.perf_counter()
    naive = setting is Setting.NAIVE
    units = Units(1.0, 1.0) if naive else own_units(scene)
    model = build_model(scene if naive else scaled(scene, units), plain=naive)
    stepper = Stepper(model, add_sensors(model))
    reason = _assembly_obstacle(model)
    if reason is not None:
        return Run(Outcome.UNSUPPORTED, reason)
    recipe = None if naive else (FREE if isinstance(scene.drive, Free) else PRESCRIBED)[setting]
    if recipe is not None:
        stepper.prepare()
    built = time.perf_counter() - began
    outcome, reason, history = _stepped(stepper, recipe)
    if history is not None and not naive:
        history = restored(history, units)
    return Run(outcome, reason, history, stepper.seconds, built, stepper.steps, stepper.details)


def _stepped(stepper: Stepper, recipe: Recipe | None) -> tuple[Outcome, str, History | None]:
    try:
        history = stepper.extrapolated(recipe) if recipe else stepper.defaults(NAIVE_STEP)
    except StoppedError as stop:
        return Outcome.DIVERGED, str(stop), None
    return Outcome.FINISHED, "", history


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


def _data_obstacle(scene: Scene) -> str | None:
    """What can be told from the data alone; exudyn itself would run on with most of this."""
    for body in scene.bodies:
        state = (*body.position, body.angle, *body.velocity, body.angular_velocity, *body.acceleration)
        if not all(map(math.isfinite, (body.mass, body.inertia or 0.0, *state, body.angular_acceleration))):
            return f"body '{body.name}' has a mass, inertia or start state that is not finite"
        if body.mass < 0.0 or (body.inertia or 0.0) < 0.0:
            return f"body '{body.name}' has a negative mass or inertia"
    return _standstill(scene) or start_misfit(scene)


def _standstill(scene: Scene) -> str | None:
    """A motion that sets off from a dwell: accelerations just after it cannot be told from the state just before."""
    if not isinstance(scene.drive, Prescribed):
        return None
    for before, after in pairwise(scene.drive.motion.segments):
        found = meeting(before, after)
        if found.jumps and found.speed == 0.0 == found.before:
            return f"the crank sets off from a dwell at {after.start:g} s; start a scene of its own there"
    return None


def _assembly_obstacle(model: Model) -> str | None:
    """Assemble a model; redundant joints would make it singular, which exudyn says only in the middle of a solve."""
    try:
        model.mbs.Assemble()
    except model.exudyn.ExudynError as error:
        return "exudyn refuses the scene: " + str(error).partition("\n")[0]
    found = model.exudyn.ComputeSystemDegreeOfFreedom(model.mbs)
    if found["redundantConstraints"]:
        return f"the joints repeat {found['redundantConstraints']} of their conditions, which makes exudyn singular"
    expected = 1 if model.driver is None else 0
    left = int(found["degreeOfFreedom"])
    if left != expected:
        return f"the joints leave {left} degrees of freedom where the drive needs {expected}"
    return None
