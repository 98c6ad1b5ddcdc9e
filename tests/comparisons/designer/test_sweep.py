"""A sweep is what a loop over its designs, one by one, makes of them; what is no space of designs is told."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from analytic.description.crank_motion import RPM
from analytic.description.law import FULL_TURN
from analytic.designs.results import design_figures
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer import sweep as sweeps
from comparisons.designer.building import sheet, usual_case
from comparisons.designer.parameters import case_at_speed, named_figures
from comparisons.designer.sweep import (
    DesignSpace,
    SweepRequest,
    parameter_range,
    read_table,
    reason_not_assembled,
    sweep,
)
from tests.analytic.linkages import on_trial
from tests.comparisons.designer.sweeps import CASE, SIX_BAR, grid, request


def test_a_range_is_read_in_the_units_of_the_file_or_in_its_own():
    for text in ("rod.B.x=170:180:11", "rod.B.x=17cm:18 cm:11", " rod.B.x =170:0.18m:11"):
        np.testing.assert_array_equal(parameter_range(CASE, text)[1], np.arange(170.0, 181.0))
    assert parameter_range(CASE, "rod.B.x=170:170:1")[1].tolist() == [170.0]


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["rod.B.z=1:2:3"], "did you mean 'rod.B."),
        (["rod.B.x=1:2"], "expected NAME=FIRST:LAST:COUNT"),
        (["rod.B.x=1:inf:3"], "expected a finite number of mm"),
        (["rod.B.x=1kg:2:3"], "unknown length unit 'kg'"),
        (["rod.B.x=1:2:0"], "expected a number of values"),
        (["rod.B.x=1:2:1"], "expected a single value, twice"),
        (["rod.B.x=2:2:5"], "expected two values that differ"),
        (["rod.B.x=-1e308:1e308:5"], "expected two values that differ"),
        (["rod.B.x=1:2:3", "rod.B.x=1:2:3"], "got rod.B.x twice"),
        (["rod.B.x=1:2:20000001"], "expected a number of values from 1 to 2e+07"),
    ],
)
def test_what_is_no_space_is_told(texts, words):
    with pytest.raises(LinkproofError) as told:
        grid(*texts)
    assert words in str(told.value)


# Tables of designs are what was written; what is wrong with one is told by line and column.


def test_a_table_is_read_in_its_own_units(tmp_path):
    values = np.random.default_rng(0).uniform(1.0, 2.0, (2, 103))
    rows = [f"{a!r},{b!r}" for a, b in values.T.tolist()]
    rows.insert(50, "")  # lines without a design count for nothing
    file = tmp_path / "designs.csv"
    file.write_text("\ufeffrod.B.x [cm], rod.mass \n" + "\n".join(rows), encoding="utf-8")
    space = read_table(file, CASE)
    truth = values * np.array([[10.0], [1.0]])
    assert (space.count, space.shape, space.dimensions) == (103, (103,), ("design",))
    np.testing.assert_array_equal(space.ends, np.stack([truth.min(axis=1), truth.max(axis=1)], axis=1))
    for first, last in ((0, 103), (10, 20)):
        np.testing.assert_array_equal(space.file_values(first, last), truth[:, first:last])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected a head that names parameters and a row per design below, got none"),
        ("rod.B.x\n \n", "expected a head that names parameters and a row per design"),
        ("rod.B.q\n1\n", "did you mean 'rod.B."),
        ("rod.B.x [kg]\n1\n", "unknown length unit 'kg'"),
        ("rod.B.x,rod.B.x\n1,2\n", "got rod.B.x twice"),
        ("rod.B.x,rod.mass\n1,2\n3\n4,5\n", "expected 2 cells in every line, got 1 in line 3"),
        ("rod.B.x,rod.mass\n1,2\n3,4,5\n", "expected 2 cells in every line, got 3 in line 3"),
        ("rod.B.x\n1\ntwo\n", "expected finite numbers in line 3, got 'two'"),
        ("rod.B.x\nTrue\n", "got 'True'"),
        ("\ufeffrod.B.x [cm];rod.mass\r\n17,2;0,1\r\n", "commas between them, got: "),
        ("rod.B.x,\n175,\n", "expected a head that names parameters"),
        ("rod.B.x\n1\n\n1e999\n", "in line 4, got '1e999'"),
    ],
)
def test_what_is_no_table_is_told(tmp_path, text, words):
    file = tmp_path / "designs.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(LinkproofError) as told:
        read_table(file, CASE)
    assert words in str(told.value)


def test_a_file_that_cannot_be_read_is_told(tmp_path):
    (tmp_path / "latin.csv").write_bytes("rod.B.x\n1\nü\n".encode("latin1"))
    (tmp_path / "head.csv").write_bytes("rö\n1\n".encode("latin1"))
    for name, words in (("none.csv", "does not exist"), ("latin.csv", "UTF-8"), ("head.csv", "UTF-8")):
        with pytest.raises(LinkproofError, match=words):
            read_table(tmp_path / name, CASE)


def looped(asked):
    """Every design on its own, (figures, designs), file's units."""
    mechanism, found = Mechanism(SIX_BAR), []
    for number in range(asked.space.count):
        values = asked.space.block(number, number + 1)
        figures, case = [one.figure for one in asked.figures], asked.case
        options = {"speed": case.speed, "period": FULL_TURN, "path": "numpy"}
        row = design_figures(mechanism, values, figures, case.places, **options)[:, 0]
        found.append(row / [one.unit.size for one in asked.figures])
    return np.array(found).T


def test_figures_and_their_ends_are_those_of_a_loop(monkeypatch):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)  # of a block
    heard = []
    study = sweep(request(), announce=lambda _, number, count: heard.append((number, count)))
    truth = looped(study.request)
    np.testing.assert_allclose(study.values, truth, rtol=1e-12)
    there = ~np.isnan(truth[0])
    assert np.array_equal(study.assembles, there)
    assert 0 < np.count_nonzero(there) < 30
    assert heard == [(7, 30), (14, 30), (21, 30), (28, 30), (30, 30)]
    shown = np.array(list(itertools.product(range(160, 181, 5), (0.1, 0.15, 0.2), (50.0, 60.0)))).T
    np.testing.assert_allclose(
        study.reach, np.stack([shown[:, there].min(axis=1), shown[:, there].max(axis=1)], axis=1), rtol=1e-14
    )
    for row, values in enumerate(study.values):
        assert (study.extreme(row, -1.0), study.extreme(row, 1.0)) == (np.nanargmin(values), np.nanargmax(values))


@pytest.mark.parametrize("refine", [False, pytest.param(True, marks=pytest.mark.nightly)])
def test_the_rms_torque_is_that_of_results_beside_a_dead_position_too(refine):
    mechanism = on_trial("near-toggle", None, False)
    case = case_at_speed(mechanism, 1000.0 * RPM)
    space = DesignSpace(*zip(parameter_range(case, "crank.mass=0.3:0.4:2"), strict=True))
    asked = SweepRequest(case, space, named_figures(mechanism, ["Mkr.rms"]), refine=refine)
    (shown,) = (one for one in sheet(usual_case(mechanism)).figures["drive"] if one.what == "RMS torque")
    assert asked.own()[0] == pytest.approx(shown.value, rel=1e-9)


def test_a_design_that_does_not_assemble_says_where():
    assert "cannot be assembled" in reason_not_assembled(request(grid("rod.B.x=100:110:2")))
    assert "stands in a dead position between two" in reason_not_assembled(request(grid("rod.B.x=166.4:166.41:2")))
    assert not reason_not_assembled(request(grid("rod.B.x=175:180:2")))
