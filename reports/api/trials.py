"""What someone who writes or chooses an engine asks: signatures are the options of the command line."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from analytic.errors import LinkproofError, shortened
from reports.api.options import Argument, Option, checked

if TYPE_CHECKING:
    from engines.contract import Engine
    from reports.document.study import Study
    from reports.studies.engines import EngineFindings


@checked
def engines(
    names: Annotated[Sequence[str], Argument("ENGINE", "engines")] = (),
    *,
    checks: Annotated[
        bool,
        Option(
            "Test the adapter of one engine: signs, frames, units, instants, failures as values, deliberate errors.",
            flags=("--check",),
        ),
    ] = False,
    tries: Annotated[
        bool,
        Option("Show what is installed, and try every engine and the compiler, for a bug report.", flags=("--try",)),
    ] = False,
) -> "Study":
    """List the engines: supported linkages, available quantities, and the origin of each figure in the engine.

    ENGINE is an engine of linkproof, or an adapter announced under the entry-point group linkproof.engines.

    Exit codes: 0; 1 a check failed, or something that is installed does not work; 2 nothing to check.
    """
    if checks and tries:
        raise LinkproofError("--check and --try exclude each other: leave one of them out")
    if tries and names:
        raise LinkproofError("--try tries everything that is installed: leave the names of engines out")
    if checks and len(names) != 1:
        raise LinkproofError(f"--check tests one engine, got {len(names)}: linkproof engines NAME --check")
    if checks:
        return check_engine(names[0])
    if tries:
        start_workers("comparisons.trials.campaign.campaign")
    from reports.studies.engines import listed_engines, tried_engines

    return tried_engines() if tries else listed_engines(names)


def check_engine(engine: "Engine | str", jobs: int | None = None) -> "EngineFindings":
    """The results of every check of an adapter, given by its name or as an object, in ``jobs`` worker processes.

    Raises LinkproofError if there is nothing to check, or if the adapter cannot be loaded.
    """
    start_workers("comparisons.trials.conformance.conformance")
    from comparisons.trials.runs.plugins import engine as registered
    from comparisons.trials.runs.run_engine import AdapterError
    from reports.studies.engine_trials import engine_findings
    from reports.studies.engines import EngineFindings

    if not isinstance(engine, str) and not hasattr(engine, "run"):
        raise LinkproofError(f"expected the name of an engine, or an adapter, got {shortened(repr(engine))}: give one")
    try:
        adapter = registered(engine) if isinstance(engine, str) else engine
        return EngineFindings(adapter.name, adapter.version() or "", engine_findings(adapter, jobs))
    except AdapterError as error:
        raise LinkproofError(f"expected an adapter that can be loaded, but {error}; correct it") from error


def start_workers(module: str) -> None:
    """Start the process that forks workers, which imports a module while this process imports the rest."""
    from comparisons.trials.runs.workers import most_processes

    if most_processes():
        from comparisons.trials.runs.worker_process import start_server

        start_server([module])
