"""What ``engines --try`` and ``--check`` do: try installed packages, engines and compiler; check an adapter."""

from __future__ import annotations

import re
import tempfile
import time
from dataclasses import dataclass
from importlib import metadata
from typing import Final

import numpy as np

from analytic import machine_code
from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import catalogue, load
from analytic.errors import LinkproofError, install_words
from analytic.machine_code import Result
from analytic.operations import OperationList
from comparisons.trials.campaign.campaign import CampaignRequest, compare
from comparisons.trials.conformance.conformance import INSTALLED, check_engine
from comparisons.trials.conformance.trial import CheckResult, Finding
from comparisons.trials.judging.records import RunRecord
from comparisons.trials.runs.plugins import engines
from comparisons.trials.runs.run_engine import blamed_on
from engines.contract import Engine
from engines.registry import Unusable, engine_names, why_unavailable

OPTIONAL: Final = re.compile(r"""^([\w.-]+).*;\s*extra\s*==\s*["']([\w-]+)["']""")
SPEED: Final = 1000.0 * RPM
NOT_FOR_USERS: Final = {"dev", "docs", "all"}  # extras


@dataclass(frozen=True)
class SelfTest:
    """A test of an engine or a package: whether it ``works``, None if it is not installed, with a ``detail``."""

    name: str
    version: str
    works: bool | None
    detail: str


def engine_trials() -> list[SelfTest]:
    """How a short run of every engine ended, the run-up of one of the catalogue's linkages, in worker processes.

    Those that are not installed are there too.
    """
    reasons = {adapter.name: why_unavailable(adapter) for adapter in engines(engine_names())}
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
    """An engine's short run as a SelfTest: it works if the torque has an error."""
    (torque,) = run.errors
    if torque.error_max is None:
        return SelfTest(run.engine, run.engine_version, False, f"{torque.outcome}: {torque.detail}")
    detail = f"simulates; error of the torque {torque.error_max:.1e} of its peak, {run.total_seconds:.2g} s"
    return SelfTest(run.engine, run.engine_version, True, detail)


def machine_code_trial() -> SelfTest:
    """Whether Numba compiles a function of one operation, as a SelfTest, which says so where it is not installed."""
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
    """Packages of the extras except engines, each as a SelfTest with its version, or the command that installs it."""
    matches = [match for each in metadata.requires("linkproof") or () if (match := OPTIONAL.match(each))]
    named = {package: extra for package, extra in (match.groups() for match in matches) if extra not in NOT_FOR_USERS}
    return [_package_trial(package, extra) for package, extra in named.items() if extra not in engine_names()]


def _package_trial(package: str, extra: str) -> SelfTest:
    """A package's version, or the command that installs its extra, as a SelfTest."""
    try:
        return SelfTest(package, metadata.version(package), True, f"extra '{extra}'")
    except metadata.PackageNotFoundError:
        return SelfTest(package, "", None, f"{install_words(extra)} installs it")


def places() -> dict[str, str]:
    """Folders that are read or written without being named by the user, by what they are, in words."""
    import matplotlib as mpl  # noqa: PLC0415 - slow to import

    return {
        "temporary files": tempfile.gettempdir(),
        "matplotlib's cache": mpl.get_cachedir(),
    }


# Every check of an engine's adapter.


def engine_findings(adapter: Engine, processes: int | None = None) -> list[CheckResult]:
    """The results of every check of an engine, made in ``processes`` worker processes.

    Raises LinkproofError if nothing can be checked, AdapterError for an engine that cannot be loaded.
    """
    if isinstance(adapter, Unusable):
        with blamed_on(adapter):
            raise adapter.error
    results = check_engine(adapter, processes)
    absent = next(
        (each.detail for each in results if each.check == INSTALLED and each.finding is Finding.NOT_TESTED), None
    )
    if absent is not None:
        raise LinkproofError(f"expected an engine to check, got none: {absent}")
    return results
