"""Benchmark records of engines that do not exist, with errors and times that are given."""

from dataclasses import replace

from comparisons.trials.judging.records import NAMES, Error
from comparisons.trials.work_precision.table import METHOD, SETTING, Bench, BenchRun


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
        "readout_seconds": 2e-3,
        "steps": 700,
        "solver_work": 2100,
        "work_unit": "iterations",
        "outcome": "finished",
        "detail": "",
        "used": "",
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
        row(
            step=first / ratio**k,
            steps_per_turn=ratio**k,
            error_max=error,
            **times(cost * ratio**k),
            **changes,
        )
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
