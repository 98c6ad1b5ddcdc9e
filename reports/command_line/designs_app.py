"""The commands about many designs of one linkage: ``linkproof sweep | optimise | tolerance``.

They are added to the commands of ``app``; what they need is imported when they run.
"""

from __future__ import annotations

from reports.command_line.app import Quiet, app, destination
from reports.command_line.parameters import command
from reports.requests.designs_options import OptimiseOptions, SweepFiles, SweepOptions, ToleranceFiles, ToleranceOptions
from reports.requests.motion_options import TIMED
from reports.requests.options import OutputOptions

# A motion at constant speed: another --regime is refused in a sentence.
HIDDEN = ("regime",)
NOT_OF_DESIGNS = (*TIMED, "save", "junit", "verbose")


@command(
    app,
    summary="Compute figures of many designs, such as peak torque over a range of lengths.",
    without=NOT_OF_DESIGNS,
    hidden=HIDDEN,
    texts={"out": "Write sweep.nc, every design, and sweep.svg into this folder."},
)
def sweep(options: SweepOptions, files: SweepFiles, output: OutputOptions) -> int:
    """Compute figures of many designs of one linkage: a grid of ranges, or a table; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Values are in the units of the file. The crank turns at constant speed; extremes are taken at sampled angles, or are
    exact with --refine. A design that does not assemble at one of the angles has no figures.
    """
    from reports.command_line.commands import sweep

    return sweep.sweep(options, files, destination(output))


@command(
    app,
    summary="Find the best lengths: the smallest peak torque at the same stroke, for example.",
    without=(*NOT_OF_DESIGNS, "resume"),
    hidden=HIDDEN,
    texts={"out": "Write the new linkage file, JSON and curves into this folder."},
)
def optimise(options: OptimiseOptions, output: OutputOptions) -> int:
    """Find the best values within bounds while holding the results you choose; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file; values are in the units of the file.

    Figures are those of sweep: a peak is the largest magnitude. joint_force.peak is that of all joints together.
    """
    from reports.command_line.commands import optimise

    return optimise.optimise(options, destination(output))


@command(
    app,
    summary="Show which length, angle or mass changes which result by how much.",
    without=(*TIMED, "speed"),  # which stands in the file of tolerances
    hidden=HIDDEN,
    texts={"angles": "Crank angles between which extremes are refined."},
)
def tolerance(options: ToleranceOptions, files: ToleranceFiles, quiet: Quiet = False) -> None:
    """Compute the effect of tolerances on results: one by one, the worst case, random designs; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file. Example of TOLERANCES.toml:

    results = ["Mkr.peak", "joint_force:A.peak", "stroke"]; speed = 1000; and under [tolerances] the ± of numbers of the
    linkage's file, in its units or one of their own, and of the speed: "rod.B.x" = 0.05, "rod.B.length" = "50um",
    "rocker.C.angle" = 0.1, speed = 10, "rod.mass" = { plus_minus = 0.01, distribution = "uniform" } (else normal: the ±
    are three standard deviations).
    """
    from reports.command_line.commands import tolerance

    tolerance.tolerance(options, files, quiet=quiet)
