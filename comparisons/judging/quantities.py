"""The quantities that are compared: what each is in the closed form, and how it is read from an engine's motion.

A quantity is one row of ``QUANTITIES``; adding one adds nothing elsewhere. S is the output's displacement from its top
dead centre (positive away from it), v and a its time derivatives, as in article 003. Joint forces have a row for every
joint of the linkage at hand, ``joint_force:JOINT``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from analytic.description.thread_path import ThreadEye, ThreadPath
from analytic.errors import LinkproofError, UnknownNameError
from analytic.turn.thread_feed import feed, feed_of_length
from analytic.turn.unit_functions import top_dead_centre
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from engines.contract import Signal
from engines.scene import Channel

Array = NDArray[np.float64]

JOINT_FORCE = "joint_force:"


@dataclass(frozen=True)
class Quantity:
    """A compared quantity: ``reference(case, time)`` is the truth, ``observed(case, motion)`` what the engine did.

    Values are (n,), or (n, 2) for a vector. ``prescribed`` and ``free`` say under which drive it is a result rather
    than given; ``clock`` is the channel whose samples it has.
    """

    name: str
    unit: str
    title: str
    clock: Channel
    reference: Callable[[Case, Array], Array]
    observed: Callable[[Case, ObservedMotion], Signal]
    also: frozenset[Channel] = frozenset()
    holds_acceleration: bool = False
    needs_output: bool = False
    needs_thread: bool = False
    prescribed: bool = True
    free: bool = True

    @property
    def channels(self) -> frozenset[Channel]:
        """What an engine has to record for it."""
        return self.also | {self.clock}

    def fits(self, case: Case) -> bool:
        """Whether it is a result of the case's drive and its linkage has what it needs."""
        wanted = self.prescribed if case.is_prescribed else self.free
        linkage = case.mechanism.linkage
        lacks = (self.needs_output and linkage.output is None) or (self.needs_thread and linkage.thread is None)
        return wanted and not lacks


def _inertia(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.VELOCITY).time
    fast = np.abs(case.at(time).speed) >= case.least_speed
    inertia = 2.0 * motion.kinetic_energy(time)[fast] / motion.crank(Channel.VELOCITY, time)[fast] ** 2
    return Signal(time[fast], inertia)


def _kinetic_energy(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.VELOCITY).time
    return Signal(time, motion.kinetic_energy(time))


def _power(case: Case, motion: ObservedMotion) -> Signal:
    torque = motion.signal(Channel.TORQUE)
    return Signal(torque.time, torque.values * motion.crank(Channel.VELOCITY, torque.time))


def _displacement(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.POSITION).time
    place = case.along(motion.point(case.output.link, case.output_anchor(), time))
    return Signal(time, top_dead_centre(case.mechanism).coordinate - place)


def _velocity(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.VELOCITY).time
    return Signal(time, -case.along(motion.point(case.output.link, case.output_anchor(), time, 1)))


def _acceleration(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.ACCELERATION).time
    return Signal(time, -case.along(motion.point(case.output.link, case.output_anchor(), time, 2)))


def _crank(channel: Channel, case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(channel).time
    return Signal(time, motion.crank(channel, time))


def _true_torque(case: Case, time: Array) -> Array:
    return case.at(time).torque


def _true_displacement(case: Case, time: Array) -> Array:
    return top_dead_centre(case.mechanism).coordinate - case.sweep(time).output()


def _true_acceleration(case: Case, time: Array) -> Array:
    at = case.at(time)
    return -(at.sweep.output(2) * at.speed**2 + at.sweep.output(1) * at.acceleration)


def _true_joint_force(joint: str, case: Case, time: Array) -> Array:
    return np.asarray(case.at(time).joint_forces[joint].T)


def _joint_force(joint: str) -> Quantity:
    return Quantity(
        name=JOINT_FORCE + joint,
        unit="N",
        title=f"force in joint {joint}",
        clock=Channel.JOINT_FORCE,
        reference=partial(_true_joint_force, joint),
        observed=lambda case, motion: motion.history.joint_force[joint],
        holds_acceleration=True,
    )


def _thread(case: Case) -> ThreadPath:
    thread = case.mechanism.linkage.thread
    if thread is None:
        raise LinkproofError(
            f"'{case.mechanism.linkage.name}' has no thread, so it feeds none: add a [thread] to its file, or leave "
            "thread_feed out"
        )
    return thread


def _thread_feed(case: Case, motion: ObservedMotion) -> Signal:
    """Feed from where the engine has the eyes; the reference length is geometry, the same for all."""
    path, linkage = _thread(case), case.mechanism.linkage
    time = motion.signal(Channel.POSITION).time
    corners = []
    for stop in path.stops:
        if isinstance(stop, ThreadEye):
            link = next(name for name, body in linkage.links.items() if stop.point in body.points)
            local, centre = linkage.links[link].points[stop.point], linkage.links[link].centre
            place = motion.point(link, (local[0] - centre[0], local[1] - centre[1]), time)
            corners.append(np.column_stack([place, np.full(len(time), stop.z)]))
        else:
            corners.append(np.broadcast_to(np.asarray(stop.position), (len(time), 3)))
    length = np.linalg.norm(np.diff(np.stack(corners), axis=0), axis=-1).sum(axis=0)
    return Signal(time, feed_of_length(case.mechanism, path, length))


QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity(
            name="phi",
            unit="rad",
            title="crank angle",
            clock=Channel.POSITION,
            reference=lambda case, time: case.motion.angle(time),
            observed=partial(_crank, Channel.POSITION),
            prescribed=False,
        ),
        Quantity(
            name="omega",
            unit="rad/s",
            title="crank speed",
            clock=Channel.VELOCITY,
            reference=lambda case, time: case.at(time).speed,
            observed=partial(_crank, Channel.VELOCITY),
            prescribed=False,
        ),
        Quantity(
            name="epsilon",
            unit="rad/s²",
            title="crank acceleration",
            clock=Channel.ACCELERATION,
            reference=lambda case, time: case.at(time).acceleration,
            observed=partial(_crank, Channel.ACCELERATION),
            holds_acceleration=True,
            prescribed=False,
        ),
        Quantity(
            name="Jeq",
            unit="kg m²",
            title="reduced moment of inertia",
            clock=Channel.VELOCITY,
            reference=lambda case, time: case.at(time).inertia,
            observed=_inertia,
        ),
        Quantity(
            name="Teq",
            unit="J",
            title="kinetic energy",
            clock=Channel.VELOCITY,
            reference=lambda case, time: 0.5 * case.at(time).inertia * case.at(time).speed ** 2,
            observed=_kinetic_energy,
        ),
        Quantity(
            name="Mkr",
            unit="N m",
            title="crank torque",
            clock=Channel.TORQUE,
            reference=_true_torque,
            observed=lambda case, motion: motion.signal(Channel.TORQUE),
            holds_acceleration=True,
            free=False,
        ),
        Quantity(
            name="Peq",
            unit="W",
            title="drive power",
            clock=Channel.TORQUE,
            also=frozenset({Channel.VELOCITY}),
            reference=lambda case, time: _true_torque(case, time) * case.at(time).speed,
            observed=_power,
            holds_acceleration=True,
            free=False,
        ),
        Quantity(
            name="S",
            unit="m",
            title="output displacement",
            clock=Channel.POSITION,
            reference=_true_displacement,
            observed=_displacement,
            needs_output=True,
        ),
        Quantity(
            name="v",
            unit="m/s",
            title="output velocity",
            clock=Channel.VELOCITY,
            also=frozenset({Channel.POSITION}),
            reference=lambda case, time: -case.sweep(time).output(1) * case.at(time).speed,
            observed=_velocity,
            needs_output=True,
        ),
        Quantity(
            name="a",
            unit="m/s²",
            title="output acceleration",
            clock=Channel.ACCELERATION,
            also=frozenset({Channel.POSITION, Channel.VELOCITY}),
            reference=_true_acceleration,
            observed=_acceleration,
            holds_acceleration=True,
            needs_output=True,
        ),
        Quantity(
            name="thread_feed",
            unit="m",
            title="thread feed",
            clock=Channel.POSITION,
            reference=lambda case, time: feed(case.mechanism, _thread(case), case.motion.angle(time)),
            observed=_thread_feed,
            needs_thread=True,
        ),
    )
}


def all_quantities(case: Case) -> dict[str, Quantity]:
    """Every quantity that is a result of a case, those of its joints among them."""
    joints = [_joint_force(joint) for joint in case.joint_names()]
    return {q.name: q for q in (*QUANTITIES.values(), *joints) if q.fits(case)}


def chosen_quantities(case: Case, names: Iterable[str]) -> list[Quantity]:
    """The quantities of these names, in this order; all that fit the case if none is named.

    ``joint_force`` stands for the forces of all joints. Raises UnknownNameError for a name that no case has, and
    LinkproofError for one that this case has not.
    """
    known = all_quantities(case)
    found: dict[str, Quantity] = {}
    for name in names:
        if name == JOINT_FORCE.rstrip(":"):
            found |= {key: known[key] for key in known if key.startswith(JOINT_FORCE)}
        elif name in known:
            found[name] = known[name]
        else:
            _refuse(case, name, known)
    return list((found or known).values())


def check_defined(case: Case, quantities: Iterable[Quantity]) -> None:
    """Raise LinkproofError for a quantity that the closed form does not have in this case."""
    for quantity in quantities:
        try:
            quantity.reference(case, np.zeros(1))
        except LinkproofError as error:
            reason = str(error).partition(";")[0]
            raise LinkproofError(
                f"{quantity.name} is undefined in regime '{case.motion.regime}', because {reason}; ask for other "
                "quantities with --quantity"
            ) from error


def _refuse(case: Case, name: str, known: Mapping[str, Quantity]) -> None:
    if name not in QUANTITIES:
        raise UnknownNameError("quantity", name, [*QUANTITIES, JOINT_FORCE.rstrip(":"), *known])
    if QUANTITIES[name].needs_output:
        _ = case.output
    if QUANTITIES[name].needs_thread:
        _thread(case)
    raise LinkproofError(
        f"{name} is given, not a result, in regime '{case.motion.regime}' of '{case.mechanism.linkage.name}': ask for "
        f"one of {', '.join(known)}"
    )
