"""The portrait of a mechanism: figures of an independent closed form, and structure in words."""

import json
import math

import pytest
from comparisons.datasheet.mechanism_summary import portrait

from analytic.description.loading import find, load, parse
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.chains import chain_of_dyads
from tests.counting import calls


def test_figures_and_structure():
    facts = portrait(load("rimoldi-164", "as-printed"))
    assert facts["Jeq"]["mean"] == pytest.approx(1.143e-4, rel=5e-4)
    assert facts["Jeq"]["max"] == pytest.approx(1.272e-4, rel=5e-4)
    assert facts["structure"] == "I (crank) -> rocker + rod (RRR) -> link + needle_bar (RRP)"
    assert set(facts["signs"].values()) <= {1, -1}
    assert facts["closure_error"] < 1e-15
    assert facts["error_bound"]["second"] < 1e-11
    assert json.loads(json.dumps(facts, allow_nan=False)) == facts


def test_the_crank_slider_has_twice_its_crank_as_stroke():
    facts = portrait(load("juki-mf7923d"))
    assert facts["output"]["stroke"] == pytest.approx(2 * 15.5e-3, rel=1e-12)
    assert facts["output"]["top_dead_centre"] == pytest.approx(90.0)
    assert facts["output"]["bottom_dead_centre"] == pytest.approx(270.0)


def test_a_linkage_that_cannot_turn_has_a_range_in_place_of_the_figures_of_a_turn():
    text = find("juki-mf7923d").read_text().replace("D = [54.5, 0]", "D = [10, 0]")
    facts = portrait(parse(text.replace("angle  = 0", "angle  = 90"), "short", "short.toml"))
    assert math.cos(facts["range"]["low"]) == pytest.approx(10.0 / 15.5)
    assert not {"Jeq", "output", "equilibria", "closure_error"} & set(facts)
    assert facts["links"]["crank"]["mass"] == 0.64


def test_a_linkage_without_masses_has_no_reduced_inertia():
    text = find("juki-mf7923d").read_text()
    massless = "\n".join(line for line in text.splitlines() if not line.startswith(("mass ", "inertia ")))
    facts = portrait(parse(massless, "light", "light.toml"))
    assert "Jeq" not in facts
    assert facts["output"]["stroke"] == pytest.approx(31e-3)


def test_a_turn_is_swept_as_often_however_many_links_there_are(monkeypatch):
    sweeps, counts = calls(monkeypatch, Mechanism, "sweep"), []
    for dyads in (3, 15):
        sweeps.clear()
        portrait(parse(chain_of_dyads(dyads), "chain", "chain.toml"))
        counts.append(len(sweeps))
    assert counts[1] < 3 * counts[0]  # which has room for two more equilibria, not for 24 more links
