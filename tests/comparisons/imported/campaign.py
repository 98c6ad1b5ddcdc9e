"""Exported curves with the faults that people make, and clean ones: what ``judge`` has to name and to pass.

Run it for the table of figures: ``python -m tests.comparisons.imported.campaign``.
"""

from __future__ import annotations

import sys
import tempfile
import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from analytic.description.changes import with_point, without
from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.description.loading import load
from comparisons.faults.filters import moving_average
from comparisons.imported.judge import judge
from comparisons.imported.reading import read_results
from tests.comparisons.imported.engine_curves import curves
from tests.comparisons.imported.exported import with_link
from tests.targets.judging.exports import ENDINGS, written

DIGITS = 6


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
    digits: int = DIGITS
    engine: str = "direct"
    every: int = 2


@cache
def simulated(mechanism, change, motion, engine, every):
    """The curves of a run, which several exports share."""
    return curves(change(load(mechanism)), motion, engine, every)


def file_of(export):
    """The text of a file, and a mapping where its layout says no names."""
    time, values = export.curves(
        *simulated(export.mechanism, export.linkage, export.motion or QUINTIC, export.engine, export.every)
    )
    return written(export.layout, export.digits, {"time": time, **{n: values[n] for n in export.signals}}, 0)


def judged(export, limit=0.01):
    """The judgement of an export."""
    text, mapping = file_of(export)
    with tempfile.TemporaryDirectory() as folder:
        file, agreed = Path(folder) / f"run.{ENDINGS.get(export.layout, 'csv')}", Path(folder) / "mapping.toml"
        file.write_text(text)
        agreed.write_text(mapping)
        linkage = load(export.mechanism)
        results = read_results([file], linkage, agreed if mapping else None)
        return judge(linkage, results, export.true_motion, limit=limit)


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


def _longer(body, point, factor):
    def change(linkage):
        x, y = linkage.links[body].points[point]
        return with_point(linkage, body, point, (factor * x, factor * y))

    return change


def _mass(body, factor):
    return lambda linkage: with_link(linkage, body, mass=factor * linkage.links[body].mass)


def _shifted_centre(body, by):
    def change(linkage):
        x, y = linkage.links[body].centre
        return with_link(linkage, body, centre=(x + by, y))

    return change


QUINTIC, LINEAR, CUBIC = (crank_motion(name) for name in ("run-up-quintic", "run-up", "run-up-cubic"))
STEADY = crank_motion("constant-speed", speed=400.0 * RPM, ramp_time=0.3, hold_time=0.0)

PLANTED = (
    Export("gravity off", ("gravity",), linkage=lambda k: without(k, "gravity"), layout="solidworks", digits=5,
           engine="exudyn"),
    Export("crank turns the other way", ("direction",), motion=crank_motion("run-up-quintic", clockwise=True),
           true_motion=QUINTIC, signals=("Mkr", "S", "v"), layout="res", engine="simbody"),
    Export("mm for m", ("unit",), curves=_only("S", lambda y: 1e3 * y), digits=5, layout="modelica",
           engine="mujoco"),
    Export("torque smoothed", ("smoothed by moving average",), curves=_only("Mkr", _smoothed), layout="tab",
           engine="exudyn"),
    Export("crank angle mirrored", ("direction", "mirrored angle"), curves=_only("phi", lambda y: -y),
           engine="simbody"),
    Export("another ramp", ("ramp",), motion=LINEAR, true_motion=CUBIC, signals=("Mkr", "S"), layout="robotran",
           engine="exudyn"),
    Export("a mass", ("coupler.mass",), linkage=_mass("coupler", 1.3), digits=5, layout="res", engine="mujoco"),
    Export("a mass centre", ("coupler.centre.x",), linkage=_shifted_centre("coupler", 2e-3), layout="tab",
           engine="simbody"),
    Export("a length", ("coupler.D.x",), linkage=_longer("coupler", "D", 1.02), digits=5, layout="german",
           engine="exudyn"),
    Export("sample rate too low", ("sample rate, joined by straight lines",), curves=_coarse, layout="modelica",
           engine="exudyn"),
    Export("torque of the reaction", ("sign",), curves=_only("Mkr", lambda y: -y), layout="solidworks",
           engine="simbody"),
    Export("single samples flipped", ("flipped samples",), curves=_only("Mkr", _flipped), digits=4, engine="exudyn"),
    Export("inertia left out", ("coupler.inertia",), linkage=lambda k: with_link(k, "coupler", inertia=0.0)),
    Export("start angle", ("start angle",), motion=crank_motion("run-up-quintic", start_angle=0.3), true_motion=QUINTIC,
           signals=("Mkr", "S")),
    Export("clock late", ("time shift",), curves=lambda t, v: (t + 0.002, v), true_motion=QUINTIC,
           signals=("Mkr", "S", "v")),
    Export("power for torque", ("is Peq",), curves=lambda t, v: (t, {**v, "Mkr": v["Peq"]})),
    Export("torque limited", ("clipped",), curves=_only("Mkr", lambda y: np.clip(y, -0.08, 0.08))),
    Export("a mass, six-bar", ("rod.mass",), "rimoldi-164", linkage=_mass("rod", 0.9)),
    Export("speed", ("speed",), motion=crank_motion("run-up-quintic", speed=960.0 * RPM), true_motion=QUINTIC,
           signals=("Mkr", "S")),
    Export("gravity along x", ("gravity's direction",), linkage=lambda k: replace(k, gravity=(9.81, 0.0))),
)  # fmt: skip

CLEAN = (
    Export("csv, 6 digits, exudyn", engine="exudyn"),
    Export("csv, 4 digits, mujoco", digits=4, engine="mujoco"),
    Export("semicolons and decimal commas, simbody", layout="german", digits=5, engine="simbody"),
    Export("SolidWorks, exudyn", layout="solidworks", engine="exudyn"),
    Export("SolidWorks, 4 digits, linear run-up", layout="solidworks", digits=4, motion=LINEAR, engine="simbody"),
    Export("Modelica, mujoco", layout="modelica", signals=("phi", "Mkr", "omega"), engine="mujoco"),
    Export("Adams .tab, simbody", layout="tab", engine="simbody"),
    Export("Adams .tab, 4 decimals, mujoco", layout="tab", digits=4, engine="mujoco"),
    Export("Adams .res, exudyn", layout="res", engine="exudyn"),
    Export("Robotran, simbody", layout="robotran", engine="simbody"),
    Export("a regime told, exudyn", engine="exudyn", motion=LINEAR, digits=5, signals=("Mkr", "S", "v"),
           true_motion=LINEAR),
    Export("a regime told, few samples", motion=QUINTIC, true_motion=QUINTIC, signals=("Mkr", "S", "v", "a"), every=14,
           engine="simbody"),
    Export("csv, 4 digits", digits=4),
    Export("six-bar", mechanism="rimoldi-164", digits=5),
    Export("six-bar, cubic run-up", mechanism="rimoldi-164", motion=CUBIC, digits=4, layout="tsv"),
    Export("slotted take-up", mechanism="slotted-takeup", signals=("phi", "Mkr"), digits=5),
    Export("constant speed", motion=STEADY, digits=5),
    Export("clockwise", motion=crank_motion("run-up-quintic", clockwise=True), digits=6),
    Export("joint forces", signals=("phi", "Mkr", "joint_force:A:x", "joint_force:A:y"), digits=5),
    Export("speed, not angle", signals=("omega", "Mkr", "S", "v"), digits=6),
    Export("swing", motion=swing("cycloidal", 0.0, 2.0, speed=20.0), digits=5),
)  # fmt: skip


def kind(fault):
    """The name of a fault without that of its column."""
    return fault.name.partition(":")[0]


def main():
    """Print the table of figures."""
    for planted in (PLANTED, CLEAN):
        for export in planted:
            start = clock.perf_counter()
            judgement = judged(export)
            took = clock.perf_counter() - start
            findings = judgement.explanation.findings
            named = [f"{kind(f.likeliest.fault)}{f' (+{len(f.others)})' if f.others else ''}" for f in findings]
            right = is_right(export, judgement)
            largest = max(v.error_max for v in judgement.verdicts)
            sys.stdout.write(
                f"{'ok ' if right else 'NO '} {export.name:38} error {largest:8.1e} passed {judgement.passed!s:5} "
                f"{took:5.2f} s  {', '.join(named)} {judgement.explanation.unexplained or ''}\n"
            )


if __name__ == "__main__":
    main()
