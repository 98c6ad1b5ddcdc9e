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
from comparisons.designs.space import DesignSpace, parameter_range
from comparisons.designs.sweep import SweepRequest, figures_of_file, reason_not_assembled, sweep, usual_figures
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
    motion = steady_motion(mechanism, 1000.0 * RPM)
    space = DesignSpace(*zip(parameter_range(mechanism.linkage, "crank.mass=0.3:0.4:2"), strict=True))
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
