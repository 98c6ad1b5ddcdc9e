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
)
click.version_option(package_name="linkproof", message="linkproof %(version)s")(app)
app.params += completion.OPTIONS

study_command(app, "list", designer.mechanisms, "json")
study_command(app, "new", designer.new)
study_command(
    app, "check", designer.check, "json", study="reports.designs.linkages:Check",
    save="Draw the scheme (.svg .png .pdf .dxf) or write what is printed (.json); repeatable.",
)  # fmt: skip
study_command(
    app, "results", designer.results, "decimal figure opens json quiet", study="reports.designs.results:Results",
    out="Write a page with the linkage in motion into this folder.",
    save="Write every signal (.csv .json .xlsx), the pictures (.svg .png .pdf), or the scheme for CAD at the "
    "first instant of --at or --time, or as sketched (.dxf); repeatable.",
)  # fmt: skip


@checked
def watch(
    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms")],
    motion: Motion = Motion(),
    *,
    opens: Annotated[bool, Option("Open no browser, only print the address.", flags=("--no-open",))] = True,
) -> None:
    """Serve an interactive page of a linkage file that follows its changes.

    Pull at points and numbers of the page, which this machine serves, and save them to the file.

    MECHANISM is the path of a .toml file.

    The page is built anew when the file changes in an editor. The file is written only by a click on the page.

    In Python ``opens`` says whether a browser is opened. Raises LinkproofError for an installed linkage, and where
    there is no browser to open.
    """
    from reports import watch

    watch.watch(mechanism, motion, opens=opens)


study_command(app, "watch", watch)
study_command(app, "engines", trials.engines, "json quiet")
study_command(
    app, "compare", trials.compare, "json quiet verbose", study="reports.studies.trials:Comparison",
    save="Write every record (.json) or every curve (.csv); repeatable.",
)  # fmt: skip
study_command(
    app, "judge", designer.judge, "out json quiet verbose", study="reports.studies.judged:Judgement",
    save="Draw the worst curves and the differences (.svg .png .pdf), or write the verdicts (.json); repeatable.",
)  # fmt: skip
study_command(app, "bench", trials.bench, "json quiet verbose")
study_command(app, "stress", trials.stress, "json quiet verbose")
study_command(
    app, "sweep", designer.sweep, "json quiet", study="reports.designs.sweep:DesignSweep",
    save="Write every design (.csv .nc), a picture (.svg .png .pdf) or the summary (.json); repeatable.",
)  # fmt: skip
study_command(
    app, "optimise", designer.optimise, "json quiet", study="reports.designs.optimise:Optimisation",
    save="Write the new linkage (.toml), the curves (.svg .png .pdf) or the results (.json); repeatable.",
)  # fmt: skip
study_command(
    app, "tolerance", designer.tolerance, "json quiet", study="reports.designs.tolerance:Tolerance",
    save="Write a row per result and number (.csv .json) or a picture (.svg .png .pdf); repeatable.",
)  # fmt: skip
