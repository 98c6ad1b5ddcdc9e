"""How a scene is solved directly: what the settings do, and the methods that can be studied."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from analytic.errors import UnknownNameError
from engines.contract import Method, Setting

LARGEST_GAP = 1e-2  # of the unit of length: joints further apart than this are no joints
NAIVE_STEP = 1e-3  # s


@dataclass(frozen=True)
class Exact:
    """Every sampled instant solved to rounding: floating type and refinements of each, tolerance of a free crank.

    ``spacing`` is the longest between samples, s; None takes as many as show the motion's every turn.
    """

    precision: type[np.floating[Any]]
    refinements: int
    tolerance: float
    spacing: float | None = None


@dataclass(frozen=True)
class RungeKutta:
    """Fixed steps, s, on index 1; stopped where joints are further apart than ``largest_gap`` units of length."""

    step: float
    largest_gap: float = LARGEST_GAP


Recipe: TypeAlias = Exact | RungeKutta

SETTINGS: Mapping[Setting, Recipe] = {
    Setting.NAIVE: RungeKutta(NAIVE_STEP),
    Setting.TUNED: Exact(np.float64, 2, 1e-12),
    Setting.BEST: Exact(np.longdouble, 3, 1e-13),
}
METHODS = (
    Method("defaults", "accelerations and joint forces from one system (index 1), Runge-Kutta 4, no stabilisation"),
    Method("exact", "every instant by Newton's method and one inverted matrix; a free crank by Gauss collocation"),
    Method("exact, extended", "the same in the widest floating type of the machine"),
)


def method_recipe(method: Method, step: float) -> Recipe:
    """What a method does at a longest step or spacing, s; raises UnknownNameError for one that is not here."""
    found: dict[str, Recipe] = {
        "defaults": RungeKutta(step, largest_gap=math.inf),
        "exact": _spaced(Setting.TUNED, step),
        "exact, extended": _spaced(Setting.BEST, step),
    }
    if method.name not in found:
        raise UnknownNameError("method", method.name, found)
    return found[method.name]


def _spaced(setting: Setting, step: float) -> Recipe:
    recipe = SETTINGS[setting]
    assert isinstance(recipe, Exact)
    return replace(recipe, spacing=step)
