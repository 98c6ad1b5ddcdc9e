"""Stepping an exudyn system through its drive: restarts where the acceleration jumps, passes at several steps.

The implicit trapezoidal rule with its constraints on velocity level (index 2) is second order in the multipliers too.
But its multipliers and accelerations carry an undamped part that changes sign from step to step, as large as
whatever does not fit at the start: 9.5 % of the peak torque for ever after a linear ramp's kink if nothing is done. So
a run starts from consistent accelerations and starts anew at every jump of the prescribed one; what is left of that
part, of the size of the truncation error, goes in the extrapolation, since all steps are odd fractions of the longest.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from analytic.regimes import Segment
from engines.consistency import State, misfits, scene_size
from engines.contract import Channel, Free, History, Prescribed, Scene, Signal
from engines.exudyn_drive import (
    Foreign,
    Meeting,
    accelerations_after,
    crank_value,
    derivative,
    meeting,
    polynomial,
    whole_angle,
)
from engines.exudyn_model import ANGLE, Model
from engines.exudyn_readout import Recorder, Strip, join
from engines.richardson import change, extrapolate

FULL_TURN = 2.0 * math.pi
# A joint may be open by this share of the scene's size over the square of the division: the drift of a constraint on
# velocity level is second order in the step, and what does not shrink like that is not drift.
LARGEST_GAP = 5e-2
LARGEST_LAG = 0.05  # rad between the crank and its prescribed angle
PILOTS = 12  # attempts at finding the speed of a free crank
SLACK = 1.25  # a step may be this much longer than wanted before it is tried again
CAUTION = 8.0  # the pace seen with too long a step may be nonsense: the step is cut by no more than this at a time
RETREAT = 2.0  # the cut after a pass that failed, which says nothing of the step that would do
ATTEMPTS = 4  # at an accuracy, each with a shorter step
LEAST_CUT, LARGEST_CUT = 1.5, 4.0  # of the step from one attempt to the next


@dataclass(frozen=True)
class Recipe:
    """How a setting integrates: its basic step, and the ``divisions`` of it that are run and extrapolated.

    At least ``levels`` divisions are run, the others if the estimated error of accelerations and torque, relative to
    their peaks, is above ``accuracy``; if that does not do, all is done again with a shorter step.
    """

    divisions: tuple[int, ...]
    levels: int
    steps_per_turn: float
    accuracy: float
    relative_tolerance: float
    absolute_tolerance: float
    least_steps: int = 100

    def details(self) -> dict[str, str | int | float]:
        """The settings in words, for the record of a run."""
        return {
            "integrator": "implicit trapezoidal rule, constraints on velocity level",
            "newton": "modified, Jacobian updated every step",
            "relative_tolerance": self.relative_tolerance,
            "absolute_tolerance": self.absolute_tolerance,
            "steps_per_turn": round(self.steps_per_turn, 1),
        }

    def finer(self, error: float) -> Recipe:
        """The recipe with a step that should bring ``error`` down to the accuracy wanted."""
        cut = 1.1 * (error / self.accuracy) ** (0.5 / len(self.divisions)) if math.isfinite(error) else RETREAT
        return replace(self, steps_per_turn=self.steps_per_turn * min(max(cut, LEAST_CUT), LARGEST_CUT))


@dataclass(frozen=True)
class Stretch:
    """A part of a run between restarts, in ``samples`` basic steps.

    If the motion is prescribed it is one ``segment`` of it, which ``entry`` joins to the one before.
    """

    start: float
    end: float
    samples: int
    segment: Segment | None = None
    entry: Meeting | None = None

    @property
    def step(self) -> float:
        """Basic step, s."""
        return (self.end - self.start) / self.samples


class StoppedError(Exception):
    """The engine gave up, or went on with something that is not the scene's motion."""


class Stepper:
    """Solves a model and keeps account of the time and the steps this takes."""

    def __init__(self, model: Model, recorder: Recorder) -> None:
        self.model = model
        self.recorder = recorder
        self.scene: Scene = model.scene
        self.seconds = 0.0
        self.steps = 0
        self.details: dict[str, str | int | float] = {}
        # By a segment's start; exudyn does not keep its symbolic functions alive itself.
        self._functions: dict[float, tuple[Foreign, Foreign]] = {}

    # -- whole runs ----------------------------------------------------------------------------------------------------

    def defaults(self, step: float) -> History:
        """One pass with exudyn's own defaults, the whole motion as one Python function of time."""
        exudyn, drive = self.model.exudyn, self.scene.drive
        if isinstance(drive, Prescribed):
            angle = whole_angle(drive.motion.segments)
            self.model.mbs.SetObjectParameter(self.model.driver, "offsetUserFunction", angle)
        end = drive.duration if isinstance(drive, Free) else drive.motion.duration
        stretch = Stretch(0.0, end, max(1, round(end / step)))
        settings = exudyn.SimulationSettings()
        self._set_clock(settings, stretch, 1)
        self.details = {"integrator": "exudyn's defaults", "step": stretch.step}
        self._solve(settings, stretch, 1)
        history = join([self.recorder.read()], [False])
        return self._with_constant_torque(history, stretch)

    def extrapolated(self, recipe: Recipe) -> History:
        """Passes of a recipe, combined; done again with a shorter step while its accuracy is missed."""
        history: History | None = None
        failure = StoppedError()
        for _ in range(ATTEMPTS):
            try:
                history, error = self._attempt(recipe)
            except StoppedError as stop:
                failure, error = stop, math.inf
            if error <= recipe.accuracy:
                break
            recipe = recipe.finer(error)
        if history is None:
            raise failure
        return history

    def _attempt(self, recipe: Recipe) -> tuple[History, float]:
        """The extrapolated history and an estimate of its error, adding divisions as long as it is too large.

        From two passes the estimate is the product of their errors, for each squares the step; from more it is what the
        last pass changed, reduced as much again as it is less than the change before.
        """
        self.details = recipe.details()
        stretches = self._prescribed(recipe)
        passes: list[tuple[float, History]] = []
        if not stretches:
            stretches, first = self._pilot(recipe)
            passes.append((1.0, first))
        history, error, before = passes[0][1] if passes else History(), math.inf, math.inf
        for division in recipe.divisions[len(passes) :]:
            passes.append((1.0 / division, self._pass(recipe, stretches, division)))
            former, history = history, extrapolate(passes) if len(passes) > 1 else passes[0][1]
            if len(passes) == 2:
                before = change(passes[1][1], history)
                error = before * change(passes[0][1], history)
            elif len(passes) > 2:
                now = change(former, history)
                error, before = now * min(1.0, now / before if before else 1.0), now
            if len(passes) >= recipe.levels and error <= recipe.accuracy:
                break
        self.details["divisions"] = " ".join(map(str, recipe.divisions[: len(passes)]))
        self.details["estimated_error"] = error
        return self._with_constant_torque(history, stretches[0]), error

    def prepare(self) -> None:
        """Make the drive's functions of time, which belongs to building the model."""
        if isinstance(self.scene.drive, Prescribed):
            for segment in self.scene.drive.motion.segments:
                self._functions[segment.start] = self._symbolic(segment)

    def _with_constant_torque(self, history: History, stretch: Stretch) -> History:
        """A free crank's drive torque is what the scene says: there is nothing to read."""
        drive = self.scene.drive
        if not isinstance(drive, Free) or Channel.TORQUE not in self.scene.channels:
            return history
        clock = np.linspace(stretch.start, stretch.end, stretch.samples + 1)
        return replace(history, torque=Signal(clock, np.full(len(clock), drive.torque)))

    # -- choosing steps ------------------------------------------------------------------------------------------------

    def _prescribed(self, recipe: Recipe) -> list[Stretch]:
        """The motion's segments, each in so many steps that its fastest turn has enough of them."""
        drive = self.scene.drive
        if not isinstance(drive, Prescribed):
            return []
        segments = drive.motion.segments
        entries = [None, *(meeting(before, after) for before, after in pairwise(segments))]
        rate = drive.motion.peak_speed * recipe.steps_per_turn / FULL_TURN
        return [
            Stretch(s.start, s.end, max(recipe.least_steps, math.ceil((s.end - s.start) * rate - 1e-6)), s, entry)
            for s, entry in zip(segments, entries, strict=True)
        ]

    def _pilot(self, recipe: Recipe) -> tuple[list[Stretch], History]:
        """A step that fits a free crank's speed, and the pass at that step.

        The speed is not known beforehand: passes are made until one is fine enough for the pace it shows itself.
        """
        drive = self.scene.drive
        assert isinstance(drive, Free)
        crank = next(body for body in self.scene.bodies if body.name == self.scene.crank)
        pace = abs(crank.angular_velocity) + math.sqrt(abs(crank.angular_acceleration))
        step = min(drive.duration / recipe.least_steps, self._wanted(pace, recipe))
        reason = ""
        for _ in range(PILOTS):
            stretch = Stretch(0.0, drive.duration, math.ceil(drive.duration / step - 1e-6))
            try:
                history = self._pass(recipe, [stretch], 1)
            except StoppedError as stop:
                reason = str(stop)
                step /= RETREAT
                continue
            wanted = self._wanted(self.recorder.pace(), recipe)
            if stretch.step <= SLACK * wanted:
                return [stretch], history
            reason = f"the crank turned too fast for a step of {stretch.step:.3g} s"
            step = max(wanted, step / CAUTION)
        raise StoppedError(f"no step was found that fits the free crank in {PILOTS} attempts: {reason}")

    def _wanted(self, pace: float, recipe: Recipe) -> float:
        return FULL_TURN / (recipe.steps_per_turn * pace) if pace > 0.0 else math.inf

    # -- one pass ------------------------------------------------------------------------------------------------------

    def _pass(self, recipe: Recipe, stretches: Sequence[Stretch], division: int) -> History:
        """All stretches in ``division`` steps per basic step; samples on the basic steps."""
        strips: list[Strip] = []
        for stretch in stretches:
            self._enter(stretch)
            self._solve(self._settings(recipe, stretch, division), stretch, division)
            strip = self.recorder.read()
            if self.recorder.sensors and len(strip.time) != stretch.samples + 1:
                raise StoppedError(f"exudyn recorded {len(strip.time)} samples of {stretch.samples + 1}")
            strips.append(strip)
        entries = [stretch.entry for stretch in stretches[1:]]
        return join(strips, [*(entry is not None and entry.jumps for entry in entries), False])

    def _enter(self, stretch: Stretch) -> None:
        """Set the state a stretch starts from and the drive's functions of time for it."""
        exudyn, mbs = self.model.exudyn, self.model.mbs
        state, initial = mbs.systemData, exudyn.ConfigurationType.Initial
        if stretch.entry is None:
            values = [self.model.start(order) for order in range(3)]
        else:
            values = [state.GetODE2Coordinates(), state.GetODE2Coordinates_t(), state.GetODE2Coordinates_tt()]
            values[2] = accelerations_after(stretch.entry, values[1], values[2])
        state.SetODE2Coordinates(values[0], configuration=initial)
        state.SetODE2Coordinates_t(values[1], configuration=initial)
        state.SetODE2Coordinates_tt(values[2], configuration=initial)
        if stretch.segment is not None:
            angle, speed = self._functions[stretch.segment.start]
            mbs.SetObjectParameter(self.model.driver, "offsetUserFunction", angle)
            mbs.SetObjectParameter(self.model.driver, "offsetUserFunction_t", speed)

    def _symbolic(self, segment: Segment) -> tuple[Foreign, Foreign]:
        """Angle from the start and speed over time, run by the solver itself: Python ones take a third more time."""
        from exudyn.advancedUtilities import CreateSymbolicUserFunction as Symbolic

        angle, speed = (derivative(segment.coefficients, order) for order in range(2))
        angle[0] -= self.scene.crank_angle
        mbs, driver = self.model.mbs, self.model.driver
        return (
            Symbolic(mbs, polynomial(angle, segment.start), "offsetUserFunction", driver),
            Symbolic(mbs, polynomial(speed, segment.start), "offsetUserFunction_t", driver),
        )

    def _settings(self, recipe: Recipe, stretch: Stretch, division: int) -> Foreign:
        exudyn = self.model.exudyn
        settings = exudyn.SimulationSettings()
        self._set_clock(settings, stretch, division)
        settings.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
        integration = settings.timeIntegration
        integration.adaptiveStep = False  # a step cut in half would break the common grid without a word
        integration.generalizedAlpha.useNewmark = True
        integration.generalizedAlpha.useIndex2Constraints = True
        integration.generalizedAlpha.computeInitialAccelerations = False  # exudyn leaves out the drive's own
        integration.newton.useModifiedNewton = True
        integration.newton.modifiedNewtonJacUpdatePerStep = True
        integration.newton.relativeTolerance = recipe.relative_tolerance
        integration.newton.absoluteTolerance = recipe.absolute_tolerance
        return settings

    def _set_clock(self, settings: Foreign, stretch: Stretch, division: int) -> None:
        settings.timeIntegration.startTime = stretch.start
        settings.timeIntegration.endTime = stretch.end
        settings.timeIntegration.numberOfSteps = stretch.samples * division
        settings.solution.sensors.writePeriod = stretch.step
        settings.solution.file.write = False

    def _solve(self, settings: Foreign, stretch: Stretch, division: int) -> None:
        """Step through a stretch; raises StoppedError if exudyn stops or leaves a linkage that came apart."""
        exudyn, mbs = self.model.exudyn, self.model.mbs
        solver = exudyn.MainSolverImplicitSecondOrder()
        began = time.perf_counter()
        try:
            finished = solver.SolveSystem(mbs, settings)
            reason = solver.GetErrorString()
        except exudyn.ExudynError as error:
            finished, reason = False, str(error).partition("\n")[0]
        finally:
            self.seconds += time.perf_counter() - began
            self.steps += solver.it.currentStepIndex - 1  # the step it would have taken next
        if not finished:
            raise StoppedError(f"exudyn stopped at {mbs.systemData.GetTime():.4g} s: {reason}")
        self._check(stretch, division)

    def _check(self, stretch: Stretch, division: int) -> None:
        """What exudyn does not look at: is the state finite, the linkage closed, the crank where its drive has it?"""
        shift = iter(self.model.mbs.systemData.GetODE2Coordinates().tolist())
        states: dict[str, State] = {}
        for body in self.scene.bodies:
            turn = body.name in self.model.turning
            x, y = body.position[0] + next(shift), body.position[1] + next(shift)
            states[body.name] = State((x, y, body.angle + (next(shift) if turn else 0.0)))
        size = scene_size(self.scene)
        for miss in misfits(self.scene, states, orders=1):
            share = miss.size / size
            if not share <= LARGEST_GAP / division**2:
                raise StoppedError(f"joint '{miss.joint}' is open by {share:.2%} of a link at {stretch.end:.4g} s")
        if isinstance(self.scene.drive, Prescribed):
            last = self.scene.drive.motion.segments[-1] if stretch.segment is None else stretch.segment
            lag = states[self.scene.crank].position[ANGLE] - crank_value(last, stretch.end, 0)
            if not abs(lag) <= LARGEST_LAG:
                raise StoppedError(f"the crank is {lag:.3g} rad away from its drive at {stretch.end:.4g} s")
