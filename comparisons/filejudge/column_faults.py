"""Faults of columns of a file: sign, unit, zero, clock, single samples, another quantity."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.written import signed
from comparisons.filejudge.fault import (
    Correction,
    Fault,
    FaultKind,
    Predict,
    SignalTimes,
    Simulation,
    has_free_zero,
    holds_acceleration,
    is_rotary,
)
from comparisons.trials.judging.quantities import near_jumps

Array = NDArray[np.float64]

RADIAN: Final = math.pi / 180.0
# What one unit is of another that is printed in its place, either way round.
UNIT_RATIOS: Final = {
    "10": 10.0,
    "100": 100.0,
    "1000": 1e3,
    "1e6": 1e6,
    "degrees and radians": 1.0 / RADIAN,
    "rpm and rad/s": 30.0 / math.pi,
    "rpm and deg/s": 6.0,
    "turns and radians": 2.0 * math.pi,
    "turns and degrees": 360.0,
    "1/s and rpm": 60.0,
    "g and m/s², or kgf and N": 9.80665,
    "in and mm": 25.4,
    "in and m": 1.0 / 0.0254,
    "lb and kg": 1.0 / 0.45359237,
    "lbf and N": 4.4482216152605,
    "lbf·in and N·m": 1.0 / 0.1129848290276167,
    "lbf·ft and N·m": 1.3558179483314,
    "hp and W": 745.69987158227,
}
MOST_RATIO_ERROR: Final = 0.2  # of a unit's ratio, by which the file's may differ where it has other faults
FEW_SAMPLES: Final = 0.03  # of the samples: single ones
ALIKE: Final = 0.05  # of the peak, within which a column is another quantity
NEGLIGIBLE: Final = 1e-5  # of a signal's scale: what every solver's numerics may do, and no fault of a model
SAME_INSTANT: Final = 1e-6  # of a step: the same instant
MOST_TIMES: Final = 4  # of single samples that are named


@dataclass(frozen=True)
class Evidence(SignalTimes):
    """A column of a file beside the closed form: ``values`` and ``truth`` (n,) at its times.

    The file leaves ``rounding`` (n,) open. A cause need not explain samples that are not ``counted``; ``over`` are
    those that are off even so. ``scale`` is the size over which errors are stated; words are in ``unit``.
    """

    values: Array
    truth: Array
    rounding: Array
    counted: NDArray[np.bool_]
    over: NDArray[np.bool_]
    scale: float
    unit: str
    unit_value: float = 1.0

    def thinned(self, most: int) -> Evidence:
        """The evidence at ``most`` samples or fewer, equally spread."""
        every = -(-len(self.time) // most)
        parts: dict[str, Any] = {k: v[::every] for k, v in vars(self).items() if isinstance(v, np.ndarray)}
        return replace(self, **parts)

    @property
    def tolerance(self) -> Array:
        """The difference that a cause need not explain, (n,)."""
        return np.asarray(self.rounding + NEGLIGIBLE * self.scale)

    @property
    def residual(self) -> Array:
        """Value less truth over the tolerance, (n,), nan where nothing is compared."""
        return np.where(self.counted, (self.values - self.truth) / self.tolerance, np.nan)


def column_faults(evidence: Evidence, simulation: Simulation, names: Sequence[str]) -> Iterator[Fault]:
    """Every fault that lies in one column; ``names`` are the signals that it may be taken for."""
    name = evidence.name
    yield scale_fault(f"sign:{name}", (name,), -1.0, f"{name} has the other sign")
    yield from _unit_faults(evidence)
    yield _factor_fault(name)
    yield from _zero_faults(evidence)
    yield _delay_fault(evidence)
    yield from _single_sample_faults(evidence)
    yield from _mistaken_quantity_faults(evidence, simulation, names)


def column_fault(
    name: str,
    kind: FaultKind,
    columns: Collection[str],
    alter: Callable[[Array, Array, Array], Array],
    words: Callable[[Array], str],
    *numbers: Any,  # noqa: ANN401 - fields of Fault, from start on
    **rest: Any,  # noqa: ANN401
) -> Fault:
    """A fault of some columns: it makes ``alter(time, values, numbers)`` of their curves."""

    def apply(simulation: Simulation, p: Array) -> Simulation:
        def change(predict: Predict, signal_name: str, time: Array) -> Array:
            values = predict(signal_name, time)
            return alter(time, values, p) if signal_name in columns else values

        return simulation.with_change(change)

    return Fault(name, kind, apply, words, *numbers, **rest)


def scale_fault(name: str, columns: Sequence[str], factor: float, words: str) -> Fault:
    """A fault of some columns: a factor that a sign or a unit explains."""
    correction = Correction(-1 if factor < 0.0 else 1, 1.0 / abs(factor))
    return column_fault(name, FaultKind.COLUMN, frozenset(columns), lambda _, y, __: factor * y, lambda _: words,
                        cure=lambda _: dict.fromkeys(columns, correction))  # fmt: skip


def _unit_faults(evidence: Evidence) -> Iterator[Fault]:
    """Units taken for others, whose ratio is near the file's factor."""
    name, truth = evidence.name, evidence.truth[evidence.counted]
    size = float(truth @ truth)
    share = float(evidence.values[evidence.counted] @ truth) / size if size else 0.0
    for unit, ratio in UNIT_RATIOS.items():
        for factor in (ratio, 1.0 / ratio, -ratio, -1.0 / ratio):
            if abs(share / factor - 1.0) < MOST_RATIO_ERROR:
                sense = "" if factor > 0.0 else " and has the other sign"
                words = f"{name} is {abs(factor):.6g} times the closed form's{sense}: a unit taken for another ({unit})"
                yield scale_fault(f"unit:{name}", (name,), factor, words)


def _factor_fault(name: str) -> Fault:
    """A column times a factor that no unit explains."""
    return column_fault(f"factor:{name}", FaultKind.FREE, (name,), lambda _, y, k: k[0] * y,
                        lambda k: f"{name} is {k[0]:.5g} times the closed form's", (1.0,), (1.0,))  # fmt: skip


def _zero_faults(evidence: Evidence) -> Iterator[Fault]:
    """Another zero, counted the same way or the other: as a stroke from the other dead centre."""
    name, size = evidence.name, (evidence.scale,)
    kind = FaultKind.COLUMN if has_free_zero(name) else FaultKind.SEVERAL

    def by(c: Array) -> str:
        return f"{signed(c[0] / evidence.unit_value, '.4g')} {evidence.unit}"

    yield column_fault(f"offset:{name}", kind, (name,), lambda _, y, c: y + c[0],
        lambda c: f"{name} counts from another zero, {by(c)} from the linkage file's", (0.0,), size,
        cure=lambda c: {name: Correction(offset=-float(c[0]))})  # fmt: skip
    yield column_fault(f"counted back:{name}", kind, (name,), lambda _, y, c: c[0] - y,
        lambda c: f"{name} counts the other way, from {by(c)}, as from the other dead centre", (0.0,), size,
        guesses=(size,), cure=lambda c: {name: Correction(sign=-1, offset=float(c[0]))})  # fmt: skip


def _delay_fault(evidence: Evidence) -> Fault:
    """A column of other instants than the other columns: read before or after the step."""
    name, step = evidence.name, float(np.median(np.diff(evidence.time)))

    def apply(simulation: Simulation, shift: Array) -> Simulation:
        def change(predict: Predict, signal_name: str, time: Array) -> Array:
            if signal_name != name:
                return predict(signal_name, time)
            at = time + float(shift[0])
            within = (at >= evidence.time[0] - SAME_INSTANT * step) & (at <= evidence.time[-1] + SAME_INSTANT * step)
            if holds_acceleration(name):
                within &= ~near_jumps(at, simulation.motion)
            return np.where(within, predict(signal_name, at), np.nan)  # outside the run a tool may write anything

        return simulation.with_change(change)

    def words(p: Array) -> str:
        halves = 2.0 * p[0] / step
        whole = f", {abs(p[0] / step):.2g} samples," if round(halves) and abs(halves - round(halves)) < 0.1 else ""
        return f"{name} is {abs(p[0]):.4g} s{whole} too {'early' if p[0] > 0.0 else 'late'}"

    return Fault(
        f"delay:{name}", FaultKind.SEVERAL, apply, words, (0.0,), (step,), ((0.0,), (4.0 * step,), (-4.0 * step,)),
        tuple((k * step,) for k in (0.5, -0.5, 1.0, -1.0, 2.0, -2.0)),
        cure=lambda p: {name: Correction(time_shift=float(p[0]))},
    )  # fmt: skip


def _single_sample_faults(evidence: Evidence) -> Iterator[Fault]:
    """Single samples that are off, by their sign or in any way."""
    name, values, instants = evidence.name, evidence.values, evidence.time
    apart = np.abs(values - evidence.truth)
    stray = (apart > 5.0 * evidence.tolerance + 1e-3 * evidence.scale) & evidence.counted | evidence.over
    if 0 < np.sum(stray) <= max(1.0, FEW_SAMPLES * len(stray)):
        mirrored = np.abs(values + evidence.truth) <= evidence.tolerance + 0.01 * np.abs(evidence.truth)
        how = "has the other sign" if np.all(mirrored[stray]) else "is off"
        yield column_fault(
            f"stray samples:{name}", FaultKind.SEVERAL, (name,),
            lambda t, y, at: np.where(np.isin(t, at), np.interp(t, instants, values), y),
            lambda at: f"{name} {how} in {_sample_words(at)}", usual=(tuple(instants[stray]),),
        )  # fmt: skip


def _sample_words(times: Array) -> str:
    """How many single samples there are, and at which times, s."""
    at = ", ".join(f"{time:.5g}" for time in times[:MOST_TIMES])
    more = f" and {len(times) - MOST_TIMES} more" if len(times) > MOST_TIMES else ""
    return f"{'a single sample' if len(times) == 1 else f'{len(times)} single samples'}, at {at} s{more}"


def _mistaken_quantity_faults(evidence: Evidence, simulation: Simulation, names: Sequence[str]) -> Iterator[Fault]:
    """Another quantity of the linkage under this name."""
    name, thin = evidence.name, evidence.thinned(100)
    others = [other for other in names if other != name]
    scale = float(np.max(np.abs(thin.values)))
    curves = [replace(thin, name=other) for other in others]
    for other, truth in zip(others, simulation.predict(curves), strict=True):
        for sign in (1.0, -1.0):
            if float(np.max(np.abs(sign * truth - thin.values))) < ALIKE * scale:
                yield _mistaken_quantity_fault(name, other, sign)


def _mistaken_quantity_fault(name: str, other: str, sign: float) -> Fault:
    """The fault that a column contains another quantity, perhaps with the other sign."""

    def apply(simulation: Simulation, _: Array) -> Simulation:
        def change(predict: Predict, signal_name: str, time: Array) -> Array:
            return sign * predict(other, time) if signal_name == name else predict(signal_name, time)

        return simulation.with_change(change)

    sense = "" if sign > 0.0 else " with the other sign"
    return Fault(f"is {other}{sense}:{name}", FaultKind.COLUMN, apply, lambda _: f"{name} contains {other}{sense}")


def group_faults(evidence: Sequence[Evidence]) -> Iterator[Fault]:
    """Faults of at least two columns at once: an axis the other way, a unit, a reaction for an action."""
    names = [signal.name for signal in evidence]
    groups: dict[str, tuple[Callable[[str], bool], str]] = {
        "rotary": (is_rotary, "angles, turns and torques count clockwise"),
        "x": (_is_component("x"), "the x axis points the other way"),
        "y": (_is_component("y"), "the y axis points the other way"),
        "output": (lambda name: name in ("S", "v", "a"), "the output counts the other way"),
        "forces": (lambda name: name.startswith("joint_force"), "joint forces are those on the other links"),
    }
    for joint in {name.rpartition(":")[0] for name in names if name.startswith("joint_force")}:
        words = f"the force of '{joint.partition(':')[2]}' is that on the other link"
        groups[joint] = (lambda name, joint=joint: name.rpartition(":")[0] == joint, words)  # type: ignore[misc]
    for kind, (chosen, words) in groups.items():
        members = [name for name in names if chosen(name)]
        if len(members) > 1:
            yield scale_fault(f"sign of {kind}", members, -1.0, words)
    for unit in sorted({signal.unit for signal in evidence}):
        members = [signal.name for signal in evidence if signal.unit == unit]
        for ratio in UNIT_RATIOS.values() if len(members) > 1 else ():
            for factor in (ratio, 1.0 / ratio):
                words = f"all that is in {unit or '1'} is {factor:.6g} times too large: a unit taken for another"
                yield scale_fault(f"unit {unit} {factor:g}", members, factor, words)


def _is_component(axis: str) -> Callable[[str], bool]:
    return lambda name: name.rpartition(":")[2] in (axis, f"v{axis}", f"a{axis}")
