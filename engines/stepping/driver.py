"""How a run ends, its cost, and in how many steps it is taken."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from analytic.errors import LinkproofError
from engines.contract import History, Outcome, Run
from engines.stepping.histories import labelled

ROUNDING = 1e-6  # of a step: what a whole number of steps may lack of a duration


class DivergedError(Exception):
    """The engine stopped early, or computed another motion than the scene's; the message gives the reason."""


class UnsupportedError(Exception):
    """The engine does not support the scene, which shows only while it is built; the message gives the reason."""


@dataclass
class Cost:
    """Cost of a run so far, passes that failed included, and the ``details`` of the settings used."""

    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    solver_work: int = 0
    passes: tuple[float, ...] = ()
    details: dict[str, str | int | float] = field(default_factory=dict)

    @contextmanager
    def building(self) -> Iterator[None]:
        """Count the wall time of the block as set-up."""
        begun = perf_counter()
        try:
            yield
        finally:
            self.setup_seconds += perf_counter() - begun

    @contextmanager
    def stepping(self) -> Iterator[None]:
        """Count the wall time of the block as stepping."""
        begun = perf_counter()
        try:
            yield
        finally:
            self.seconds += perf_counter() - begun

    def run(self, outcome: Outcome, reason: str = "", history: History | None = None) -> Run:
        """The run with this outcome and cost."""
        return Run(
            outcome,
            reason,
            history,
            self.seconds,
            self.setup_seconds,
            self.steps,
            self.solver_work,
            self.passes,
            self.details,
        )


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
    """Raise LinkproofError for an empty step."""
    if not 0.0 < step < math.inf:
        raise LinkproofError(f"step: expected a positive finite number of seconds, got {step:g}; correct it")


def whole_steps(duration: float, step: float, least: int) -> int:
    """Number of equal steps of at most ``step`` that make up a duration, ``least`` or more."""
    return max(least, math.ceil(duration / step - ROUNDING))
