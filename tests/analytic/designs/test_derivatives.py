"""Exact derivatives against differences in 90 digits, of formulas that share none with the closed form."""

from collections.abc import Mapping
from functools import cache
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
from mpmath import mp, mpf

from analytic import signals
from analytic.description import walk
from analytic.description.changes import changed, numbers, with_numbers
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.designs.derivatives import differences, figure_gradients, is_exact, signal_gradients
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from tests.analytic import fifty_digits
from tests.analytic.fifty_digits import Exact, forces_of, signals_of
from tests.analytic.linkages import IN_LINE, from_text, mechanism, on_trial

SPEED = 20.0
# Between them they have every dyad, every joint, tables of loads, springs, dashpots and dampers.
TRIALS = [
    ("moving-guides", None),
    *(
        pytest.param(name, variant, marks=pytest.mark.nightly)
        for name, variant in (
            *(("rimoldi-164", "as-built"), ("shaper", None), ("slotted-takeup", "corrected")),
            ("three-on-one-pin", None),
        )
    ),
]
DERIVATIVE = 1e-12  # 8e-14 is reached
NONE = 1e-12
LEAST = 1e-20  # what is smaller is zero
NUDGE = mpf(10) ** -20  # and as small is the error of a difference over it
HERE = frozenset()  # no nudge


@pytest.fixture(autouse=True)
def _ninety_digits(monkeypatch):
    monkeypatch.setattr(fifty_digits, "DIGITS", 90)
    mp.dps = 90
    yield
    mp.dps = 15
    _exact.cache_clear()


def _nudged(linkage: Linkage, nudges: Mapping[str, mpf]) -> Linkage:
    """The linkage in many digits with numbers moved; those of loads, in which all is linear, by whole units."""

    def change(name: str, _: str, value: float) -> float | mpf:
        if _is_load(name):
            return value + float(nudges[name] / NUDGE) if name in nudges else value
        return mpf(value) + nudges.get(name, 0)

    with patch.object(walk, "unit_vector", lambda v: (v[0] / mp.hypot(*v), v[1] / mp.hypot(*v))):
        return changed(linkage, change)


@cache
def _exact(sample: Mechanism, angle: float, nudges: frozenset[tuple[str, mpf]]) -> Exact:
    sweep = sample.sweep(angle)
    linkage = _nudged(sample.linkage, dict(nudges))
    return Exact(SimpleNamespace(linkage=linkage, poses=sweep.poses, angle=angle, zero_of_s=sweep.zero_of_s))


def _differences(sample: Mechanism, angle: float, parameters: list[str], names: list[str]) -> np.ndarray:
    """Derivatives of signals by numbers and the speed (signals, parameters), in many digits."""
    result = []
    for nudges in (HERE, *(_nudge(one) for one in parameters)):
        at, speed = _exact(sample, angle, nudges), SPEED + dict(nudges).get("speed", mpf(0))
        values = signals_of(at, speed) | forces_of(at, speed)
        result.append([values[one] for one in names])
    steps = [1 if _is_load(one) else NUDGE for one in parameters]
    return np.array([[float((b - a) / step) for a, b in zip(result[0], row, strict=True)]
                     for row, step in zip(result[1:], steps, strict=True)]).T  # fmt: skip


def _nudge(name: str) -> frozenset[tuple[str, mpf]]:
    return frozenset({(name, NUDGE)})


def _is_load(name: str) -> bool:
    return name.startswith(("forces.", "torques."))


def _of_every_kind(linkage: Linkage, seed: int) -> dict[str, float]:
    """A number of every kind that the linkage has, two lengths of links among them."""
    result: dict[str, list[tuple[str, float]]] = {}

    def note(name: str, kind: str, value: float) -> float:
        if not name.startswith("sketch."):
            place = "centre" if ".centre." in name else "through" if ".through." in name else ""
            result.setdefault(f"{kind} {place}", []).append((name, value))
        return value

    changed(linkage, note)
    draw = np.random.default_rng(seed)
    return dict(names[draw.integers(len(names))] for names in result.values())


@pytest.mark.parametrize(("name", "variant"), TRIALS)
def test_every_signal_has_the_derivatives_of_ninety_digits(name, variant):
    sample = on_trial(name, variant, True)
    angle = 0.7
    chosen = _of_every_kind(sample.linkage, 3) | {"speed": SPEED}
    others = ("trans", "shak", "thread")
    names = [
        one
        for one in signals.names(sample)
        if one not in ("phi", "omega", "epsilon", "S") and not one.startswith(others)
    ]
    values, gradients = signal_gradients(sample, chosen, names, [angle], speed=SPEED)
    expected = _differences(sample, angle, list(chosen), names)
    units = np.array([signals.unit(one, sample.linkage) for one in names])
    for unit in {*units}:  # over the largest derivative of its unit by that number, or the values where there is none
        own = units == unit
        largest = np.max(np.abs(values[own]))
        scale = np.max(np.abs(expected[own]), axis=0)
        scale = np.where(scale > NONE * largest + LEAST, scale, largest + LEAST)
        error = np.max(np.abs(gradients[own, :, 0] - expected[own]), axis=0)
        assert np.all(error <= DERIVATIVE * scale), (unit, dict(zip(chosen, error, strict=True)))


@pytest.mark.parametrize(("name", "variant"), TRIALS)
def test_figures_are_those_of_designs_and_move_as_theirs_do(name, variant):
    sample, places = on_trial(name, variant, False), np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)
    names = [
        *(one for one in signals.names(sample) if one.startswith(("Mkr", "S", "trans"))),
        "v",
        "shaking_force:magnitude",
    ]
    figures = [Figure(one, how) for one in names for how in Reduction if how is not Reduction.AT and _has(sample, one)]
    links = {f"{name}.{point}.x" for name, link in sample.linkage.links.items() for point in link.points}
    number, value = next((one, size) for one, size in numbers(sample.linkage).items() if one in links and size)
    values, gradients = figure_gradients(sample, {number: value}, figures, places, speed=SPEED, period=FULL_TURN)
    near = value + 1e-5 * (abs(value) or 0.1) * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    result = design_figures(sample, {number: near}, figures, places, speed=SPEED, period=FULL_TURN, refine=True)
    other = np.abs(result + values[:, None]) < 1e-3 * np.abs(result)  # of tops that tie either is right
    result = np.where(other, -result, result)
    assert values == pytest.approx(result[:, 2], rel=1e-9, abs=1e-12)
    slopes = (8.0 * (result[:, 3] - result[:, 1]) - (result[:, 4] - result[:, 0])) / (12.0 * (near[3] - near[2]))
    known, least = np.isfinite(gradients[:, 0]), 1e-6 * np.max(np.abs(slopes)) + 1e-8 * np.max(np.abs(values))
    assert np.count_nonzero(known) >= len(figures) // 2
    assert gradients[known, 0] == pytest.approx(slopes[known], rel=1e-5, abs=least)


def _has(sample: Mechanism, name: str) -> bool:
    return name.endswith(":magnitude") or name in signals.names(sample)


@pytest.mark.parametrize(("name", "variant"), TRIALS)
def test_shaking_has_the_derivatives_of_differences(name, variant):
    sample = on_trial(name, variant, True)
    chosen = _of_every_kind(sample.linkage, 3)
    names = [one for one in signals.names(sample) if one.startswith("shak")]
    _, gradients = signal_gradients(sample, chosen, names, [0.7, 4.0], speed=SPEED)

    def values(own):
        design = sample.redesigned(with_numbers(sample.linkage, own))
        return np.stack([*signals.evaluate(design, [0.7, 4.0], names, speed=SPEED).values()])

    steps = {one: 1e-3 * (abs(value) or 0.1) for one, value in chosen.items()}
    _, slopes, errors = differences(values, chosen, steps)
    assert np.all(np.abs(gradients - slopes) <= 1e-8 * np.abs(slopes) + errors + 1e-9 * np.max(np.abs(slopes)))


def test_tops_that_tie_have_a_derivative_only_where_they_have_it_in_common():
    sample = from_text(IN_LINE)
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    chosen = {"rod.B.x": 0.11, "piston.through.y": 0.0}
    figures = [Figure("v", Reduction.PEAK), Figure("v", Reduction.MAX)]
    values, gradients = figure_gradients(sample, chosen, figures, angle, speed=SPEED, period=FULL_TURN)
    assert values[0] == pytest.approx(values[1], rel=1e-12)
    assert np.all(np.isfinite(gradients[:, 0]))
    assert np.isnan(gradients[0, 1])  # the offset makes one stroke faster and the other slower
    assert np.isfinite(gradients[1, 1])


def test_linkages_without_closed_form_have_differences_on_both_sides_of_a_mass_of_zero():
    sample, angle = mechanism("parallelogram"), np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    assert not is_exact(sample)
    assert is_exact(mechanism("rimoldi-164", "as-built"))
    _, gradients = signal_gradients(sample, {"coupler.mass": 0.0}, ["Jeq"], [0.7, 2.0], speed=SPEED)
    radius = sample.linkage.local("A", sample.linkage.crank)[0]
    assert gradients[0, 0] == pytest.approx([radius**2] * 2, rel=1e-9)  # its coupler turns about a circle
    figures = [Figure("Jeq", Reduction.MEAN), Figure("Mkr", Reduction.AT, 0.7)]
    none, whole = (
        figure_gradients(sample, {"coupler.mass": m}, figures, angle, speed=SPEED, period=FULL_TURN) for m in (0.0, 1.0)
    )
    assert none[1] == pytest.approx(whole[1], rel=1e-9)  # both are linear in it
    assert whole[0] - none[0] == pytest.approx(none[1][:, 0], rel=1e-9)
    with pytest.raises(LinkproofError, match="none negative"):
        figure_gradients(sample, {"coupler.mass": -0.1}, figures, angle, speed=SPEED, period=FULL_TURN)


def test_wrong_names_and_designs_that_cannot_be_assembled_are_refused():
    sample = mechanism("rimoldi-164", "as-built")
    with pytest.raises(UnknownNameError, match=r"rod\.B\.x"):
        signal_gradients(sample, {"rod.B.X": 0.2}, ["Mkr"], [0.0], speed=SPEED)
    with pytest.raises(AssemblyError, match="cannot be assembled"):
        signal_gradients(sample, {"rod.B.x": 0.05}, ["Mkr"], [0.0], speed=SPEED)


def test_the_rms_of_what_stays_zero_has_no_slope():
    wanted = [Figure("epsilon", Reduction.RMS)]  # at constant speed
    angle = np.linspace(0.0, 6.0, 20)
    sample = mechanism("juki-mf7923d")
    values, slopes = figure_gradients(sample, {"crank.mass": 1.0}, wanted, angle, speed=9.0, period=None)
    assert (values.tolist(), slopes.tolist()) == ([0.0], [[0.0]])
