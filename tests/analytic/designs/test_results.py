"""Figures of many designs against linkages built one by one."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import signals
from analytic.description.changes import changed
from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN
from analytic.description.loading import literature
from analytic.designs import sampling
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.errors import AssemblyError, LinkproofError, StructureError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.machine_code import compiling
from analytic.moving import MovingSweep
from comparisons.datasheet.curves import Curves
from comparisons.reference.case import Case
from tests.analytic.drives import driven
from tests.analytic.linkages import FOLDER, four_bars, from_text, mechanism, slider_cranks
from tests.analytic.loaded_linkages import ALL, laden, on_trial

# Other orders of the same operations; of the peak.
SAME = 1e-13
# Of a top that two searches close in on.
TOP = 1e-12
# A hair from a dead position the closed form's own roundings are as large.
AT_TOGGLE = 1e-9
SPEED = 7.0
BETWEEN = 10_001  # angles at which a design is seen to stand that moves at the sampled ones
LOADED = [(name, variant, is_laden) for (name, variant), is_laden in ALL]
# n-four-bar takes 12 s a design, for the series through its change points.
LITERATURE = sorted({*literature()} - {"n-four-bar"})
DRIVES = sorted(path.stem for path in (FOLDER / "drives").glob("*.toml"))
SAMPLES = [*LOADED, *((name, None, False) for name in (*LITERATURE, *DRIVES))]
REDUCTIONS = [Reduction.PEAK, Reduction.MAX, Reduction.MIN, Reduction.RANGE]
TURN = np.arange(24) * (FULL_TURN / 24)


def sample_of(name, variant, is_laden):
    """A linkage by name."""
    return driven(name) if name in DRIVES else on_trial(name, variant, is_laden)


@cache
def places(sample, count):
    """Places of the driver over a turn, or over the middle of its range; and whether it is a turn."""
    reach = sample.crank_range()
    if reach.is_full_turn:
        return np.arange(count) * (FULL_TURN / count), True
    low, high = reach.limits
    return np.linspace(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high, count), False


def varied(sample, seed, count, share):
    """Parameters for every number of a linkage, each changed by a share of itself and of the drawing's size."""
    draw = np.random.default_rng(seed)
    kinds = {}
    changed(sample.linkage, lambda name, kind, value: kinds.setdefault(name, (kind, value))[1])
    parameters = {}
    for name, (kind, value) in kinds.items():
        if name.startswith("sketch."):
            continue
        values = value * (1.0 + share * draw.normal(size=count))
        if kind in ("length", "direction"):
            values += share * (sample.linkage.extent() if kind == "length" else 1.0) * draw.normal(size=count)
        parameters[name] = np.abs(values) if kind in ("mass", "inertia") else values
    return parameters


def built(sample, parameters, number):
    """One of the designs, in the assembly modes of the original."""
    own = {name: float(values[number]) for name, values in parameters.items()}
    return sample.redesigned(changed(sample.linkage, lambda name, _, value: own.get(name, value)))


def every_signal(sample, design, angle):
    """All signals of a design at crank angles, S from its largest output there; raises AssemblyError."""
    sweep = Sweep(design.linkage, design.structure, angle)
    for body in design.structure.bodies:
        sweep.rates(body)
    top = float(np.max(sweep.output())) if sample.linkage.output else 0.0
    at = MovingSweep(sample, sweep, np.asarray(SPEED), np.asarray(0.0), top)
    return {name: signals.signal(at, name) for name in signals.names(sample)}


def stands(design, angle):
    """Whether a design cannot be assembled between crank angles, or passes there into its other assembly mode."""
    sweep = design.sweep(np.linspace(angle[0], angle[-1] + angle[1] - angle[0], BETWEEN))
    try:
        return any(np.ptp(np.sign(sweep.determinant(dyad))) > 0.0 for dyad in design.structure.dyads)
    except AssemblyError:
        return True


def reduced(values, reduction):
    """One figure of a sampled signal."""
    return {
        Reduction.PEAK: lambda: np.max(np.abs(values)),
        Reduction.MAX: lambda: np.max(values),
        Reduction.MIN: lambda: np.min(values),
        Reduction.RANGE: lambda: np.ptp(values),
    }[reduction]()


def compare(sample, parameters, angle):
    """Every signal of every design, each reduced in one of the ways, against a loop."""
    names = [name for name in signals.names(sample) if name not in ("phi", "omega", "epsilon")]
    figures = [Figure(name, REDUCTIONS[row % len(REDUCTIONS)]) for row, name in enumerate(names)]
    found = design_figures(sample, parameters, figures, angle, speed=SPEED)
    for number in range(found.shape[1]):
        try:
            expected = every_signal(sample, built(sample, parameters, number), angle)
        except (AssemblyError, StructureError):
            assert np.all(np.isnan(found[:, number]))
            continue
        if np.all(np.isnan(found[:, number])):  # it stands between two of the angles
            assert stands(built(sample, parameters, number), angle)
            continue
        for row, one in enumerate(figures):
            values = expected[one.signal]
            value = reduced(values, one.reduction)
            assert abs(found[row, number] - value) <= SAME * np.max(np.abs(values)), one
    return np.isnan(found[0])


@pytest.mark.parametrize("case", SAMPLES)
def test_figures_are_those_of_linkages_built_one_by_one(case):
    sample = sample_of(*case)
    failing = compare(sample, varied(sample, 3, 4, 0.001), places(sample, 24)[0])
    assert not np.all(failing)


@pytest.mark.parametrize("case", [case for case in LOADED if case[2]])
def test_designs_that_cannot_be_assembled_or_moved_are_nan_and_no_others(case):
    sample = sample_of(*case)
    failing = compare(sample, varied(sample, 4, 12, 0.2), places(sample, 24)[0])
    assert np.any(failing) == (case[0] != "scotch-yoke")


@given(sample=st.one_of(four_bars().map(lambda bar: bar.text()), slider_cranks()), seed=st.integers(0, 2**32))
@settings(max_examples=25)
def test_figures_of_linkages_drawn_at_random(sample, seed):
    mechanism = Mechanism(laden(from_text(sample).linkage))
    compare(mechanism, varied(mechanism, seed, 3, 0.05), TURN)


# Its laden springs' ends meet at a sample; through change points.
NOT_SAMPLED = ("scotch-yoke", "parallelogram")
NUMERICAL = ("boom", "cylinder-in-the-loop", "linear-motor")
REFINED = [case for case in SAMPLES if case[0] not in (*NOT_SAMPLED, *NUMERICAL) and (case[2] or case[1] is None)][::2]
REFINED += [("near-toggle", None, False), ("near-toggle", None, True)]


@pytest.mark.parametrize("case", REFINED)
def test_true_peaks_are_those_that_results_prints(case):
    sample = sample_of(*case)
    angle, is_turn = places(sample, 180)
    start, end = angle[0], angle[0] + FULL_TURN if is_turn else angle[-1]
    motion = CrankMotion("test", (Segment(0.0, (end - start) / SPEED, (start, SPEED)),))
    curves = Curves(Case(sample, motion))
    names = [name for name in curves.names if name not in ("time", "phi", "omega", "epsilon", "S")]
    crank = sample.linkage.crank
    own = {f"{crank}.mass": [sample.linkage.links[crank].mass]}
    ways = [Reduction.MIN if name.startswith("transmission") else Reduction.PEAK for name in names]
    figures = list(map(Figure, names, ways))
    found = design_figures(sample, own, figures, angle, speed=SPEED, refine=True)[:, 0]
    for value, (name, peak) in zip(found, curves.peaks(names).items(), strict=True):
        size = max(abs(peak.value), 0.05)  # what is zero but for rounding has no peak
        expected = peak.value if name.startswith("transmission_angle:") else abs(peak.value)
        top = AT_TOGGLE if case[0] == "near-toggle" else TOP
        assert abs(value - expected) <= top * size, name


@given(sample=four_bars(), seed=st.integers(0, 2**32))
@settings(max_examples=10)
def test_true_extremes_need_few_samples(sample, seed):
    """Those of 60 samples are those of 240; every extreme lies on the other side of 240 plain samples."""
    mechanism = from_text(sample.text())
    parameters = varied(mechanism, seed, 5, 0.01)
    names = ("Mkr", "joint_force:A:magnitude", "transmission_angle:" + mechanism.structure.dyads[0].name)
    ways = (Reduction.PEAK, Reduction.MAX, Reduction.MIN, Reduction.RANGE)
    figures = [Figure(name, way) for name in names for way in ways if name != names[1] or way is not Reduction.MIN]
    few, many = (
        design_figures(mechanism, parameters, figures, np.arange(n) * FULL_TURN / n, speed=SPEED, refine=True)
        for n in (60, 240)
    )
    plain = design_figures(mechanism, parameters, figures, np.arange(240) * FULL_TURN / 240, speed=SPEED)
    assert np.allclose(few, many, rtol=1e-11, atol=0.0, equal_nan=True)
    beyond = np.array([[-1.0 if one.reduction is Reduction.MIN else 1.0] for one in figures])
    outward = many - plain
    assert not np.any(beyond * outward < -1e-12 * np.abs(plain))


def test_blocks_and_threads_change_nothing(monkeypatch):
    sample = mechanism("rimoldi-164")
    parameters = varied(sample, 8, 30, 0.02)
    ways = [*Reduction]
    every = [Figure(name, ways[row % len(ways)], 0.4) for row, name in enumerate(signals.names(sample)[::6])]
    for refine, figures in ((False, every), (True, every[:4])):
        asked = (sample, parameters, figures, TURN)
        whole = design_figures(*asked, speed=SPEED, refine=refine, cores=1, path="numpy")
        assert 0 < np.count_nonzero(np.isnan(whole[0])) < 30
        for block, chunk in ((24 * 21, 30), (24 * 64, 11)):
            monkeypatch.setattr(sampling, "BLOCK", block)
            monkeypatch.setattr(sampling, "CHUNK", chunk)
            parts = design_figures(*asked, speed=SPEED, refine=refine, cores=3, path="numpy")
            assert np.array_equal(parts, whole, equal_nan=True)
        monkeypatch.undo()


def test_values_at_an_angle_are_those_of_the_curve():
    """Of a link that turns on the branch of the curve, of S from the design's own top."""
    sample = mechanism("double-crank")
    parameters = varied(sample, 9, 5, 0.02)
    names = [name for name in signals.names(sample) if name not in ("phi", "omega", "epsilon")]
    angle = np.arange(360) * (FULL_TURN / 360)
    for place in (0, 123, 359):
        figures = [Figure(name, Reduction.AT, angle[place]) for name in names]
        found = design_figures(sample, parameters, figures, angle, speed=SPEED)
        for number in range(5):
            expected = every_signal(sample, built(sample, parameters, number), angle)
            for row, name in enumerate(names):
                assert abs(found[row, number] - expected[name][place]) <= SAME * np.max(np.abs(expected[name]))


def test_the_ends_of_a_range_count_and_those_of_a_turn_do_not():
    sample = mechanism("centric-slider-crank")
    own = {"crank.mass": [1.0]}
    figures = [Figure("point:A:y", Reduction.MAX), Figure("point:A:y", Reduction.MIN), Figure("S", Reduction.MIN)]
    reach = sample.linkage.links["crank"].points["A"][0]
    over = np.linspace(0.2, 1.2, 9)
    found = design_figures(sample, own, figures, over, speed=SPEED, refine=True)[:, 0]
    assert np.allclose(found, [reach * np.sin(1.2), reach * np.sin(0.2), 0.0], rtol=0.0, atol=1e-15)
    turn = np.arange(10) * (FULL_TURN / 10) + 0.1
    for period in ({}, {"period": FULL_TURN}):
        found = design_figures(sample, own, figures, turn, speed=SPEED, refine=True, **period)[:, 0]
        assert np.allclose(found, [reach, -reach, 0.0], rtol=0.0, atol=1e-15)


def test_a_link_that_turns_has_turned_by_a_turn():
    sample = mechanism("double-crank")
    turns = [
        design_figures(
            sample,
            {"crank.mass": [1.0]},
            [Figure(f"link:{name}:angle", Reduction.RANGE)],
            TURN,
            speed=SPEED,
            refine=True,
        )[0, 0]
        for name in sample.linkage.links
    ]
    assert np.count_nonzero(np.isclose(turns, FULL_TURN, rtol=1e-14)) >= 2


ONE = np.ones(2)
MKR = [Figure("Mkr", Reduction.PEAK)]


@pytest.mark.parametrize(
    ("parameters", "figures", "angle", "message"),
    [
        ({"crnk.mass": ONE}, MKR, TURN, "did you mean 'crank.mass'"),
        ({"sketch.B.x": ONE}, MKR, TURN, "unknown parameter"),
        ({"crank.mass": ONE, "coupler.mass": np.ones(3)}, MKR, TURN, r"coupler.mass of shape \(3,\)"),
        ({"crank.mass": [1.0, -1.0]}, MKR, TURN, "none negative, got -1 in design 1"),
        ({"needle_bar.along.x": [1.0, 0.0], "needle_bar.along.y": [0.0, 0.0]}, MKR, TURN, "in design 1"),
        ({"crank.mass": ONE}, [Figure("Mkt", Reduction.PEAK)], TURN, "signal 'Mkt'"),
        ({"crank.mass": ONE}, MKR, [], r"1 or more finite crank angles in rad, ascending, got shape \(0,\)"),
        ({"crank.mass": ONE}, MKR, [0.0, 2.0, 1.0], "ascending, got others"),
    ],
)
def test_bad_arguments_are_named(parameters, figures, angle, message):
    with pytest.raises(LinkproofError, match=message):
        design_figures(mechanism("juki-mf7923d"), parameters, figures, angle, speed=SPEED)


def both_paths(sample, parameters, names, **settings):
    figures = [Figure(name, Reduction.PEAK) for name in names]
    return [
        design_figures(sample, parameters, figures, TURN, speed=SPEED, path=path, **settings)
        for path in ("numpy", "compiled")
    ]


@pytest.mark.skipif(not compiling.is_installed(), reason="numba is not installed")
def test_either_path_gives_the_figures():
    sample = mechanism("rimoldi-164")
    parameters = varied(sample, 5, 200, 0.02)
    names = ["Mkr", "S", "joint_force:A:magnitude", "shaking_force:magnitude", "point:B:vx"]
    plain, compiled = both_paths(sample, parameters, names)
    assert 0 < np.count_nonzero(np.isnan(plain[0])) < 200
    np.testing.assert_array_equal(np.isnan(plain), np.isnan(compiled))
    assert np.nanmax(np.abs(plain - compiled) / np.nanmax(np.abs(plain), axis=1, keepdims=True)) <= SAME


def test_a_signal_that_is_not_there_is_named():
    sample = mechanism("rimoldi-164")
    for name in ("Mrk", "point:B:magnitude", "joint_force:Q:magnitude"):
        with pytest.raises(UnknownNameError, match="signal"):
            design_figures(sample, {"rod.mass": [1.0]}, [Figure(name, Reduction.PEAK)], TURN, speed=SPEED)
