"""Contests of speed: run in turns, void where the numbers differ. Times are measured, never asserted."""

import math

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code import compiling
from tests.targets import speed

ANGLES = 300
SIX_BAR = "rimoldi-164"
VARIED = ("rod.B.x", "rocker.B.x")


def test_contestants_take_turns_after_a_warm_up_of_their_own():
    calls = []
    contestants = {name: lambda name=name: calls.append(name) for name in "ab"}
    spent = speed.race(contestants, 3, {"b": lambda: calls.append("warm b")})
    assert calls == ["a", "warm b", *"ababab"]
    assert {name: len(seconds) for name, seconds in spent.items()} == {"a": 3, "b": 3}
    assert all(second >= 0.0 for seconds in spent.values() for second in seconds)


def test_a_ratio_is_of_the_shortest_repeats_and_keeps_all():
    contest = speed.Contest({"ours": (2.0, 3.0, 8.0), "theirs": (20.0, 6.0, 4.0)}, 2)
    found = speed.over(contest, "ours", "theirs", "s", 1.0)
    assert found.reached == 0.5
    assert found.repeats == (0.1, 0.5, 2.0)
    assert found.detail == "ours: 1 s, median 1.5 s; theirs: 2 s, median 3 s"


def test_a_time_is_per_piece_of_work():
    found = speed.each(speed.Contest({"ours": (4e-6, 2e-6)}, 100), "ours", "ns", 1e-9)
    assert found.repeats == pytest.approx((40.0, 20.0))
    assert found.reached == pytest.approx(20.0)


def test_a_void_contest_reaches_nothing():
    contest = speed.Contest({"ours": (1.0,), "theirs": (9.0,)}, 1, "theirs is off")
    assert speed.over(contest, "ours", "theirs", "s", 1.0).reached == math.inf
    assert speed.each(contest, "ours", "s", 1.0) == speed.Measured("ours", math.inf, (1.0,), "theirs is off")


@pytest.mark.parametrize("name", ["compiled", "theirs"])
def test_an_absent_contestant_gives_no_figure(name):
    seconds = {"compiled": (1.0,), "theirs": (1.0,)}
    del seconds[name]
    found = speed.over(speed.Contest(seconds, 1), "compiled", "theirs", "s", 1.0)
    assert math.isnan(found.reached)
    assert found.subject == ("numba is not installed" if name == "compiled" else "theirs is not installed")


def test_without_numba_there_is_no_contest(monkeypatch):
    monkeypatch.setattr(compiling, "is_installed", lambda: False)
    empty = (
        speed.six_bar_contest(SIX_BAR, 1),
        speed.designs_contest(SIX_BAR, VARIED, 1, 1),
        speed.forward_contest("slotted-takeup", "free"),
    )
    assert not any(contest.seconds for contest in empty)
    assert math.isnan(speed.each(empty[1], speed.OURS, "ns", 1e-9).reached)
    speed.six_bar_contest.cache_clear()
    speed.forward_contest.cache_clear()


def test_every_six_bar_gives_the_same_numbers():
    pytest.importorskip("numba")
    pytest.importorskip("pylinkage")
    contest = speed.six_bar_contest(SIX_BAR, ANGLES)
    assert contest.fault == ""
    assert set(contest.seconds) == {"compiled", "NumPy", "hand-written kernel", "pylinkage"}
    assert {len(repeats) for repeats in contest.seconds.values()} == {speed.REPEATS}


def test_a_contestant_with_other_numbers_is_found_out():
    mechanism, angle = Mechanism(load(SIX_BAR)), np.linspace(0.0, 6.0, 50)
    truth = speed._plain(mechanism, ("A", "D"), angle)
    wrong = truth.copy()
    wrong[1, 2, 1, 7] *= 1.0 + 1e-6
    contestants = {"NumPy": lambda: truth, "theirs": lambda: wrong}
    assert speed._difference(contestants).startswith("theirs differs from NumPy by")
    assert speed._difference({"NumPy": lambda: truth, "same": truth.copy}) == ""


def test_every_design_of_the_contest_can_be_assembled():
    pytest.importorskip("numba")
    contest = speed.designs_contest(SIX_BAR, VARIED, 20, 30)
    assert (contest.fault, contest.count) == ("", 600)


@pytest.mark.parametrize(("within", "faults"), [(speed.WITHIN, 0), (0.0, 2)])
def test_motions_count_within_the_error_asked_for(monkeypatch, within, faults):
    pytest.importorskip("numba")
    monkeypatch.setattr(speed, "WITHIN", within)
    speed.forward_contest.cache_clear()
    contest = speed.forward_contest("slotted-takeup", "free")
    assert contest.fault.count("is off by") == faults
    assert set(contest.seconds) == {"NumPy", "DOP853"}
    speed.forward_contest.cache_clear()
