"""What the reference and every engine are given alike, and so could not see: units, speed, loads over φ, zeros.

An offset slider-crank is worked out here once more, by its triangle and virtual work, from the numbers of its file; and
every fault put into what both sides share makes one of these figures wrong.
"""

import itertools
import math

import numpy as np
import pytest

from analytic import signals
from analytic.description import crank_motion as crank_motions
from analytic.description import units
from analytic.description.law import Law
from analytic.dynamics import reduced
from analytic.kinematics import dead_centres
from comparisons.motion.case import Case
from comparisons.trials.judging import quantities
from engines.scene import Channel
from engines.stepping.stepped_engine import plain_law
from tests.analytic.linkages import file_text, from_text

TEXT = file_text("loaded-slider-crank")
R, L, E, RPM = 0.020, 0.080, 0.010, 600.0
AT = 0.05  # s of the constant speed: half a turn and a little more from 40°
TOLERANCE = 1e-9
NUMBERS = itertools.count()


def _triangle(phi):
    """Piston x, m, and the rod's angle, rad, of the linkage in its sketch."""
    rod = math.asin((E - R * math.sin(phi)) / L)
    return R * math.cos(phi) + L * math.cos(rod), rod


def _energy(phi, omega):
    """Kinetic energy, J: every body's, its velocity by central differences of the triangle."""
    step = 1e-5
    states = [np.array(_bodies(phi + sign * step)) for sign in (1, -1)]
    rates = (states[0] - states[1]) / (2.0 * step) * omega
    weights = np.array([[0.3, 0.3, 60e-6], [0.12, 0.12, 90e-6], [0.2, 0.2, 0.0]])
    return 0.5 * float(np.sum(weights * rates**2))


def _bodies(phi):
    x, rod = _triangle(phi)
    crank = (0.008 * math.cos(phi), 0.008 * math.sin(phi), phi)
    middle = (R * math.cos(phi) + 0.030 * math.cos(rod), R * math.sin(phi) + 0.030 * math.sin(rod), rod)
    return crank, middle, (x, E, 0.0)


def _potential(phi):
    weight = sum(m * 9.81 * body[1] for m, body in zip((0.3, 0.12, 0.2), _bodies(phi), strict=True))
    return weight + 0.5 * 200.0 * (math.hypot(_triangle(phi)[0] - 0.1, E - 0.04) - 0.010) ** 2


def _pull(phi):
    """The periodic cubic spline through four values a quarter turn apart, by its own tridiagonal system, N."""
    values, h = np.array([-10.0, -20.0, -5.0, 0.0]), math.pi / 2.0
    matrix = 4.0 * np.eye(4) + np.roll(np.eye(4), 1, 0) + np.roll(np.eye(4), -1, 0)
    bend = np.linalg.solve(matrix, 6.0 / h**2 * (np.roll(values, -1) - 2.0 * values + np.roll(values, 1)))
    piece, x = int(phi % (2 * math.pi) // h), phi % h
    a, b, m, n = values[piece], values[(piece + 1) % 4], bend[piece], bend[(piece + 1) % 4]
    y = h - x
    return (m * y**3 + n * x**3) / (6 * h) + (a / h - m * h / 6) * y + (b / h - n * h / 6) * x


def _expected():
    """Torque, N m, S, m, and thread feed, m, after AT seconds at a constant speed."""
    omega = RPM / 60.0 * 2.0 * math.pi
    phi = math.radians(40.0) + omega * AT
    step = 1e-4

    def slope(function, power=1):
        return (function(phi + step) - function(phi - step)) / (2.0 * step)

    travel = slope(lambda angle: _triangle(angle)[0])
    torque = slope(lambda angle: _energy(angle, omega)) + slope(_potential) - _pull(phi) * travel + 1e-3 * omega
    top = math.sqrt((R + L) ** 2 - E**2)
    x, start = _triangle(phi)[0], _triangle(math.pi / 2.0)[0]
    feed = math.hypot(x, 0.06 - E) - math.hypot(start, 0.06 - E) + 0.002
    return {"Mkr": torque, "S": top - x, "thread_feed": feed}


def _found():
    motion = crank_motions.crank_motion(
        "constant-speed", speed=RPM * crank_motions.RPM, ramp_time=AT, hold_time=0.0, start_angle=math.radians(40.0)
    )
    name = f"sample-{next(NUMBERS)}"  # files once read are kept by their text and name
    case = Case(from_text(TEXT, name), motion)
    result = {name: float(quantities.QUANTITIES[name].reference(case, np.array([AT]))[0]) for name in _expected()}
    scene = case.scene([Channel.POSITION])  # what an engine is told
    (load,), end = scene.forces, math.radians(40.0) + RPM / 60.0 * 2.0 * math.pi * AT
    knots, pieces, _ = plain_law(load.force)
    piece = int(np.searchsorted(knots, end, side="right")) - 1
    pull = np.polyval(pieces[piece][0][::-1], end - knots[piece])
    return result | {"crank": float(case.motion.angle(AT)), "pull": float(pull)}


def _wrong():
    """The figures that are off by more than the differences' own error."""
    end = math.radians(40.0) + RPM / 60.0 * 2.0 * math.pi * AT
    expected = _expected() | {"crank": end, "pull": _pull(end)}
    result = _found()
    scale = {"Mkr": 1e-6}
    return [name for name, value in expected.items() if abs(result[name] - value) > scale.get(name, TOLERANCE)]


def test_the_figures_that_both_sides_share_are_right():
    assert _wrong() == []


def _unit(kind, name, share=1.001):
    return lambda monkeypatch: monkeypatch.setitem(units.UNITS[kind], name, share * units.UNITS[kind][name])


def _scaled(module, name, share):
    true = getattr(module, name)
    return lambda monkeypatch: monkeypatch.setattr(module, name, lambda *given: share * true(*given))


def _top(monkeypatch):
    true = dead_centres.bottom_dead_centre
    monkeypatch.setattr(dead_centres, "top_dead_centre", true)


MUTANTS = {
    **{f"unit of {kind}": _unit(kind, name) for kind, name in (
        ("length", "mm"), ("mass", "g"), ("inertia", "kg*mm^2"), ("force", "N"), ("stiffness", "N/mm"),
        ("turn_damping", "N*m*s"))},
    "speed in rpm": lambda monkeypatch: monkeypatch.setattr(crank_motions, "RPM", 1.001 * crank_motions.RPM),
    "angles in degrees": _unit("angle", "deg"),
    "loads over φ, a degree late": lambda monkeypatch: monkeypatch.setattr(
        Law, "__call__", lambda law, angle, order=0, call=Law.__call__: call(law, np.asarray(angle) - 0.0175, order)),
    "loads over φ as engines have them": lambda monkeypatch: monkeypatch.setattr(
        Law, "pieces", lambda law, true=Law.pieces: ((np.array(true(law)[0]) + 0.0175).tolist(), true(law)[1])),
    "loads over φ, their sign": lambda monkeypatch: monkeypatch.setattr(
        Law, "__call__", lambda law, angle, order=0, call=Law.__call__: -call(law, angle, order)),
    "zero of S": _top,
    "reference length of the thread": _scaled(signals, "reference_length", 1.001),
    "generalised force": _scaled(reduced, "generalised_force", 1.001),
}  # fmt: skip


@pytest.mark.parametrize("name", MUTANTS)
def test_a_fault_in_what_both_sides_share_is_seen(name, monkeypatch):
    MUTANTS[name](monkeypatch)
    assert _wrong(), f"nothing notices a fault in the {name}"
