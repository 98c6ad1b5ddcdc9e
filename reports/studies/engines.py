"""The engines: what each can do, how an adapter fares in every check, what is installed and works."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from comparisons.trials.conformance.trial import CheckResult, Finding
from comparisons.trials.runs.environment import environment
from comparisons.trials.runs.plugins import engines as registered
from engines.contract import Engine, Setting
from engines.registry import Unusable, engine_names, why_unavailable
from reports.designs.shelves import Listing
from reports.document.parts import Paragraph, Table, TableCell
from reports.document.study import Study
from reports.document.terminal import Printed, Printout
from reports.records import printout, readout_table
from reports.studies.engine_trials import SelfTest, engine_trials, machine_code_trial, optional_packages, places

REPORT = (
    "With a bug report, send the output of `linkproof engines --try`, the linkage file, the command and what it "
    "printed. If an engine failed, run the command again with LINKPROOF_WORKER_OUTPUT=1 before it."
)


def listed_engines(names: Sequence[str]) -> Listing:
    """The abilities and read-outs of these engines, or of all, as a listing."""
    tables = [_describe_engine(adapter) for adapter in registered(names or engine_names())]
    return Listing([part for table in tables for part in _engine_parts(table)], {"records": tables})


def _describe_engine(adapter: Engine) -> dict[str, Any]:
    """The abilities and read-outs of an engine, and the reason if it cannot be used here; JSON-ready."""
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
    """Names of types, sorted."""
    return sorted(entry.__name__ for entry in types)


def _engine_parts(table: Mapping[str, Any]) -> list[Printed]:
    """The printed parts of one engine: name and version, abilities, read-outs."""
    version = table["unusable"] or table["version"]
    control = ", the reference's control, no engine" if table["control"] else ""
    kinds = ("drives", "joints", "loads", "settings")
    return [
        Paragraph(f"{table['engine']} ({version}{control})", colour="bold"),
        *(f"  {kind}: {', '.join(table[kind])}" for kind in kinds),
        readout_table(table["engine"], table["readouts"]),
        "",
    ]


@dataclass(frozen=True, repr=False)
class EngineFindings(Study):
    """The results of every check of an adapter, ``checks``; each has a ``check``, a ``finding`` and a ``detail``."""

    engine: str
    version: str
    checks: Sequence[CheckResult]

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code: 1 if a check failed, else 0."""
        return 1 if any(each.finding is Finding.FAILED for each in self.checks) else 0

    def printout(self) -> Printout:
        """The printed findings, a line for every check."""
        return printout(self.engine, self.checks)

    def to_dict(self) -> Mapping[str, Any]:
        """The checks and the engine's version, JSON-ready."""
        return {"engine": self.engine, "version": self.version, "checks": self.rows()}

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """The checks as rows, JSON-ready."""
        return [asdict(each) for each in self.checks]

    def failures(self) -> Sequence[str]:
        """A line for every check that failed."""
        return [f"{each.check}: {each.detail}" for each in self.checks if each.finding is Finding.FAILED]


def tried_engines() -> Listing:
    """A trial of every engine and of the compiler, with the facts that a bug report needs, as a Listing.

    Its exit code is 1 if anything installed does not work.
    """
    facts, tried, packages = environment(), engine_trials(), optional_packages()
    compiler, where = machine_code_trial(), places()
    trials = [*tried, compiler]
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
    table = {
        "environment": facts,
        "trials": [asdict(trial) for trial in trials],
        "packages": [asdict(package) for package in packages],
        "places": where,
    }
    return Listing(tables, table, [Paragraph(REPORT)], 1 if any(trial.works is False for trial in trials) else 0)


def _trials_table(trials: Sequence[SelfTest], head: str) -> Table:
    """A table of trials: name, version, sign and detail; ``head`` heads the names."""
    marks = {True: TableCell("✓", colour="green"), False: TableCell("✗", colour="red"), None: TableCell("–")}
    rows = [(trial.name, trial.version or "–", marks[trial.works], trial.detail) for trial in trials]
    return Table("", (head, "version", "", ""), rows, "l")
