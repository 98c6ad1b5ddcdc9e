"""Stepping any engine to an accuracy: passes at several steps, and the search of a step.

An engine brings one pass of a scene at a step and raises :class:`DivergedError` where it gives none; how fine the step
has to be and how many passes are extrapolated is settled here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.errors import LinkproofError
from engines.contract import History, Outcome, Run
from engines.stepping.cost import Cost
from engines.stepping.histories import labelled
from engines.stepping.richardson import Pass

ROUNDING = 1e-6  # of a step: what a whole number of steps may lack of a duration
SLACK = 1.25  # a step may be this much longer than wanted before it is tried again
CAUTION = 8.0  # the pace seen with too long a step may be nonsense: the step is cut by no more than this at a time


class DivergedError(Exception):
    """The engine gave up, or went on with something that is not the scene's motion; the message says which."""


class UnsupportedError(Exception):
    """A scene of which only its building shows that the engine cannot hold it; the message says why."""


def run_stepping(cost: Cost, history: Callable[[], History]) -> Run:
    """The run whose history a call makes, with its cost however it ends; a history of numbers alone is a motion."""
    try:
        result = history()
        for name, signal in labelled(result):
            if not np.isfinite(signal.values).all():
                raise DivergedError(f"the {name} is not finite everywhere")
        return cost.run(Outcome.FINISHED, history=result)
    except DivergedError as stop:
        return cost.run(Outcome.DIVERGED, str(stop))
    except UnsupportedError as stop:
        return cost.run(Outcome.UNSUPPORTED, str(stop))


def check_step(step: float) -> None:
    """Raise LinkproofError for a step that is none."""
    if not 0.0 < step < math.inf:
        raise LinkproofError(f"step: expected a positive finite number of seconds, got {step:g}; correct it")


def whole_steps(duration: float, step: float, least: int) -> int:
    """Number of equal steps of at most ``step`` that make up a duration, ``least`` or more."""
    return max(least, math.ceil(duration / step - ROUNDING))


def refined(
    run_pass: Callable[[int], Pass],
    ratios: Sequence[int],
    *,
    levels: int,
    estimate: Callable[[Sequence[Pass]], float],
    accuracy: float,
    worthwhile: float = math.inf,
    first: Sequence[Pass] = (),
) -> tuple[list[Pass], float]:
    """Passes at the step over each of the ratios and an estimate of the error of their extrapolation.

    At least ``levels`` are made, more while the estimate is above ``accuracy`` and each brings it below the share
    ``worthwhile`` of what it was. ``first`` are passes that exist already. Raises DivergedError where a pass does.
    """
    passes, error = list(first), math.inf
    for ratio in ratios[len(passes) :]:
        passes.append(run_pass(ratio))
        if len(passes) < levels:
            continue
        before, error = error, estimate(passes)
        if error <= accuracy or not error < worthwhile * before:
            break
    return passes, error


@dataclass
class StepSearch:
    """The search of a step that fits a free crank, whose speed is not known beforehand.

    The step is shortened until there are ``steps_per_turn`` at the pace that a trial with it shows, at most by CAUTION
    at a time, or by ``retreat`` where the trial fails. ``trials`` counts down those that are left.
    """

    duration: float
    steps_per_turn: float
    least_steps: int
    trials: int
    retreat: float
    shortest: float = 0.0

    def fit(self, step: float, pace: Callable[[float], float]) -> float:
        """The longest step, s, of those tried from ``step`` on that fits the ``pace``, rad/s, it shows itself.

        Raises DivergedError where no trials are left.
        """
        reason = "it is too short"
        while self.trials > 0:
            self.trials -= 1
            step = self.duration / whole_steps(self.duration, step, self.least_steps)
            if step < self.shortest:
                break
            try:
                wanted = turn_share(pace(step), self.steps_per_turn)
            except DivergedError as stop:
                reason, step = str(stop), step / self.retreat
                continue
            if step <= SLACK * wanted:
                return step
            reason = f"the crank turned too fast for a step of {step:.3g} s"
            step = max(wanted, step / CAUTION)
        raise DivergedError(f"no step down to {step:.2g} s fits the free crank: {reason}")


def turn_share(pace: float, steps_per_turn: float) -> float:
    """The step, s, of which so many make a turn at a pace, rad/s."""
    return FULL_TURN / (steps_per_turn * pace) if pace > 0.0 else math.inf
