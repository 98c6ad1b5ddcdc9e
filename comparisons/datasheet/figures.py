"""The figures a designer chooses motor, bearings and lengths by, a row for each number, from curves of a case; SI."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.signals import MAGNITUDE, signal
from comparisons.datasheet.curves import Curves, Measure

Array = NDArray[np.float64]

TRANSMISSION: Final = "transmission_angle:"
DIRECTION: Final = ":direction"  # of a force in place of its magnitude
SHAKING: Final = "shaking force"
SAME_SPEED: Final = 1e-9  # share of the largest speed within which an instant counts as one of the largest speed
NEGLIGIBLE: Final = 1e-12  # share of the largest value of a kind below which a value is zero but for rounding
NEGLIGIBLE_MEAN: Final = 1e-9  # of its signal's peak: the integral of a mean is this near to the truth
FEWEST: Final = 4  # instants of the grid at that speed that make it more than a moment
BRAKING: Final = "peak braking power"
MEAN: Final = "signed mean"
DRIVE: Final[Mapping[str, Measure]] = {
    "peak torque": lambda at: np.abs(at.torque),
    "peak power": lambda at: at.torque * at.speed,
    BRAKING: lambda at: -at.torque * at.speed,
}
TABLES: Final = ("drive", "forces", "moment", "transmission", "output")
LOAD: Final = ("Mkr", "omega", "Peq")  # of the drive, side by side


@dataclass(frozen=True)
class KeyFigure:
    """A number of a designer: ``what`` it is, of a force the link it acts ``on``, its signal, value and SI unit.

    ``time``, s, and ``phi``, rad, of a drive along a line m, say where; None of a mean. A value that is not finite, as
    a joint's force at a change point, is None. ``joint_force:A:direction``, rad, is no signal of the closed form.
    """

    what: str
    signal: str
    value: float | None
    unit: str
    on: str = ""
    time: float | None = None
    phi: float | None = None


def finite(value: float) -> float | None:
    """A number, or nothing."""
    return value if math.isfinite(value) else None


def plain(values: Array) -> list[float | None]:
    """Numbers as a list, nothing in place of what is not finite."""
    return [finite(value) for value in values.tolist()]


@dataclass(frozen=True)
class KeyFigures:
    """The key figures of ``curves``."""

    curves: Curves

    def row(self, what: str, name: str, value: float, time: float | None = None, on: str = "") -> KeyFigure:
        """One of them."""
        phi = None if time is None else float(self.curves.case.motion.angle(np.array([time]))[0])
        unit = "rad" if name.endswith(DIRECTION) else self.curves.unit(name)
        return KeyFigure(what, name, finite(value), unit, on, time, phi)

    @cached_property
    def peaks(self) -> dict[str, KeyFigure]:
        """Of every signal the value of the largest magnitude; of a transmission angle the least."""
        found = self.curves.peaks(self.curves.names)
        return {name: self.row("peak", name, peak.value, peak.time) for name, peak in found.items()}

    def tables(self) -> dict[str, tuple[KeyFigure, ...]]:
        """All others, table by table."""
        moment = self._peaks({"shaking_moment": f"about {self.curves.moment_centre}"})
        tables = (self.drive(), self.forces(), moment, self.transmission(), self.output())
        return {name: tuple(rows) for name, rows in zip(TABLES, tables, strict=True)}

    def _peaks(self, signals: Mapping[str, str]) -> Iterator[KeyFigure]:
        """Peaks of signals, each by what it is."""
        return (replace(self.peaks[name], what=what) for name, what in signals.items() if self.curves.has(name))

    def drive(self) -> Iterator[KeyFigure]:
        """What chooses a motor: peaks of torque, power and speed, RMS and means; nothing where nothing has mass.

        Beside each peak stand the others at its instant. The RMS has no sign, the means have theirs.
        """
        curves = self.curves
        if not curves.has("Mkr"):
            return
        force = "force" if curves.linkage.is_linear else "torque"
        places = curves.places(DRIVE)
        if not curves.instants.is_steady:
            places["peak speed"] = _fastest(curves)
        points = {what: curves.values(LOAD, time) for what, time in places.items()}
        least = NEGLIGIBLE * max(abs(power) for *_, power in points.values())
        for what, point in points.items():
            if what != BRAKING or point[-1] < -least:
                yield from self._load(what.replace("torque", force), point, places[what])
        square, *means = curves.means(
            lambda at: np.square(at.torque),
            lambda at: at.torque,
            lambda at: at.speed,
            lambda at: at.torque * at.speed,
        )
        yield self.row(f"RMS {force}", "Mkr", math.sqrt(square))
        sizes = [NEGLIGIBLE_MEAN * abs(self.peaks[name].value or 0.0) for name in LOAD]
        yield from self._load(MEAN, [m if abs(m) > size else 0.0 for m, size in zip(means, sizes, strict=True)])

    def _load(self, what: str, values: Iterable[float], time: float | None = None) -> Iterator[KeyFigure]:
        return (self.row(what, name, value, time) for name, value in zip(LOAD, values, strict=True))

    def forces(self) -> Iterator[KeyFigure]:
        """Largest force of every joint, and of the linkage on its frame, each with its direction."""
        joints = {f"joint_force:{joint}": (joint, link) for joint, link in _loaded_links(self.curves).items()}
        every = {**joints, "shaking_force": (SHAKING, "ground")}
        vectors = {vector: words for vector, words in every.items() if self.curves.has(vector + MAGNITUDE)}
        peaks = [self.peaks[vector + MAGNITUDE] for vector in vectors]
        truth = self.curves.at(np.array([peak.time for peak in peaks]))
        for row, (vector, (what, link)) in enumerate(vectors.items()):
            yield replace(peaks[row], what=what, on=link)
            x, y = (float(self.curves.of(truth, f"{vector}:{component}")[row]) for component in "xy")
            yield self.row(what, vector + DIRECTION, math.atan2(y + 0.0, x + 0.0), peaks[row].time, link)

    def transmission(self) -> Iterator[KeyFigure]:
        """Of every group of two links its least transmission angle, rad."""
        groups = {n: n.removeprefix(TRANSMISSION) for n in self.curves.names if n.startswith(TRANSMISSION)}
        return self._peaks(groups)

    def output(self) -> Iterator[KeyFigure]:
        """The output's stroke, the ends of its travel, and its largest speed and acceleration."""
        if not self.curves.has("S"):
            return
        places = self.curves.places({"least S": lambda at: -signal(at, "S"), "largest S": lambda at: signal(at, "S")})
        ends = {what: self.curves.values(("S",), time)[0] for what, time in places.items()}
        yield self.row("stroke", "S", ends["largest S"] - ends["least S"])
        yield from (self.row(what, "S", value, places[what]) for what, value in ends.items())
        yield from self._peaks({"v": "peak v", "a": "peak a"})


def _fastest(curves: Curves) -> float:
    """Where the crank is fastest; where it keeps that speed for a while, where its torque is largest meanwhile."""
    place = curves.places({"speed": lambda at: np.abs(at.speed)})["speed"]
    fastest = abs(curves.values(("omega",), place)[0]) * (1.0 - SAME_SPEED)
    if np.count_nonzero(np.abs(curves.on_grid.speed) >= fastest) < FEWEST:
        return place
    torque = curves.places({"torque": lambda at: np.where(np.abs(at.speed) >= fastest, np.abs(at.torque), -1.0)})
    return torque["torque"]


def _loaded_links(curves: Curves) -> dict[str, str]:
    """Of every joint the link on which its force acts."""
    linkage, sweep = curves.linkage, curves.case.start()
    pins = {joint: link for pin in linkage.pins for joint, link in pin.joints.items()}
    sliders = {slider.name: slider.link for slider in linkage.sliders}
    return {**pins, **sliders, **{slot.name: sweep.carrier(slot.point) for slot in linkage.slots}}
