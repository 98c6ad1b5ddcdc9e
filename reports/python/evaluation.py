"""``linkproof.evaluate``: the closed form at any crank angles, of one design or of many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import xarray
from numpy.typing import ArrayLike, NDArray

from analytic import signals
from analytic.description.crank_motion import RPM
from analytic.description.linkage import Linkage
from analytic.description.units import factor
from analytic.designs.values import ASSEMBLED, evaluate_designs
from analytic.errors import LinkproofError, UnknownNameError
from analytic.evaluation import evaluate as evaluate_quantities
from analytic.kinematics.mechanism import Mechanism
from analytic.request import UNITS
from comparisons.reference.case import Truth
from comparisons.reference.farthest import farthest
from reports.python.labels import label, labelled, unit
from reports.python.options import Words, chosen_linkage, words

Array = NDArray[np.float64]

GIVEN: Final = ("phi", "omega", "epsilon")  # what is given rather than asked for
STILL: Final = frozenset(("Jeq", "half_slope", "S", "point_position", "link_angle", "transmission_angle"))
BACKWARDS: Final = ("S", "v", "a")  # the output counts towards its direction, S away from the dead centre


@dataclass(frozen=True)
class GivenMotion:
    """A crank at angles (n,), rad, with a speed, rad/s, and an acceleration, rad/s², at each: the k-th of them at k s.

    Between them all three are straight lines.
    """

    angles: Array
    speeds: Array
    accelerations: Array
    regime: str = "given"
    jumps: tuple[float, ...] = ()

    @property
    def time(self) -> Array:
        """The instants of the angles, s."""
        return np.arange(len(self.angles), dtype=float)

    @property
    def duration(self) -> float:
        """The last of them, s."""
        return float(self.time[-1])

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        return float(np.max(np.abs(self.speeds)))

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        return np.asarray(np.interp(np.asarray(time, dtype=float), self.time, self.angles))

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        return np.asarray(np.interp(np.asarray(time, dtype=float), self.time, self.speeds))

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²."""
        return np.asarray(np.interp(np.asarray(time, dtype=float), self.time, self.accelerations))


def evaluate(
    linkage: Linkage | str | Path,
    phi: ArrayLike,
    quantities: Words | None = None,
    *,
    variant: str | None = None,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    gravity: bool = True,
    designs: Mapping[str, ArrayLike] | None = None,
) -> xarray.Dataset:
    """Quantities of the closed form over crank angles ``phi`` (n,), rad; all that can be told where none are named.

    They are called and counted as in ``results``; ``Q`` and ``half_slope``, ½ dJeq/dφ, come besides. ``speed``, rpm,
    and ``acceleration``, rad/s², are a number or (n,); what moves needs a speed. ``designs`` has arrays (k,) of numbers
    of the linkage, SI, by their names in its file: the Dataset is then over ``design`` and ``phi``, without signals of
    parts and without S, and NaN where ``assembled`` is False. A drive along a line has m, its file's unit of length
    per second and m/s² in place of rad, rpm and rad/s². Raises LinkproofError for what cannot be.
    """
    mechanism = Mechanism(chosen_linkage(linkage, variant, gravity=gravity))
    angle = np.atleast_1d(np.asarray(phi, dtype=float))
    if angle.ndim != 1 or not angle.size:
        raise LinkproofError(f"phi: expected a flat list of crank angles, got shape {angle.shape}; pass such a list")
    size = factor("length", mechanism.linkage.units.get("length", "m")) if mechanism.linkage.is_linear else RPM
    moves: dict[str, Any] = {"acceleration": acceleration, "speed": None}
    if speed is not None:
        moves["speed"] = np.asarray(speed, dtype=float) * size
    asked = None if quantities is None else words(quantities)
    if designs is not None:
        return _of_designs(mechanism, angle, asked, designs, moves)
    parts = _parts(mechanism)
    chosen = _chosen(asked, list(parts), moves=speed is not None)
    values = evaluate_quantities(mechanism, angle, [name for name in chosen if name in UNITS], **moves)
    still = np.zeros(angle.shape)
    motion = GivenMotion(angle, still + (0.0 if speed is None else moves["speed"]), still + np.asarray(acceleration))
    values |= {name: -values[name] for name in BACKWARDS if name in values}
    if "S" in values:
        values["S"] += farthest(mechanism, motion)
    truth = Truth(mechanism, motion, motion.time)
    values |= {name: signals.signal(truth, name) for variable in chosen for name in parts[variable]}
    return labelled(mechanism.linkage, "phi", {"phi": angle, **values}, {})


def _parts(mechanism: Mechanism) -> dict[str, list[str]]:
    """Every variable that can be asked for, with the signals that it is made of; none of what ``UNITS`` has."""
    known: dict[str, list[str]] = {"Q": [], "half_slope": []}
    for name in signals.names(mechanism):
        if name not in GIVEN:
            known.setdefault(label(name).variable, []).extend([] if name in UNITS else [name])
    return known


def _chosen(asked: Sequence[str] | None, known: Sequence[str], *, moves: bool) -> list[str]:
    """The variables asked for, each once; all that the motion allows where none are named."""
    if asked is None:
        return [name for name in known if moves or name in STILL]
    for name in asked:
        if name not in known:
            raise UnknownNameError("quantity", name, known)
        if not moves and name not in STILL and name != "Q":
            raise LinkproofError(f"speed: expected the crank's speed in rpm for {name}, got none; pass speed=...")
    return list(dict.fromkeys(asked))


def _of_designs(
    mechanism: Mechanism,
    angle: Array,
    asked: Sequence[str] | None,
    designs: Mapping[str, ArrayLike],
    moves: Mapping[str, Any],
) -> xarray.Dataset:
    known = [name for name, signals_of in _parts(mechanism).items() if name != "S" and name in UNITS]
    chosen = _chosen(asked, known, moves=moves["speed"] is not None)
    values = evaluate_designs(mechanism, designs, angle, chosen, **moves)
    over = ("design", "phi")
    assembled = values.pop(ASSEMBLED)
    return xarray.Dataset(
        {
            **{
                name: (over, -value if name in BACKWARDS else value, {"units": unit(name, mechanism.linkage)})
                for name, value in values.items()
            },
            ASSEMBLED: (over, assembled),
        },
        coords={
            "phi": ("phi", angle, {"units": unit("phi", mechanism.linkage)}),
            **{name: ("design", np.asarray(numbers, dtype=float)) for name, numbers in designs.items()},
        },
        attrs={"mechanism": mechanism.linkage.name, "variant": mechanism.linkage.variant},
    )
