"""From a file to a linkage: SI units, joints from shared names, and faults that only meaning shows."""

import math
import re

import pytest

from analytic.description.linkage import GROUND
from analytic.description.loading import parse
from tests.analytic.faults import JUKI, message_of
from tests.analytic.linkages import from_text, mechanism, text_of
from tests.analytic.tolerances import EPS

SLOT = '\n[[slots]]\npoint = "D"\non = "crank"\nthrough = [0, 0]\nalong = [1, 0]\n'

FAULTS = {
    "slot of a link's own pin": (
        SLOT.replace('"D"', '"A"'),
        "slots #1: expected a pin that another body carries, got 'A' of",
    ),
    "slot of no pin": (SLOT.replace('"D"', '"E"'), "slots #1: unknown point 'E'"),
    "slot twice": (SLOT + SLOT, "slots #2: expected one slot for 'D in crank', got a second one; leave it out"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_a_slot(fault):
    added, expected = FAULTS[fault]
    assert expected in message_of(JUKI + added)


def test_shared_names_are_pins():
    linkage = mechanism("three-on-one-pin").linkage
    assert {pin.point: pin.links for pin in linkage.pins} == {
        "A": ("crank", "left_rod", "right_rod"),
        "B": ("link", "right_rod", "rocker"),
        "D": ("left_piston", "left_rod"),
        "E": ("link", "tool"),
        "O": ("crank", "ground"),
        "O2": ("ground", "rocker"),
    }


def test_everything_is_in_si_units():
    linkage = mechanism("spring-and-damper").linkage
    crank = linkage.links["crank"]
    assert (crank.mass, crank.inertia) == pytest.approx((0.31, 41e-6), rel=4 * EPS)
    assert crank.centre == pytest.approx((0.002, -0.001), rel=4 * EPS)
    assert linkage.sketch_angle == pytest.approx(math.radians(30.0), rel=4 * EPS)
    angle = math.radians(75.0)
    assert linkage.links["rocker"].points["B"] == pytest.approx((0.033 * math.cos(angle), 0.033 * math.sin(angle)))
    assert linkage.output.along == pytest.approx((0.6, 0.8), rel=4 * EPS)


def test_a_slider_has_its_point_at_its_origin_unless_it_says_otherwise():
    assert mechanism("juki-mf7923d").linkage.links["needle_bar"].points == {"D": (0.0, 0.0)}
    assert mechanism("carried-slider").linkage.links["slider"].points["D"] == pytest.approx((-0.003, 0.002))


def test_only_what_can_turn_needs_an_inertia():
    text = text_of("carried-slider").replace("inertia = 0.2e-4", "")
    assert "links.slider.inertia is missing" in message_of(text)
    assert mechanism("juki-mf7923d").linkage.links["needle_bar"].inertia is None


def test_a_link_without_a_mass_has_no_inertia_and_a_point_mass_says_so():
    text = text_of("double-crank")
    bare = re.sub(r"(?m)^(mass|centre|inertia) .*\n", "", text)
    assert {(link.mass, link.inertia) for link in from_text(bare).linkage.links.values()} == {(0.0, 0.0)}
    assert from_text(bare).linkage.is_massless
    assert not mechanism("double-crank").linkage.is_massless
    points = from_text(re.sub(r"(?m)^inertia .*$", "inertia = 0", text)).linkage.links
    assert {link.inertia for link in points.values()} == {0.0}
    assert "links.coupler.inertia is missing" in message_of(re.sub(r"(?m)^inertia .*$", "", text))


def test_sliders_that_carry_each_other():
    text = text_of("carried-slider").replace(
        "[links.rocker]", '[links.rocker]\nslides = { point = "O2", on = "slider", through = [0, 0], along = [1, 0] }'
    )
    assert "got a circle of rocker on slider on rocker; let one of them slide on another link" in message_of(text)


def test_the_output_is_taken_along_its_slider_unless_it_says_otherwise():
    output = mechanism("scotch-yoke").linkage.output
    assert (output.link, output.along) == ("yoke", (1.0, 0.0))


def test_an_output_off_any_slider_needs_a_direction():
    text = text_of("near-toggle").replace(", along = [1, 0] }", " }")
    assert "output.along is missing: expected a direction [x, y], since 'B' is on no slider" in message_of(text)


def test_a_direction_of_any_length_will_do():
    text = text_of("scotch-yoke").replace("along = [1, 0] }", "along = [1e200, 0] }")
    slider = parse(text, "sample", "sample.toml").sliders[0]
    assert slider.guide.along == (1.0, 0.0)
    assert slider.guide.host == GROUND


def test_numbers_too_small_to_matter_are_zero():
    text = JUKI.replace("centre  = [0.5, 0]", "centre = [0.5, 1e-200]")
    assert parse(text, "sample", "sample.toml").links["crank"].centre[1] == 0.0
