"""``linkproof engines``, and ``compare --script``: list, check or try engines; write a run as an engine's script."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analytic.errors import LinkproofError
from comparisons.trials.campaign.campaign import each_case
from comparisons.trials.conformance.trial import Finding
from comparisons.trials.exported_run import exported
from comparisons.trials.runs.environment import environment
from comparisons.trials.runs.files import check_writable, write_file
from comparisons.trials.runs.plugins import engine
from comparisons.trials.runs.plugins import engines as registered
from engines.contract import Engine, Setting
from engines.registry import Unusable, engine_names, why_unavailable
from reports.api import FAILED, PASSED
from reports.api.campaign import request
from reports.api.engine_trials import (
    SelfTest,
    engine_findings,
    engine_trials,
    machine_code_trial,
    optional_packages,
    places,
)
from reports.api.options import CompareOptions, command_line
from reports.command_line.destination import Destination
from reports.document.parts import Paragraph, Table, TableCell
from reports.document.terminal import Printed, Printout
from reports.records import printout, readout_table

REPORT = (
    "With a bug report, send the output of `linkproof engines --try`, the linkage file, the command and what it "
    "printed. If an engine failed, run the command again with LINKPROOF_WORKER_OUTPUT=1 before it."
)


def engines(names: Sequence[str], destination: Destination, *, checks: bool = False, tries: bool = False) -> int:
    """List, check or try engines; returns the exit code. Raises LinkproofError for words that do not go together."""
    if checks and tries:
        raise LinkproofError("--check and --try exclude each other: leave one of them out")
    if tries and names:
        raise LinkproofError("--try tries everything that is installed: leave the names of engines out")
    if checks and len(names) != 1:
        raise LinkproofError(f"--check tests one engine, got {len(names)}: linkproof engines NAME --check")
    if checks:
        return check(names[0], destination)
    return try_all(destination) if tries else _list(names, destination)


def _list(names: Sequence[str], destination: Destination) -> int:
    """Print the abilities and read-outs of these engines, of all by default."""
    tables = [_describe_engine(adapter) for adapter in registered(names or engine_names())]
    destination.print_out(Printout([part for table in tables for part in _engine_parts(table)], (), ()))
    destination.write_json({"records": tables})
    return PASSED


def _describe_engine(adapter: Engine) -> dict[str, Any]:
    """The abilities and read-outs of an engine, and the reason if it cannot be used here."""
    error = adapter.error if isinstance(adapter, Unusable) else None
    reason = why_unavailable(adapter) if error is None else str(error)
    able = adapter.abilities
    return {
        "engine": adapter.name,
        "version": adapter.version(),
        "control": adapter.is_control,
        "drives": _type_names(able.drives),
        "joints": ["PinJoint", *_type_names(able.joints)],
        "loads": ["gravity", *_type_names(able.loads)],
        "varying_loads": able.varying_loads,
        "load_states": able.load_states,
        "massless_bodies": able.massless,
        "settings": [setting.value for setting in Setting if setting in able.settings],
        "readouts": able.as_dict(),
        "unusable": reason or "",
    }


def _type_names(types: Iterable[type]) -> list[str]:
    return sorted(entry.__name__ for entry in types)


def _engine_parts(table: Mapping[str, Any]) -> list[Printed]:
    """What is printed of one engine: its name and version, its abilities, its read-outs."""
    version = table["unusable"] or table["version"]
    control = ", the reference's control, no engine" if table["control"] else ""
    kinds = ("drives", "joints", "loads", "settings")
    return [
        Paragraph(f"{table['engine']} ({version}{control})", colour="bold"),
        *(f"  {kind}: {', '.join(table[kind])}" for kind in kinds),
        readout_table(table["engine"], table["readouts"]),
        "",
    ]


def check(name: str, destination: Destination, processes: int | None = None) -> int:
    """Make every check of an engine, print a line for each; returns the exit code. Raises as ``engine_findings``."""
    adapter = engine(name)
    results = engine_findings(adapter, processes)
    destination.write_json({"engine": name, "version": adapter.version(), "checks": [asdict(each) for each in results]})
    destination.print_out(printout(name, results))
    return FAILED if any(each.finding is Finding.FAILED for each in results) else PASSED


def try_all(destination: Destination) -> int:
    """Try every engine and the compiler, print the results and what a bug report needs; returns the exit code."""
    facts, tried, packages = environment(), engine_trials(), optional_packages()
    compiler, where = machine_code_trial(), places()
    trials = [*tried, compiler]
    destination.write_json(
        {
            "environment": facts,
            "trials": [asdict(trial) for trial in trials],
            "packages": [asdict(package) for package in packages],
            "places": where,
        }
    )
    tables: list[Printed] = [
        ", ".join(f"{name} {facts[name]}" for name in ("linkproof", "python", "numpy", "scipy") if name in facts),
        f"{facts['machine']}; commit {facts['commit']}",
        "",
        _trials_table(trials, "engine"),
        "",
        _trials_table(packages, "package"),
        "",
        *(f"{name}: {place}" for name, place in where.items()),
        "",
    ]
    destination.print_out(Printout(tables, [Paragraph(REPORT)], ()))
    return FAILED if any(trial.works is False for trial in trials) else PASSED


def _trials_table(trials: Sequence[SelfTest], head: str) -> Table:
    marks = {True: TableCell("✓", colour="green"), False: TableCell("✗", colour="red"), None: TableCell("–")}
    rows = [(trial.name, trial.version or "–", marks[trial.works], trial.detail) for trial in trials]
    return Table("", (head, "version", "", ""), rows, "l")


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
