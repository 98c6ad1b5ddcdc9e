"""Slips of an adapter that reads its engine: each is planted in a history, and explains the error of a signal.

An entry makes of a right signal what a slip of an adapter makes of it. It is planted in what an engine did; where a
signal of an engine is wrong, it is planted in the closed form, and explains the signal if it makes the same of that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, DriverKind
from comparisons.judging.signal_errors import ANGLE, LEVELS, PLACE, Reading, readings
from engines.contract import History
from engines.mechanics.states import point_acceleration, point_velocity
from engines.scene import Channel, Scene

Array = NDArray[np.float64]

VECTORS: Final = (*LEVELS, Channel.JOINT_FORCE)
EXPLAINED: Final = 0.1  # of an error: what a cause may leave of it
ENDS: Final = 4  # samples at either end by which nothing is explained: shifted in time they have no values
STEP: Final = 0.1  # of a factor or a sample, to either side, for the slope of a fit
ROUNDS: Final = 4  # of Gauss and Newton
FACTOR_ERROR: Final = 1e-3  # relative: what a known factor may be off
FACTORS: Final = {
    -1.0: "it has the wrong sign",
    1e3: "it is in mm",
    1e-3: "it is a thousandth: m taken for mm",
    360.0 / FULL_TURN: "it is in degrees",
    FULL_TURN / 360.0: "it is turned from degrees to rad twice",
}


@dataclass(frozen=True)
class Misreading:
    """A slip: ``values(reading, choice)`` (n, k) are what it makes of a signal, ``words(choice)`` its sentence.

    Of its ``channels`` it concerns those signals that have ``choices``: names of joints or bodies, or a single text.
    Where a slip goes by any number, these are the ``numbers`` to plant, and a fit begins at ``start``.
    """

    words: Callable[[Any], str]
    values: Callable[[Reading, Any], Array]
    channels: tuple[Channel, ...] = tuple(Channel)
    choices: Callable[[Reading], Iterable[Any]] = lambda _: ("",)
    numbers: tuple[float, ...] = ()
    start: float = 0.0

    def causes(self, right: Reading, wrong: Array) -> Iterator[tuple[float, str]]:
        """Residual of values (n, k) with each choice, or with the best number; and its sentence."""
        if right.channel in self.channels:
            for choice in (self._fitted(right, wrong),) if self.numbers else self.choices(right):
                yield largest_magnitude(wrong - self.values(right, choice)), self.words(choice)

    def _fitted(self, right: Reading, wrong: Array) -> float:
        """The number with which the slip comes nearest to wrong values, by least squares."""
        number = self.start
        for _ in range(ROUNDS):
            high, low = (self.values(right, number + step) for step in (STEP, -STEP))
            slope, left = _without_ends((high - low) / (2.0 * STEP)), _without_ends(wrong - self.values(right, number))
            number += float(np.vdot(left, slope) / (np.vdot(slope, slope) or 1.0))
        return number


def likeliest_misreading(right: Reading, wrong: Array) -> str:
    """The slip that leaves least of the error of values (n, k), in words; empty where none explains it."""
    left, words = min(cause for misreading in MISREADINGS for cause in misreading.causes(right, wrong))
    return words if left <= EXPLAINED * largest_magnitude(wrong - right.values) else ""


def largest_magnitude(values: Array) -> float:
    """The largest magnitude in values (n, k), the ends left out."""
    return float(np.abs(_without_ends(values)).max())


def _without_ends(values: Array) -> Array:
    """Values (n, k) without the samples at either end, of few samples one at least."""
    ends = min(ENDS, (len(values) - 1) // 2)
    return values[ends : len(values) - ends]


def plant_misreading(
    history: History, scene: Scene, channel: Channel, misreading: Misreading, number: float | None
) -> History:
    """A history with a channel misread, of joint forces the largest; itself where that concerns nothing in it."""
    concerned = [reading for reading in readings(scene, history) if reading.channel is channel]
    if channel is Channel.JOINT_FORCE:
        concerned = [max(concerned, key=lambda reading: largest_magnitude(reading.values))]
    for reading in concerned:
        choice = next(iter(misreading.choices(reading)), None) if number is None else number
        if choice is None:
            continue
        values = misreading.values(reading, choice)
        before = getattr(history, channel.value)
        if channel in LEVELS:
            whole = before.values.copy()
            whole[:, reading.body_number(reading.name), reading.columns] = values
            changed: Any = replace(before, values=whole)
        elif channel is Channel.TORQUE:
            changed = replace(before, values=values[:, 0])
        else:
            force = before[reading.name]
            changed = {**before, reading.name: replace(force, values=values.reshape(force.values.shape))}
        history = replace(history, **{channel.value: changed})
    return history


def _factor_words(factor: float) -> str:
    known = (words for value, words in FACTORS.items() if abs(factor - value) <= FACTOR_ERROR * abs(value))
    return next(known, f"it is {factor:.5g} times as large")


def _shift_words(samples: float) -> str:
    return (
        f"its values are those of {abs(samples):.2g} of a sample {'after' if samples > 0.0 else 'before'} their times"
    )


def _choices_of(columns: slice, *choices: Any) -> Callable[[Reading], Iterable[Any]]:  # noqa: ANN401
    """The choices of a slip that concerns signals with these columns alone: places and forces, or angles."""
    return lambda reading: (choices or ("",)) if reading.columns == columns else ()


def _frame_bodies(reading: Reading) -> list[str]:
    """The bodies in whose frame a vector may be read by mistake; [] for an angle or a number."""
    ends = {pin.name: (pin.first, pin.second) for pin in reading.scene.pins}
    ends |= {joint.name: (joint.body, joint.host) for joint in reading.scene.guided}
    bodies = ends[reading.name] if reading.channel is Channel.JOINT_FORCE else (reading.name,)
    return [end for end in bodies if end != GROUND] if reading.columns == PLACE else []


def _in_body_frame(reading: Reading, body: str) -> Array:
    """A vector (n, 2) in the frame of a body."""
    angle = reading.channel_values(Channel.POSITION, body, reading.time)[:, 2]
    c, s, (x, y) = np.cos(angle), np.sin(angle), reading.values.T
    return np.column_stack([c * x + s * y, c * y - s * x])


def _other_joints(reading: Reading) -> list[str]:
    return [name for name in reading.history.joint_force if name != reading.name]


def _anchors(reading: Reading) -> dict[str, tuple[float, float]]:
    """The points of a body that are in joints, by the joint, in the body's frame."""
    sides = [(pin.name, pin.first, pin.first_anchor) for pin in reading.scene.pins]
    sides += [(pin.name, pin.second, pin.second_anchor) for pin in reading.scene.pins]
    sides += [(joint.name, joint.body, joint.anchor) for joint in reading.scene.guided]
    return {name: at for name, body, at in sides if body == reading.name} if reading.columns == PLACE else {}


def _at_joint_point(reading: Reading, joint: str) -> Array:
    """Place (n, 2), m, of a body's point in a joint, or its velocity or acceleration, as the reading's channel is."""
    order = LEVELS.index(reading.channel)
    position, *rates = (reading.channel_values(level, reading.name, reading.time) for level in LEVELS[: order + 1])
    c, s, (x, y) = np.cos(position[:, 2]), np.sin(position[:, 2]), _anchors(reading)[joint]
    arm = np.column_stack([c * x - s * y, s * x + c * y])
    moved = (
        lambda: position[:, :2] + arm,
        lambda: point_velocity(arm, *rates),
        lambda: point_acceleration(arm, *rates),
    )
    return np.asarray(moved[order](), dtype=float)


def _without_crank(reading: Reading, _: str) -> Array:
    """The drive torque (n, 1), N m or N, without the share that accelerates and lifts the driven link itself."""
    scene = reading.scene
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    velocity, second = (reading.channel_values(level, crank.name, reading.time) for level in LEVELS[1:])
    force = crank.mass * (second[:, :2] - scene.gravity)
    if scene.driver_kind is DriverKind.SLIDER:
        taken = force @ np.array(scene.driven_slider.along)
    else:
        speed = np.where(velocity[:, 2] == 0.0, 1.0, velocity[:, 2])
        taken = np.einsum("nk,nk->n", force, velocity[:, :2]) / speed + (crank.inertia or 0.0) * second[:, 2]
    return np.asarray(reading.values - taken[:, None])


MISREADINGS: Final = (
    Misreading(_factor_words, lambda r, k: k * r.values, numbers=(-1.0, 1.002), start=1.0),
    Misreading(_shift_words, lambda r, samples: r.values_at(r.time + samples * np.gradient(r.time)), numbers=(-0.5,)),
    Misreading(lambda _: "it counts clockwise", lambda r, _: -r.values, LEVELS, _choices_of(ANGLE)),
    Misreading(
        lambda _: "it counts from the start", lambda r, _: r.values - r.values[0], LEVELS[:1], _choices_of(ANGLE)
    ),
    Misreading(
        lambda _: "it is not unwrapped",
        lambda r, low: (r.values - low) % FULL_TURN + low,
        LEVELS[:1],
        _choices_of(ANGLE, -np.pi, 0.0),
    ),
    Misreading(lambda _: "x and y are exchanged", lambda r, _: r.values[:, ::-1], VECTORS, _choices_of(PLACE)),
    Misreading(
        lambda axis: f"{axis} is mirrored",
        lambda r, axis: r.values * ((-1.0, 1.0) if axis == "x" else (1.0, -1.0)),
        VECTORS,
        _choices_of(PLACE, "x", "y"),
    ),
    Misreading(
        lambda body: f"it is in the frame of body '{body}', not the ground's", _in_body_frame, VECTORS, _frame_bodies
    ),
    Misreading(
        lambda joint: f"it is the force of joint '{joint}'",
        lambda r, joint: r.channel_values(Channel.JOINT_FORCE, joint, r.time),
        (Channel.JOINT_FORCE,),
        _other_joints,
    ),
    Misreading(
        lambda _: "gravity is subtracted, as an accelerometer does",
        lambda r, _: r.values - r.scene.gravity,
        (Channel.ACCELERATION,),
        _choices_of(PLACE),
    ),
    Misreading(
        lambda joint: f"it is that of the point in joint '{joint}', not of the mass centre",
        _at_joint_point,
        LEVELS,
        _anchors,
    ),
    Misreading(
        lambda _: "the crank's own inertia and weight are left out of it",
        _without_crank,
        (Channel.TORQUE,),
        lambda r: [""] if r.scene.driver_kind is not DriverKind.CYLINDER else [],
    ),
)
