"""A finished benchmark of engines that do not exist, for tests of its page and tables."""

from comparisons.trials.work_precision.table import Bench, judged
from tests.comparisons.bench_rows import points, row, setting_row, sweep_rows


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
                    records += _engine(quantity, 1.0 + number, where)
    return judged(Bench(document(mechanisms, engines), points(records)))


def _engine(quantity, dearer, where):
    facts = {"quantity": quantity, **where}
    second = sweep_rows([0.1 / 4**k for k in range(8)], cost=1e-3 * dearer, **facts)
    fourth = sweep_rows([0.1 / 16**k for k in range(6)], cost=4e-3 * dearer, setting="higher", runs=2, **facts)
    settings = [
        setting_row(name, error, seconds * dearer, runs=runs, used="scheme <made up>", **facts)
        for name, error, seconds, runs in (("naive", 0.9, 2e-3, 1), ("tuned", 4e-4, 1.7e-2, 1), ("best", 1e-12, 0.4, 4))
    ]
    failed = row(setting="torn", outcome="diverged", detail="the joints <gave> way", error_max=None, seconds=0.0,
                 repeats=(), **facts)  # fmt: skip
    return [*settings, *second, *fourth, failed]


def document(mechanisms, engines, **changes):
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
    return Bench(document(("m",), ("gamma",), methods=[]), points([absent]))
