"""exudyn behind the contract: constrained planar bodies, one generalised-α run or trapezoidal runs extrapolated.

J. Gerstmayr, "Exudyn - a C++-based Python package for flexible multibody systems", Multibody System Dynamics 60 (2024).

- ``naive``: a rigid body for every link, prismatic joints, a Python function for the drive, exudyn's defaults at 1 ms.
- ``tuned``: one run of generalised α with its constraints on position level: joints stay closed over any number of
  turns, and a linkage passes its change points.
- ``best``: the trapezoidal rule with its constraints on velocity level, extrapolated to eighth order: its multipliers
  are free of the rounding that the square of the step magnifies on position level.

The parts of a prescribed motion start anew (``engines.exudyn_adapter.fresh_start``);
``engines.exudyn_adapter.recipes`` has the settings' numbers and the methods that can be studied.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import ClassVar

from analytic.description.linkage import DriverKind
from engines.contract import Abilities, History
from engines.exudyn_adapter.fresh_start import FROM, closed_state, end_state, set_initial
from engines.exudyn_adapter.model import Foreign, Model
from engines.exudyn_adapter.readout import READOUTS, Recorder, add_sensors
from engines.exudyn_adapter.recipes import EFFORT_UNIT, SETTINGS, STUDIED, ExudynRecipe
from engines.scene import GUIDES, LOADS, Free, Prescribed, Scene
from engines.stepping.driver import DivergedError, UnsupportedError
from engines.stepping.histories import joined
from engines.stepping.intervals import Interval
from engines.stepping.stepped_engine import Course, SteppedEngine


class ExudynEngine(SteppedEngine[Recorder, ExudynRecipe]):
    """Adapter for exudyn."""

    name = "exudyn"
    package = "exudyn"
    oldest = "1.13.6"  # has newton.residualMode
    work_unit = "Newton iterations"
    effort_unit = EFFORT_UNIT
    abilities: ClassVar[Abilities] = Abilities(
        readouts=READOUTS,
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS,
        drivers=frozenset(DriverKind),
    )
    settings = SETTINGS
    studied = STUDIED

    def build(self, scene: Scene, recipe: ExudynRecipe) -> Recorder:
        recorder = add_sensors(Model(scene, plain=recipe.as_shipped))
        _assemble(recorder.model)
        return recorder

    def follow(self, world: Recorder, course: Course[ExudynRecipe]) -> History:
        recipe, model = course.recipe, world.model
        course.cost.details.update(recipe.details())
        histories: list[History] = []
        with _silent():
            for part, later in zip(course.parts, [*course.parts[1:], None], strict=True):
                if not recipe.as_shipped:
                    _start(model, part, course.cost.details, first=not histories)
                _solve(model, part, course)
                before_jump = later is not None and later.after_jump
                histories.append(world.read(first=not histories, before_jump=before_jump))
        return joined(histories)


def _start(model: Model, part: Interval, details: dict[str, str | int | float], *, first: bool) -> None:
    """Set the drive's functions and the state a part starts from: the scene's, or one near what has been reached."""
    if first:
        start = model.start(0), model.start(1), model.start(2)
    else:
        reached = end_state(model)
        closed = closed_state(model, part, reached)
        told = "fresh_starts_left_out" if closed is None else "fresh_starts"
        details[told] = int(details.get(told, 0)) + 1
        if closed is not None:
            details["fresh_starts_from"] = FROM
        start = closed or reached
    if part.segment is not None:
        model.set_drive(part)
    model.starts.append((model.drive_terms(part), start, model.unwound.copy()))
    set_initial(model, *start)


def _solve(model: Model, part: Interval, course: Course[ExudynRecipe]) -> None:
    """Step through a part; raises DivergedError if exudyn stops or leaves what is no number."""
    mbs = model.mbs
    solver = model.exudyn.MainSolverImplicitSecondOrder()
    try:
        finished = solver.SolveSystem(mbs, solver_settings(model.exudyn, part, course))
        reason = solver.GetErrorString()
    except model.exudyn.ExudynError as error:
        finished, reason = False, str(error).partition("\n")[0]
    finally:
        course.cost.solver_work += solver.it.newtonStepsCount
    if not finished:
        raise DivergedError(f"exudyn stopped at {model.begin + mbs.systemData.GetTime():.4g} s: {reason}")
    if not all(map(math.isfinite, mbs.systemData.GetODE2Coordinates_t())):
        raise DivergedError(f"the state is not finite at {part.end:.4g} s")


def solver_settings(exudyn: Foreign, part: Interval, course: Course[ExudynRecipe]) -> Foreign:
    """The settings of a part's solver."""
    recipe = course.recipe
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime = part.end - part.start
    integration.numberOfSteps = part.samples * course.ratio
    settings.solution.sensors.writePeriod = part.step
    settings.solution.file.write = False
    newton = integration.newton
    if recipe.effort is not None:
        newton.relativeTolerance = newton.absoluteTolerance = recipe.effort
    if recipe.as_shipped:
        return settings
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
    integration.adaptiveStep = recipe.adaptive
    integration.generalizedAlpha.useNewmark = recipe.damping is None
    integration.generalizedAlpha.useIndex2Constraints = recipe.index == 2
    integration.generalizedAlpha.computeInitialAccelerations = False  # exudyn leaves out the drive's own
    if recipe.damping is not None:
        integration.generalizedAlpha.spectralRadius = recipe.damping
    # Residuals hold the multipliers, which nothing fixes at a change point; corrections of the motion die out there.
    newton.residualMode = 1
    newton.useModifiedNewton = True
    newton.modifiedNewtonJacUpdatePerStep = True
    return settings


def _assemble(model: Model) -> None:
    """Assemble a model; raises UnsupportedError where exudyn refuses it or its joints do not fit the drive.

    Redundant joints would make it singular, which exudyn says only in the middle of a solve.
    """
    try:
        model.mbs.Assemble()
    except model.exudyn.ExudynError as error:
        raise UnsupportedError("exudyn refuses the scene: " + str(error).partition("\n")[0]) from error
    freedom = model.exudyn.ComputeSystemDegreeOfFreedom(model.mbs)
    redundant = freedom["redundantConstraints"]
    if redundant:
        raise UnsupportedError(f"the joints repeat {redundant} of their conditions, which makes exudyn singular")
    expected = 1 if model.driver is None else 0
    left = int(freedom["degreeOfFreedom"])
    if left != expected:
        raise UnsupportedError(f"the joints leave {left} degrees of freedom where the drive needs {expected}")


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
