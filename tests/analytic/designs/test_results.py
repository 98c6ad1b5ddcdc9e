"""Figures of many designs: those of linkages built one by one; extremes between samples; dead positions; means."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytic import signals
from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN
from analytic.description.loading import literature
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.errors import AssemblyError, StructureError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import MovingSweep
from comparisons.designer.curves import Curves
from comparisons.motion.case import Case
from tests.analytic.designs.one_by_one import PATHS, built, signals_of, varied
from tests.analytic.linkages import FOLDER, MADE_UP, ON_TRIAL, double_rocker, driven, from_text, mechanism, on_trial

# Other orders of the same operations; of the peak.
SAME = 1e-13
# Of a top that two searches close in on; a hair from a dead position the closed form's own roundings are as large.
TOP, AT_TOGGLE = 1e-12, 1e-9
AT_KINK = 1e-6  # where a load over the travel sets in: a top is there closed in on as if the curve were smooth
SPEED = 7.0
BETWEEN = 10_001  # angles that show whether a design that moves at the sampled ones stands between them
DRIVES = sorted(path.stem for path in (FOLDER / "drives").glob("*.toml"))
# n-four-bar takes 12 s a design, for the series through its change points.
OTHERS = [(name, None, False) for name in (*sorted({*literature()} - {"n-four-bar"}), *DRIVES)]
LADEN = [(name, variant, True) for (name, variant), is_laden in ON_TRIAL if is_laden]
ORDINARY = [
    ("pin-in-two-slots", None, True),
    ("shaper", None, True),
    ("double-crank", None, True),
    OTHERS[1],
    OTHERS[-2],
]
WAYS = [Reduction.PEAK, Reduction.MAX, Reduction.MIN, Reduction.RANGE]
TURN = np.arange(24) * (FULL_TURN / 24)


def nightly_but(ordinary, cases):
    """The cases as parameters, of which all but the ordinary ones run nightly."""
    return [case if case in ordinary else pytest.param(case, marks=pytest.mark.nightly) for case in cases]


def sample_of(name, variant, is_laden):
    """A linkage by name."""
    return driven(name) if name in DRIVES else on_trial(name, variant, is_laden)


def places(sample, count):
    """Places of the driver over the loads' period, or over the middle of its range; and the period, None of a range."""
    reach, period = sample.crank_range(), sample.linkage.load_period
    if reach.is_full_turn:
        return np.arange(count) * (period / count), period
    low, high = reach.limits
    return np.linspace(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high, count), None


def stands(design, angle):
    """Whether a design cannot be assembled between crank angles, or passes there into its other assembly mode."""
    sweep = design.sweep(np.linspace(angle[0], angle[-1] + angle[1] - angle[0], BETWEEN))
    try:
        return any(np.ptp(np.sign(sweep.determinant(dyad))) > 0.0 for dyad in design.structure.dyads)
    except AssemblyError:
        return True


def reduced(values, way):
    """One figure of a sampled signal."""
    if way is Reduction.RANGE:
        return np.ptp(values)
    return (
        np.max(np.abs(values)) if way is Reduction.PEAK else np.max(values) if way is Reduction.MAX else np.min(values)
    )


def compare(sample, parameters):
    """Compare every signal of every design, each reduced in one of the ways, with a loop; which designs fail."""
    angle, period = places(sample, 24)
    names = [name for name in signals.names(sample) if name not in ("phi", "omega", "epsilon")]
    figures = [Figure(name, WAYS[row % len(WAYS)]) for row, name in enumerate(names)]
    result = design_figures(sample, parameters, figures, angle, speed=SPEED, period=period)
    for number in range(result.shape[1]):
        try:
            design = built(sample, parameters, number)
            expected = signals_of(sample, design, angle, names, (SPEED, 0.0))
        except (AssemblyError, StructureError):
            assert np.all(np.isnan(result[:, number]))
            continue
        if np.all(np.isnan(result[:, number])):
            assert stands(design, angle)
            continue
        for figure, value in zip(figures, result[:, number], strict=True):
            values = expected[figure.signal]
            assert abs(value - reduced(values, figure.reduction)) <= SAME * np.max(np.abs(values)), figure
    return np.isnan(result[0])


@pytest.mark.parametrize("case", nightly_but(ORDINARY, [*LADEN, *OTHERS]))
def test_figures_are_those_of_linkages_built_one_by_one(case):
    sample = sample_of(*case)
    assert not np.all(compare(sample, varied(sample, 3, 4, 0.001)))


@pytest.mark.parametrize("case", nightly_but([LADEN[0], LADEN[8]], LADEN))
def test_designs_that_cannot_be_assembled_or_moved_are_nan_and_no_others(case):
    sample = sample_of(*case)
    failing = compare(sample, varied(sample, 4, 12, 0.2))
    assert np.any(failing) == (case[0] != "scotch-yoke")


# Not "scotch-yoke", whose laden springs' ends meet at a sample, nor what passes change points or is solved by numbers.
NEAR_TOGGLE = ("near-toggle", None, True)
REFINED = [("rimoldi-164", "as-built", False), *((name, None, False) for name in MADE_UP), *LADEN[:4], NEAR_TOGGLE]
REFINED = [case for case in REFINED if case[0] not in ("scotch-yoke", "parallelogram")]


@pytest.mark.parametrize("case", nightly_but([NEAR_TOGGLE, ("rimoldi-164", "as-built", False)], REFINED))
def test_true_peaks_are_those_that_results_prints(case):
    sample = sample_of(*case)
    angle, period = places(sample, 180 * round(sample.linkage.load_period / FULL_TURN))
    start, end = angle[0], angle[0] + period if period else angle[-1]
    curves = Curves(Case(sample, CrankMotion("test", (Segment(0.0, (end - start) / SPEED, (start, SPEED)),))))
    names = [name for name in curves.names if name not in ("time", "phi", "omega", "epsilon", "S")]
    ways = [Reduction.MIN if name.startswith("transmission") else Reduction.PEAK for name in names]
    figures = list(map(Figure, names, ways))
    result = design_figures(sample, {}, figures, angle, speed=SPEED, period=period, refine=True)[:, 0]
    within = {"near-toggle": AT_TOGGLE, "laden-press": AT_KINK}.get(case[0], TOP)
    for value, (name, peak) in zip(result, curves.peaks(names).items(), strict=True):
        size = max(abs(peak.value), 0.05)  # what is zero but for rounding has no peak
        expected = peak.value if name.startswith("transmission_angle:") else abs(peak.value)
        assert abs(value - expected) <= within * size, name


def test_values_at_an_angle_are_those_of_the_curve():
    """Of a link that turns on the branch of the curve, of S from the design's own top."""
    sample = mechanism("double-crank")
    parameters = varied(sample, 9, 2, 0.02)
    names = [name for name in signals.names(sample) if name not in ("phi", "omega", "epsilon")]
    angle = np.arange(360) * (FULL_TURN / 360)
    expected = [signals_of(sample, built(sample, parameters, n), angle, names, (SPEED, 0.0)) for n in range(2)]
    for place in (0, 123, 359):
        figures = [Figure(name, Reduction.AT, angle[place]) for name in names]
        result = design_figures(sample, parameters, figures, angle, speed=SPEED, period=FULL_TURN)
        for values, (row, name) in itertools.product(enumerate(expected), enumerate(names)):
            true = values[1][name]
            assert abs(result[row, values[0]] - true[place]) <= SAME * np.max(np.abs(true))


def test_the_ends_of_a_range_count_and_those_of_a_turn_do_not():
    sample = mechanism("centric-slider-crank")
    figures = [Figure("point:A:y", Reduction.MAX), Figure("point:A:y", Reduction.MIN), Figure("S", Reduction.MIN)]
    reach = sample.linkage.links["crank"].points["A"][0]
    over = np.linspace(0.2, 1.2, 9)
    result = design_figures(sample, {}, figures, over, speed=SPEED, period=None, refine=True)[:, 0]
    assert np.allclose(result, [reach * np.sin(1.2), reach * np.sin(0.2), 0.0], rtol=0.0, atol=1e-15)
    turn = np.arange(10) * (FULL_TURN / 10) + 0.1
    result = design_figures(sample, {}, figures, turn, speed=SPEED, period=FULL_TURN, refine=True)[:, 0]
    assert np.allclose(result, [reach, -reach, 0.0], rtol=0.0, atol=1e-15)


def test_unknown_numbers_are_named():
    with pytest.raises(UnknownNameError, match=r"did you mean 'crank\.mass'"):
        design_figures(mechanism("juki-mf7923d"), {"crnk.mass": [1.0]}, [], TURN, speed=SPEED, period=FULL_TURN)


# Dead positions between samples, against the condition of Grashof; the ground leans, so that none lies at a sample.
PIVOT = (0.1 * math.cos(0.1), 0.1 * math.sin(0.1))
LEANING = f"""
title = "four-bar"
crank = "crank"
units = {{ length = "m", mass = "kg", inertia = "kg*m^2", angle = "rad" }}
ground = {{ O = [0, 0], C = [{PIVOT[0]!r}, {PIVOT[1]!r}] }}
links.crank = {{ points = {{ O = [0, 0], A = [0.03, 0] }}, mass = 1, inertia = 1e-3 }}
links.coupler = {{ points = {{ A = [0, 0], B = [0.11, 0] }}, mass = 1, inertia = 1e-3 }}
links.rocker = {{ points = {{ C = [0, 0], B = [0.06, 0] }}, mass = 1, inertia = 1e-3 }}
sketch = {{ angle = 1, points = {{ B = [0.1, 0.06] }} }}
"""
TWO = [Figure("Mkr", Reduction.PEAK), Figure("point:B:y", Reduction.MEAN)]


def lengths_about_dead_positions():
    """Crank, coupler and rocker, (3, designs), m, at and on both sides of both limits, and of every kind of motion."""
    draw = np.random.default_rng(2)
    beyond = np.concatenate([sign * 10.0 ** np.arange(-9.0, -2.9, 0.5) for sign in (1.0, -1.0)]) * 0.1
    crank, rocker = 0.1 * draw.uniform(0.2, 1.6, (2, 400))
    limits = np.stack([0.1 + crank - rocker, rocker + np.abs(0.1 - crank), rocker - np.abs(0.1 - crank)])
    coupler = limits[draw.integers(0, 3, 400), np.arange(400)] + draw.choice([*beyond, 0.0], 400)
    exact = np.array([[0.03, 0.1, 0.03], [0.1, 0.05, 0.05], [0.03, 0.0995, 0.0305], [0.03, 0.1005, 0.0305]])
    return np.concatenate([np.stack([crank, coupler, rocker], axis=1)[coupler > 0.01], exact]).T


@pytest.mark.parametrize(("count", "refine", "path"), [(12, False, "numpy"), (129, False, "auto"), (40, True, "numpy")])
def test_a_crank_that_makes_no_turn_is_seen_however_narrow_the_gap(count, refine, path):
    crank, coupler, rocker = lengths_about_dead_positions()
    gap = np.minimum(coupler + rocker - (0.1 + crank), np.abs(0.1 - crank) - np.abs(coupler - rocker))
    lengths = {"crank.A.x": crank, "coupler.B.x": coupler, "rocker.B.x": rocker}
    places = np.arange(count) * (FULL_TURN / count)
    options = {"speed": SPEED, "period": FULL_TURN, "path": path, "refine": refine}
    result = design_figures(from_text(LEANING), lengths, TWO, places, **options)
    turns = gap > 1e-15
    assert 50 < np.count_nonzero(turns) < len(turns) - 50
    np.testing.assert_array_equal(np.isfinite(result), [turns, turns])


@pytest.mark.parametrize("path", PATHS)
def test_over_a_range_only_the_dead_positions_in_it_count(path):
    """One of the designs fails about half a turn, the other from 0.03 to 0.17 rad, between two samples."""
    designs = {"coupler.B.x": [0.0999, 0.1001], "rocker.B.x": [0.03, 0.03]}
    for start, fails in ((0.2, [False, False]), (-0.6, [False, True])):
        over = np.linspace(start, 1.2, 10)
        result = design_figures(from_text(LEANING), designs, TWO, over, speed=SPEED, period=None, path=path)
        np.testing.assert_array_equal(np.isnan(result), [fails, fails])


# Means, against quadrature that shares nothing with theirs.
SWING = (math.radians(-10.0), math.radians(65.0))
AROUND = (0.0, FULL_TURN)


def integral(sample, figure, span):
    """A mean by QUADPACK's adaptive quadrature; S from the highest of very many places."""
    output = sample.sweep(np.linspace(*span, 300_001)).output() if figure.signal == "S" else np.zeros(1)
    is_rms = figure.reduction is Reduction.RMS

    def integrand(phi):
        moving = MovingSweep(
            sample, sample.sweep(np.array([phi])), np.asarray(20.0), np.asarray(0.0), float(output.max())
        )
        return float(signals.signal(moving, figure.signal)[0]) ** (2 if is_rms else 1)

    edges = np.linspace(*span, 21)
    parts = [quad(integrand, *ends, epsabs=0.0, epsrel=1e-11, limit=500)[0] for ends in itertools.pairwise(edges)]
    mean = math.fsum(parts) / (span[1] - span[0])
    return math.sqrt(mean) if is_rms else mean


@pytest.mark.filterwarnings("ignore::scipy.integrate.IntegrationWarning")
@pytest.mark.parametrize(
    ("name", "figures"),
    [
        ("near-toggle", [("joint_force:B:magnitude", Reduction.MEAN), ("transmission_angle:GROUP", Reduction.MEAN)]),
        ("juki-mf7923d", [("S", Reduction.RMS), ("Jeq", Reduction.MEAN)]),
        ("double rocker", [("transmission_angle:GROUP", Reduction.RMS), ("S", Reduction.MEAN)]),
    ],
)
def test_a_mean_is_the_integral_over_the_motion_whatever_the_samples(name, figures):
    swings = name == "double rocker"
    sample = Mechanism(double_rocker(along=(-1.0, 0.0))) if swings else mechanism(name)
    group, span = sample.structure.dyads[0].name, SWING if swings else AROUND
    means = [Figure(signal.replace("GROUP", group), way) for signal, way in figures]
    expected = np.array([[integral(sample, figure, span)] for figure in means])
    period = None if swings else FULL_TURN
    for count, refine in ((60, False), (180, True)):
        angle = np.linspace(*span, count, endpoint=swings)
        options = {"speed": 20.0, "period": period, "refine": refine, "path": "numpy"}
        result = design_figures(sample, {}, means, angle, **options)
        np.testing.assert_allclose(result, expected, rtol=1e-9, err_msg=f"{count} {refine}")
