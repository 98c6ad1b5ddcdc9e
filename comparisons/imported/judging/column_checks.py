"""Checks of the columns among themselves, which need no closed form: derivatives, power, lengths, energy."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.dynamics.reduced import potential_energy
from comparisons.faults.simulation import Simulation
from comparisons.imported.columns import ImportedResults
from comparisons.imported.judging.crank_column import regular
from comparisons.imported.judging.samples import Samples
from comparisons.judging.records import IMPORTED, Record, Verdict
from comparisons.observation.quadrature import error_bound, integral
from engines.contract import Signal

Array = NDArray[np.float64]

LEAST: Final = 1e-3  # of a peak: a check within it is passed, whatever the rounding
ROUNDINGS: Final = 3.0  # times the floor that a check may be off
# Of a signal's last part, that of the signal that it is the time derivative of.
WHOLES: Final = {
    **{"v": "S", "a": "v", "omega": "phi", "epsilon": "omega", "alpha": "omega"},
    **{"vx": "x", "vy": "y", "ax": "vx", "ay": "vy"},
}


@dataclass(frozen=True)
class ColumnCheck:
    """Columns that do or do not agree: ``error`` over the peak, and the ``floor`` of rounding and of differences."""

    name: str
    words: str
    error: float
    floor: float

    @property
    def limit(self) -> float:
        """How far off the columns may be: their rounding, the error of differences, and a thousandth of the peak."""
        return max(LEAST, ROUNDINGS * self.floor)

    def record(self, blank: Record) -> Record:
        """The record of a campaign's tables, among the checks that need no reference."""
        outcome = Verdict.PASSED if self.passed else Verdict.OVER_LIMIT
        return replace(
            blank, quantity=self.name, error_max=self.error, limit=self.limit, outcome=outcome.value, detail=self.words,
            origin=IMPORTED, runs=1,
        )  # fmt: skip

    @property
    def passed(self) -> bool:
        """Whether the columns agree."""
        return self.error <= self.limit


def column_checks(model: Simulation, signals: Sequence[Samples], imported: ImportedResults) -> Iterator[ColumnCheck]:
    """Every check that the columns allow."""
    found = {one.name: one for one in signals}
    for one in imported.signals:  # those that are the crank's motion too
        if one.name not in found and one.axis == "time":
            at, open_ = regular(one.at, one.at_resolution)
            found[one.name] = Samples(one.name, at, one.values, one.resolution, open_, one)
    for name, part in found.items():
        whole = found.get(_whole_of(name))
        if whole and _same_clock(part, whole):
            yield _derivative(model, whole, part)
    power = [found[name] for name in ("Peq", "Mkr", "omega") if name in found]
    if len(power) == 3 and _same_clock(*power):
        yield _power(*power)
    yield from _lengths(model, found)
    if "Peq" in found and "Teq" in found and _same_clock(found["Peq"], found["Teq"]) and _only_gravity(model):
        yield _energy(model, found["Peq"], found["Teq"])


def _whole_of(name: str) -> str:
    """The signal that one is the time derivative of, "" where it is of none."""
    head, colon, last = name.rpartition(":")
    if head.startswith("link") and last == "omega":
        return f"{head}:angle"
    return f"{head}{colon}{WHOLES[last]}" if last in WHOLES else ""


def _same_clock(*signals: Samples) -> bool:
    first = signals[0]
    return all(len(one.time) == len(first.time) and np.array_equal(one.time, first.time) for one in signals) and (
        len(first.time) > 2
    )


def _derivative(model: Simulation, whole: Samples, part: Samples) -> ColumnCheck:
    """The integral of the derivative beside the signal itself: differences would multiply its rounding."""
    time, rate = part.time, Signal(part.time, part.values)
    jumps = model.motion.jumps
    grown = integral(rate, jumps)
    values = np.unwrap(whole.values) if whole.name == "phi" or whole.name.endswith(":angle") else whole.values
    error = np.abs(values - values[0] - grown)
    # An error in the rate drifts; an error at single samples stands against its own peak.
    open_ = error_bound(rate, grown, jumps) + 2.0 * np.max(whole.rounding)
    open_ = open_ + (time - time[0]) * np.max(part.rounding) + np.max(whole.time_rounding) * np.max(np.abs(part.values))
    size = float(np.ptp(values)) or 1.0
    worst = int(np.argmax(error - open_))
    words = f"{part.name} is the time derivative of {whole.name}"
    return ColumnCheck(f"{part.name} = d{whole.name}/dt", words, float(error[worst]) / size, float(open_[worst]) / size)


def _power(power: Samples, torque: Samples, speed: Samples) -> ColumnCheck:
    error = np.abs(power.values - torque.values * speed.values)
    open_ = power.rounding + np.abs(torque.values) * speed.rounding + np.abs(speed.values) * torque.rounding
    size = float(np.max(np.abs(power.values))) or 1.0
    worst = int(np.argmax(error - open_))
    return ColumnCheck(
        "Peq = Mkr omega", "power is torque times speed", float(error[worst]) / size, float(open_[worst]) / size
    )


def _lengths(model: Simulation, found: dict[str, Samples]) -> Iterator[ColumnCheck]:
    """Points of one link keep their distance."""
    linkage = model.linkage
    for name, link in linkage.links.items():
        known = [p for p in link.points if p in linkage.ground or {f"point:{p}:x", f"point:{p}:y"} <= found.keys()]
        for one, other in itertools.combinations(known, 2):
            sides = [_place(model, found, point) for point in (one, other)]
            sizes = {len(x) for x, _, _ in sides if len(x) > 1}
            length = math.dist(link.points[one], link.points[other])
            if len(sizes) != 1 or not length:
                continue
            (ax, ay, aopen), (bx, by, bopen) = sides
            error = np.abs(np.hypot(bx - ax, by - ay) - length)
            worst = int(np.argmax(error))
            words = f"'{one}' and '{other}' of '{name}' keep their distance of {linkage.written(length)}"
            open_ = 1.5 * (aopen + bopen) / length
            yield ColumnCheck(f"length of {name} from {one} to {other}", words, float(error[worst]) / length, open_)


def _place(model: Simulation, found: dict[str, Samples], point: str) -> tuple[Array, Array, float]:
    if point in model.linkage.ground:
        x, y = model.linkage.ground[point]
        return np.array([x]), np.array([y]), 0.0
    x_column, y_column = (found[f"point:{point}:{axis}"] for axis in "xy")
    open_ = float(np.max(x_column.rounding) + np.max(y_column.rounding))
    return x_column.values, y_column.values, open_


def _only_gravity(model: Simulation) -> bool:
    linkage = model.linkage
    return not (linkage.forces or linkage.torques or linkage.springs or linkage.dampers)


def _energy(model: Simulation, power: Samples, kinetic: Samples) -> ColumnCheck:
    """Work of the drive beside kinetic energy and, of the linkage's weights, potential energy."""
    time, jumps = power.time, model.motion.jumps
    work = integral(Signal(time, power.values), jumps)
    height = potential_energy(model.mechanism.sweep(model.motion.angle(time))) if any(model.linkage.gravity) else 0.0
    stored = kinetic.values + height
    error = np.abs(stored - stored[0] - work)
    open_ = error_bound(Signal(time, power.values), work, jumps) + 2.0 * np.max(kinetic.rounding)
    open_ = open_ + (time - time[0]) * np.max(power.rounding)
    size = float(np.max(np.abs(kinetic.values))) + float(np.ptp(stored)) or 1.0
    worst = int(np.argmax(error - open_))
    words = "the drive's work is what kinetic and potential energy gain"
    return ColumnCheck("energy", words, float(error[worst]) / size, float(open_[worst]) / size)
