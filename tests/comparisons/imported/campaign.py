"""Exported curves with the faults that people make, and clean ones: what ``judge`` has to name and to pass."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from analytic.description.changes import without
from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.description.loading import load
from comparisons.faults.filters import moving_average
from comparisons.imported.judge import judge
from comparisons.imported.reading import read_results
from tests.comparisons.imported.engine_curves import curves
from tests.comparisons.imported.exported import with_link
from tests.targets.judging.exports import ENDINGS, written


def _unchanged(linkage):
    return linkage


@dataclass(frozen=True, eq=False)
class Export:
    """One exported file: what was simulated, what was done to the curves, how it was written, what is to be named."""

    name: str
    expected: tuple[str, ...] = ()  # kinds of causes, any of which is right
    mechanism: str = "juki-mf7923d"
    linkage: Callable = _unchanged
    motion: object = None
    true_motion: object = None  # where another than that of the file's columns is told on the command line
    curves: Callable = lambda time, values: (time, values)
    signals: tuple[str, ...] = ("phi", "Mkr", "S", "v")
    layout: str = "csv"
    digits: int = 6
    engine: str = "direct"
    every: int = 2


@cache
def simulated(mechanism, change, motion, engine, every):
    """The curves of a run, which several exports share."""
    return curves(change(load(mechanism)), motion, engine, every)


def judged(export):
    """The judgement of an export."""
    time, values = export.curves(
        *simulated(export.mechanism, export.linkage, export.motion or QUINTIC, export.engine, export.every)
    )
    named = {"time": time, **{name: values[name] for name in export.signals}}
    text, mapping = written(export.layout, export.digits, named, 0)
    with tempfile.TemporaryDirectory() as folder:
        file, agreed = Path(folder) / f"run.{ENDINGS.get(export.layout, 'csv')}", Path(folder) / "mapping.toml"
        file.write_text(text)
        agreed.write_text(mapping)
        linkage = load(export.mechanism)
        results = read_results([file], linkage, agreed if mapping else None)
        return judge(linkage, results, export.true_motion)


def kind(fault):
    """The name of a fault without that of its column."""
    return fault.name.partition(":")[0]


def is_right(export, judgement):
    """Whether the planted fault is the likeliest cause of all that differs, or a clean file passes without a cause."""
    findings = judgement.explanation.findings
    if not export.expected:
        return judgement.passed and not findings
    return any(kind(f.likeliest.fault) in export.expected for f in findings) and not judgement.explanation.unexplained


def _only(name, change):
    return lambda time, values: (time, {**values, name: change(values[name])})


def _smoothed(values):
    means = moving_average(values, 15)
    return np.where(np.isfinite(means), means, values)


def _flipped(values):
    values = values.copy()
    values[[100, 333]] *= -1.0
    return values


def _coarse(time, values):
    return time, {**values, "Mkr": np.interp(time, time[::9], values["Mkr"][::9])}


def _shifted_centre(linkage):
    x, y = linkage.links["coupler"].centre
    return with_link(linkage, "coupler", centre=(x + 2e-3, y))


QUINTIC, LINEAR, CUBIC = (crank_motion(name) for name in ("run-up-quintic", "run-up", "run-up-cubic"))
STEADY = crank_motion("constant-speed", speed=400.0 * RPM, ramp_time=0.3, hold_time=0.0)


# Signs, units, lengths and masses are faults of the files in ``foreign``, which an independent program made.
PLANTED = (
    Export("gravity off", ("gravity",), linkage=lambda k: without(k, "gravity"), layout="solidworks", digits=5),
    Export("start angle", ("start angle",), motion=crank_motion("run-up-quintic", start_angle=0.3), true_motion=QUINTIC,
           signals=("Mkr", "S")),
    Export("torque limited", ("clipped",), curves=_only("Mkr", lambda y: np.clip(y, -0.08, 0.08))),
    Export("crank turns the other way", ("direction",), motion=crank_motion("run-up-quintic", clockwise=True),
           true_motion=QUINTIC, signals=("Mkr", "S", "v"), layout="res", engine="simbody"),
    Export("torque smoothed", ("smoothed by moving average",), curves=_only("Mkr", _smoothed), layout="tab",
           engine="exudyn"),
    Export("crank angle mirrored", ("direction", "mirrored angle"), curves=_only("phi", lambda y: -y),
           engine="simbody"),
    Export("another ramp", ("ramp",), motion=LINEAR, true_motion=CUBIC, signals=("Mkr", "S"), layout="robotran",
           engine="exudyn"),
    Export("a mass centre", ("coupler.centre.x",), linkage=_shifted_centre, layout="tab", engine="simbody"),
    Export("sample rate too low", ("sample rate, joined by straight lines",), curves=_coarse, layout="modelica",
           engine="exudyn"),
    Export("single samples flipped", ("flipped samples",), curves=_only("Mkr", _flipped), digits=4, engine="mujoco"),
    Export("inertia left out", ("coupler.inertia",), linkage=lambda k: with_link(k, "coupler", inertia=0.0)),
    Export("clock late", ("time shift",), curves=lambda t, v: (t + 0.002, v), true_motion=QUINTIC,
           signals=("Mkr", "S", "v")),
    Export("power for torque", ("is Peq",), curves=lambda t, v: (t, {**v, "Mkr": v["Peq"]})),
    Export("speed", ("speed",), motion=crank_motion("run-up-quintic", speed=960.0 * RPM), true_motion=QUINTIC,
           signals=("Mkr", "S")),
    Export("gravity along x", ("gravity's direction",), linkage=lambda k: replace(k, gravity=(9.81, 0.0))),
)  # fmt: skip
CLEAN = (
    Export("regime, few samples", motion=QUINTIC, true_motion=QUINTIC, signals=("Mkr", "S", "v", "a"), every=14),
    Export("speed, not angle", signals=("omega", "Mkr", "S", "v")),
    Export("slotted take-up", mechanism="slotted-takeup", signals=("phi", "Mkr"), digits=5),
    Export("four digits", digits=4, engine="mujoco"),
    Export("semicolons and decimal commas", layout="german", digits=5, engine="simbody"),
    Export("SolidWorks, linear run-up", layout="solidworks", digits=4, motion=LINEAR, engine="simbody"),
    Export("Modelica", layout="modelica", signals=("phi", "Mkr", "omega"), engine="mujoco"),
    Export("Adams .tab, 4 decimals", layout="tab", digits=4, engine="mujoco"),
    Export("Adams .res", layout="res", engine="exudyn"),
    Export("Robotran", layout="robotran", engine="simbody"),
    Export("six-bar, cubic run-up", mechanism="rimoldi-164", motion=CUBIC, digits=4, layout="tsv"),
    Export("constant speed", motion=STEADY, digits=5),
    Export("clockwise", motion=crank_motion("run-up-quintic", clockwise=True)),
    Export("joint forces", signals=("phi", "Mkr", "joint_force:A:x", "joint_force:A:y"), digits=5),
    Export("swing", motion=swing("cycloidal", 0.0, 2.0, speed=20.0), digits=5),
)  # fmt: skip
