"""The slotted take-up of article 000 from its own formulas, in extended precision and with none of the code on trial.

Eqs (1)-(16) are typed as printed, with the readings that ``mechanisms.md`` explains. Reduced inertia and potential are
sampled over a turn and differentiated as Fourier series, so that no derivative is written down by hand; the motion is
integrated by Gragg's extrapolated midpoint rule, which has nothing in common with collocation.
"""

from __future__ import annotations

from functools import cache

import numpy as np

Long = np.longdouble
PI = Long("3.141592653589793238462643383279502884")
DEGREE = PI / 180
SAMPLES, HARMONICS = 256, 64  # the series has fallen below 1e-22 by order 50
COLUMNS = 8  # order 16
G = Long("9.81")


def _number(text: str) -> np.longdouble:
    return Long(text)


def _turned(x, y, angle, scale):
    return (x * np.cos(angle) - y * np.sin(angle)) * scale, (x * np.sin(angle) + y * np.cos(angle)) * scale


def centres_and_angles(phi):
    """Mass centres S1 … S5, m, and unit vectors along links 1, 2, 5 (the slider turns with the slot)."""
    mm = Long("1e-3")
    l1, l2, ln2 = _number("16.3") * mm, _number("44.2") * mm, _number("10") * mm
    p5 = (_number("11.7") * mm, _number("35.69") * mm)
    p2 = l1 * np.cos(phi), l1 * np.sin(phi)
    p3 = 0 * phi, p2[1] - np.sqrt(l2**2 - p2[0] ** 2)
    arm = p3[0] - p2[0], p3[1] - p2[1]
    p4 = tuple(a + b for a, b in zip(p2, _turned(*arm, -90 * DEGREE, ln2 / l2), strict=True))
    slot = p4[0] - p5[0], p4[1] - p5[1]
    reach = np.sqrt(slot[0] ** 2 + slot[1] ** 2)
    s1 = 5 * mm * np.cos(phi + PI), 5 * mm * np.sin(phi + PI)
    s2 = tuple(a + b for a, b in zip(p2, _turned(*arm, 30 * DEGREE, 10 * mm / l2), strict=True))
    s3 = p3[0], p3[1] + 10 * mm
    s5 = tuple(a + b for a, b in zip(p5, _turned(*slot, 45 * DEGREE, 15 * mm / reach), strict=True))
    directions = (np.cos(phi), np.sin(phi)), (arm[0] / l2, arm[1] / l2), (slot[0] / reach, slot[1] / reach)
    return (s1, s2, s3, p4, s5), directions


def _harmonics(phi):
    """exp(i k φ) for every order k."""
    powers = np.full((HARMONICS, *np.shape(phi)), np.exp(1j * phi))
    powers[0] = 1
    return np.multiply.accumulate(powers, axis=0)


ORDERS = np.arange(HARMONICS)


@cache
def _samples():
    phi = 2 * PI * np.arange(SAMPLES) / SAMPLES
    return phi, _harmonics(phi)


def _series(values):
    """Coefficients c of values(φ) = Re Σ c exp(i k φ)."""
    _, harmonics = _samples()
    series = 2 * (harmonics.conj() @ values.astype(np.clongdouble)) / SAMPLES
    series[0] /= 2
    return series


def _derivative(values):
    _, harmonics = _samples()
    return ((1j * ORDERS * _series(values)) @ harmonics).real


@cache
def reduced():
    """Fourier coefficients of Jeq, kg m², ½ Jeq' and Q, N m; shape (3, HARMONICS)."""
    phi, _ = _samples()
    centres, directions = centres_and_angles(phi)
    turns = [c * _derivative(s) - s * _derivative(c) for c, s in directions]
    masses = [_number(m) * Long("1e-3") for m in ("200", "55", "100", "20", "60")]
    inertias = [_number(j) * Long("1e-6") for j in ("325", "70", "50")]
    inertias[2] += Long("25e-6")  # the slider in the slot turns with the rocker
    jeq = sum(m * (_derivative(x) ** 2 + _derivative(y) ** 2) for m, (x, y) in zip(masses, centres, strict=True))
    jeq = jeq + sum(j * w**2 for j, w in zip(inertias, turns, strict=True))
    potential = sum(m * G * y for m, (_, y) in zip(masses, centres, strict=True))
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
