"""Slips of an adapter that reads its engine: what each makes of a right signal, and which one explains a wrong one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, DriverKind
from analytic.numerics.arrays import Array
from comparisons.trials.judging.signal_errors import ANGLE, LEVELS, PLACE, Reading
from engines.mechanics.states import point_acceleration, point_velocity
from engines.scene import Channel

EXPLAINED: Final = 0.1  # of an error: what a cause may leave of it
ENDS: Final = 4  # samples at either end by which nothing is explained: shifted in time they have no values
FACTOR_ERROR: Final = 1e-3  # relative: what a known factor may be off
FACTORS: Final = {
    -1.0: "it has the wrong sign",
    1e3: "it is in mm",
    1e-3: "it is a thousandth: m taken for mm",
    360.0 / FULL_TURN: "it is in degrees",
    FULL_TURN / 360.0: "it is turned from degrees to rad twice",
}
SHIFTS: Final = (-1.0, -0.5, 0.5, 1.0)  # samples


def likeliest_misreading(right: Reading, wrong: Array) -> str:
    """The slip that leaves the least error of ``wrong`` values (n, k), in words.

    "" where none leaves a tenth or less.
    """
    left, words = min((_largest(wrong - values), words) for words, values in misread(right, wrong))
    return words if left <= EXPLAINED * _largest(wrong - right.values) else ""


def _largest(values: Array) -> float:
    """The largest magnitude of values (n, k), both ends left out unless that leaves fewer than one sample."""
    ends = min(ENDS, (len(values) - 1) // 2)
    return float(np.abs(values[ends : len(values) - ends]).max())


def misread(right: Reading, wrong: Array) -> Iterator[tuple[str, Array]]:
    """Yield every slip that may befall a signal, in words, with the values (n, k) that it makes of it.

    Of all factors it is the one that comes nearest to the ``wrong`` values.
    """
    values, channel, time = right.values, right.channel, right.time
    factor = float(np.vdot(values, wrong) / (np.vdot(values, values) or 1.0))
    yield _factor_words(factor), factor * values
    for samples in SHIFTS:
        when = "after" if samples > 0.0 else "before"
        words = f"its values are those of {abs(samples):.2g} of a sample {when} their times"
        yield words, right.values_at(time + samples * np.gradient(time))
    if channel in LEVELS and right.columns == ANGLE:
        yield from _misread_angle(right)
    if right.columns == PLACE:
        yield from _misread_vector(right)
    if channel is Channel.JOINT_FORCE:
        for joint in right.history.joint_force.keys() - {right.name}:
            yield f"it is the force of joint '{joint}'", right.channel_values(channel, joint, time)[:, right.columns]
    if channel is Channel.TORQUE and right.scene.driver_kind is not DriverKind.CYLINDER:
        yield "the crank's own inertia and weight are left out of it", _without_crank(right)


def _misread_angle(right: Reading) -> Iterator[tuple[str, Array]]:
    """Yield slips that may befall an angle or its rates, each in words with the values (n, 1) it makes."""
    values = right.values
    yield "it counts clockwise", -values
    if right.channel is Channel.POSITION:
        yield "it counts from the start", values - values[0]
        for low in (-np.pi, 0.0):
            yield "it is not unwrapped", (values - low) % FULL_TURN + low


def _misread_vector(right: Reading) -> Iterator[tuple[str, Array]]:
    """Yield slips that may befall a plane vector, each in words with the values (n, 2) it makes."""
    values = right.values
    yield "x and y are exchanged", values[:, ::-1]
    for axis, signs in (("x", (-1.0, 1.0)), ("y", (1.0, -1.0))):
        yield f"{axis} is mirrored", values * signs
    for body in _bodies(right):
        yield f"it is in the frame of body '{body}', not the ground's", _in_body_frame(right, body)
    if right.channel is Channel.ACCELERATION:
        yield "gravity is subtracted, as an accelerometer does", values - right.scene.gravity
    for joint, anchor in _anchors(right).items():
        words = f"it is that of the point in joint '{joint}', not of the mass centre"
        yield words, _at_anchor(right, anchor)


def _factor_words(factor: float) -> str:
    """A factor in words: the slip that it is known for, else its value."""
    known = (words for value, words in FACTORS.items() if abs(factor - value) <= FACTOR_ERROR * abs(value))
    return next(known, f"it is {factor:.5g} times as large")


def _bodies(reading: Reading) -> list[str]:
    """Names of the bodies in whose frame a vector may be read by mistake: those of a joint, or its own; no ground."""
    ends = {pin.name: (pin.first, pin.second) for pin in reading.scene.pins}
    ends |= {joint.name: (joint.body, joint.host) for joint in reading.scene.guided}
    bodies = ends[reading.name] if reading.channel is Channel.JOINT_FORCE else (reading.name,)
    return [end for end in bodies if end != GROUND]


def _in_body_frame(reading: Reading, body: str) -> Array:
    """A vector (n, 2) in the frame of a body."""
    angle = reading.channel_values(Channel.POSITION, body, reading.time)[:, 2]
    c, s, (x, y) = np.cos(angle), np.sin(angle), reading.values.T
    return np.column_stack([c * x + s * y, c * y - s * x])


def _anchors(reading: Reading) -> dict[str, tuple[float, float]]:
    """Places of a body's joints in its frame, m, by joint; {} for a force."""
    sides = [(pin.name, pin.first, pin.first_anchor) for pin in reading.scene.pins]
    sides += [(pin.name, pin.second, pin.second_anchor) for pin in reading.scene.pins]
    sides += [(joint.name, joint.body, joint.anchor) for joint in reading.scene.guided]
    return {name: at for name, body, at in sides if body == reading.name}


def _at_anchor(reading: Reading, anchor: tuple[float, float]) -> Array:
    """Place (n, 2), m, of a body's point, or its velocity or acceleration, as the reading's channel is."""
    order = LEVELS.index(reading.channel)
    position, *rates = (reading.channel_values(level, reading.name, reading.time) for level in LEVELS[: order + 1])
    c, s, (x, y) = np.cos(position[:, 2]), np.sin(position[:, 2]), anchor
    arm = np.column_stack([c * x - s * y, s * x + c * y])
    if order == 0:
        return position[:, :2] + arm
    return np.asarray((point_velocity, point_acceleration)[order - 1](arm, *rates), dtype=float)


def _without_crank(reading: Reading) -> Array:
    """The drive torque (n, 1), N m or N, less the part that accelerates and lifts the driven link itself."""
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
