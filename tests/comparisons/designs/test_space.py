"""Grids number their designs as itertools.product does; what is no range is refused in a sentence."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.errors import LinkproofError
from comparisons.designs.parameters import parameter
from comparisons.designs.space import Grid, Listed, steps
from tests.comparisons.designs.sweeps import SIX_BAR, grid

NAMES = ("rod.B.x", "rod.mass", "rod.centre.x")


@given(st.lists(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=4), min_size=1, max_size=3), st.data())
def test_designs_are_numbered_last_axis_first(values, data):
    parts = tuple(parameter(SIX_BAR, name) for name in NAMES[: len(values)])
    space = Grid(parts, tuple(map(np.array, values)))
    truth = np.array(list(itertools.product(*values))).T
    first = data.draw(st.integers(0, space.count - 1))
    last = data.draw(st.integers(first + 1, space.count))
    np.testing.assert_array_equal(space.shown(first, last), truth[:, first:last])
    np.testing.assert_array_equal(space.ends, np.stack([truth.min(axis=1), truth.max(axis=1)], axis=1))
    for one, row in zip(parts, truth, strict=True):
        np.testing.assert_array_equal(space.block(first, last)[one.name], row[first:last] * one.unit.size)


def test_a_range_is_read_in_the_units_of_the_file_or_in_its_own():
    for text in ("rod.B.x=170:180:11", "rod.B.x=17cm:18 cm:11", " rod.B.x =170:0.18m:11"):
        np.testing.assert_array_equal(steps(SIX_BAR, text)[1], np.arange(170.0, 181.0))
    assert steps(SIX_BAR, "rod.B.x=170:170:1")[1].tolist() == [170.0]


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
        ([f"{name}=1:2:20000" for name in NAMES], "designs at most, got 20000 × 20000 × 20000"),
        (["rod.B.x=1:2:10000001"], "expected a number of values from 1 to 1e+07"),
    ],
)
def test_what_is_no_space_is_told(texts, words):
    with pytest.raises(LinkproofError) as told:
        grid(*texts)
    assert words in str(told.value)


def test_a_part_of_a_list_knows_its_numbers():
    columns = (parameter(SIX_BAR, "rod.B.x"), parameter(SIX_BAR, "rod.mass"))
    space = Listed(columns, tuple(np.arange(20.0).reshape(2, 10)))
    np.testing.assert_array_equal(space.part(3, 7).shown(4, 6), space.shown(4, 6))
    assert (space.count, space.part(3, 7).count) == (10, 4)
