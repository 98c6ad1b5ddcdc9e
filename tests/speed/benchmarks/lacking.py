"""Skipping what the measured commit or machine does not have, as asv expects it: NotImplementedError in a set-up."""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import Any


def module(name: str) -> ModuleType:
    """A module of linkproof or of a library, if this commit has it and it is installed."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        raise NotImplementedError(f"this commit has no {error.name}, or it is not installed") from error


def mechanism(name: str) -> Any:
    """A mechanism of the catalogue."""
    linkage = module("analytic.description.loading").load(name)
    return module("analytic.kinematics.mechanism").Mechanism(linkage)
