"""Tables of periodic functions against the functions: smooth ones, ones of rounding alone, and no angles at all."""

import numpy as np
import pytest

from analytic.numerics.periodic_table import tabulate


def _functions(angle):
    smooth = 1.0 / (1.3 + np.cos(angle))
    return np.stack([smooth, (smooth + np.sin(angle)) - smooth - np.sin(angle)])  # the second is rounding alone


def test_a_function_of_rounding_alone_does_not_cost_cells():
    table, alone = tabulate(_functions), tabulate(lambda angle: _functions(angle)[:1])
    assert len(table.edges) <= 4 * len(alone.edges)
    angle = np.linspace(-7.0, 7.0, 999)
    assert table(angle)[0] == pytest.approx(_functions(angle)[0], rel=1e-13)
    assert np.max(np.abs(table(angle)[1])) < 1e-14


@pytest.mark.parametrize("shape", [(0,), (0, 3), (3, 0)])
def test_no_angles_have_no_values(shape):
    assert tabulate(_functions)(np.empty(shape)).shape == (2, *shape)
