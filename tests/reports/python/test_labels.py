"""Every signal has its place among labelled arrays, whatever colons its name has."""

import numpy as np
import pytest

from analytic.description.loading import load
from reports.python.labels import Label, label, labelled


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("Mkr", Label("Mkr")),
        ("point:D:vx", Label("point_velocity", "point", "D", "x")),
        ("link:rod:alpha", Label("link_alpha", "link", "rod")),
        ("joint_force:A:K5:y", Label("joint_force", "joint", "A:K5", "y")),
        ("joint_force:A:K5:magnitude", Label("joint_force_magnitude", "joint", "A:K5")),
        ("shaking_force:x", Label("shaking_force", component="x")),
        ("transmission_angle:K2 + K3: x", Label("transmission_angle", "group", "K2 + K3: x")),
    ],
)
def test_a_signal_has_its_place(name, place):
    assert label(name) == place


def test_parts_and_components_keep_their_values_and_units():
    names = [f"joint_force:{joint}:{axis}" for joint in ("B", "A") for axis in "xy"]
    values = {name: np.array([10.0 * row, 10.0 * row + 1.0]) for row, name in enumerate(names)}
    found = labelled(load("juki-mf7923d"), "time", {"time": np.array([0.0, 0.5]), **values}, {"regime": "run-up"})
    assert found["joint_force"].dims == ("joint", "component", "time")
    assert found["joint_force"].sel(joint="A", component="y", time=0.5) == 31.0
    assert found["joint_force"].sel(joint="B", component="x").values.tolist() == [0.0, 1.0]
    assert (found["joint_force"].attrs["units"], found["time"].attrs["units"]) == ("N", "s")
    assert (found.attrs["mechanism"], found.attrs["regime"]) == ("juki-mf7923d", "run-up")
