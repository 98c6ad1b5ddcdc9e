"""The options of the commands about many designs of one linkage: sweep, optimise, tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from reports.requests.motion_options import TIMED, MotionOptions
from reports.requests.options import Argument, Option

NOT_STEADY: Final = (*TIMED, "regime")  # options of a motion that is not at constant speed


@dataclass(frozen=True, kw_only=True)
class SteadyOptions(MotionOptions):
    """A motion at constant speed, without the options ``NOT_STEADY``."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    scale_mass: Annotated[
        bool, Option("Scale mass and inertia of a link with its lengths; default: as in the file.")
    ] = False
    refine: bool = True


@dataclass(frozen=True, kw_only=True)
class _Designs:
    """The designs of a sweep, and the figures to compute; the first in the help."""

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
    """The designs of ``linkproof sweep``."""

    refine: Annotated[bool, Option("Find the exact extremes between the sampled angles.")] = False


@dataclass(frozen=True, kw_only=True)
class _Aim:
    """The aim of an optimisation, its variables, and the figures to hold; the first in the help."""

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

    everywhere: Annotated[bool, Option("Search the whole region within the bounds.", flags=("--global",))] = False
    step: Annotated[
        str | None, Option("Round lengths to this step, such as 0.1mm, and report the loss.", "STEP", ("--round",))
    ] = None


@dataclass(frozen=True, kw_only=True)
class ToleranceOptions(SteadyOptions):
    """The tolerances of ``linkproof tolerance``."""

    tolerances: Annotated[Path, Argument("TOLERANCES.toml", is_required=True)] = Path()
    samples: Annotated[
        int | None, Option("Random designs; default: 10000, 200 where a group has no closed form.", "N")
    ] = None
