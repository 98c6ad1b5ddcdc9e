"""Runs of engines: a comparison with the closed form, a benchmark, stability maps; each kept in a folder as well."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.designer.linkage_check import warnings
from comparisons.trials.campaign import results as campaign
from comparisons.trials.campaign.results import CampaignResults, with_runs, write_curves
from comparisons.trials.judging.changes import Change, write_rows
from comparisons.trials.judging.limits import deciding
from comparisons.trials.judging.records import Error, Verdict
from comparisons.trials.runs.files import write_file
from comparisons.trials.runs.run_engine import Failure
from comparisons.trials.stress import campaign as stress_test
from comparisons.trials.stress.campaign import Stress
from comparisons.trials.stress.cells import StressVerdict
from comparisons.trials.work_precision import table as work_precision
from comparisons.trials.work_precision.study import OUT_OF_TIME, USUAL_QUANTITIES
from comparisons.trials.work_precision.table import Bench
from engines.contract import Outcome
from reports import FAILED, PASSED, SUITE_ERROR
from reports import bench as bench_words
from reports import stress as stress_words
from reports.campaign.terminal import printout
from reports.document.study import Content, Study, check_file
from reports.document.terminal import Printed, Printout
from reports.studies.judged import failed_rows

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

Named = TypeVar("Named")
RUN = ("mechanism", "variant", "regime", "engine", "setting")


@dataclass(frozen=True, repr=False)
class Trials(Study):
    """The ``results`` of runs of engines; ``folder`` keeps them already if it is not None.

    ``processes`` write the pages, one per core for None; ``remark`` is for stderr, ``written`` are files made beside.
    """

    module: ClassVar[ModuleType]  # of comparisons, with ``load`` and ``save``
    results: Any
    folder: Path | None = None
    processes: int | None = None
    remark: str = ""
    written: tuple[Path, ...] = ()

    @classmethod
    def load(cls, folder: str | Path) -> Self:
        """The study in a folder, with that as its ``folder``; no engine is imported.

        Raises LinkproofError if it is missing or damaged.
        """
        return cls(cls.module.load(Path(folder)), Path(folder))

    def store(self, folder: Path) -> None:
        """Write the study into a folder, replacing one of its kind.

        Raises LinkproofError where it cannot be written.
        """
        self.module.save(folder, self.results)

    def write(self, folder: str | Path) -> Path:
        """Write runs, unless ``folder`` keeps them already, and pages; returns the first page's path.

        Raises LinkproofError where they cannot be written.
        """
        from reports.site import write_site  # noqa: PLC0415 - figures cost seconds that a table does not pay

        place = Path(folder)
        if place != self.folder:
            self.store(place)
        try:
            return write_site(place, processes=self.processes)
        except LinkproofError as error:
            raise LinkproofError(f"the results are saved in '{place}', but no pages are written: {error}") from error


@dataclass(frozen=True, repr=False)
class Comparison(Trials):
    """The result of a comparison: a record per run, quantity and check, and the changes since earlier results.

    ``repr`` is a line, ``str`` and a notebook have what the command prints, ``to_pandas`` has a row for each record.
    """

    suffixes: ClassVar = (".json", ".csv")
    module: ClassVar[ModuleType] = campaign
    results: CampaignResults

    def store(self, folder: Path) -> None:
        """Write the comparison into a folder, replacing another one, a judgement and a designer's results there.

        Raises LinkproofError where it cannot be written.
        """
        campaign.save(folder, self.results.document, self.results.runs)

    def with_files(self, record: str | Path | None, junit: str | Path | None) -> Comparison:
        """A copy of the comparison that names these files, after writing its rows and its verdicts for JUnit to them.

        None writes none. Raises LinkproofError for a file that cannot be written.
        """
        if record is not None:
            write_rows(self.results.rows, Path(record))
        if junit is not None:
            from reports.campaign.junit import junit as test_cases  # noqa: PLC0415 - a table needs none of it

            write_file(Path(junit), test_cases(self.results.runs, self.changes))
        return replace(self, written=tuple(Path(file) for file in (record, junit) if file is not None))

    @property
    def records(self) -> tuple[Error, ...]:
        """Errors with their limits and verdicts, then invariants."""
        return tuple(error for run in self.results.runs for error in run.every)

    @property
    def changes(self) -> tuple[Change, ...]:
        """The changes since the results of ``against`` were recorded; those that appeared do not fail."""
        return self.results.changes

    @property
    def command(self) -> str:
        """The command that repeats the comparison."""
        return str(self.results.document["command"])

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about probable slips of the linkages' files; [] without any."""
        return [text for linkage in self.results.linkages for text in warnings(linkage)]

    def plot(self, mechanism: str | None = None, regime: str | None = None) -> Figure:
        """Every error over its limit, of a mechanism under a regime, by default the first ones, as a matplotlib figure.

        Raises UnknownNameError for a name that was not compared, StopIteration if nothing was.
        """
        from reports.mechanism.engines import errors_figure  # noqa: PLC0415
        from reports.records import views  # noqa: PLC0415

        view = _value_by_name("mechanism", mechanism, {view.linkage.name: view for view in views(self.results)})
        motions = {motion.name: motion for motion in view.regimes}
        return errors_figure(view, _value_by_name("regime", regime, motions))

    def printout(self) -> Printout:
        """The printed comparison: a table per mechanism, regime and four runs, what has changed, reasons and counts."""
        results = self.results
        return printout(results.runs, results.changes, results.document["environment"])

    def to_dict(self) -> Mapping[str, Any]:
        """The document with all records, JSON-ready; errors are shares of the peak."""
        return with_runs(self.results.document, self.results.runs)

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """A file's content: for .csv a function that writes every curve to a path, else the JSON of every record.

        ``form`` is ignored.
        """
        return partial(write_curves, self.results.runs) if suffix == ".csv" else super().content(suffix, **form)

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """The records as rows, a mapping per record with its run's place, times and steps, JSON-ready."""
        return [row for run in self.results.runs for row in run.rows(run.every)]

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code: 3 for a fault of linkproof, 1 if a deciding record or a change fails, else 0.

        Naive records decide only if alone. Raises LinkproofError if no deciding record is judged, unless the code is 1
        or 3.
        """
        return campaign_exit_code(self.records, self.changes)

    def failures(self) -> Sequence[str]:
        """A count, then a line for every deciding error over its limit, failed run, fault of ours and failed change."""
        ours = [record for record in self.records if record.outcome == Verdict.SUITE_ERROR]
        failed = [record for record in deciding(self.records) if Verdict(record.outcome).failed]
        rows = failed_rows([*failed, *ours])
        changed = [entry.sentence for entry in self.changes if entry.fails]
        return [f"{len(rows)} of {len(self.records)} errors and checks failed", *rows, *changed]

    @property
    def dataset(self) -> xarray.Dataset:
        """The records over ``run`` and ``quantity``: errors and limits as shares of the peak, NaN where there is none.

        ``mechanism``, ``variant``, ``regime``, ``engine`` and ``setting`` stand along ``run``, with
        ``setup_seconds``, ``seconds`` of stepping and ``steps`` of each.
        """
        shares, times = ["error_max", "error_rms", "limit"], ["setup_seconds", "seconds"]
        frame = self.to_pandas().astype(dict.fromkeys(shares, float))
        runs = frame.groupby([*RUN], sort=False)
        cells = frame.assign(run=runs.ngroup()).set_index(["run", "quantity"])[[*shares, "outcome"]].to_xarray()
        of_runs = runs[[*times, "steps"]].first().reset_index().rename_axis("run").to_xarray()
        dataset: xarray.Dataset = cells.fillna({"outcome": ""}).merge(of_runs).set_coords([*RUN]).drop_vars("run")
        for name in (*shares, *times):
            dataset[name].attrs["units"] = "1" if name in shares else "s"
        return dataset


@dataclass(frozen=True, repr=False)
class Script(Comparison):
    """A comparison of which nothing was run: its one run was ``written`` as a script."""

    exit_code: ClassVar[int] = 0  # type: ignore[misc]

    def sentence(self) -> Printed:
        """The sentence that names the file."""
        return f"wrote {self.written[0]}"

    def printout(self) -> Printout:
        """An empty printout, since the command names every file that it writes."""
        return Printout((), ())


def check_files(record: str | Path | None, junit: str | Path | None) -> None:
    """Raise LinkproofError, before any work, for a file of rows, .csv, or for JUnit that could not be written.

    None is none.
    """
    if record is not None:
        check_file("--record", Path(record), (".csv",))
    if junit is not None:
        check_file("--junit", Path(junit))


def _value_by_name(what: str, name: str | None, known: Mapping[str, Named]) -> Named:
    """The value of a name among the ``known``, or the first one for None.

    Raises UnknownNameError for another name, StopIteration for None where nothing is ``known``. ``what`` says in the
    message what it names.
    """
    if name is not None and name not in known:
        raise UnknownNameError(what, name, known)
    return known[name] if name is not None else next(iter(known.values()))


@dataclass(frozen=True, repr=False)
class Benchmark(Trials):
    """Errors against run times of engines: a point per engine, setting or method, and step.

    ``to_pandas`` has a row for every point and quantity. ``linkages`` are those measured; a folder's study has none.
    """

    module: ClassVar[ModuleType] = work_precision
    results: Bench
    linkages: tuple[Linkage, ...] = ()

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about probable slips of the linkages' files; [] without any."""
        return [text for linkage in self.linkages for text in warnings(linkage)]

    def printout(self) -> Printout:
        """The printed benchmark: per mechanism and regime methods, cheapest ways to an error, and settings.

        They are in the quantities that the command named, else in the foremost.
        """
        named = tuple(self.results.document["quantities"])
        return bench_words.printout(self.results, () if named == USUAL_QUANTITIES else named)

    def sentence(self) -> Printed:
        """A sentence on how many points of how many engines were measured."""
        return f"{len(self.results.points)} points of {len({point.engine for point in self.results.points})} engines"

    def to_dict(self) -> Mapping[str, Any]:
        """The document and all points, JSON-ready; times are in s."""
        return self.results.as_dict

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame with a row for every point and quantity; the study's own, no copy."""
        return self.results.table

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code: 3 for a fault of linkproof, 1 if an engine finished no point without an excuse, else 0.

        An excuse is that it is not installed, cannot do what is asked, or was left no time. Raises LinkproofError if
        nothing finished, unless the code is 1 or 3.
        """
        excused = (Outcome.FINISHED, Outcome.UNAVAILABLE, Outcome.UNSUPPORTED, Verdict.NOT_PROVIDED)
        points = list(self.results.table.itertuples())
        useful = {point.engine for point in points if point.outcome in excused or point.detail == OUT_OF_TIME}
        asked = {point.engine for point in points}  # each has one, if only to say that there was no time
        reasons = Counter((point.outcome, point.detail) for point in points)
        is_ours = any(outcome == Failure.SUITE_ERROR for outcome, _ in reasons)
        return _exit_code(is_ours, not useful.issuperset(asked), any(point.finished for point in points), reasons)


@dataclass(frozen=True, repr=False)
class StabilityMaps(Trials):
    """Which conditions each engine stands, and whether the checks detect where it fails; or cells alone.

    With ``are_cells`` it is of single cells, printed in full.
    """

    module: ClassVar[ModuleType] = stress_test
    results: Stress
    are_cells: bool = False

    def printout(self) -> Printout:
        """The printed maps: counts and borders; of single cells every detail."""
        if self.are_cells:
            return Printout([stress_words.cell_details(cell) for cell in self.results.cells], ())
        return stress_words.printout(self.results)

    def sentence(self) -> Printed:
        """A sentence on how many cells came to each verdict."""
        counts = self.results.count().items()
        return f"{len(self.results.cells)} cells: {', '.join(f'{count} {verdict}' for verdict, count in counts)}"

    def to_dict(self) -> Mapping[str, Any]:
        """The document and all cells, JSON-ready; of single cells these alone, under "cells"."""
        return {"cells": self.rows()} if self.are_cells else self.results.as_dict

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """The cells as rows, JSON-ready."""
        return [cell.data for cell in self.results.cells]

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code: 3 for a fault of linkproof, 1 if the checks missed a wrong motion, else 0.

        Raises LinkproofError if nothing was judged: every cell is unsupported or its engine not installed.
        """
        reasons = {cell.verdict: cell.reason for cell in self.results.cells}
        is_judged = not reasons.keys() <= {StressVerdict.UNSUPPORTED, StressVerdict.UNAVAILABLE}
        counts = Counter((verdict.value, reason) for verdict, reason in reasons.items())
        return _exit_code(StressVerdict.SUITE_ERROR in reasons, StressVerdict.MISSED in reasons, is_judged, counts)


def campaign_exit_code(records: Iterable[Error], changes: Iterable[Change] = ()) -> int:
    """The exit code for judged records and changes; naive records count only without other settings.

    Of ``changes`` since results were recorded those that fail count. It is 3 for a fault of linkproof, 1 for a failure,
    else 0. Raises LinkproofError where it would be 0 and no deciding record is judged.
    """
    every = list(records)
    decisive = {Verdict(record.outcome) for record in deciding(every)}
    is_ours = any(record.outcome == Verdict.SUITE_ERROR for record in every)
    has_failed = any(verdict.failed for verdict in decisive) or any(entry.fails for entry in changes)
    reasons = Counter((record.outcome, record.detail) for record in every if not Verdict(record.outcome).judged)
    return _exit_code(is_ours, has_failed, any(verdict.judged for verdict in decisive), reasons)


def _exit_code(is_ours: bool, has_failed: bool, is_judged: bool, counts: Counter[tuple[str, str]]) -> int:
    """The exit code: 3 if a fault ``is_ours``, linkproof's, else 1 if something ``has_failed``, else 0.

    Raises LinkproofError if nothing ``is_judged``. ``counts`` are those of outcomes that are not judged, by outcome and
    reason.
    """
    if is_ours or has_failed:
        return SUITE_ERROR if is_ours else FAILED
    if is_judged:
        return PASSED
    if not counts:
        raise LinkproofError("nothing to run: no regime, map or setting matches the request")
    (outcome, reason), _ = counts.most_common(1)[0]
    others = "" if len(counts) == 1 else f" (and {len(counts) - 1} other reasons)"
    raise LinkproofError(f"expected a run to judge, got none: {outcome}, {reason.rstrip('.')}{others}")
