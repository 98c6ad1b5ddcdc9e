"""Data sheets come back from their file as they were, and a damaged file is told by its key."""

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.datasheet.building import usual_sheet
from comparisons.datasheet.saved import load_sheets, save_sheets


@pytest.fixture(scope="module")
def sheet():
    return usual_sheet(load("slotted-takeup"))


def test_a_sheet_comes_back_as_it_was(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    (found,) = load_sheets(tmp_path)
    assert found.linkage == sheet.linkage
    assert (found.figures, found.published) == (sheet.figures, sheet.published)
    assert np.allclose(found.values["Mkr"], sheet.values["Mkr"], rtol=1e-7)
    assert np.allclose(found.thread.contour, sheet.thread.contour, rtol=1e-7)


def test_what_is_not_a_number_comes_back_so(sheet, tmp_path):
    values = dict(sheet.values)
    values["Mkr"] = np.where(np.arange(len(values["Mkr"])) == 7, np.nan, values["Mkr"])
    save_sheets(tmp_path, [replace(sheet, values=values)])
    assert np.isnan(load_sheets(tmp_path)[0].values["Mkr"][7])
