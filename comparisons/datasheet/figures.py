"""The figures a designer chooses motor, bearings and lengths by, from the curves of a case; SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from analytic.signals import MAGNITUDE, signal
from comparisons.datasheet.curves import Curves, Measure

TRANSMISSION = "transmission_angle:"
SAME_SPEED = 1e-9  # share of the largest speed within which an instant counts as one of the largest speed
NEGLIGIBLE = 1e-12  # share of the largest torque or power below which a figure is zero but for rounding
FEWEST = 4  # instants of the grid at that speed that make it more than a moment
BRAKING = "peak braking power"
DRIVE: Mapping[str, Measure] = {
    "peak torque": lambda at: np.abs(at.torque),
    "peak power": lambda at: at.torque * at.speed,
    BRAKING: lambda at: -at.torque * at.speed,
}


class DrivePoint(NamedTuple):
    """A point of the drive's torque over its speed, N m, rad/s and W, and its instant, s; none of a mean."""

    what: str
    torque: float
    speed: float
    power: float
    time: float | None


class ForcePeak(NamedTuple):
    """Largest force, N, of a joint on a link or of the linkage on its ground; direction, rad; instant, s."""

    joint: str
    link: str
    force: float
    direction: float
    time: float


class Extreme(NamedTuple):
    """A named value, SI, and its instant, s."""

    what: str
    signal: str
    value: float
    time: float


def drive_points(curves: Curves) -> list[DrivePoint]:
    """What chooses a motor: peaks of torque, power and speed, and the mean load; nothing where nothing has mass."""
    if not curves.has("Mkr"):
        return []
    places = curves.places(DRIVE)
    if not curves.instants.is_steady:
        places["peak speed"] = _fastest(curves)
    points = [_drive_point(curves, what, time) for what, time in places.items()]
    least = NEGLIGIBLE * max(abs(point.power) for point in points)
    points = [point for point in points if point.what != BRAKING or point.power < -least]
    square, speed, power = curves.means(
        lambda at: np.square(at.torque), lambda at: np.abs(at.speed), lambda at: at.torque * at.speed
    )
    return [*points, DrivePoint("RMS torque, means", math.sqrt(square), speed, power, None)]


def _drive_point(curves: Curves, what: str, time: float) -> DrivePoint:
    torque, speed, power = curves.values(("Mkr", "omega", "Peq"), time)
    return DrivePoint(what, torque, speed, power, time)


def _fastest(curves: Curves) -> float:
    """Where the crank is fastest; where it keeps that speed for a while, where its torque is largest meanwhile."""
    place = curves.places({"speed": lambda at: np.abs(at.speed)})["speed"]
    fastest = abs(curves.values(("omega",), place)[0]) * (1.0 - SAME_SPEED)
    if np.count_nonzero(np.abs(curves.on_grid.speed) >= fastest) < FEWEST:
        return place
    torque = curves.places({"torque": lambda at: np.where(np.abs(at.speed) >= fastest, np.abs(at.torque), -1.0)})
    return torque["torque"]


def force_peaks(curves: Curves) -> list[ForcePeak]:
    """Largest force of every joint, and of the linkage on its frame."""
    joints = {f"joint_force:{joint}": (joint, link) for joint, link in _loaded_links(curves).items()}
    vectors = {**joints, "shaking_force": ("shaking force", "ground")}
    vectors = {vector: words for vector, words in vectors.items() if curves.has(vector + MAGNITUDE)}
    peaks = curves.peaks(vector + MAGNITUDE for vector in vectors)
    truth = curves.at(np.array([peak.time for peak in peaks.values()]))
    found = []
    for row, (vector, (joint, link)) in enumerate(vectors.items()):
        size, time = peaks[vector + MAGNITUDE]
        x, y = (float(curves.of(truth, f"{vector}:{component}")[row]) for component in "xy")
        found.append(ForcePeak(joint, link, size, math.atan2(y + 0.0, x + 0.0), time))
    return found


def _loaded_links(curves: Curves) -> dict[str, str]:
    """Of every joint the link on which its force acts."""
    linkage, sweep = curves.linkage, curves.case.start()
    pins = {joint: link for pin in linkage.pins for joint, link in pin.joints.items()}
    sliders = {slider.name: slider.link for slider in linkage.sliders}
    return {**pins, **sliders, **{slot.name: sweep.carrier(slot.point) for slot in linkage.slots}}


def transmission(curves: Curves) -> list[Extreme]:
    """Of every group of two links its least transmission angle, rad."""
    peaks = curves.peaks(name for name in curves.names if name.startswith(TRANSMISSION))
    return [Extreme(name.removeprefix(TRANSMISSION), name, *peak) for name, peak in peaks.items()]


def output_extremes(curves: Curves) -> list[Extreme]:
    """Ends of the output's travel, its stroke, and its largest speed and acceleration."""
    if not curves.has("S"):
        return []
    places = curves.places({"least S": lambda at: -signal(at, "S"), "largest S": lambda at: signal(at, "S")})
    ends = [Extreme(what, "S", curves.values(("S",), time)[0], time) for what, time in places.items()]
    peaks = curves.peaks(("v", "a"))
    return [*ends, *(Extreme(f"peak {name}", name, *peak) for name, peak in peaks.items())]


def stroke(ends: list[Extreme]) -> float:
    """Distance between the ends of the output's travel, m."""
    travel = [end.value for end in ends if end.signal == "S"]
    return max(travel) - min(travel)
