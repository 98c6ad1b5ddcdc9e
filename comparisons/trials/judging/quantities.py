"""The quantities that are compared: what each is in the closed form, and how it is read from an engine's motion.

A quantity is a signal of ``analytic.signals``, which has its formula and unit, a row of ``quantities.toml`` and what an
engine did, here. S is the output's displacement from its top dead centre (positive away from it), v and a its time
derivatives, as in article 003; where the crank cannot turn fully it counts from the farthest point of the motion.
Every joint of the linkage at hand has its force, ``joint_force:JOINT``. What an engine did is read from its channels;
one that was not recorded raises AssertionError.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN
from analytic.description.linkage import ThreadEye, ThreadPath
from analytic.dynamics.reduced import near_load_jumps
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.dead_centres import top_of_turn
from analytic.numerics.arrays import Array, Booleans
from analytic.signals import SINGLE_SIGNALS, feed, feed_of_length, reference_angle, reference_length, unit_of
from comparisons.motion.case import Case, DriverMotion, zero_of_output
from comparisons.motion.thinning import stored_curve
from comparisons.trials.judging.records import Error
from comparisons.trials.observed_motion import SHARP_POINTS, ObservedMotion, peak, resample
from comparisons.trials.runs.store import Curve
from engines.contract import Origin, Signal
from engines.scene import LEVELS, Channel

JOINT_FORCE = "joint_force:"
TABLE = Path(__file__).with_name("quantities.toml")

Reference = Callable[[Case, Array], Array]
Observed = Callable[[Case, ObservedMotion], Signal]

# Which samples lie at a jump of the driver's acceleration: one rule for all who judge or draw them.


WINDOW: Final = 1e-2  # of the shortest time between two jumps, the start and the end: half of the window at a jump
ROUNDING: Final = 1e-9  # of the half window


@dataclass(frozen=True)
class Quantity:
    """A compared quantity: ``reference(case, time)`` is the truth, ``observed(case, motion)`` what the engine did.

    The truth at times (n,), s, is (n,), or (n, 2) for a vector, in ``unit``; what the engine did is a Signal of such
    values, or of a vector's magnitudes. ``prescribed`` and ``free`` say under which drive it is a result rather than
    given; ``clock`` is the channel whose samples it has, ``also`` are others that it is made of; ``zero`` says in words
    where it is counted from, which the engine's own motion shows only if its crank turns fully, or cannot.
    ``linear_title`` is the title for a linear drive, "" if that is the same.
    """

    name: str
    reference: Reference
    observed: Observed
    unit: str
    title: str
    clock: Channel
    also: frozenset[Channel] = frozenset()
    linear_title: str = ""
    needs_output: bool = False
    needs_thread: bool = False
    prescribed: bool = True
    free: bool = True
    zero: str = ""

    def origin(self, motion: ObservedMotion) -> Origin:
        """The weakest origin of the engine's signals that the quantity is computed from.

        Raises AssertionError for a channel that was not recorded, KeyError for such a joint.
        """
        if self.name.startswith(JOINT_FORCE):
            return motion.history.joint_force[self.name.removeprefix(JOINT_FORCE)].origin
        return motion.origin(self.channels)

    def lacking(self, motion: ObservedMotion) -> str:
        """The channels, or the joint, that it needs and the engine has not recorded, in words; "" if none."""
        if self.name.startswith(JOINT_FORCE):
            joint = self.name.removeprefix(JOINT_FORCE)
            return "" if joint in motion.history.joint_force else f"force in joint '{joint}'"
        return ", ".join(sorted(channel.value for channel in self.channels if not motion.has(channel)))

    def shared(self, case: Case, motion: ObservedMotion) -> str:
        """What of its value comes from the reference, not the engine, in words, such as its zero; "" for nothing.

        A zero is the engine's own if its crank made a full turn or, of the output, if the crank cannot make one.
        """
        if not self.zero or (self.needs_output and top_of_turn(case.mechanism) is None):
            return ""
        return self.zero if motion.last_turn is None else ""

    def undefined(self, case: Case) -> str:
        """The reason why the closed form has no value of it in a case, by its value at the start; "" if it has."""
        try:
            self.reference(case, np.zeros(1))
        except LinkproofError as error:
            return str(error)
        return ""

    @property
    def holds_acceleration(self) -> bool:
        """Whether it jumps with the crank's acceleration, as all but positions and velocities do."""
        return self.clock not in LEVELS[:2]

    @property
    def channels(self) -> frozenset[Channel]:
        """The channels that an engine has to record for it, ``clock`` among them."""
        return self.also | {self.clock}

    def fits(self, case: Case) -> bool:
        """Whether it is a result of the case's drive and its linkage has the output or thread that it needs."""
        is_result = self.prescribed if case.is_prescribed else self.free
        linkage = case.mechanism.linkage
        lacks = (self.needs_output and linkage.output is None) or (self.needs_thread and linkage.thread is None)
        return is_result and not lacks


def _inertia(case: Case, motion: ObservedMotion) -> Signal:
    """Jeq = 2 T/ω², kg m² (kg of a linear drive), on the clock of the velocities, without samples near standstill."""
    time = motion.signal(Channel.VELOCITY).time
    fast = np.abs(case.at(time).speed) >= case.least_speed
    inertia = 2.0 * motion.kinetic_energy(time)[fast] / motion.crank(Channel.VELOCITY, time)[fast] ** 2
    return Signal(time[fast], inertia)


def _kinetic_energy(case: Case, motion: ObservedMotion) -> Signal:
    """Kinetic energy of all bodies, J, on the clock of the velocities."""
    time = motion.signal(Channel.VELOCITY).time
    return Signal(time, motion.kinetic_energy(time))


def _power(case: Case, motion: ObservedMotion) -> Signal:
    """Power of the drive, W, on the clock of the torque: torque times the crank's speed, both the engine's."""
    torque = motion.signal(Channel.TORQUE)
    return Signal(torque.time, torque.values * motion.crank(Channel.VELOCITY, torque.time))


def _displacement(case: Case, motion: ObservedMotion) -> Signal:
    """S, m, on the clock of the positions: displacement of the output, positive away from its farthest place.

    That place is the engine's own where its motion shows it, in a full turn, or anywhere if the crank cannot make one;
    else the closed form's. Raises LinkproofError without an output.
    """
    place = _output_signal(Channel.POSITION, 0, case, motion)
    turn = slice(None) if top_of_turn(case.mechanism) is None else motion.last_turn
    if not case.mechanism.repeats:  # a last turn shows one of several
        turn = None
    top = (
        zero_of_output(case.mechanism, case.motion)
        if turn is None
        else peak(Signal(place.time[turn], -place.values[turn]), case.motion.jumps)
    )
    return Signal(place.time, top + place.values)


def _output_signal(channel: Channel, order: int, case: Case, motion: ObservedMotion) -> Signal:
    """The output's coordinate, m, or its derivative of an ``order``, 1 or 2, per s or s², on a channel's clock.

    Positive away from top dead centre. Raises LinkproofError without an output.
    """
    time = motion.signal(channel).time
    return Signal(time, -case.along(motion.point(case.output.link, case.output_anchor(), time, order)))


def _crank_signal(channel: Channel, case: Case, motion: ObservedMotion) -> Signal:
    """φ, rad or m, its speed or its acceleration, by the channel and on its clock, by the engine's own account."""
    time = motion.signal(channel).time
    return Signal(time, motion.crank(channel, time))


def _joint_force(joint: str) -> Quantity:
    """The force in a joint, N, as a quantity; its truth is (n, 2) in the ground frame, on the joint's first body."""
    return Quantity(
        JOINT_FORCE + joint,
        reference=lambda case, time: np.asarray(case.at(time).joint_forces[joint].T),
        observed=lambda case, motion: motion.history.joint_force[joint],
        unit="N",
        title=f"force in joint {joint}",
        clock=Channel.JOINT_FORCE,
    )


def _thread(case: Case) -> ThreadPath:
    """The linkage's thread; raises LinkproofError without one."""
    thread = case.mechanism.linkage.thread
    if thread is None:
        raise LinkproofError(
            f"'{case.mechanism.linkage.name}' has no thread, so it feeds none: add a [thread] to its file, or leave "
            "thread_feed out"
        )
    return thread


def _thread_feed(case: Case, motion: ObservedMotion) -> Signal:
    """The feed, m, on the clock of the positions, computed from these and the engine's own reference angle.

    Without a last full turn of the engine, the contour's reference length is the closed form's. Raises LinkproofError
    without a thread.
    """
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
    start, turn = reference_length(case.mechanism, path), motion.last_turn
    if turn is not None:
        angle = motion.crank(Channel.POSITION, time)[turn]
        way = math.copysign(1.0, angle[-1] - angle[0])
        turned = way * (reference_angle(case.mechanism, path) - angle[-1]) % FULL_TURN + way * angle[-1] - FULL_TURN
        start = float(resample(Signal(way * angle, length[turn]), np.array([turned]), min(SHARP_POINTS, len(angle)))[0])
    return Signal(time, feed_of_length(path, length, start))


def _true_feed(case: Case, time: Array) -> Array:
    """The thread's feed by the closed form, m, at times (n,), s; raises LinkproofError without a thread."""
    return feed(case.mechanism, _thread(case), case.motion.angle(time))


# Of each quantity of the table what the engine did; the truth is that of ``analytic.signals``.
OBSERVED: Mapping[str, Observed] = {
    "phi": partial(_crank_signal, Channel.POSITION),
    "omega": partial(_crank_signal, Channel.VELOCITY),
    "epsilon": partial(_crank_signal, Channel.ACCELERATION),
    "Jeq": _inertia,
    "Teq": _kinetic_energy,
    "Mkr": lambda case, motion: motion.signal(Channel.TORQUE),
    "Peq": _power,
    "S": _displacement,
    "v": partial(_output_signal, Channel.VELOCITY, 1),
    "a": partial(_output_signal, Channel.ACCELERATION, 2),
    "thread_feed": _thread_feed,
}


def _quantity(name: str, row: dict[str, Any]) -> Quantity:
    """A quantity from its row of ``quantities.toml``: fields of ``Quantity`` by name, channels as text.

    Unit and truth are those of the signal of this name in ``analytic.signals``, where there is one, else the truth is
    the thread's feed. Raises KeyError for a name that ``OBSERVED`` lacks, ValueError for an unknown channel.
    """
    channels = {"clock": Channel(row["clock"]), "also": frozenset(map(Channel, row.get("also", ())))}
    if name not in SINGLE_SIGNALS:
        return Quantity(name, _true_feed, OBSERVED[name], **{**row, **channels})
    known = SINGLE_SIGNALS[name]
    return Quantity(
        name,
        lambda case, time: np.asarray(known.formula(case.at(time))),
        OBSERVED[name],
        **{"unit": known.unit, **row, **channels},
    )


QUANTITIES: Mapping[str, Quantity] = {
    name: _quantity(name, row) for name, row in tomllib.loads(TABLE.read_text(encoding="utf-8")).items()
}


def all_quantities(case: Case) -> dict[str, Quantity]:
    """Every quantity that applies to a case, those of its joints included, by name."""
    joints = [_joint_force(joint) for joint in case.joint_names()]
    return {q.name: _worded_for_drive(q, case) for q in (*QUANTITIES.values(), *joints) if q.fits(case)}


def _worded_for_drive(quantity: Quantity, case: Case) -> Quantity:
    """The quantity, its unit and title replaced by those for a linear drive if the case has one."""
    linkage = case.mechanism.linkage
    if not linkage.is_linear:
        return quantity
    unit = unit_of(quantity.name, quantity.unit, is_linear=True)
    return replace(quantity, unit=unit, title=quantity.linear_title or quantity.title)


def chosen_quantities(case: Case, names: Iterable[str]) -> list[Quantity]:
    """The quantities of these names, in this order, each once; without names all that fit the case.

    ``joint_force`` stands for the forces of all joints. Raises UnknownNameError for a name that no case has, and
    LinkproofError for one that this case has not.
    """
    known = all_quantities(case)
    quantities: dict[str, Quantity] = {}
    for name in names:
        if name == JOINT_FORCE.rstrip(":"):
            quantities |= {key: known[key] for key in known if key.startswith(JOINT_FORCE)}
        elif name in known:
            quantities[name] = known[name]
        else:
            _refuse_quantity(case, name, known)
    return list((quantities or known).values())


def check_defined(case: Case, quantities: Iterable[Quantity]) -> None:
    """Raise LinkproofError for the first quantity of which the closed form has no value at the start of this case."""
    for quantity in quantities:
        reason = quantity.undefined(case).partition(";")[0]
        if reason:
            raise LinkproofError(
                f"{quantity.name} is undefined in regime '{case.motion.regime}', because {reason}; ask for other "
                "quantities with --quantity"
            )


def _refuse_quantity(case: Case, name: str, known: Mapping[str, Quantity]) -> None:
    """Raise LinkproofError or UnknownNameError with the reason why a case lacks this quantity.

    ``known`` are the case's own, by name. Unknown is a name that no case has.
    """
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


def near_jumps(time: Array, motion: DriverMotion) -> Booleans:
    """Which of the times (n,), s, lie in the window around some jump of a motion's acceleration, (n,).

    There accelerations, torques and forces have two true values. The window belongs to the motion: it is as wide for
    long steps of an engine or a file as for short ones.
    """
    near = np.zeros(len(time), dtype=bool)
    for jump in motion.jumps:
        near |= near_jump(time, motion, jump)
    return near


def has_two_values(case: Case, time: Array) -> Booleans:
    """Which of the times (n,), s, lie at a jump of the acceleration, of friction or of a load that acts one way, (n,).

    A driver at rest has no direction, so that friction and such loads have two values there, too.
    """
    linkage = case.mechanism.linkage
    is_directed = bool(linkage.friction) or linkage.has_one_way_loads
    at_rest = is_directed & (case.motion.speed(time) == 0.0)
    near = near_jumps(time, case.motion) | near_load_jumps(case.mechanism, case.motion.angle(time))
    return np.asarray(near | at_rest)


def near_jump(time: Array, motion: DriverMotion, jump: float) -> Booleans:
    """Which of the times (n,), s, lie in the window around ``jump``, s, one of the motion's jumps, (n,).

    It reaches ``WINDOW`` of the shortest time between two jumps, the start or the end to either side.
    """
    pieces = np.diff(np.unique([0.0, *motion.jumps, motion.duration]))
    half = WINDOW * float(np.min(pieces, initial=motion.duration))
    return np.asarray(np.abs(time - jump) <= half * (1.0 + ROUNDING))


UNBOUNDED = "joint forces have no bound where the linkage passes its change point at {angle}"


class NoSampleError(ValueError):
    """No sample of a run allows a comparison of a quantity; the message says why."""


def deviation(case: Case, quantity: Quantity, motion: ObservedMotion, blank: Error) -> tuple[Error, Curve]:
    """The ``blank`` record with the errors of one quantity over every sample that the engine returned, and its curve.

    The record is not judged yet; the curve is from ``stored_curve``. At an acceleration jump (``near_jumps``), samples
    of accelerations, torques, powers and forces have a bound of their own, ``error_at_jumps``: an engine may be off by
    the jump besides. Where friction or a load jumps they are left out, and so are samples of Jeq near standstill;
    ``left_out`` counts these and those at acceleration jumps. A vector is compared as one, and stored by its magnitude;
    where the engine tells the magnitude alone, magnitudes are compared. Raises NoSampleError where no sample is left,
    forces have no bound, a thread's feed has no value, or no link has a mass and the truth is zero; LinkproofError
    where the closed form has none.
    """
    if quantity.name.startswith("joint_force:") and case.unbounded_at is not None:
        raise NoSampleError(UNBOUNDED.format(angle=degrees(case.unbounded_at)))
    if quantity.needs_thread and (reason := quantity.undefined(case)):
        raise NoSampleError(reason)
    signal = quantity.observed(case, motion)
    counted = np.ones(len(signal.time), dtype=bool)
    if quantity.holds_acceleration:
        counted &= ~has_two_values(case, signal.time)
    if not counted.any():
        raise NoSampleError(
            f"every sample of {quantity.name} lies at an acceleration jump or near standstill: run it for longer"
        )
    truth = quantity.reference(case, signal.time)
    reference = _magnitudes(truth)
    errors = _magnitudes(signal.values - (truth if signal.values.ndim == truth.ndim else reference))
    difference, peak = errors[counted], float(np.max(reference[counted]))
    if peak == 0.0 and case.mechanism.linkage.is_massless:
        raise NoSampleError(f"{quantity.name} is zero throughout, as no link has a mass: its error has no scale")
    scale, worst = peak or 1.0, int(np.argmax(difference))
    record = blank._replace(
        shared=quantity.shared(case, motion),
        error_max=float(difference[worst] / scale),
        error_rms=float(np.sqrt(np.mean(difference**2)) / scale),
        error_at_jumps=_error_at_jumps(case, quantity, signal.time, errors) / scale,
        peak=peak,
        worst_time=float(signal.time[counted][worst]),
        samples=len(difference),
        left_out=len(_sample_times(quantity, motion)) - len(difference),
    )
    observed = signal.values if signal.values.ndim == 1 else _magnitudes(signal.values)
    reference = truth if truth.ndim == 1 else reference  # a number keeps its sign
    return record, stored_curve(signal.time, case.motion.angle(signal.time), reference, observed - reference)


def _error_at_jumps(case: Case, quantity: Quantity, time: Array, errors: Array) -> float:
    """The largest of the ``errors`` (n,), SI, of samples at an acceleration jump beyond the size of that jump.

    ``time`` (n,), s, are the samples'. It is 0 without such samples, or of a quantity that does not jump.
    """
    jumps = case.motion.jumps if quantity.holds_acceleration else ()
    beside = [near_jump(time, case.motion, jump) for jump in jumps]
    if not np.any(beside):
        return 0.0
    before, after = _truth_beside_jumps(case, quantity)
    most = (np.max(errors[near], initial=0.0) for near in beside)
    return max(0.0, *(float(worst - size) for worst, size in zip(most, _magnitudes(after - before), strict=True)))


def _truth_beside_jumps(case: Case, quantity: Quantity) -> tuple[Array, Array]:
    """The truth just before and after every jump, (jumps,) or (jumps, 2) each, SI; there must be a jump.

    At the start the crank is at rest before.
    """
    jumps = np.asarray(case.motion.jumps)
    before, after = (quantity.reference(case.apart, time) for time in (np.nextafter(jumps, 0.0), jumps))
    if jumps[0] == 0.0:
        before = np.concatenate([quantity.reference(case.at_rest, jumps[:1]), before[1:]])
    return before, after


def _magnitudes(values: Array) -> Array:
    """Magnitude of every sample, (n,): of a number, or of a vector along the last axis."""
    return np.abs(values) if values.ndim == 1 else np.asarray(np.hypot(*values.T))


def _sample_times(quantity: Quantity, motion: ObservedMotion) -> Array:
    """Times, s, of the engine's samples of a quantity, those left out included; of forces the first joint's."""
    if quantity.clock is Channel.JOINT_FORCE:
        return next(iter(motion.history.joint_force.values())).time
    return motion.signal(quantity.clock).time
