"""``linkproof.results`` says what the command says, and takes its words."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import linkproof
from reports.command_line.app import app
from reports.python.labels import label

DRIVES = Path(__file__).parents[2] / "linkages" / "drives"


def _told(*words):
    return json.loads(CliRunner().invoke(app, ["results", *words, "--json", "-"]).stdout)


@pytest.mark.parametrize(
    ("words", "options"),
    [
        (["rimoldi-164", "--speed", "1200", "--clockwise"], {"speed": 1200, "clockwise": True}),
        (["juki-mf7923d", "--regime", "run-up", "--time", "0.1"], {"regime": "run-up", "time": (0.1,)}),
        (["juki-mf7923d", "--at", "0,90.5", "--no-gravity"], {"at": [0, 90.5], "gravity": False}),
        (["juki-mf7923d", "--from", "10", "--to", "70"], {"from_angle": 10, "to_angle": 70}),
        ([str(DRIVES / "linear-motor.toml"), "--speed", "12"], {"speed": 12}),
    ],
)  # fmt: skip
def test_every_signal_is_the_commands(words, options):
    told, found = _told(*words), linkproof.results(words[0], **options)
    assert found.attrs["conditions"] == told["conditions"]
    assert found.sizes[told["axis"]] == len(told["values"]["time"])
    for name, values in told["values"].items():
        variable, dimension, part, component = label(name)
        chosen = {side: at for side, at in ((dimension, part), ("component", component)) if at}
        assert found[variable].sel(chosen).values.tolist() == values, name
        assert found[variable].attrs["units"] == told["units"][name], name


def test_a_loaded_linkage_and_a_path_are_the_same():
    path = DRIVES / "linear-motor.toml"
    assert linkproof.results(path).identical(linkproof.results(linkproof.load(path)))


def test_a_linkage_as_it_is_can_have_another_variant():
    loaded = linkproof.results(linkproof.load("juki-mf7923d"), variant="as-printed")
    assert loaded.identical(linkproof.results("juki-mf7923d", variant="as-printed"))


def test_it_is_saved_and_read_as_netcdf(tmp_path):
    import xarray  # noqa: PLC0415

    found = linkproof.results("juki-mf7923d", at=[0, 45])
    found.to_netcdf(tmp_path / "juki.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "juki.nc", engine="scipy") as saved:
        assert np.array_equal(saved["joint_force"].sel(joint="A"), found["joint_force"].sel(joint="A"))


def test_what_the_command_refuses_is_an_error():
    with pytest.raises(linkproof.LinkproofError, match="--at and --time both"):
        linkproof.results("juki-mf7923d", at=[0], time=[0])


def test_no_figure_is_drawn_to_know_results():
    code = "import sys, linkproof; linkproof.results; print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
