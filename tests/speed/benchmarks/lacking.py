"""Skipping what the commit at hand does not have yet, as asv wants it: NotImplementedError from a set-up."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any

# Where modules stood in version 0.1.0, so that it can be compared with what came after.
BEFORE = {
    "analytic.description.crank_motion": "analytic.regimes",
    "analytic.description.loading": "analytic.loading",
    "analytic.kinematics.mechanism": "analytic.mechanism",
    "analytic.motion.released": "analytic.free_motion",
    "comparisons.invariants.checks": "comparisons.checks",
    "comparisons.judging.records": "comparisons.records",
    "comparisons.judging.deviations": "comparisons.deviations",
    "comparisons.judging.quantities": "comparisons.quantities",
    "comparisons.observation.observed_motion": "comparisons.motion",
    "comparisons.reference.case": "comparisons.case",
    "engines.scene": "engines.contract",
    "reports.command_line.main": "reports.command",
}


def module(name: str) -> ModuleType:
    """A module of linkproof, if this commit has it and what it needs is installed."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if name in BEFORE:
            return module(BEFORE[name])
        raise NotImplementedError(f"this commit has no {error.name}") from error


def check_parameter(function: Callable[..., Any], name: str) -> None:
    """Skip if a function does not take a parameter of a name yet."""
    if name not in inspect.signature(function).parameters:
        raise NotImplementedError(f"{function.__name__} does not take {name} yet")
