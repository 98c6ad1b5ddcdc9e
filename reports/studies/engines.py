"""The engines: what each can do, how an adapter fares in every check, what is installed and works."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib import metadata
from typing import Any, Final

import numpy as np

from analytic import machine_code
from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import catalogue, load
from analytic.errors import LinkproofError, install_words, shortened
from analytic.machine_code import Result
from analytic.operations import OperationList
from comparisons.trials.campaign.campaign import CampaignRequest, compare
from comparisons.trials.conformance.conformance import INSTALLED, check_engine
from comparisons.trials.conformance.trial import CheckResult, Finding
from comparisons.trials.judging.records import RunRecord
from comparisons.trials.runs.environment import environment
from comparisons.trials.runs.plugins import engines as registered
from comparisons.trials.runs.run_engine import AdapterError, blamed_on
from engines.contract import Engine, Setting
from engines.registry import Unusable, engine_names, why_unavailable
from reports.designs.shelves import Listing
from reports.document.parts import Paragraph, Table, TableCell
from reports.document.study import Study
from reports.document.terminal import Printed, Printout
from reports.records import printout, readout_table

OPTIONAL: Final = re.compile(r"""^([\w.-]+).*;\s*extra\s*==\s*["']([\w-]+)["']""")
SPEED: Final = 1000.0 * RPM
NOT_FOR_USERS: Final = {"dev", "docs", "all"}  # extras
REPORT = (
    "With a bug report, send the output of `linkproof engines --try`, the linkage file, the command and what it "
    "printed. If an engine failed, run the command again with LINKPROOF_WORKER_OUTPUT=1 before it."
)


def listed_engines(names: Sequence[str]) -> Listing:
    """The abilities and read-outs of these engines, or of all, as a listing.

    Raises UnknownNameError for another name.
    """
    tables = [_describe_engine(adapter) for adapter in registered(names or engine_names())]
    return Listing([part for table in tables for part in _engine_parts(table)], {"records": tables})


def _describe_engine(adapter: Engine) -> dict[str, Any]:
    """The name, version, abilities and read-outs of an engine, JSON-ready; "unusable" is why it cannot be used here.

    That is "" if it can.
    """
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
    """The printed parts of one engine, as ``_describe_engine`` has it: name and version, abilities, read-outs."""
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
    """The results of every check of an adapter, ``checks``; each has a ``check``, a ``finding`` and a ``detail``.

    ``version`` is the engine's, "" if it states none.
    """

    engine: str
    version: str
    checks: Sequence[CheckResult]

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code: 1 if a check failed, else 0."""
        return 1 if any(each.finding is Finding.FAILED for each in self.checks) else 0

    def printout(self) -> Printout:
        """The printed findings, a line for every check, and a closing line with their counts."""
        return printout(self.engine, self.checks)

    def to_dict(self) -> Mapping[str, Any]:
        """The engine's name and version and the checks, JSON-ready."""
        return {"engine": self.engine, "version": self.version, "checks": self.rows()}

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """The checks as rows, a dict of ``check``, ``finding`` and ``detail`` each, JSON-ready."""
        return [asdict(each) for each in self.checks]

    def failures(self) -> Sequence[str]:
        """A line for every check that failed: its name and why."""
        return [f"{each.check}: {each.detail}" for each in self.checks if each.finding is Finding.FAILED]


def engine_findings(engine: Engine | str, processes: int | None = None) -> EngineFindings:
    """The results of every check of an adapter, given by its name or as an object, in worker ``processes``.

    By default there is one per core. Raises LinkproofError if there is nothing to check, or if the adapter cannot be
    loaded, UnknownNameError for an unknown name.
    """
    if not isinstance(engine, str) and not hasattr(engine, "run"):
        raise LinkproofError(f"expected the name of an engine, or an adapter, got {shortened(repr(engine))}: give one")
    try:
        adapter = registered([engine])[0] if isinstance(engine, str) else engine
        if isinstance(adapter, Unusable):
            with blamed_on(adapter):
                raise adapter.error
        checks = check_engine(adapter, processes)
    except AdapterError as error:
        raise LinkproofError(f"expected an adapter that can be loaded, but {error}; correct it") from error
    for each in checks:
        if each.check == INSTALLED and each.finding is Finding.NOT_TESTED:
            raise LinkproofError(f"expected an engine to check, got none: {each.detail}")
    return EngineFindings(adapter.name, adapter.version() or "", checks)


# What ``engines --try`` does: it tries installed packages, engines and compiler.


@dataclass(frozen=True)
class SelfTest:
    """A test of an engine or a package: whether it ``works``, None if it is not installed, with a ``detail``."""

    name: str
    version: str
    works: bool | None
    detail: str


def engine_trials() -> list[SelfTest]:
    """How a short run of every engine ended, the run-up of one of the catalogue's linkages, in worker processes.

    Those that are not installed are there too; the order is that of the list of engines.
    """
    reasons = {adapter.name: why_unavailable(adapter) for adapter in registered(engine_names())}
    trial = CampaignRequest(
        (load(catalogue()[0]),),
        (crank_motion("run-up", speed=SPEED, ramp_time=0.6, hold_time=0.1),),
        "",
        tuple(name for name, reason in reasons.items() if reason is None),
        quantities=("Mkr",),
        with_invariants=False,
    )
    tried = {run.engine: _trial_of_run(run) for run in compare(trial)}
    absent = {name: SelfTest(name, "", None, reason) for name, reason in reasons.items() if reason is not None}
    return [(absent | tried)[name] for name in engine_names()]


def _trial_of_run(run: RunRecord) -> SelfTest:
    """An engine's short run as a SelfTest: it works if its torque, the run's only quantity, could be compared."""
    (torque,) = run.errors
    if torque.error_max is None:
        return SelfTest(run.engine, run.engine_version, False, f"{torque.outcome}: {torque.detail}")
    detail = f"simulates; error of the torque {torque.error_max:.1e} of its peak, {run.total_seconds:.2g} s"
    return SelfTest(run.engine, run.engine_version, True, detail)


def machine_code_trial() -> SelfTest:
    """Whether Numba compiles a function of one operation, as a SelfTest, which says so where it is not installed.

    No error of the compiler is raised: its text is the detail.
    """
    if not machine_code.is_installed():
        return SelfTest("machine code", "", None, f"numba is not installed: {install_words('compiled')}")
    trace, begin = OperationList(), time.perf_counter()
    number = trace.input("number")
    line = trace.line(number + 1.0)
    version = metadata.version("numba")
    try:
        function = machine_code.StraightFunction(trace, [number.line], [], [Result(line)])
        (result,) = function([1.0], np.zeros((1, 0)), 1)
    except Exception as error:  # whatever a broken compiler raises
        return SelfTest("machine code", version, False, " ".join(f"{type(error).__name__}: {error}".split()))
    return SelfTest("machine code", version, bool(result == 2.0), f"compiles, {time.perf_counter() - begin:.2g} s")


def optional_packages() -> list[SelfTest]:
    """Packages of the extras, each as a SelfTest with its version, or the command that installs it.

    Extras of engines and those of development are left out.
    """
    matches = [match for each in metadata.requires("linkproof") or () if (match := OPTIONAL.match(each))]
    named = {package: extra for package, extra in (match.groups() for match in matches) if extra not in NOT_FOR_USERS}
    return [_package_trial(package, extra) for package, extra in named.items() if extra not in engine_names()]


def _package_trial(package: str, extra: str) -> SelfTest:
    """A package's version, or, if it is not installed, the command that installs its extra, as a SelfTest."""
    try:
        return SelfTest(package, metadata.version(package), True, f"extra '{extra}'")
    except metadata.PackageNotFoundError:
        return SelfTest(package, "", None, f"{install_words(extra)} installs it")


def tried_engines() -> Listing:
    """A trial of every engine and of the compiler, with the facts that a bug report needs, as a Listing.

    Its exit code is 1 if anything installed does not work.
    """
    facts, packages = environment(), optional_packages()
    trials = [*engine_trials(), machine_code_trial()]
    tables: list[Printed] = [
        ", ".join(f"{name} {facts[name]}" for name in ("linkproof", "python", "numpy", "scipy") if name in facts),
        f"{facts['machine']}; commit {facts['commit']}",
        "",
        _trials_table(trials, "engine"),
        "",
        _trials_table(packages, "package"),
        "",
    ]
    table = {
        "environment": facts,
        "trials": [asdict(trial) for trial in trials],
        "packages": [asdict(package) for package in packages],
    }
    return Listing(tables, table, [Paragraph(REPORT)], 1 if any(trial.works is False for trial in trials) else 0)


def _trials_table(trials: Sequence[SelfTest], head: str) -> Table:
    """A table of trials: name, version, sign and detail; ``head`` heads the names."""
    marks = {True: TableCell("✓", colour="green"), False: TableCell("✗", colour="red"), None: TableCell("–")}
    rows = [(trial.name, trial.version or "–", marks[trial.works], trial.detail) for trial in trials]
    return Table("", (head, "version", "", ""), rows, "l")
