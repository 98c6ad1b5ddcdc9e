"""The contract between the suite and an engine: a scene of rigid bodies goes in, histories or a reason come out.

An adapter receives data only. It never imports the closed forms, never prints, never raises for what a simulation can
do wrong (that is an :class:`Outcome`), and returns the raw motion: every judgement is made by the suite.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from engines.scene import Scene

Array = NDArray[np.float64]


class Setting(StrEnum):
    """How an engine is used."""

    NAIVE = "naive"  # what a newcomer would write, the engine's defaults wherever it has any
    TUNED = "tuned"  # the default: accurate for its price
    BEST = "best"  # the most accurate the adapter can do


class Outcome(StrEnum):
    """How a run ended, as its adapter says; ``comparisons.runs.failures.Failure`` has what else can happen to it."""

    FINISHED = "finished"
    DIVERGED = "diverged"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"


@dataclass(frozen=True)
class Method:
    """One way of stepping that an engine offers for study: each step as asked, nothing tried again or adapted.

    A :class:`Setting` is what a user runs; a method is what its choice is argued from. ``name`` is unique within the
    engine, ``about`` says in one sentence what it is. ``levels`` counts the runs at fractions of the step that are
    extrapolated (1: none). ``effort`` is what the constraint solver is given in every step, in ``effort_unit``
    ("iterations", "relative tolerance"); None leaves the engine's own, and any other may be put in its place with
    ``dataclasses.replace`` where ``effort_unit`` is not empty.
    """

    name: str
    about: str
    levels: int = 1
    effort: float | None = None
    effort_unit: str = ""


@dataclass(frozen=True)
class Signal:
    """Samples over time: ``time`` (n,), s, increasing; ``values`` (n, ...)."""

    time: Array
    values: Array


@dataclass(frozen=True)
class History:
    """The raw motion an engine computed, each channel on its own clock; None where it was not asked for.

    ``position`` values (n, bodies, 3): mass centre x, y, m, and angle, rad, unwrapped; ``velocity`` and
    ``acceleration`` likewise; bodies in the scene's order. ``torque`` values (n,): what the drive exerts on the
    crank, N m. ``joint_force``: one signal (n, 2), N, per joint name, acting on the joint's first body (the pin's
    ``first``, the slider's or slot's ``body``), ground frame. Torque and joint forces may lack a sample at the start
    or at a jump of the prescribed acceleration, where they have two values; kinematics carry the value just after it.
    """

    position: Signal | None = None
    velocity: Signal | None = None
    acceleration: Signal | None = None
    torque: Signal | None = None
    joint_force: Mapping[str, Signal] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    """What came of a run: an outcome with its reason, and the history if it finished.

    ``seconds`` is wall time of the stepping alone, ``setup_seconds`` of building the model; ``steps`` counts
    every time step taken, over all passes of an extrapolation and every trial of a step. ``solver_work`` counts what
    the constraint solver did in them, in the engine's own unit (``Engine.work_unit``); 0 where the engine does not
    tell. ``details`` states the settings actually used.
    """

    outcome: Outcome
    reason: str = ""
    history: History | None = None
    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    solver_work: int = 0
    details: Mapping[str, str | int | float] = field(default_factory=dict)


class Engine(Protocol):
    """One engine behind the contract. Adapters are found through the entry-point group ``linkproof.engines``."""

    name: str
    work_unit: str  # what Run.solver_work counts, in the plural: "Newton iterations"

    def version(self) -> str | None:
        """Version of the installed engine, or None where it is not installed."""
        ...

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Build the scene, step it through its drive and return the motion; never raises for a bad simulation.

        A scene the engine cannot hold is not stepped: the run says UNSUPPORTED with a reason in one sentence.
        """
        ...

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        """The ways of stepping that can be studied on a scene's kind of drive: integrators × levels × solver effort.

        The first is what a newcomer would write, the engine's defaults at a step of the caller's. Nothing is imported.
        """
        ...

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        """Like ``run``, by one method at a longest step of ``step`` seconds; samples come at that step.

        A method without steps (an exact solution at every instant) only samples there. Refuses nothing that ``run``
        would take; says DIVERGED only where no history can be handed back or the engine itself gave up, so that what
        it makes of too long a step can be judged from outside.
        """
        ...
