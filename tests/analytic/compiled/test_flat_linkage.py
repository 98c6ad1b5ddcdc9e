"""The flat tables: every number of the description once, by name, and found again."""

import subprocess
import sys

import numpy as np
import pytest
from analytic.compiled.flat_linkage import CONSTANT, GROUND_BODY, flatten, levels, redesigned

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.dynamics.derivative_orders import needs
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import from_text, mechanism, text_of
from tests.analytic.loaded_linkages import ALL, on_trial
from tests.analytic.tolerances import EPS

NUDGE = 1e-4  # of every number: the linkage stays what it is, and no two numbers stay alike


def plain(value: object) -> object:
    """A description as nested lists of names and numbers, which can be compared; directions stay numbers."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__}
    if isinstance(value, tuple | list):
        return [plain(part) for part in value]
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    return value


def flattened(value: object) -> list[float]:
    """All numbers of a description, in its order."""
    if isinstance(value, dict):
        return [number for part in value.values() for number in flattened(part)]
    if isinstance(value, list):
        return [number for part in value for number in flattened(part)]
    return [value] if isinstance(value, float) else []


@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_a_description_is_found_again(case, is_laden):
    sample = on_trial(*case, is_laden)
    flat = flatten(sample)
    again = redesigned(flat, flat.numbers)
    assert isinstance(again, Linkage)
    assert np.allclose(flattened(plain(again)), flattened(plain(sample.linkage)), rtol=4 * EPS, atol=0.0)


@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_every_number_has_one_place(case, is_laden):
    sample = on_trial(*case, is_laden)
    flat = flatten(sample)
    factors = 1.0 + NUDGE * np.random.default_rng(1).uniform(0.5, 1.5, len(flat.numbers))
    for name, place in flat.places.items():
        if ".along." in name:
            factors[place] = 1.0
    nudged = flatten(Mechanism(redesigned(flat, flat.numbers * factors)))
    assert nudged.places == flat.places
    assert sorted(flat.places.values()) == list(range(2, len(flat.numbers)))
    assert np.allclose(nudged.numbers, flat.numbers * factors, rtol=4 * EPS, atol=0.0)
    for one, two in zip(nudged.tables[:-1], flat.tables[:-1], strict=True):
        assert np.array_equal(one, two)


def test_names_are_those_of_the_file():
    flat = flatten(mechanism("rimoldi-164"))
    link = flat.linkage.links["rod"]
    assert flat.numbers[flat.places["rod.B.x"]] == link.points["B"][0]
    assert flat.numbers[flat.places["rod.mass"]] == link.mass
    assert flat.numbers[flat.places["rod.centre.x"]] == link.centre[0]
    assert flat.numbers[flat.places["rod.inertia"]] == link.inertia
    assert flat.numbers[flat.places["ground.O2.y"]] == flat.linkage.ground["O2"][1]
    assert flat.numbers[flat.places["needle_bar.through.x"]] == flat.linkage.sliders[0].guide.through[0]
    assert flat.numbers[flat.places["gravity.y"]] == flat.linkage.gravity[1]
    assert flat.numbers[flat.places["output.along.y"]] == 1.0
    assert "needle_bar.inertia" not in flat.places  # it cannot turn
    assert "A in rocker.along.y" in flatten(mechanism("slot-without-mass")).places
    laden = flatten(mechanism("spring-and-damper")).places
    assert {name.split(".")[0] for name in laden} >= {"springs", "dampers"}


def test_a_second_load_of_a_name_is_counted_and_a_mass_centre_keeps_its_own():
    text = text_of("centric-slider-crank")
    text = text.replace("points  = { ", "points  = { centre = [1, 2], ", 1)
    force = '[[forces]]\npoint = "centre"\nforce = [1, {}]\n'
    sample = from_text(text + force.format(2) + force.format(3))
    places, numbers = flatten(sample).places, flatten(sample).numbers
    (link,) = (name for name, link in sample.linkage.links.items() if "centre" in link.points)
    assert numbers[places[f"{link}.centre.x"]] == sample.linkage.links[link].centre[0]
    assert numbers[places[f"{link}.centre.x #2"]] == sample.linkage.links[link].points["centre"][0]
    assert {numbers[places["forces.centre.y"]], numbers[places["forces.centre.y #2"]]} == {2.0, 3.0}


def test_laws_are_kept_as_piecewise_cubics():
    sample = on_trial("rimoldi-164", "as-built", True)
    tables = flatten(sample).tables
    laws = [load.force for load in sample.linkage.forces] + [load.torque for load in sample.linkage.torques]
    assert any(law.is_constant for law in laws)
    assert not all(law.is_constant for law in laws)
    for law, (pieces, components, start) in zip(laws, tables.laws, strict=True):
        assert (pieces == CONSTANT) == law.is_constant
        if pieces == CONSTANT:
            continue
        knots = tables.curves[start : start + pieces + 1]
        cubics = tables.curves[start + pieces + 1 :][: 4 * pieces * components].reshape(pieces, components, 4)
        assert knots[-1] - knots[0] == pytest.approx(FULL_TURN)
        for piece in range(pieces):
            inside = np.linspace(knots[piece], knots[piece + 1], 5)
            values = [np.polyval(cubic, inside - knots[piece]) for cubic in cubics[piece]]
            assert np.allclose(values, law(inside), rtol=1e3 * EPS, atol=1e3 * EPS * np.abs(law.values).max())


@pytest.mark.parametrize(
    ("quantities", "turns", "expected"),
    [
        (["S"], False, [0, 0]),
        (["v"], True, [1, 1]),
        (["Jeq"], False, [1, 1]),
        (["Q"], False, [1, 1]),
        (["Mkr"], True, [2, 2]),
        (["Mkr"], False, [1, 1]),
        (["half_slope"], False, [2, 2]),
        ([], False, [-1, -1]),
    ],
)
def test_no_derivative_is_planned_that_nobody_asks_for(quantities, turns, expected):
    sample = mechanism("rimoldi-164")
    orders = needs(sample.linkage, quantities, turns=turns).orders
    assert levels(sample.structure, orders).tolist() == expected


def test_dyads_behind_the_one_needed_are_left_out():
    sample = mechanism("rimoldi-164")
    assert levels(sample.structure, {"rocker": 1}).tolist() == [1, -1]
    assert levels(sample.structure, {"needle_bar": 0, "rod": 1}).tolist() == [1, 0]


def test_what_weighs_nothing_is_not_asked_for():
    sample = mechanism("rimoldi-164")
    flat = flatten(sample)
    numbers = flat.numbers.copy()
    for name, place in flat.places.items():
        if name.endswith((".mass", ".inertia")) and not name.startswith(("crank", "rod", "rocker")):
            numbers[place] = 0.0
    light = redesigned(flat, numbers)
    assert levels(flat.structure, needs(light, ["Mkr"], turns=True).orders).tolist() == [2, -1]


def test_without_an_output_the_tables_name_the_ground():
    text = text_of("centric-slider-crank").replace('output  = { point = "D" }\n', "")
    flat = flatten(from_text(text))
    assert flat.linkage.output is None
    assert flat.tables.output.tolist() == [GROUND_BODY, 0, 0]
    assert redesigned(flat, flat.numbers).output is None


def test_neither_the_tables_nor_small_evaluations_import_numba():
    code = (
        "import sys, numpy as np\n"
        "from analytic import evaluation\n"
        "from analytic.designs import values\n"
        "from analytic.compiled import choice, flat_linkage\n"
        "from analytic.description.loading import load\n"
        "from analytic.kinematics.mechanism import Mechanism\n"
        "sample = Mechanism(load('juki-mf7923d'))\n"
        "flat_linkage.flatten(sample)\n"
        "evaluation.evaluate(sample, np.linspace(0.0, 6.0, 1000), ['Mkr'], speed=1.0)\n"
        "values.evaluate_designs(sample, {'crank.mass': np.ones(3)}, np.linspace(0.0, 6.0, 9), ['Jeq'])\n"
        "choice.is_installed()\n"
        "assert 'numba' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)
