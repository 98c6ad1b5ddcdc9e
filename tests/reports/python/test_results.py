"""``linkproof.results`` and ``optimise`` have the values of their commands, labelled, and take the same options."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray

import linkproof
from analytic.description.loading import load, parse
from reports.python.evaluation import Label, label, labelled
from tests.commands import linkproof as command

DRIVES = Path(__file__).parents[2] / "linkages" / "drives"
MOTOR = str(DRIVES / "linear-motor.toml")


@pytest.mark.parametrize(
    ("words", "options"),
    [
        (["rimoldi-164", "--speed", "1200", "--clockwise"], {"speed": 1200, "clockwise": True}),
        (["juki-mf7923d", "--at", "0,90.5", "--no-gravity"], {"at": [0, 90.5], "gravity": False}),
    ],
)
def test_every_signal_is_the_commands(words, options):
    document = json.loads(command("results", *words, "--json").stdout)
    found = linkproof.results(words[0], **options)
    assert found.attrs["conditions"] == document["conditions"]
    assert found.sizes[document["axis"]] == len(document["values"]["time"])
    for name, values in document["values"].items():
        variable, dimension, part, component = label(name)
        chosen = {side: at for side, at in ((dimension, part), ("component", component)) if at}
        assert found[variable].sel(chosen).values.tolist() == values, name
        assert found[variable].attrs["units"] == document["units"][name], name


def test_a_loaded_linkage_and_a_path_are_the_same():
    assert linkproof.results(MOTOR).identical(linkproof.results(linkproof.load(MOTOR)))
    loaded = linkproof.results(linkproof.load("juki-mf7923d"), variant="as-printed")
    assert loaded.identical(linkproof.results("juki-mf7923d", variant="as-printed"))


def test_results_are_saved_and_read_as_netcdf(tmp_path):
    found = linkproof.results("juki-mf7923d", at=[0, 45])
    found.to_netcdf(tmp_path / "juki.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "juki.nc", engine="scipy") as saved:
        assert np.array_equal(saved["joint_force"].sel(joint="A"), found["joint_force"].sel(joint="A"))


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
def test_a_signal_has_its_place_whatever_colons_its_name_has(name, place):
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


def test_an_optimum_has_the_numbers_and_figures_of_the_command():
    words = ["rimoldi-164", "--minimise", "Mkr.peak", "--over", "rod.B.x=172:178", "--over", "rocker.B.x=±5%"]
    words += ["--keep", "stroke=30.9:31", "--keep", "Jeq.mean"]
    document = json.loads(command("optimise", *words, "--json", "-q").stdout)
    over, keep = {"rod.B.x": (172, 178), "rocker.B.x": "±5%"}, {"stroke": (30.9, 31), "Jeq.mean": None}
    found = linkproof.optimise("rimoldi-164", minimise="Mkr.peak", over=over, keep=keep)
    for row in document["figures"]:
        scale = {"mm": 1e-3, "deg": 0.017453292519943295}.get(found[row["name"]].attrs["units"], 1.0)
        assert found[row["name"]].values * scale == pytest.approx([row["before"], row["after"]], rel=1e-14)
    for row in document["numbers"]:
        assert found[row["name"]].sel(design="after") * 1e-3 == pytest.approx(row["after"], rel=1e-14)
        assert found[row["name"]].attrs["low"] * 1e-3 == pytest.approx(row["low"], rel=1e-14)
    new = parse(found.attrs["toml"], "new", "new")
    assert new.links["rod"].points["B"][0] * 1e3 == pytest.approx(float(found["rod.B.x"][1]), rel=1e-14)
    assert found.attrs["residual"] < 1e-6
