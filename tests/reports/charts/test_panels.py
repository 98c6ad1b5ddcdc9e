"""Thinning hides no peak."""

import numpy as np

from reports.charts.panels import envelope, last_turn, thinned


def test_a_single_spike_survives_thinning():
    time = np.linspace(0.0, 1.0, 50_001)
    values = np.sin(20.0 * time)
    values[31_234], values[40_003] = 9.0, -7.0
    short_time, short = thinned(time, values, buckets=100)
    assert len(short) <= 2 * 101 + 2
    assert (short.max(), short.min()) == (9.0, -7.0)
    assert short_time[0] == time[0]
    assert short_time[-1] == time[-1]
    assert np.all(np.diff(short_time) > 0.0)


def test_short_curves_come_back_whole():
    time = np.arange(10.0)
    assert thinned(time, time**2)[1] is not None
    np.testing.assert_array_equal(thinned(time, time**2)[1], time**2)


def test_an_envelope_keeps_the_largest_and_skips_gaps():
    time = np.linspace(0.0, 1.0, 10_007)
    error = np.abs(np.sin(300.0 * time)) * 1e-6
    error[7000], error[:50] = 3e-4, np.nan
    found_time, found = envelope(time, error, buckets=100)
    assert found.max() == 3e-4
    assert len(found) <= 101
    assert found_time.min() >= time[50]
    assert not np.isnan(found).any()


def test_an_envelope_of_nothing_is_empty():
    assert len(envelope(np.arange(5.0), np.zeros(5))[1]) == 0


def test_the_last_turn_is_one_turn_in_order_of_its_angle():
    angle = np.linspace(0.0, 23.0, 2301)
    order = last_turn(angle)
    within = angle[order] % (2.0 * np.pi)
    assert np.all(np.diff(within) >= 0.0)
    assert angle[order].min() > 23.0 - 2.0 * np.pi
    assert len(last_turn(-angle)) == len(order)
