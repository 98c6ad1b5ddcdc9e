"""Many designs at once: those of a loop over linkages built one by one, and nan where a design cannot be built."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description.changes import design_numbers, with_numbers
from analytic.designs.values import ASSEMBLED, evaluate_designs
from analytic.dynamics import reduced
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.evaluation import evaluate
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.sweep import Sweep
from analytic.machine_code import compiling
from analytic.machine_code.linkage_trace import is_traceable
from analytic.moving import MovingSweep
from analytic.signals import signal, table
from tests.analytic.linkages import FourBar, four_bars, from_text, mechanism, text_of
from tests.analytic.loaded_linkages import ALL, on_trial

PATHS = ("numpy", pytest.param("compiled", marks=pytest.mark.skipif(not compiling.is_installed(), reason="no numba")))
# Two orders of the same operations; relative to the peak.
SAME = 1e-14
# A linkage written to a file and read again has figures that are a rounding off.
WRITTEN = 1e-12
TINY = 1e-300


@pytest.mark.parametrize("path", PATHS)
@given(sample=four_bars(), seed=st.integers(0, 2**32))
@settings(max_examples=15)
def test_designs_are_a_loop_over_linkages(path, sample, seed):
    """The linkages are written out as files, each with its own figures."""
    draw = np.random.default_rng(seed)
    lengths = np.array([sample.frame, sample.crank, sample.coupler, sample.rocker]) * draw.uniform(0.98, 1.02, (4, 4))
    inertias = sample.inertias * draw.uniform(0.5, 1.5, (4, *sample.inertias.shape))
    angle = draw.uniform(-7.0, 7.0, 5)
    parameters = {"ground.O2.x": lengths[:, 0], "crank.A.x": lengths[:, 1]}
    parameters |= {"coupler.B.x": lengths[:, 2], "rocker.B.x": lengths[:, 3]}
    for number, link in enumerate(("crank", "coupler", "rocker")):
        for column, name in enumerate(("mass", "centre.x", "centre.y", "inertia")):
            parameters[f"{link}.{name}"] = inertias[:, number, column]
    names, moves = ["Jeq", "Mkr", "half_slope", "Q"], {"speed": 3.0, "acceleration": np.arange(5.0)}
    found = evaluate_designs(from_text(sample.text()), parameters, angle, names, **moves, path=path)
    for number in range(4):
        built = from_text(FourBar(tuple(lengths[number]), inertias[number], sample.mode).text())
        expected = evaluate(built, angle, names, **moves, path="numpy")
        turn = evaluate(built, built.turn.angle, names, speed=3.0, acceleration=4.0, path="numpy")
        assert np.all(found[ASSEMBLED][number])
        for name, values in expected.items():
            atol = WRITTEN * np.max(np.abs(turn[name]))
            assert np.allclose(found[name][number], values, rtol=0.0, atol=atol)


def perturbed(sample, seed, count, share):
    """Parameters for every number of a linkage, each changed by a share of itself or of the drawing's size."""
    draw, parameters = np.random.default_rng(seed), {}
    for name, (_, value) in design_numbers(sample.linkage).items():
        values = value * (1.0 + share * draw.normal(size=count))
        if not name.endswith((".mass", ".inertia", ".stiffness", ".damping", ".coefficient")):
            values += share * sample.linkage.extent() * draw.normal(size=count) * (".along." not in name)
        parameters[name] = np.abs(values) if name.endswith((".mass", ".inertia")) else values
    return parameters


def design(sample, parameters, number):
    """One of the designs as a linkage with its structure, in the assembly modes of the original."""
    linkage = with_numbers(sample.linkage, {name: float(values[number]) for name, values in parameters.items()})
    return linkage, find_structure(linkage).with_signs(tuple(dyad.sign for dyad in sample.structure.dyads))


@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_every_number_of_every_linkage_may_vary(case, is_laden):
    """Against linkages built one by one, whose formulas get plain numbers."""
    sample = on_trial(*case, is_laden)
    if not is_traceable(sample):
        return
    angle = np.random.default_rng(4).uniform(-7.0, 7.0, 30)
    parameters, names = perturbed(sample, 5, 6, 0.04), every_signal(sample)
    found = evaluate_designs(sample, parameters, angle, names, speed=4.0, acceleration=np.cos(angle), path="numpy")
    assert np.any(found[ASSEMBLED])
    for number in range(6):
        (linkage, structure), moving = design(sample, parameters, number), found[ASSEMBLED][number]
        at = MovingSweep(sample, Sweep(linkage, structure, angle[moving]), 4.0, np.cos(angle[moving]))
        for name in names if np.any(moving) else ():
            expected = signal(at, name)
            assert np.all(np.isnan(found[name][number, ~moving]))
            peak = np.max(np.abs(expected))
            np.testing.assert_allclose(
                found[name][number, moving], expected, rtol=0.0, atol=SAME * peak + TINY, err_msg=name
            )


def every_signal(sample):
    """All signals but S and those that go on from turn to turn, which count from what else there is."""
    return [name for name in table(sample) if name != "S" and not name.endswith(":angle")]


@pytest.mark.skipif(not compiling.is_installed(), reason="numba is not installed")
@pytest.mark.parametrize(
    "case", [("rimoldi-164", None), ("carriage and crossed blocks", None), ("pin in two slots", None)]
)
def test_machine_code_gives_what_numpy_gives(case):
    sample, angle = on_trial(*case, True), np.random.default_rng(6).uniform(-7.0, 7.0, 40)
    parameters = perturbed(sample, 7, 12, 0.3)
    motion = {"speed": 4.0, "acceleration": np.cos(angle)}
    found, expected = (
        evaluate_designs(sample, parameters, angle, every_signal(sample), **motion, path=path)
        for path in ("compiled", "numpy")
    )
    assert np.array_equal(found[ASSEMBLED], expected[ASSEMBLED])
    assert 0 < np.count_nonzero(found[ASSEMBLED]) < found[ASSEMBLED].size
    for name, values in expected.items():
        scale = np.nanmax(np.abs(values), axis=-1, keepdims=True, initial=0.0) if name != ASSEMBLED else 1.0
        assert np.array_equal(np.isnan(found[name]), np.isnan(values))
        assert np.nanmax(np.abs(found[name] * 1.0 - values) - SAME * scale) <= 0.0, name


@pytest.mark.parametrize("path", PATHS)
def test_a_design_that_cannot_be_assembled_is_nan_exactly_there(path):
    sample, angle = mechanism("rimoldi-164"), np.linspace(0.0, 6.0, 50)
    parameters = {"rod.B.x": sample.linkage.links["rod"].points["B"][0] * np.array([0.5, 0.9, 1.0, 1.1])}
    found = evaluate_designs(sample, parameters, angle, ["Jeq", "S"], path=path)
    assert found[ASSEMBLED].dtype == np.bool_
    assert np.mean(found[ASSEMBLED], axis=1)[[0, 2]].tolist() == [0.0, 1.0]
    for number, row in enumerate(found[ASSEMBLED]):
        built = design(sample, parameters, number)
        for place, moves in enumerate(row):
            sweep = Sweep(*built, angle[place])
            if moves:
                expected = float(reduced.reduced_inertia(sweep))
                assert found["Jeq"][number, place] == pytest.approx(expected, rel=WRITTEN)
            else:
                with pytest.raises(AssemblyError):
                    reduced.reduced_inertia(sweep)
                assert np.isnan(found["Jeq"][number, place])
                assert np.isnan(found["S"][number, place])


def _coinciding_pins():
    """RRR with equal arms whose outer pins meet at 0°, and arms of different length that then cannot meet."""
    text = FourBar((0.06, 0.02, 0.05, 0.05), np.full((3, 4), 0.01), 1).text()
    output = 'output = { point = "B", along = [1, 0] }'
    sample = from_text(text.replace('crank = "crank"', f'crank = "crank"\n{output}'))
    same = {"ground.O2.x": [0.02, 0.02], "crank.A.x": [0.02, 0.02], "rocker.B.x": [0.05, 0.049]}
    return sample, same, [0.0, 0.3], [[False, True], [False, True]]


def _pin_on_pivot():
    """RPR: a slot through the rocker's pivot, which the crank pin passes over at 30°; then a slot beside it."""
    sample = mechanism("slot-without-mass")
    crank, pivot = sample.linkage.links["crank"].points["A"][0], sample.linkage.links["rocker"].points["O2"]
    on_circle = {"ground.O2.x": [crank * np.cos(np.pi / 6)] * 2, "ground.O2.y": [crank * np.sin(np.pi / 6)] * 2}
    slot = {"A in rocker.through.x": [pivot[0]] * 2, "A in rocker.through.y": [pivot[1], pivot[1] + 0.004]}
    straight = {"A in rocker.along.x": [1.0] * 2, "A in rocker.along.y": [0.0] * 2}
    return (
        sample,
        on_circle | slot | straight,
        [np.pi / 6, np.pi / 6 + 0.1, 2.0],
        [[False, True, True], [False, False, True]],
    )


def _arm_too_short():
    """RRP: a rod shorter than the slider's line is far away at 90°."""
    sample = mechanism("centric-slider-crank")
    return sample, {"rod.D.x": [0.04, 0.06]}, [0.1, np.pi / 2], [[True, False], [True, True]]


def _parallel_guides_rpp():
    """The yoke's slot along its own guide, or almost."""
    slot = {"A in yoke.along.x": np.ones(3), "A in yoke.along.y": [0.0, 1e-9, 1e-6]}
    return mechanism("scotch-yoke"), slot, [0.3], [[False], [False], [True]]


def _parallel_guides_prp():
    """The slot in the shaper's rocker parallel to the ram's guide at 1 rad."""
    sample = mechanism("shaper")
    _, _, c, s = sample.sweep(1.0).poses("rocker")
    ex, ey = next(slider.guide.along for slider in sample.linkage.sliders if slider.link == "ram")
    slot = {"F in rocker.along.x": [c * ex + s * ey], "F in rocker.along.y": [c * ey - s * ex]}
    return sample, slot, [1.0, 1.3], [[False, True]]


SINGULAR = (_coinciding_pins, _pin_on_pivot, _arm_too_short, _parallel_guides_rpp, _parallel_guides_prp)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("case", SINGULAR)
@pytest.mark.parametrize("name", ["S", "Jeq"])
def test_places_without_motion_are_found_by_hand(path, case, name):
    sample, parameters, angle, expected = case()
    found = evaluate_designs(sample, parameters, angle, [name], path=path)
    assert found[ASSEMBLED].tolist() == expected
    assert np.isnan(found[name]).tolist() == np.logical_not(expected).tolist()


def _almost_square():
    """RRP: a rod as long as the crank, square to the slider's line but for 30 nanoradians."""
    return mechanism("centric-slider-crank"), {"rod.D.x": [0.05]}, [np.pi / 2 - 3e-8, np.pi / 2 - 1e-3]


def _almost_at_the_foot():
    """RPR: the crank pin a hair farther from the rocker's pivot than the slot is offset from it."""
    sample = mechanism("slot-without-mass")
    crank, pivot = sample.linkage.links["crank"].points["A"][0], sample.linkage.links["rocker"].points["O2"]
    places = {
        "ground.O2.x": [crank],
        "ground.O2.y": [-0.004],
        "A in rocker.along.x": [1.0],
        "A in rocker.along.y": [0.0],
    }
    through = {"A in rocker.through.x": [pivot[0]], "A in rocker.through.y": [pivot[1] + 0.004]}
    return sample, places | through, [1e-14, 0.1]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("case", [_almost_square, _almost_at_the_foot])
def test_in_a_dead_position_a_design_has_no_values(path, case):
    for name in ("S", "Jeq"):
        assert evaluate_designs(*case(), [name], path=path)[ASSEMBLED].tolist() == [[False, True]]


@pytest.mark.skipif(not compiling.is_installed(), reason="numba is not installed")
def test_chunks_and_threads_make_up_the_whole():
    sample, angle = mechanism("juki-mf7923d"), np.linspace(0.0, 6.0, 131)
    masses = np.linspace(0.1, 0.9, 515)
    asked = {"speed": 2.0, "acceleration": 1.0, "path": "compiled"}
    whole = evaluate_designs(sample, {"coupler.mass": masses}, angle, ["Mkr", "Jeq"], **asked, cores=1)
    assert whole["Mkr"].shape == (len(masses), len(angle))
    for cores in (2, None):
        parts = evaluate_designs(sample, {"coupler.mass": masses}, angle, ["Mkr", "Jeq"], **asked, cores=cores)
        assert all(np.array_equal(parts[name], values) for name, values in whole.items())
    last = evaluate_designs(sample, {"coupler.mass": masses[-1:]}, angle, ["Mkr"], **asked)
    assert np.array_equal(last["Mkr"][0], whole["Mkr"][-1])


@pytest.mark.parametrize("path", PATHS)
def test_a_link_that_weighs_something_in_one_design_is_assembled_in_all(path):
    sample, angle = mechanism("rimoldi-164"), np.linspace(0.0, 6.0, 20)
    short = {"link.D.x": np.array([0.002, 0.002]), "needle_bar.mass": np.array([0.0, 0.041])}
    light = {"link.mass": np.zeros(2), "link.inertia": np.zeros(2)}
    both = evaluate_designs(sample, {**short, **light}, angle, ["Jeq"], path=path)
    assert np.array_equal(both[ASSEMBLED][0], both[ASSEMBLED][1])
    assert not np.all(both[ASSEMBLED])
    short["needle_bar.mass"] = np.zeros(2)
    assert np.all(evaluate_designs(sample, {**short, **light}, angle, ["Jeq"], path=path)[ASSEMBLED])


ONE = np.ones(2)


@pytest.mark.parametrize(
    ("parameters", "angle", "message"),
    [
        ({"crnk.mass": ONE}, [0.0], "unknown parameter of 'juki-mf7923d' 'crnk.mass': did you mean 'crank.mass'"),
        ({}, [0.0], "got none"),
        ({"crank.mass": 1.0}, [0.0], r"crank.mass of shape \(\)"),
        ({"crank.mass": ONE, "coupler.mass": np.ones(3)}, [0.0], r"coupler.mass of shape \(3,\)"),
        ({"crank.mass": np.ones(0)}, [0.0], "a value per design"),
        ({"crank.mass": [1.0, -1.0]}, [0.0], "none negative, got -1 in design 1"),
        ({"crank.A.x": [np.nan, 1.0]}, [0.0], "expected finite numbers, got nan in design 0"),
        ({"needle_bar.along.x": ONE, "needle_bar.along.y": [1.0, 2.0]}, 0.0, r"got shape \(\)"),
        ({"needle_bar.along.x": [1.0, 0.0], "needle_bar.along.y": [0.0, 0.0]}, [0.0], r"got \(0, 0\) in design 1"),
        ({"crank.mass": ONE}, [[0.0]], r"got shape \(1, 1\)"),
        ({"crank.mass": ONE}, [0.0, np.inf], "got nan or infinity"),
    ],
)
def test_bad_arguments_are_named(parameters, angle, message):
    with pytest.raises(LinkproofError, match=message):
        evaluate_designs(mechanism("juki-mf7923d"), parameters, angle, ["Jeq"])


def test_a_point_called_along_is_no_direction():
    text = text_of("centric-slider-crank").replace("A = [0.05, 0] }", "A = [0.05, 0], along = [0, 0.01] }", 1)
    found = evaluate_designs(from_text(text), {"crank.along.y": [0.0, 0.01]}, [0.3], ["Jeq"])
    assert np.all(found[ASSEMBLED])


def test_an_unknown_quantity_and_a_missing_output_are_named():
    sample, masses = mechanism("centric-slider-crank"), {"crank.mass": ONE}
    with pytest.raises(UnknownNameError, match="quantity 'Jqe'"):
        evaluate_designs(sample, masses, [0.0], ["Jqe"])
    bare = from_text(text_of("centric-slider-crank").replace('output  = { point = "D" }\n', ""))
    with pytest.raises(LinkproofError, match="names no output"):
        evaluate_designs(bare, masses, [0.0], ["S"])


def test_a_direction_is_scaled_to_unit_length():
    sample, angle = mechanism("juki-mf7923d"), np.linspace(0.0, 6.0, 9)
    scales = np.array([1.0, 5.0])
    names = {name: value * scales for name, value in _direction(sample).items()}
    found = evaluate_designs(sample, names, angle, ["S", "Jeq"])
    for name in ("S", "Jeq"):
        assert np.allclose(found[name][1], found[name][0], rtol=WRITTEN, atol=0.0)


def _direction(sample):
    return {name: value for name, (_, value) in design_numbers(sample.linkage).items() if ".along." in name}
