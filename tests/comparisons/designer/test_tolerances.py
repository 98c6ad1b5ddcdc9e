"""Tolerance files and messages about wrong ones; studies against designs worked out one by one."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from analytic.description.changes import changed
from analytic.description.diagnosis import Source
from analytic.description.loading import load
from analytic.dynamics.reduced import drive_torque
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.parameters import case_at_speed
from comparisons.designer.tolerances import (
    FEW_SAMPLES,
    Distribution,
    Tolerances,
    read_tolerances,
    tolerance_study,
    tolerances,
)
from tests.analytic.linkages import IN_LINE, driven, from_text

RIMOLDI = Mechanism(load("rimoldi-164"))


def test_a_file_states_results_speed_and_tolerances_in_several_ways(tmp_path):
    file = tmp_path / "tolerances.toml"
    file.write_text(
        'results = ["Mkr.peak", "stroke"]\nspeed = 900\n[tolerances]\n"rod.B.x" = 0.05\nrod.centre.x = "±50um"\n'
        'rocker.mass = { plus_minus = 0.01, distribution = "uniform" }\n',
        encoding="utf-8",
    )
    read = read_tolerances(file)
    found = {one.name: one for one in tolerances(RIMOLDI.linkage, read.table)}
    assert (read.results, read.speed) == (("Mkr.peak", "stroke"), 900)
    expected = {"rod.B.x": 5e-5, "rod.centre.x": 5e-5, "rocker.mass": 0.01}
    assert {name: one.plus_minus for name, one in found.items()} == pytest.approx(expected)
    assert found["rocker.mass"].distribution is Distribution.UNIFORM
    assert found["rod.B.x"].distribution is Distribution.NORMAL


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"rod.B.X": 0.1}, "did you mean 'rod.B.x'"),
        ({"rod.B.x": -0.1}, "rod.B.x: expected a positive ±, got -0.1"),
        ({"rod.B.x": "0.1kg"}, "rod.B.x: unknown length unit"),
        ({"rod.B.x": True}, "expected a finite number of mm, got 'True'"),
        ({"rod.B.x": {"plus_minus": 0.1, "distribution": "flat"}}, "normal or uniform, got 'flat'"),
        ({"rod.B.x": {"plus_minus": 0.1, "spread": 1}}, "unknown key 'spread'"),
        ({"rod.mass": 0.2}, "rod.mass: expected a positive ± up to 0.17 kg, got 0.2"),
        ({"speed": 500}, "speed: expected a positive ± up to 477.465 rpm, got 500"),
    ],
)
def test_a_wrong_tolerance_is_refused_in_a_sentence(table, words):
    with pytest.raises(LinkproofError, match=words) as told:
        tolerances(RIMOLDI.linkage, table, Source("t.toml"), 100.0)
    assert str(told.value).startswith("t.toml:1: tolerances.")


def test_a_wrong_tolerance_of_a_file_is_told_with_its_line(tmp_path):
    file = tmp_path / "t.toml"
    file.write_text('results = ["Mkr.peak"]\n\n[tolerances]\n"rod.B.x" = 0.1\nrod.B.w = 0.1\n', encoding="utf-8")
    read = read_tolerances(file)
    with pytest.raises(LinkproofError, match=r"t\.toml:5: tolerances\.rod\.B\.w: unknown parameter"):
        tolerances(RIMOLDI.linkage, read.table, read.source)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("result = 1", "unknown key 'result'"),
        ("results = []", "results: expected a list of figures"),
        (
            'results = ["Mkr.peak"]\nspeed = 0\n[tolerances]\nx = 1',
            "speed: expected a finite number other than 0, got 0",
        ),
        ('results = ["Mkr.peak"]\nspeed = "fast"', "speed: expected a number, got 'fast'"),
        ('results = ["Mkr.peak"]', "expected a table \\[tolerances\\]"),
        ("results = [", "not valid TOML"),
    ],
)
def test_a_wrong_file_is_refused_with_its_name(tmp_path, text, words):
    file = tmp_path / "tolerances.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(LinkproofError, match=words) as told:
        read_tolerances(file)
    assert str(file) in str(told.value)
    with pytest.raises(LinkproofError, match="check the path"):
        read_tolerances(tmp_path / "none.toml")


TABLE = {
    **{"rod.B.x": 0.05, "rocker.B.x": 0.05, "rocker.C.y": 0.05},
    "rod.mass": {"plus_minus": 0.01, "distribution": "uniform"},
}


def study(table=TABLE, results=("Mkr.peak", "stroke", "Mkr@30"), samples=10_000):
    return tolerance_study(case_at_speed(RIMOLDI, 104.7, samples=90), Tolerances(results, None, table), samples)


def test_corners_and_changes_are_those_of_linkages_built_one_by_one():
    found = study(results=("Mkr@30", "point:B:y@30"), samples=10)

    def result(signs):
        own = {"rod.B.x": 0.175 + 5e-5 * signs[0], "rocker.B.x": 21.3e-3 + 5e-5 * signs[1]}
        own |= {"rocker.C.y": 5e-5 * signs[2], "rod.mass": 0.17 + 0.01 * signs[3]}
        sample = RIMOLDI.redesigned(changed(RIMOLDI.linkage, lambda name, _, value: own.get(name, value)))
        sweep = sample.sweep(math.radians(30.0))
        return float(drive_torque(sweep, 104.7, 0.0)), float(sweep.point("B")[1])

    every = np.array([result(signs) for signs in itertools.product((-1, 1), repeat=4)])
    assert found.corners == pytest.approx(np.stack([every.min(axis=0), every.max(axis=0)], axis=1), rel=1e-12)
    for row, side in ((0, -1), (1, 1)):
        alone = np.array([result(side * np.eye(4)[one]) for one in range(4)]).T
        assert found.nominal[:, None] + found.changes[..., row] == pytest.approx(alone, rel=1e-12)


def test_derivatives_are_slopes_of_small_changes_and_shares_add_up():
    found = study(dict.fromkeys(("rod.B.x", "rocker.B.x", "rocker.C.y", "rod.centre.x"), 0.001), samples=4)
    slopes = (found.changes[..., 1] - found.changes[..., 0]) / 2.0
    sizes = np.array([one.plus_minus for one in found.tolerances])
    assert slopes == pytest.approx(found.derivatives * sizes, rel=1e-4, abs=1e-6 * np.max(np.abs(slopes)))
    assert found.how == "exact"
    assert np.sum(found.shares, axis=1) == pytest.approx(np.ones(3))
    assert np.all(found.worst >= 3.0 * found.deviations * (1.0 - 1e-12))


def test_random_designs_scatter_as_their_distributions_say():
    table = {"rod.mass": {"plus_minus": 0.01, "distribution": "uniform"}, "gravity.y": 0.1}
    found = study(table, results=("Mkr@30",), samples=8_000)  # linear in both
    assert found.deviation == pytest.approx(found.deviations, rel=0.03)
    assert found.mean == pytest.approx(found.nominal, abs=3.0 * found.deviations[0] / math.sqrt(8_000))
    assert found.corners[0] == pytest.approx(found.nominal[0] + np.array([-1.0, 1.0]) * found.worst[0], rel=1e-3)
    assert found.assembled == 1.0
    assert np.array_equal(found.random, study(table, results=("Mkr@30",), samples=8_000).random)


def test_of_many_tolerances_the_derivatives_point_to_the_corners():
    names = ["rod.B.x", "rod.B.y", "rod.A.x", "rod.A.y", "rocker.B.x", "rocker.B.y", "rocker.C.x", "rocker.C.y",
             "link.D.x", "link.D.y", "crank.A.x", "crank.A.y", "ground.O2.x"]  # fmt: skip
    found = study(dict.fromkeys(names, 0.01), results=("Mkr.peak",), samples=50)
    assert not found.has_all_corners
    assert found.corners[0] == pytest.approx(found.nominal[0] + np.array([-1.0, 1.0]) * found.worst[0], rel=1e-2)


def test_designs_that_do_not_assemble_are_counted_and_none_at_all_is_told():
    found = study({"crank.A.x": {"plus_minus": 11.9, "distribution": "uniform"}}, samples=200)
    assert 0.0 < found.assembled < 1.0
    assert np.all(np.isfinite(found.mean))
    with pytest.raises(LinkproofError, match="expected 2 or more random designs"):
        study(samples=1)


@pytest.mark.nightly
def test_where_there_is_no_closed_form_derivatives_are_differences():
    sample, heard = driven("ternary-on-rods"), []
    asked = Tolerances(("Mkr@30",), None, {"crank.A.x": 0.01})
    case = case_at_speed(sample, 10.0, samples=8)
    assert tolerance_study(case, asked).random.shape[1] == FEW_SAMPLES
    found = tolerance_study(case, asked, 2, lambda *words: heard.append(words))
    slopes = (found.changes[..., 1] - found.changes[..., 0]) / 2.0
    assert found.how == "difference"
    assert found.derivatives[:, 0] * 1e-5 == pytest.approx(slopes[:, 0], rel=1e-5)
    assert heard[0] == ("designs", 0, 7)


def test_tops_that_tie_have_the_larger_change_for_a_contribution():
    sample = from_text(IN_LINE)
    case = case_at_speed(sample, 104.7, samples=90)
    asked = Tolerances(("v.peak",), None, {"piston.through.y": 0.001, "rod.B.x": 0.001})
    found = tolerance_study(case, asked, 4)
    assert np.isnan(found.derivatives[0]).tolist() == [True, False]
    assert np.all(found.contributions > 0.0)
    assert np.all(found.contributions < 1e-2 * np.abs(found.nominal))  # not from one stroke's peak to the other's
    assert np.all(found.deviation < 1e-2 * np.abs(found.nominal))
