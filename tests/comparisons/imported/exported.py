"""Curves as another tool would export them, with a fault planted: made from the closed form and rounded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from comparisons.faults.fault import Simulation
from comparisons.imported.columns import Column, ImportedResults, ImportedSignal
from comparisons.imported.judge import Samples


def samples(name, time):
    """A place for a signal's values."""
    nothing = np.zeros(len(time))
    return Samples(name, time, nothing, nothing, nothing, None)


def rounded(values, digits):
    """Values to so many significant digits, and half a unit of the last one of each."""
    texts = [f"{value:.{digits - 1}e}" for value in values]
    exponents = np.array([int(text.partition("e")[2]) for text in texts])
    return np.array([float(text) for text in texts]), 0.5 * 10.0 ** (exponents - digits + 1)


def exported(linkage, motion, names, time, *, digits=6, change=None, model=None):
    """Imported results of a model, the true one by default; ``change`` alters values by name."""
    model = model or Simulation(linkage, motion)
    values = dict(zip(names, model.predict([samples(name, time) for name in names]), strict=True))
    return results_of(change(values, time) if change else values, time, digits=digits)


def results_of(values, time, *, digits=6):
    """Values (n,) by the names of their signals, rounded as a file has them."""
    signals = []
    for name in values:
        printed, half = rounded(values[name], digits)
        at, at_half = rounded(time, 10)
        column = Column(name, "", printed, half, "made up")
        signals.append(ImportedSignal(name, "time", at, printed, half, column, at_half))
    return ImportedResults(tuple(signals), (), {}, "")


def with_link(linkage, name, **changes):
    """A linkage with a link changed."""
    link = replace(linkage.links[name], **changes)
    return replace(linkage, links={**linkage.links, name: link})
