"""What a player is given: a place on the figures, a pose of the drawing and the signals, instant by instant."""

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.datasheet.building import usual_sheet
from reports.mechanism.page import SAMPLES, player_data
from tests.analytic.linkages import FOLDER
from tests.reports.designs.samples import SPEED
from tests.reports.mechanism.test_shown import shown


@pytest.mark.parametrize("speed", [SPEED, -SPEED])
def test_signals_are_those_of_the_place_on_the_axis(speed):
    found = shown(speed)
    data = player_data(found, found.positions)
    shares = np.array(data["axis"]["shares"])
    rows = {row["name"]: row for row in data["rows"]}
    expected = np.interp(360.0 * shares, found.x, found.y("v"))
    assert len(shares) == SAMPLES
    assert np.array(rows["v"]["values"]) == pytest.approx(expected, abs=2e-3 * np.max(np.abs(expected)))
    assert rows["v"]["unit"] == "mm/s"


def test_poses_of_a_motion_to_and_fro_go_from_its_start_to_its_end():
    found = usual_sheet(load(str(FOLDER / "drives" / "boom.toml")))
    data = player_data(found, found.positions)
    assert (data["poses"][0], data["poses"][-1]) == (0.0, 1.0)
