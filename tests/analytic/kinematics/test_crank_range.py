"""How far a crank turns, against the law of cosines in 50 digits, also where range or gap are narrow."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from analytic.errors import AssemblyError
from tests.analytic.linkages import DOUBLE_ROCKER, FOLDER, file_text, four_bar, from_text, text_of
from tests.analytic.tolerances import EPS

LENGTHS = st.floats(0.1, 10.0)
# Errors of a length in roundings; over the length's slope they are those of an angle.
ROUNDINGS = 32 * EPS


def sample(*numbers):
    """A four-bar of the textbook."""
    return from_text(four_bar(*numbers))


def cosine_law(ground, crank, reach):
    """The crank angle in 50 digits at which A and B are ``reach`` apart, and its change by one of the lengths' share.

    None where they never are.
    """
    mp.dps = 50
    g, a, r = map(abs, map(mpf, (ground, crank, reach)))
    cosine = (g**2 + a**2 - r**2) / (2 * g * a)
    if not abs(cosine) < 1:
        return None
    angle = mp.acos(cosine)
    return float(angle), float(max(g, a, r) ** 2 / (g * a * mp.sin(angle)))


def expected_range(ground, crank, coupler, rocker):
    """Both limits of a four-bar whose crank starts between 0 and π, with their conditions; none for a full turn."""
    inner = cosine_law(ground, crank, mpf(coupler) - mpf(rocker))
    outer = cosine_law(ground, crank, mpf(coupler) + mpf(rocker))
    if inner is None and outer is None:
        return None
    low = inner or (-outer[0], outer[1])
    high = outer or (2 * math.pi - inner[0], inner[1])
    return low, high


def hold(result, expected):
    assert result.is_full_turn == (expected is None)
    for limit, (angle, condition) in zip((result.low, result.high), expected or (), strict=False):
        assert abs(limit.angle - angle) <= ROUNDINGS * condition


@settings(max_examples=25)
@given(LENGTHS, LENGTHS, LENGTHS, LENGTHS, st.floats(0.05, 0.95))
def test_four_bars(ground, crank, coupler, rocker, share):
    low, high = max(abs(ground - crank), abs(coupler - rocker)), min(ground + crank, coupler + rocker)
    assume(high > 1.001 * low)
    assume(low > 1e-3)  # else A comes onto B
    start = cosine_law(ground, crank, low + share * (high - low))
    assume(start is not None)
    for limit in (cosine_law(ground, crank, coupler - rocker), cosine_law(ground, crank, coupler + rocker)):
        assume(limit is None or limit[1] < 1e6)
    hold(sample(ground, crank, coupler, rocker, start[0]).crank_range(), expected_range(ground, crank, coupler, rocker))


@pytest.mark.parametrize("rocker", [1e-2, 1e-5])
def test_a_range_narrower_than_any_step(rocker):
    start = cosine_law(1.0, 0.8, 0.9)[0]
    result = sample(1.0, 0.8, 0.9, rocker, start).crank_range()
    hold(result, expected_range(1.0, 0.8, 0.9, rocker))
    assert result.limits[1] - result.limits[0] < 4 * rocker


@pytest.mark.parametrize("short", [1e-4, 1e-12])
def test_a_gap_narrower_than_any_step(short):
    hold(sample(1.0, 0.4, 0.9, 0.5 - short, 1.0).crank_range(), expected_range(1.0, 0.4, 0.9, 0.5 - short))
    assert sample(1.0, 0.4, 0.9, 0.5 + short, 1.0).crank_range().is_full_turn


@settings(max_examples=20)
@given(st.floats(0.2, 0.95), st.floats(-0.9, 0.9))
def test_slider_cranks_whose_rod_is_too_short(rod, offset):
    """The rod reaches the guide where |r sin φ - e| <= l, up to two arcs; with the crank at 0 it starts in one."""
    assume(abs(offset) < 0.99 * rod and rod + abs(offset) < 0.999)
    text = (
        text_of("centric-slider-crank")
        .replace("0.25", repr(1.0 + rod))
        .replace("D = [0.2, 0] }", f"D = [{rod!r}, 0] }}")
    )
    text = text.replace("A = [0.05, 0]", "A = [1, 0]").replace("through = [0, 0]", f"through = [0, {offset!r}]")
    sample = from_text(text)
    result = sample.crank_range(0.0)
    expected = [float(mp.asin(mpf(offset) + side * mpf(rod))) for side in (-1, 1)]
    assert result.limits == pytest.approx(expected, rel=0, abs=ROUNDINGS / (1.0 - rod - abs(offset)))
    assert "'rod' square to the guide of 'piston'" in result.low.sentence


TANGENT = file_text("tangent")


def test_guides_that_become_parallel():
    """A slotted link on a line through the crank's pivot: it reaches to infinity a quarter turn either way."""
    result = from_text(TANGENT).crank_range()
    assert result.limits == pytest.approx([-math.pi / 2, math.pi / 2], rel=0, abs=4 * EPS)
    assert "parallel" in result.high.sentence


def test_a_parallelogram_that_is_pushed_ends_at_its_change_point():
    """The cylinder from (20, -50) to (10, 0) on the crank, which is then in line with the frame."""
    text = (FOLDER / "parallelogram.toml").read_text()
    for old, new in (
        ('crank   = "crank"', 'cylinder = { between = ["P", "Q"] }'),
        ("O1 = [0, 0]\nO2", "O1 = [0, 0]\nP = [20, -50]\nO2"),
        ("points  = { O1 = [0, 0], A = [25, 0] }", "points  = { O1 = [0, 0], A = [25, 0], Q = [10, 0] }"),
        ("angle  = 90", "angle  = 63.24"),
        ("{ B = [60, 25] }", "{ B = [60, 25], A = [0, 25], Q = [0, 10] }"),
    ):
        assert old in text
        text = text.replace(old, new)
    result = from_text(text).crank_range()
    assert result.low.angle == pytest.approx(math.hypot(0.01, 0.05), rel=0, abs=1e-9)
    assert result.low.sentence == "coupler + rocker (RRR): folded in one line"
    assert result.change_points == ()


def test_limits_have_a_sentence_each_and_a_start_or_motion_beyond_them_is_refused():
    rocker = from_text(DOUBLE_ROCKER)
    result = rocker.crank_range()
    assert result.low.sentence == "coupler + rocker (RRR): folded in one line"
    assert result.high.sentence == "coupler + rocker (RRR): stretched in one line"
    assert result.low.angle < result.start < result.high.angle
    at_the_limit = rocker.crank_range(result.high.angle)
    assert at_the_limit.limits == pytest.approx(result.limits, rel=0, abs=1e-14)
    with pytest.raises(AssemblyError, match=r"cannot be assembled at 0°: 'coupler' \(60 mm\) and 'rocker' \(90 mm\)"):
        rocker.crank_range(0.0)
    result.check(*result.limits, "pendulum")
    message = (
        r"'sample' cannot be moved from 20° to 120°: its crank reaches 14\.3615° to 112\.411° \(at 112\.411° "
        r"coupler \+ rocker \(RRR\): stretched in one line\); stay within"
    )
    with pytest.raises(AssemblyError, match=message):
        result.check(np.radians(20.0), np.radians(120.0), "sample")
