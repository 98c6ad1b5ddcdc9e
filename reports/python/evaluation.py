"""``linkproof.evaluate`` and ``results``: the closed form at any crank angles, or over a motion, as labelled arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import xarray
from numpy.typing import ArrayLike, NDArray

from analytic import signals
from analytic.description.crank_motion import RPM
from analytic.description.linkage import Linkage
from analytic.description.units import factor
from analytic.designs.sampled_signals import ASSEMBLED, evaluate_designs
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import evaluate as evaluate_signals
from comparisons.designer.building import sheet
from comparisons.designer.curves import TIME
from reports.python.keywords import Words, load_linkage, resolve_linkage, with_keywords, words
from reports.requests.motions import requested_results
from reports.requests.options import ResultsOptions

Array = NDArray[np.float64]
GROUP: Final = "transmission_angle"
# Of a kind of signal the dimension of its parts; a shaking force has none.
DIMENSIONS: Final = {"point": "point", "link": "link", "joint_force": "joint", GROUP: "group"}
# Of a kind's components the variable that each belongs to.
VARIABLES: Final[Mapping[str, Mapping[str, str]]] = {
    "point": {
        **{"x": "point_position", "y": "point_position", "vx": "point_velocity", "vy": "point_velocity"},
        **{"ax": "point_acceleration", "ay": "point_acceleration"},
    },
    "link": {"angle": "link_angle", "omega": "link_omega", "alpha": "link_alpha"},
    "joint_force": {"x": "joint_force", "y": "joint_force", "magnitude": "joint_force_magnitude"},
    "shaking_force": {"x": "shaking_force", "y": "shaking_force", "magnitude": "shaking_force_magnitude"},
}


class Label(NamedTuple):
    """The place of a signal: its variable, the dimension and name of its part, its component; "" if there is none."""

    variable: str
    dimension: str = ""
    part: str = ""
    component: str = ""


def label(name: str) -> Label:
    """The place of a signal in a dataset, from its name."""
    kind, _, rest = name.partition(":")
    if kind == GROUP:
        return Label(kind, DIMENSIONS[kind], rest)
    if kind not in VARIABLES:
        return Label(name)
    part, _, component = rest.rpartition(":")
    axis = component[-1] if component[-1] in "xy" else ""
    return Label(VARIABLES[kind][component], DIMENSIONS.get(kind, ""), part, axis)


def unit(name: str, linkage: Linkage) -> str:
    """SI unit of a signal or quantity."""
    return "s" if name == TIME else signals.unit(name, linkage)


def labelled(linkage: Linkage, axis: str, values: Mapping[str, Array], about: Mapping[str, str]) -> xarray.Dataset:
    """Signals (n,) by name over the signal ``axis``, with units, mechanism and further facts in the attributes."""
    variables: dict[str, dict[Label, str]] = {}
    for name in values:
        variables.setdefault(label(name).variable, {})[label(name)] = name
    arrays: dict[str, xarray.Variable] = {}
    coordinates: dict[str, list[str]] = {}
    for variable, names in variables.items():
        first = next(iter(names))
        sides = {
            first.dimension: list(dict.fromkeys(entry.part for entry in names)),
            "component": list(dict.fromkeys(entry.component for entry in names)),
        }
        sides = {side: places for side, places in sides.items() if places != [""]}
        shape = [*map(len, sides.values()), -1]
        stacked = np.stack([values[name] for name in names.values()]).reshape(shape)
        units = {"units": unit(names[first], linkage)}
        arrays[variable] = xarray.Variable((*sides, axis), stacked, units)
        coordinates |= sides
    beside = {name: arrays.pop(name) for name in (TIME, "phi") if name in arrays}
    attributes = {"mechanism": linkage.name, "variant": linkage.variant, **about}
    return xarray.Dataset(arrays, coords={**beside, **coordinates}, attrs=attributes)


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
    """Quantities of the closed form over crank angles ``phi`` (n,), rad; all available ones if none are named.

    They have the names and signs of ``results``; ``Q``, ``half_slope``, ½ dJeq/dφ, and ``damping`` are added, and a
    link's share ``Jeq:LINK`` where it is named. ``speed``, rpm, and ``acceleration``, rad/s², are a number or (n,);
    quantities of motion need a speed. ``designs`` has arrays (k,) of numbers of the linkage, SI, by their names in its
    file: the Dataset is then over ``design`` and ``phi``, without signals of parts and without S, and NaN where
    ``assembled`` is False. A drive along a line has m, its file's unit of length per second and m/s² in place of rad,
    rpm and rad/s². Raises LinkproofError for bad input.
    """
    mechanism = Mechanism(load_linkage(linkage, variant, gravity=gravity))
    angle = np.atleast_1d(np.asarray(phi, dtype=float))
    if angle.ndim != 1 or not angle.size:
        raise LinkproofError(f"phi: expected a flat list of crank angles, got shape {angle.shape}; pass such a list")
    size = factor("length", mechanism.linkage.units.get("length", "m")) if mechanism.linkage.is_linear else RPM
    moves: dict[str, Any] = {"acceleration": acceleration, "speed": None}
    if speed is not None:
        moves["speed"] = np.asarray(speed, dtype=float) * size
    texts = None if quantities is None else words(quantities)
    if designs is not None:
        return _evaluate_designs(mechanism, angle, texts, designs, moves)
    variables = _signals_by_variable(mechanism)
    chosen = _requested_variables(mechanism, texts, variables, moves=speed is not None)
    names = [name for variable in chosen for name in variables[variable]]
    values = evaluate_signals(mechanism, angle, names, **moves)
    return labelled(mechanism.linkage, "phi", {"phi": angle, **values}, {})


def _signals_by_variable(mechanism: Mechanism) -> dict[str, list[str]]:
    """Every variable that can be requested, with its signals."""
    known: dict[str, list[str]] = {}
    for name in signals.table(mechanism):
        if name not in signals.DRIVE:
            known.setdefault(label(name).variable, []).append(name)
    return known


def _requested_variables(
    mechanism: Mechanism, names: Sequence[str] | None, known: Mapping[str, Sequence[str]], *, moves: bool
) -> list[str]:
    """The requested variables, each once; by default all that need no motion, or all if the crank ``moves``."""
    table = signals.table(mechanism)
    if names is None:
        whole = {name: parts for name, parts in known.items() if not name.startswith("Jeq:")}
        return [name for name, parts in whole.items() if moves or all(table[part].is_still for part in parts)]
    for name in names:
        if name not in known:
            raise UnknownNameError("quantity", name, known)
        if not moves and not all(table[part].is_still for part in known[name]):
            raise LinkproofError(f"speed: expected the crank's speed in rpm for {name}, got none; pass speed=...")
    return list(dict.fromkeys(names))


def _evaluate_designs(
    mechanism: Mechanism,
    angle: Array,
    names: Sequence[str] | None,
    designs: Mapping[str, ArrayLike],
    moves: Mapping[str, Any],
) -> xarray.Dataset:
    """Quantities of many designs over the angles, and whether each design is assembled there."""
    known = {name: parts for name, parts in _signals_by_variable(mechanism).items() if name != "S" and parts == [name]}
    chosen = _requested_variables(mechanism, names, known, moves=moves["speed"] is not None)
    values = evaluate_designs(mechanism, designs, angle, chosen, **moves)
    over = ("design", "phi")
    assembled = values.pop(ASSEMBLED)
    return xarray.Dataset(
        {
            **{name: (over, value, {"units": unit(name, mechanism.linkage)}) for name, value in values.items()},
            ASSEMBLED: (over, assembled),
        },
        coords={
            "phi": ("phi", angle, {"units": unit("phi", mechanism.linkage)}),
            **{name: ("design", np.asarray(numbers, dtype=float)) for name, numbers in designs.items()},
        },
        attrs={"mechanism": mechanism.linkage.name, "variant": mechanism.linkage.variant},
    )


# ``linkproof.results``: every signal of a linkage over a motion of its crank.


@with_keywords()
def results(linkage: Linkage | str | Path, *, options: ResultsOptions) -> xarray.Dataset:
    """Every signal of a linkage over a motion of its crank, as by ``linkproof results``, in SI.

    The dimension is ``phi``, rad, where the crank turns at one speed, else ``time``, s; the other stands beside it.
    Points, links, joints and groups are dimensions of their own, as are the components x and y of a vector. ``at``, in
    degrees, or ``time``, in s, choose the instants. Raises LinkproofError for what cannot be.
    """
    case, chosen = requested_results(*resolve_linkage(linkage, options))
    result = sheet(case, chosen)
    about = {"regime": case.motion.regime, "conditions": result.conditions}
    if result.open_end_warning:
        about["open_ends"] = result.open_end_warning
    return labelled(result.linkage, result.axis, result.table, about)
