"""A sweep is what a loop over its designs, one by one, makes of them."""

import itertools

import numpy as np
import pytest

from analytic.description.crank_motion import RPM
from analytic.designs.results import design_figures
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import sheet, usual_case
from comparisons.designs import sweep as sweeps
from comparisons.designs.parameters import named_figures, steady_motion
from comparisons.designs.space import Grid, parameter_range
from comparisons.designs.sweep import Summary, SweepRequest, figures_of_file, reason_not_assembled, sweep, usual_figures
from comparisons.runs.workers import LocalPool
from tests.analytic.loaded_linkages import on_trial
from tests.comparisons.designs.sweeps import SIX_BAR, grid, request


def looped(asked):
    """Every design on its own, (figures, designs), file's units."""
    mechanism, found = Mechanism(SIX_BAR), []
    for number in range(asked.space.count):
        values = asked.space.block(number, number + 1)
        found.append(
            design_figures(
                mechanism, values, [one.figure for one in asked.figures], asked.motion.places,
                speed=asked.motion.speed, path="numpy"
            )[:, 0] / [one.unit.size for one in asked.figures]
        )  # fmt: skip
    return np.array(found).T


def test_figures_and_their_ends_are_those_of_a_loop(monkeypatch):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)
    asked = request()
    found = np.full((3, 30), np.nan)

    def keep(number, values):
        found[:, slice(*asked.block(number))] = values

    heard = []
    summary = sweep(asked, keep=keep, announce=heard.append, pool=LocalPool(2))
    truth = looped(asked)
    np.testing.assert_allclose(found, truth, rtol=1e-12)
    there = ~np.isnan(truth[0])
    assert 0 < summary.assembled == np.count_nonzero(there) < summary.designs == 30 == heard[-1]
    assert heard == sorted(heard)
    shown = np.array(list(itertools.product(range(160, 181, 5), (0.1, 0.15, 0.2), (50.0, 60.0)))).T
    np.testing.assert_allclose(
        summary.reach, np.stack([shown[:, there].min(axis=1), shown[:, there].max(axis=1)], axis=1), rtol=1e-14
    )
    for row, least, largest in zip(found, summary.least, summary.largest, strict=True):
        assert (least.design, largest.design) == (np.nanargmin(row), np.nanargmax(row))
        assert (least.value, largest.value) == (row[least.design], row[largest.design])


def test_what_is_done_is_not_made_again(monkeypatch):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)
    asked, parts = request(), {}
    whole = sweep(asked, keep=parts.__setitem__)
    made, begun = [], Summary(asked)
    for number in (3, 1):  # in any order
        begun.add(asked.blocks[number], parts[number])
    again = sweep(asked, done={1, 3}, begun=begun, keep=lambda number, _: made.append(number))
    assert (again.assembled, again.least, again.largest) == (whole.assembled, whole.least, whole.largest)
    np.testing.assert_array_equal(again.reach, whole.reach)
    assert sorted([*made, 1, 3]) == sorted(parts)


@pytest.mark.parametrize("refine", [False, pytest.param(True, marks=pytest.mark.nightly)])
def test_the_rms_torque_is_that_of_results_beside_a_dead_position_too(refine):
    mechanism = on_trial("near-toggle", None, False)
    motion = steady_motion(mechanism, 1000.0 * RPM)
    space = Grid(*zip(parameter_range(mechanism.linkage, "crank.mass=0.3:0.4:2"), strict=True))
    asked = SweepRequest(mechanism.linkage, space, named_figures(mechanism, ["Mkr.rms"]), motion, refine=refine)
    (shown,) = (one for one in sheet(usual_case(mechanism)).figures["drive"] if one.what == "RMS torque")
    assert figures_of_file(asked)[0] == pytest.approx(shown.value, rel=1e-9)


def test_a_design_that_does_not_assemble_says_where():
    assert "cannot be assembled" in reason_not_assembled(request(grid("rod.B.x=100:110:2")))
    assert "stands in a dead position between two" in reason_not_assembled(request(grid("rod.B.x=166.4:166.41:2")))
    assert not reason_not_assembled(request(grid("rod.B.x=175:180:2")))


def test_usual_figures_are_peaks_and_the_stroke():
    names = [one.name for one in usual_figures(Mechanism(SIX_BAR))]
    assert names[0] == "Mkr.peak"
    assert names[-1] == "stroke"
    assert {name.partition(":")[0] for name in names[1:-1]} == {"joint_force", "transmission_angle"}
