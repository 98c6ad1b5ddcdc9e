"""``linkproof.evaluate``, ``results`` and ``optimise``: textbook formulas, and the values of the commands, labelled."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import linkproof
from reports.designs.labels import label
from tests.analytic.linkages import path_of
from tests.commands import linkproof as command

LINKAGES = Path(__file__).parents[2] / "linkages"
CRANK, ROD = 0.05, 0.2  # m, of the centric slider-crank
EXACT = {"rtol": 1e-12, "atol": 1e-14}


def test_the_stroke_of_a_slider_crank_is_the_textbooks():
    phi = np.array([0.0, 0.3, 2.0, 4.0])
    found = linkproof.evaluate(LINKAGES / "centric-slider-crank.toml", phi, ["S", "point_position", "v"], speed=60.0)
    angle = np.arcsin(CRANK / ROD * np.sin(phi))
    reached = CRANK * np.cos(phi) + ROD * np.cos(angle)
    away = CRANK * 2.0 * np.pi * np.sin(phi + angle) / np.cos(angle)  # at one turn a second
    assert np.allclose(found["S"], CRANK + ROD - reached, **EXACT)
    assert np.allclose(found["point_position"].sel(point="D", component="x"), reached, **EXACT)
    assert np.allclose(found["v"], away, **EXACT)
    assert list(found.data_vars) == ["S", "point_position", "v"]


@pytest.mark.parametrize("name", ["rimoldi-164", str(LINKAGES / "drives" / "linear-motor.toml")])
def test_every_quantity_is_that_of_results(name):
    expected = linkproof.results(name, linkproof.Motion(speed=12.0, regime="constant-speed")).dataset
    found = linkproof.evaluate(name, expected["phi"], speed=12.0)
    shared = [variable for variable in found if variable in expected and variable != "S"]
    assert {"Mkr", "Peq", "v", "a", "joint_force", "point_acceleration", "link_alpha", "shaking_moment"} <= {*shared}
    for variable in shared:
        size = float(np.abs(expected[variable]).max()) or 1.0
        assert np.allclose(found[variable].values, expected[variable].values, rtol=0.0, atol=1e-11 * size), variable
        assert found[variable].attrs == expected[variable].attrs
    assert np.allclose(found["S"].values, expected["S"].values, rtol=0.0, atol=1e-11)


def test_acceleration_and_speed_are_of_each_angle():
    phi, speed, rise = np.array([1.0, 1.0]), np.array([0.0, 60.0]), np.array([3.0, 0.0])
    found = linkproof.evaluate("juki-mf7923d", phi, ["Jeq", "Mkr", "joint_force"], speed=speed, acceleration=rise)
    still = linkproof.evaluate("juki-mf7923d", [1.0], ["Mkr", "joint_force"], speed=0.0)
    assert np.isclose(found["Mkr"][0], found["Jeq"][0] * 3.0 + still["Mkr"][0], rtol=1e-12)
    moving = linkproof.evaluate("juki-mf7923d", [1.0], ["joint_force"], speed=60.0)
    assert np.array_equal(found["joint_force"][..., 1], moving["joint_force"][..., 0])


def test_every_design_is_evaluated_by_itself():
    phi, rods = np.array([0.2, 1.5]), np.array([0.2, 0.25, 0.01])
    slider_crank = LINKAGES / "centric-slider-crank.toml"
    found = linkproof.evaluate(slider_crank, phi, ["v", "Jeq"], speed=60.0, designs={"rod.D.x": rods})
    assert found["v"].dims == ("design", "phi")
    assert found["rod.D.x"].values.tolist() == rods.tolist()
    alone = linkproof.evaluate(slider_crank, phi, ["v", "Jeq"], speed=60.0)
    assert np.allclose(found["Jeq"][0], alone["Jeq"], **EXACT)
    angle = np.arcsin(CRANK / 0.25 * np.sin(phi))
    assert np.allclose(found["v"][1], CRANK * 2.0 * np.pi * np.sin(phi + angle) / np.cos(angle), **EXACT)
    assert found["assembled"].values.tolist() == [[True, True], [True, True], [True, False]]
    assert np.isnan(found["v"][2, 1])


@pytest.mark.parametrize(
    ("words", "options", "sentence"),
    [
        (([0.0], "Mkr"), {}, "expected the crank's speed in rpm for Mkr, got none"),
        (([0.0], "omega"), {}, "unknown quantity 'omega'"),
        (([[0.0]], "Jeq"), {}, r"expected a flat list of finite crank angles, got shape \(1, 1\)"),
        (([], "Jeq"), {}, "expected a flat list of finite crank angles"),
        (([0.0], "S"), {"designs": {"coupler.D.x": [0.05]}}, "unknown quantity 'S'"),  # many designs have no stroke
    ],
)
def test_bad_input_is_refused(words, options, sentence):
    with pytest.raises(linkproof.LinkproofError, match=sentence):
        linkproof.evaluate("juki-mf7923d", *words, **options)


def test_every_signal_is_the_commands():
    document = json.loads(command("results", "juki-mf7923d", "--at", "0,90.5", "--no-gravity", "--json").stdout)
    found = linkproof.results("juki-mf7923d", linkproof.Motion(gravity=False), at=[0, 90.5]).dataset
    assert found.attrs["conditions"] == document["conditions"]
    assert found.sizes[document["axis"]] == len(document["values"]["time"])
    for name, values in document["values"].items():
        variable, dimension, part, component = label(name)
        chosen = {side: at for side, at in ((dimension, part), ("component", component)) if at}
        assert found[variable].sel(chosen).values.tolist() == values, name
        assert found[variable].attrs["units"] == document["units"][name], name


def test_words_of_signals_are_accepted_as_their_symbols_are():
    found = linkproof.results("juki-mf7923d")
    pairs = {"torque": "Mkr", "power": "Peq", "energy": "Teq", "inertia": "Jeq", "displacement": "S"}
    for word, symbol in pairs.items():
        assert found[word].identical(found.dataset[symbol])
        assert found[word].attrs["long_name"] == f"{word} ({symbol})"
    assert "Mkr.peak" in linkproof.sweep("juki-mf7923d", {"crank.mass": [0.6]}, "torque.peak").dataset
    with pytest.raises(linkproof.LinkproofError, match=r"unknown signal 'torqe': did you mean"):
        _ = found["torqe"]


def test_a_loaded_linkage_a_mapping_of_the_form_of_a_file_and_a_path_are_the_same():
    motor = path_of("linear-motor")
    linkage = linkproof.load(motor)
    expected = linkproof.results(motor).dataset
    assert linkproof.results(linkage).dataset.identical(expected)
    assert np.array_equal(linkproof.results(tomllib.loads(linkage.text))["Mkr"], expected["Mkr"])
    loaded = linkproof.results(linkproof.load("juki-mf7923d"), linkproof.Motion(variant="as-printed")).dataset
    assert loaded.identical(linkproof.results("juki-mf7923d", linkproof.Motion(variant="as-printed")).dataset)
