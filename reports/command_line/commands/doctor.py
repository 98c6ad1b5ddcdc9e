"""``linkproof doctor``: list the installed packages, try engines and compiler, name the data for a bug report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from comparisons.runs.environment import environment
from reports.command_line.destination import Destination
from reports.document.parts import Paragraph, Table, TableCell
from reports.requests import FAILED, PASSED
from reports.requests.doctor import SelfTest, engine_trials, machine_code_trial, optional_packages, places

REPORT = (
    "With a bug report, send the file of `linkproof doctor --json doctor.json`, the linkage file, the command and what "
    "it printed. If an engine failed, run the command again with LINKPROOF_WORKER_OUTPUT=1 before it."
)


def doctor(destination: Destination) -> int:
    """Try every engine and the compiler, print the results; returns the exit code."""
    facts, engines, packages = environment(), engine_trials(), optional_packages()
    compiler, where = machine_code_trial(), places()
    trials = [*engines, compiler]
    destination.write_json(
        {
            "environment": facts,
            "trials": [asdict(trial) for trial in trials],
            "packages": [asdict(package) for package in packages],
            "places": where,
        }
    )
    destination.print(
        ", ".join(f"{name} {facts[name]}" for name in ("linkproof", "python", "numpy", "scipy") if name in facts),
        f"{facts['machine']}; commit {facts['commit']}",
        "",
        _trials_table(trials, "engine"),
        "",
        _trials_table(packages, "package"),
        "",
        *(f"{name}: {place}" for name, place in where.items()),
        "",
        Paragraph(REPORT),
    )
    return FAILED if any(trial.works is False for trial in trials) else PASSED


def _trials_table(trials: Sequence[SelfTest], head: str) -> Table:
    marks = {True: TableCell("✓", colour="green"), False: TableCell("✗", colour="red"), None: TableCell("–")}
    rows = [(trial.name, trial.version or "–", marks[trial.works], trial.detail) for trial in trials]
    return Table("", (head, "version", "", ""), rows, "l")
