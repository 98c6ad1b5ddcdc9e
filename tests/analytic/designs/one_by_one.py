"""Designs of a linkage as linkages built one by one: what functions for many designs are compared with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import pytest

from analytic import machine_code, signals
from analytic.description.changes import design_numbers, with_numbers
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.signals import MovingSweep

NUMBA = pytest.mark.skipif(not machine_code.is_installed(), reason="no numba")
PATHS = ("numpy", pytest.param("compiled", marks=[NUMBA, pytest.mark.nightly]))
NOT_NEGATIVE = ("mass", "inertia", "stiffness", "damping", "coefficient")


def varied(sample: Mechanism, seed: int, count: int, share: float) -> dict[str, np.ndarray]:
    """Every number of a linkage, (count,) by name, each changed by a share of itself or of the drawing's size."""
    draw, parameters = np.random.default_rng(seed), {}
    for name, (kind, value) in design_numbers(sample.linkage).items():
        values = value * (1.0 + share * draw.normal(size=count))
        if kind in ("length", "direction"):
            values += share * (sample.linkage.extent() if kind == "length" else 1.0) * draw.normal(size=count)
        parameters[name] = np.abs(values) if name.endswith(NOT_NEGATIVE) else values
    return parameters


def built(sample: Mechanism, parameters: Mapping[str, np.ndarray], number: int) -> Mechanism:
    """One of the designs, in the assembly modes of the original."""
    return sample.redesigned(with_numbers(sample.linkage, {name: float(v[number]) for name, v in parameters.items()}))


def signals_of(
    sample: Mechanism,
    design: Mechanism,
    angle: np.ndarray,
    names: Iterable[str],
    motion: tuple[float, np.ndarray | float],
) -> dict[str, np.ndarray]:
    """Signals (angles,) of a design by name; S from its largest output among the angles. Raises AssemblyError."""
    sweep = Sweep(design.linkage, design.structure, angle)
    for body in design.structure.bodies:
        sweep.rates(body)
    top = float(np.max(sweep.output())) if sample.linkage.output else 0.0
    moving = MovingSweep(sample, sweep, np.asarray(motion[0]), np.asarray(motion[1]), top)
    return {name: signals.signal(moving, name) for name in names}
