"""Results of a tool that cannot be called, judged: aligned with the crank's motion, compared, their causes named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.description.written import file_unit
from analytic.errors import LinkproofError
from analytic.numerics.arrays import Array
from analytic.signals import names, table, unit
from comparisons.filejudge.columns import Correction, Evidence, ImportedResults, ImportedSignal, SignalTimes
from comparisons.filejudge.crank_column import (
    SPREAD,
    ColumnMotion,
    even_instants,
    motion_of_angles,
    motion_of_speeds,
    unwrap_angles,
)
from comparisons.filejudge.fault_ranking import Explanation, explain, proposals
from comparisons.filejudge.simulation import CRANK, JUMPING, MOTION, Simulation
from comparisons.motion.case import DriverMotion
from comparisons.motion.thinning import stored_curve
from comparisons.trials.judging.quantities import near_jump, near_jumps
from comparisons.trials.judging.records import IMPORTED, Error, Verdict

NEIGHBOURS: Final = 8  # a share of the samples that are near one another

MOST_FLOORS: Final = 5000  # instants at which it is worked out what the rounding of times and angles leaves open
FINE: Final = 2000  # instants by which a curve is looked at between few samples
FEWEST_OF_NOISE: Final = 30  # samples that tell noise from a trend,
LAGS: Final = (1, 2, 3)  # by its correlation with the next samples,
SURE: Final = 4.0  # within so many standard deviations


def rounding_floors(model: Simulation, signals: Sequence[ImportedSignal], truth: Sequence[Array]) -> list[Array]:
    """The uncertainty, SI, of each signal (n,) due to the file's rounding of values, instants and crank angles.

    ``truth`` is the closed form of each. Of a long signal what instants and angles leave open is worked out at a part
    of its instants. Near a jump of the acceleration angles leave nothing open.
    """
    floors = []
    likewise = model.motion.likewise if isinstance(model.motion, ColumnMotion) else ()
    places = [np.unique(np.linspace(0, len(s.time) - 1, MOST_FLOORS).astype(int)) for s in signals]
    few = [SignalTimes(s.name, s.time[place]) for s, place in zip(signals, places, strict=True)]
    others = [model.with_values({MOTION: motion}).predict(few) for motion in likewise]
    moved = [s.time_rounding[place] for s, place in zip(signals, places, strict=True)]
    early, late = (
        model.predict([replace(s, time=s.time + sign * by) for s, by in zip(few, moved, strict=True)])
        for sign in (-1.0, 1.0)
    )
    for n, signal in enumerate(signals):
        right, is_at_jump = truth[n][places[n]], near_jumps(few[n].time, model.motion)
        open_ = np.where(moved[n] > 0.0, np.maximum(np.abs(early[n] - right), np.abs(late[n] - right)), 0.0)
        apart = [np.where(is_at_jump, 0.0, np.abs(other[n] - right)) for other in others]
        open_ = open_ + SPREAD * _largest_nearby(apart, model.motion) if apart else open_
        floors.append(signal.rounding + np.interp(signal.time, few[n].time, open_))
    return floors


def _largest_nearby(differences: Sequence[Array], motion: DriverMotion) -> Array:
    """The largest of several trials' ``differences``, (n,) each, near each sample, (n,).

    Near are a share 1 / NEIGHBOURS of all samples, half of them to either side. For a motion that is no known one it is
    the largest over all samples.
    """
    largest = np.max(differences, axis=0)
    if not (isinstance(motion, ColumnMotion) and motion.is_known):
        return np.full(len(largest), np.max(largest))
    size = max(1, len(largest) // NEIGHBOURS)
    wide = np.pad(largest, (size // 2, (size - 1) // 2), mode="edge")
    return np.asarray(np.max(np.lib.stride_tricks.sliding_window_view(wide, size), axis=1))


def jump_sizes(model: Simulation, signal: SignalTimes) -> Array:
    """The signed change, SI, from each sample to the closed form beyond the jump near it, (n,); 0 away from jumps.

    Of several jumps near a sample the largest counts; one without a size is tiny, never 0.
    """
    sizes = np.zeros(len(signal.time))
    if unit(signal.name, model.linkage) not in JUMPING:
        return sizes
    for jump in model.motion.jumps:
        at_rest = model.with_values({(CRANK, "order"): 0})  # as the crank is before the start
        earlier = model if jump > 0.0 else at_rest
        (after,) = model.predict([SignalTimes(signal.name, np.array([jump]))])
        (before,) = earlier.predict([SignalTimes(signal.name, np.array([np.nextafter(jump, 0.0)]))])
        size = float((after - before)[0]) or np.finfo(float).tiny
        larger = near_jump(signal.time, model.motion, jump) & (np.abs(size) > np.abs(sizes))
        sizes = np.where(larger, np.where(signal.time < jump, size, -size), sizes)
    return sizes


DEFAULT_LIMIT: Final = 0.01
# A signal whose peak is below this share of its natural scale is judged by that share: a reaction that symmetry makes
# zero has no peak of its own.
NEAR_ZERO: Final = 0.01


@dataclass(frozen=True, kw_only=True)
class SignalVerdict(Evidence):
    """One signal beside the closed form; ``error_max``, ``error_rms`` and ``limit`` are shares of ``scale``.

    ``scale`` is the closed form's peak, or where that is ``near_zero`` a share of the signal's natural scale. ``worst``
    is the number of the sample with the largest error, ``worst_angle`` φ there, rad. Samples at a jump of the crank's
    acceleration are not ``counted``: their errors count beyond the jump's size, and where nothing else is over the
    limit they are counted ``over``. ``truth_there`` is the side of the jump that is nearer to the file.
    """

    imported: ImportedSignal
    near_zero: bool
    limit: float
    error_max: float
    error_rms: float
    worst: int
    worst_angle: float
    truth_there: float
    outcome: Verdict

    @property
    def floor(self) -> float:
        """The largest error, over the scale, that the file's rounding leaves open."""
        return float(np.max(self.rounding[self.counted], initial=0.0)) / self.scale

    @property
    def worst_time(self) -> float:
        """Instant of the largest error, s."""
        return float(self.time[self.worst])

    @property
    def value_there(self) -> float:
        """The file's value, SI, at the largest error."""
        return float(self.values[self.worst])

    @property
    def left_out(self) -> int:
        """Number of samples at a jump, where only errors beyond the jump's size count."""
        return int(np.sum(~self.counted))

    @property
    def is_noise(self) -> bool:
        """Whether the difference is known to have no trend: its mean and its neighbours say nothing about a sample.

        False for fewer counted samples than FEWEST_OF_NOISE, and without any difference.
        """
        rest = (self.values - self.truth)[self.counted]
        size = float(rest @ rest)
        if len(rest) < FEWEST_OF_NOISE or not size:
            return False
        trends = [float(np.sum(rest)) ** 2 / len(rest)]
        trends += [float(rest[lag:] @ rest[:-lag]) ** 2 / size for lag in LAGS]
        return max(trends) < SURE**2 * size / len(rest)

    @property
    def detail(self) -> str:
        """The reason why the signal did not pass; "" where it did."""
        if self.outcome is Verdict.PASSED:
            return ""
        if self.outcome is Verdict.OVER_LIMIT:
            return f"error {self.error_max:.2g} of peak is over its limit {self.limit:.2g}"
        if not self.counted.any():
            return "every sample lies at a jump of the crank's acceleration: export a longer run"
        return (
            "the rounding of the crank's motion causes an uncertainty over the limit: export its angle with more "
            "digits, or say how it moves with --regime"
        )

    def curve(self, motion: DriverMotion) -> NDArray[np.float32]:
        """The thinned curve of the signal, (4, samples), as a campaign stores it: time, φ, closed form, error; SI.

        The error is signed: the file less the closed form.
        """
        return stored_curve(self.time, motion.angle(self.time), self.truth, self.values - self.truth)

    def record(self, blank: Error) -> Error:
        """The verdict as an Error record, a copy of ``blank``, which has the fields that all signals share.

        An undefined one has no errors.
        """
        errors = (self.error_max, self.error_rms) if self.outcome is not Verdict.UNDEFINED else (None, None)
        return blank._replace(
            quantity=self.name,
            unit=self.si,
            error_max=errors[0],
            error_rms=errors[1],
            limit=self.limit,
            outcome=self.outcome.value,
            detail=self.detail,
            peak=self.scale,
            worst_time=self.worst_time,
            samples=int(np.sum(self.counted)),
            left_out=self.left_out,
            origin=IMPORTED,
        )


def _judge_signal(
    model: Simulation, signal: ImportedSignal, truth: Array, open_: Array, *, limit: float, natural: float
) -> SignalVerdict:
    """The verdict of one signal; ``natural`` is its natural scale, SI, ``open_`` (n,), SI, what the file leaves open.

    ``truth`` (n,) is the closed form, ``limit`` a share of its peak. At a jump of the crank's acceleration a sample may
    be off by the jump besides. An error over the limit that ``open_`` covers, and the values' rounding does not, leaves
    the signal undefined, and so does a file with samples at jumps only.
    """
    si, jump = unit(signal.name, model.linkage), jump_sizes(model, signal)
    in_file, counted = file_unit(si, model.linkage), jump == 0.0
    peak, least = float(np.max(np.abs(truth[counted] if counted.any() else truth))), NEAR_ZERO * natural
    scale = max(peak, least) or 1.0
    apart = np.abs(signal.values - truth)
    error = np.maximum(apart - np.abs(jump), 0.0)
    worst, over = int(np.argmax(error)), error > limit * scale
    alone = over & ~counted & ~np.any((apart > limit * scale) & counted)  # nothing but samples at a jump is off
    outcome = Verdict.PASSED
    if np.any(over & (error > open_)):
        outcome = Verdict.OVER_LIMIT
    elif np.any(over & (error > signal.rounding)) or not counted.any():
        outcome = Verdict.UNDEFINED  # the uncertainty of the crank's motion is over the limit
    return SignalVerdict(
        signal.name, signal.time, signal.values, truth, open_, counted | alone, alone, scale, in_file.on_page,
        in_file.size, si, signal.unit_value,
        imported=signal,
        near_zero=peak < least,
        limit=limit,
        error_max=float(error[worst]) / scale,
        error_rms=float(np.sqrt(np.sum(error[counted] ** 2) / max(1, np.sum(counted)))) / scale,
        worst=worst,
        worst_angle=float(model.motion.angle(signal.time[worst])),
        truth_there=float(min(truth[worst], truth[worst] + jump[worst], key=lambda y: abs(y - signal.values[worst]))),
        outcome=outcome,
    )  # fmt: skip


def natural_scales(model: Simulation, signals: Sequence[SignalTimes], truth: Sequence[Array]) -> list[float]:
    """The natural scale, SI, of each signal in this linkage and motion: what is large for its kind; 0 for other kinds.

    ``truth`` is the closed form of each signal, SI. A length is the linkage's largest coordinate, a speed that times
    the crank's; a force is the largest of all signals that are forces, and of the weights.
    """
    linkage, motion = model.linkage, model.motion
    length, speed = linkage.extent(), motion.peak_speed
    hardest = float(np.max(np.abs(motion.acceleration(np.linspace(0.0, motion.duration, 101))))) + speed**2
    mass = sum(link.mass for link in linkage.links.values())
    forces = [float(np.max(np.abs(y))) for signal, y in zip(signals, truth, strict=True) if "force" in signal.name]
    force = max(mass * float(np.hypot(*linkage.gravity)), mass * length * hardest * 0.1, *forces, 0.0)
    torque = force * length * 0.1
    turning = {"rad": 1.0, "rad/s": speed, "rad/s²": hardest, "J": torque, "N m": torque, "W": torque * speed}
    scales = {**turning, "m": length, "m/s": length * speed, "m/s²": length * hardest, "N": force}
    return [scales.get(unit(signal.name, linkage), 0.0) for signal in signals]


@dataclass(frozen=True)
class ImportedJudgement:
    """The result of a judgement; ``motion_source`` is the source of the crank's motion in words.

    ``limit`` is a share of the peak. ``missed`` are signals whose peak lies between the file's samples, each with the
    share of it that is missed.
    """

    model: Simulation
    verdicts: tuple[SignalVerdict, ...]
    explanation: Explanation
    imported: ImportedResults
    motion_source: str
    limit: float
    missed: tuple[tuple[str, float], ...] = ()

    @property
    def proposals(self) -> dict[str, Correction]:
        """Corrections by the names of signals and axes that would make them right, to be agreed to."""
        known = self.imported
        columns = [signal.name for signal in known.signals] + [signal.axis for signal in known.signals]
        return proposals(self.explanation, dict.fromkeys(columns), known.corrections)

    @property
    def passed(self) -> bool:
        """Whether every signal is within the limit: one that the file leaves open has not passed."""
        return all(verdict.outcome is Verdict.PASSED for verdict in self.verdicts)

    def without_cause(self, verdict: SignalVerdict) -> tuple[str, Array | None]:
        """Words of the likely cause of a signal's difference, "" for none, and the file's values without it, (n,), SI.

        These are nan at jumps of the crank's acceleration, where either value is accepted; None without a cause.
        """
        finding = next(
            (fault_finding for fault_finding in self.explanation.findings if verdict.name in fault_finding.signals),
            None,
        )
        if finding is None:
            return "", None
        (wrong,) = finding.likeliest.applied(self.model).predict([verdict])
        right = finding.aligned.get(verdict.name, Correction())
        values = right.sign * right.factor * verdict.values + verdict.truth - wrong
        return finding.likeliest.words, np.where(verdict.counted, values, np.nan)


def judge(
    linkage: Linkage,
    imported: ImportedResults,
    motion: DriverMotion | None = None,
    *,
    limit: float = DEFAULT_LIMIT,
    start_angle: float = 0.0,
    gives_speed: bool = True,
) -> ImportedJudgement:
    """Compare every imported signal with the closed form at the file's own instants, and seek causes of differences.

    Without a ``motion`` the crank follows the file's column of its angle, or of its speed from ``start_angle``, rad.
    ``limit`` is a share of the peak. ``gives_speed`` is False where the user states no speed, which moving signals over
    the crank angle need. Raises LinkproofError without a signal, a motion or that speed, AssemblyError where the
    linkage cannot make the motion.
    """
    moved, source, crank = _crank_motion(imported, motion, start_angle)
    model = Simulation(linkage, moved)
    judged = [signal for signal in imported.signals if signal is not crank]
    _check_speed(model, judged, gives_speed=gives_speed)
    signals = [_over_time(signal, moved) for signal in judged]
    if not signals:
        reasons = "".join(f"; '{column.header}' is not judged: {why}" for column, why in imported.not_judged)
        raise LinkproofError(
            f"expected a signal to judge, got none besides the crank's motion ({source}){reasons}; name columns "
            "with --map, or export more of them"
        )
    truth = model.predict(signals)
    signals = [_without_turns(signal, values, linkage) for signal, values in zip(signals, truth, strict=True)]
    floors, scales = rounding_floors(model, signals, truth), natural_scales(model, signals, truth)
    verdicts = [
        _judge_signal(model, signal, values, open_, limit=limit, natural=natural)
        for signal, values, open_, natural in zip(signals, truth, floors, scales, strict=True)
    ]
    return ImportedJudgement(
        model,
        tuple(verdicts),
        explain(model, verdicts, names(model.mechanism), crank),
        imported,
        source,
        limit,
        tuple(_missed_peaks(model, verdicts)),
    )


def _crank_motion(
    imported: ImportedResults, motion: DriverMotion | None, start_angle: float
) -> tuple[DriverMotion, str, ImportedSignal | None]:
    """The crank's motion, its source in words, and the column that gives it; None where the motion is stated.

    Of a column of angles and one of speeds it is the one that leaves less doubt, and that of angles where it is a known
    motion. ``start_angle``, rad, is for a column of speeds alone. Raises LinkproofError where nothing gives it.
    """
    signals = imported.signals
    if motion is not None:
        return motion, f"regime {motion.regime}", None
    over_time = {signal.name: signal for signal in signals if signal.axis == "time"}
    angle, speed = over_time.get("phi"), over_time.get("omega")
    made = [(motion_of_angles(*_motion_samples(angle)), angle)] if angle else []
    if speed and not (made and made[0][0].is_known):
        made += [(motion_of_speeds(*_motion_samples(speed), float(angle.values[0]) if angle else start_angle), speed)]
    if made:
        best, column = min(made, key=lambda pair: pair[0].doubt)
        return best, f"column '{column.column.header}'", column
    kind = "over the crank angle" if signals and all(signal.axis == "phi" for signal in signals) else "over time"
    cure = "--speed" if kind.endswith("angle") else "--regime"
    raise LinkproofError(
        f"crank's motion: expected a column of the crank's angle or speed, got signals {kind} without one; say how the "
        f"crank moves with {cure}, or name the column with --map"
    )


def _motion_samples(signal: ImportedSignal) -> tuple[Array, Array, Array]:
    """Times, values and roundings, each (n,), of a column of the crank's motion.

    Times are in equal steps if they are so but for rounding, and angles without jumps of a turn. A rounding is that of
    the value and what that of its time adds.
    """
    time, open_ = even_instants(signal.time, signal.time_rounding)
    values = unwrap_angles(signal.values) if signal.name == "phi" else signal.values
    return time, values, signal.rounding + open_ * np.abs(np.gradient(values, time))


def _over_time(signal: ImportedSignal, motion: DriverMotion) -> ImportedSignal:
    """The signal over time, in its order; one over the crank angle gets the times of the motion's constant speed."""
    time, rounding = even_instants(signal.time, signal.time_rounding)
    order = np.arange(len(time))
    if signal.axis == "phi":
        speed = float(motion.speed(0.0))
        time, rounding = (time - float(motion.angle(0.0))) / speed, rounding / abs(speed)
        order = np.argsort(time, kind="stable")
    return replace(
        signal, axis="time", time=time[order], time_rounding=rounding[order], values=signal.values[order],
        rounding=signal.rounding[order],
    )  # fmt: skip


def _check_speed(model: Simulation, signals: Sequence[ImportedSignal], *, gives_speed: bool) -> None:
    """Raise LinkproofError if a signal over the crank angle needs the speed and ``gives_speed`` is False."""
    known = table(model.mechanism)
    over_angle = [signal.name for signal in signals if signal.axis == "phi"]
    moving = [name for name in over_angle if name not in known or not known[name].is_still]
    if moving and not gives_speed:
        raise LinkproofError(
            f"{moving[0]} over the crank angle: expected the crank's speed, got none; say it with --speed, in rpm"
        )


def _without_turns(signal: ImportedSignal, truth: Array, linkage: Linkage) -> ImportedSignal:
    """The signal without whole turns that a tool added; a transmission angle as its acute angle.

    ``truth`` (n,), rad, tells the turn. A signal that is no angle is returned as it is.
    """
    if unit(signal.name, linkage) != "rad":
        return signal
    if signal.name.startswith("transmission_angle"):
        return replace(signal, values=np.abs(signal.values - np.pi * np.round(signal.values / np.pi)))
    values = unwrap_angles(signal.values)
    turns = np.round(np.median(truth - values) / (2.0 * np.pi))
    return replace(signal, values=values + 2.0 * np.pi * turns)


def _missed_peaks(model: Simulation, judged: Sequence[SignalVerdict]) -> Iterator[tuple[str, float]]:
    """Yield each signal whose closed form peaks between the samples by more than the limit, with the share missed.

    Signals with more samples than FINE, those near zero, and with a motion read from a column those with fewer than
    four samples are left out.
    """
    for verdict in judged:
        time = verdict.time
        if len(time) > FINE or (isinstance(model.motion, ColumnMotion) and len(time) < 4):
            continue
        between = np.linspace(0.0, 1.0, max(9, FINE // len(time)))[:-1]
        fine = (time[:-1, None] + np.diff(time)[:, None] * between).ravel()
        whole = model.predict([SignalTimes(verdict.name, fine)])[0]
        peak = float(np.max(np.abs(whole)))
        share = 1.0 - float(np.max(np.abs(verdict.truth))) / peak if peak else 0.0
        if share > verdict.limit and not verdict.near_zero:
            yield verdict.name, share
