"""Signals of many designs: those of linkages built one by one, and nan where a design cannot be built or moved."""

import numpy as np
import pytest

from analytic import machine_code
from analytic.designs.sampled_signals import ASSEMBLED, evaluate_designs
from analytic.errors import LinkproofError
from analytic.signals import table
from tests.analytic.designs.one_by_one import built, signals_of, varied
from tests.analytic.linkages import ODD, four_bar, from_text, mechanism, on_trial, text_of

# Two orders of the same operations; relative to the peak.
SAME = 1e-14
TINY = 1e-300
needs_numba = pytest.mark.skipif(not machine_code.is_installed(), reason="numba is not installed")


def every_signal(sample):
    """All signals but S and angles of links, which count from a place that depends on the samples."""
    return [name for name in table(sample) if name != "S" and not name.endswith(":angle")]


@pytest.mark.parametrize("name", ["rimoldi-164", *ODD])
def test_every_number_may_vary(name):
    """Against linkages built one by one, whose formulas get plain numbers."""
    sample = on_trial(name, None, True)
    angle = np.random.default_rng(4).uniform(-7.0, 7.0, 30)
    parameters, names = varied(sample, 5, 6, 0.04), every_signal(sample)
    values = evaluate_designs(sample, parameters, angle, names, speed=4.0, acceleration=np.cos(angle), path="numpy")
    assert np.any(values[ASSEMBLED])
    for number in range(6):
        design, moving = built(sample, parameters, number), values[ASSEMBLED][number]
        expected = signals_of(sample, design, angle[moving], names, (4.0, np.cos(angle[moving]))) if any(moving) else {}
        for signal, row in expected.items():
            assert np.all(np.isnan(values[signal][number, ~moving]))
            close = {"rtol": 0.0, "atol": SAME * np.max(np.abs(row)) + TINY}
            np.testing.assert_allclose(values[signal][number, moving], row, **close, err_msg=signal)


@needs_numba
@pytest.mark.parametrize(
    ("name", "some"),
    [
        ("rimoldi-164", ("rod.B.x", "crank.mass", "needle_bar.along.x")),
        pytest.param("rimoldi-164", (), marks=pytest.mark.nightly),
        pytest.param("carriage-and-crossed-blocks", (), marks=pytest.mark.nightly),
        pytest.param("pin-in-two-slots", (), marks=pytest.mark.nightly),
    ],
)
def test_machine_code_gives_what_numpy_gives(name, some):
    sample, angle = on_trial(name, None, True), np.random.default_rng(6).uniform(-7.0, 7.0, 40)
    parameters = varied(sample, 7, 12, 0.3)
    parameters = {number: parameters[number] for number in some or parameters}
    names = [signal for signal in every_signal(sample) if not some or signal == "Mkr" or "shaking" in signal]
    motion = {"speed": 4.0, "acceleration": np.cos(angle)}
    values, expected = (
        evaluate_designs(sample, parameters, angle, names, **motion, path=path) for path in ("compiled", "numpy")
    )
    assert np.array_equal(values[ASSEMBLED], expected[ASSEMBLED])
    assert 0 < np.count_nonzero(values[ASSEMBLED]) < values[ASSEMBLED].size
    for signal in names:
        scale = np.nanmax(np.abs(expected[signal]), axis=-1, keepdims=True, initial=0.0)
        assert np.array_equal(np.isnan(values[signal]), np.isnan(expected[signal]))
        assert np.nanmax(np.abs(values[signal] - expected[signal]) - SAME * scale) <= 0.0, signal


def _coinciding_pins():
    """RRR with equal arms whose outer pins meet at 0°, and arms of different length that then cannot meet."""
    sample = from_text('output = { point = "C", along = [1, 0] }\n' + four_bar(0.06, 0.02, 0.05, 0.05, 1.0))
    same = {"ground.B.x": [0.02, 0.02], "crank.A.x": [0.02, 0.02], "rocker.C.x": [0.05, 0.049]}
    return sample, same, [0.0, 0.3], [[False, True], [False, True]]


def _rpr(place, through):
    """The crank pin passes the rocker's pivot at a place, m; the slot goes through a point beside the pivot, m."""
    sample = mechanism("slot-without-mass")
    pivot, count = sample.linkage.links["rocker"].points["O2"], len(through)
    numbers = {"ground.O2.x": [place[0]] * count, "ground.O2.y": [place[1]] * count}
    numbers |= {"A in rocker.through.x": [pivot[0]] * count, "A in rocker.through.y": [pivot[1] + y for y in through]}
    return sample, numbers | {"A in rocker.along.x": [1.0] * count, "A in rocker.along.y": [0.0] * count}


def _pin_on_pivot():
    """RPR: a slot through the rocker's pivot, which the crank pin passes over at 30°; then a slot beside it."""
    crank = mechanism("slot-without-mass").linkage.links["crank"].points["A"][0]
    places = _rpr((crank * np.cos(np.pi / 6), crank * np.sin(np.pi / 6)), [0.0, 0.004])
    return *places, [np.pi / 6, np.pi / 6 + 0.1, 2.0], [[False, True, True], [False, False, True]]


def _almost_at_the_foot():
    """RPR: the crank pin a hair farther from the rocker's pivot than the slot is offset from it."""
    crank = mechanism("slot-without-mass").linkage.links["crank"].points["A"][0]
    return *_rpr((crank, -0.004), [0.004]), [1e-14, 0.1], [[False, True]]


def _arm_too_short():
    """RRP: a rod shorter than the slider's line is far away at 90°."""
    rods = {"rod.D.x": [0.04, 0.06]}
    return mechanism("centric-slider-crank"), rods, [0.1, np.pi / 2], [[True, False], [True, True]]


def _almost_square():
    """RRP: a rod as long as the crank, square to the slider's line but for 30 nanoradians."""
    places = [np.pi / 2 - 3e-8, np.pi / 2 - 1e-3]
    return mechanism("centric-slider-crank"), {"rod.D.x": [0.05]}, places, [[False, True]]


def _parallel_guides_rpp():
    """The yoke's slot along its own guide, or almost."""
    slot = {"A in yoke.along.x": np.ones(3), "A in yoke.along.y": [0.0, 1e-9, 1e-6]}
    return mechanism("scotch-yoke"), slot, [0.3], [[False], [False], [True]]


def _parallel_guides_prp():
    """The slot in the shaper's rocker parallel to the ram's guide at 1 rad."""
    sample = mechanism("shaper")
    _, _, c, s = sample.sweep(1.0).poses("rocker")
    ex, ey = next(slider.guide.along for slider in sample.linkage.sliders if slider.link == "ram")
    slot = {"F in rocker.along.x": [c * ex + s * ey], "F in rocker.along.y": [c * ey - s * ex]}
    return sample, slot, [1.0, 1.3], [[False, True]]


SINGULAR = (
    _coinciding_pins, _pin_on_pivot, _almost_at_the_foot, _arm_too_short, _almost_square, _parallel_guides_rpp,
    _parallel_guides_prp,
)  # fmt: skip


@pytest.mark.parametrize("case", SINGULAR)
def test_places_without_motion_are_those_known_by_hand(case):
    sample, parameters, angle, expected = case()
    for name in ("S", "Jeq"):
        values = evaluate_designs(sample, parameters, angle, [name])
        assert values[ASSEMBLED].tolist() == expected
        assert np.isnan(values[name]).tolist() == np.logical_not(expected).tolist()


def test_a_link_that_weighs_something_in_one_design_is_assembled_in_all():
    sample, angle = mechanism("rimoldi-164"), np.linspace(0.0, 6.0, 20)
    short = {"link.D.x": np.array([0.002, 0.002]), "needle_bar.mass": np.array([0.0, 0.041])}
    light = {"link.mass": np.zeros(2), "link.inertia": np.zeros(2)}
    both = evaluate_designs(sample, {**short, **light}, angle, ["Jeq"])
    assert np.array_equal(both[ASSEMBLED][0], both[ASSEMBLED][1])
    assert not np.all(both[ASSEMBLED])
    short["needle_bar.mass"] = np.zeros(2)
    assert np.all(evaluate_designs(sample, {**short, **light}, angle, ["Jeq"])[ASSEMBLED])


ONE = np.ones(2)
NO_DIRECTION = {"needle_bar.along.x": [1.0, 0.0], "needle_bar.along.y": [0.0, 0.0]}


@pytest.mark.parametrize(
    ("parameters", "angle", "message"),
    [
        ({"crnk.mass": ONE}, [0.0], "unknown parameter of 'juki-mf7923d' 'crnk.mass': did you mean 'crank.mass'"),
        ({"sketch.B.x": ONE}, [0.0], "unknown parameter"),
        ({}, [0.0], "got none"),
        ({"crank.mass": 1.0}, [0.0], r"crank.mass of shape \(\)"),
        ({"crank.mass": ONE, "coupler.mass": np.ones(3)}, [0.0], r"coupler.mass of shape \(3,\)"),
        ({"crank.mass": np.ones(0)}, [0.0], "a value per design"),
        ({"crank.mass": [1.0, -1.0]}, [0.0], "none negative, got -1 in design 1"),
        ({"crank.A.x": [np.nan, 1.0]}, [0.0], "expected finite numbers, got nan in design 0"),
        (NO_DIRECTION, [0.0], r"got \(0, 0\) in design 1"),
    ],
)
def test_bad_arguments_are_named(parameters, angle, message):
    with pytest.raises(LinkproofError, match=message):
        evaluate_designs(mechanism("juki-mf7923d"), parameters, angle, ["Jeq"])


def test_a_direction_is_scaled_to_unit_length_and_a_point_of_that_name_is_none():
    scaled = {"needle_bar.along.x": [0.0, 0.0], "needle_bar.along.y": [1.0, 5.0]}
    values = evaluate_designs(mechanism("juki-mf7923d"), scaled, np.linspace(0.0, 6.0, 9), ["S", "Jeq"])
    for name in ("S", "Jeq"):
        assert np.allclose(values[name][1], values[name][0], rtol=1e-12, atol=0.0)
    text = text_of("centric-slider-crank").replace("A = [0.05, 0] }", "A = [0.05, 0], along = [0, 0.01] }", 1)
    assert np.all(evaluate_designs(from_text(text), {"crank.along.y": [0.0, 0.01]}, [0.3], ["Jeq"])[ASSEMBLED])
