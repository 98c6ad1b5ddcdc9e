"""The thread's contour and feed against the articles' formulas in 50 digits, and files of required feed."""

import itertools
import math

import numpy as np
import pytest
from analytic.description.thread_path import ThreadEye, ThreadGuide, ThreadPath
from mpmath import mp, mpf

from analytic.description.schema import EyeReference
from analytic.errors import LinkproofError, UnknownNameError
from analytic.motion.thread_feed import (
    RequiredFeed,
    compare_feed,
    contour_length,
    eye_travel,
    feed,
    feed_diagram,
    read_required_feed,
    reference_angle,
)
from tests.analytic.articles import FORMULAS
from tests.analytic.linkages import angles, from_text, mechanism
from tests.analytic.textbook import ROTOR

MM = 1e-3
# Of the contour's length: a few roundings of its stretches.
LENGTH = 1e-14
# rad. Newton's last step on the exact derivative of the eye's height.
TURNING = 1e-12
# mm, half a digit of the specification's 261.7-352.3 and 90.6.
PRINTED = 0.05

FORK = ThreadPath(
    stops=(
        ThreadGuide("N1", (-30 * MM, -20 * MM, 10 * MM)),
        ThreadEye("P6", 4 * MM),
        ThreadEye("P5"),
        ThreadEye("P6", -4 * MM),
        ThreadGuide("N2", (-30 * MM, -40 * MM, -10 * MM)),
    ),
    stretch=6 * MM,
    feed="lengthening",
    reference=0.4,
)
SLOTTED = ThreadPath(
    stops=(ThreadGuide("NN1", (30 * MM, 90 * MM, 0.0)), ThreadEye("P7"), ThreadGuide("NN2", (30 * MM, -60 * MM, 0.0))),
    stretch=6 * MM,
    feed="shortening",
    reference=EyeReference(eye="P7", extreme="lowest"),
)
TAKEUPS = [("fork-takeup", "representative", FORK), ("slotted-takeup", "corrected", SLOTTED)]
TAKEUPS += [("slotted-takeup", "inverted", SLOTTED)]


def _exact_length(name, variant, path, phi):
    """L(φ), mm: articles 002, eqs (19)-(21), and 004, eqs (15)-(17)."""
    points = FORMULAS[name, variant](phi).points

    def corner(stop):
        if isinstance(stop, ThreadEye):
            return points[stop.point].real, points[stop.point].imag, mpf(round(stop.z / MM))
        return tuple(mpf(round(part / MM)) for part in stop.position)

    corners = [corner(stop) for stop in path.stops]
    return sum(
        mp.sqrt(sum((b - a) ** 2 for a, b in zip(one, two, strict=True))) for one, two in itertools.pairwise(corners)
    )


@pytest.mark.parametrize(("name", "variant", "path"), TAKEUPS)
def test_the_contour_agrees_with_fifty_digits(name, variant, path):
    sample = mechanism(name, variant)
    phi = angles(8)
    sweep = sample.sweep(phi)
    with mp.workdps(50):
        truth = [_exact_length(name, variant, path, mpf(float(angle))) for angle in phi]
    assert contour_length(sweep, path) / MM == pytest.approx([float(length) for length in truth], rel=LENGTH)


def test_fork_takeup_as_specified():
    diagram = feed_diagram(mechanism("fork-takeup"), FORK)
    assert diagram.length_extremes.minimum / MM == pytest.approx(261.7, abs=PRINTED)
    assert diagram.length_extremes.maximum / MM == pytest.approx(352.3, abs=PRINTED)
    assert diagram.total_feed / MM == pytest.approx(90.6, abs=PRINTED)
    assert diagram.angle.shape == diagram.length.shape == diagram.feed.shape
    assert np.ptp(diagram.feed) <= diagram.total_feed


@pytest.mark.parametrize("variant", ["corrected", "inverted"])
def test_the_eye_turns_round_where_the_article_says(variant):
    formula, travel = FORMULAS["slotted-takeup", variant], eye_travel(mechanism("slotted-takeup", variant), "P7")
    with mp.workdps(50):
        tiny = mpf(10) ** -15
        for angle, height, upper in (
            (travel.top_angle, travel.top, True),
            (travel.bottom_angle, travel.bottom, False),
        ):
            before, here, after = (formula(mpf(angle) + k * tiny).points["P7"].imag for k in (-1, 0, 1))
            bend = (before - 2 * here + after) / tiny**2
            assert abs((after - before) / (2 * tiny) / bend) < TURNING
            assert (bend < 0) == upper
            assert height == pytest.approx(float(here) * MM)
    everywhere = mechanism("slotted-takeup", variant).turn.point("P7")[1]
    assert travel.top >= np.max(everywhere)
    assert travel.bottom <= np.min(everywhere)


def test_feed_of_the_slotted_takeup_as_article_004_writes_it():
    sample, phi = mechanism("slotted-takeup"), angles(20)
    travel = eye_travel(sample, "P7")

    def length(angle):
        return contour_length(sample.sweep(angle), SLOTTED)

    def d(angle):
        return length(angle) - length(travel.top_angle)

    assert feed(sample, SLOTTED, phi) == pytest.approx(-d(phi) + d(travel.bottom_angle) + 6 * MM, abs=LENGTH)
    assert float(feed(sample, SLOTTED, travel.bottom_angle)) == pytest.approx(6 * MM, abs=LENGTH)
    highest = ThreadPath(SLOTTED.stops, SLOTTED.stretch, SLOTTED.feed, EyeReference(eye="P7", extreme="highest"))
    assert reference_angle(sample, highest) == travel.top_angle


def test_an_eye_that_does_not_move_or_does_not_exist_is_refused():
    with pytest.raises(LinkproofError, match="expected an eye that moves up and down, got 'O'"):
        eye_travel(from_text(ROTOR), "O")
    with pytest.raises(UnknownNameError, match="did you mean 'P7'"):
        eye_travel(mechanism("slotted-takeup"), "p7")


TABLE = "0,0.5\n90,12.25\n180,-3\n"


@pytest.mark.parametrize(
    "text",
    [
        TABLE,
        "# from the data sheet\n\nfeed_mm,phi_deg\n0.5,0\n12.25,90\n-3,180\n",
        '"phi_deg";"feed_mm"\n0;0,5\n90;12,25\n180;-3\n',
        "\ufeffPhi_deg, Feed_mm\n0, 0.5\n90, 12.25\n180, -3",
    ],
)
def test_a_required_curve_is_read_however_it_is_written(tmp_path, text):
    file = tmp_path / "required.csv"
    file.write_bytes(text.encode())
    read = read_required_feed(file)
    assert read.angle == pytest.approx([0.0, 0.5 * math.pi, math.pi])
    assert read.feed == pytest.approx([0.5 * MM, 12.25 * MM, -3 * MM])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "two columns, phi_deg and feed_mm, with a row"),
        (b"phi_deg,feed_mm\n", "with a row for each crank angle, got none"),
        (b"0,1\n90,2,3\n", "line 2: expected two columns"),
        (b"0,1\n\n90,nan\n", "line 3: .* got '90,nan'"),
        (b"angle,mm\n0,1\n", "line 1: expected two columns, phi_deg and feed_mm, got 'angle,mm'"),
        (b"\xff\xfe0", "UTF-8"),
    ],
)
def test_a_bad_required_curve_is_refused_with_its_line(tmp_path, content, words):
    file = tmp_path / "required.csv"
    file.write_bytes(content)
    with pytest.raises(LinkproofError, match=words) as caught:
        read_required_feed(file)
    assert "\n" not in str(caught.value)
    with pytest.raises(LinkproofError, match="expected a readable CSV file"):
        read_required_feed(tmp_path / "nothing.csv")


def test_required_against_actual():
    sample = mechanism("slotted-takeup")
    required = RequiredFeed(np.array([2.0, 1.0]), np.array([10 * MM, -5 * MM]))
    result = compare_feed(sample, SLOTTED, required)
    assert result.actual == pytest.approx(feed(sample, SLOTTED, required.angle))
    assert result.difference == pytest.approx(result.actual - required.feed)
    assert result.angle is required.angle


def test_a_crank_that_cannot_turn_fully_has_no_turn_to_tell_a_feed_by():
    watt = mechanism("watt-six-bar")
    with pytest.raises(LinkproofError, match="the extreme height of eye 'E' of 'watt-six-bar' needs a full turn"):
        eye_travel(watt, "E")
    path = ThreadPath((ThreadGuide("N", (0.0, 0.0, 0.0)), ThreadEye("E")), 0.0, "lengthening", 0.0)
    with pytest.raises(LinkproofError, match="the contour of 'watt-six-bar' needs a full turn"):
        feed_diagram(watt, path)
    assert np.all(np.isfinite(feed(watt, path, np.array([-0.05, 0.05]))))
