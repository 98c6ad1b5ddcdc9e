"""The compiled path: the plain path's numbers for every linkage, and the plain path itself where it knows more."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.compiled import choice
from analytic.compiled import evaluation as compiled
from analytic.compiled.flat_linkage import flatten, redesigned
from analytic.dynamics import reduced
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.evaluation import QUANTITIES, evaluate
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import CATALOGUE, four_bars, from_text, mechanism, slider_cranks, text_of
from tests.analytic.loaded_linkages import ALL, on_trial
from tests.analytic.tolerances import EPS

# Two orders of the same operations on the same numbers; relative to the peak.
SAME = 1e-14
# Cosines and sines of two libraries, each good to about a rounding.
TRIGONOMETRY = 0.75 * EPS

numba = pytest.mark.skipif(not choice.is_installed(), reason="numba is not installed")


def crank_angles(name, count=700, seed=1):
    """Angles over three turns; of a parallelogram those before its change point, which the kernels do not pass."""
    angle = np.random.default_rng(seed).uniform(-10.0, 10.0, count)
    return angle[np.sin(angle) > 0.1] if name == "parallelogram" else angle


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
    found = evaluate(sample, angle, quantities(sample), **asked, path="compiled")
    expected = evaluate(sample, angle, quantities(sample), **asked, path="numpy")
    assert list(found) == list(expected)
    limit = limits(case, sample, angle)
    for name, values in expected.items():
        assert deviation(found[name], values) <= limit[ORDERS[name]], name


@numba
@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_terms_of_the_equation_of_motion(case, is_laden):
    from analytic.compiled.kernels import layout, linkage  # noqa: PLC0415 - it imports numba

    sample, angle = on_trial(*case, is_laden), crank_angles(case[0], 20)
    flat = flatten(sample)
    design, work = linkage.design_of(flat), linkage.scratch(flat)
    work[layout.ANGLE : layout.ANGLE + len(angle)] = angle
    assert linkage.equation_rows(flat.tables, design, len(angle), work) == 0.0
    sums = (layout.FORCE, layout.DAMPING, layout.JEQ, layout.HALF_DERIVATIVE)
    sweep = sample.sweep(angle)
    expected = (
        reduced.generalised_force(sweep),
        reduced.damping_coefficient(sweep),
        reduced.reduced_inertia(sweep),
        reduced.half_inertia_derivative(sweep),
    )
    limit = max(limits(case, sample, angle))
    for row, values in zip(sums, expected, strict=True):
        start = layout.SUMS + row
        if np.max(np.abs(values)) < EPS * np.max(np.abs(expected)):  # ½ Jeq' of a parallelogram is zero
            continue
        assert deviation(work[start : start + len(angle)], values) <= limit


@numba
@given(
    st.one_of(four_bars().map(lambda drawn: drawn.text()), slider_cranks()), st.integers(0, 2**32), st.integers(1, 400)
)
@settings(max_examples=60)
def test_random_linkages_at_random_angles(text, seed, count):
    sample = from_text(text)
    draw = np.random.default_rng(seed)
    angle, speed = draw.uniform(-1e3, 1e3, count), draw.normal(0.0, 50.0, count)
    found = evaluate(sample, angle, quantities(sample), speed=speed, acceleration=3.0, path="compiled")
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
    whole = evaluate(sample, angle, ["Mkr"], speed=speed, cores=1, path="compiled")
    for cores in (2, 3, None):
        parts = evaluate(sample, angle, ["Mkr"], speed=speed, cores=cores, path="compiled")
        assert np.array_equal(parts["Mkr"], whole["Mkr"])


@numba
@pytest.mark.parametrize("count", [0, 1, 127, 128, 129, 300])
def test_any_number_of_angles(count):
    sample, angle = mechanism("juki-mf7923d"), np.linspace(0.1, 6.0, count)
    found = evaluate(sample, angle, QUANTITIES, speed=5.0, acceleration=7.0, path="compiled")
    expected = evaluate(sample, angle, QUANTITIES, speed=5.0, acceleration=7.0, path="numpy")
    for name, values in expected.items():
        assert found[name].shape == (count,)
        assert np.allclose(found[name], values, rtol=0.0, atol=SAME * 1e3 * np.max(np.abs(values), initial=0.0))


@numba
def test_shapes_are_kept_and_arrays_may_be_read_only():
    sample, angle = mechanism("shaper"), np.linspace(0.0, 12.0, 60).reshape(5, 12)
    angle.flags.writeable = False
    found = evaluate(sample, angle, ["Mkr"], speed=np.broadcast_to(2.0, angle.shape), path="compiled")
    assert found["Mkr"].shape == angle.shape
    assert evaluate(sample, 0.3, ["Jeq"], path="compiled")["Jeq"].shape == ()
    assert evaluate(sample, angle, [], path="compiled") == {}


@numba
def test_kernels_are_compiled_once_for_all_linkages():
    from analytic.compiled.kernels import evaluation as kernels_evaluation  # noqa: PLC0415 - it imports numba

    for case, is_laden in ALL[:12]:
        sample = on_trial(*case, is_laden)
        evaluate(sample, np.array([0.7, 0.8]), ["Mkr"], speed=1.0, path="compiled")
    assert len(kernels_evaluation.quantities.signatures) == 1


@numba
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_where_links_do_not_meet_the_plain_path_says_so(factor):
    flat = flatten(mechanism("rimoldi-164"))
    numbers = flat.numbers.copy()
    numbers[flat.places["rod.B.x"]] *= factor
    sample, angle = Mechanism(redesigned(flat, numbers)), np.linspace(0.0, 6.0, 1000)
    messages = set()
    for path in ("numpy", "compiled"):
        with pytest.raises(AssemblyError, match="cannot be assembled") as error:
            evaluate(sample, angle, ["S"], path=path)
        messages.add(str(error.value))
    assert len(messages) == 1


@numba
def test_change_points_are_left_to_numpy():
    sample, angle = mechanism("parallelogram"), np.linspace(0.0, np.pi, 9)
    for name in ("S", "Jeq"):
        one, two = (evaluate(sample, angle, [name], path=path)[name] for path in ("compiled", "numpy"))
        np.testing.assert_array_equal(one, two)


@numba
def test_bad_arguments_are_the_plain_path_s():
    sample = mechanism("centric-slider-crank")
    with pytest.raises(LinkproofError, match="expected finite numbers"):
        evaluate(sample, [0.1, np.nan], ["Jeq"], path="compiled")
    with pytest.raises(UnknownNameError, match="quantity 'Jqe'"):
        evaluate(sample, 0.1, ["Jqe"], path="compiled")
    with pytest.raises(LinkproofError, match="speed"):
        evaluate(sample, 0.1, ["v"], path="compiled")
    with pytest.raises(LinkproofError, match="expected a positive number of threads, or none for all, got 0"):
        evaluate(sample, 0.1, ["Jeq"], cores=0, path="compiled")
    bare = from_text(text_of("centric-slider-crank").replace('output  = { point = "D" }\n', ""))
    with pytest.raises(LinkproofError, match="names no output"):
        evaluate(bare, 0.1, ["S"], path="compiled")


@numba
def test_cosines_and_sines():
    from analytic.compiled.kernels.layout import BLOCK  # noqa: PLC0415
    from analytic.compiled.kernels.trigonometry import LARGEST, cosines_and_sines  # noqa: PLC0415 - numba

    draw = np.random.default_rng(3)
    for largest in (1.0, 10.0, 1e4, 0.99 * LARGEST, 100.0 * LARGEST):
        angle = np.append(draw.uniform(-largest, largest, BLOCK - 3), [0.0, 0.5 * np.pi, -np.pi])
        cosine, sine = np.empty((2, BLOCK))
        cosines_and_sines(BLOCK, angle, cosine, sine)
        exact = angle.astype(np.longdouble)
        assert np.max(np.abs(cosine - np.cos(exact))) <= TRIGONOMETRY
        assert np.max(np.abs(sine - np.sin(exact))) <= TRIGONOMETRY
