"""The compiled path: the plain path's numbers for every linkage, and the plain path itself where it knows more."""

import os
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import analytic
from analytic import evaluation
from analytic.compiled import evaluation as compiled
from analytic.compiled import kernels as kernels_package
from analytic.compiled.flat_linkage import program
from analytic.compiled.redesign import redesigned
from analytic.dynamics import reduced
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.evaluation import LEAST_WORK, QUANTITIES, WORK_OF_COMPILING, WORK_OF_LOADING, evaluate
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import CATALOGUE, EVERY, four_bars, from_text, mechanism, slider_cranks, text_of
from tests.analytic.loaded_linkages import ALL, on_trial
from tests.analytic.tolerances import EPS

# Two orders of the same operations on the same numbers; relative to the peak.
SAME = 1e-14
# Cosines and sines of two libraries, each good to about a rounding.
TRIGONOMETRY = 0.75 * EPS

numba = pytest.mark.skipif(not compiled.available(), reason="numba is not installed")


def crank_angles(name, count=700, seed=1):
    """Angles over three turns; those near the change points of a parallelogram left out."""
    angle = np.random.default_rng(seed).uniform(-10.0, 10.0, count)
    return angle[np.abs(np.sin(angle)) > 0.1] if name == "parallelogram" else angle


ORDERS = {"S": 0, "Jeq": 1, "Q": 1, "Teq": 1, "v": 1, "half_slope": 2, "Mkr": 2, "Peq": 2, "a": 2}


def limits(case, sample, angle):
    """Limits by order of the derivative: the catalogue's must be the same, others as far as the closed form is certain.

    Its own bound on its error grows near dead positions, and so does the difference of any two roundings of it.
    """
    if case in CATALOGUE:
        return (SAME, SAME, SAME)
    return tuple(max(SAME, bound) for bound in relative_bounds(sample.sweep(angle)))


def deviation(found, expected):
    """Largest difference, relative to the peak."""
    return np.max(np.abs(found - expected)) / max(np.max(np.abs(expected)), np.finfo(float).tiny)


def quantities(sample):
    return [name for name in QUANTITIES if sample.linkage.output or name not in {"S", "v", "a"}]


@numba
@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_all_quantities_are_the_plain_path_s(case, is_laden):
    sample, angle = on_trial(*case, is_laden), crank_angles(case[0])
    draw = np.random.default_rng(2)
    speed, acceleration = draw.normal(0.0, 30.0, angle.shape), draw.normal(0.0, 100.0, angle.shape)
    asked = {"speed": speed, "acceleration": acceleration}
    found = compiled.CompiledMechanism(sample).evaluate(angle, quantities(sample), **asked)
    expected = evaluate(sample, angle, quantities(sample), **asked, path="numpy")
    assert list(found) == list(expected)
    limit = limits(case, sample, angle)
    for name, values in expected.items():
        assert deviation(found[name], values) <= limit[ORDERS[name]], name


@numba
@pytest.mark.parametrize("case", EVERY)
def test_points_and_angles_with_their_derivatives_are_the_plain_path_s(case):
    sample, angle = mechanism(*case), np.sort(crank_angles(case[0]))
    links = list(sample.linkage.links)
    points = sorted(
        {point for link in sample.linkage.links.values() for point in link.points} | {*sample.linkage.ground}
    )
    found = compiled.CompiledMechanism(sample).motion(angle, points, links)
    expected = compiled.plain_motion(sample, angle, points, links)
    assert all(found.points[name].shape == (3, 2, *angle.shape) for name in points)
    for order, limit in enumerate(limits(case, sample, angle)):
        for name in points:
            assert deviation(found.points[name][order], expected.points[name][order]) <= limit
        for name in links:
            assert deviation(found.angles[name][order], expected.angles[name][order]) <= limit


@numba
@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_terms_of_the_equation_of_motion_one_by_one(case, is_laden):
    from analytic.compiled.kernels import linkage  # noqa: PLC0415 - it imports numba

    sample, angle = on_trial(*case, is_laden), crank_angles(case[0], 20)
    plan = program(sample)
    design, work = linkage.design_of(plan), linkage.scratch(plan)
    rows = [linkage.equation_terms(plan.tables, design, float(phi), work) for phi in angle]
    assert all(row[4] for row in rows)
    sweep = sample.sweep(angle)
    expected = (
        reduced.generalised_force(sweep),
        reduced.damping_coefficient(sweep),
        reduced.reduced_inertia(sweep),
        reduced.half_inertia_slope(sweep),
    )
    limit = max(limits(case, sample, angle))
    for column, values in enumerate(expected):
        assert deviation(np.array([row[column] for row in rows]), values) <= limit


@numba
@given(
    st.one_of(four_bars().map(lambda drawn: drawn.text()), slider_cranks()), st.integers(0, 2**32), st.integers(1, 400)
)
@settings(max_examples=60, deadline=None)
def test_random_linkages_at_random_angles(text, seed, count):
    sample = from_text(text)
    draw = np.random.default_rng(seed)
    angle, speed = draw.uniform(-1e3, 1e3, count), draw.normal(0.0, 50.0, count)
    found = compiled.CompiledMechanism(sample).evaluate(angle, quantities(sample), speed=speed, acceleration=3.0)
    expected = evaluate(sample, angle, quantities(sample), speed=speed, acceleration=3.0, path="numpy")
    # Among few angles a quantity's peak may be a small part of its peak over a turn.
    turn = evaluate(sample, sample.turn.angle, quantities(sample), speed=np.abs(speed).max(), acceleration=3.0)
    limit = limits(None, sample, sample.turn.angle)
    for name, values in expected.items():
        peak = max(np.max(np.abs(turn[name])), np.max(np.abs(values)))
        assert np.max(np.abs(found[name] - values)) <= limit[ORDERS[name]] * peak, name


@numba
def test_threads_make_up_the_whole():
    sample, angle = mechanism("rimoldi-164"), np.linspace(0.0, 40.0, 4 * compiled.SHARE + 77)
    speed = np.cos(angle)
    fast = compiled.CompiledMechanism(sample)
    whole = fast.evaluate(angle, ["Mkr"], speed=speed, cores=1)
    moves = fast.motion(angle, ["D"], ["rocker", "crank"], cores=1)
    for cores in (2, 3, None):
        assert np.array_equal(fast.evaluate(angle, ["Mkr"], speed=speed, cores=cores)["Mkr"], whole["Mkr"])
        parts = fast.motion(angle, ["D"], ["rocker", "crank"], cores=cores)
        assert np.array_equal(parts.points["D"], moves.points["D"])
        assert np.array_equal(parts.angles["rocker"], moves.angles["rocker"])
    assert np.array_equal(moves.angles["crank"], [angle, np.ones_like(angle), np.zeros_like(angle)])


@numba
@pytest.mark.parametrize("count", [0, 1, 127, 128, 129, 300])
def test_any_number_of_angles(count):
    sample, angle = mechanism("juki-mf7923d"), np.linspace(0.1, 6.0, count)
    found = evaluate(sample, angle, QUANTITIES, speed=5.0, acceleration=7.0, path="compiled")
    expected = evaluate(sample, angle, QUANTITIES, speed=5.0, acceleration=7.0, path="numpy")
    for name, values in expected.items():
        assert found[name].shape == (count,)
        assert np.allclose(found[name], values, rtol=0.0, atol=SAME * 1e3 * np.max(np.abs(values), initial=0.0))
    assert compiled.CompiledMechanism(sample).motion(angle, ["D"], ["coupler"]).angles["coupler"].shape == (3, count)


@numba
def test_shapes_are_kept_and_arrays_may_be_read_only():
    sample, angle = mechanism("shaper"), np.linspace(0.0, 12.0, 60).reshape(5, 12)
    angle.flags.writeable = False
    fast = compiled.CompiledMechanism(sample)
    assert set(fast.motion(0.3, ["F", "F"], ["crank", "ram", "crank"]).angles) == {"crank", "ram"}
    found = fast.evaluate(angle, ["Mkr"], speed=np.broadcast_to(2.0, angle.shape))
    assert found["Mkr"].shape == angle.shape
    assert fast.evaluate(0.3, ["Jeq"])["Jeq"].shape == ()
    assert fast.evaluate(angle, []) == {}
    links = list(sample.linkage.links)
    moves, plain = fast.motion(angle, (), links, 1), compiled.plain_motion(sample, angle, (), links, 1)
    for link in links:  # unwrapped along the last axis only
        assert moves.angles[link].shape == (2, 5, 12)
        assert deviation(moves.angles[link], plain.angles[link]) <= SAME
    assert fast.motion(0.3, list(sample.linkage.ground)[:1], links[:1]).angles[links[0]].shape == (3,)


@numba
def test_kernels_are_compiled_once_for_all_linkages():
    from analytic.compiled.kernels import evaluation as kernels_evaluation  # noqa: PLC0415 - it imports numba

    for case, is_laden in ALL[:12]:
        sample = on_trial(*case, is_laden)
        evaluate(sample, np.array([0.7, 0.8]), ["Mkr"], speed=1.0, path="compiled")
        compiled.CompiledMechanism(sample).motion([0.7, 0.8], list(sample.linkage.ground), [sample.linkage.crank])
    assert len(kernels_evaluation.quantities.signatures) == 1
    assert len(kernels_evaluation.motion.signatures) == 1


@numba
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_where_links_do_not_meet_the_plain_path_says_so(factor):
    plan = program(mechanism("rimoldi-164"))
    numbers = plan.numbers.copy()
    numbers[plan.places["rod.B.x"]] *= factor
    sample, angle = Mechanism(redesigned(plan, numbers)), np.linspace(0.0, 6.0, 1000)
    messages = set()
    for path in ("numpy", "compiled"):
        with pytest.raises(AssemblyError, match="cannot be assembled") as error:
            evaluate(sample, angle, ["S"], path=path)
        messages.add(str(error.value))
    with pytest.raises(AssemblyError) as error:
        compiled.CompiledMechanism(sample).motion(angle, ["D"], order=0)
    assert len({*messages, str(error.value)}) == 1


@numba
def test_at_a_change_point_places_are_known_and_rates_are_not():
    sample, angle = mechanism("parallelogram"), np.linspace(0.0, np.pi, 9)
    found = evaluate(sample, angle, ["S"], path="compiled")["S"]
    assert deviation(found, evaluate(sample, angle, ["S"], path="numpy")["S"]) <= SAME
    messages = set()
    for path in ("numpy", "compiled"):
        with pytest.raises(AssemblyError, match="dead position") as error:
            evaluate(sample, angle, ["Jeq"], path=path)
        messages.add(str(error.value))
    with pytest.raises(AssemblyError) as error:
        compiled.CompiledMechanism(sample).motion(angle, ["B"])
    assert len({*messages, str(error.value)}) == 1


@numba
def test_bad_arguments_are_the_plain_path_s():
    sample = mechanism("centric-slider-crank")
    fast = compiled.CompiledMechanism(sample)
    with pytest.raises(LinkproofError, match="expected finite numbers"):
        fast.evaluate([0.1, np.nan], ["Jeq"])
    with pytest.raises(UnknownNameError, match="quantity 'Jqe'"):
        fast.evaluate(0.1, ["Jqe"])
    with pytest.raises(LinkproofError, match="speed"):
        fast.evaluate(0.1, ["v"])
    with pytest.raises(UnknownNameError, match="point 'X'"):
        fast.motion(0.1, ["X"])
    with pytest.raises(UnknownNameError, match="link 'pistn': did you mean 'piston'"):
        fast.motion(0.1, links=["pistn"])
    with pytest.raises(LinkproofError, match="expected 0, 1 or 2, got 3"):
        fast.motion(0.1, ["D"], order=3)
    with pytest.raises(LinkproofError, match="expected a positive number of threads, or none for all, got 0"):
        fast.evaluate(0.1, ["Jeq"], cores=0)
    bare = from_text(text_of("centric-slider-crank").replace('output  = { point = "D" }\n', ""))
    with pytest.raises(LinkproofError, match="names no output"):
        evaluate(bare, 0.1, ["S"], path="compiled")


@numba
def test_cosines_sines_and_arctangents():
    from analytic.compiled.kernels.layout import BLOCK  # noqa: PLC0415
    from analytic.compiled.kernels.trigonometry import LARGEST, arctangents, cosines_and_sines  # noqa: PLC0415 - numba

    draw = np.random.default_rng(3)
    for largest in (1.0, 10.0, 1e4, 0.99 * LARGEST, 100.0 * LARGEST):
        angle = np.append(draw.uniform(-largest, largest, BLOCK - 3), [0.0, 0.5 * np.pi, -np.pi])
        cosine, sine, back = np.empty((3, BLOCK))
        cosines_and_sines(BLOCK, angle, cosine, sine)
        exact = angle.astype(np.longdouble)
        assert np.max(np.abs(cosine - np.cos(exact))) <= TRIGONOMETRY
        assert np.max(np.abs(sine - np.sin(exact))) <= TRIGONOMETRY
        arctangents(BLOCK, 0.3 * sine, 0.3 * cosine, back)
        assert np.allclose(back, np.arctan2(0.3 * sine, 0.3 * cosine), rtol=4 * EPS, atol=0.0)
    sine, cosine = np.array([0.0, -0.0, 0.0, -0.0, 1.0, -1.0]), np.array([1.0, 1.0, -1.0, -1.0, 0.0, 0.0])
    back = np.empty(6)
    arctangents(6, sine, cosine, back)
    assert np.array_equal(back, np.arctan2(sine, cosine))
    assert np.array_equal(np.signbit(back), np.signbit(np.arctan2(sine, cosine)))


def test_a_change_of_any_kernel_file_counts(tmp_path):
    jit = pytest.importorskip("analytic.compiled.kernels.jit", exc_type=ModuleNotFoundError)
    shutil.copytree(Path(analytic.__file__).parent, tmp_path / "analytic")
    kernels = tmp_path / "analytic" / "compiled" / "kernels"
    assert jit.checksum(kernels) == jit.SOURCES
    for path in kernels.glob("*.py"):
        before = jit.checksum(kernels)
        path.write_bytes(path.read_bytes() + b"\n")
        assert jit.checksum(kernels) != before


@pytest.fixture
def without_numba(monkeypatch):
    """Numba not installed, and none of its kernels in memory."""
    _forget_kernels(monkeypatch)
    monkeypatch.setitem(sys.modules, "numba", None)


def _forget_kernels(monkeypatch):
    for name in [name for name in sys.modules if name.startswith("analytic.compiled.kernels.")]:
        monkeypatch.delitem(sys.modules, name)
        monkeypatch.delattr(kernels_package, name.rpartition(".")[2], raising=False)


@pytest.mark.usefixtures("without_numba")
def test_without_numba_the_plain_path_is_taken_and_the_cure_named():
    sample = mechanism("juki-mf7923d")
    assert not compiled.available()
    assert not evaluation.is_compiled("auto", 10 * WORK_OF_COMPILING)
    with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[compiled\]'"):
        evaluate(sample, 0.3, ["Jeq"], path="compiled")
    with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[compiled\]'"):
        compiled.CompiledMechanism(sample)


def test_an_error_inside_is_not_taken_for_an_absent_numba(monkeypatch):
    class Broken:
        def find_spec(self, wanted, path=None, target=None):
            if wanted == "numba":
                raise ModuleNotFoundError("No module named 'slip_of_the_pen'", name="slip_of_the_pen")

    _forget_kernels(monkeypatch)
    for name in [name for name in sys.modules if name == "numba" or name.startswith("numba.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [Broken(), *sys.meta_path])
    with pytest.raises(ModuleNotFoundError, match="slip_of_the_pen"):
        compiled.kernels()


@pytest.mark.parametrize(
    ("work", "state", "expected"),
    [
        (LEAST_WORK - 1, {"loaded", "ready", "there"}, False),
        (LEAST_WORK, {"loaded", "ready", "there"}, True),
        (WORK_OF_LOADING - 1, {"ready", "there"}, False),
        (WORK_OF_LOADING, {"ready", "there"}, True),
        (WORK_OF_LOADING, {"ready"}, False),
        (WORK_OF_COMPILING - 1, {"there"}, False),
        (WORK_OF_COMPILING, {"there"}, True),
        (WORK_OF_COMPILING, set(), False),
    ],
)
def test_the_compiled_path_is_taken_where_it_pays(monkeypatch, work, state, expected):
    monkeypatch.setattr(compiled, "is_loaded", lambda: "loaded" in state)
    monkeypatch.setattr(compiled, "is_ready", lambda: "ready" in state)
    monkeypatch.setattr(compiled, "available", lambda: "there" in state)
    assert evaluation.is_compiled("auto", work) is expected
    assert evaluation.is_compiled("compiled", work)
    assert not evaluation.is_compiled("numpy", work)


def test_an_unknown_path_is_named():
    with pytest.raises(UnknownNameError, match="path 'numby': did you mean 'numpy'"):
        evaluate(mechanism("juki-mf7923d"), 0.3, ["Jeq"], path="numby")


def test_kept_kernels_older_than_their_sources_are_none(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not compiled.is_ready()
    version = f"py{sys.version_info.major}{sys.version_info.minor}"
    kept = tmp_path / "analytic_1" / f"evaluation.quantities-1.{version}.nbi"
    kept.parent.mkdir()
    kept.touch()
    assert compiled.is_ready()
    os.utime(kept, (0, 0))
    assert not compiled.is_ready()
