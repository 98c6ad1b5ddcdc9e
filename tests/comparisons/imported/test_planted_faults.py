"""Every fault of the list, planted in a linkage: it is among the causes that fit, or changes nothing that is judged."""

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.conformance.samples import case
from comparisons.faults.ranking import differs, model_faults
from comparisons.faults.settings import motion_settings
from comparisons.faults.simulation import Simulation
from comparisons.imported.judge import judge
from tests.comparisons.imported.exported import exported

MOTION = crank_motion("run-up-quintic", start_angle=0.4)
TIME = np.linspace(0.0, 0.7, 141)
NAMES = ("Mkr", "shaking_force:x", "shaking_force:y")
SAMPLES = ("four-bar", "slider-crank", "quick return", "force", "torque", "spring", "damper")
PART = 0.03  # of what counts as a change


def planted(fault, simulation):
    """A simulation with a fault, its numbers a little off or the first usual ones."""
    numbers = [n + PART * size for n, size in zip(fault.start, fault.sizes, strict=False)]
    return fault.plant(simulation, *(numbers or (fault.usual[0] if fault.usual else ())))


def misses(linkage, every=1, first=0):
    simulation, missed = Simulation(linkage, MOTION), []
    faults = [*motion_settings(MOTION), *model_faults(simulation)]
    for fault in faults[first::every]:
        results = exported(linkage, MOTION, NAMES, TIME, digits=7, model=planted(fault, simulation))
        judgement = judge(linkage, results, MOTION)
        fits = [fit.fault.name for finding in judgement.explanation.findings for fit in finding.every]
        if fault.name not in fits and any(differs(verdict.evidence) for verdict in judgement.verdicts):
            missed.append((fault.name, fits[:3]))
    return missed


@pytest.mark.nightly
@pytest.mark.parametrize("number", range(len(SAMPLES)), ids=SAMPLES)
def test_a_fault_is_found_where_it_is_planted(number):
    """Every seventh of one linkage, each linkage beginning with another."""
    assert misses(case(SAMPLES[number]).mechanism.linkage, len(SAMPLES), number) == []
