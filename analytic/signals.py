"""The closed form signal by signal, by the names under which results are written and judged; everything in SI.

``phi omega epsilon``           the crank's angle, speed and acceleration, counter-clockwise positive
``Mkr Peq Teq Jeq``             torque and power of the drive, kinetic energy, inertia reduced to the crank
``S v a``                       displacement of the output from its farthest point, and its derivatives
``point:D:x :y :vx :vy :ax :ay``  a point of a moving link, ground frame
``link:coupler:angle :omega :alpha``  the angle of a link's frame against the ground's, unwrapped, and derivatives
``joint_force:A:x :y``          the force that a joint exerts on its first body, ground frame
``shaking_force:x :y``          the force of the linkage on its frame, ground frame
``shaking_moment``              its moment about the crank's pivot; about the origin where no crank turns
``transmission_angle:GROUP``    of a group of two links, from 0 to π/2 (``analytic.kinematics.transmission``)

The first body of a pin is the link that is not the ground, of two moving links the second by name; of a slider it is
the slider, of a slot the link that has the pin (``analytic.dynamics.joint_forces``). A drive along a line has a travel,
a speed and a force in place of angle, angular speed and torque. Where nothing has mass and nothing is loaded there are
no torques and no forces; without an output there are no S, v and a. Names of joints and groups may hold colons.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import UnknownNameError
from analytic.kinematics.frames import Scalar
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.transmission import transmission_angle
from analytic.moving import Moving
from analytic.request import unit_of

Array = NDArray[np.float64]
Formula = Callable[[Moving], Scalar]

DRIVE: Final[Mapping[str, Formula]] = {
    "phi": lambda at: at.sweep.angle,
    "omega": lambda at: at.speed,
    "epsilon": lambda at: at.acceleration,
}
LOADS: Final[Mapping[str, Formula]] = {
    "Mkr": lambda at: at.torque,
    "Peq": lambda at: at.torque * at.speed,
    "Teq": lambda at: 0.5 * at.inertia * at.speed**2,
    "Jeq": lambda at: at.inertia,
}
OUTPUT: Final[Mapping[str, Formula]] = {
    "S": lambda at: at.farthest - at.sweep.output(),
    "v": lambda at: -at.sweep.output(1) * at.speed,
    "a": lambda at: -(at.sweep.output(2) * at.speed**2 + at.sweep.output(1) * at.acceleration),
}
UNITS: Final[Mapping[str, str]] = {
    **{"phi": "rad", "omega": "rad/s", "epsilon": "rad/s²", "Mkr": "N m", "Peq": "W", "Teq": "J", "Jeq": "kg m²"},
    **{"S": "m", "v": "m/s", "a": "m/s²", "shaking_moment": "N m"},
}
# Of a kind its components, each with its unit.
COMPONENTS: Final[Mapping[str, Mapping[str, str]]] = {
    "point": {"x": "m", "y": "m", "vx": "m/s", "vy": "m/s", "ax": "m/s²", "ay": "m/s²"},
    "link": {"angle": "rad", "omega": "rad/s", "alpha": "rad/s²"},
    "joint_force": {"x": "N", "y": "N"},
    "shaking_force": {"x": "N", "y": "N"},
    "transmission_angle": {"": "rad"},
}
MAGNITUDE: Final = ":magnitude"
ORDERS: Final = ("x", "y", "vx", "vy", "ax", "ay")  # of a point: two components of each derivative


def names(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of all signals that a mechanism has under any motion, always in the same order."""
    return tuple(formulas(mechanism))


def unit(name: str, linkage: Linkage) -> str:
    """SI unit of the signal of a linkage."""
    if name in UNITS:
        return unit_of(name, UNITS[name], is_linear=linkage.is_linear)
    kind, part = name.split(":", 1)
    return COMPONENTS[kind][part.rpartition(":")[2] if kind != "transmission_angle" else ""]


def signal(at: Moving, name: str) -> Array:
    """A signal, of the shape of the angles; raises UnknownNameError for one that the linkage does not have."""
    known = formulas(at.mechanism)
    if name not in known:
        raise UnknownNameError("signal", name, known)
    return np.copy(np.broadcast_to(known[name](at), at.sweep.angle.shape))


def signal_or_magnitude(at: Moving, name: str) -> Array:
    """A signal, or the magnitude of a vector, ``joint_force:A:magnitude``; raises UnknownNameError as ``signal``."""
    if not name.endswith(MAGNITUDE):
        return signal(at, name)
    vector = name.removesuffix(MAGNITUDE)
    return np.hypot(signal(at, f"{vector}:x"), signal(at, f"{vector}:y"))


def moving_points(linkage: Linkage) -> tuple[str, ...]:
    """Names of the points of the moving links that are not fixed to the ground, sorted."""
    return tuple(sorted({point for link in linkage.links.values() for point in link.points} - {*linkage.ground}))


@lru_cache(maxsize=64)
def formulas(mechanism: Mechanism) -> Mapping[str, Formula]:
    """Every signal of a mechanism by name."""
    linkage, found = mechanism.linkage, dict(DRIVE)
    loaded = not linkage.is_idle
    if loaded:
        found |= LOADS
    if linkage.output is not None:
        found |= OUTPUT
    found |= _each("point", moving_points(linkage), _point)
    found |= _each("link", linkage.links, _link)
    if loaded:
        found |= _each("joint_force", linkage.joint_names, _joint_force)
        shaking = ("shaking_force:x", "shaking_force:y", "shaking_moment")
        found |= {name: partial(_shaking, row=row) for row, name in enumerate(shaking)}
    dyads = mechanism.structure.dyads
    return found | {
        f"transmission_angle:{dyad.name}": partial(_transmission, row=row) for row, dyad in enumerate(dyads)
    }


def _each(kind: str, parts: Iterable[str], formula: Callable[..., Scalar]) -> dict[str, Formula]:
    """The signals of a kind: every component of every part."""
    return {
        f"{kind}:{part}:{component}": partial(formula, name=part, component=component)
        for part in parts
        for component in COMPONENTS[kind]
    }


def _point(at: Moving, name: str, component: str) -> Scalar:
    order, axis = divmod(ORDERS.index(component), 2)
    if order == 0:
        return at.sweep.point(name)[axis]
    first = at.sweep.point(name, 1)[axis]
    if order == 1:
        return first * at.speed
    return at.sweep.point(name, 2)[axis] * at.speed**2 + first * at.acceleration


def _link(at: Moving, name: str, component: str) -> Scalar:
    if component == "angle":
        return at.sweep.angles(name)
    first = at.sweep.rates(name)[2]
    if component == "omega":
        return first * at.speed
    return at.sweep.accelerations(name)[2] * at.speed**2 + first * at.acceleration


def _joint_force(at: Moving, name: str, component: str) -> Scalar:
    return at.joint_forces[name]["xy".index(component)]


def _shaking(at: Moving, row: int) -> Scalar:
    return at.shaking[row]


def _transmission(at: Moving, row: int) -> Scalar:
    return transmission_angle(at.sweep, at.sweep.structure.dyads[row])
