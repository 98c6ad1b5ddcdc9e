"""What exudyn is told to do: its rules for a time step, and the recipes that are made of them.

A setting is a recipe that looks for its step until its accuracy is met; a method is one that takes the step it is
given, once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from analytic.errors import UnknownNameError
from engines.contract import Method, Setting
from engines.scene import Free, Scene
from engines.stepping.intervals import Pace

TIGHTER = 1e-2  # absolute tolerance of Newton's method over its relative one, as exudyn has it
RETREAT = 2.0  # the cut of a step that failed, which says nothing of the step that would do
LEAST_CUT, LARGEST_CUT = 1.5, 4.0  # of the step from one attempt to the next
# Turns between fresh starts: what drifts off the joints in these does not show beside the rule's own error. No whole or
# half turn, so that the starts come upon a linkage in ever other positions.
CLOSED_EVERY = 1.7
EFFORT_UNIT = "relative tolerance"
ODD = (1, 3, 5, 7)  # divisions that keep the sign of what alternates from step to step


@dataclass(frozen=True)
class Rule:
    """One of exudyn's rules for a time step, constraints on position (index 3) or velocity level (index 2).

    ``orders`` are the powers of the step in its error. ``damping`` is the spectral radius at infinite frequency of the
    generalised α rule, None for the trapezoidal rule; a rule ``as_shipped`` leaves every setting of exudyn's alone.
    """

    name: str
    orders: tuple[int, ...]
    index: int
    damping: float | None = None
    as_shipped: bool = False


TRAPEZOIDAL = Rule("implicit trapezoidal rule", (2, 4, 6, 8), 2)


def generalised_alpha(damping: float) -> Rule:
    """Generalised α (J. Chung, G. M. Hulbert, ASME Journal of Applied Mechanics 60, 1993).

    exudyn has it on position level only. Its auxiliary accelerations start as the true ones, which leaves the
    multipliers first order for some steps behind every start.
    """
    return Rule(f"generalised α, spectral radius {damping:g}", (2, 3, 4, 5), 3, damping)


AS_SHIPPED = replace(generalised_alpha(0.9), as_shipped=True)


@dataclass(frozen=True, kw_only=True)
class Recipe(Pace):
    """A rule, how fine its basic step is, and the ``divisions`` of that step that are run and extrapolated.

    At least ``levels`` divisions are run, the others if the estimated error of accelerations and torque, relative to
    their peaks, is above ``accuracy``; if that does not do, all is done again with a shorter step, ``attempts`` times
    in all. ``tolerance`` is Newton's relative one; None leaves exudyn's own.
    """

    rule: Rule
    divisions: tuple[int, ...] = (1,)
    tolerance: float | None = None
    levels: int = 1
    accuracy: float = math.inf
    attempts: int = 1

    def details(self) -> dict[str, str | int | float]:
        """The recipe in words, for the record of a run."""
        told: dict[str, str | int | float] = {
            "integrator": self.rule.name,
            "constraints": f"on {'velocity' if self.rule.index == 2 else 'position'} level",
            "newton": "as shipped" if self.rule.as_shipped else "modified, Jacobian updated every step",
        }
        if self.tolerance is not None:
            told["relative_tolerance"] = self.tolerance
            told["absolute_tolerance"] = TIGHTER * self.tolerance
        if math.isfinite(self.turns):
            told["turns_between_starts"] = self.turns
        if self.steps_per_turn:
            told["steps_per_turn"] = round(self.steps_per_turn, 1)
        return told

    def finer(self, error: float) -> Recipe:
        """The recipe with a step that should bring ``error`` down to the accuracy wanted."""
        cut = 1.1 * (error / self.accuracy) ** (0.5 / len(self.divisions)) if math.isfinite(error) else RETREAT
        return replace(self, steps_per_turn=self.steps_per_turn * min(max(cut, LEAST_CUT), LARGEST_CUT))


def _searching(levels: int, steps_per_turn: float, accuracy: float, tolerance: float) -> Recipe:
    return Recipe(
        rule=TRAPEZOIDAL,
        divisions=ODD,
        tolerance=tolerance,
        steps_per_turn=steps_per_turn,
        levels=levels,
        accuracy=accuracy,
        attempts=4,
        turns=CLOSED_EVERY,
        least_steps=100,
    )


NAIVE = Recipe(rule=AS_SHIPPED, step=1e-3)
# From work against precision of the methods below on the catalogue's mechanisms: fourth order is cheapest down to 1e-5
# of the torque's peak, sixth down to 1e-7, eighth below; 50 steps a turn are the fewest whose samples can be read
# between. Smooth linkages stay at fourth order in tuned, sharp ones get the divisions they need.
PRESCRIBED: Mapping[Setting, Recipe] = {
    Setting.NAIVE: NAIVE,
    Setting.TUNED: _searching(2, 50, 1.5e-5, 1e-9),
    Setting.BEST: _searching(4, 50, 1e-7, 1e-12),
}
# A free crank adds up its phase error over all turns, which eighth order pays for even at a few digits.
FREE: Mapping[Setting, Recipe] = {
    Setting.NAIVE: NAIVE,
    Setting.TUNED: _searching(4, 20, 2e-3, 1e-10),
    Setting.BEST: _searching(4, 40, 2e-5, 1e-12),
}


def setting_recipe(scene: Scene, setting: Setting) -> Recipe:
    """What a setting does with a scene."""
    return (FREE if isinstance(scene.drive, Free) else PRESCRIBED)[setting]


def _extrapolated(count: int) -> tuple[str, Recipe]:
    parts = ", 1/".join(map(str, ODD[:count]))
    about = (
        f"the same at 1/{parts} of the step, extrapolated to order {2 * count}, closed again every {CLOSED_EVERY} turns"
    )
    return about, Recipe(rule=TRAPEZOIDAL, divisions=ODD[:count], tolerance=1e-12, levels=count, turns=CLOSED_EVERY)


STUDIED: Mapping[str, tuple[str, Recipe]] = {
    "defaults": ("a rigid body for every link, the drive a Python function, exudyn's settings as shipped", NAIVE),
    "generalised alpha": (
        "generalised α as shipped (index 3, spectral radius 0.9) from consistent accelerations, restarted at jumps",
        Recipe(rule=generalised_alpha(0.9), tolerance=1e-10),
    ),
    "generalised alpha 0.6": (
        "the same with a spectral radius of 0.6, which forgets a start sooner",
        Recipe(rule=generalised_alpha(0.6), tolerance=1e-10),
    ),
    "trapezoidal, index 3": (
        "the implicit trapezoidal rule, constraints on position level: nothing damps the multipliers",
        Recipe(rule=replace(TRAPEZOIDAL, index=3), tolerance=1e-10),
    ),
    "trapezoidal": (
        "the implicit trapezoidal rule, constraints on velocity level, started anew where the acceleration jumps",
        Recipe(rule=TRAPEZOIDAL, tolerance=1e-10),
    ),
    **{f"trapezoidal x{count}": _extrapolated(count) for count in (2, 3, 4)},
}


def studied_methods() -> tuple[Method, ...]:
    """All methods, the same for prescribed and free cranks."""
    return tuple(
        Method(name, about, len(recipe.divisions), recipe.tolerance, EFFORT_UNIT)
        for name, (about, recipe) in STUDIED.items()
    )


def method_recipe(method: Method, step: float) -> Recipe:
    """What a method does at a longest step, s; raises UnknownNameError for a method that is not exudyn's."""
    if method.name not in STUDIED:
        raise UnknownNameError("method", method.name, STUDIED)
    return replace(STUDIED[method.name][1], tolerance=method.effort, step=step)
