"""The reference's speed against named baselines: same run, same machine, in turns, all repeats kept.

Every contestant has one run to warm up, in which it compiles what it compiles. The repeats are then interleaved, so
that a machine that slows down slows all of them. The contestants' numbers are held against each other: times count only
where they are the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from time import perf_counter
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import design_numbers
from analytic.description.loading import load
from analytic.designs.values import evaluate_designs
from analytic.evaluation import PIECE
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code import compiling
from analytic.motion.released import free_motion

Array = NDArray[np.float64]
Seconds = tuple[float, ...]
Work = Callable[[], object]

OURS: Final = "compiled"
SAME: Final = 1e-9  # of the peak, what contestants' numbers may differ by
# Over several turns: pylinkage's crank turns in steps, whose roundings add up.
TURNS: Final = 7
SPREAD: Final = 0.02  # share of its value that a number of a design may differ by
WITHIN: Final = 1e-6  # rad, over the whole run
# Evaluations of ours: 8300 at 1e-12, 5000 at 1e-8, 2200 at 1e-5 with an error of 1.4e-7 rad.
TOLERANCE: Final = 1e-5
REPEATS, LONG_REPEATS = 9, 3  # of runs of milliseconds, and of ten seconds


@dataclass(frozen=True)
class Contest:
    """Seconds of every repeat by contestant, for ``count`` pieces of work each; ``fault`` says why it is void."""

    seconds: Mapping[str, Seconds]
    count: int
    fault: str = ""


@dataclass(frozen=True)
class Measured:
    """A figure for the table of targets; ``reached`` is nan where a baseline is absent."""

    subject: str
    reached: float
    repeats: Seconds
    detail: str


def race(
    contestants: Mapping[str, Work], repeats: int, warm_up: Mapping[str, Work] | None = None
) -> dict[str, Seconds]:
    """Seconds of every repeat, taken in turns after one run each to warm up, or after what is given for that."""
    for work in {**contestants, **(warm_up or {})}.values():
        work()
    spent: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(repeats):
        for name, work in contestants.items():
            begun = perf_counter()
            work()
            spent[name].append(perf_counter() - begun)
    return {name: tuple(seconds) for name, seconds in spent.items()}


def over(contest: Contest, name: str, baseline: str, unit: str, scale: float) -> Measured:
    """Time of a contestant over that of a baseline, shortest over shortest, and repeat by repeat.

    Times are told per piece of work, in a unit of ``scale`` seconds.
    """
    for wanted in (name, baseline):
        if wanted not in contest.seconds:
            return _absent(wanted)
    ours, theirs = contest.seconds[name], contest.seconds[baseline]
    reached = math.inf if contest.fault else min(ours) / min(theirs)
    ratios = tuple(one / other for one, other in zip(ours, theirs, strict=True))
    words = (f"{who}: {_span(contest.seconds[who], contest.count, unit, scale)}" for who in contest.seconds)
    return Measured(f"{name} over {baseline}", reached, ratios, contest.fault or "; ".join(words))


def each(contest: Contest, name: str, unit: str, scale: float) -> Measured:
    """Time of a contestant per piece of work, in a unit of ``scale`` seconds."""
    if name not in contest.seconds:
        return _absent(name)
    repeats = tuple(seconds / (contest.count * scale) for seconds in contest.seconds[name])
    words = contest.fault or _span(contest.seconds[name], contest.count, unit, scale)
    return Measured(name, math.inf if contest.fault else min(repeats), repeats, words)


def _absent(name: str) -> Measured:
    """No figure: a contestant is not there."""
    return Measured(f"{'numba' if name == OURS else name} is not installed", math.nan, (), "")


def _span(seconds: Seconds, count: int, unit: str, scale: float) -> str:
    """Shortest and median time per piece of work."""
    part = scale * count
    return f"{min(seconds) / part:.3g} {unit}, median {float(np.median(seconds)) / part:.3g} {unit}"


@cache
def six_bar_contest(name: str, angles: int) -> Contest:
    """A six-bar's four moving joints and their two derivatives over as many crank angles, one core."""
    if not compiling.is_installed():
        return Contest({}, angles)
    from tests.targets import speed_baselines as baselines  # noqa: PLC0415 - needs numba

    mechanism = Mechanism(load(name))
    measures = baselines.six_bar(mechanism.linkage)
    step = 2.0 * math.pi * TURNS / angles
    angle = step * np.arange(1.0, angles + 1.0)
    contestants: dict[str, Work] = {
        OURS: baselines.our_motion(mechanism, angle),
        "NumPy": lambda: _plain(mechanism, baselines.POINTS, angle),
        "hand-written kernel": baselines.hand_written_motion(measures, angle),
    }
    if baselines.has_pylinkage():
        contestants["pylinkage"] = baselines.pylinkage_motion(measures, step, angles)
    return Contest(race(contestants, REPEATS), angles, _difference(contestants))


def _plain(mechanism: Mechanism, points: tuple[str, ...], angle: Array) -> Array:
    """The same by NumPy, in pieces that stay in the cache: (points, orders, 2, angles)."""
    places = np.empty((len(points), 3, 2, len(angle)))
    for start in range(0, len(angle), PIECE):
        sweep = mechanism.sweep(angle[start : start + PIECE])
        for number, point in enumerate(points):
            for order in range(3):
                places[number, order, :, start : start + PIECE] = sweep.point(point, order)
    return places


def _difference(contestants: Mapping[str, Work]) -> str:
    """What is wrong with the contestants' numbers, if anything."""
    found = {name: _places(work()) for name, work in contestants.items()}
    truth = found["NumPy"]
    peak = np.max(np.abs(truth), axis=(0, 2, 3))
    for name, places in found.items():
        worst = float(np.max(np.max(np.abs(places - truth), axis=(0, 2, 3)) / peak))
        if not worst <= SAME:
            return f"{name} differs from NumPy by {worst:.1e} of the peak"
    return ""


def _places(result: object) -> Array:
    """A contestant's result as (points, orders, 2, angles)."""
    if isinstance(result, tuple):
        return np.stack([np.moveaxis(places[:, -4:], 0, -1) for places in result], axis=1)
    if isinstance(result, dict):
        places = np.stack(list(result.values()))
        return places.reshape(-1, 3, 2, places.shape[-1])
    return np.asarray(result)


def designs_contest(name: str, varied: tuple[str, ...], designs: int, angles: int) -> Contest:
    """Jeq of designs that differ in the numbers named, at as many crank angles each, compiled, one core."""
    if not compiling.is_installed():
        return Contest({}, designs * angles)
    mechanism, chance = Mechanism(load(name)), np.random.default_rng(4)
    own = design_numbers(mechanism.linkage)
    angle = np.linspace(0.0, 2.0 * math.pi, angles, endpoint=False)
    numbers = {one: own[one][1] * chance.uniform(1 - SPREAD, 1 + SPREAD, designs) for one in varied}
    work = partial(evaluate_designs, mechanism, numbers, angle, ("Jeq",), cores=1, path="compiled")
    fault = "" if np.all(work()["assembled"]) else "some designs cannot be assembled"
    return Contest(race({OURS: work}, REPEATS), designs * angles, fault)


@cache
def forward_contest(name: str, regime: str) -> Contest:
    """A released crank in a regime of the linkage's own, φ within 1e-6 rad throughout."""
    if not compiling.is_installed():
        return Contest({}, 1)
    from tests.targets import speed_baselines as baselines  # noqa: PLC0415 - needs numba

    mechanism = Mechanism(load(name))
    (own,) = (found for found in mechanism.linkage.regimes if found.name == regime)
    release = partial(
        free_motion,
        mechanism,
        torque=own.torque,
        start_angle=own.start_angle,
        start_speed=own.start_speed,
        duration=own.duration,
    )
    quick = partial(release, tolerance=TOLERANCE)
    theirs = baselines.dop853(mechanism, own.torque, (own.start_angle, own.start_speed), own.duration)
    contestants: dict[str, Work] = {
        "NumPy": quick,
        "DOP853": theirs,
    }
    time, angle = theirs()
    truth = release().angle(time)
    far = {"DOP853": np.abs(angle - truth), "NumPy": np.abs(quick().angle(time) - truth)}
    faults = [f"{who} is off by {np.max(errors):.1e} rad" for who, errors in far.items() if np.max(errors) > WITHIN]
    return Contest(race(contestants, LONG_REPEATS, {"DOP853": lambda: None}), 1, ", ".join(faults))
