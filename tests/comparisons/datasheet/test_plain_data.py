"""A designer's figures as plain data say what the curves do, and nothing where a figure is not finite."""

import json

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import usual_case
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.instants import Instants
from comparisons.datasheet.plain_data import figures, peaks, plain


@pytest.fixture(scope="module")
def results():
    case = usual_case(Mechanism(load("juki-mf7923d")))
    return DesignerResults(case, Instants(case.motion))


def test_a_peak_is_the_value_at_its_place(results):
    found = peaks(results, ["Mkr", "a"])
    for name, peak in found.items():
        time = peak["at"] / results.case.motion.peak_speed
        assert results.curves.values([name], time)[0] == pytest.approx(peak["value"])


def test_figures_are_json_in_si(results):
    found = json.loads(json.dumps(figures(results), allow_nan=False))
    assert found["stroke"] == pytest.approx(max(one["value"] for one in found["output"] if one["signal"] == "S"))
    power = next(one for one in found["drive"] if one["what"] == "peak power")
    assert power["power"] == pytest.approx(power["torque"] * power["speed"])


def test_what_is_not_finite_is_nothing():
    assert plain(np.array([1.0, np.nan, np.inf])) == [1.0, None, None]
