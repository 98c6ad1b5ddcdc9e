"""Extremes and zeros lie between the samples of the grid."""

import numpy as np
import pytest

from analytic.numerics.refine import extremes, in_turn, zeros
from tests.analytic.tolerances import EPS


def test_a_peak_that_the_grid_shows_lower_than_another_wins():
    def two_peaks(phi):  # the higher one lies half-way between samples, the lower one on a sample
        sharp, step = 40.0, 2.0 * np.pi / 90
        higher = 1.001 * np.exp(sharp * (np.cos(phi - 10.5 * step) - 1.0))
        return higher + np.exp(sharp * (np.cos(phi - 50.0 * step) - 1.0))

    assert extremes(two_peaks, 90).maximum == pytest.approx(1.001, rel=1e-9)


def test_zeros_are_exact_and_sorted_also_of_a_function_that_all_but_jumps():
    even = zeros(lambda phi: np.sin(2.0 * phi - 0.5))
    assert np.allclose(even, 0.25 + 0.5 * np.pi * np.arange(4), rtol=0.0, atol=4 * EPS * 2.0 * np.pi)
    steep = zeros(lambda phi: np.tanh(60.0 * np.sin(phi - 1.0)), 12)
    assert np.allclose(steep, [1.0, 1.0 + np.pi], rtol=0.0, atol=8 * EPS * np.pi)
    assert len(zeros(lambda phi: 2.0 + np.cos(phi))) == 0


def test_angles_are_brought_below_a_full_turn():
    angles = in_turn(np.array([-1e-17, 0.0, 1.0, 2.0 * np.pi, 2.0 * np.pi + 1.0, -1.0]))
    assert np.all((angles >= 0.0) & (angles < 2.0 * np.pi))
    assert angles[0] == angles[3] == 0.0
    assert angles[[2, 4, 5]] == pytest.approx([1.0, 1.0, 2.0 * np.pi - 1.0])
