"""A data sheet in the units of its file, over the crank angle of a turn."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.loading import load
from comparisons.case import Case
from comparisons.datasheet.building import page_sheet, usual_sheet
from comparisons.datasheet.curves import SignalFigure
from reports.mechanism.page import SAMPLES, player_data
from reports.mechanism.shown import words
from tests.analytic.linkages import FOLDER, from_text
from tests.reports.designs.samples import CRANK, ROD, SPEED, piston_text


def shown(speed=SPEED, start=0.0, length="mm", metres=1e-3):
    motion = CrankMotion("constant-speed", (Segment(0.0, 2.0 * math.pi / abs(speed), (start, speed)),))
    return page_sheet(Case(from_text(piston_text(length, metres)), motion))


@pytest.mark.parametrize(("speed", "start"), [(SPEED, 0.0), (-SPEED, 0.0), (SPEED, 2.0), (-SPEED, 1.0)])
def test_a_turn_is_shown_from_0_to_360_degrees_however_it_is_made(speed, start):
    found = shown(speed, start)
    assert found.is_turn
    assert np.all(np.diff(found.x) > 0.0)
    assert found.x[-1] - found.x[0] == pytest.approx(360.0)
    phi = np.radians(found.x)
    place = 1e3 * (CRANK * np.cos(phi) + np.sqrt(ROD**2 - (CRANK * np.sin(phi)) ** 2))
    travel = (place - np.min(place)) if abs(found.y("S")[0] - np.ptp(place)) < 1.0 else np.max(place) - place
    assert found.y("S") == pytest.approx(travel, abs=1e-3)


@pytest.mark.parametrize(
    ("length", "metres", "one", "text"),
    [
        ("mm", 1e-3, SignalFigure("stroke", "S", 0.1, "m"), "100.0 mm"),
        ("m", 1.0, SignalFigure("stroke", "S", 0.1, "m"), "0.1000 m"),
        ("mm", 1e-3, SignalFigure("peak a", "a", -2.0, "m/s²"), "−2000 mm/s²"),
        ("mm", 1e-3, SignalFigure("peak v", "v", 1e-13, "m/s"), "0 mm/s"),  # rounding beside its signal
        ("mm", 1e-3, SignalFigure("A", "joint_force:A:magnitude", None, "N"), "–"),
    ],
)
def test_a_figure_stands_in_the_units_of_the_file(length, metres, one, text):
    assert words(shown(length=length, metres=metres), one) == text


@pytest.fixture(scope="module")
def boom():
    return usual_sheet(load(str(FOLDER / "drives" / "boom.toml")))


def test_a_range_is_shown_in_the_units_of_its_file_and_is_no_turn(boom):
    assert not boom.is_turn
    assert np.all(np.diff(boom.x) > 0.0)


# What a player is given: a place on the figures, a pose of the drawing and the signals, instant by instant.


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


def test_poses_of_a_motion_to_and_fro_go_from_its_start_to_its_end(boom):
    data = player_data(boom, boom.positions)
    assert (data["poses"][0], data["poses"][-1]) == (0.0, 1.0)
