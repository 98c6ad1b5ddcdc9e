"""Tables of results where some figures have no value."""

import numpy as np

from comparisons.datasheet.instants import Instants
from reports.designs.results_terminal import printed
from reports.document.terminal import rendered
from tests.analytic.linkages import mechanism
from tests.reports.designs.samples import TURN, results


def test_joint_forces_without_bound_at_change_points_leave_those_elsewhere():
    quarters = Instants(TURN).times_of_angles(np.array([0.0, 90.0, 180.0]), "°", np.radians(1.0))
    found = results(mechanism("parallelogram"), chosen=quarters)
    rows = [row.split() for row in rendered(*printed(found)).splitlines()]
    start = next(number for number, row in enumerate(rows) if row[:2] == ["force", "in"])
    assert [row[-3:] for row in rows[start + 1 : start + 4]] == [["–"] * 3, ["0", "19.83", "19.83"], ["–"] * 3]
    assert "nan" not in rendered(*printed(results(mechanism("parallelogram"))))
    assert "Joint forces have no bound at the change point" in rendered(*printed(found))
