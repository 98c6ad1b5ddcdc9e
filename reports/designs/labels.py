"""Signals as labelled arrays: variables over points, links, joints and components, from the names of the signals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
import xarray
from numpy.typing import ArrayLike, NDArray

from analytic import signals
from analytic.description.linkage import Linkage
from analytic.designs.sampled_signals import ASSEMBLED, evaluate_designs
from analytic.errors import WORDS, LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.curves import TIME

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


TITLES: Final = {symbol: word for word, symbol in WORDS.items()}


class Label(NamedTuple):
    """The place of a signal: its variable, the dimension and name of its part, its component; "" if there is none."""

    variable: str
    dimension: str = ""
    part: str = ""
    component: str = ""


def label(name: str) -> Label:
    """The Label of a signal by its name: the dataset's variable, its dimension, the place along that, its component.

    Raises KeyError for an unknown component of a known kind; any other name is a variable itself.
    """
    kind, _, rest = name.partition(":")
    if kind == GROUP:
        return Label(kind, DIMENSIONS[kind], rest)
    if kind not in VARIABLES:
        return Label(name)
    part, _, component = rest.rpartition(":")
    axis = component[-1] if component[-1] in "xy" else ""
    return Label(VARIABLES[kind][component], DIMENSIONS.get(kind, ""), part, axis)


def unit(name: str, linkage: Linkage) -> str:
    """The SI unit of a signal or quantity of the linkage, as text; raises KeyError for an unknown one."""
    return "s" if name == TIME else signals.unit(name, linkage)


def labelled(linkage: Linkage, axis: str, values: Mapping[str, Array], about: Mapping[str, str]) -> xarray.Dataset:
    """A dataset of signals (n,) by name over the signal ``axis``, with units; facts ``about`` it are attributes.

    So are mechanism and variant. The time and φ are coordinates. ``axis`` is "phi" or "time" and among the ``values``,
    SI.
    """
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
        if variable in TITLES:
            units["long_name"] = f"{TITLES[variable]} ({variable})"
        arrays[variable] = xarray.Variable((*sides, axis), stacked, units)
        coordinates |= sides
    beside = {name: arrays.pop(name) for name in (TIME, "phi") if name in arrays}
    attributes = {"mechanism": linkage.name, "variant": linkage.variant, **about}
    return xarray.Dataset(arrays, coords={**beside, **coordinates}, attrs=attributes)


# Signals at any crank angles, for ``linkproof.evaluate``.


def evaluated(
    mechanism: Mechanism, angle: Array, names: Sequence[str] | None, moves: Mapping[str, Any]
) -> xarray.Dataset:
    """A dataset of quantities over crank angles (n,), rad; all that ``moves`` allows if ``names`` is None.

    ``moves`` has "speed", None without, and "acceleration", SI. Raises LinkproofError for a quantity that needs a
    speed, UnknownNameError for an unknown one, AssemblyError for angles that the crank cannot reach.
    """
    variables = _signals_by_variable(mechanism)
    chosen = _requested_variables(mechanism, names, variables, moves=moves["speed"] is not None)
    every = [name for variable in chosen for name in variables[variable]]
    return labelled(mechanism.linkage, "phi", {"phi": angle, **signals.evaluate(mechanism, angle, every, **moves)}, {})


def _signals_by_variable(mechanism: Mechanism) -> dict[str, list[str]]:
    """Names of the signals of every variable that can be requested, by variable; those of the drive cannot."""
    known: dict[str, list[str]] = {}
    for name in signals.table(mechanism):
        if name not in signals.DRIVE:
            known.setdefault(label(name).variable, []).append(name)
    return known


def _requested_variables(
    mechanism: Mechanism, names: Sequence[str] | None, known: Mapping[str, Sequence[str]], *, moves: bool
) -> list[str]:
    """The requested variables, each once; for None all that need no motion, or all if the crank ``moves``.

    A link's share of Jeq has to be named. ``known`` has their signals. Raises UnknownNameError for an unknown one,
    LinkproofError for one that needs a motion.
    """
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


def evaluated_designs(
    mechanism: Mechanism,
    angle: Array,
    names: Sequence[str] | None,
    designs: Mapping[str, ArrayLike],
    moves: Mapping[str, Any],
) -> xarray.Dataset:
    """A dataset of quantities of many designs over crank angles, rad, and of whether each is ``assembled``.

    ``designs`` has arrays (k,) of numbers, SI, by name. ``names``, ``moves`` and errors are as of ``evaluated``, but a
    design that does not assemble is NaN; signals of parts and S are unknown here.
    """
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
