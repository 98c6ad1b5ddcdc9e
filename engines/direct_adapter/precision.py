"""How finely a scene is solved: what the settings do, and the methods that can be studied."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic.errors import UnknownNameError
from engines.contract import Method, Setting


@dataclass(frozen=True)
class Precision:
    """Every sampled instant solved to rounding: floating type and refinements of each, tolerance of a free crank.

    ``spacing`` is the longest between samples, s; None takes as many as show the motion's every turn.
    """

    dtype: type[np.floating[Any]]
    refinements: int
    tolerance: float
    spacing: float | None = None


DOUBLE, EXTENDED = Precision(np.float64, 2, 1e-12), Precision(np.longdouble, 3, 1e-13)
# A control of the reference has no defaults of its own to be naive with.
SETTINGS: Mapping[Setting, Precision] = {Setting.NAIVE: DOUBLE, Setting.TUNED: DOUBLE, Setting.BEST: EXTENDED}
METHODS = (
    Method("exact", "every instant by Newton's method and one inverted matrix; a free crank by Gauss collocation"),
    Method("exact, extended", "the same in the widest floating type of the machine"),
)


def method_precision(method: Method, spacing: float) -> Precision:
    """What a method does at a longest spacing, s; raises UnknownNameError for one that is not here."""
    precisions = dict(zip((method.name for method in METHODS), (DOUBLE, EXTENDED), strict=True))
    if method.name not in precisions:
        raise UnknownNameError("method", method.name, precisions)
    return replace(precisions[method.name], spacing=spacing)
