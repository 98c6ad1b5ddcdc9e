"""Passes of a recipe at several divisions of its step, combined; done again at a shorter step if not accurate."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from engines.contract import History, Signal
from engines.exudyn_adapter.recipes import RETREAT, Recipe
from engines.exudyn_adapter.stepping import Stepper
from engines.scene import Channel, Free
from engines.stepping.driver import DivergedError, StepSearch, refined, turn_share
from engines.stepping.error_estimate import estimated_error
from engines.stepping.intervals import Interval, intervals, whole_interval
from engines.stepping.richardson import Pass, extrapolate

TRIALS = 12  # attempts at finding the speed of a free crank


def follow(recipe: Recipe, stepper: Stepper) -> History:
    """The motion by a recipe; done again with a shorter step while its accuracy is missed and it has attempts left.

    Raises DivergedError where no attempt gave a history.
    """
    history: History | None = None
    failure = DivergedError()
    for _ in range(recipe.attempts):
        try:
            history, error = _attempt(recipe, stepper)
        except DivergedError as stop:
            failure, error = stop, math.inf
        if error <= recipe.accuracy:
            break
        recipe = recipe.finer(error)
    if history is None:
        raise failure
    return history


def _attempt(recipe: Recipe, stepper: Stepper) -> tuple[History, float]:
    """The extrapolated history and an estimate of its error."""
    details = stepper.cost.details
    details.clear()
    details.update(recipe.details())
    orders = recipe.rule.orders
    parts, first = _parts(recipe, stepper)
    passes, error = refined(
        lambda division: Pass(1.0 / division, stepper.pass_through(recipe, parts, division)),
        recipe.divisions,
        levels=recipe.levels,
        estimate=lambda passes: estimated_error(passes, orders),
        accuracy=recipe.accuracy,
        first=first,
    )
    details["step"] = max(part.step for part in parts)
    details["divisions"] = " ".join(map(str, recipe.divisions[: len(passes)]))
    if len(passes) > 1:
        details["estimated_error"] = error
    return _with_constant_torque(extrapolate(passes, orders), parts[0], stepper), error


def _parts(recipe: Recipe, stepper: Stepper) -> tuple[list[Interval], list[Pass]]:
    """The intervals to run, and the passes that were made in finding them."""
    drive = stepper.scene.drive
    if isinstance(drive, Free):
        return _free_part(drive, recipe, stepper)
    if recipe.rule.as_shipped:
        return [whole_interval(drive.motion.duration, recipe.step, recipe.least_steps)], []
    return intervals(drive.motion, recipe), []


def _free_part(drive: Free, recipe: Recipe, stepper: Stepper) -> tuple[list[Interval], list[Pass]]:
    """A free crank's whole motion at a step that fits its speed, and the pass at that step if it was sought."""
    if not recipe.steps_per_turn:
        return [whole_interval(drive.duration, recipe.step, recipe.least_steps)], []
    crank = next(body for body in stepper.scene.bodies if body.name == stepper.scene.crank)
    first: list[Pass] = []

    def pace(step: float) -> float:
        part = whole_interval(drive.duration, step, recipe.least_steps)
        first[:] = [Pass(1.0, stepper.pass_through(recipe, [part], 1))]
        return stepper.recorder.pace()

    search = StepSearch(drive.duration, recipe.steps_per_turn, recipe.least_steps, TRIALS, RETREAT)
    start = abs(crank.angular_velocity) + math.sqrt(abs(crank.angular_acceleration))
    step = search.fit(turn_share(start, recipe.steps_per_turn), pace)
    return [whole_interval(drive.duration, step, recipe.least_steps)], first


def _with_constant_torque(history: History, part: Interval, stepper: Stepper) -> History:
    """A free crank's drive torque is what the scene says: there is nothing to read."""
    drive = stepper.scene.drive
    if not isinstance(drive, Free) or Channel.TORQUE not in stepper.scene.channels:
        return history
    clock = np.linspace(part.start, part.end, part.samples + 1)
    return replace(history, torque=Signal(clock, np.full(len(clock), drive.torque)))
