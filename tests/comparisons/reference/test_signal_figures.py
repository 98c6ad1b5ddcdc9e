"""Figures of signals: their names, and the literature's printed figures."""

import math

import numpy as np
import pytest

from analytic.description.loading import literature, load
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.published import all_variants, compare_published, figure
from comparisons.reference.signal_figures import signal_figure
from tests.analytic.linkages import from_text, mechanism

# A crank of 30 mm and a rod of 100 mm, the guide through the crank's pivot.
SLIDER_CRANK = """
title = "slider-crank"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
output = { point = "B", along = [1, 0] }
[ground]
O = [0, 0]
[links.crank]
points = { O = [0, 0], A = [30, 0] }
[links.rod]
points = { A = [0, 0], B = [100, 0] }
[links.block]
slides = { point = "B", through = [0, 0], along = [1, 0] }
[sketch]
points = { B = [130, 0] }
"""


@pytest.mark.parametrize("name", literature())
def test_the_printed_figures_of_the_literature_are_reproduced(name):
    records = compare_published(all_variants(name))
    assert records
    assert [r for r in records if r.verdict != "reproduced"] == []


@pytest.mark.parametrize(
    ("quantity", "speed", "unit", "expected"),
    [
        ("point:B:x@90", 1.0, "m", math.sqrt(0.1**2 - 0.03**2)),
        ("point:B:x@1.5707963267948966rad", 1.0, "m", math.sqrt(0.1**2 - 0.03**2)),
        ("point:B:vx@90", 2.0, "m/s", -0.06),
        ("point:B:vx@90", -2.0, "m/s", 0.06),
        ("point:A:ax@0", 2.0, "m/s²", -0.12),
        ("link:rod:angle@90", 1.0, "rad", -math.asin(0.3)),
        ("link:rod:angle - phi@90", 1.0, "rad", -math.asin(0.3) - math.pi / 2),
        ("link:rod:angle.max", 1.0, "rad", math.asin(0.3)),
        ("point:B:x.min", 1.0, "m", 0.07),
        ("point:B:x.range", 1.0, "m", 0.06),
        ("link:rod:omega.max", 10.0, "rad/s", 3.0),
        ("link:rod:omega.max", -10.0, "rad/s", 3.0),
    ],
)
def test_values_of_a_slider_crank_are_those_of_its_triangle(quantity, speed, unit, expected):
    told, value = signal_figure(from_text(SLIDER_CRANK), quantity, speed)
    assert told == unit
    assert value == pytest.approx(expected, rel=1e-14, abs=1e-15)


def test_a_value_at_a_time_is_that_of_the_regime():
    released = mechanism("andrews-squeezer")
    start = released.linkage.regimes[0].start_angle
    assert signal_figure(released, "phi@0s:squeezing", 1.0)[1] == pytest.approx(start, rel=1e-14)
    assert signal_figure(released, "omega@0s:squeezing", 1.0)[1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("quantity", "error", "message"),
    [
        ("point:B:x@noon", LinkproofError, "expected a crank angle or a time with its regime after '@', got 'noon'"),
        ("point:B:x@3s", LinkproofError, "write 30, 0.5rad or 0.03s:REGIME"),
        ("point:B:x@-", LinkproofError, "got '-'"),
        ("point:B:x@1s:driven", UnknownNameError, "unknown regime of 'sample' 'driven'"),
        ("point:C:x@30", UnknownNameError, "unknown signal 'point:C:x'"),
        ("point:C:x.max", LinkproofError, "unknown figure 'point:C:x.max': did you mean '"),
        ("range.low", LinkproofError, "its crank turns fully"),
    ],
)
def test_what_cannot_be_told_is_refused_in_a_sentence(quantity, error, message):
    with pytest.raises(error, match=message):
        figure(from_text(SLIDER_CRANK), quantity)


def test_a_name_of_several_figures_is_refused():
    with pytest.raises(LinkproofError, match=r"expected one figure, got 'joint_force\.peak', which is several"):
        figure(mechanism("rimoldi-164"), "joint_force.peak")


def test_figures_of_the_output_and_of_the_range():
    assert figure(from_text(SLIDER_CRANK), "stroke") == ("m", pytest.approx(0.06))
    assert figure(from_text(SLIDER_CRANK), "time_ratio") == ("", pytest.approx(1.0))
    unit, ratio = figure(Mechanism(load("whitworth-quick-return")), "time_ratio")
    half = math.acos(100 / 150)
    assert (unit, ratio) == ("", pytest.approx((math.pi - half) / half, rel=1e-12))
    low, high = (figure(Mechanism(load("watt-six-bar")), f"range.{end}")[1] for end in ("low", "high"))
    assert -math.radians(6) < low < 0.0 < high < math.radians(6)


def test_a_printed_unit_is_that_of_both_figures():
    (record,) = (r for r in compare_published([load("jansen-leg")]) if r.quantity == "point:F:x.range")
    assert (record.unit, record.published) == ("mm", 68)
    assert record.ours == pytest.approx(67.9, abs=0.05)
    assert np.isclose(record.deviation, record.ours / 68 - 1)


def test_a_printed_zero_has_no_relative_deviation():
    text = SLIDER_CRANK.replace(
        'crank = "crank"',
        'crank = "crank"\npublished = [{ quantity = "point:B:vx@0", value = 0, half_digit = 1e-3, place = "" }]',
    )
    (record,) = compare_published([from_text(text).linkage])
    assert (record.deviation, record.verdict) == (None, "reproduced")
