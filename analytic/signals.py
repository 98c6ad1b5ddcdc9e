"""The closed form signal by signal, by the names under which results are written and judged; everything in SI.

``phi omega epsilon``           the crank's angle, speed and acceleration, counter-clockwise positive
``Mkr Peq Teq Jeq``             torque and power of the drive, kinetic energy, inertia reduced to the crank
``S v a``                       displacement of the output from its farthest point, and its derivatives
``thread_feed``                 the feed of the linkage's thread (``analytic.signals``)
``point:D:x :y :vx :vy :ax :ay``  a point of a moving link, ground frame
``link:coupler:angle :omega :alpha``  the angle of a link's frame against the ground's, unwrapped, and derivatives
``joint_force:A:x :y``          the force that a joint exerts on its first body, ground frame
``shaking_force:x :y``          the force of the linkage on its frame, ground frame
``shaking_moment``              its moment about the crank's pivot; about the origin where no crank turns
``transmission_angle:GROUP``    of a group of two links, from 0 to π/2 (``analytic.kinematics.sweep``)
``Q half_slope damping``        generalised force of the loads, ½ dJeq/dφ and damping reduced to the crank: on request
``Jeq:coupler``                 a link's share of the reduced inertia: on request
``thread_length``               the length of the thread's contour: on request

The first body of a pin is the link that is not the ground, of two moving links the second by name; of a slider it is
the slider, of a slot the link that has the pin (``analytic.dynamics.joint_forces``). A drive along a line has a travel,
a speed and a force in place of angle, angular speed and torque. Linkages without masses and loads have
no torques and no forces; without an output there are no S, v and a, and without a thread no feed. Names of joints and
groups may contain colons. Formulas raise AssemblyError where the linkage cannot be assembled or moved.
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.linkage import Linkage, ThreadEye, ThreadGuide, ThreadPath
from analytic.dynamics import reduced
from analytic.dynamics.friction import reactions
from analytic.dynamics.joint_forces import Reactions, shaking
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.kinematics.dead_centres import farthest_between
from analytic.kinematics.frames import Scalar
from analytic.kinematics.mechanism import Mechanism, once_per_mechanism
from analytic.kinematics.structure import Revolute
from analytic.kinematics.sweep import Sweep, output_of, transmission_angle
from analytic.numerics.arrays import Array
from analytic.numerics.refine import zeros

# A linkage at crank angles with the crank's motion there: the common argument of torques, forces and signals.


class LinkageInMotion(ABC):
    """A ``sweep`` of a ``mechanism`` whose crank has a ``speed``, rad/s, and an ``acceleration``, rad/s².

    Both are of the sweep's shape or scalar; of a linear driver they are in m/s and m/s². Everything is computed once,
    when it is needed, and then raises AssemblyError where the linkage cannot be assembled or moved, and torques and
    joint forces LinkproofError where friction locks it.
    """

    if TYPE_CHECKING:

        @property
        def mechanism(self) -> Mechanism:
            """The linkage whose motion it is."""

        @property
        def sweep(self) -> Sweep:
            """The linkage posed at φ."""

        @property
        def speed(self) -> Array:
            """The driver's speed, rad/s or m/s."""

        @property
        def acceleration(self) -> Array:
            """The driver's acceleration, rad/s² or m/s²."""

    @property
    @abstractmethod
    def farthest(self) -> Any:  # noqa: ANN401 - a number, or one for each design
        """The output's coordinate, m, from which S counts: one number, or one for each design."""

    @cached_property
    def inertia(self) -> Array:
        """Jeq, the moment of inertia reduced to the crank, kg m², of the sweep's shape; of a linear driver the mass."""
        return reduced.reduced_inertia(self.sweep)

    @cached_property
    def torque(self) -> Array:
        """Mkr, the torque of the drive on the crank, N m, positive along growing φ; of a linear driver its force, N."""
        inertia = self.inertia if np.any(self.acceleration) else np.zeros(self.sweep.angle.shape)
        torque = reduced.balance(self.sweep, inertia, self.speed, self.acceleration)
        return torque + self.friction_torque if self.sweep.linkage.friction else torque

    @cached_property
    def joint_forces(self) -> Mapping[str, Array]:
        """Force of every joint on its first body, by the joint's name, (2, *shape), N, in the ground frame.

        One analysis of the linkage gives them all.
        """
        return self._reactions.forces

    @property
    def friction_torque(self) -> Any:  # noqa: ANN401 - an array, or 0 without friction
        """The share of the joints' friction in the drive's torque, N m; of a linear driver in its force, N.

        0 without friction.
        """
        return self._reactions.friction

    @cached_property
    def _reactions(self) -> Reactions:
        """Forces of all joints at this speed and acceleration, the drive's torque, and friction's share."""
        return reactions(self.sweep, self.speed, self.acceleration)

    @cached_property
    def shaking(self) -> Array:
        """Force of the linkage on the frame, N, and its moment about the crank's pivot, N m: (3, *shape).

        The moment is about the origin where no crank turns.
        """
        pivot = self.sweep.structure.pivot
        about = pivot.near_local if isinstance(pivot, Revolute) else (0.0, 0.0)
        return shaking(self.sweep, self.speed, self.acceleration, about)


@dataclass(frozen=True)
class MovingSweep(LinkageInMotion):
    """A sweep with the crank's speed, rad/s, acceleration, rad/s², and the output's coordinate, m, at which S is 0.

    Speed and acceleration are of the sweep's shape or scalar; of a linear driver they are in m/s and m/s².
    """

    mechanism: Mechanism
    sweep: Sweep
    speed: Array
    acceleration: Array
    farthest: float | Array = 0.0


# The thread's contour and feed over the crank angle (articles 002 and 004).
#
# The contour's length is the sum of the straight distances between its stops, guides and eyes, in space (article 002,
# eqs (19)-(21); article 004, eqs (15)-(17)); the thickness of guides and eyes is neglected. The feed is the contour's
# change from a reference position, plus the thread's stretch (article 002, eqs (22) and (23); article 004, eqs
# (21)-(24), where D(φ_bottom) − D(φ) = L(φ_bottom) − L(φ)).


def stop_position(sweep: Sweep, stop: ThreadGuide | ThreadEye) -> tuple[Scalar, Scalar, Scalar]:
    """Position in space, x, y and z, m, of a stop of the thread, over the sweep's angles if it is an eye.

    Raises AssemblyError where the eye's link cannot be assembled.
    """
    if isinstance(stop, ThreadGuide):
        return stop.position
    x, y = sweep.point(stop.point)
    return x, y, stop.z


def contour_length(sweep: Sweep, path: ThreadPath) -> Scalar:
    """The length L(φ) of the thread's contour, m, at the sweep's angles; one number if no stop moves.

    Raises AssemblyError where the linkage cannot be assembled.
    """
    corners = [stop_position(sweep, stop) for stop in path.stops]
    length: Scalar = 0.0
    for (x0, y0, z0), (x1, y1, z1) in itertools.pairwise(corners):
        x, y, z = x1 - x0, y1 - y0, z1 - z0
        length = length + np.sqrt(x * x + y * y + z * z)
    return length


@lru_cache(maxsize=8)
def reference_angle(mechanism: Mechanism, path: ThreadPath) -> float:
    """φ_ref, rad, of a linear driver m: the crank angle at which the feed is ΔP; the latest eight are kept.

    It is as the file gives it, or the extreme position of an eye: the outermost zero of the exact derivative of its
    height, not a grid point. Raises LinkproofError where that needs a full turn and the driver makes none, and for an
    eye that does not move up and down.
    """
    if isinstance(path.reference, float | int):
        return float(path.reference)
    eye, name = path.reference.eye, mechanism.linkage.name
    words = f"thread: the extreme height of eye '{eye}' of '{name}' needs a full turn of the crank, which"
    if mechanism.linkage.is_linear:
        raise LinkproofError(f"{words} its linear drive does not make; give a place of the drive as the reference")
    try:
        mechanism.check_full_turn()
    except AssemblyError as error:
        raise LinkproofError(f"{words} it cannot make; give a crank angle as the reference") from error
    angles = zeros(lambda phi: mechanism.sweep(phi).point(eye, 1)[1])
    if not len(angles):
        raise LinkproofError(
            f"thread: expected an eye that moves up and down, got '{eye}' of '{name}', which does not; name another "
            "point"
        )
    heights = mechanism.sweep(angles).point(eye)[1]
    return float(angles[np.argmax(heights) if path.reference.extreme == "highest" else np.argmin(heights)])


def reference_length(mechanism: Mechanism, path: ThreadPath) -> float:
    """L(φ_ref), m: the length of the thread's contour at the angle at which the feed is ΔP.

    Raises LinkproofError as ``reference_angle`` does.
    """
    return float(contour_length(mechanism.sweep(reference_angle(mechanism, path)), path))


def feed(mechanism: Mechanism, path: ThreadPath, angle: ArrayLike) -> Array:
    """Actual feed Pd(φ), m, of the thread at crank angles, rad, of any shape; an array of that shape.

    Raises LinkproofError as ``reference_angle`` does, AssemblyError where the linkage cannot be assembled.
    """
    length = contour_length(mechanism.sweep(angle), path)
    return np.asarray(feed_of_length(path, length, reference_length(mechanism, path)))


def feed_of_length(path: ThreadPath, length: Scalar, start: float) -> Scalar:
    """Feed, m, of a contour of the given length, m, from its length ``start`` at the reference angle, m.

    The path says whether a longer or a shorter contour counts positive, and adds its stretch.
    """
    sign = -1.0 if path.feed == "shortening" else 1.0
    return sign * (length - start) + path.stretch


# The signals by name.


Formula = Callable[[LinkageInMotion], Scalar]


@dataclass(frozen=True)
class NamedSignal:
    """A signal of the closed form: its SI ``unit``, of a turning crank's, and its ``formula``.

    The formula takes a ``LinkageInMotion`` and gives the values, SI, in its shape or as one number. One that
    ``is_still`` depends on the crank's angle alone, not on how it moves. One that is not ``is_listed`` is computed
    where it is named, and not part of the results.
    """

    unit: str
    formula: Formula
    is_still: bool = False
    is_listed: bool = True


DRIVE: Final[Mapping[str, NamedSignal]] = {
    "phi": NamedSignal("rad", lambda at: at.sweep.angle, is_still=True),
    "omega": NamedSignal("rad/s", lambda at: at.speed),
    "epsilon": NamedSignal("rad/s²", lambda at: at.acceleration),
}
LOADS: Final[Mapping[str, NamedSignal]] = {
    "Mkr": NamedSignal("N m", lambda at: at.torque),
    "Peq": NamedSignal("W", lambda at: at.torque * at.speed),
    "Teq": NamedSignal("J", lambda at: 0.5 * at.inertia * (at.speed * at.speed)),
    "Jeq": NamedSignal("kg m²", lambda at: at.inertia, is_still=True),
}
EQUATION: Final[Mapping[str, NamedSignal]] = {
    "half_slope": NamedSignal(
        "kg m²", lambda at: reduced.half_inertia_derivative(at.sweep), is_still=True, is_listed=False
    ),
    "Q": NamedSignal("N m", lambda at: reduced.generalised_force(at.sweep), is_still=True, is_listed=False),
    "damping": NamedSignal("N m s", lambda at: reduced.damping_coefficient(at.sweep), is_still=True, is_listed=False),
}
OUTPUT: Final[Mapping[str, NamedSignal]] = {
    "S": NamedSignal("m", lambda at: at.farthest - at.sweep.output(), is_still=True),
    "v": NamedSignal("m/s", lambda at: -at.sweep.output(1) * at.speed),
    "a": NamedSignal(
        "m/s²", lambda at: -(at.sweep.output(2) * (at.speed * at.speed) + at.sweep.output(1) * at.acceleration)
    ),
}
SHAKING: Final[Mapping[str, NamedSignal]] = {
    "shaking_force:x": NamedSignal("N", lambda at: at.shaking[0]),
    "shaking_force:y": NamedSignal("N", lambda at: at.shaking[1]),
    "shaking_moment": NamedSignal("N m", lambda at: at.shaking[2]),
}
# Of a kind of parts its components, each with its unit.
COMPONENTS: Final[Mapping[str, Mapping[str, str]]] = {
    "point": {"x": "m", "y": "m", "vx": "m/s", "vy": "m/s", "ax": "m/s²", "ay": "m/s²"},
    "link": {"angle": "rad", "omega": "rad/s", "alpha": "rad/s²"},
    "joint_force": {"x": "N", "y": "N"},
    "shaking_force": {"x": "N", "y": "N"},
    "transmission_angle": {"": "rad"},
    "thread_feed": {"": "m"},
    "thread_length": {"": "m"},
}
POSITIONS: Final = ("x", "y", "angle")  # components that depend on the crank's angle alone
# Units that change where the driver is pushed along a line, so that φ is a length.
LINEAR_UNITS: Final[Mapping[str, str]] = {
    **{"phi": "m", "omega": "m/s", "epsilon": "m/s²", "Jeq": "kg", "Mkr": "N"},
    **{"half_slope": "kg/m", "Q": "N", "damping": "N s/m"},
}
SINGLE_SIGNALS: Final = {**DRIVE, **LOADS, **EQUATION, **OUTPUT, **SHAKING}
MAGNITUDE: Final = ":magnitude"
VECTORS: Final = ("joint_force:", "shaking_force:")  # whose magnitude is a signal as well
THREAD_FEED: Final = "thread_feed"
THREAD_LENGTH: Final = "thread_length"
OUTPUT_COORDINATE: Final = "output"  # no signal, for what is seen of it is S
ORDERS: Final = ("x", "y", "vx", "vy", "ax", "ay")  # of a point: two components of each derivative


def names(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of all listed signals that a mechanism has under any motion, always in the same order."""
    return tuple(name for name, signal in table(mechanism).items() if signal.is_listed)


def names_with_magnitudes(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of all listed signals of a mechanism and, after the components of each force, the name of its magnitude."""
    texts = []
    for name in names(mechanism):
        texts.append(name)
        if name.startswith(VECTORS) and name.endswith(":y"):
            texts.append(name.removesuffix(":y") + MAGNITUDE)
    return tuple(texts)


def unit(name: str, linkage: Linkage) -> str:
    """SI unit, as text, of a signal of a linkage by name, or of the magnitude of a vector.

    Whether the linkage has the signal is not checked; raises KeyError for a kind that no linkage has.
    """
    kind, _, part = name.partition(":")
    whole = name if name in SINGLE_SIGNALS else kind
    if whole in SINGLE_SIGNALS:
        return unit_of(whole, SINGLE_SIGNALS[whole].unit, is_linear=linkage.is_linear)
    components, component = COMPONENTS[kind], part.rpartition(":")[2]
    return components.get(component, next(iter(components.values())))  # a magnitude has that of its components


def unit_of(name: str, unit: str, *, is_linear: bool) -> str:
    """Unit of a quantity by name: ``unit``, that of a turning crank's, or for a linear driver what takes its place."""
    return LINEAR_UNITS.get(name, unit) if is_linear else unit


def signal(at: LinkageInMotion, name: str) -> Array:
    """A signal by name, SI, the magnitude of a vector, ``joint_force:A:magnitude``, or ``OUTPUT_COORDINATE``.

    It has the angles' shape. Raises UnknownNameError for a signal that the linkage does not have, LinkproofError for
    the output's coordinate without an output and where friction locks the linkage, AssemblyError where it cannot be
    assembled or moved.
    """
    if name == OUTPUT_COORDINATE:
        return at.sweep.output()
    if name.endswith(MAGNITUDE):
        vector = name.removesuffix(MAGNITUDE)
        return np.hypot(signal(at, f"{vector}:x"), signal(at, f"{vector}:y"))
    known = table(at.mechanism)
    if name not in known:
        raise UnknownNameError("signal", name, known)
    return np.copy(np.broadcast_to(known[name].formula(at), at.sweep.angle.shape))


def check_signals(mechanism: Mechanism, names: Iterable[str], *, has_speed: bool) -> tuple[str, ...]:
    """The requested names, each once, in their order, after checks.

    Raises UnknownNameError for a signal that the mechanism does not have, LinkproofError for S, v or a without an
    output and, unless ``has_speed``, for a signal that depends on the crank's speed.
    """
    known = table(mechanism)
    chosen = tuple(dict.fromkeys(names))
    for name in chosen:
        if name in OUTPUT:
            output_of(mechanism.linkage)
        if name not in known:
            raise UnknownNameError("quantity", name, known)
    moving = [name for name in chosen if not known[name].is_still]
    if moving and not has_speed:
        raise LinkproofError(
            f"speed: expected the crank's speed in rad/s for {', '.join(moving)}, got none; pass speed=..."
        )
    return chosen


def is_angle(name: str) -> bool:
    """Whether a signal, by name, is an angle that grows from turn to turn: φ, or the angle of a link."""
    return name == "phi" or (name.startswith("link:") and name.endswith(":angle"))


def is_wrapped(name: str, linkage: Linkage) -> bool:
    """Whether a formula gives a signal, by name, only within one turn, so that it has to be unwrapped along its angles.

    Those are the angles of links, but for that of a turning crank.
    """
    return is_angle(name) and name != "phi" and (linkage.is_linear or name != f"link:{linkage.crank}:angle")


def moving_points(linkage: Linkage) -> tuple[str, ...]:
    """Names, sorted, of the points of moving links that are not fixed to the ground."""
    return tuple(sorted({point for link in linkage.links.values() for point in link.points} - {*linkage.ground}))


@once_per_mechanism
def table(mechanism: Mechanism) -> Mapping[str, NamedSignal]:
    """Every signal of a mechanism by name, those not listed too; made once for a mechanism, and not to be changed."""
    linkage, signals = mechanism.linkage, dict(DRIVE)
    loaded = not linkage.is_idle
    if loaded:
        signals |= LOADS
    if linkage.output is not None:
        signals |= OUTPUT
    if linkage.thread is not None:
        signals |= _thread_signals(mechanism, linkage.thread)
    signals |= _signals_of_kind("point", moving_points(linkage), _point_component)
    signals |= _signals_of_kind("link", linkage.links, _link_component)
    if loaded:
        signals |= _signals_of_kind("joint_force", linkage.joint_names, _joint_force_component)
        signals |= SHAKING
        for link in linkage.links:
            formula = partial(_link_inertia, link=link)
            signals[f"Jeq:{link}"] = NamedSignal("kg m²", formula, is_still=True, is_listed=False)
    for dyad in mechanism.structure.dyads:
        formula = partial(_transmission_angle, group=dyad.name)
        signals[f"transmission_angle:{dyad.name}"] = NamedSignal("rad", formula, is_still=True)
    return {**signals, **EQUATION}


def _thread_signals(mechanism: Mechanism, path: ThreadPath) -> Iterator[tuple[str, NamedSignal]]:
    """Yield the name and the signal of the thread's feed, if its reference angle can be found, and of its length.

    An eye's extreme position, from which the feed may count, needs a full turn.
    """
    with suppress(LinkproofError):
        start = reference_length(mechanism, path)
        yield (
            THREAD_FEED,
            NamedSignal("m", lambda at: feed_of_length(path, contour_length(at.sweep, path), start), is_still=True),
        )
    yield (
        THREAD_LENGTH,
        NamedSignal("m", lambda at: contour_length(at.sweep, path), is_still=True, is_listed=False),
    )


def _signals_of_kind(kind: str, parts: Iterable[str], formula: Callable[..., Scalar]) -> dict[str, NamedSignal]:
    """The signals of a kind, by name: every component of each of its parts (points, links, joints), which are names.

    ``formula(at, name=..., component=...)`` computes one of them for a ``LinkageInMotion``, by the part's name.
    """
    is_place = kind != "joint_force"
    return {
        f"{kind}:{part}:{component}": NamedSignal(
            unit, partial(formula, name=part, component=component), is_still=is_place and component in POSITIONS
        )
        for part in parts
        for component, unit in COMPONENTS[kind].items()
    }


def _point_component(at: LinkageInMotion, name: str, component: str) -> Scalar:
    """A component, x, y, vx, vy, ax or ay, of the motion of a point by name, SI, ground frame."""
    order, axis = divmod(ORDERS.index(component), 2)
    if order == 0:
        return at.sweep.point(name)[axis]
    first = at.sweep.point(name, 1)[axis]
    if order == 1:
        return first * at.speed
    return at.sweep.point(name, 2)[axis] * at.speed**2 + first * at.acceleration


def _link_component(at: LinkageInMotion, name: str, component: str) -> Scalar:
    """The angle, "angle", angular velocity, "omega", or angular acceleration of a link by name, SI.

    The angle is unwrapped along the sweep's last axis.
    """
    if component == "angle":
        return at.sweep.angles(name)
    first = at.sweep.rates(name)[2]
    if component == "omega":
        return first * at.speed
    return at.sweep.accelerations(name)[2] * at.speed**2 + first * at.acceleration


def _link_inertia(at: LinkageInMotion, link: str) -> Scalar:
    """The share of one link, by name, in the moment of inertia reduced to the crank, kg m²."""
    return reduced.reduced_inertia(at.sweep, [link])


def _joint_force_component(at: LinkageInMotion, name: str, component: str) -> Scalar:
    """The x or y component of the force of a joint, by name, on its first body, N, ground frame."""
    return at.joint_forces[name]["xy".index(component)]


def _transmission_angle(at: LinkageInMotion, group: str) -> Scalar:
    """The transmission angle of a group by its name, rad, in [0, π/2]."""
    dyad = next(dyad for dyad in at.sweep.structure.dyads if dyad.name == group)
    return transmission_angle(at.sweep, dyad)


# Signals by name over many crank angles: only what is requested is computed, in pieces that stay in the cache.


# Crank angles per piece. Measured on the needle mechanisms: from 4096 to 16384 the cost per angle is the same within a
# tenth; shorter pieces pay NumPy's cost per call (1024: twice), longer ones leave the cache (100 000 at once: twice).
PIECE: Final = 6144


def evaluate(
    mechanism: Mechanism,
    angle: ArrayLike,
    names: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
) -> dict[str, Array]:
    """Signals of ``analytic.signals`` by name at every crank angle (rad, any shape); arrays of that shape, SI.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank are signed, scalar or of the angles' shape; the speed
    is needed by whatever depends on the crank's motion. S counts from the top dead centre of a full turn, or where
    there is none from the farthest place between the least and the largest angle. Angles of links are unwrapped along
    the last axis. Raises errors as ``check_signals`` does, LinkproofError for a speed or acceleration of another shape
    and where friction locks the linkage, and AssemblyError where it cannot be assembled or moved.
    """
    chosen = check_signals(mechanism, names, has_speed=speed is not None)
    angle = np.asarray(angle, dtype=float)
    motion = [
        _flat_as_angles(angle, 0.0 if speed is None else speed, "speed"),
        _flat_as_angles(angle, acceleration, "acceleration"),
    ]
    values = _evaluate_pieces(mechanism, chosen, angle.ravel(), motion)
    if "S" in chosen:
        values[chosen.index("S")] += farthest_between(mechanism, angle)
    table = {name: row.reshape(angle.shape) for name, row in zip(chosen, values, strict=True)}
    wrapped = [name for name in table if angle.ndim and is_wrapped(name, mechanism.linkage)]
    return table | {name: np.unwrap(table[name]) for name in wrapped}


def _flat_as_angles(angle: Array, value: ArrayLike, name: str) -> Array:
    """A number as an array without axes, or an array of the angles' shape flattened.

    Raises LinkproofError for another shape; ``name`` is what the value is called in the message.
    """
    values = np.asarray(value, dtype=float)
    if values.ndim and values.shape != angle.shape:
        raise LinkproofError(
            f"{name}: expected a number or an array of the crank angles' shape {angle.shape}, got shape "
            f"{values.shape}; pass one value per angle"
        )
    return values.ravel() if values.ndim else values


def _evaluate_pieces(mechanism: Mechanism, names: tuple[str, ...], angle: Array, motion: Sequence[Array]) -> Array:
    """Signals by name at flat crank angles, rad, (signals, angles), SI, piece by piece.

    S is minus the output's coordinate, still without its zero. ``motion`` has the crank's speed and acceleration, each
    a number or (angles,). Raises AssemblyError where the linkage cannot be assembled or moved, LinkproofError where
    friction locks it.
    """
    values = np.empty((len(names), angle.size))
    for start in range(0, angle.size, PIECE):
        here = slice(start, start + PIECE)
        moves = (move[here] if move.ndim else move for move in motion)
        at = MovingSweep(mechanism, mechanism.sweep(angle[here]), *moves)
        for row, name in zip(values, names, strict=True):
            row[here] = signal(at, name)
    return values
