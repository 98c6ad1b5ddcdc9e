"""Clocks: what they say of given samples, and that what is measured is there; no limit on any time."""

import gc

import pytest

from comparisons.runs.timing import Noise, calibrate, no_collection, timed


def test_noise_is_relative_to_the_shortest():
    noise = Noise((2.0, 1.0, 1.1, 1.2, 1.1, 1.0, 1.1, 1.3, 1.1, 1.1, 1.1))
    assert noise.least == 1.0
    assert noise.median_excess == pytest.approx(0.1)
    assert noise.spread == pytest.approx(0.3)
    nothing = Noise(())
    assert (nothing.least, nothing.median_excess, nothing.spread) == (0.0, 0.0, 0.0)


def test_the_fixed_work_takes_time():
    assert calibrate() > 0.0


def test_work_is_timed_with_the_collector_off_and_the_collector_comes_back():
    assert gc.isenabled()
    collecting, seconds = timed(gc.isenabled)
    assert (collecting, gc.isenabled()) == (False, True)
    assert seconds > 0.0
    gc.disable()
    try:
        with no_collection():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
