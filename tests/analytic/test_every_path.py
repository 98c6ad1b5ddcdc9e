"""Signals by every path of the closed form against 50 digits, of linkages with every dyad and load drawn at random.

The truth is Newton's iteration on rigid bodies, differences over φ, virtual work and Lagrange's multipliers.
"""

import numpy as np
import pytest
from mpmath import mp

from analytic.description.changes import changed, numbers
from analytic.designs.derivatives import signal_gradients
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code import linkage_trace
from analytic.signals import evaluate, names
from tests.analytic.fifty_digits import Exact, forces_of, signals_of
from tests.analytic.linkages import ON_TRIAL, driven, laden, on_trial

SAME = 1e-13  # of the peak
SEED, COUNT, ORDINARY = 11, 22, (0, 3, 8, 20)
STRIDE = 5  # has no factor in common with the number of kinds
SPEED = 20.0
SHARE = 0.02  # of a length, that it is changed by; of the rest ten times as much
LEAST = np.radians(25.0)  # transmission angle
NEAR = np.linspace(-0.5, 0.5, 9)  # rad, of the drawn angle: where the peak of a signal is taken


def drawn(number):
    """A linkage of a number, and crank angles of which the first one counts: the same on every machine."""
    case, is_laden = ON_TRIAL[STRIDE * number % len(ON_TRIAL)]
    base = on_trial(*case, is_laden).linkage if number % 10 else laden(driven("linear-motor").linkage)
    for attempt in range(1000):
        chance = np.random.default_rng([SEED, number, attempt])

        def other(name, kind, value, chance=chance):
            share = SHARE * (1.0 if kind in ("length", "direction") else 10.0)
            return value if name.startswith("sketch.") else float(value * chance.uniform(1.0 - share, 1.0 + share))

        try:
            sample = Mechanism(changed(base, other))
            middle, reach = (base.sketch_angle, 0.02) if base.is_linear else (chance.uniform(0.0, 2.0 * np.pi), 1.0)
            places = middle + reach * np.array([chance.uniform(-0.5, 0.5), *NEAR])
            between = evaluate(sample, places, [one for one in names(sample) if one.startswith("transmission_angle")])
        except LinkproofError:
            continue
        if all(np.min(angle) >= LEAST for angle in between.values()):
            return sample, places
    raise RuntimeError(f"no linkage of number {number}")


def by_every_path(sample, places, chosen):
    """Values (signals, angles) by path."""
    varied = f"{sample.linkage.crank}.mass"  # a number that the list leaves open, and that has derivatives
    own = {varied: numbers(sample.linkage)[varied]}
    listed = linkage_trace(sample, own, chosen)
    rows = listed.trace.evaluate(listed.signals, listed.values(own, places, SPEED))
    return {
        "numpy": np.stack(list(evaluate(sample, places, chosen, speed=SPEED).values())),
        "list": np.stack([np.broadcast_to(row, places.shape) for row in rows]),
        "derivatives": signal_gradients(sample, own, chosen, places, speed=SPEED)[0],
    }


def kind_of(name):
    """Signals of a kind have one peak."""
    head, last = name.partition(":")[0], name.rpartition(":")[2]
    return head if head == "joint_force" else (head, last[:-1]) if head == "point" else name


def deviations(number):
    """Deviation over the peak by path and signal."""
    sample, places = drawn(number)
    exact = Exact(sample.sweep(places[0]))
    truth = signals_of(exact, SPEED) | forces_of(exact, SPEED)
    chosen = [name for name in names(sample) if name in truth]
    paths = by_every_path(sample, places, chosen)
    peaks = {}
    for name, row in zip(chosen, paths["numpy"], strict=True):
        peaks[kind_of(name)] = max(peaks.get(kind_of(name), 0.0), float(np.max(np.abs(row))))
    for path, rows in paths.items():
        for name, row in zip(chosen, rows, strict=True):
            off = mp.mpf(float(row[0])) - truth[name]
            off -= 2 * mp.pi * mp.nint(off / (2 * mp.pi)) if name.endswith(":angle") else 0
            yield (path, name), float(abs(off)) / (peaks[kind_of(name)] or 1.0)


NIGHTLY = [pytest.param(number, marks=pytest.mark.nightly) for number in range(COUNT) if number not in ORDINARY]


@pytest.mark.parametrize("number", [*ORDINARY, *NIGHTLY])
def test_signals_of_linkages_drawn_at_random_are_those_of_fifty_digits(number):
    errors = dict(deviations(number))
    assert max(errors.values()) <= SAME, max(errors, key=errors.get)
