"""Benchmark records of engines that do not exist, with errors and times that are given."""

from comparisons.work_precision.records import METHOD, SETTING, BenchRecord, PointError, PointRecord


def row(*, error_max=1e-3, **changes):
    """A finished point of a method in one quantity; none where its error is None."""
    values = {
        "mechanism": "m",
        "variant": "v",
        "regime": "run-up-quintic",
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
        "seconds_min": 1e-2,
        "seconds_median": 1.1e-2,
        "repeats": (1e-2, 1.2e-2),
        "setup_seconds": 1e-3,
        "readout_seconds": 2e-3,
        "steps": 700,
        "solver_work": 2100,
        "work_unit": "iterations",
        "outcome": "finished",
        "left_out": {},
        "detail": "",
        "used": "",
        "ended": "the sweep ends here",
    }
    values |= changes
    error = None if error_max is None else PointError("N m", error_max, 0.5 * error_max, 0.2)
    return BenchRecord(**values, errors={values["quantity"]: error} if error else {})


def times(seconds):
    """So many seconds of set-up and stepping, a quarter of them set-up; None for what did not finish."""
    shares = {"seconds_min": 0.75, "setup_seconds": 0.25}
    return {name: None if seconds is None else share * seconds for name, share in shares.items()}


def sweep_rows(errors, *, first=0.06, ratio=2.0, cost=1e-3, **changes):
    """A sweep from the step ``first``, s, down, each step ``ratio`` times finer and dearer."""
    return [
        row(
            step=first / ratio**k,
            steps_per_turn=ratio**k,
            error_max=error,
            **times(cost * ratio**k),
            seconds_median=1.1 * cost * ratio**k,
            repeats=(cost * ratio**k, 1.2 * cost * ratio**k),
            **changes,
        )
        for k, error in enumerate(errors)
    ]


def setting_row(name, error, seconds, **changes):
    """A finished setting."""
    return row(
        kind=SETTING, setting=name, step=None, steps_per_turn=None, error_max=error, **(times(seconds) | changes)
    )


def points(records):
    """The points behind records, each once with the errors in all its quantities."""
    found = {}
    for record in records:
        shared = {name: value for name, value in vars(record).items() if name not in ("quantity", "errors")}
        errors = found.setdefault(repr(shared), PointRecord(**shared, errors={})).errors
        errors |= record.errors
    return list(found.values())
