"""The commands about many designs of one linkage: ``linkproof sweep | optimise | tolerance``.

They are added to the commands of ``app``; what they need is imported when they run.
"""

from __future__ import annotations

from reports.command_line.app import app, destination
from reports.command_line.parameters import command
from reports.requests.designs_options import NOT_STEADY, OptimiseOptions, SweepOptions, ToleranceOptions
from reports.requests.options import OutputOptions

LEFT_OUT = (*NOT_STEADY, "out", "junit", "verbose")


@command(
    app,
    summary="Compute figures of many designs, such as peak torque over a range of lengths.",
    without=LEFT_OUT,
    texts={"save": "Write every design (.csv .nc), a picture (.svg .png .pdf) or the summary (.json); repeatable."},
)
def sweep(options: SweepOptions, output: OutputOptions) -> None:
    """Compute figures of many designs of one linkage: a grid of ranges, or a table; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Values are in the units of the file. The crank turns at constant speed; extremes are taken at 180 angles, or are
    exact with --refine. A design that does not assemble at one of the angles has no figures.
    """
    from reports.command_line.commands import sweep

    sweep.sweep(options, destination(output))


@command(
    app,
    summary="Find the best lengths: the smallest peak torque at the same stroke, for example.",
    without=LEFT_OUT,
    texts={"save": "Write the new linkage (.toml), the curves (.svg .png .pdf) or the results (.json); repeatable."},
)
def optimise(options: OptimiseOptions, output: OutputOptions) -> None:
    """Find the best values within bounds while holding the results you choose; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file; values are in the units of the file.

    Figures are those of sweep: a peak is the largest magnitude. joint_force.peak is that of all joints together.
    """
    from reports.command_line.commands import optimise

    optimise.optimise(options, destination(output))


@command(
    app,
    summary="Show which length, angle or mass changes which result by how much.",
    without=(*LEFT_OUT, "speed"),  # which stands in the file of tolerances
    texts={"save": "Write a row per result and number (.csv .json) or a picture (.svg .png .pdf); repeatable."},
)
def tolerance(options: ToleranceOptions, output: OutputOptions) -> None:
    """Compute the effect of tolerances on results: one by one, the worst case, random designs; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file. Example of TOLERANCES.toml:

    results = ["Mkr.peak", "joint_force:A.peak", "stroke"]; speed = 1000; and under [tolerances] the ± of numbers of the
    linkage's file, in its units or one of their own, and of the speed: "rod.B.x" = 0.05, "rod.B.length" = "50um",
    "rocker.C.angle" = 0.1, speed = 10, "rod.mass" = { plus_minus = 0.01, distribution = "uniform" } (else normal: the ±
    are three standard deviations).
    """
    from reports.command_line.commands import tolerance

    tolerance.tolerance(options, destination(output))
