"""What a look over a linkage finds: figures of independent formulas, and all that is right up to a fault."""

import json
import math

import numpy as np
import pytest

from analytic.description.loading import literature, load, parse
from analytic.errors import AssemblyError, StructureError
from comparisons.designer.linkage_check import check
from reports.designs.linkages import printed_facts
from reports.document.terminal import rendered
from tests.analytic.linkages import DOUBLE_ROCKER, EVERY, FAR, FOLDER, JUKI, four_bar, text_of


def folded(gap, one, two):
    """Transmission angle of a four-bar at a gap between A and B, by the law of cosines."""
    angle = math.acos((one**2 + two**2 - gap**2) / (2 * one * two))
    return min(angle, math.pi - angle)


def looked_over(text):
    return check(parse(text, "sample", "sample.toml"))


NIGHTLY = [pytest.param(*sample, marks=pytest.mark.nightly) for sample in EVERY[::2]]


@pytest.mark.parametrize(("name", "variant"), [*EVERY[1::2], *NIGHTLY])
def test_every_linkage_that_works_is_without_fault(name, variant):
    path = name if variant else f"tests/linkages/{name}.toml"
    linkage = load(path, variant) if variant else parse(text_of(name), name, path)
    facts, fault = check(linkage)
    assert fault is None
    assert facts["fault"] is None
    assert facts["mobility"]["degrees"] == 1
    assert [one for one in facts["warnings"] if "has no free length" not in one] == []  # one has none and says so
    assert json.loads(json.dumps(facts)) == facts


@pytest.mark.nightly
def test_the_linkages_of_the_literature_are_without_warnings():
    assert [name for name in literature() if check(load(name))[0]["warnings"]] == []


def test_where_rounding_decides_how_the_links_lie_no_bound_can_be_given():
    facts, _ = looked_over(FAR)
    assert set(facts["error_bound"].values()) == {None}
    assert "no error bound can be given" in rendered(*printed_facts(facts, str))


def test_transmission_angle_of_a_crank_rocker_is_least_with_the_crank_on_the_frame():
    facts, _ = looked_over(four_bar(0.1, 0.02, 0.1, 0.045, math.pi / 2))
    (found,) = facts["transmission"].values()
    assert found["least"] == pytest.approx(min(folded(80.0, 100.0, 45.0), folded(120.0, 100.0, 45.0)), abs=1e-9)
    assert found["where"] in ("0°", "180°")


def test_figures_of_a_full_turn():
    six_bar, slider = (check(load(*name))[0] for name in (("rimoldi-164", "as-printed"), ("juki-mf7923d",)))
    assert six_bar["Jeq"]["mean"] == pytest.approx(1.143e-4, rel=5e-4)
    assert six_bar["Jeq"]["max"] == pytest.approx(1.272e-4, rel=5e-4)
    assert sum(link["Jeq_mean"] for link in six_bar["links"].values()) == pytest.approx(six_bar["Jeq"]["mean"])
    assert (slider["source"], slider["variants"]) == (load("juki-mf7923d").source, ["as-built", "as-printed"])
    assert slider["links"]["crank"]["mass"] == 0.64
    assert slider["output"]["stroke"] == pytest.approx(2 * 15.5e-3, rel=1e-12)
    assert math.degrees(slider["output"]["top_dead_centre"]) == pytest.approx(90.0)
    assert math.degrees(slider["output"]["bottom_dead_centre"]) == pytest.approx(270.0)


def test_without_a_full_turn_or_without_masses_there_is_less():
    facts, _ = looked_over(JUKI.replace("D = [54.5, 0]", "D = [10, 0]").replace("angle  = 0", "angle  = 90"))
    assert math.cos(facts["range"]["low"]) == pytest.approx(10.0 / 15.5)
    assert not {"Jeq", "output", "equilibria"} & set(facts)
    assert facts["closure_error"] < 1e-15  # m, over the range short of its ends
    facts, _ = looked_over("\n".join(row for row in JUKI.splitlines() if not row.startswith(("mass ", "inertia "))))
    assert "Jeq" not in facts
    assert facts["output"]["stroke"] == pytest.approx(31e-3)


def test_of_a_swing_where_the_transmission_angle_is_good():
    facts, _ = looked_over(DOUBLE_ROCKER)
    (found,) = facts["transmission"].values()
    assert found["least"] == pytest.approx(0.0, abs=1e-3)
    for end in found["good"]:
        gap = math.sqrt(100**2 + 80**2 - 2 * 100 * 80 * math.cos(end))
        assert math.degrees(folded(gap, 60.0, 90.0)) == pytest.approx(40.0, abs=1e-6)


def test_a_range_may_end_at_parallel_guides():
    facts, fault = check(load(str(FOLDER / "designer" / "S_negative.toml")))
    assert fault is None
    assert np.degrees([facts["range"]["low"], facts["range"]["high"]]) == pytest.approx([-40.2187, 139.7813], abs=1e-4)
    (found,) = facts["transmission"].values()
    assert np.degrees(found["good"]) == pytest.approx([-0.2187, 99.7813], abs=1e-4)  # 40° inside either end


def test_a_point_that_is_not_pinned_leaves_mobility_and_a_fault():
    facts, fault = looked_over(DOUBLE_ROCKER.replace("C = [60, 0]", "c = [60, 0]"))
    assert isinstance(fault, StructureError)
    assert facts["fault"] == str(fault)
    assert "expected mobility 1, got 3" in str(fault)
    assert facts["mobility"] == {"degrees": 3, "formula": "3 = 3·3 links - 2·3 pins and slides"}
    assert facts["loose_points"] == ["C", "c"]
    assert facts["structure"] == "I (crank) -> ?"
    assert "range" not in facts


def test_a_sketch_out_of_reach_leaves_mobility_and_a_fault():
    facts, fault = looked_over(DOUBLE_ROCKER.replace("angle = 70", "angle = 0"))
    assert isinstance(fault, AssemblyError)
    assert facts["structure"] == "I (crank) -> coupler + rocker (RRR)"
    assert facts["four_bar"].startswith("Grashof double-rocker")
    assert "range" not in facts


def test_change_points_of_a_parallelogram():
    facts, fault = looked_over(text_of("parallelogram"))
    assert fault is None
    assert [point["where"] for point in facts["range"]["change_points"]] == ["180°", "0°"]
    assert facts["four_bar"].startswith("change-point four-bar")


# Beside those in tests/reports/command_line/test_usual_mistakes.py.
