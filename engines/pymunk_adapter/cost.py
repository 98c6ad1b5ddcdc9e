"""What a run costs: time of stepping and of building, steps, and what pymunk's solver did in them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter

from engines.pymunk_adapter.space import World


@dataclass
class Cost:
    """What a run has taken so far, passes that failed included.

    ``visits`` counts constraint visits: in every iteration of a step the solver goes once through all constraints of
    the space, those that carry a load among them.
    """

    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    visits: int = 0

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

    def count(self, world: World, steps: int) -> None:
        """Note steps that a world took with its present number of iterations."""
        self.steps += steps
        self.visits += steps * world.space.iterations * len(world.space.constraints)
