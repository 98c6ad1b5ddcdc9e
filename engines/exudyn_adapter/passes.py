"""Passes of a recipe at several divisions of its step, combined; and the search for a step that is fine enough."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from engines.contract import History, Signal
from engines.exudyn_adapter.recipes import RETREAT, Recipe
from engines.exudyn_adapter.segments import Stretch, free_stretch, prescribed_stretches, wanted_step
from engines.exudyn_adapter.stepping import Stepper, StoppedError
from engines.scene import Channel, Free
from engines.stepping.richardson import change, extrapolate

PILOTS = 12  # attempts at finding the speed of a free crank
SLACK = 1.25  # a step may be this much longer than wanted before it is tried again
SAFETY = 2.0  # of an estimated error over what the theory of evenly shrinking terms says
COARSE = 0.5  # the relative error for which a step that is far too long stands
CAUTION = 8.0  # the pace seen with too long a step may be nonsense: the step is cut by no more than this at a time


def follow(recipe: Recipe, stepper: Stepper) -> History:
    """The motion by a recipe; done again with a shorter step while its accuracy is missed and it has attempts left.

    Raises StoppedError where no attempt gave a history.
    """
    history: History | None = None
    failure = StoppedError()
    for _ in range(recipe.attempts):
        try:
            history, error = _attempt(recipe, stepper)
        except StoppedError as stop:
            failure, error = stop, math.inf
        if error <= recipe.accuracy:
            break
        recipe = recipe.finer(error)
    if history is None:
        raise failure
    return history


def _attempt(recipe: Recipe, stepper: Stepper) -> tuple[History, float]:
    """The extrapolated history and an estimate of its error, adding divisions as long as it is too large."""
    stepper.details = recipe.details()
    stretches, passes = _begun(recipe, stepper)
    history, error = passes[0][1] if passes else History(), math.inf
    changes: list[float] = []
    for division in recipe.divisions[len(passes) :]:
        passes.append((1.0 / division, stepper.pass_through(recipe, stretches, division)))
        former, history = history, extrapolate(passes, recipe.rule.orders)
        if len(passes) > 1:
            changes.append(change(former, history))
            error = estimated_error(changes, recipe.divisions)
        if len(passes) >= recipe.levels and error <= recipe.accuracy:
            break
    stepper.details["step"] = max(stretch.step for stretch in stretches)
    stepper.details["divisions"] = " ".join(map(str, recipe.divisions[: len(passes)]))
    if len(passes) > 1:
        stepper.details["estimated_error"] = error
    return _with_constant_torque(history, stretches[0], stepper), error


def estimated_error(changes: Sequence[float], divisions: Sequence[int]) -> float:
    """Error of an extrapolation by what each of its passes but the first changed, relative to the peaks.

    If the terms of the error, cₖ h²ᵏ, shrink evenly, the error left by k passes is as much less than the last change as
    that is less than the one before, times the square of the ratio of their divisions. With one change only, COARSE
    stands for the one before it. Measured on all test linkages: half to twice the error from three passes on, seven
    tenths to six times from two, as long as Newton's tolerance is not what limits it.
    """
    before = changes[-2] if len(changes) > 1 else COARSE
    now, number = changes[-1], len(changes)
    ratio = now / before if before else 1.0
    return SAFETY * now * min(1.0, ratio) * (divisions[number - 1] / divisions[number]) ** 2


def _begun(recipe: Recipe, stepper: Stepper) -> tuple[list[Stretch], list[tuple[float, History]]]:
    """The stretches to run, and the passes that were made in finding them."""
    drive = stepper.scene.drive
    if not isinstance(drive, Free):
        return prescribed_stretches(stepper.scene, recipe), []
    if not recipe.steps_per_turn:
        return [free_stretch(drive, recipe, recipe.step)], []
    stretch, first = _pilot(drive, recipe, stepper)
    return [stretch], [(1.0, first)]


def _pilot(drive: Free, recipe: Recipe, stepper: Stepper) -> tuple[Stretch, History]:
    """A step that fits a free crank's speed, and the pass at that step.

    The speed is not known beforehand: passes are made until one is fine enough for the pace it shows itself.
    """
    scene = stepper.scene
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    pace = abs(crank.angular_velocity) + math.sqrt(abs(crank.angular_acceleration))
    step, reason = wanted_step(pace, recipe), ""
    for _ in range(PILOTS):
        stretch = free_stretch(drive, recipe, step)
        try:
            history = stepper.pass_through(recipe, [stretch], 1)
        except StoppedError as stop:
            reason = str(stop)
            step = stretch.step / RETREAT
            continue
        wanted = wanted_step(stepper.recorder.pace(), recipe)
        if stretch.step <= SLACK * wanted:
            return stretch, history
        reason = f"the crank turned too fast for a step of {stretch.step:.3g} s"
        step = max(wanted, stretch.step / CAUTION)
    raise StoppedError(f"no step was found that fits the free crank in {PILOTS} attempts: {reason}")


def _with_constant_torque(history: History, stretch: Stretch, stepper: Stepper) -> History:
    """A free crank's drive torque is what the scene says: there is nothing to read."""
    drive = stepper.scene.drive
    if not isinstance(drive, Free) or Channel.TORQUE not in stepper.scene.channels:
        return history
    clock = np.linspace(stretch.start, stretch.end, stretch.samples + 1)
    return replace(history, torque=Signal(clock, np.full(len(clock), drive.torque)))
