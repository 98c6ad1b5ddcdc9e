"""The commands and their options: ``linkproof list | check | results | compare | bench | …``.

Only click is imported here; a command imports the rest when it runs, so that help appears at once.
"""

from typing import Annotated

import click

from reports.api import designer, trials
from reports.api.options import Argument, Motion, Option, checked
from reports.command_line import completion
from reports.command_line.parameters import SETTINGS, CommandGroup, study_command

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


def _print_version(context: click.Context, is_asked: bool) -> None:
    """Print the version and end, if it is asked for."""
    if is_asked:
        from importlib.metadata import version

        click.echo(f"linkproof {version('linkproof')}")
        context.exit()


LINKAGES, TRIALS = "reports.designs.linkages", "reports.studies.trials"
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
    app, "results", designer.results, study="reports.studies.results:Results",
    summary="Peaks, bearing forces and every signal of one linkage, without an engine.",
    offers={
        "out": "Write a page with the linkage in motion into this folder.",
        "save": "Write every signal (.csv .json .xlsx), the pictures (.svg .png .pdf), or the scheme for CAD at the "
        "first instant of --at or --time, or as sketched (.dxf); repeatable.",
        **{"decimal": "", "figure": "", "opens": ""},
        **PRINTED,
    },
)  # fmt: skip


@checked
def watch(
    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms")],
    motion: Motion = designer.USUAL,
    *,
    opens: Annotated[bool, Option("Open no browser, only print the address.", flags=("--no-open",))] = True,
) -> None:
    """Serve the page of a linkage file on this machine: pull at its points and numbers, and save them to the file.

    MECHANISM is the path of a .toml file.

    The page is built anew when the file changes in an editor. The file is written only by a click on the page.
    """
    from reports import watch

    watch.watch(mechanism, motion, opens=opens)


study_command(
    app, "watch", watch, offers={}, summary="Serve an interactive page of a linkage file that follows its changes."
)
study_command(
    app, "engines", trials.engines, offers=PRINTED,
    summary="List the engines, test an adapter, or try what is installed.",
)  # fmt: skip


study_command(
    app, "compare", trials.compare, study=f"{TRIALS}:Comparison",
    summary="Simulate mechanisms; compare every error with its limit.",
    offers={"save": "Write every record (.json) or every curve (.csv); repeatable.", **PRINTED, "verbose": ""},
)  # fmt: skip
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


study_command(
    app, "bench", trials.bench, offers={**PRINTED, "verbose": ""},
    summary="Measure error against run time, over a sweep of steps.",
)  # fmt: skip
study_command(
    app, "stress", trials.stress, offers={**PRINTED, "verbose": ""},
    summary="Find conditions under which each engine fails.",
)  # fmt: skip
study_command(
    app, "sweep", designer.sweep, study="reports.designs.sweep:DesignSweep",
    summary="Compute figures of many designs, such as peak torque over a range of lengths.",
    offers={
        "save": "Write every design (.csv .nc), a picture (.svg .png .pdf) or the summary (.json); repeatable.",
        **PRINTED,
    },
)  # fmt: skip
study_command(
    app, "optimise", designer.optimise, study="reports.designs.optimise:Optimisation",
    summary="Find the best lengths: the smallest peak torque at the same stroke, for example.",
    offers={
        "save": "Write the new linkage (.toml), the curves (.svg .png .pdf) or the results (.json); repeatable.",
        **PRINTED,
    },
)  # fmt: skip
study_command(
    app, "tolerance", designer.tolerance, study="reports.designs.tolerance:Tolerance",
    summary="Show which length, angle or mass changes which result by how much.",
    offers={
        "save": "Write a row per result and number (.csv .json) or a picture (.svg .png .pdf); repeatable.",
        **PRINTED,
    },
)  # fmt: skip
