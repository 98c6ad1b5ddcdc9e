"""What one cell of a stress map comes to: is the motion right, and if it is not, did anything of ours notice?

A motion is *wrong* where the position or velocity of any body, the crank's angle among them, or the torque of a driven
crank is off the closed form by more than ``WRONG`` of its scale. An engine that returns a wrong motion as a success has
delivered silent garbage: our invariants, which know no closed form, have either caught it or missed it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from analytic.regimes import REGIMES
from comparisons.case import Case
from comparisons.checks import checks
from comparisons.deviations import deviation, near_jumps
from comparisons.limits import OWN, limit
from comparisons.motion import ObservedMotion
from comparisons.quantities import all_quantities
from comparisons.records import Record, Verdict
from engines.consistency import scene_size
from engines.contract import Channel, Outcome, Run, Scene

Array = NDArray[np.float64]

# Of the linkage's size (or rad), of the peak velocity, of the peak torque.
WRONG = 1e-2
LARGEST = 1e300
# A joint is as far open as it is: over its limit that is a deviation from the truth, not an inference that may be false.
MEASURED = ("joint_gap",)


class StressVerdict(StrEnum):
    """What a cell shows."""

    WITHIN = "within limit"
    OVER = "over limit"
    CAUGHT = "caught"
    MISSED = "missed"
    ALARM = "alarm"
    DIVERGED = "diverged"
    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"


MEANINGS: Mapping[StressVerdict, str] = {
    StressVerdict.WITHIN: "every quantity within its limit",
    StressVerdict.OVER: "a quantity over its limit, the motion not grossly wrong",
    StressVerdict.CAUGHT: "said finished with a wrong motion; our invariants said so",
    StressVerdict.MISSED: "said finished with a wrong motion; our invariants let it pass",
    StressVerdict.ALARM: "within every limit, yet an invariant failed it",
    StressVerdict.DIVERGED: "the engine, or its adapter, said that it failed",
    StressVerdict.TIMED_OUT: "took longer than a cell may",
    StressVerdict.CRASHED: "took its process down, or more memory than a cell may",
    StressVerdict.UNSUPPORTED: "refused before it began",
    StressVerdict.UNAVAILABLE: "not installed",
}

SAID: Mapping[str, str] = {
    "joint_gap": "a joint is open by {error} of the shortest link",
    "closure": "bodies are {error} (of size, rad or peak) away from fitting joints and drive",
    "assembly_mode": "a group of links is in its other assembly mode",
    "crank_phase": "the crank is {error} rad away from where it must be",
    "energy_balance": "{error} of the peak kinetic energy comes from nowhere",
    "torque_two_routes": "the torque is {error} of its peak away from what the motion takes",
    "force_balance": "a joint force is {error} of its peak away from the bodies' balance",
}


@dataclass(frozen=True)
class Judgement:
    """A verdict with what it rests on; errors are over the peak, ``wrong`` is in the words of a reader."""

    verdict: StressVerdict
    reason: str = ""
    quantity: str = ""
    deviation: float | None = None
    deviation_limit: float | None = None
    wrong: str = ""
    invariant: str = ""
    invariant_error: float | None = None
    invariant_limit: float | None = None
    alarms: tuple[str, ...] = ()


def judged(case: Case, scene: Scene, run: Run, setting: str) -> Judgement:
    """Hold a run against the closed form and against the invariants, by the limits of a setting.

    Where the closed form itself has no motion (a change point), no motion is right, and the invariants have to say so.
    """
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return Judgement(StressVerdict(run.outcome.value), run.reason)
    motion = ObservedMotion(scene, run.history)
    blank = _blank(case, setting)
    with np.errstate(all="ignore"):  # a wrong motion can be any numbers
        failed, worst = _invariants(case, motion, blank)
        try:
            if case.is_prescribed:
                case.mechanism.check_full_turn()
            found, wrong = _deviations(case, motion, blank), wrongs(case, motion)
        except LinkproofError as error:
            return _without_truth(failed, worst, error)
    return _verdict(found, wrong, failed, worst)


def _verdict(found: Record | None, wrong: Sequence[str], failed: Sequence[Record], worst: Record) -> Judgement:
    said = "; ".join(_said(record) for record in failed)
    over = found is not None and found.outcome != Verdict.PASSED
    inferred = [record for record in failed if record.quantity not in MEASURED]
    if wrong:
        verdict = StressVerdict.CAUGHT if failed else StressVerdict.MISSED
        reason = f"{'; '.join(wrong)}. {'Seen by: ' + said if failed else 'No invariant saw it'}"
    elif over:
        assert found is not None
        verdict, reason = StressVerdict.OVER, f"{found.quantity} off by {_share(found.error_max)} of its peak"
    elif inferred:
        verdict, reason = StressVerdict.ALARM, f"right, yet {said}"
    else:
        verdict, reason = (StressVerdict.OVER, said) if failed else (StressVerdict.WITHIN, "")
    return Judgement(
        verdict,
        reason,
        quantity=found.quantity if found else "",
        deviation=found.error_max if found else None,
        deviation_limit=found.limit if found else None,
        wrong="; ".join(wrong),
        invariant=worst.quantity,
        invariant_error=worst.error_max,
        invariant_limit=worst.limit,
        alarms=tuple(record.quantity for record in failed),
    )


def _without_truth(failed: Sequence[Record], worst: Record, error: LinkproofError) -> Judgement:
    said = "; ".join(_said(record) for record in failed)
    return Judgement(
        StressVerdict.CAUGHT if failed else StressVerdict.MISSED,
        f"there is no one motion to find ({error}). {'Seen by: ' + said if failed else 'No invariant saw it'}",
        wrong="no motion is the right one",
        invariant=worst.quantity,
        invariant_error=worst.error_max,
        invariant_limit=worst.limit,
        alarms=tuple(record.quantity for record in failed),
    )


def _said(record: Record) -> str:
    words = SAID[record.quantity].format(error=_share(record.error_max))
    return words if record.worst_time is None else f"{words} at {record.worst_time:.3g} s"


def _share(error: float | None) -> str:
    return f"{error:.2g}"


def _blank(case: Case, setting: str) -> Record:
    """A record by the limits of the regime that the motion is most like."""
    regime = case.motion.regime
    if case.is_prescribed and regime not in REGIMES:
        regime = "run-up" if case.motion.jumps else "run-up-quintic"
    linkage = case.mechanism.linkage
    return Record(
        mechanism=linkage.name,
        variant=linkage.variant,
        regime=regime if case.is_prescribed else OWN,
        conditions="stress",
        engine="",
        engine_version="",
        setting=setting,
        quantity="",
        unit="",
        error_max=None,
        error_rms=None,
        limit=None,
        baseline=None,
        outcome=Verdict.PASSED.value,
        detail="",
        peak=None,
        worst_time=None,
        samples=0,
        left_out=0,
        seconds=0.0,
        setup_seconds=0.0,
        steps=0,
    )


def _invariants(case: Case, motion: ObservedMotion, blank: Record) -> tuple[list[Record], Record]:
    """Those that failed, the one furthest over its limit first, and the one nearest to or furthest over it."""
    records = sorted(checks(case, motion, blank), key=_over, reverse=True)
    return [record for record in records if record.outcome != Verdict.PASSED], records[0]


def _deviations(case: Case, motion: ObservedMotion, blank: Record) -> Record | None:
    """The quantity nearest to its limit, or furthest over it."""
    found = []
    for quantity in all_quantities(case).values():
        try:
            one = deviation(case, quantity, motion)
        except ValueError:  # so few samples that none is left to compare
            continue
        bound = limit(quantity.name, blank.setting, blank.regime).value
        outcome = Verdict.PASSED if one.error_max <= bound else Verdict.OVER_LIMIT
        found.append(replace(blank, quantity=quantity.name, error_max=_finite(one.error_max), limit=bound,
                             worst_time=one.worst_time, outcome=outcome.value))  # fmt: skip
    return max(found, key=_over, default=None)


def _over(record: Record) -> float:
    """Error over limit."""
    assert record.error_max is not None and record.limit is not None
    return record.error_max / record.limit


def _finite(value: float) -> float:
    """A number that JSON can hold, however far off."""
    return min(value, LARGEST) if value == value else LARGEST


def wrongs(case: Case, motion: ObservedMotion) -> list[str]:
    """What of a motion is wrong, in words; empty for a right one."""
    return [words for size, words in _errors(case, motion) if not size <= WRONG]


def _errors(case: Case, motion: ObservedMotion) -> Iterator[tuple[float, str]]:
    for order, name in enumerate(("position", "velocity")):
        body, share, time = _state_error(case, motion, order)
        yield (
            share,
            f"{name} of {body} off by {share:.2g} of {('the size (or rad)', 'the peak')[order]} at {time:.3g} s",
        )
    if case.is_prescribed:
        signal = motion.signal(Channel.TORQUE)
        kept = ~near_jumps(signal.time, case.motion.jumps)
        if kept.any():
            truth = case.at(signal.time).torque
            error = np.abs(signal.values - truth)[kept] / (float(np.max(np.abs(truth[kept]))) or 1.0)
            worst = int(np.argmax(error))
            yield (
                float(error[worst]),
                f"torque off by {error[worst]:.2g} of its peak at {signal.time[kept][worst]:.3g} s",
            )
    missing = _missing(case, motion)
    yield missing, f"{missing:.2g} of the duration has no samples"


def _missing(case: Case, motion: ObservedMotion) -> float:
    """Share of the duration before the first sample and after the last, where more than steps are missing."""
    time = motion.signal(Channel.POSITION).time
    left_out = max(float(time[0]), case.motion.duration - float(time[-1]))
    return left_out / case.motion.duration if left_out > 2.0 * float(np.max(np.diff(time))) else 0.0


def _state_error(case: Case, motion: ObservedMotion, order: int) -> tuple[str, float, float]:
    """The body that is furthest off in position (0) or velocity (1), by what share of the scale, and when."""
    signal = motion.signal((Channel.POSITION, Channel.VELOCITY)[order])
    truth = true_states(case, motion.scene, signal.time, order)
    unit = np.array([scene_size(motion.scene)] * 2 + [1.0])
    difference = (signal.values - truth) / unit
    if order == 0:  # whole turns apart is the same place
        difference[:, :, 2] = np.angle(np.exp(1j * difference[:, :, 2]))
    difference[:, _without_angle(motion.scene), 2] = 0.0
    sizes = np.maximum(np.hypot(difference[..., 0], difference[..., 1]), np.abs(difference[..., 2]))
    scale = 1.0
    if order:
        peak = truth / unit
        scale = float(np.max(np.maximum(np.hypot(peak[..., 0], peak[..., 1]), np.abs(peak[..., 2])))) or 1.0
    worst = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
    return motion.scene.bodies[worst[1]].name, float(sizes[worst]) / scale, float(signal.time[worst[0]])


def _without_angle(scene: Scene) -> list[int]:
    """Bodies that are points: masses at a pin, whose angle means nothing."""
    guided = {slider.body for slider in scene.sliders}
    return [n for n, body in enumerate(scene.bodies) if body.inertia is None and body.name not in guided]


def true_states(case: Case, scene: Scene, time: Array, order: int) -> Array:
    """Positions or velocities of a scene's bodies by the closed form, (instants, bodies, 3)."""
    truth = case.at(time)
    result = np.empty((len(time), len(scene.bodies), 3))
    for number, body in enumerate(scene.bodies):
        x, y = truth.sweep.centre(body.name, order)
        turn = truth.sweep.rates(body.name)[2] if order else truth.sweep.angles(body.name)
        for part, value in enumerate((x, y, turn)):
            result[:, number, part] = value * truth.speed if order else value
    return result
