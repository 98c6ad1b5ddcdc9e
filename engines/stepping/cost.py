"""What a run costs: time of stepping and of building, steps, and what the constraint solver did in them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter

from engines.contract import History, Outcome, Run


@dataclass
class Cost:
    """What a run has taken so far, passes that failed included, and the ``details`` settled on the way."""

    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    solver_work: int = 0
    passes: tuple[float, ...] = ()
    details: dict[str, str | int | float] = field(default_factory=dict)

    @contextmanager
    def building(self) -> Iterator[None]:
        """Wall time of what is done inside counts as set-up."""
        begun = perf_counter()
        try:
            yield
        finally:
            self.setup_seconds += perf_counter() - begun

    @contextmanager
    def stepping(self) -> Iterator[None]:
        """Wall time of what is done inside counts as stepping."""
        begun = perf_counter()
        try:
            yield
        finally:
            self.seconds += perf_counter() - begun

    def run(self, outcome: Outcome, reason: str = "", history: History | None = None) -> Run:
        """The run that ended so at this cost."""
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
