"""What may be wrong with one column: its sign, unit, zero or clock, or another quantity under its name."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.written import signed
from comparisons.imported.causes.filters import coarser, filters
from comparisons.imported.causes.fitting import FaultModel, said
from comparisons.imported.columns import Correction
from comparisons.imported.judging.judgement import SignalVerdict
from comparisons.imported.judging.samples import JudgedModel, is_angle

Array = NDArray[np.float64]
Alter = Callable[[Array, Array, Array], Array]  # time, the closed form, the numbers of the cause

RADIAN: Final = math.pi / 180.0
# What one unit is of another that is printed in its place, either way round.
UNIT_RATIOS: Final = {
    "10": 10.0,
    "100": 100.0,
    "1000": 1e3,
    "1e6": 1e6,
    "degrees and radians": 1.0 / RADIAN,
    "rpm and rad/s": 30.0 / math.pi,
    "g and m/s², or kgf and N": 9.80665,
    "in and mm": 25.4,
    "in and m": 1.0 / 0.0254,
    "lb and kg": 1.0 / 0.45359237,
    "lbf and N": 4.4482216152605,
    "lbf·in and N·m": 1.0 / 0.1129848290276167,
    "lbf·ft and N·m": 1.3558179483314,
    "hp and W": 745.69987158227,
}
NEAR_RATIO: Final = 0.2  # of a unit's ratio, by which the file's may differ where it has other faults
FEW: Final = 0.03  # of the samples: single ones
HELD: Final = 4  # samples at one value: a limit
NEAR: Final = 0.05  # of the peak, within which a column is another quantity


def signal_changes(model: JudgedModel, verdict: SignalVerdict, names: Sequence[str]) -> Iterator[FaultModel]:
    """Every cause that lies in one column; ``names`` are the signals that it may be taken for."""
    name = verdict.name
    yield _altered(
        name, "sign", lambda _, y, __: -y, said(f"{name} has the other sign"), handicap=-1,
        corrections=lambda _: {name: Correction(sign=-1)},
    )  # fmt: skip
    yield from _factors(verdict)
    yield _offset(verdict)
    if name == "Mkr":
        yield _friction(model, verdict)
    yield _delayed(model, verdict)
    for kind, words, values in (*filters(verdict), *coarser(verdict)):
        yield _given(name, kind, words, values, handicap=1)
    yield from _limited(verdict)
    yield from _single_samples(verdict)
    yield from _mistaken(model, verdict, names)


def _altered(name: str, kind: str, alter: Alter, words: Callable[[Array], str], **rest: Any) -> FaultModel:  # noqa: ANN401
    """A cause that changes the closed form of one signal; ``rest`` are fields of ``FaultModel``."""

    def predict(numbers: Array, verdicts: Sequence[SignalVerdict]) -> list[Array]:
        return [alter(v.samples.time, v.truth, numbers) if v.name == name else v.truth for v in verdicts]

    return FaultModel(f"{kind}:{name}", predict, words, signals=frozenset((name,)), **rest)


def _given(name: str, kind: str, words: str, values: Array, handicap: int = 0) -> FaultModel:
    """A cause without numbers, its values at the file's instants."""
    return _altered(name, kind, lambda _, __, ___: values, said(words), handicap=handicap)


def _factors(verdict: SignalVerdict) -> Iterator[FaultModel]:
    """A free factor, and those of units taken for others that are near the file's, which a mapping may agree to."""
    name, truth = verdict.name, verdict.truth[verdict.kept]
    size = float(truth @ truth)
    share = float(verdict.samples.values[verdict.kept] @ truth) / size if size else 0.0
    for words, ratio in UNIT_RATIOS.items():
        for factor in (ratio, 1.0 / ratio, -ratio, -1.0 / ratio):
            if abs(share / factor - 1.0) < NEAR_RATIO:
                yield _unit(name, words, factor)
    yield _altered(
        name, "factor", lambda _, y, k: k[0] * y, lambda k: f"{name} is {k[0]:.5g} times the closed form's",
        start=(1.0,), sizes=(1.0,), handicap=1, contains=("sign", "unit"),
    )  # fmt: skip


def _unit(name: str, words: str, factor: float) -> FaultModel:
    sign = 1 if factor > 0.0 else -1
    sense = "" if sign > 0 else " and has the other sign"
    return _altered(
        name,
        "unit",
        lambda _, y, __: factor * y,
        said(f"{name} is {abs(factor):.6g} times the closed form's{sense}: a unit taken for another ({words})"),
        handicap=0 if sign > 0 else 1,
        corrections=lambda _: {name: Correction(sign=sign, factor=1.0 / abs(factor))},
    )


def _offset(verdict: SignalVerdict) -> FaultModel:
    """A constant difference: another zero, of which a mapping may agree to that of an angle."""
    name = verdict.name

    def words(c: Array) -> str:
        by = f"{signed(math.degrees(c[0]), '.4g')}°" if is_angle(name) else f"{signed(c[0], '.4g')} {verdict.unit}"
        return f"{name} counts from another zero, {by} from the linkage file's"

    def corrections(c: Array) -> dict[str, Correction]:
        return {name: Correction(angle_offset=-float(c[0]))}

    return _altered(
        name, "offset", lambda _, y, c: y + c[0], words, start=(0.0,), sizes=(verdict.scale,),
        corrections=corrections if is_angle(name) else None, handicap=int(name == "Mkr"),
    )  # fmt: skip


def _friction(model: JudgedModel, verdict: SignalVerdict) -> FaultModel:
    """A torque against the motion, whatever the speed."""

    def alter(time: Array, truth: Array, numbers: Array) -> Array:
        way = np.sign(model.motion.speed(time))
        return np.asarray(truth + numbers[0] * np.where(way == 0.0, np.nan, way))  # at rest it is anything up to that

    return _altered(
        verdict.name, "friction", alter, lambda c: f"a friction of {c[0]:.3g} N m brakes the crank at any speed",
        start=(0.0,), sizes=(verdict.scale,),
    )  # fmt: skip


def _delayed(model: JudgedModel, verdict: SignalVerdict) -> FaultModel:
    """One column told at other instants than the rest: read before or after the step."""
    name, samples = verdict.name, verdict.samples
    step = float(np.median(np.diff(samples.time)))
    half_steps = (0.5, -0.5, 1.0, -1.0, 2.0, -2.0)

    def alter(time: Array, _: Array, shift: Array) -> Array:
        return model.predicted([replace(samples, time=time + float(shift[0]))])[0]

    def words(p: Array) -> str:
        halves = 2.0 * p[0] / step
        whole = f", {abs(p[0] / step):.2g} samples," if round(halves) and abs(halves - round(halves)) < 0.1 else ""
        return f"{name} is {abs(p[0]):.4g} s{whole} too {'early' if p[0] > 0.0 else 'late'}"

    return _altered(
        name,
        "delay",
        alter,
        words,
        start=(0.0,),
        sizes=(step,),
        guesses=((0.0,), (4.0 * step,), (-4.0 * step,)),
        special=tuple((k * step,) for k in half_steps),
        corrections=lambda p: {name: Correction(time_shift=float(p[0]))},
    )


def _limited(verdict: SignalVerdict) -> Iterator[FaultModel]:
    """Cut off at a largest or a smallest value."""
    values, truth, open_ = verdict.samples.values, verdict.truth, verdict.open + 1e-9 * verdict.scale
    low, high = float(np.min(values)), float(np.max(values))
    clipped = np.clip(truth, low, high)
    held = max(np.sum(np.abs(values - end) <= open_) for end in (low, high))
    if held >= HELD and np.any(np.abs(clipped - truth) > open_):
        cut = ((low, np.min(truth) < low), (high, np.max(truth) > high))
        ends = " and ".join(f"{end:.4g} {verdict.unit}" for end, is_cut in cut if is_cut)
        yield _given(verdict.name, "clipped", f"{verdict.name} is limited to {ends}", clipped)


def _single_samples(verdict: SignalVerdict) -> Iterator[FaultModel]:
    """Single samples with the other sign, or else off in any way."""
    name, values, truth = verdict.name, verdict.samples.values, verdict.truth
    open_ = verdict.open + 1e-9 * verdict.scale
    flipped = (np.abs(values + truth) <= open_ + 0.01 * np.abs(truth)) & (np.abs(values - truth) > open_)
    stray = np.abs(values - truth) > 5.0 * open_ + 1e-3 * verdict.scale
    if _are_few(flipped) and not np.any(stray & ~flipped):
        words = f"{name} has the other sign in {_counted(flipped)}"
        yield _given(name, "flipped samples", words, np.where(flipped, -truth, truth), handicap=-1)
    elif _are_few(stray):
        yield _given(name, "stray samples", f"{name} is off in {_counted(stray)}", np.where(stray, values, truth), 2)


def _are_few(which: NDArray[np.bool_]) -> bool:
    return bool(0 < np.sum(which) <= FEW * len(which))


def _counted(which: NDArray[np.bool_]) -> str:
    count = int(np.sum(which))
    return "a single sample" if count == 1 else f"{count} single samples"


def _mistaken(model: JudgedModel, verdict: SignalVerdict, names: Sequence[str]) -> Iterator[FaultModel]:
    """Another quantity of the linkage under this name."""
    name, samples = verdict.name, verdict.samples
    others = [other for other in names if other != name]
    scale = float(np.max(np.abs(samples.values)))
    truths = model.predicted([replace(samples, name=other) for other in others])
    for other, truth in zip(others, truths, strict=True):
        for sign in (1.0, -1.0):
            if float(np.max(np.abs(sign * truth - samples.values))) < NEAR * scale:
                sense = "" if sign > 0.0 else " with the other sign"
                yield _given(name, f"is {other}{sense}", f"{name} contains {other}{sense}", sign * truth)
