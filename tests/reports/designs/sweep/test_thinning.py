"""What is kept of many designs: every peak, every failure, and as little memory as is told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from reports.designs.sweep import thinning
from reports.designs.sweep.thinning import PixelCells

VALUES = st.one_of(st.floats(-1e6, 1e6), st.just(np.nan))


def kept(values, *most, target=0.0):
    cells = tuple(PixelCells(np.arange(float(n)), one) for n, one in zip(values.shape, most, strict=False))
    starts = [one.starts for one in cells]
    return cells, thinning.keep(lambda first, last: values[first:last], values.shape, starts, target)


@pytest.fixture(params=[thinning.AT_ONCE, 7], ids=["at once", "in pieces"])
def _pieces(request, monkeypatch):
    monkeypatch.setattr(thinning, "AT_ONCE", request.param)


@pytest.mark.usefixtures("_pieces")
def test_a_single_peak_and_a_single_failure_of_a_million_are_kept():
    values = np.sin(np.arange(1e4))
    values[[1234, 7777, 5000]] = 50.0, -60.0, np.nan
    (cells,), found = kept(values, 100)
    x, y = cells.curve(found)
    assert len(x) == len(y) == 200
    assert (np.max(y), np.min(y)) == (50.0, -60.0)
    assert x[np.argmax(y)] == pytest.approx(1234, abs=50)
    assert (x[0], x[-1]) == (0.0, 9999.0)
    ((low, high),) = cells.failing(found)
    assert low <= 5000 <= high
    assert high - low == pytest.approx(100.0, abs=1.0)
    assert found.indices.tolist()[:2] == [7777, 1234]
    assert found.failing == 1


@pytest.mark.usefixtures("_pieces")
@given(arrays.arrays(float, arrays.array_shapes(min_dims=2, max_dims=2, max_side=9), elements=VALUES))
def test_a_map_shows_of_every_cell_the_value_farthest_from_the_middle(values):
    (x, y), found = kept(values, 3, 4)
    shown = found.surface()
    there = values[np.isfinite(values)]
    assert found.failing == values.size - there.size
    for row, first in enumerate(x.starts):
        for column, start in enumerate(y.starts):
            last = [*x.starts, len(values)][row + 1], [*y.starts, values.shape[1]][column + 1]
            cell = values[first : last[0], start : last[1]]
            if np.any(np.isnan(cell)):
                assert np.isnan(shown[row, column])
            else:
                away = np.abs(cell - 0.5 * (there.min() + there.max()))
                assert shown[row, column] in cell
                assert abs(shown[row, column] - 0.5 * (there.min() + there.max())) == pytest.approx(
                    away.max(), rel=1e-9
                )
    assert not len(there) or {there.min(), there.max()} == set(found.extremes[:2].tolist())


@pytest.mark.usefixtures("_pieces")
@given(arrays.arrays(float, (5, 3, 4), elements=VALUES), st.floats(-10.0, 10.0))
def test_extremes_and_the_nearest_are_the_first_in_the_order_of_the_dimensions(values, target):
    _, found = kept(values, 2, target=target)
    if np.all(np.isnan(values)):
        assert found.indices.tolist() == [-1] * 3
        return
    expected = np.nanargmin(values), np.nanargmax(values), np.nanargmin(np.abs(values - target))
    assert found.extremes.tolist() == values.ravel()[list(expected)].tolist()
    assert abs(found.extremes[2] - target) == np.nanmin(np.abs(values - target))
    assert values.ravel()[found.indices].tolist() == found.extremes.tolist()


def test_few_designs_are_drawn_as_they_are_and_their_failures_half_a_step_around():
    values = np.array([1.0, np.nan, np.nan, 4.0])
    cells = PixelCells(np.array([0.0, 1.0, 2.0, 4.0]), 100)
    found = thinning.keep(lambda first, last: values[first:last], (4,), [cells.starts])
    x, y = cells.curve(found)
    assert x.tolist() == [0.0, 1.0, 2.0, 4.0]
    assert np.array_equal(y, values, equal_nan=True)
    assert cells.failing(found).tolist() == [[0.5, 3.0]]
    assert PixelCells(np.array([5.0]), 9).edges.tolist() == [2.5, 7.5]


@pytest.mark.usefixtures("_pieces")
@pytest.mark.parametrize(("count", "most", "always"), [(10, 20, {3}), (1000, 20, {0, 999, 500}), (30, 29, {7})])
def test_a_sample_holds_what_it_has_to_and_picks_its_values(count, most, always):
    chosen = thinning.sample(count, most, always)
    assert len(chosen) <= most
    assert always <= set(chosen.tolist())
    assert np.all(np.diff(chosen) > 0)
    assert chosen.tolist() == thinning.sample(count, most, always).tolist()
    values = np.arange(float(count)).reshape(10, -1)
    assert thinning.picked(lambda first, last: values[first:last], values.shape, chosen).tolist() == chosen.tolist()
