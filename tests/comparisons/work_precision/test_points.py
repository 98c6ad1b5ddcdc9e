"""A sweep goes on while it pays, and says why it stops."""

import dataclasses
import math

import pytest

from comparisons.work_precision.measure import Taken
from comparisons.work_precision.points import FULL, OUT_OF_TIME, QUICK, Point, Track, tracks
from comparisons.work_precision.records import PointError
from engines.contract import Method, Setting

METHOD = Method("plain", "as it comes", effort_unit="iterations")
STEPS = (12.0, 24.0, 48.0, 96.0, 192.0)


def _track(budget=math.inf):
    return Track([Point(0, "alpha", method=METHOD, steps_per_turn=n) for n in STEPS], budget)


def _taken(error, seconds=1e-3, also=None):
    errors = {"Mkr": PointError("N m", error, error, 1.0)} | (
        {"Jeq": PointError("kg m²", also, also, 1.0)} if also else {}
    )
    return Taken("finished", seconds=seconds, errors=errors)


def _failed(outcome="diverged"):
    return Taken(outcome, "why")


def _run(track, results):
    """Feed results to a track until it wants no more; how many it took."""
    for number, taken in enumerate(results):
        if track.next() is None:
            return number
        track.take(taken)
    return len(results) if track.next() is None else None


def test_a_sweep_ends_at_its_last_step():
    track = _track()
    assert _run(track, [_taken(10.0**-k) for k in range(5)]) == 5
    assert track.ended == "the sweep ends here"


def test_two_refinements_that_improve_nothing_end_it():
    track = _track()
    assert _run(track, [_taken(e) for e in (1e-2, 1e-3, 1e-3, 1e-3, 1e-3)]) == 4
    assert "two refinements in a row" in track.ended


def test_a_quantity_that_still_improves_keeps_it_going():
    track = _track()
    assert _run(track, [_taken(1e-3, also=10.0**-k) for k in range(5)]) == 5


def test_a_point_that_would_take_too_long_is_not_begun():
    track = _track(budget=0.1)
    assert _run(track, [_taken(10.0**-k, seconds=0.02 * 2**k) for k in range(5)]) == 3
    assert "would take about 0.16 s, over 0.1 s" in track.ended


def test_one_slow_run_does_not_end_a_sweep():
    track = _track(budget=0.1)
    times = [0.001, 0.002, 0.09, 0.008, 0.016]
    assert _run(track, [_taken(10.0**-k, seconds=times[k]) for k in range(5)]) == 5


@pytest.mark.parametrize(
    ("results", "count"),
    [
        ([_failed()] * 5, 3),
        ([_failed(), _failed(), *[_taken(10.0**-k) for k in range(3)]], 5),
        ([_taken(1e-1), _failed()], 2),
        ([_failed("timed-out")], 1),
        ([_failed("unsupported")], 1),
        ([_failed("not-provided")], 1),
    ],
)
def test_failures_end_a_sweep_unless_a_shorter_step_may_cure_them(results, count):
    track = _track()
    assert _run(track, results) == count
    if count < 5:
        assert track.ended.endswith("why")


def test_no_time_left_ends_it_without_a_point():
    track = _track()
    track.next()
    track.take(None)
    assert track.next() is None
    assert (track.ended, track.taken) == (OUT_OF_TIME, [])


def test_settings_methods_and_other_efforts_are_swept():
    fixed = dataclasses.replace(METHOD, name="fixed", effort_unit="")
    found = tracks(0, "alpha", [METHOD, fixed], tuple(Setting), FULL, efforts=True)
    assert [track.points[0].setting for track in found[:3]] == list(Setting)
    efforts = [(track.points[0].method.name, track.points[0].method.effort) for track in found[3:]]
    assert efforts == [("plain", None), *(("plain", e) for e in (10.0, 30.0, 100.0, 300.0)), ("fixed", None)]
    assert len(found[3].points) == len(FULL.steps_per_turn)
    assert len(found[4].points) == len(FULL.steps_per_turn) / 2


def test_a_quick_benchmark_tries_no_other_efforts():
    assert len(tracks(0, "alpha", [METHOD], (), QUICK, efforts=True)) == 1


def test_every_point_of_a_benchmark_has_a_key_of_its_own():
    found = tracks(0, "alpha", [METHOD], tuple(Setting), FULL, efforts=True)
    found += tracks(1, "alpha", [METHOD], tuple(Setting), FULL, efforts=False)
    keys = [point.key for track in found for point in track.points]
    assert len(set(keys)) == len(keys)


@pytest.mark.parametrize("extent", [FULL, QUICK])
def test_steps_are_swept_coarse_to_fine(extent):
    assert list(extent.steps_per_turn) == sorted(set(extent.steps_per_turn))
