"""``linkproof.compare``: engines compared with the closed form, and results that print as their commands print them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.trials.campaign.results import Results, with_runs
from comparisons.trials.campaign.standard import JudgedCampaign
from comparisons.trials.judging.changes import Change, write_rows
from comparisons.trials.judging.limits import deciding
from comparisons.trials.judging.records import Error, Verdict
from reports.api import PASSED
from reports.api.campaign import Campaign, campaign
from reports.api.exit_codes import campaign_exit_code
from reports.api.options import CompareOptions, RunLimits, StandardOptions
from reports.campaign.terminal import printout
from reports.document.study import Study
from reports.document.terminal import Printout
from reports.python.keywords import with_keywords

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Named = TypeVar("Named")
RUN = ("mechanism", "variant", "regime", "engine", "setting")


def failed_rows(records: Iterable[Error]) -> list[str]:
    """A line for each record, with its outcome and the reason: what ``check`` of a result raises."""
    return [
        f"{record.mechanism} ({record.variant}), {record.regime}, {record.engine} {record.setting}, {record.quantity}: "
        f"{record.outcome}, {record.detail}"
        for record in records
    ]


@dataclass(frozen=True, repr=False)
class Comparison(Study):
    """The result of a comparison: a record per run, quantity and check, and the changes since earlier results.

    ``repr`` is a line, ``str`` and a notebook have what the command prints, ``to_pandas`` has a row for each record.
    """

    judged: JudgedCampaign
    campaign: Campaign

    @property
    def records(self) -> tuple[Error, ...]:
        """Errors beside their limits, and invariants."""
        return tuple(self.judged.records)

    @property
    def changes(self) -> tuple[Change, ...]:
        """What has changed since the results of ``against`` were recorded; those that appeared do not fail."""
        return self.judged.changes

    @property
    def command(self) -> str:
        """The command that repeats it."""
        return self.campaign.saved_command

    def plot(self, mechanism: str | None = None, regime: str | None = None) -> Figure:
        """Every error and limit of a mechanism under a regime, the first ones by default, as a figure of matplotlib.

        Raises UnknownNameError for a name that was not compared.
        """
        from reports.charts.draw import figure  # noqa: PLC0415
        from reports.mechanism.engines import errors_chart  # noqa: PLC0415
        from reports.records import views  # noqa: PLC0415

        results = Results(self.campaign.document(self.judged), tuple(self.judged.runs))
        seen = {view.linkage.name: view for view in views(results)}
        view = _value_by_name("mechanism", mechanism, seen)
        return figure(
            errors_chart(view, _value_by_name("regime", regime, {motion.name: motion for motion in view.regimes}))
        )

    def printout(self) -> Printout:
        """The output of the command."""
        return printout(self.judged.runs, self.changes, self.campaign.environment)

    def to_dict(self) -> Mapping[str, Any]:
        """What the command prints as JSON."""
        return with_runs(self.campaign.document(self.judged), self.judged.runs)

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """A row for each record."""
        return [row for run in self.judged.runs for row in run.rows(run.every)]

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """That of the command; raises LinkproofError if nothing could be judged."""
        return campaign_exit_code(self.records, changes=self.changes)

    @property
    def passed(self) -> bool:
        """Whether the command would exit with 0; raises LinkproofError if nothing could be judged."""
        return self.exit_code == PASSED

    def check(self) -> Comparison:
        """The comparison itself if it has passed; a test is ``linkproof.compare("press.toml").check()``.

        Raises AssertionError with a line for every error over its limit, every failed run and every result that is
        not as it was recorded, and LinkproofError if nothing could be judged.
        """
        __tracebackhide__ = True  # pytest shows the line of the test
        if self.passed:
            return self
        ours = [record for record in self.records if record.outcome == Verdict.SUITE_ERROR]
        failed = [record for record in deciding(self.records) if Verdict(record.outcome).failed]
        rows = failed_rows([*failed, *ours])
        changed = [entry.sentence for entry in self.changes if entry.fails]
        head = f"{len(rows)} of {len(self.records)} errors and checks failed"
        raise AssertionError("\n".join((head, *rows, *changed)))

    @property
    def table(self) -> xarray.Dataset:
        """The records over ``run`` and ``quantity``: errors and limits as shares of the peak, NaN where there is none.

        ``mechanism``, ``variant``, ``regime``, ``engine`` and ``setting`` stand along ``run``, with
        ``setup_seconds``, ``seconds`` of stepping and ``steps`` of each.
        """
        import xarray  # noqa: PLC0415  half a second that records alone save

        runs = {run.run: run for run in self.judged.runs}
        quantities = list(dict.fromkeys(record.quantity for record in self.records))
        places = {(record.run, record.quantity): record for record in self.records}

        def cells(field: str, lacking: float | str) -> tuple[tuple[str, str], list[list[Any]]]:
            groups = [[getattr(places.get((run, name)), field, None) for name in quantities] for run in runs]
            return ("run", "quantity"), [[lacking if cell is None else cell for cell in row] for row in groups]

        labels = {name: ("run", [run[number] for run in runs]) for number, name in enumerate(RUN)}
        return xarray.Dataset(
            {
                **{name: (*cells(name, math.nan), {"units": "1"}) for name in ("error_max", "error_rms", "limit")},
                "outcome": cells("outcome", ""),
                **{
                    name: ("run", [getattr(run, name) for run in runs.values()], {"units": "s"})
                    for name in ("setup_seconds", "seconds")
                },
                "steps": ("run", [run.steps for run in runs.values()]),
            },
            coords={"quantity": quantities, **labels},
        )


@with_keywords()
def compare(
    *mechanisms: str | Path, options: CompareOptions, standard: StandardOptions, limits: RunLimits
) -> Comparison:
    """Simulate mechanisms in engines and compare every error with its limit, as ``linkproof compare`` does.

    Mechanisms are names of the catalogue and paths of files; ``time_limit`` is in s and ``memory_limit`` in GiB.
    Raises LinkproofError for bad input; a run that fails is a record.
    """
    for mechanism in mechanisms:
        if not isinstance(mechanism, (str, Path)):
            raise LinkproofError(
                f"expected names and paths of linkages, got a {type(mechanism).__name__}: give its file, since "
                "limits and recorded results belong to files"
            )
    wanted = campaign(replace(options, mechanisms=tuple(map(str, mechanisms))), standard, limits)
    result = Comparison(wanted.compared(wanted.resources.pool), wanted)
    if standard.record is not None:
        write_rows(result.judged.rows, standard.record)
    return result


def _value_by_name(what: str, name: str | None, known: Mapping[str, Named]) -> Named:
    """The value of a name, or the first value if ``name`` is None; raises UnknownNameError."""
    if name is not None and name not in known:
        raise UnknownNameError(what, name, known)
    return known[name] if name is not None else next(iter(known.values()))
