"""Curves of an engine's run by the names of signals, as they are exported; the linkage may have a fault planted."""

import numpy as np

from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.quantities import QUANTITIES, all_quantities
from comparisons.observation.interpolation import resample
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.runs.run_engine import run_engine
from engines.contract import Outcome, Setting, Signal
from engines.registry import engine
from engines.scene import Channel


def curves(linkage, motion, name="direct", every=1):
    """Time (n,) and every signal (n,) that an engine's run has by name, SI, on the clock of its torque."""
    case = Case(Mechanism(linkage), motion)
    scene = case.scene(frozenset(Channel))
    run = run_engine(engine(name), scene, Setting.TUNED)
    assert run.outcome is Outcome.FINISHED, run.reason
    observed = ObservedMotion(scene, run.history)
    crank = {name: QUANTITIES[name] for name in ("phi", "omega", "epsilon")}
    found = {}
    for quantity in {**crank, **all_quantities(case)}.values():
        signal = quantity.observed(case, observed)
        parts = (
            {"": signal.values} if signal.values.ndim == 1 else {":x": signal.values[:, 0], ":y": signal.values[:, 1]}
        )
        found |= {quantity.name + part: Signal(signal.time, values) for part, values in parts.items()}
    time = found["Mkr"].time[::every]
    return time, {name: _at(signal, time) for name, signal in found.items()}


def _at(signal, time):
    """Values at the samples themselves, or between them where an engine has another clock for each channel."""
    places = np.clip(np.searchsorted(signal.time, time), 0, len(signal.time) - 1)
    if np.array_equal(signal.time[places], time):
        return signal.values[places]
    return resample(signal, time)
