"""``linkproof.compare``: engines against the closed form, as the command compares them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from analytic.errors import LinkproofError
from comparisons.campaign.campaign import compare as run_campaign
from comparisons.campaign.key_figures import KeyFigure
from comparisons.campaign.standards import judged_campaign
from comparisons.judging.records import Record
from reports.campaign.terminal import printout
from reports.command_line import PASSED
from reports.command_line.exit_codes import campaign_exit_code
from reports.command_line.requests import CampaignChoice, RunLimits, request
from reports.command_line.standard_choice import StandardChoice, in_project
from reports.document.terminal import Printout
from reports.python.options import MotionOptions, Words, choice, words
from reports.python.printed_result import PrintedResult

if TYPE_CHECKING:
    import xarray
    from distributed import Client

RUN = ("mechanism", "variant", "regime", "engine", "setting")


@dataclass(frozen=True, repr=False)
class Comparison(PrintedResult):
    """The result of a comparison: a record per run, quantity and check, and the key figures with their recorded values.

    ``departures`` name linkages and motions that differ from the baseline, and fail it; ``notes`` cause no failure:
    changes since it was recorded, and permitted differences. ``repr`` is a line, ``str`` and a notebook have what the
    command prints, ``to_pandas`` has a row for each record.
    """

    records: tuple[Record, ...]
    figures: tuple[KeyFigure, ...]
    notes: tuple[str, ...]
    departures: tuple[str, ...] = ()
    printed: Printout = field(default=Printout((), ("nothing was compared",)), compare=False)

    def _printout(self) -> Printout:
        return self.printed

    def _rows(self) -> Sequence[Record]:
        return self.records

    @property
    def passed(self) -> bool:
        """Whether the command would exit with 0; raises LinkproofError if nothing could be judged."""
        return campaign_exit_code(self.records, figures=self.figures, departures=self.departures) == PASSED

    @property
    def table(self) -> xarray.Dataset:
        """The records over ``run`` and ``quantity``: errors and limits as shares of the peak, NaN where there is none.

        ``mechanism``, ``variant``, ``regime``, ``engine`` and ``setting`` stand along ``run``, with
        ``setup_seconds``, ``seconds`` of stepping and ``steps`` of each.
        """
        import xarray  # noqa: PLC0415  half a second that records alone do not pay

        runs = {record.run: record for record in self.records}
        quantities = list(dict.fromkeys(record.quantity for record in self.records))
        places = {(record.run, record.quantity): record for record in self.records}

        def cells(field: str, lacking: float | str) -> tuple[tuple[str, str], list[list[Any]]]:
            found = [[getattr(places.get((run, name)), field, None) for name in quantities] for run in runs]
            return ("run", "quantity"), [[lacking if cell is None else cell for cell in row] for row in found]

        labels = {name: ("run", [run[number] for run in runs]) for number, name in enumerate(RUN)}
        return xarray.Dataset(
            {
                **{name: (*cells(name, math.nan), {"units": "1"}) for name in ("error_max", "error_rms", "limit")},
                "outcome": cells("outcome", ""),
                **{
                    name: ("run", [getattr(record, name) for record in runs.values()], {"units": "s"})
                    for name in ("setup_seconds", "seconds")
                },
                "steps": ("run", [record.steps for record in runs.values()]),
            },
            coords={"quantity": quantities, **labels},
        )


def compare(
    *mechanisms: str | Path,
    engine: Words = (),
    setting: Words = (),
    quantity: Words = (),
    full: bool = False,
    limits: str | Path | None = None,
    baseline: str | Path | None = None,
    record_baseline: bool = False,
    allow_new: bool = False,
    allow_missing: bool = False,
    time_limit: float | None = None,
    memory_limit: float | None = None,
    jobs: int | None = None,
    scheduler: str | Client | None = None,
    **options: Unpack[MotionOptions],
) -> Comparison:
    """Simulate mechanisms in engines and compare every error with its limit, as ``linkproof compare`` does.

    Mechanisms are names of the catalogue and paths of files; the options are the command's, ``time_limit`` in s and
    ``memory_limit`` in GiB among them; a client of Dask may stand for its scheduler. A ``linkproof.toml`` above the
    first file says what they leave open. Raises LinkproofError for bad input; a run that fails is a record.
    """
    for mechanism in mechanisms:
        if not isinstance(mechanism, (str, Path)):
            raise LinkproofError(
                f"expected names and paths of linkages, got a {type(mechanism).__name__}: give its file, since "
                "limits and baselines belong to files"
            )
    asked = CampaignChoice(
        tuple(map(str, mechanisms)), words(engine), words(setting), words(quantity),
        full, **choice(options),
    )  # fmt: skip
    bounds = RunLimits(time_limit, memory_limit, jobs, scheduler)
    bounds.check()
    held = StandardChoice(_path(limits), _path(baseline), record_baseline, allow_new, allow_missing)
    asked, bounds, held, known = in_project(asked, bounds, held)
    held.check()
    wanted, standard = request(asked, known), held.standard(asked)
    with bounds.pool() as pool:
        results = list(run_campaign(wanted, bounds=bounds.bounds, pool=pool))
    judged = judged_campaign(wanted, results, standard, held.file if held.record else None)
    printed = printout(judged.results, judged.figures, (*judged.notes, *judged.departures))
    return Comparison(
        tuple(judged.records), tuple(judged.figures), tuple(judged.notes), tuple(judged.departures), printed
    )


def _path(given: str | Path | None) -> Path | None:
    return None if given is None else Path(given)
