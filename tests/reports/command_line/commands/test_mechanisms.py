"""``linkproof list --figures`` and ``--numbers``: the names for the commands about designs, with unit and value."""

import json

import pytest

from tests.commands import linkproof, refused


def _listed(option, name):
    document = json.loads(linkproof("list", option, name, "--json").stdout)
    return document["conditions"], {row["name"]: (row["value"], row["units"]) for row in document["records"]}


def test_every_figure_has_the_value_of_results_and_of_a_refined_sweep():
    conditions, figures = _listed("--figures", "juki-mf7923d")
    assert "constant-speed, 1000 rpm counter-clockwise" in conditions
    drive, *_ = json.loads(linkproof("results", "juki-mf7923d", "--json").stdout)["figures"]["drive"]
    assert figures["Mkr.peak"] == (pytest.approx(abs(drive["value"]), rel=1e-9), "N*m")
    names = ("stroke", "joint_force:A.rms", "link:coupler:omega.range", "Jeq.mean")
    words = [word for name in names for word in ("--quantity", name)]
    vary = ("--vary", "crank.A.x=15.5:15.5:1", "--refine", "--json")
    swept = json.loads(linkproof("sweep", "juki-mf7923d", *vary, *words).stdout)["figures"]
    for name in names:
        assert figures[name] == (pytest.approx(swept[name]["least"]["value"], rel=1e-12), swept[name]["units"])


def test_every_number_has_the_value_and_the_unit_of_the_file():
    numbers = _listed("--numbers", "juki-mf7923d")[1]
    expected = {"crank.A.x": (15.5, "mm"), "coupler.mass": (0.03, "kg"), "gravity.y": (-9.81, "m/s^2")}
    assert {**expected, "output.along.y": (1.0, "")}.items() <= numbers.items()
    shown = linkproof("list", "--numbers", "juki-mf7923d").stdout.splitlines()
    assert shown[0].startswith("juki-mf7923d (as-built); speed, rpm, may be varied too")
    assert ["coupler.mass", "kg", "0.03"] in [row.split() for row in shown]


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("list", "--figures", "juki"), "did you mean 'juki-mf7923d'?"),
        (("list", "--figures", "juki-mf7923d", "--numbers", "juki-mf7923d"), "give one of them"),
        (("sweep", "juki-mf7923d", "--vary", "cuopler.mass=1:2:3"), "did you mean 'coupler.mass'"),
        (("sweep", "juki-mf7923d", "--vary", "coupler.mass=1:2:3", "--quantity", "torque"), "did you mean 'Mkr.peak'"),
        (("optimise", "juki-mf7923d", "--over", "mas=1:2", "--minimise", "a.peak"), "`linkproof list --numbers`"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_wrong_name_is_answered_with_the_nearest(words, answer):
    assert answer in refused(*words)
