"""Results, benchmarks and maps of engines that do not exist: the closed form with a ripple, times that are given."""

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
from comparisons.motion.thinning import stored_curve
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.campaign.results import CampaignResults, document
from comparisons.trials.invariants.checks import INVARIANTS
from comparisons.trials.judging.limits import judge
from comparisons.trials.judging.quantities import QUANTITIES, near_jumps
from comparisons.trials.judging.records import NAMES, Error, RunRecord, Verdict, run_of
from comparisons.trials.runs.store import Curve
from comparisons.trials.stress.campaign import Stress
from comparisons.trials.stress.cells import StressVerdict, axes
from comparisons.trials.work_precision.table import METHOD, SETTING, Bench, BenchRun
from engines.contract import ReadOut, Setting
from tests.comparisons.true_motions import cell

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
    errors = tuple(judge(_named(blank, name, **found)) for name, (found, _) in deviations.items())
    invariants = tuple(
        judge(_named(blank, name, error_max=0.3 * size, error_rms=0.1 * size, peak=1.0, samples=samples))
        for name in INVARIANTS
    )
    curves = {name: curve for name, (_, curve) in deviations.items()}
    details = {"step": 1e-4, "scheme": "made up", "passes": 2}
    return replace(run, errors=errors, invariants=invariants, details=details, curves=curves)


def _deviation(case: Case, name: str, size: float, samples: int) -> tuple[dict[str, Any], Curve]:
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
    found = {
        "error_max": float(np.max(relative)),
        "error_rms": float(np.sqrt(np.mean(relative**2))),
        "peak": peak,
        "worst_time": float(time[judged_samples][np.argmax(relative)]),
        "samples": int(judged_samples.sum()),
        "left_out": samples - int(judged_samples.sum()),
    }
    return found, stored_curve(time, case.motion.angle(time), reference, ripple)


def _named(blank: Error, name: str, **values: Any) -> Error:
    unit = QUANTITIES[name].unit if name in QUANTITIES else "m"
    return blank._replace(quantity=name, unit=unit, **values)


def unpacked(data):
    """Columns as the page's script reads them, NaN where it draws nothing."""
    shares = np.frombuffer(base64.b64decode(data["shares"]), "<u2").reshape(len(data["ends"]), -1)
    columns = (low + share / 65534 * (high - low) for (low, high), share in zip(data["ends"], shares, strict=True))
    return np.where(shares > 65534, np.nan, [*columns])


# Benchmark records with errors and times that are given.


def row(*, error_max=1e-3, lacking=(), detail_of="", **changes):
    """A finished point of a method in one quantity; without an error where that is None.

    The engine says nothing of the quantities ``lacking``, for reasons by name, and ``detail_of`` the one that it has.
    """
    values = {
        "mechanism": "m",
        "variant": "v",
        "regime": "run-up-quintic",
        "conditions": "c",
        "engine": "alpha",
        "engine_version": "1.0",
        "kind": METHOD,
        "setting": "plain",
        "is_control": False,
        "runs": 1,
        "effort": None,
        "effort_unit": "",
        "step": 1e-3,
        "steps_per_turn": 60.0,
        "quantity": "Mkr",
        "seconds": 1e-2,
        "repeats": (1e-2, 1.2e-2),
        "setup_seconds": 1e-3,
        "steps": 700,
        "outcome": "finished",
        "detail": "",
        "ended": "the sweep ends here",
    }
    values |= changes
    known = {"unit": "N m", "error_rms": None if error_max is None else 0.5 * error_max, "peak": 0.2}
    names, quantity = [values[name] for name in NAMES], values.pop("quantity")
    error = Error(*names, quantity, error_max=error_max, outcome="measured", detail=detail_of, **known)
    others = [Error(*names, name, outcome="not-provided", detail=why) for name, why in dict(lacking).items()]
    return BenchRun(**values, errors=(*(() if error_max is None else (error,)), *others))


def times(seconds):
    """So many seconds of set-up and stepping, a quarter of them set-up; None for what did not finish."""
    if seconds is None:
        return {"seconds": 0.0, "setup_seconds": 0.0, "repeats": ()}
    return {"seconds": 0.75 * seconds, "setup_seconds": 0.25 * seconds, "repeats": (0.75 * seconds, 0.9 * seconds)}


def sweep_rows(errors, *, first=0.06, ratio=2.0, cost=1e-3, **changes):
    """A sweep from the step ``first``, s, down, each step ``ratio`` times finer and dearer."""
    return [
        row(step=first / ratio**k, steps_per_turn=ratio**k, error_max=error, **times(cost * ratio**k), **changes)
        for k, error in enumerate(errors)
    ]


def setting_row(name, error, total, **changes):
    """A finished setting, of so many seconds in total."""
    return row(kind=SETTING, setting=name, step=None, steps_per_turn=None, error_max=error, **(times(total) | changes))


def points(runs):
    """Runs that are alike but for their errors as one, with the errors of all."""
    found = {}
    for run in runs:
        shared = repr(replace(run, errors=()))
        found[shared] = replace(run, errors=(*found[shared].errors, *run.errors) if shared in found else run.errors)
    return list(found.values())


def bench_of(*runs):
    """A benchmark of these runs."""
    return Bench({"quantities": ["Mkr"]}, runs)


# A finished benchmark.


def made_up_bench(
    mechanisms=("juki-mf7923d", "rimoldi-164"), regimes=("run-up-quintic",), engines=("alpha", "beta"), control=""
):
    """Two methods, three settings and a failure, in every place and engine.

    One of the engines may be the control.
    """
    records = []
    for mechanism in mechanisms:
        for regime in regimes:
            for number, engine in enumerate(engines):
                where = {"mechanism": mechanism, "regime": regime, "engine": engine, "is_control": engine == control}
                for quantity in ("Mkr", "joint_force"):
                    records += _bench_engine(quantity, 1.0 + number, where)
    return Bench(bench_document(mechanisms, engines), points(records))


def _bench_engine(quantity, dearer, where):
    facts = {"quantity": quantity, **where}
    second = sweep_rows([0.1 / 4**k for k in range(8)], cost=1e-3 * dearer, **facts)
    fourth = sweep_rows([0.1 / 16**k for k in range(6)], cost=4e-3 * dearer, setting="higher", runs=2, **facts)
    settings = [
        setting_row(name, error, seconds * dearer, runs=runs, details={"scheme": "<made up>"}, **facts)
        for name, error, seconds, runs in (("naive", 0.9, 2e-3, 1), ("tuned", 4e-4, 1.7e-2, 1), ("best", 1e-12, 0.4, 4))
    ]
    failed = row(setting="torn", outcome="diverged", detail="the joints <gave> way", error_max=None, seconds=0.0,
                 repeats=(), **facts)  # fmt: skip
    return [*settings, *second, *fourth, failed]


def bench_document(mechanisms, engines, **changes):
    """All a saved benchmark holds but its points."""
    methods = [("plain", 100.0, "iterations", 1), ("higher", None, "", 2), ("torn", None, "", 1)]
    return {
        "command": "linkproof bench --quick",
        "conditions": "as tested",
        "environment": {"date": "today", "machine": "this one", "commit": "none", "python": "3"},
        "extent": {"steps_per_turn": [12.0], "budget": 1.0, "repeats": 5, "patience": 0.6},
        "mechanisms": [{"name": name, "title": f"The {name}", "variant": "v"} for name in mechanisms],
        "methods": [
            {"engine": engine, "name": name, "about": f"what <{name}> does", "runs": runs, "effort": effort,
             "effort_unit": unit}
            for engine in engines
            for name, effort, unit, runs in methods
        ],
        "quantities": ["Mkr", "joint_force"],
        **changes,
    }  # fmt: skip


def nothing_finished():
    """A benchmark of an engine that is not installed."""
    absent = row(
        engine="gamma",
        kind="setting",
        setting="",
        step=None,
        outcome="unavailable",
        detail="not installed",
        error_max=None,
        seconds=0.0,
        repeats=(),
    )
    return Bench(bench_document(("m",), ("gamma",), methods=[]), points([absent]))


# A finished stress test, with every verdict in it.


STRESS_SETTINGS = ("naive", "tuned", "best")
METHODS = {"alpha": ("generalised alpha", "trapezoidal"), "beta": ("centred", "defaults")}
REASON = "velocity of <rod> off by 0.3 of the peak at 0.01 s"


def made_up_stress(
    names=("mass", "change-point", "speed"), engines=("alpha", "beta"), *, quick=False, cells=None, **changes
):
    """Axes as the table has them, verdicts in turn where a line is beyond its border."""
    results = []
    for name in names:
        axis = axes()[name]
        for row in axis.chosen_rows(quick=quick):
            for engine in engines:
                for usage in METHODS[engine] if axis.methods else STRESS_SETTINGS:
                    values = axis.chosen_values(row, quick=quick)
                    results += [
                        made_up_cell(
                            made_up_verdict(row.label, value, usage, axis.good, values),
                            axis=name, row=row.label, value=value, engine=engine, usage=usage,
                        )
                        for value in values
                    ]  # fmt: skip
    document = {
        "command": "linkproof stress --out 'a <folder>'",
        "environment": {"date": "today", "machine": "this one", "commit": "none", "python": "3"},
        "quick": quick,
    }
    return Stress({**document, **changes}, results if cells is None else cells)


def made_up_verdict(row, value, usage, good, values):
    """Within the limit near the easy value; beyond, every other verdict in turn."""
    far = abs(values.index(value) - values.index(good)) if good in values else values.index(value)
    reaches = 3 + ("naive", "tuned", "best").index(usage) if usage in STRESS_SETTINGS else 4
    others = [verdict for verdict in StressVerdict if verdict is not StressVerdict.WITHIN]
    beyond = max(0, far - reaches)
    turn = (beyond + len(row)) % len(others) if beyond > 1 else 0
    return others[turn] if beyond else StressVerdict.WITHIN


def made_up_cell(came_to, **place):
    """One cell of a verdict."""
    reason = "" if came_to is StressVerdict.WITHIN else REASON
    return cell(**place, verdict=came_to, reason=reason, differing={"linkage": "m"}, spent=0.5, steps=10)
