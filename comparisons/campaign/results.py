"""The results of a campaign as one labelled dataset: every curve, every record, and all a report needs besides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.linkage import Linkage, Vector
from analytic.description.loading import parse
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, RunResult
from comparisons.campaign.errata import ErratumRecord
from comparisons.campaign.key_figures import KeyFigure
from comparisons.campaign.saved_document import checked, limits_of
from comparisons.campaign.standards import checksum
from comparisons.datasheet.saved import FILE as SHEETS
from comparisons.datasheet.saved import load_sheets, save_sheets
from comparisons.datasheet.sheet import Sheet
from comparisons.judging.limits import LimitTable
from comparisons.judging.records import Record, from_rows, to_json
from comparisons.judging.run_result import ARRAYS
from comparisons.runs.environment import environment
from comparisons.runs.files import write_file

if TYPE_CHECKING:
    import xarray

DATASET = "curves.nc"
RECORDS = "records.json"
LABELS = ("mechanism", "variant", "regime", "engine", "setting")


@dataclass(frozen=True)
class Results:
    """A finished campaign: its document, its ``curves`` as ``dataset`` lays them out, a data sheet of each linkage."""

    document: dict[str, Any]
    curves: xarray.Dataset
    sheets: tuple[Sheet, ...] = ()

    @cached_property
    def records(self) -> tuple[Record, ...]:
        """One record per run and quantity."""
        return from_rows(self.document["records"])

    @cached_property
    def invariants(self) -> tuple[Record, ...]:
        """One record per run and invariant."""
        return from_rows(self.document["invariants"])

    @cached_property
    def limits(self) -> LimitTable:
        """The limits that the records are held against; of a campaign that did not save them the suite's."""
        return limits_of(self.document)

    @cached_property
    def figures(self) -> tuple[KeyFigure, ...]:
        """Key figures of every linkage and motion, beside what was recorded of them."""
        names = [field.name for field in fields(KeyFigure)]
        return tuple(KeyFigure(**{name: row[name] for name in names}) for row in self.document.get("figures", ()))

    @cached_property
    def linkages(self) -> tuple[Linkage, ...]:
        """The linkages as they were described when the campaign ran."""
        return tuple(
            described(d["text"], d["name"], d["variant"], (d["gravity"][0], d["gravity"][1]))
            for d in self.document["descriptions"]
        )

    @cached_property
    def motions(self) -> tuple[CrankMotion, ...]:
        """The crank motions of the campaign's regimes."""
        return tuple(
            CrankMotion(m["regime"], tuple(Segment(s[0], s[1], tuple(s[2])) for s in m["segments"]))
            for m in self.document["motions"]
        )

    @cached_property
    def _places(self) -> dict[tuple[str, str], slice]:
        """Where each curve lies along the samples, by run and quantity."""
        ends = np.cumsum(self.curves["row_size"].values)
        names = zip(self.curves["run"].values, self.curves["quantity"].values, strict=True)
        sizes = self.curves["row_size"].values
        return {
            (str(run), str(quantity)): slice(int(end - size), int(end))
            for (run, quantity), end, size in zip(names, ends, sizes, strict=True)
        }

    def curve(self, run: Sequence[str], quantity: str) -> tuple[np.ndarray, ...]:
        """``ARRAYS`` of one run (mechanism, variant, regime, engine, setting) and quantity, (samples,) each."""
        place = self._places["/".join(run), quantity]
        return tuple(self.curves[name].values[place] for name in ARRAYS)


def described(text: str, name: str, variant: str | None, gravity: Vector) -> Linkage:
    """A variant of a linkage from its file's text, under the gravity a campaign ran with."""
    return replace(parse(text, name, name, variant), gravity=gravity)


def document(
    request: CampaignRequest,
    results: Sequence[RunResult],
    command: str,
    errata: Sequence[ErratumRecord] = (),
    readouts: Mapping[str, Mapping[str, Mapping[str, str]]] | None = None,
) -> dict[str, Any]:
    """Everything but the curves, as JSON-ready data; ``readouts`` are the engines' as ``Abilities.told`` has them."""
    return {
        "format": 1,
        "command": command,
        "conditions": request.conditions,
        "environment": environment(request.engines),
        "records": [asdict(record) for result in results for record in result.records],
        "invariants": [asdict(record) for result in results for record in result.invariants],
        "errata": [{**asdict(record), "sentence": record.sentence} for record in errata],
        "readouts": dict(readouts or {}),
        "details": {"/".join(r.records[0].run): r.details for r in results if r.records},
        "motions": [
            {"regime": m.regime, "segments": [[s.start, s.end, list(s.coefficients)] for s in m.segments]}
            for m in request.motions
        ],
        "descriptions": [
            {
                "name": linkage.name,
                "variant": linkage.variant,
                "gravity": list(linkage.gravity),
                "text": linkage.text,
                "checksum": checksum(linkage.text),
            }
            for linkage in request.linkages
        ],
    }


def dataset(results: Sequence[RunResult], told: dict[str, Any]) -> xarray.Dataset:
    """The curves of all runs that finished, one after the other: a contiguous ragged array of the CF conventions.

    Along ``sample``: time, s, true crank angle, rad, observed and reference, in the quantity's unit. Along ``curve``:
    run, quantity and every other label, and ``row_size``, how many samples each curve has.
    """
    import xarray  # noqa: PLC0415  half a second that a run without --out does not pay

    curves = [(result, name, found) for result in results for name, found in result.deviations.items()]
    attributes = {
        "title": "linkproof: engines against the closed form",
        "Conventions": "CF-1.8",
        "document": to_json(told),
    }
    if not curves:
        return xarray.Dataset(attrs=attributes)
    units = {record.quantity: record.unit for result, _, _ in curves for record in result.records}
    runs = [result.records[0].run for result, _, _ in curves]
    return xarray.Dataset(
        {
            **{
                array: ("sample", np.concatenate([getattr(found, array) for _, _, found in curves])) for array in ARRAYS
            },
            "row_size": ("curve", [len(found.time) for _, _, found in curves], {"sample_dimension": "sample"}),
        },
        coords={
            "run": ("curve", ["/".join(run) for run in runs]),
            "quantity": ("curve", [name for _, name, _ in curves]),
            "unit": ("curve", [units[name] for _, name, _ in curves]),
            **{label: ("curve", [run[i] for run in runs]) for i, label in enumerate(LABELS)},
        },
        attrs=attributes,
    )


def save(folder: Path, results: Sequence[RunResult], told: dict[str, Any], sheets: Sequence[Sheet] = ()) -> Results:
    """Write ``curves.nc``, ``records.json`` and ``mechanisms.json`` into a folder, each in one step.

    What a kill has left of earlier attempts at them is removed.
    """
    for name in (DATASET, RECORDS, SHEETS):
        for half in folder.glob(f".{name}.*"):
            half.unlink(missing_ok=True)
    curves = dataset(results, told)
    write_file(folder / DATASET, lambda path: curves.to_netcdf(path, engine="scipy", format="NETCDF3_64BIT"))
    write_file(folder / RECORDS, lambda path: path.write_text(to_json(told), encoding="utf-8"))
    save_sheets(folder, sheets)
    return Results(told, curves, tuple(sheets))


def load(folder: Path, *, with_sheets: bool = True) -> Results:
    """Read a saved campaign back, from its folder or from the dataset itself; no engine is imported.

    Without sheets where none is needed: the first campaigns of version 0.1.0 wrote none.
    """
    import xarray  # noqa: PLC0415

    path = folder / DATASET if folder.is_dir() else folder
    if not path.is_file():
        raise LinkproofError(f"no saved curves at '{path}': expected the folder given to --out, or its {DATASET}")
    try:
        with xarray.open_dataset(path, engine="scipy", mmap=False) as opened:
            curves = opened.load()
        told = checked(curves.attrs["document"], curves)
    except Exception as error:  # a damaged file raises anything at all, in any number of lines
        why = next(iter(str(error).splitlines()), type(error).__name__)
        raise LinkproofError(f"'{path}' is no dataset of a campaign ({why}); run compare with --out again") from error
    if not with_sheets:
        return Results(told, curves)
    found = Results(told, curves, load_sheets(path.parent))
    _check_sheets(found, path.parent)
    return found


def _check_sheets(results: Results, folder: Path) -> None:
    """Raise LinkproofError where a linkage of the campaign has no data sheet."""
    known = {(sheet.name, sheet.variant) for sheet in results.sheets}
    for linkage in results.linkages:
        if (linkage.name, linkage.variant) not in known:
            raise LinkproofError(
                f"'{folder / SHEETS}' is another campaign's: it has no {linkage.name} ({linkage.variant}); run compare "
                "with --out again"
            )
