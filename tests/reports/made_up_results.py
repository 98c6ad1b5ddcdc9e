"""Results of engines that do not exist: the closed form with a ripple of known size, for tests of the report."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.campaign.results import CampaignResults, document
from comparisons.trials.invariants.checks import INVARIANTS
from comparisons.trials.judging.limits import judge
from comparisons.trials.judging.quantities import QUANTITIES, Deviation, near_jumps
from comparisons.trials.judging.records import Error, RunRecord, Verdict, run_of
from engines.contract import ReadOut, Setting

ERRORS = ("error_max", "error_rms", "peak", "worst_time", "samples", "left_out")
SIZES = {Setting.NAIVE: 9e-2, Setting.TUNED: 1.3e-6, Setting.BEST: 4e-8}
PRESCRIBED = tuple(name for name, quantity in QUANTITIES.items() if quantity.prescribed and not quantity.needs_thread)
CONDITIONS = "1000 rpm counter-clockwise, 0.6 s + 0.1 s, from 0°, gravity on"


def made_up_results(
    linkages: Sequence[Linkage] | None = None,
    *,
    regimes: Iterable[str] = ("run-up",),
    engines: Sequence[str] = ("alpha", "beta"),
    settings: Sequence[Setting] = tuple(Setting),
    broken: dict[str, Verdict] | None = None,
    samples: int = 701,
    clockwise: bool = False,
    quantities: Sequence[str] = PRESCRIBED,
) -> CampaignResults:
    """A campaign of these engines; those in ``broken`` gave no motion, with a reason."""
    linkages = linkages or [load("juki-mf7923d")]
    motions = tuple(crank_motion(name, clockwise=clockwise) for name in regimes)
    request = CampaignRequest(tuple(linkages), motions, CONDITIONS, tuple(engines), tuple(settings), tuple(quantities))
    runs = [
        _run(case, Maker(engine, setting, samples), request, broken or {})
        for linkage in linkages
        for motion in motions
        for case in [Case(Mechanism(linkage), motion)]
        for engine in engines
        for setting in settings
    ]
    readouts = {name: {"torque": asdict(ReadOut("motor torque", drive="it is the drive's"))} for name in engines}
    saved = document(request, "linkproof compare juki-mf7923d --setting all", readouts=readouts)
    return CampaignResults(saved, tuple(runs))


def changed_results(results: CampaignResults, change: Callable[[Error], Error | None]) -> CampaignResults:
    """The same results, each record as ``change`` makes it, those without that it makes None of."""
    runs = []
    for run in results.runs:
        records, checks = (
            tuple(new for record in part if (new := change(record)) is not None)
            for part in (run.errors, run.invariants)
        )
        runs += [replace(run, setting=records[0].setting, errors=records, invariants=checks)] if records else []
    return CampaignResults(results.document, tuple(runs))


@dataclass(frozen=True)
class Maker:
    """Who makes a run up, and how finely."""

    engine: str
    setting: Setting
    samples: int


def _run(case: Case, maker: Maker, request: CampaignRequest, broken: dict[str, Verdict]) -> RunRecord:
    engine, setting, samples = maker.engine, maker.setting, maker.samples
    run = replace(
        run_of(case, setting.value, engine, "1.0"),
        conditions=request.conditions,
        seconds=0.0123,
        setup_seconds=0.004,
        steps=7000,
        runs=4 if setting is Setting.BEST else 1,
    )
    blank = run.blank._replace(origin="extrapolated" if setting is Setting.BEST else "read")
    if engine in broken:
        facts = {"origin": "", "outcome": broken[engine].value, "detail": f"{engine} <cannot> hold this scene"}
        return replace(run, errors=tuple(_named(blank, name, **facts) for name in request.quantities))
    size = SIZES[setting] * (1.0 + 0.7 * request.engines.index(engine))
    deviations = {name: _deviation(case, name, size, samples) for name in request.quantities}
    errors = tuple(
        judge(_named(blank, name, **{field: getattr(found, field) for field in ERRORS}))
        for name, found in deviations.items()
    )
    invariants = tuple(
        judge(_named(blank, name, error_max=0.3 * size, error_rms=0.1 * size, peak=1.0, samples=samples))
        for name in INVARIANTS
    )
    curves = {name: found.curve for name, found in deviations.items()}
    details = {"step": 1e-4, "scheme": "made up", "passes": 2}
    return replace(run, errors=errors, invariants=invariants, details=details, curves=curves)


def _deviation(case: Case, name: str, size: float, samples: int) -> Deviation:
    time = np.linspace(0.0, case.motion.duration, samples)
    if name == "Jeq":
        time = time[np.abs(case.motion.speed(time)) >= case.least_speed]
    reference = QUANTITIES[name].reference(case, time)
    peak = float(np.max(np.abs(reference)))
    judged_samples = np.ones(len(time), dtype=bool)
    if QUANTITIES[name].holds_acceleration:
        judged_samples = ~near_jumps(time, case.motion)
    ripple = size * peak * np.sin(37.0 * case.motion.angle(time)) * (0.3 + 0.7 * time / time[-1])
    relative = np.abs(ripple[judged_samples]) / peak
    return Deviation(
        time=time,
        angle=case.motion.angle(time),
        observed=reference + ripple,
        reference=reference,
        peak=peak,
        error_max=float(np.max(relative)),
        error_rms=float(np.sqrt(np.mean(relative**2))),
        worst_time=float(time[judged_samples][np.argmax(relative)]),
        samples=int(judged_samples.sum()),
        left_out=samples - int(judged_samples.sum()),
    )


def _named(blank: Error, name: str, **values: Any) -> Error:
    unit = QUANTITIES[name].unit if name in QUANTITIES else "m"
    return blank._replace(quantity=name, unit=unit, **values)


def unpacked(data):
    """Columns as the page's script reads them, NaN where it draws nothing."""
    shares = np.frombuffer(base64.b64decode(data["shares"]), "<u2").reshape(len(data["ends"]), -1)
    columns = (low + share / 65534 * (high - low) for (low, high), share in zip(data["ends"], shares, strict=True))
    return np.where(shares > 65534, np.nan, [*columns])
