"""The table of axes: every word in it means something, and every cell of it is a scene."""

from dataclasses import fields

import numpy as np
import pytest

from analytic.errors import UnknownNameError
from comparisons.stress.axes import axes, chosen_axes, nearest
from comparisons.stress.scenes import RELEASED, Conditions, case, scene
from engines.mechanics.start_check import start_misfit

EVERY = [(axis, row) for axis in axes().values() for row in axis.rows]
STRETCH = 1e4  # times the easy value: beyond it a released motion is only slow to integrate


@pytest.mark.parametrize(("axis", "row"), EVERY, ids=lambda one: getattr(one, "name", None) or one.label)
def test_every_row_is_a_scene_that_fits_its_joints_at_both_ends_and_at_its_easy_value(axis, row):
    values = axis.chosen_values(row, quick=False)
    if row.conditions.motion == RELEASED:
        values = tuple(value for value in values if value <= STRETCH)[:3]
    for value in {values[0], values[-1], axis.good}:
        conditions = axis.conditions(row.label, value)
        given = scene(conditions, case(conditions))
        misfit = start_misfit(given)
        assert (misfit is None) or (conditions.disturbed and value > 1e-7), (value, misfit)
        assert all(body.mass > 0.0 for body in given.bodies)


@pytest.mark.parametrize("axis", axes().values(), ids=lambda axis: axis.name)
def test_an_axis_varies_a_field_over_values_that_hold_its_easy_one(axis):
    assert axis.vary in {field.name for field in fields(Conditions)}
    assert axis.good in axis.values
    assert len(set(axis.values)) == len(axis.values)
    assert set(axis.quick) <= set(axis.values)
    assert axis.settings or axis.methods
    assert sum(row.quick for row in axis.rows) >= 1
    assert len({row.label for row in axis.rows}) == len(axis.rows)
    assert all("/" not in row.label for row in axis.rows)  # it separates the words of a cell's name
    for row in axis.rows:
        assert getattr(axis.conditions(row.label, 0.125), axis.vary) == 0.125


def test_a_quick_map_is_a_small_part_of_the_full_one():
    def count(quick):
        return sum(
            len(axis.chosen_values(row, quick=quick))
            for axis in axes().values()
            for row in axis.chosen_rows(quick=quick)
        )

    assert 0 < count(True) < 0.2 * count(False)


def test_axes_are_chosen_by_name_in_the_tables_order():
    names = list(axes())
    assert [axis.name for axis in chosen_axes(())] == names
    assert [axis.name for axis in chosen_axes(reversed(names[:3]))] == names[:3]
    with pytest.raises(UnknownNameError, match=r"unknown axis 'mas'.*mass"):
        chosen_axes(["mas"])
    with pytest.raises(UnknownNameError, match="row of axis 'mass'"):
        axes()["mass"].row("four-bar")


def test_the_nearest_value_is_so_by_ratio():
    assert nearest([1e-3, 1.0, 1e3], 40.0) == 2
    assert nearest([1e-3, 1.0, 1e3], 20.0) == 1
    assert nearest([0.0, 1e-9], 1e-12) == 1
    assert nearest([0.0, 1e-9], 0.0) == 0
    assert np.isfinite(nearest([5.0], 1.0))
