"""Random motions, digits and faults: how often ``judge`` names the fault, or one that is none.

``python -m tests.comparisons.imported.random_faults [COUNT] [SEED]`` prints every miss and the rates.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np

from analytic.description.changes import with_point, without
from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.faults.filters import low_pass, moving_average
from comparisons.faults.ranking import differs
from comparisons.faults.simulation import ChangedMotion, Simulation
from comparisons.imported.judge import judge
from comparisons.judging.records import Verdict
from tests.comparisons.imported.exported import exported, with_link

MECHANISMS = ("juki-mf7923d", "rimoldi-164", "slotted-takeup", "two-crank-takeup", "fork-takeup")
REGIMES = ("run-up", "run-up-cubic", "run-up-quintic", "constant-speed")


def planted(random, linkage, motion):
    """Kinds that are right, and the model or the change of the curves behind a fault."""
    heavy = [name for name, link in linkage.links.items() if link.mass and link.inertia]
    body = heavy[random.integers(len(heavy))]
    link = linkage.links[body]
    size = float(np.exp(random.uniform(np.log(0.01), np.log(0.5)))) * random.choice([-1.0, 1.0])
    extent = linkage.shortest_length()
    points = [point for point in list(link.points)[1:] if point not in linkage.ground]
    width = int(random.choice([5, 9, 15, 25]))

    def smoothed(y):
        means = moving_average(y, width)
        return np.where(np.isfinite(means), means, y)

    def model(**changes):
        return lambda: {"model": Simulation(with_link(linkage, body, **changes), motion)}

    def curve(change):
        return lambda: {"change": lambda values, _: {**values, "Mkr": change(values["Mkr"])}}

    def moved(*changes, **named):
        return lambda: {"model": Simulation(linkage, ChangedMotion(motion, *changes, **named))}

    (x, y), start = link.centre, float(motion.angle(0.0))
    faults = {
        "gravity": lambda: {"model": Simulation(without(linkage, "gravity"), motion)},
        f"{body}.mass": model(mass=link.mass * (1.0 + size)),
        f"{body}.inertia": model(inertia=link.inertia * (1.0 + size)),
        f"{body}.centre.x": model(centre=(x + size * extent, y)),
        "direction": moved(-1.0, 2.0 * start),
        "start angle": moved(offset=size),
        "time shift": moved(shift=0.02 * size),
        "speed": moved(1.0 + size, -size * start),
        "sign:Mkr": curve(lambda m: -m),
        "unit:Mkr": curve(lambda m: 1e3 * m),
        "smoothed by moving average:Mkr": curve(smoothed),
        "smoothed by low-pass filter:Mkr": curve(lambda m: low_pass(m, width / 4.0)),
        "clipped:Mkr": curve(lambda m: np.clip(m, -0.7 * np.max(np.abs(m)), 0.7 * np.max(np.abs(m)))),
        "friction": curve(lambda m: m + abs(size) * np.mean(np.abs(m)) * np.sign(motion.speed(0.5))),
    }
    if points:
        point = points[random.integers(len(points))]
        px, py = link.points[point]
        place = ((1.0 + 0.1 * size) * px, (1.0 + 0.1 * size) * py)
        origin = next((name for name, at in link.points.items() if at == (0.0, 0.0)), "")
        faults[f"{body}.{point}.x" if not py else f"{body}.{point}.y" if not px else f"{body}.{origin}-{point}"] = (
            lambda: {"model": Simulation(with_point(linkage, body, point, place), motion)}
        )
    kind = list(faults)[random.integers(len(faults))]
    return kind, faults[kind]()


def trial(random, *, is_clean):
    """The fault's kind, what came of it, and the judgement."""
    linkage = load(str(random.choice(MECHANISMS)))
    motion = crank_motion(str(random.choice(REGIMES)), start_angle=float(random.uniform(0.0, 6.0)),
                          speed=float(random.uniform(100.0, 3000.0)) * RPM)  # fmt: skip
    names = ["Mkr", *(["S", "v"] if linkage.output and random.random() < 0.7 else [])]
    names += ["phi"] if (by_column := random.random() < 0.3) else []
    kind, fault = ("", {}) if is_clean else planted(random, linkage, motion)
    if by_column and (kind in ("time shift", "speed", "direction", "start angle") or kind == ""):
        fault = {} if kind == "" else fault
        kind = "" if kind in ("time shift", "speed", "direction", "start angle") else kind
    time = np.linspace(0.0, 0.7, int(random.choice([201, 401, 701, 1401])))
    results = exported(linkage, motion, names, time, digits=int(random.integers(4, 7)), **fault)
    judgement = judge(linkage, results, None if by_column else motion)
    return kind, verdict_on(kind, judgement), judgement


def verdict_on(kind, judgement):
    """Whether the fault was named first, among others, not at all, or another in its place."""
    findings = judgement.explanation.findings
    if not kind:
        over = any(verdict.outcome is Verdict.OVER_LIMIT for verdict in judgement.verdicts)
        return "false alarm" if findings or over else "clean" if judgement.passed else "open"
    if any(finding.likeliest.fault.name == kind for finding in findings):
        return "likeliest"
    if any(fit.fault.name == kind for finding in findings for fit in finding.others):
        return "not told apart"
    if not findings:
        return (
            "none named" if any(differs(verdict.evidence) for verdict in judgement.verdicts) else "within the rounding"
        )
    return "misnamed"


def main(count=200, seed=0):
    """Print the misses and the rates."""
    random = np.random.default_rng(seed)
    for is_clean in (False, True):
        outcomes = Counter()
        for _ in range(count):
            try:
                kind, outcome, judgement = trial(random, is_clean=is_clean)
            except LinkproofError as error:
                outcomes["refused"] += 1
                sys.stdout.write(f"refused: {error}\n")
                continue
            outcomes[outcome] += 1
            if outcome in ("misnamed", "none named", "false alarm", "not told apart"):
                named = [
                    f"{f.likeliest.fault.name} (+{len(f.others)}) left {f.left:.1e}"
                    for f in judgement.explanation.findings
                ]
                errors = ", ".join(f"{v.name} {v.error_max:.1e} floor {v.floor:.1e}" for v in judgement.verdicts)
                linkage = judgement.model.linkage.name
                sys.stdout.write(f"{outcome}: {kind} of {linkage} {judgement.motion_source}: {errors}: {named}\n")
        sys.stdout.write(f"{'clean' if is_clean else 'planted'}: {dict(outcomes)}\n")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
