"""Figures of many designs at once: peaks, means and single values of any signal, without its curves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import changed
from analytic.description.linkage import Linkage
from analytic.designs.figures import Figure, Reduction
from analytic.errors import AssemblyError
from analytic.evaluation import MovingSweep
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.signals import signal

Array = NDArray[np.float64]
MAGNITUDE = ":magnitude"


def design_figures(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    figures: Sequence[Figure],
    angle: ArrayLike,
    *,
    speed: float,
    weights: ArrayLike | None = None,
    refine: bool = False,
    cores: int | None = None,
    path: str = "auto",
) -> Array:
    """Figures of every design, (figures, designs), SI; the crank turns at a constant ``speed``, rad/s, signed.

    ``parameters`` are arrays (designs,) of numbers of the description, SI, by the names of
    ``analytic.description.changes``; all else is as described, and the assembly modes are those that its sketch picks.
    A signal is sampled at the crank angles ``angle`` (angles,), rad, ascending; its means take the ``weights``
    (angles,), which add up to one: equal ones if None. With ``refine`` the extremes are the true ones, looked for
    between neighbours of the highest samples.

    The figures of a design that cannot be assembled, or stands in a dead position, at any of the angles are nan.
    ``cores`` and ``path`` are as for ``analytic.evaluation.evaluate``. Raises UnknownNameError and LinkproofError as
    ``analytic.designs.values.evaluate_designs`` does.
    """
    angle = np.asarray(angle, dtype=float)
    count = len(np.asarray(next(iter(parameters.values()))))
    share = np.full(angle.shape, 1.0 / len(angle)) if weights is None else np.asarray(weights)
    found = np.full((len(figures), count), np.nan)
    for number in range(count):
        own = {name: float(np.asarray(values)[number]) for name, values in parameters.items()}
        linkage = _with(mechanism, own)
        structure = find_structure(linkage).with_signs(tuple(dyad.sign for dyad in mechanism.structure.dyads))
        chosen = np.array([one.angle if one.reduction is Reduction.AT else angle[0] for one in figures])
        try:
            at, there = (_moving(mechanism, Sweep(linkage, structure, phi), speed) for phi in (angle, chosen))
            for body in structure.bodies:
                at.sweep.rates(body)
            for row, one in enumerate(figures):
                if one.reduction is Reduction.AT:
                    found[row, number] = _values(there, one.signal)[row]
                else:
                    found[row, number] = _reduced(one, _values(at, one.signal), share)
        except AssemblyError:
            found[:, number] = np.nan
    return found


def _with(mechanism: Mechanism, numbers: Mapping[str, float]) -> Linkage:
    return changed(mechanism.linkage, lambda name, _, value: numbers.get(name, value))


def _moving(mechanism: Mechanism, sweep: Sweep, speed: float) -> MovingSweep:
    top = float(np.max(sweep.output())) if mechanism.linkage.output else 0.0
    return MovingSweep(mechanism, sweep, np.asarray(speed), np.asarray(0.0), top)


def _values(at: MovingSweep, name: str) -> Array:
    if name.endswith(MAGNITUDE):
        vector = name.removesuffix(MAGNITUDE)
        return np.hypot(signal(at, f"{vector}:x"), signal(at, f"{vector}:y"))
    return signal(at, name)


def _reduced(figure: Figure, values: Array, share: Array) -> float:
    middle = 0.5 * np.pi if figure.signal.startswith("transmission_angle:") else 0.0
    reductions: dict[Reduction, Callable[[], Any]] = {
        Reduction.PEAK: lambda: values[np.argmax(np.abs(values - middle))],
        Reduction.MEAN: lambda: share @ values,
        Reduction.RMS: lambda: np.sqrt(share @ np.square(values)),
        Reduction.MAX: lambda: np.max(values),
        Reduction.MIN: lambda: np.min(values),
        Reduction.RANGE: lambda: np.max(values) - np.min(values),
    }
    return float(reductions[figure.reduction]())
