"""The thread's contour as drawn: in the plane at its reference angle, and in space at its depth."""

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.datasheet.building import usual_sheet
from reports.charts import thread


@pytest.fixture(scope="module")
def sheet():
    return usual_sheet(load("fork-takeup"))


def drawn(figure, ink=thread.THREAD):
    return next(line for line in figure.axes[0].lines if line.get_color() == ink)


def test_the_contour_passes_through_its_guides_and_the_links_that_carry_its_eyes(sheet):
    figure = thread.plane_figure(sheet.linkage, sheet.positions, sheet.thread)
    line = drawn(figure).get_xydata()
    np.testing.assert_allclose(line, 1e3 * sheet.thread.contour[:, :2])
    texts = {text.get_text() for text in figure.axes[0].texts}
    assert set(sheet.thread.stops) <= texts
    for name in sheet.thread.eyes:
        place = line[sheet.thread.stops.index(name)]
        carrier = sheet.linkage.output.point == name
        corners = np.concatenate([patch.get_xy() for patch in figure.axes[0].patches if hasattr(patch, "get_xy")])
        assert carrier or np.min(np.hypot(*(corners - place).T)) < 0.1


def test_the_contour_in_space_is_the_whole_of_it(sheet):
    assert thread.is_spatial(sheet.thread)
    figure = thread.space_figure(sheet.linkage, sheet.positions, sheet.thread)
    x, z, y = drawn(figure).get_data_3d()
    np.testing.assert_allclose(np.transpose([x, y, z]), 1e3 * sheet.thread.contour)
