"""Motions by models as printed: the printed integrator nears the corrected motion as its steps become finer."""

from analytic.description.loading import load
from analytic.description.schema import Erratum
from comparisons.reference.printed_models import printed_motion

DRIVEN = {"name": "", "place": "", "regime": "driven"}


def test_a_finer_published_integrator_converges():
    linkage = load("two-crank-takeup")
    errors = [
        abs(float(printed_motion(linkage, Erratum(**DRIVEN, steps=steps)).speed(1.0)[0]) - final)
        for final in [float(printed_motion(linkage, Erratum(**DRIVEN)).speed(1.0))]
        for steps in (8000, 16000)
    ]
    assert errors[1] < errors[0] / 10.0
