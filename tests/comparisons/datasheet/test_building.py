"""Data sheets hold what the closed form says, of every kind of linkage."""

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.kinematics import frames
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import usual_sheet


@pytest.mark.parametrize("name", ["juki-mf7923d", "slotted-takeup", "rimoldi-164"])
def test_the_positions_put_every_point_where_the_linkage_has_it(name):
    found, mechanism = usual_sheet(load(name)), Mechanism(load(name))
    sweep = mechanism.sweep(found.positions.angle)
    for link in found.linkage.links.values():
        x, y, turned = found.positions.bodies[link.name]
        for point, local in link.points.items():
            there = frames.point((x, y, np.cos(turned), np.sin(turned)), local)
            assert np.allclose(there, sweep.point(point), atol=1e-12), (link.name, point)


def test_straight_lines_between_the_instants_show_every_peak():
    found = usual_sheet(load("slotted-takeup"))
    for name, peak in found.peaks.items():
        if not name.startswith("transmission"):
            assert np.max(np.abs(found.values[name])) == pytest.approx(abs(peak["value"]), rel=2e-3, abs=1e-9), name


def test_the_shares_of_the_inertia_add_up_to_it():
    found = usual_sheet(load("rimoldi-164"))
    for shares in found.shares.values():
        assert np.allclose(sum(shares.values()), found.values["Jeq"], rtol=1e-12)
