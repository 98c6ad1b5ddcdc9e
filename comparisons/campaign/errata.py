"""Printed models put to the engines: which of two closed forms a simulation supports, and by how much.

An engine knows nothing of either model. It simulates the linkage as described, and its crank speed is compared with the
corrected closed form and with the printed one.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np

from analytic.description.linkage import Linkage
from analytic.description.schema import Erratum
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import judged, lost, run_key
from comparisons.judging.records import RunRecord
from comparisons.reference.case import Case, case_of_file_regime, erratum_motion
from comparisons.reference.motion import Spin
from comparisons.runs.study import Journal, Study, Task
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, LocalPool, Pool, usual_processes
from engines.contract import Outcome, Setting, Signal

SPEED_QUANTITY = "omega"  # is compared with both models
# The share of a regime, from its end, over which mean speeds are taken: the last 2 s of 10.
LAST_SHARE = 0.2
# An engine supports a model if it is this many times nearer to it than to the other.
DECISIVE_RATIO = 10.0


@dataclass(frozen=True)
class ErratumRecord:
    """One engine's judgement of a printed model; deviations are of crank speed, error_max over the corrected peak.

    Mean speeds, rad/s, are over the last fifth of the regime; ``supports`` is ``corrected``, ``as-printed`` or
    ``neither``; ``reason`` explains a missing motion.
    """

    mechanism: str
    erratum: str
    place: str
    regime: str
    engine: str
    outcome: str
    supports: str
    deviation_corrected: float | None
    deviation_printed: float | None
    mean_speed: float | None
    mean_speed_corrected: float
    mean_speed_printed: float
    note: str
    reason: str = ""

    @property
    def sentence(self) -> str:
        """The judgement in one line."""
        if self.deviation_corrected is None or self.deviation_printed is None:
            return (
                f"{self.mechanism}, {self.erratum} ({self.place}): {self.engine} gave no motion, {self.outcome}: "
                f"{self.reason}"
            )
        return (
            f"{self.mechanism}, {self.erratum} ({self.place}): {self.engine} supports the {self.supports} model; its "
            f"crank speed is off by {self.deviation_corrected:.1e} of peak from the corrected one, by "
            f"{self.deviation_printed:.1e} from the printed one (mean at the end {self.mean_speed:.4g}, corrected "
            f"{self.mean_speed_corrected:.4g}, printed {self.mean_speed_printed:.4g} rad/s)"
        )


ErratumTrial = tuple[Erratum, Case]  # a printed model, and the case of the regime that it is tried in


def judge_errata(
    linkages: Iterable[Linkage],
    engines: Sequence[str],
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    pool: Pool | None = None,
    journal: Journal | None = None,
) -> Iterator[ErratumRecord]:
    """Put every printed model of these linkages to every engine, tuned.

    The engines run as ``comparisons.campaign.campaign.compare`` runs them, and a run that its ``journal`` has is not
    made again: it has to have the crank's speed.
    """
    trials = list(_trials(linkages))
    tasks = [_task(*trial, name) for trial in trials for name in engines]
    where = pool or LocalPool(usual_processes(len({task.key for task in tasks})))
    study = Study(judged, lost, RunRecord.written, RunRecord.from_row, journal, pool=where)
    with closing(study.in_order(tasks, bounds)) as runs:
        for erratum, case in trials:
            printed = None
            for name, run in zip(engines, runs, strict=False):
                printed = printed or erratum_motion(case.mechanism.linkage, erratum)  # while the workers are busy
                yield _erratum_record((erratum, case), name, printed, run)


def _task(erratum: Erratum, case: Case, engine_name: str) -> Task:
    """The run that a trial needs of an engine; trials of one linkage and regime share it."""
    linkage = case.mechanism.linkage
    key = run_key(linkage, erratum.regime, engine_name, Setting.TUNED)
    return Task(key, (pickle.dumps(case), engine_name, Setting.TUNED, (SPEED_QUANTITY,), False))


def _trials(linkages: Iterable[Linkage]) -> Iterator[ErratumTrial]:
    """Every erratum of a linkage's first variant, with the case of the regime that it is tried in."""
    for linkage in linkages:
        if linkage.variant != linkage.variants[0]:
            continue  # printed models are compared at the values of the file
        mechanism = Mechanism(linkage)
        regimes = linkage.released
        names = dict.fromkeys(erratum.regime for erratum in linkage.errata)
        cases = {name: case_of_file_regime(mechanism, regimes[name]) for name in names}
        yield from ((erratum, cases[erratum.regime]) for erratum in linkage.errata)


def _erratum_record(trial: ErratumTrial, engine_name: str, printed: Spin, result: RunRecord) -> ErratumRecord:
    """An engine's run beside both models; without deviations where the run gave no motion."""
    erratum, case = trial
    corrected, values = case.motion, result.curves.get(SPEED_QUANTITY)
    speed_error = next(error for error in result.errors if error.quantity == SPEED_QUANTITY)
    record = ErratumRecord(
        mechanism=case.mechanism.linkage.name,
        erratum=erratum.name,
        place=erratum.place,
        regime=erratum.regime,
        engine=engine_name,
        outcome=speed_error.outcome,
        supports="neither",
        deviation_corrected=None,
        deviation_printed=None,
        mean_speed=None,
        mean_speed_corrected=_mean_speed(corrected, corrected.duration),
        mean_speed_printed=_mean_speed(printed, corrected.duration),
        note=erratum.note,
        reason=speed_error.detail,
    )
    if values is None:
        return record
    time, _, observed, _ = values
    off_corrected, off_printed = (
        float(np.max(np.abs(observed - model.speed(time)))) / corrected.peak_speed for model in (corrected, printed)
    )
    return replace(
        record,
        outcome=Outcome.FINISHED.value,
        supports=_supported_model(off_corrected, off_printed),
        deviation_corrected=off_corrected,
        deviation_printed=off_printed,
        mean_speed=_observed_mean_speed(Signal(time, observed), corrected.duration),
        reason="",
    )


def _supported_model(corrected: float, printed: float) -> str:
    """The model that a simulation supports, by its deviations from both."""
    if DECISIVE_RATIO * corrected < printed:
        return "corrected"
    return "as-printed" if DECISIVE_RATIO * printed < corrected else "neither"


def _mean_speed(motion: Spin, duration: float) -> float:
    """Mean crank speed at the end, rad/s: angle gained over time, no quadrature."""
    start = (1.0 - LAST_SHARE) * duration
    gained = motion.angle(np.asarray(duration)) - motion.angle(np.asarray(start))
    return float(np.squeeze(gained)) / (LAST_SHARE * duration)


def _observed_mean_speed(speed: Signal, duration: float) -> float:
    """Mean of an engine's crank speed at the end, rad/s."""
    late = speed.time >= (1.0 - LAST_SHARE) * duration
    time, values = speed.time[late], speed.values[late]
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))
