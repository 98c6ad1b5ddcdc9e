"""The commands and their options: ``linkproof list | check | results | compare | bench | …``.

Only click is imported here; a command imports the rest when it runs, so that help appears at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from reports.api import designer, trials
from reports.api.designer import USUAL
from reports.api.options import (
    Argument,
    BenchOptions,
    CompareOptions,
    Jobs,
    Motion,
    Option,
    OutputOptions,
    ResultsFiles,
    RunLimits,
    Scheduler,
    StandardOptions,
    StressOptions,
)
from reports.command_line import completion
from reports.command_line.parameters import SETTINGS, CommandGroup, command, study_command

if TYPE_CHECKING:
    from reports.command_line.destination import Destination


app = CommandGroup(
    name="linkproof",
    help="Torque, power and bearing forces of planar linkages, exactly; errors of simulations, and their cost.",
    no_args_is_help=True,
    context_settings=SETTINGS,
    params=[
        click.Option(
            ["--version"], is_flag=True, is_eager=True, expose_value=False, help="Show the version and exit.",
            callback=lambda context, _, is_asked: _print_version(context, is_asked),
        ),
        *completion.OPTIONS,
    ],
)  # fmt: skip

Quiet = Annotated[bool, Option("No progress and no tables, only the closing line.", flags=("-q", "--quiet"))]


def destination(output: OutputOptions) -> Destination:
    """The writer and printer for the options of output."""
    from reports.command_line.destination import Destination

    return Destination(**vars(output))


def _own_study(command: str, output: OutputOptions, *bags: Any) -> tuple[bool, Any]:  # noqa: ANN401 - dataclasses
    """Whether the study in the folder of ``output`` is asked for and finished; the options of what is to be run."""
    if output.out is None:
        return False, bags
    from reports.command_line.unfinished import own_study

    return own_study(app, command, output.out, bags)


def _print_version(context: click.Context, is_asked: bool) -> None:
    if is_asked:
        from importlib.metadata import version

        click.echo(f"linkproof {version('linkproof')}")
        context.exit()


STUDIES, LINKAGES = "reports.studies.designs", "reports.designs.linkages"
PRINTED = {"json": "", "quiet": ""}

study_command(
    app, "list", designer.mechanisms, offers={"json": ""},
    summary="List the mechanisms of the catalogue, or the figures and numbers of one.",
)  # fmt: skip
study_command(app, "new", designer.new, offers={}, summary="Write a linkage file to fill in.")
study_command(
    app, "check", designer.check, study=f"{LINKAGES}:Check",
    summary="Review a linkage: mobility, groups, range, links, errors.",
    offers={
        "save": "Draw the scheme (.svg .png .pdf .dxf) or write what is printed (.json); repeatable.", "json": "",
    },
)  # fmt: skip
study_command(
    app, "results", designer.results, study=f"{STUDIES}:Results", form=ResultsFiles,
    summary="Peaks, bearing forces and every signal of one linkage, without an engine.",
    offers={
        "out": "Write a page with the linkage in motion into this folder.",
        "save": "Write every signal (.csv .json .xlsx), the pictures (.svg .png .pdf), or the scheme for CAD at the "
        "first instant of --at or --time, or as sketched (.dxf); repeatable.",
        "opens": "",
        **PRINTED,
    },
)  # fmt: skip


@command(app, summary="Work on a linkage file: its page follows the file, and saves to it.")
def watch(
    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)],
    motion: Motion = USUAL,
    opens: Annotated[bool, Option("Open no browser, only print the address.", flags=("--no-open",))] = True,
) -> None:
    """Serve the page of a linkage file on this machine: pull at its points and numbers, and save them to the file.

    MECHANISM is the path of a .toml file.

    The page is built anew when the file changes in an editor. The file is written only by a click on the page.
    """
    from reports.command_line import watch

    watch.watch(mechanism, motion, opens=opens)


study_command(
    app, "engines", trials.engines, offers=PRINTED,
    summary="List the engines, test an adapter, or try what is installed.",
)  # fmt: skip


@command(
    app,
    summary="Simulate mechanisms; compare every error with its limit.",
    without=("opens",),
    texts={"save": "Write every record (.json) or every curve (.csv); repeatable."},
)
def compare(
    options: CompareOptions,
    output: OutputOptions,
    standard: StandardOptions,
    limits: RunLimits,
    script: Annotated[
        Path | None, Option("Run nothing; write one run as a script that needs only its engine and numpy.", "FILE")
    ] = None,
) -> int:
    """Simulate mechanisms in engines and compare every error with its limit.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    The naive setting shows the engine without tuning; if other settings run too, its rows do not affect the exit code.
    An engine that crashes, hangs or runs out of memory fails in its own row only.

    --out DIR alone takes the study that is in DIR: the runs that are missing are made, a finished study only gets its
    pages again.

    Exit codes: 0 every error within its limit, 1 an error over its limit, a failed run, or a result that
    is not as it was recorded (--against), 2 bad input.
    """
    if script is not None:
        from reports.command_line.commands.script import write_script

        write_script(script, options, (output, standard, limits))
        return 0
    is_finished, (options, standard, limits) = _own_study("compare", output, options, standard, limits)
    if limits.jobs != 0 and not is_finished:
        trials.start_workers("comparisons.trials.campaign.campaign")
    from reports.command_line.commands import compare

    if is_finished:
        return compare.write_again(destination(output), standard.record)
    return compare.compare(options, destination(output), limits, standard)


study_command(
    app, "judge", designer.judge, study="reports.studies.judged:Judgement",
    summary="Judge a curve from another tool: right or wrong, and the probable cause.",
    offers={
        "out": "",
        "save": "Draw the worst curves and the differences (.svg .png .pdf), or write the verdicts (.json); "
        "repeatable.",
        **PRINTED,
        "verbose": "",
    },
)  # fmt: skip


@command(
    app, summary="Measure error against run time, over a sweep of steps.", without=("save", "junit", "setting", "opens")
)
def bench(options: BenchOptions, output: OutputOptions, scheduler: Scheduler = None) -> int:
    """Measure error against run time: every engine, setting and method over a sweep of steps.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    --out DIR alone takes the benchmark that is in DIR.

    Runs are made one at a time, with --scheduler by one of its workers. Do not use the machine for anything else, or
    the times become wrong.
    """
    is_finished, (options,) = _own_study("bench", output, options)
    if not is_finished:
        trials.start_workers("comparisons.trials.work_precision.measure")
    from reports.command_line.commands import bench

    if is_finished:
        return bench.write_again(destination(output))
    return bench.bench(options, destination(output), scheduler)


@command(app, summary="Find conditions under which each engine fails.", without=("save", "junit", "opens"))
def stress(options: StressOptions, output: OutputOptions, jobs: Jobs = None, scheduler: Scheduler = None) -> int:
    """Find conditions under which each engine fails, and whether the checks detect it.

    AXIS is a stability map; CELL is one run of a map, AXIS/ROW/VALUE/ENGINE/USAGE; default: every map.

    --out DIR alone takes the maps that are in DIR.

    Exit code 1: an engine reported success with a wrong motion, and no check detected it.
    """
    is_finished, (options,) = _own_study("stress", output, options)
    if not is_finished:
        trials.start_workers("comparisons.trials.stress.cells")
    from reports.command_line.commands import stress

    if is_finished:
        return stress.write_again(destination(output))
    return stress.run(options, destination(output), jobs, scheduler)


study_command(
    app, "sweep", designer.sweep, study=f"{STUDIES}:Sweep",
    summary="Compute figures of many designs, such as peak torque over a range of lengths.",
    offers={
        "save": "Write every design (.csv .nc), a picture (.svg .png .pdf) or the summary (.json); repeatable.",
        **PRINTED,
    },
)  # fmt: skip
study_command(
    app, "optimise", designer.optimise, study=f"{STUDIES}:Optimisation",
    summary="Find the best lengths: the smallest peak torque at the same stroke, for example.",
    offers={
        "save": "Write the new linkage (.toml), the curves (.svg .png .pdf) or the results (.json); repeatable.",
        **PRINTED,
    },
)  # fmt: skip
study_command(
    app, "tolerance", designer.tolerance, study=f"{STUDIES}:Tolerance",
    summary="Show which length, angle or mass changes which result by how much.",
    offers={
        "save": "Write a row per result and number (.csv .json) or a picture (.svg .png .pdf); repeatable.",
        **PRINTED,
    },
)  # fmt: skip
