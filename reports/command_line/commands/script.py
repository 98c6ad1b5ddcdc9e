"""``linkproof compare --script``: a run as a script of its engine."""

from __future__ import annotations

import shlex
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.trials.campaign.campaign import each_case
from comparisons.trials.exported_run import exported
from comparisons.trials.runs.files import check_writable, write_file
from reports.api.campaign import request
from reports.api.options import CompareOptions, command_line


def write_script(file: Path, options: CompareOptions, others: tuple[object, ...] = ()) -> None:
    """Write the run of one mechanism in one engine, setting and motion; ``others`` are options that runs alone have.

    Raises LinkproofError for several runs, for a run that cannot be exported, and for ``others`` that are given.
    """
    if options.quantity or options.full or any(given != type(given)() for given in others):
        raise LinkproofError(
            "--script runs nothing: leave out every option but those of the engine, setting and motion"
        )
    check_writable(file)
    if (len(options.mechanisms), len(options.engine)) != (1, 1):
        raise LinkproofError(
            f"--script writes one run, got {len(options.mechanisms)} mechanisms and {len(options.engine)} engines: "
            "name one MECHANISM and one --engine"
        )
    wanted = request(options)
    chosen, settings = list(each_case(wanted)), wanted.settings
    if len(chosen) != 1 or len(settings) != 1:
        raise LinkproofError(
            f"--script writes one run, got {len(chosen)} motions and {len(settings)} settings: name one --regime and "
            "one --setting"
        )
    command = f"{command_line('compare', options)} --script {shlex.quote(str(file))}"
    write_file(file, exported(chosen[0], options.engine[0], settings[0], command))
