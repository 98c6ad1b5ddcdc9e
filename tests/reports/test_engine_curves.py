"""Curves of every engine in a file: ``judge`` finds them as right or wrong as ``compare`` does, and says by what."""

import pytest

from analytic.description.crank_motion import RPM, crank_motion
from comparisons.filejudge.judge import judge
from comparisons.motion.case import Case
from comparisons.trials.judging.limits import limit
from comparisons.trials.judging.quantities import chosen_quantities, deviation
from comparisons.trials.judging.records import NAMES, Error
from comparisons.trials.observed_motion import ObservedMotion
from engines.contract import Setting
from reports.imported import sentences
from tests.analytic.linkages import mechanism
from tests.comparisons.filejudge.layouts import results_of
from tests.engines.closed_form import driven, history_of, installed

MECHANISM = mechanism("juki-mf7923d")
MOTION = crank_motion("run-up-quintic", speed=1000.0 * RPM, ramp_time=0.12, hold_time=0.06)
BY_NIGHT = ("direct", "dart", "drake", "exudyn", "mujoco", "ondsel", "pinocchio", "pybullet", "simbody")


@pytest.mark.parametrize("name", ["pymunk", *(pytest.param(name, marks=pytest.mark.nightly) for name in BY_NIGHT)])
@pytest.mark.parametrize("setting", [Setting.NAIVE, Setting.TUNED])
def test_curves_of_an_engine_are_right_or_wrong_by_its_step_or_softness(name, setting):
    model = driven(MECHANISM, MOTION)
    motion = ObservedMotion(model, history_of(installed(name), model, setting))
    for quantity in chosen_quantities(Case(MECHANISM, MOTION), ("Mkr", "S", "v", "a")):
        case = Case(MECHANISM, MOTION)
        found, curve = deviation(case, quantity, motion, Error(*NAMES))[0], quantity.observed(case, motion)
        allowed = limit(quantity.name, setting, MOTION.regime, name).value
        results = results_of({quantity.name: curve.values}, curve.time, digits=9)
        words = " ".join(sentences(judge(MECHANISM.linkage, results, MOTION, limit=allowed)))
        if found.error_max > 2.0 * allowed:
            assert words.startswith("Not right")
            assert "the step or the softness of the engine" in words
        elif found.error_max < allowed:
            assert words.startswith("Right")
