"""The motion of article 000's slotted take-up in extended precision, with none of the code on trial.

Reduced inertia and potential follow from the article's formulas; they are sampled over a turn and differentiated as
Fourier series, so that no derivative is written down by hand. The motion is integrated by Gragg's extrapolated midpoint
rule, which has nothing in common with collocation.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from mpmath import mp, mpf

from tests.analytic.articles import FORMULAS, reduced_inertia
from tests.analytic.fifty_digits import DIGITS

Long = np.longdouble
PI = Long("3.141592653589793238462643383279502884")
DEGREE = PI / 180
SAMPLES, HARMONICS = 256, 64  # the series has fallen below 1e-22 by order 50
COLUMNS = 8  # order 16


def _long(values):
    return np.array([Long(mp.nstr(value, 25)) for value in values])


def _harmonics(phi):
    """exp(i k φ) for every order k."""
    powers = np.full((HARMONICS, *np.shape(phi)), np.exp(1j * phi))
    powers[0] = 1
    return np.multiply.accumulate(powers, axis=0)


ORDERS = np.arange(HARMONICS)


@cache
def _samples():
    return _harmonics(2 * PI * np.arange(SAMPLES) / SAMPLES)


def _series(values):
    """Coefficients c of values(φ) = Re Σ c exp(i k φ)."""
    series = 2 * (_samples().conj() @ values.astype(np.clongdouble)) / SAMPLES
    series[0] /= 2
    return series


@cache
def reduced():
    """Fourier coefficients of Jeq, kg m², ½ Jeq' and Q, N m; shape (3, HARMONICS)."""
    formula = FORMULAS["slotted-takeup", "corrected"]
    with mp.workdps(DIGITS):
        places = [2 * mp.pi * number / SAMPLES for number in range(SAMPLES)]
        jeq = _long(reduced_inertia(formula, phi) for phi in places)
        moments = (sum(mass * s.imag for mass, _, s, _ in formula(phi).links.values()) for phi in places)
        potential = _long(mpf("9.81") * moment / 1000 for moment in moments)  # mm
    inertia, energy = _series(jeq), _series(potential)
    return np.stack([inertia, 1j * ORDERS * inertia / 2, -1j * ORDERS * energy])


def acceleration(phi, omega, torque, damping):
    """Article 000, eq (32), with the scalar product in k2."""
    jeq, half_slope, force = (reduced() @ _harmonics(phi)).real
    return (force + torque - omega * (damping + half_slope * omega)) / jeq


def motion(times, start_angle, torque, damping, steps_per_second):
    """φ at increasing times from rest, rad, by extrapolated steps of Gragg's rule."""
    state, time, result = np.array([start_angle, 0], dtype=Long), Long(0), []
    for instant in times:
        steps = int(np.ceil(float(Long(instant) - time) * steps_per_second))
        step = (Long(instant) - time) / steps
        for _ in range(steps):
            state = _extrapolated(state, step, torque, damping)
        time = Long(instant)
        result.append(state[0])
    return np.array(result)


def _extrapolated(state, step, torque, damping):
    def rate(y):
        return np.array([y[1], acceleration(y[0], y[1], torque, damping)])

    row, first = [], rate(state)
    for column in range(COLUMNS):
        count = 2 * (column + 1)
        h = step / count
        before, now = state, state + h * first
        for _ in range(count - 1):
            before, now = now, before + 2 * h * rate(now)
        new = [(now + before + h * rate(now)) / 2]
        for back, old in enumerate(row):
            ratio = (Long(column + 1) / (column - back)) ** 2
            new.append(new[-1] + (new[-1] - old) / (ratio - 1))
        row = new
    return row[-1]
