"""``linkproof list MECHANISM``: the names for the commands about designs, with unit and value."""

import json

import pytest

from analytic.description.loading import load
from comparisons.designs.parameters import parameters
from tests.commands import linkproof, refused


def _listed(kind):
    document = json.loads(linkproof("list", "juki-mf7923d", "--json").stdout)
    return document["conditions"], {row["name"]: (row["value"], row["units"]) for row in document[kind]}


def test_every_figure_has_the_value_of_results_and_of_a_refined_sweep():
    conditions, figures = _listed("figures")
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
    numbers = _listed("numbers")[1]
    expected = {"crank.A.x": (15.5, "mm"), "coupler.mass": (0.03, "kg"), "gravity.y": (-9.81, "m/s^2")}
    assert {**expected, "output.along.y": (1.0, "")}.items() <= numbers.items()


@pytest.mark.parametrize("name", ["juki-mf7923d", "slotted-takeup", "andrews-squeezer"])
def test_a_number_that_is_printed_gives_the_value_back(name):
    shown = [row.split() for row in linkproof("list", name).stdout.partition("number  ")[2].splitlines()]
    texts = {row[0]: row[-1] for row in shown if len(row) > 1}
    for each in parameters(load(name)).values():
        assert each.si(texts[each.name]) == each.value, each.name


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("list", "juki"), "did you mean 'juki-mf7923d'?"),
        (("sweep", "juki-mf7923d", "--vary", "cuopler.mass=1:2:3"), "did you mean 'coupler.mass'"),
        (("sweep", "juki-mf7923d", "--vary", "coupler.mass=1:2:3", "--quantity", "torque"), "did you mean 'Mkr.peak'"),
        (("optimise", "juki-mf7923d", "--over", "mas=1:2", "--minimise", "a.peak"), "`linkproof list MECHANISM`"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_wrong_name_is_answered_with_the_nearest(words, answer):
    assert answer in refused(*words)
