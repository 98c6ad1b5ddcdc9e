"""Figures of many designs by the kernels: those of a loop over linkages built one by one, whatever the linkage."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import signals
from analytic.compiled import choice
from analytic.compiled.design_figures import CHUNK, can_figure, compiled_figures
from analytic.compiled.flat_linkage import flatten, redesigned
from analytic.designs.figures import Figure, Reduction
from analytic.errors import AssemblyError, UnknownNameError
from analytic.evaluation import MovingSweep
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.sweep import Sweep
from tests.analytic.linkages import CATALOGUE, four_bars, from_text, mechanism, slider_cranks
from tests.analytic.loaded_linkages import ALL, on_trial

# Two orders of the same operations on the same numbers; relative to the signal's peak.
SAME = 1e-13
SPEED = -31.0  # rad/s
ANGLES = np.linspace(0.1, 6.2, 150)  # more than a block
CHOSEN = (0.35, 4.0)
REDUCED = {
    Reduction.PEAK: lambda x: np.max(np.abs(x)),
    Reduction.MEAN: np.mean,
    Reduction.RMS: lambda x: np.sqrt(np.mean(x**2)),
    Reduction.MAX: np.max,
    Reduction.MIN: np.min,
    Reduction.RANGE: np.ptp,
}

numba = pytest.mark.skipif(not choice.is_installed(), reason="numba is not installed")


def names_of(sample):
    """All signals that the kernels know, with the magnitudes of vectors."""
    crank = f"link:{sample.linkage.crank}:angle"
    names = [name for name in signals.names(sample) if name == crank or not name.endswith(":angle")]
    vectors = {name.rpartition(":")[0] for name in names if name.startswith(("joint_force:", "shaking_force:"))}
    return [*names, *(f"{vector}:magnitude" for vector in sorted(vectors))]


def designs_of(flat, count, spread=1e-3, seed=4):
    """Vectors of numbers near those of the linkage, the first its own."""
    draw = np.random.default_rng(seed)
    designs = flat.numbers * (1.0 + spread * draw.uniform(-1.0, 1.0, (count, len(flat.numbers))))
    designs[0] = flat.numbers
    return designs


def by_kernels(flat, designs, figures, angle=ANGLES, **settings):
    chosen = {"speed": SPEED, "cores": 1, "largest": flat.linkage, **settings}
    count = len(designs)
    return compiled_figures(flat, figures, angle, count=count, designs=lambda a, b: designs[a:b], **chosen)[0]


def moving(sample, flat, numbers, angle, speed, farthest=None):  # noqa: PLR0917
    """A design at crank angles, every link of which has been found to move; raises AssemblyError."""
    linkage = redesigned(flat, numbers)
    structure = find_structure(linkage).with_signs(tuple(dyad.sign for dyad in flat.structure.dyads))
    sweep = Sweep(linkage, structure, angle)
    for body in structure.bodies:
        sweep.rates(body)
    if farthest is None:
        farthest = np.max(sweep.output()) if linkage.output else 0.0
    return MovingSweep(sample, sweep, np.asarray(speed), np.asarray(0.0), farthest)


def values_of(at, name):
    vector, _, part = name.rpartition(":")
    if part == "magnitude":
        return np.hypot(signals.signal(at, f"{vector}:x"), signals.signal(at, f"{vector}:y"))
    return signals.signal(at, name)


def scale_of(at, name):
    """The peak by which a signal's digits are counted: of a force and of a moment that of the largest of its kind."""
    kind = name.partition(":")[0]
    kin = [other for other in signals.names(at.mechanism) if other.partition(":")[0] == kind]
    if kind in {"point", "link"}:
        kin = [other for other in kin if other.rpartition(":")[2][:1] == name.rpartition(":")[2][:1]]
    if kind == "joint_force":
        return max(np.max(np.abs(force)) for force in at.joint_forces.values())
    return max(np.max(np.abs(signals.signal(at, other))) for other in kin)


def check(sample, count=2, limit=SAME, angle=ANGLES, speed=SPEED):
    """All figures of some designs are those of the loop."""
    flat = flatten(sample)
    designs = designs_of(flat, count)
    names = names_of(sample)
    figures = [Figure(name, reduction) for name in names for reduction in REDUCED]
    figures += [Figure(name, Reduction.AT, chosen) for name in names for chosen in CHOSEN]
    found = by_kernels(flat, designs, figures, angle, speed=speed)
    for number in range(count):
        try:
            at = moving(sample, flat, designs[number], angle, speed)
        except AssemblyError:
            assert number > 0
            assert np.all(np.isnan(found[:, number]))
            continue
        there = moving(sample, flat, designs[number], np.array(CHOSEN), speed, at.farthest)
        scales = {name: scale_of(at, name) for name in names}
        for figure, value in zip(figures, found[:, number], strict=True):
            series = values_of(there if figure.reduction is Reduction.AT else at, figure.signal)
            if figure.reduction is Reduction.AT:
                expected = series[CHOSEN.index(figure.angle)]
            else:
                expected = REDUCED[figure.reduction](series)
            scale = max(scales[figure.signal], np.max(np.abs(series)))
            assert abs(value - expected) <= limit * scale, (figure, value, expected)


@numba
@pytest.mark.parametrize(("case", "is_laden"), ALL)
def test_every_figure_of_every_signal(case, is_laden):
    sample = on_trial(*case, is_laden)
    angle = ANGLES[np.sin(ANGLES) > 0.1] if case[0] == "parallelogram" else ANGLES
    limit = SAME if case in CATALOGUE else max(SAME, *relative_bounds(sample.sweep(angle)))
    if can_figure(sample.structure, []):
        check(sample, limit=limit, angle=angle)


@numba
def test_a_crank_at_rest_feels_static_forces():
    check(on_trial("carriage and crossed blocks", None, True), speed=0.0)


@numba
@given(st.one_of(four_bars().map(lambda drawn: drawn.text()), slider_cranks()), st.integers(1, 300))
@settings(max_examples=25)
def test_random_linkages(text, count):
    sample = from_text(text)
    check(sample, 1, max(relative_bounds(sample.turn)), np.linspace(0.0, 6.0, count))


PEAKS = [Figure(name, Reduction.PEAK) for name in ("Mkr", "S", "joint_force:A:magnitude", "transmission_angle:")]


def rimoldi():
    sample = mechanism("rimoldi-164")
    group = sample.structure.dyads[0].name
    return flatten(sample), [*PEAKS[:3], Figure(f"transmission_angle:{group}", Reduction.PEAK)]


@numba
@pytest.mark.parametrize("case", [("carriage and crossed blocks", None), ("pin in two slots", None)])
def test_what_the_ground_exerts_is_the_reverse_of_the_force_on_the_frame(case):
    sample = on_trial(*case, False)
    flat, linkage = flatten(sample), sample.linkage
    on_ground = [pin.joints for pin in linkage.pins if pin.hub == "ground"]
    names = [name for joints in on_ground for name in joints]
    names += [slider.name for slider in linkage.sliders if slider.guide.host == "ground"]
    designs = designs_of(flat, 5)
    for part in "xy":
        signals_of = [f"joint_force:{name}:{part}" for name in names] + [f"shaking_force:{part}"]
        found = by_kernels(flat, designs, [Figure(name, Reduction.AT, 1.3) for name in signals_of])
        assert np.max(np.abs(np.sum(found, axis=0))) <= SAME * np.max(np.abs(found))


@numba
def test_where_a_design_fails_at_any_angle_it_has_no_figures():
    flat, figures = rimoldi()
    designs = designs_of(flat, 300, spread=0.0)
    short = np.arange(300) % 7 == 3
    designs[short, flat.places["rod.B.x"]] *= 0.9
    designs[5, flat.places["link.D.x"]] *= 0.1  # a group that Mkr needs no less than S does, and joint A does not
    found = by_kernels(flat, designs, figures)
    lost = short | (np.arange(300) == 5)
    assert np.array_equal(np.isnan(found), np.broadcast_to(lost, found.shape))
    assert np.array_equal(found[:, ~lost], np.broadcast_to(found[:, :1], found[:, ~lost].shape))
    for figure in figures:  # whatever else is asked for
        assert np.array_equal(np.isnan(by_kernels(flat, designs, [figure])[0]), lost)


@numba
def test_one_angle_without_motion_is_enough():
    flat, figures = rimoldi()
    designs, turn = designs_of(flat, 1), np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    designs[0, flat.places["rod.B.x"]] *= 0.9
    able = np.array([_moves(flat, designs[0], phi) for phi in turn])
    assert 0 < np.sum(able) < len(turn)
    for unable in turn[~able][[0, -1]]:
        for one in (np.append(turn[able], unable), np.append(unable, turn[able])):
            assert np.all(np.isnan(by_kernels(flat, designs, figures, one)))
        chosen = [*figures, Figure("Mkr", Reduction.AT, unable)]
        assert np.all(np.isnan(by_kernels(flat, designs, chosen, turn[able])))
    assert np.all(np.isfinite(by_kernels(flat, designs, figures, turn[able])))


def _moves(flat, numbers, phi):
    try:
        moving(None, flat, numbers, np.array([phi]), SPEED)
    except AssemblyError:
        return False
    return True


@numba
def test_any_number_of_cores_gives_the_same_bits():
    flat, figures = rimoldi()
    figures += [Figure(one.signal, reduction) for one in figures for reduction in (Reduction.MEAN, Reduction.RMS)]
    designs = designs_of(flat, 2 * CHUNK + 5)
    whole = by_kernels(flat, designs, figures)
    for cores in (2, 3, None):
        assert np.array_equal(by_kernels(flat, designs, figures, cores=cores), whole)
    alone = by_kernels(flat, designs[700:701], figures)
    assert np.array_equal(alone[:, 0], whole[:, 700])


@numba
def test_kernels_are_compiled_once_for_all_linkages():
    from analytic.compiled.kernels import figures as code  # noqa: PLC0415 - it imports numba

    for case, is_laden in ALL[:12]:
        flat = flatten(on_trial(*case, is_laden))
        by_kernels(flat, designs_of(flat, 1), [Figure("Mkr", Reduction.PEAK)])
        by_kernels(flat, designs_of(flat, 1), [])
    assert len(code.reduced.signatures) == 1


def test_what_is_left_to_numpy():
    assert can_figure(mechanism("rimoldi-164").structure, ["Mkr", "link:crank:angle"])
    assert not can_figure(mechanism("rimoldi-164").structure, ["link:rod:angle"])
    assert not can_figure(mechanism("parallelogram").structure, ["Mkr"])


@numba
@pytest.mark.parametrize("name", ["Mrk", "joint_force:Q:x", "transmission_angle:rod", "point:Q:x"])
def test_signals_that_are_not_there(name):
    flat, _ = rimoldi()
    with pytest.raises(UnknownNameError):
        by_kernels(flat, designs_of(flat, 1), [Figure(name, Reduction.PEAK)])
