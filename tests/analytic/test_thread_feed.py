"""The thread's contour and feed against the articles' formulas in 50 digits, and as a signal."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf

from analytic.description.changes import with_numbers
from analytic.description.linkage import ThreadEye, ThreadGuide, ThreadPath
from analytic.description.schema import EyeReference
from analytic.designs.sampled_signals import evaluate_designs
from analytic.errors import LinkproofError, UnknownNameError
from analytic.numerics.refine import extremes
from analytic.signals import contour_length, evaluate, feed, reference_angle
from tests.analytic.articles import FORMULAS
from tests.analytic.linkages import ROTOR, angles, from_text, mechanism

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
    fork = mechanism("fork-takeup")
    length = extremes(lambda phi: contour_length(fork.sweep(phi), FORK))
    assert length.minimum / MM == pytest.approx(261.7, abs=PRINTED)
    assert length.maximum / MM == pytest.approx(352.3, abs=PRINTED)
    assert (length.maximum - length.minimum) / MM == pytest.approx(90.6, abs=PRINTED)


def _counted_from(extreme, eye="P7"):
    return replace(SLOTTED, reference=EyeReference(eye=eye, extreme=extreme))


@pytest.mark.parametrize("variant", ["corrected", "inverted"])
def test_the_eye_turns_round_where_the_article_says(variant):
    formula, sample = FORMULAS["slotted-takeup", variant], mechanism("slotted-takeup", variant)
    heights = {}
    with mp.workdps(50):
        tiny = mpf(10) ** -15
        for extreme in ("highest", "lowest"):
            angle = reference_angle(sample, _counted_from(extreme))
            before, here, after = (formula(mpf(angle) + k * tiny).points["P7"].imag for k in (-1, 0, 1))
            bend = (before - 2 * here + after) / tiny**2
            assert abs((after - before) / (2 * tiny) / bend) < TURNING
            assert (bend < 0) == (extreme == "highest")
            heights[extreme] = float(here) * MM
    everywhere = sample.turn.point("P7")[1]
    assert heights["highest"] >= np.max(everywhere)
    assert heights["lowest"] <= np.min(everywhere)


def test_feed_of_the_slotted_takeup_as_article_004_writes_it():
    sample, phi = mechanism("slotted-takeup"), angles(20)
    top, bottom = (reference_angle(sample, _counted_from(extreme)) for extreme in ("highest", "lowest"))

    def length(angle):
        return contour_length(sample.sweep(angle), SLOTTED)

    def d(angle):
        return length(angle) - length(top)

    assert feed(sample, SLOTTED, phi) == pytest.approx(-d(phi) + d(bottom) + 6 * MM, abs=LENGTH)
    assert float(feed(sample, SLOTTED, bottom)) == pytest.approx(6 * MM, abs=LENGTH)


def test_an_eye_that_does_not_move_or_does_not_exist_is_refused():
    with pytest.raises(LinkproofError, match="expected an eye that moves up and down, got 'O'"):
        reference_angle(from_text(ROTOR), _counted_from("highest", "O"))
    with pytest.raises(UnknownNameError, match="did you mean 'P7'"):
        reference_angle(mechanism("slotted-takeup"), _counted_from("highest", "p7"))


def test_the_signal_is_the_feed_of_the_file_and_designs_have_their_own():
    sample, phi = mechanism("slotted-takeup"), angles(20)
    path = sample.linkage.thread
    assert evaluate(sample, phi, ["thread_feed"])["thread_feed"] == pytest.approx(feed(sample, path, phi), abs=LENGTH)
    longer = with_numbers(sample.linkage, {"rocker.P7.x": 0.057})
    values = evaluate_designs(sample, {"rocker.P7.x": [0.055, 0.057]}, phi, ["thread_feed", "thread_length"])
    for row, design in enumerate((sample, sample.redesigned(longer))):
        assert values["thread_feed"][row] == pytest.approx(feed(design, path, phi), abs=LENGTH)
        assert values["thread_length"][row] == pytest.approx(contour_length(design.sweep(phi), path), abs=LENGTH)


def test_a_crank_that_cannot_turn_fully_has_no_turn_to_tell_a_feed_by():
    watt = mechanism("watt-six-bar")
    with pytest.raises(LinkproofError, match="the extreme height of eye 'E' of 'watt-six-bar' needs a full turn"):
        reference_angle(watt, _counted_from("highest", "E"))
    path = ThreadPath((ThreadGuide("N", (0.0, 0.0, 0.0)), ThreadEye("E")), 0.0, "lengthening", 0.0)
    assert np.all(np.isfinite(feed(watt, path, np.array([-0.05, 0.05]))))
