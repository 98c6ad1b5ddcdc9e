"""A static map has a box and a sign for every cell, and a bar for every border."""

from itertools import pairwise

import numpy as np
import pytest

from comparisons.stress.axes import axes
from reports.charts import draw
from reports.stress.figure import draw_map
from reports.stress.maps import border_place, map_data
from tests.reports.made_up_stress import made_up_stress

STRESS = made_up_stress()


@pytest.mark.parametrize("axis", STRESS.axes)
def test_every_cell_has_its_box_and_sign_and_every_border_its_bar(axis):
    drawing = draw_map(map_data(STRESS, axis))
    assert [panel.get_title(loc="left") for panel in drawing.axes] == [row.label for row in axes()[axis].rows]
    lines = [line for panel in drawing.axes for line in panel.lines]
    bars = [line for line in lines if line.get_marker() == "None"]
    assert sum(len(line.get_xdata()) for line in lines if line not in bars) == 2 * STRESS.count(axis=axis).total()
    places = [border_place(one, STRESS.columns[axis]) for one in STRESS.borders if one.axis == axis]
    assert sorted(float(line.get_xdata()[0]) for line in bars) == sorted(places)


def test_panels_do_not_overlap_and_stay_within_the_figure():
    boxes = [panel.get_position() for panel in draw_map(map_data(STRESS, "mass")).axes]
    for box in boxes:
        assert np.all(np.concatenate([box.min, 1.0 - box.max]) >= 0.0)
    for left, right in pairwise(boxes):
        assert left.x1 < right.x0 or left.y0 > right.y1


def test_names_and_values_are_text_in_the_file_and_large_enough():
    drawing = draw_map(map_data(STRESS, "mass"))
    text = draw.svg(drawing)
    assert "alpha tuned" in text
    sizes = [label.get_fontsize() for panel in drawing.axes for label in (*panel.get_xticklabels(), panel.title)]
    assert min(sizes) * 96 / 72 >= 12.0
