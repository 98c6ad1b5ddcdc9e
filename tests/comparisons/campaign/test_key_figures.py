"""Key figures change with a linkage's file, by a mass of 1e-5, and not with rounding."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load, parse
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.key_figures import changes, compared, key_figures, present_figures
from comparisons.judging.baseline import Baseline, Place
from comparisons.reference.case import Case

LINKAGE = load("juki-mf7923d")


def _case(linkage=LINKAGE) -> Case:
    return Case(Mechanism(linkage), crank_motion("run-up"), conditions="c")


def _heavier(share: float):
    mass = re.search(r"\bmass *= *([\d.]+)", LINKAGE.text)
    assert mass is not None
    text = LINKAGE.text[: mass.start(1)] + f"{float(mass[1]) * (1.0 + share):.12g}" + LINKAGE.text[mass.end(1) :]
    return parse(text, LINKAGE.name, LINKAGE.name, LINKAGE.variant)


def _now():
    return present_figures(compared([_case()], Baseline()))


def _baseline() -> Baseline:
    return Baseline({}, {LINKAGE.name: Place("press.toml", "0")}).recorded([], _now())


def test_the_same_file_has_the_same_figures():
    assert changes([_case()], _baseline()) == []
    assert changes([replace(_case(), conditions="another")], _baseline()) == []


def test_a_mass_changed_by_a_hundred_thousandth_is_seen():
    found = changes([_case(_heavier(1e-5))], _baseline())
    assert {"joint_force:O1.peak", "joint_force:A.peak"} & {one.figure for one in found}
    assert all(re.search(r" was \S+ (N|N m|W|kg m²) and is .* %$", one.sentence) for one in found)


def test_figures_are_the_peaks_of_the_motion():
    found = key_figures(_case())
    fresh = compared([_case()], Baseline())
    assert {one.figure: one.now for one in fresh} == found
    assert not any(one.changed or one.recorded is not None for one in fresh)
    assert found["Peq.peak"] == pytest.approx(found["Mkr.peak"] * 104.72, rel=0.05)  # near full speed
    kinds = {"Mkr", "Peq", "Jeq", "joint_force", "S", "stroke", "v", "a", "transmission_angle", "point", "output"}
    assert {name.partition(":")[0].partition(".")[0] for name in found} == kinds


def test_figures_of_a_centric_slider_crank_are_those_of_its_formulas():
    """S = r sin φ - sqrt(l² - r² cos²φ): a stroke of two cranks, dead centres and speed by an independent search."""
    r, length, omega = 0.0155, 0.0545, 1000.0 * math.pi / 30.0
    found = key_figures(Case(Mechanism(LINKAGE), crank_motion("constant-speed", speed=omega)))
    phi = np.linspace(0.0, 2.0 * math.pi, 2_000_001)
    root = np.sqrt(length**2 - (r * np.cos(phi)) ** 2)
    speed = omega * (r * np.cos(phi) - r**2 * np.cos(phi) * np.sin(phi) / root)
    assert found["stroke"] == found["S.max"] - found["S.min"] == pytest.approx(2.0 * r)
    assert (found["v.max"], found["v.min"]) == pytest.approx((np.max(speed), np.min(speed)), rel=1e-9)
    (least,) = (value for name, value in found.items() if name.startswith("transmission_angle"))
    assert least == pytest.approx(math.acos(r / length))
    assert (found["point:A:x@0s"], found["point:D:y@0s"]) == pytest.approx((r, -math.sqrt(length**2 - r**2)))
    assert (found["output:direction:x"], found["output:direction:y"]) == (0.0, 1.0)


def test_a_figure_that_is_lost_or_new_has_a_sentence():
    key = next(iter(_now()))
    baseline = _baseline().recorded([], {key: {"Mkr.peak": key_figures(_case())["Mkr.peak"], "old": 1.0}})
    sentences = {one.figure: one.sentence for one in changes([_case()], baseline)}
    assert "is no figure any more" in sentences.pop("old")
    assert all("was not recorded" in words for words in sentences.values())


def test_rounding_of_a_figure_that_is_zero_is_no_change():
    """A force that is zero but for rounding differs between machines by more than a millionth of itself."""
    recorded = {**key_figures(_case()), "Jeq.mean": key_figures(_case())["Jeq.mean"] + 1e-15}
    baseline = _baseline().recorded([], {next(iter(_now())): recorded})
    assert changes([_case()], baseline) == []
