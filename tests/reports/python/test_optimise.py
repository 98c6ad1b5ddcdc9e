"""``linkproof.optimise`` says what the command says, and takes its words."""

import json

import pytest
from typer.testing import CliRunner

import linkproof
from analytic.description.loading import parse
from reports.command_line import designs_app
from reports.command_line.app import app


def test_numbers_and_figures_are_the_commands():
    assert designs_app.optimise
    words = ["rimoldi-164", "--minimise", "Mkr.peak", "--over", "rod.B.x=172:178", "--over", "rocker.B.x=±5%"]
    words += ["--keep", "stroke=30.9:31", "--keep", "Jeq.mean"]
    told = json.loads(CliRunner().invoke(app, ["optimise", *words, "--json", "-", "-q"]).stdout)
    keep = {"stroke": (30.9, 31), "Jeq.mean": None}
    found = linkproof.optimise(
        "rimoldi-164", minimise="Mkr.peak", over={"rod.B.x": (172, 178), "rocker.B.x": "±5%"}, keep=keep
    )
    for one in told["figures"]:
        scale = {"mm": 1e-3, "deg": 0.017453292519943295}.get(found[one["name"]].attrs["units"], 1.0)
        assert found[one["name"]].values * scale == pytest.approx([one["before"], one["after"]], rel=1e-14)
    for one in told["numbers"]:
        assert found[one["name"]].sel(design="after") * 1e-3 == pytest.approx(one["after"], rel=1e-14)
        assert found[one["name"]].attrs["low"] * 1e-3 == pytest.approx(one["low"], rel=1e-14)
    new = parse(found.attrs["toml"], "new", "new")
    assert new.links["rod"].points["B"][0] * 1e3 == pytest.approx(float(found["rod.B.x"][1]), rel=1e-14)
    assert found.attrs["residual"] < 1e-6


def test_what_cannot_be_is_said():
    with pytest.raises(linkproof.LinkproofError, match="got neither"):
        linkproof.optimise("rimoldi-164", over={"rod.B.x": (170, 180)})
