"""The options of the commands about many designs of one linkage: sweep, optimise, tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from reports.requests.motion_options import MotionOptions
from reports.requests.options import Argument, Json, Option

ANGLES, DESIGNS = 180, 24  # by default: crank angles of a turn, and designs that are simulated


@dataclass(frozen=True, kw_only=True)
class SteadyOptions(MotionOptions):
    """A motion at constant speed, and the number of crank ``angles`` at which signals are sampled."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    scale_mass: Annotated[
        bool, Option("Scale mass and inertia of a link with its lengths; default: as in the file.")
    ] = False
    angles: Annotated[int, Option("Crank angles at which signals are sampled.", "N")] = ANGLES
    refine: bool = True


@dataclass(frozen=True, kw_only=True)
class _Designs:
    """The designs of a sweep, and the figures to compute."""

    vary: Annotated[
        tuple[str, ...],
        Option(
            "Values of a number of the file or of the speed, in the file's units or others: rod.B.x=17cm:18cm:100; "
            "several make a grid.",
            "NAME=FIRST:LAST:COUNT",
            names="parameters",
        ),
    ] = ()
    table: Annotated[Path | None, Option("Designs one by one: columns rod.B.x or rod.B.x [mm].", "CSV")] = None
    quantity: Annotated[
        tuple[str, ...],
        Option(
            "Figure of a design: SIGNAL.peak, .mean, .rms, .max, .min or .range, SIGNAL@DEGREES, joint_force.peak of "
            "every joint, stroke; repeatable; default: peaks of torque and joint forces, least transmission angles, "
            "the stroke.",
            "NAME",
            names="figures",
        ),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class SweepOptions(SteadyOptions, _Designs):
    """The designs of ``linkproof sweep``, and the sample that engines simulate."""

    refine: Annotated[bool, Option("Find the exact extremes between the sampled angles.")] = False
    simulate: Annotated[
        tuple[str, ...],
        Option(
            "Compare this engine on a sample of the designs and report how often it is accurate; repeatable.",
            "ENGINE",
            names="engines",
            affects_results=False,
        ),
    ] = ()
    designs: Annotated[
        int, Option("Designs to simulate, drawn from a Latin hypercube.", "N", affects_results=False)
    ] = DESIGNS
    seed: Annotated[int, Option("Seed of the sample.", "N", affects_results=False)] = 0
    jobs: Annotated[int | None, Option("Processor cores; default: all.", "N", affects_results=False)] = None


@dataclass(frozen=True, kw_only=True)
class _Aim:
    """The aim of an optimisation, its variables, and the figures to hold."""

    minimise: Annotated[str | None, Option("Minimise this figure, such as Mkr.peak.", "FIGURE", names="figures")] = None
    maximise: Annotated[str | None, Option("Maximise it: transmission_angle.min.", "FIGURE", names="figures")] = None
    over: Annotated[
        tuple[str, ...],
        Option(
            "A number of the file, or the speed, to vary within bounds, or NAME=±10%; repeatable.",
            "NAME=LOW:HIGH",
            names="parameters",
        ),
    ] = ()
    keep: Annotated[
        tuple[str, ...],
        Option(
            "Hold a figure at its present value, at =VALUE, or in a range; repeatable.",
            "FIGURE[=LOW:HIGH]",
            names="figures",
        ),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class OptimiseOptions(SteadyOptions, _Aim):
    """The optimisation of ``linkproof optimise``."""

    starts: Annotated[int, Option("Number of designs to start from; the first is the file's.", "N")] = 1
    seed: Annotated[int, Option("Seed of the other designs.", "N")] = 0
    everywhere: Annotated[bool, Option("Search the whole region within the bounds.", flags=("--global",))] = False
    step: Annotated[
        str | None, Option("Round lengths to this step, such as 0.1mm, and report the loss.", "STEP", ("--round",))
    ] = None
    simulate: Annotated[
        tuple[str, ...],
        Option("Simulate the result, as compare does; repeatable.", "ENGINE", names="engines"),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class ToleranceOptions(SteadyOptions):
    """The tolerances of ``linkproof tolerance``."""

    tolerances: Annotated[Path, Argument("TOLERANCES.toml", is_required=True)] = Path()
    samples: Annotated[
        int | None, Option("Random designs; default: 10000, 200 where a group has no closed form.", "N")
    ] = None
    seed: Annotated[int, Option("Seed of the random designs.", "N")] = 0


@dataclass(frozen=True, kw_only=True)
class SweepFiles:
    """Files that ``linkproof sweep`` writes beside its folder."""

    csv: Annotated[str | None, Option("Write every design as a table.", "FILE|-")] = None
    svg: Annotated[str | None, Option("Draw the figures over the designs.", "FILE|-")] = None


@dataclass(frozen=True, kw_only=True)
class ToleranceFiles:
    """Files that ``linkproof tolerance`` writes."""

    json: Json = False
    csv: Annotated[str | None, Option("Write a row per result and parameter.", "FILE|-")] = None
    svg: Annotated[str | None, Option("Draw the effect on each result into this file.", "FILE|-")] = None
