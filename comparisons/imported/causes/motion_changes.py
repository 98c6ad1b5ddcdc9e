"""What may be wrong with the crank's motion: its direction, start, ramp, speed, or clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RAMPS, RPM, CrankMotion, crank_motion
from analytic.written import signed
from comparisons.imported.causes.fitting import FaultModel, said
from comparisons.imported.columns import Correction
from comparisons.imported.judging.changed_motion import ChangedMotion
from comparisons.imported.judging.crank_column import ColumnMotion
from comparisons.imported.judging.judgement import SignalVerdict
from comparisons.imported.judging.samples import JudgedModel, Samples, at_jumps, holds_acceleration
from comparisons.reference.motion import Motion

Array = NDArray[np.float64]

TURNS: Final = 12  # start angles from which a fit of the start angle begins
PHASE: Final = 0.7  # rad, from which a fit finds the phase
MOST_PACES: Final = 150
QUARTERS: Final = (90.0, -90.0, 180.0)
SHORTEST: Final = 1e-9  # s, of a ramp


def motion_changes(model: JudgedModel) -> Iterator[FaultModel]:
    """Every cause that lies in the crank's motion; ramps only where a regime, not a column of the file, gives it."""
    motion, start = model.motion, float(model.motion.angle(0.0))
    from_column = isinstance(motion, ColumnMotion)
    direction = "the crank angle is mirrored" if from_column else "the crank turns the other way"
    yield _of(
        model, "direction", lambda _: ChangedMotion(motion, -1.0, 2.0 * start), said(direction),
        corrections=_mirrored(2.0 * start) if from_column else None,
    )  # fmt: skip
    if abs(start) > 1e-9:
        mirrored = said("the crank angle is mirrored")
        yield _of(model, "mirrored angle", lambda _: ChangedMotion(motion, -1.0), mirrored, corrections=_mirrored(0.0))
    yield from _offsets(model, start)
    yield _shifted(model)
    yield _of(
        model, "no acceleration", lambda _: ChangedMotion(motion, order=1),
        said("the crank's acceleration is left out: torque and forces are those of a constant speed"),
    )  # fmt: skip
    if not from_column:
        yield from _regimes(model)


def _mirrored(offset: float) -> Callable[[Array], dict[str, Correction]]:
    return lambda _: {"phi": Correction(sign=-1, angle_offset=turned(offset))}


def turned(angle: float) -> float:
    """An angle, rad, without whole turns: from −π to π."""
    return (float(angle) + math.pi) % (2.0 * math.pi) - math.pi


def _of(
    model: JudgedModel,
    kind: str,
    motion: Callable[[Array], Motion],
    words: Callable[[Array], str],
    **rest: Any,  # noqa: ANN401
) -> FaultModel:
    """A cause that changes the motion; ``rest`` are fields of ``FaultModel``."""

    def predict(numbers: Array, verdicts: Sequence[SignalVerdict]) -> list[Array]:
        other = motion(numbers)
        values = model.moving(other).predicted([verdict.samples for verdict in verdicts])
        if other.jumps == model.motion.jumps:
            return values
        return [_without_jumps(v.samples, found, other) for v, found in zip(verdicts, values, strict=True)]

    return FaultModel(kind, predict, words, **rest)


def _without_jumps(samples: Samples, values: Array, motion: Motion) -> Array:
    """Values left open where the other motion's acceleration jumps."""
    return np.where(at_jumps(samples.time, motion), np.nan, values) if holds_acceleration(samples.name) else values


def _offsets(model: JudgedModel, start: float) -> Iterator[FaultModel]:
    """Another zero of the crank angle, counted the same way or the other."""
    motion, from_column = model.motion, isinstance(model.motion, ColumnMotion)

    def words(p: Array) -> str:
        degrees = math.degrees(turned(p[0]))
        if from_column:
            return f"the crank angle counts from another zero: {signed(degrees, '.4g')}° are to be added to the file's"
        return f"the crank starts at {math.degrees(turned(start + p[0])):.4g}° in place of {math.degrees(start):.4g}°"

    def mirrored_words(p: Array) -> str:
        return f"the crank angle counts the other way, from {math.degrees(turned(p[0])):.4g}°"

    of_one: dict[str, Any] = {
        "start": (0.0,),
        "sizes": (1.0,),
        "guesses": tuple((2.0 * math.pi * n / TURNS,) for n in range(TURNS)),
        "special": tuple((math.radians(a),) for a in QUARTERS),
    }
    yield _of(
        model, "start angle", lambda p: ChangedMotion(motion, offset=float(p[0])), words,
        corrections=lambda p: {"phi": Correction(angle_offset=turned(p[0]))}, **of_one,
    )  # fmt: skip
    yield _of(
        model, "mirrored start", lambda p: ChangedMotion(motion, -1.0, float(p[0])), mirrored_words, handicap=1,
        contains=("direction", "mirrored angle"),
        corrections=lambda p: _mirrored(float(p[0]))(p), **of_one,
    )  # fmt: skip


def _shifted(model: JudgedModel) -> FaultModel:
    motion = model.motion
    turn = 2.0 * math.pi / motion.peak_speed if motion.peak_speed else motion.duration
    length = min(turn, motion.duration)
    of = "*" if isinstance(motion, ColumnMotion) else "time"  # all that is not the crank's motion, or the clock itself
    return _of(
        model,
        "time shift",
        lambda p: ChangedMotion(motion, shift=float(p[0])),
        lambda p: f"the file's clock is {abs(p[0]):.4g} s {'behind' if p[0] > 0.0 else 'ahead'}",
        start=(0.0,),
        sizes=(length,),
        guesses=tuple((k * length / 8.0,) for k in (0, 1, -1, 2, -2, 3, -3)),
        corrections=lambda p: {of: Correction(time_shift=float(p[0]))},
    )


def _regimes(model: JudgedModel) -> Iterator[FaultModel]:
    """Another speed, another ramp, another time of the ramp."""
    motion, start = model.motion, float(model.motion.angle(0.0))
    rpm, turned_by = motion.peak_speed / RPM, abs(float(motion.angle(motion.duration)) - start)
    paces = np.linspace(0.5, 1.5, int(min(max(turned_by / PHASE, 9.0), MOST_PACES)))
    yield _of(
        model, "speed", lambda p: ChangedMotion(motion, float(p[0]), start * (1.0 - float(p[0]))),
        lambda p: f"the crank's speed is {p[0] * rpm:.4g} rpm in place of {rpm:.4g} rpm", start=(1.0,), sizes=(1.0,),
        guesses=((1.0,), *((float(pace),) for pace in paces)),
    )  # fmt: skip
    if not isinstance(motion, CrankMotion) or motion.regime not in (*RAMPS, "constant-speed"):
        return
    speed = float(motion.speed(motion.duration))
    ramp = motion.segments[0].end if motion.regime in RAMPS else 0.6 * motion.duration
    for name in (*RAMPS, "constant-speed"):
        if name != motion.regime:
            words = said(f"the crank follows '{name}' in place of '{motion.regime}'")
            yield _of(model, f"ramp:{name}", _always(_regime(name, speed, ramp, motion)), words)
    if motion.regime in RAMPS:
        yield _of(
            model, "ramp time", lambda p: _regime(motion.regime, speed, float(abs(p[0])), motion),
            lambda p: f"the crank runs up in {p[0]:.4g} s in place of {ramp:.4g} s", start=(ramp,), sizes=(ramp,),
            guesses=((ramp,), *((float(part) * motion.duration,) for part in np.linspace(0.02, 1.0, 50))),
        )  # fmt: skip


def _always(motion: Motion) -> Callable[[Array], Motion]:
    return lambda _: motion


def _regime(name: str, speed: float, ramp: float, like: CrankMotion) -> CrankMotion:
    """A regime as long as another, with the same start."""
    ramp = min(max(ramp, SHORTEST), like.duration)
    return crank_motion(
        name, speed=abs(speed), ramp_time=ramp, hold_time=like.duration - ramp, clockwise=speed < 0.0,
        start_angle=float(like.angle(0.0)),
    )  # fmt: skip
