"""The options of campaigns: runs of engines that compare, bench and stress make."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from reports.requests.motion_options import MotionOptions
from reports.requests.options import Argument, Option

Engines = Annotated[
    tuple[str, ...], Option("Engine; repeatable; default: all that are installed.", "NAME", names="engines")
]
Settings = Annotated[
    tuple[str, ...],
    Option(
        "naive, tuned, best, or all; repeatable; default: tuned (stress: a setting or a fixed-step method; default: "
        "those of each map).",
        "NAME",
        names="settings",
    ),
]
Jobs = Annotated[
    int | None,
    Option("Worker processes; default: one per core; compare: 0 for none, no limits.", "N", affects_results=False),
]


@dataclass(frozen=True, kw_only=True)
class RunsOptions(MotionOptions):
    """Linkages, engines, settings and quantities of runs; empty means the default."""

    mechanisms: Annotated[tuple[str, ...], Argument("MECHANISM", "mechanisms")] = ()
    engine: Engines = ()
    setting: Settings = ()
    quantity: Annotated[
        tuple[str, ...],
        Option(
            "Quantity, such as Mkr; repeatable; default: all (bench: Mkr, Jeq, phi, joint_force).",
            "NAME",
            names="quantities",
        ),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class CompareOptions(RunsOptions):
    """The runs of ``linkproof compare``."""

    full: Annotated[bool, Option("Run the files' regimes in every setting, not only in tuned.")] = False


@dataclass(frozen=True, kw_only=True)
class BenchOptions(RunsOptions):
    """The runs of ``linkproof bench``, which has settings and methods of its own."""

    quick: Annotated[bool, Option("Measure only the fronts, over one turn, in under a minute.")] = False


@dataclass(frozen=True, kw_only=True)
class StressOptions:
    """Stability maps or cells for ``linkproof stress``; empty means the default."""

    words: Annotated[tuple[str, ...], Argument("AXIS|CELL", "axes")] = ()
    engine: Engines = ()
    setting: Settings = ()
    quick: Annotated[bool, Option("Fewer cells, coarser borders: about a minute.")] = False


@dataclass(frozen=True, kw_only=True)
class StandardOptions:
    """Files of limits, and of results recorded before."""

    limits: Annotated[Path | None, Option("Your limits, which precede the suite's.", "FILE")] = None
    against: Annotated[
        Path | None,
        Option(
            "Compare with results that --record wrote or that are in a folder of --out: what newly fails, has grown "
            "threefold, has vanished or has changed fails.",
            "FILE|DIR",
        ),
    ] = None
    record: Annotated[
        Path | None,
        Option(
            "Write errors, and figures of the closed form, into this CSV file for --against.",
            "FILE",
            affects_results=False,
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class RunLimits:
    """Limits of each run, s and GiB, and worker processes; None means the default."""

    time_limit: Annotated[float | None, Option("Wall time that one run may take; default: 600.", "SECONDS")] = None
    memory_limit: Annotated[float | None, Option("Memory that one run may add; default: 4.", "GIB")] = None
    jobs: Jobs = None
