"""The reference's speed, in turns with pylinkage's compiled path where both compute the same, or alone.

Every contestant has one run to warm up, in which it compiles. The repeats are then interleaved, so that a machine that
slows down slows all of them. Times count only where the numbers are the same.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import design_numbers
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.designs.sampled_signals import evaluate_designs
from analytic.evaluation import evaluate
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code import compiling
from analytic.signals import ORDERS

Array = NDArray[np.float64]
Seconds = tuple[float, ...]
Work = Callable[[], Any]

SAME: Final = 1e-9  # of the peak, what contestants' numbers may differ by
TURNS: Final = 7  # several: pylinkage's crank turns in steps, whose roundings add up
SPREAD: Final = 0.02  # share of its value that a number of a design may differ by
REPEATS: Final = 9
POINTS: Final = ("A", "B", "C", "D")


@dataclass(frozen=True)
class Measured:
    """A figure for the table of targets; ``reached`` is nan where a package is absent, inf where a contest is void."""

    subject: str
    reached: float
    repeats: Seconds = ()
    detail: str = ""


def race(contestants: Mapping[str, Work]) -> dict[str, Seconds]:
    """Seconds of every repeat, taken in turns after one run each to warm up."""
    for work in contestants.values():
        work()
    spent: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(REPEATS):
        for name, work in contestants.items():
            begun = perf_counter()
            work()
            spent[name].append(perf_counter() - begun)
    return {name: tuple(seconds) for name, seconds in spent.items()}


def six_bar(name: str, angles: int) -> Measured:
    """Time of a six-bar's four moving joints and their two derivatives over pylinkage's, one core."""
    if not compiling.is_installed() or importlib.util.find_spec("pylinkage") is None:
        return Measured("numba or pylinkage is not installed", math.nan)
    mechanism, step = Mechanism(load(name)), 2.0 * math.pi * TURNS / angles
    names = [f"point:{point}:{component}" for point in POINTS for component in ORDERS]
    angle = step * np.arange(1.0, angles + 1.0)
    ours = partial(evaluate, mechanism, angle, names, speed=1.0, cores=1, path="compiled")
    theirs = pylinkage_motion(mechanism.linkage, step, angles)
    right = np.stack(list(ours().values())).reshape(len(POINTS), 3, 2, angles)
    other = np.stack([np.moveaxis(places[:, -len(POINTS) :], 0, -1) for places in theirs()], axis=1)
    fault = difference(right, other)
    return ratio(race({"compiled": ours, "pylinkage": theirs}), angles, fault)


def difference(right: Array, other: Array) -> str:
    """The fault of other numbers (points, orders, 2, angles) in words; empty where they are the same."""
    peak = np.max(np.abs(right), axis=(0, 2, 3))
    worst = float(np.max(np.max(np.abs(other - right), axis=(0, 2, 3)) / peak))
    return "" if worst <= SAME else f"the numbers differ by {worst:.1e} of the peak"


def ratio(seconds: Mapping[str, Seconds], count: int, fault: str = "") -> Measured:
    """Time of the first contestant over the second's for ``count`` pieces of work: shortest over shortest."""
    (ours, first), (theirs, second) = seconds.items()
    words = (
        f"{name}: {1e9 * min(each) / count:.3g} ns, median {1e9 * float(np.median(each)) / count:.3g} ns"
        for name, each in seconds.items()
    )
    repeats = tuple(one / other for one, other in zip(first, second, strict=True))
    reached = math.inf if fault else min(first) / min(second)
    return Measured(f"{ours} over {theirs}", reached, repeats, fault or "; ".join(words))


def designs(name: str, varied: list[str], count: int, angles: int) -> Measured:
    """Time, ns, of Jeq per design and crank angle, of designs that differ in the numbers named; compiled, one core."""
    if not compiling.is_installed():
        return Measured("numba is not installed", math.nan)
    mechanism, chance = Mechanism(load(name)), np.random.default_rng(4)
    own = design_numbers(mechanism.linkage)
    angle = np.linspace(0.0, 2.0 * math.pi, angles, endpoint=False)
    numbers = {each: own[each][1] * chance.uniform(1 - SPREAD, 1 + SPREAD, count) for each in varied}
    work = partial(evaluate_designs, mechanism, numbers, angle, ("Jeq",), cores=1, path="compiled")
    if not np.all(work()["assembled"]):
        return Measured("compiled", math.inf, (), "some designs cannot be assembled")
    repeats = tuple(1e9 * seconds / (count * angles) for seconds in race({"compiled": work})["compiled"])
    return Measured("compiled", min(repeats), repeats)


def pylinkage_motion(linkage: Linkage, step: float, count: int) -> Callable[[], tuple[Array, ...]]:
    """The compiled run of pylinkage over ``count`` steps of the crank, rad, ready to be called again and again.

    The linkage has the Rimoldi's shape: crank O1A, rod AB, rocker CBO2 with C on the line of B and O2, link CD, D on a
    vertical line. A call gives positions, velocities and accelerations at a crank speed of 1 rad/s, each (count,
    joints, 2), the last four joints A to D; the first run starts one step after φ = 0, the next one where it ended.
    """
    from pylinkage.actuators import Crank  # noqa: PLC0415 - wanted for the benchmark only
    from pylinkage.components import Ground  # noqa: PLC0415
    from pylinkage.dyads import FixedDyad, RRPDyad, RRRDyad  # noqa: PLC0415
    from pylinkage.simulation import Linkage as Theirs  # noqa: PLC0415

    bodies, (x, y), (slider,) = linkage.links, linkage.ground["O2"], linkage.sliders
    ends = {"crank": "A", "rod": "B", "rocker": "B", "link": "D"}
    length = {name: math.hypot(*bodies[name].points[end]) for name, end in ends.items()}
    opposite = bodies["rocker"].points["C"][0] / bodies["rocker"].points["B"][0]
    r, line = length["rocker"], slider.guide.through[0]
    o1, o2 = Ground(0.0, 0.0, name="O1"), Ground(x, y, name="O2")
    low, high = Ground(line, 0.0, name="low"), Ground(line, 1.0, name="high")
    a = Crank(anchor=o1, radius=length["crank"], angular_velocity=step, initial_angle=0.0, name="A")
    b = RRRDyad(a.output, o2, length["rod"], r, x=x - r, y=y, name="B")
    c = FixedDyad(o2, b, abs(opposite) * r, 0.0 if opposite > 0.0 else math.pi, name="C")
    d = RRPDyad(c, low, high, length["link"], x=line, y=y - length["link"], name="D")
    theirs: Any = Theirs((o1, o2, low, high, a, b, c, d))
    theirs.set_input_velocity(a, omega=1.0)
    return lambda: tuple(theirs.step_fast_with_kinematics(iterations=count))
