"""The likeliest cause of a signal that is not the closed form's: which known slip of an adapter would give it?"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, DriverKind
from comparisons.reference.case import Case
from comparisons.reference.channels import truth
from engines.contract import Signal
from engines.scene import Channel, Scene

Array = NDArray[np.float64]

EXPLAINED = 0.1  # of an error: what a cause may leave of it
ENDS = 4  # samples at either end that a shift in time is not judged by
FACTORS: Final = (
    (-1.0, "it has the wrong sign, as of a turn that is counted clockwise or a force on the other body"),
    (1e3, "it is in mm"),
    (1e-3, "it is a thousandth: m taken for mm"),
    (360.0 / FULL_TURN, "it is in degrees"),
    (FULL_TURN / 360.0, "it is turned from degrees to rad twice"),
    (0.5, "it is half of it"),
    (2.0, "it is twice it"),
)
EQUAL = 1e-3  # relative: what a factor may be off
Candidate = tuple[str, Array]


@dataclass(frozen=True)
class Part:
    """A signal of one body or joint (``name``) or of the drive; its ``columns`` are what the ``words`` say."""

    words: str
    channel: Channel
    name: str
    signal: Signal
    columns: slice


def likeliest(case: Case, scene: Scene, part: Part, steps: float) -> str:
    """The known slip that leaves least of the error, in words; empty where none explains it.

    ``steps`` are the engine's steps to a sample.
    """
    time = part.signal.time

    def true(at: Array) -> Array:
        values = truth(case, part.channel, part.name, np.clip(at, 0.0, case.motion.duration))
        return values[:, part.columns] if values.ndim > 1 else values[:, None]

    observed, right = part.signal.values, true(time)
    observed = observed[:, part.columns] if observed.ndim > 1 else observed[:, None]
    if observed.shape != right.shape:
        right = np.hypot(*right.T)[:, None]
    bound = EXPLAINED * _size(observed - right)
    found: list[tuple[float, str]] = [
        (_size(observed - values), words) for words, values in _candidates(case, scene, part, right)
    ]
    found += list(_factor(observed, right))
    if observed.shape == true(time).shape:
        found += list(_shift(observed, true, time, steps))
    left, words = min(found, default=(bound + 1.0, ""))
    return words if left <= bound else ""


def _size(values: Array) -> float:
    return float(np.abs(values).max())


def _factor(observed: Array, right: Array) -> Iterator[tuple[float, str]]:
    factor = float(np.vdot(observed, right) / (np.vdot(right, right) or 1.0))
    words = next((words for known, words in FACTORS if abs(factor - known) <= EQUAL * abs(known)), "")
    yield _size(observed - factor * right), words or f"it is {factor:.5g} times as large"


def _shift(observed: Array, true: Callable[[Array], Array], time: Array, steps: float) -> Iterator[tuple[float, str]]:
    """The shift in time that fits best, by Gauss and Newton."""
    inside = slice(ENDS, -ENDS)
    sample = float(np.median(np.diff(time)))
    shift, small = 0.0, 0.1 * sample
    for _ in range(4):
        here = time + shift
        slope = (true(here + small) - true(here - small))[inside] / (2.0 * small)
        shift += float(np.vdot(observed[inside] - true(here)[inside], slope) / (np.vdot(slope, slope) or 1.0))
        shift = float(np.clip(shift, -ENDS * sample, ENDS * sample))
    way = "after" if shift > 0.0 else "before"
    off = abs(shift) / sample
    words = f"its values are those of {off:.2g} of a sample ({off * steps:.2g} steps) {way} their times"
    yield _size(observed[inside] - true(time + shift)[inside]), words


def _candidates(case: Case, scene: Scene, part: Part, right: Array) -> Iterator[Candidate]:
    """What other values each slip would give, (n, columns)."""
    channel, time = part.channel, part.signal.time
    if channel is Channel.TORQUE:
        own = _crank_share(case, scene, time)
        yield "the crank's own inertia and weight are left out of it", right - own[:, None]
        return
    if right.shape[1] == 1:  # an angle and its derivatives, or a magnitude
        if channel is Channel.POSITION:
            yield "it is counted from the start", right - right[0]
            yield "it is not unwrapped", (right + np.pi) % FULL_TURN - np.pi
            yield "it is not unwrapped", right % FULL_TURN
        return
    yield "x and y are exchanged", right[:, ::-1]
    yield "x is mirrored", right * (-1.0, 1.0)
    yield "y is mirrored", right * (1.0, -1.0)
    for body in _bodies(scene, channel, part.name):
        yield f"it is in the frame of body '{body}', not the ground's", _rotated(case, body, time, right)
    if channel is Channel.JOINT_FORCE:
        for name in (name for name in case.joint_names() if name != part.name):
            yield f"it is the force of joint '{name}'", truth(case, channel, name, time)
        return
    if channel is Channel.ACCELERATION:
        yield "gravity is subtracted, as an accelerometer does", right - scene.gravity
    for name, anchor in _anchors(scene, part.name):
        yield (
            f"it is that of the point in joint '{name}', not of the mass centre",
            right + _arm(case, channel, part.name, anchor, time),
        )


def _bodies(scene: Scene, channel: Channel, part: str) -> list[str]:
    if channel is not Channel.JOINT_FORCE:
        return [part]
    ends = [(p.name, p.first, p.second) for p in scene.pins] + [(g.name, g.body, g.host) for g in scene.guided]
    return [end for name, *both in ends for end in both if name == part and end != GROUND]


def _rotated(case: Case, body: str, time: Array, values: Array) -> Array:
    angle = truth(case, Channel.POSITION, body, time)[:, 2]
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * values[:, 0] + s * values[:, 1], c * values[:, 1] - s * values[:, 0]])


def _anchors(scene: Scene, body: str) -> Iterator[tuple[str, Array]]:
    for pin in scene.pins:
        if body in (pin.first, pin.second):
            yield pin.name, np.asarray(pin.first_anchor if body == pin.first else pin.second_anchor)
    for joint in scene.guided:
        if body == joint.body:
            yield joint.name, np.asarray(joint.anchor)


def _arm(case: Case, channel: Channel, body: str, anchor: Array, time: Array) -> Array:
    """From the mass centre to an anchor, or a time derivative of it, (n, 2)."""
    angle = truth(case, Channel.POSITION, body, time)[:, 2]
    c, s = np.cos(angle), np.sin(angle)
    arm = np.column_stack([c * anchor[0] - s * anchor[1], s * anchor[0] + c * anchor[1]])
    if channel is Channel.POSITION:
        return arm
    across = np.column_stack([-arm[:, 1], arm[:, 0]])
    speed = truth(case, Channel.VELOCITY, body, time)[:, 2:]
    if channel is Channel.VELOCITY:
        return np.asarray(speed * across)
    second = truth(case, Channel.ACCELERATION, body, time)[:, 2:]
    return np.asarray(second * across - speed**2 * arm)


def _crank_share(case: Case, scene: Scene, time: Array) -> Array:
    """Torque that the crank alone would take, N m, or a driven slider its force, N; 0 of a cylinder, without mass."""
    if scene.driver_kind is DriverKind.CYLINDER:
        return np.zeros(len(time))
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    velocity, second = (truth(case, c, crank.name, time) for c in (Channel.VELOCITY, Channel.ACCELERATION))
    speed = np.where(velocity[:, 2] == 0.0, 1.0, velocity[:, 2])
    force = crank.mass * (second[:, :2] - scene.gravity)
    if scene.driver_kind is DriverKind.SLIDER:
        return np.asarray(force @ np.array(scene.driven_slider.along))
    power = np.einsum("nk,nk->n", force, velocity[:, :2]) / speed
    return np.asarray(power + (crank.inertia or 0.0) * second[:, 2])
