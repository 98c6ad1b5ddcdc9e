"""Torque and joint forces of a linkage file beside a solution in absolute coordinates that shares nothing with them."""

import tomllib

import numpy as np

from analytic.description.loading import parse
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import evaluate
from tests.nightly.judging.multibody import Multibody


def largest_error(text, places, speed):
    """The largest deviation of torque and joint forces at crank angles, rad, over their peaks.

    A guide's joint force with friction is that across it, as multipliers of its line are.
    """
    motion = places, np.full(len(places), speed), np.zeros(len(places))
    control = Multibody(tomllib.loads(text)).curves(np.zeros(0), lambda _: motion)
    names = [name for name in control if name == "Mkr" or name.startswith("joint_force")]
    found = evaluate(Mechanism(parse(text, "drawn", "drawn")), places, names, speed=speed)
    peak = max(np.max(np.abs(control[name])) for name in names if name != "Mkr")
    peaks = {name: np.max(np.abs(control[name])) if name == "Mkr" else peak for name in names}
    return max(np.max(np.abs(found[name] - control[name])) / peaks[name] for name in names)
