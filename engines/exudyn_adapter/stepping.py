"""Stepping an exudyn system through intervals of its drive, each from a state that fits the joints exactly.

The implicit trapezoidal rule with its constraints on velocity level (index 2) is second order in the multipliers too.
But its multipliers and accelerations carry an undamped part that changes sign from step to step, as large as
whatever does not fit at the start: 9.5 % of the peak torque for ever after a linear ramp's kink if nothing is done. So
a run starts from consistent accelerations and starts anew at every jump of the prescribed one; what is left of that
part, of the size of the truncation error, goes in the extrapolation, since all steps are odd fractions of the longest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import Segment
from engines.contract import History
from engines.exudyn_adapter.checks import broken, not_finite
from engines.exudyn_adapter.drive import Foreign, polynomial, whole_angle
from engines.exudyn_adapter.model import Model
from engines.exudyn_adapter.projection import Constraints, projected_state
from engines.exudyn_adapter.readout import Recorder
from engines.exudyn_adapter.recipes import TIGHTER, Recipe
from engines.scene import Prescribed, Scene
from engines.stepping.cost import Cost
from engines.stepping.driver import DivergedError
from engines.stepping.histories import joined
from engines.stepping.intervals import Interval

Array = NDArray[np.float64]


class Stepper:
    """Solves a model and keeps account of what this costs.

    ``checked`` stops a run whose linkage came apart or whose crank is not where its drive has it; without it only what
    is no number stops one.
    """

    def __init__(self, model: Model, recorder: Recorder, cost: Cost, *, checked: bool) -> None:
        self.model = model
        self.recorder = recorder
        self.scene: Scene = model.scene
        self.checked = checked
        self.cost = cost
        self._side = 0.0  # of the start state: the sign of the determinant of its constraints
        # By a segment's start; exudyn does not keep its symbolic functions alive itself.
        self._functions: dict[float, tuple[Foreign, Foreign]] = {}

    def prepare(self, recipe: Recipe) -> None:
        """Make the drive's functions of time, which belongs to building the model."""
        drive = self.scene.drive
        if not isinstance(drive, Prescribed):
            return
        if recipe.rule.as_shipped:
            angle = whole_angle(drive.motion.segments)
            self.model.mbs.SetObjectParameter(self.model.driver, "offsetUserFunction", angle)
            return
        for segment in drive.motion.segments:
            self._functions[segment.start] = self._symbolic(segment)

    def pass_through(self, recipe: Recipe, parts: Sequence[Interval], division: int) -> History:
        """All parts in ``division`` steps per basic step; samples on the basic steps. Raises DivergedError."""
        histories: list[History] = []
        for part, after in zip(parts, [*parts[1:], None], strict=True):
            if not recipe.rule.as_shipped:
                self._enter(part, fresh=not histories)
            self._solve(self._settings(recipe, part, division), part, division)
            samples = self.recorder.samples()
            if not recipe.rule.as_shipped and samples not in (None, part.samples + 1):
                raise DivergedError(f"exudyn recorded {samples} samples of {part.samples + 1}")
            histories.append(self.recorder.read(last=after is None, before_jump=after is not None and after.after_jump))
        if isinstance(self.scene.drive, Prescribed) and self.checked and not recipe.rule.as_shipped:
            end, left = parts[-1].end, self._left()
            self._check_side(Constraints(self.model).side(left, end), end)
        return joined(histories)

    def _enter(self, part: Interval, *, fresh: bool) -> None:
        """Set the state a part starts from and the drive's functions of time for it."""
        mbs = self.model.mbs
        if part.segment is not None:
            angle, speed = self._functions[part.segment.start]
            mbs.SetObjectParameter(self.model.driver, "offsetUserFunction", angle)
            mbs.SetObjectParameter(self.model.driver, "offsetUserFunction_t", speed)
        values = self._start(part) if fresh else self._closed(part)
        state, initial = mbs.systemData, self.model.exudyn.ConfigurationType.Initial
        state.SetODE2Coordinates(values[0], configuration=initial)
        state.SetODE2Coordinates_t(values[1], configuration=initial)
        state.SetODE2Coordinates_tt(values[2], configuration=initial)

    def _start(self, part: Interval) -> tuple[Array, Array, Array]:
        position, velocity, acceleration = (self.model.start(order) for order in range(3))
        if part.segment is not None and self.checked:
            self._side = Constraints(self.model).side(position, part.start)
        return position, velocity, acceleration

    def _closed(self, part: Interval) -> tuple[Array, Array, Array]:
        """The state the part before has left, put back on the joints and the drive."""
        assert part.segment is not None
        left = self._left()
        speed, second = (abs(float(part.segment.value(part.start, order))) for order in (1, 2))
        pace = speed + math.sqrt(second) + 1.0 / (part.end - part.start)
        with self.cost.stepping():
            constraints = Constraints(self.model)
            state = projected_state(constraints, left, part.start, pace, strict=self.checked)
        self.cost.solver_work += constraints.systems
        if state is None:
            raise DivergedError(f"the joints could not be closed again at {part.start:.4g} s")
        if self.checked:
            self._check_side(state.side, part.start)
        return state.position, state.velocity, state.acceleration

    def _left(self) -> Array:
        """The coordinates a part has ended with, before anything else is done with the model."""
        return np.array(self.model.mbs.systemData.GetODE2Coordinates())

    def _check_side(self, side: float, now: float) -> None:
        """Raise DivergedError where the linkage has passed a point at which its constraints are singular."""
        if side != self._side:
            raise DivergedError(f"the linkage has passed a dead or change point before {now:.4g} s")

    def _symbolic(self, segment: Segment) -> tuple[Foreign, Foreign]:
        """Angle from the start and speed over time, run by the solver itself: Python ones take a third more time."""
        from exudyn.advancedUtilities import CreateSymbolicUserFunction as Symbolic

        mbs, driver = self.model.mbs, self.model.driver
        return (
            Symbolic(mbs, polynomial(segment, 0, self.scene.crank_angle), "offsetUserFunction", driver),
            Symbolic(mbs, polynomial(segment, 1), "offsetUserFunction_t", driver),
        )

    def _settings(self, recipe: Recipe, part: Interval, division: int) -> Foreign:
        exudyn = self.model.exudyn
        settings = exudyn.SimulationSettings()
        integration, rule = settings.timeIntegration, recipe.rule
        integration.startTime = part.start
        integration.endTime = part.end
        integration.numberOfSteps = part.samples * division
        settings.solution.sensors.writePeriod = part.step
        settings.solution.file.write = False
        if recipe.tolerance is not None:
            integration.newton.relativeTolerance = recipe.tolerance
            integration.newton.absoluteTolerance = TIGHTER * recipe.tolerance
        if rule.as_shipped:
            return settings
        settings.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
        integration.adaptiveStep = False  # a step cut in half would break the common grid without a word
        integration.generalizedAlpha.useNewmark = rule.damping is None
        integration.generalizedAlpha.useIndex2Constraints = rule.index == 2
        integration.generalizedAlpha.computeInitialAccelerations = False  # exudyn leaves out the drive's own
        if rule.damping is not None:
            integration.generalizedAlpha.spectralRadius = rule.damping
        integration.newton.useModifiedNewton = True
        integration.newton.modifiedNewtonJacUpdatePerStep = True
        return settings

    def _solve(self, settings: Foreign, part: Interval, division: int) -> None:
        """Step through a part; raises DivergedError if exudyn stops or leaves what cannot be gone on with."""
        exudyn, mbs = self.model.exudyn, self.model.mbs
        solver = exudyn.MainSolverImplicitSecondOrder()
        try:
            with self.cost.stepping():
                finished = solver.SolveSystem(mbs, settings)
            reason = solver.GetErrorString()
        except exudyn.ExudynError as error:
            finished, reason = False, str(error).partition("\n")[0]
        finally:
            self.cost.steps += solver.it.currentStepIndex - 1  # the step it would have taken next
            self.cost.solver_work += solver.it.newtonStepsCount
        if not finished:
            raise DivergedError(f"exudyn stopped at {mbs.systemData.GetTime():.4g} s: {reason}")
        fault = not_finite(self.model, part.end)
        if fault is None and self.checked:
            fault = broken(self.model, part.end, division)
        if fault is not None:
            raise DivergedError(fault)
