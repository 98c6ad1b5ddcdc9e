"""Cases whose motion the invariants check, and the records of a history."""

import dataclasses
from functools import cache

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import ReleasedRegime, RotaryDamper
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case, case_of_file_regime
from comparisons.invariants.checks import checks
from comparisons.judging.records import blank_record
from comparisons.observed_motion import ObservedMotion
from tests.comparisons.true_motions import EVERYTHING

JUKI = "juki-mf7923d"


@cache
def mechanism(name):
    return Mechanism(load(name))


@cache
def driven(name, regime="run-up-quintic", speed=100.0, start_angle=0.0):
    return Case(mechanism(name), crank_motion(regime, speed=speed, start_angle=start_angle))


@cache
def released(name, turns=5.0, *, speed=100.0, damping=0.0, torque=0.0, start_angle=0.3):
    """Let go at a speed, with one damper on the crank as all the damping there is."""
    linkage = load(name)
    damper = RotaryDamper((linkage.crank, "ground"), damping)
    linkage = dataclasses.replace(linkage, dampers=(damper,) if damping else ())
    own = ReleasedRegime("free", torque, start_angle, speed, turns * 2.0 * np.pi / speed)
    return case_of_file_regime(Mechanism(linkage), own)


def records(one, history):
    found = checks(one, ObservedMotion(one.scene(EVERYTHING), history), blank_record(one, "tuned"))
    return {record.quantity: record for record in found}
