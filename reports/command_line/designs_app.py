"""The commands about many designs of one linkage: ``linkproof sweep | optimise | tolerance``.

They are added to the commands of ``app``; what they need is imported when they run.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reports.command_line import completion, options
from reports.command_line.app import app
from reports.command_line.motion_choice import TIMED, MotionChoice
from reports.command_line.options import flag, valued, with_choices

Quantities = Annotated[
    list[str] | None,
    valued(
        "NAME",
        "Figure of a design: SIGNAL.peak, .mean, .rms, .max, .min or .range, SIGNAL@DEGREES, joint_force.peak of every "
        "joint, stroke; repeatable; default: peaks of torque and joint forces, least transmission angles, the stroke.",
        "--quantity",
        names=completion.figures,
    ),
]
Angles = Annotated[int, valued("N", "Crank angles at which signals are sampled.")]
Refine = Annotated[bool, flag("Find the exact extremes between the sampled angles.", "--refine")]


USUAL = MotionChoice()
# A motion at constant speed: another --regime is refused in a sentence.
STEADY = with_choices(without=TIMED, hidden=["regimes"])


@app.command(short_help="Compute figures of many designs, such as peak torque over a range of lengths.")
@STEADY
def sweep(
    mechanism: options.Mechanism,
    motion: MotionChoice = USUAL,
    vary: Annotated[
        list[str] | None,
        valued(
            "NAME=FIRST:LAST:COUNT",
            "Values of a number of the file or of the speed, in the file's units or others: rod.B.x=17cm:18cm:100; "
            "several make a grid.",
            names=completion.parameters,
        ),
    ] = None,
    table: Annotated[Path | None, valued("CSV", "Designs one by one: columns rod.B.x or rod.B.x [mm].")] = None,
    quantity: Quantities = None,
    scale_mass: options.ScaleMass = False,
    angles: Angles = 180,
    refine: Refine = False,
    out: Annotated[Path | None, valued("DIR", "Write sweep.nc, every design, and sweep.svg into this folder.")] = None,
    csv: Annotated[str | None, valued("FILE|-", "Write every design as a table.")] = None,
    json: Annotated[str | None, valued("FILE|-", "Write the summary as JSON.")] = None,
    svg: Annotated[str | None, valued("FILE|-", "Draw the figures over the designs.")] = None,
    simulate: Annotated[
        list[str] | None,
        valued(
            "ENGINE",
            "Compare this engine on a sample of the designs and report how often it is accurate; repeatable.",
            names=completion.engines,
        ),
    ] = None,
    designs: Annotated[int, valued("N", "Designs to simulate, drawn from a Latin hypercube.")] = 24,
    seed: Annotated[int, valued("N", "Seed of the sample.")] = 0,
    resume: options.Resume = False,
    quiet: options.Quiet = False,
    jobs: Annotated[int | None, valued("N", "Processor cores; default: all.")] = None,
    scheduler: options.Scheduler = None,
) -> None:
    """Compute figures of many designs of one linkage: a grid of ranges, or a table; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Values are in the units of the file. The crank turns at constant speed; extremes are taken at sampled angles, or are
    exact with --refine. A design that does not assemble at one of the angles has no figures.
    """
    from reports.command_line.commands import sweep
    from reports.command_line.destination import Destination

    choice = sweep.SweepChoice(
        **motion.motion_options, mechanism=mechanism, scale_mass=scale_mass, angles=angles, refine=refine,
        vary=tuple(vary or ()), table=table, quantities=tuple(quantity or ()), csv=csv, json=json, svg=svg, jobs=jobs,
        simulate=tuple(dict.fromkeys(simulate or ())), designs=designs, seed=seed, scheduler=scheduler,
    )  # fmt: skip
    raise typer.Exit(sweep.run(choice, Destination(json, out, resume, quiet)))


@app.command(short_help="Find the best lengths: the smallest peak torque at the same stroke, for example.")
@STEADY
def optimise(
    mechanism: options.Mechanism,
    minimise: Annotated[
        str | None, valued("FIGURE", "Minimise this figure, such as Mkr.peak.", names=completion.figures)
    ] = None,
    maximise: Annotated[
        str | None, valued("FIGURE", "Maximise it: transmission_angle.min.", names=completion.figures)
    ] = None,
    over: Annotated[
        list[str] | None,
        valued(
            "NAME=LOW:HIGH",
            "A number of the file, or the speed, to vary within bounds, or NAME=±10%; repeatable.",
            names=completion.parameters,
        ),
    ] = None,
    keep: Annotated[
        list[str] | None,
        valued(
            "FIGURE[=LOW:HIGH]",
            "Hold a figure at its present value, at =VALUE, or in a range; repeatable.",
            names=completion.figures,
        ),
    ] = None,
    motion: MotionChoice = USUAL,
    scale_mass: options.ScaleMass = False,
    angles: Angles = 180,
    starts: Annotated[int, valued("N", "Number of designs to start from; the first is the file's.")] = 1,
    seed: Annotated[int, valued("N", "Seed of the other designs.")] = 0,
    everywhere: Annotated[bool, flag("Search the whole region within the bounds.", "--global")] = False,
    step: Annotated[
        str | None, valued("STEP", "Round lengths to this step, such as 0.1mm, and report the loss.", "--round")
    ] = None,
    simulate: Annotated[
        list[str] | None,
        valued("ENGINE", "Simulate the result, as compare does; repeatable.", names=completion.engines),
    ] = None,
    out: Annotated[Path | None, valued("DIR", "Write the new linkage file, JSON and curves into this folder.")] = None,
    json: options.Json = None,
    quiet: options.Quiet = False,
) -> None:
    """Find the best values within bounds while holding the results you choose; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file; values are in the units of the file.

    Figures are those of sweep: a peak is the largest magnitude. joint_force.peak is that of all joints together.
    """
    from reports.command_line.commands import optimise as command
    from reports.command_line.destination import Destination

    how = {"starts": starts, "seed": seed, "everywhere": everywhere, "step": step or ""}
    wish = command.wish(minimise, maximise, over or (), keep or (), how)
    choice = command.OptimiseChoice(
        **motion.motion_options, mechanism=mechanism, scale_mass=scale_mass, angles=angles, wish=wish,
        simulate=tuple(simulate or ()),
    )  # fmt: skip
    raise typer.Exit(command.run(choice, Destination(json, out, quiet=quiet)))


@app.command(short_help="Show which length, angle or mass changes which result by how much.")
@with_choices(without=(*TIMED, "speed"), hidden=["regimes"])  # which stands in the file of tolerances
def tolerance(
    mechanism: options.Mechanism,
    tolerances: Annotated[Path, typer.Argument(metavar="TOLERANCES.toml", hidden=True)],
    motion: MotionChoice = USUAL,
    scale_mass: options.ScaleMass = False,
    angles: Annotated[int, valued("N", "Crank angles between which extremes are refined.")] = 180,
    samples: Annotated[
        int | None, valued("N", "Random designs; default: 10000, 200 where a group has no closed form.")
    ] = None,
    seed: Annotated[int, valued("N", "Seed of the random designs.")] = 0,
    json: options.Json = None,
    csv: Annotated[str | None, valued("FILE|-", "Write a row per result and parameter.")] = None,
    svg: Annotated[str | None, valued("FILE|-", "Draw the effect on each result into this file.")] = None,
    quiet: options.Quiet = False,
) -> None:
    """Compute the effect of tolerances on results: one by one, the worst case, random designs; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file. Example of TOLERANCES.toml:

    results = ["Mkr.peak", "joint_force:A.peak", "stroke"]; speed = 1000; and under [tolerances] the ± of numbers of the
    linkage's file, in its units or one of their own, and of the speed: "rod.B.x" = 0.05, "rod.B.length" = "50um",
    "rocker.C.angle" = 0.1, speed = 10, "rod.mass" = { plus_minus = 0.01, distribution = "uniform" } (else normal: the ±
    are three standard deviations).
    """
    from reports.command_line.commands import tolerance

    choice = tolerance.ToleranceChoice(
        **motion.motion_options, mechanism=mechanism, tolerances=tolerances, scale_mass=scale_mass, angles=angles,
        samples=samples, seed=seed, json=json, csv=csv, svg=svg, quiet=quiet,
    )  # fmt: skip
    tolerance.run(choice)
