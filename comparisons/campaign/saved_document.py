"""The form of a campaign's saved document and curves: damage is reported by its key when it is read back."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, NotRequired, TypeVar, get_type_hints

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError
from typing_extensions import TypedDict

from comparisons.campaign.errata import ErratumRecord
from comparisons.campaign.key_figures import KeyFigure
from comparisons.judging.limits import LimitTable, shipped_limits, table_of
from comparisons.judging.records import Record, Verdict, from_rows
from comparisons.judging.run_result import ARRAYS
from comparisons.runs.damage import first_fault
from engines.contract import ReadOut

if TYPE_CHECKING:
    import xarray

Part = TypeVar("Part")
ReadOuts = dict[str, dict[str, Part]]  # by engine and channel


def _form(fields: Mapping[str, Any], container: Any = list) -> TypeAdapter[Any]:  # noqa: ANN401 - a type
    """The form of rows that have these fields, all of them, in a container."""
    typed_dict: Any = TypedDict
    row = typed_dict("Row", dict(fields))
    return TypeAdapter(container[row])


RECORDS: Final = _form(get_type_hints(Record))
ROWS: Final[Mapping[str, TypeAdapter[Any]]] = {
    "records": RECORDS,
    "invariants": RECORDS,
    "errata": _form({**get_type_hints(ErratumRecord), "sentence": str}),
    "figures": _form({**get_type_hints(KeyFigure), "sentence": str}),
    "readouts": _form(get_type_hints(ReadOut), ReadOuts),
}
NEWER: Final = ("figures",)  # which campaigns of version 0.1.0 do not have
# What a record tells since then, as it is where nothing was told.
NEWER_FIELDS: Final = {"error_at_jumps": 0.0, "origin": "", "runs": 0, "shared": "", "host": ""}
COLUMNS: Final = {**dict.fromkeys(ARRAYS, "sample"), **dict.fromkeys(("row_size", "run", "quantity"), "curve")}


class MotionRow(TypedDict):
    """A crank motion: its pieces from one instant to another, s, each a polynomial of the angle, rad."""

    regime: str
    segments: Annotated[list[tuple[float, float, Annotated[list[float], Field(min_length=1)]]], Field(min_length=1)]


class LimitData(TypedDict):
    """A row of the table of limits, as its file has it."""

    quantities: list[str]
    settings: list[str]
    regimes: list[str]
    mechanisms: list[str]
    value: float
    reason: str


class DescriptionRow(TypedDict):
    """A linkage as it was described, under a gravity, m/s²."""

    name: str
    variant: str
    gravity: tuple[float, float]
    text: str
    checksum: NotRequired[str]


class SavedCampaign(TypedDict):
    """Everything but the curves."""

    format: Literal[1]
    command: str
    conditions: str
    environment: Mapping[str, str]
    records: list[Any]
    invariants: list[Any]
    errata: list[Any]
    readouts: Mapping[str, Any]
    details: Mapping[str, Mapping[str, Any]]
    motions: list[MotionRow]
    descriptions: list[DescriptionRow]
    limits: NotRequired[list[LimitData]]
    figures: NotRequired[list[Any]]
    notes: NotRequired[list[str]]
    departures: NotRequired[list[str]]
    judgement: NotRequired[list[str]]


DOCUMENT: Final = TypeAdapter(SavedCampaign)


def checked(text: str, curves: xarray.Dataset) -> dict[str, Any]:
    """The document of a campaign from its text; raises ValueError, which names the key, where it is damaged."""
    at = ""
    parsed = json.loads(text)
    document: dict[str, Any] = _completed(parsed)
    try:
        DOCUMENT.validate_json(text if document is parsed else json.dumps(document), strict=True)
        for key, form in ROWS.items():
            at = key
            if key in document or key not in NEWER:
                form.validate_python(document[key], strict=True)
    except ValidationError as error:
        key, what = first_fault(error)
        raise ValueError(f"{'.'.join(filter(None, (at, key)))}: {what}") from error
    for fault in chain(_curve_faults(curves), _record_faults(document, curves)):
        raise ValueError(fault)
    return document


def _completed(document: Any) -> Any:  # noqa: ANN401 - whatever JSON holds
    """A document with what was not told in its time: hosts and units; of version 0.1.0, which told no limits, more."""
    if not isinstance(document, dict):
        return document
    records = {"host": ""} if "limits" in document else NEWER_FIELDS
    found = document if "limits" in document else {"readouts": {}, **document}
    for key, newer in (("records", records), ("invariants", records), ("figures", {"unit": ""})):
        rows = found.get(key)
        if isinstance(rows, list) and any(isinstance(row, dict) and not newer.keys() <= row.keys() for row in rows):
            found = {**found, key: [newer | row if isinstance(row, dict) else row for row in rows]}
    return found


def _curve_faults(curves: xarray.Dataset) -> Iterator[str]:
    """What does not fit among the arrays."""
    if not curves.sizes:
        return
    for name, dimension in COLUMNS.items():
        if name not in curves or curves[name].dims != (dimension,):
            yield f"expected {name} along {dimension}"
            return
    sizes = curves["row_size"].values
    if sizes.dtype.kind not in "iu" or np.any(sizes < 0) or int(np.sum(sizes)) != curves.sizes["sample"]:
        yield f"row_size: expected whole numbers that add up to {curves.sizes['sample']} samples"
    for name in ARRAYS:
        if curves[name].dtype.kind != "f" or not np.isfinite(curves[name].values).all():
            yield f"{name}: expected finite numbers"


def _record_faults(document: Mapping[str, Any], curves: xarray.Dataset) -> Iterator[str]:
    """Records of nothing that was described, without the curve that they tell of, or that contradict themselves."""
    described = {(row["name"], row["variant"]) for row in document["descriptions"]}
    columns = ([str(name) for name in curves[key].values] if key in curves else [] for key in ("run", "quantity"))
    known = set(zip(*columns, strict=True))
    rows = {key: from_rows(document[key]) for key in ("records", "invariants")}
    runs, limits = {record.run for record in rows["records"]}, limits_of(document)
    for key, records in rows.items():
        for number, record in enumerate(records):
            where, run = f"{key}.{number}", "/".join(record.run)
            if record.run not in runs:
                yield f"{where}: no record of the run {run}"
            if record.run[:2] not in described:
                yield f"{where}: no description of {record.mechanism} ({record.variant})"
            if record.outcome not in list(Verdict):
                yield f"{where}.outcome: expected one of {', '.join(Verdict)}"
            if record.error_max is None and record.error_rms is not None:
                yield f"{where}: expected an error_max beside error_rms"
            if key == "records" and record.error_max is not None and (run, record.quantity) not in known:
                yield f"{where}: no curve of {record.quantity} by {run}"
            if "judgement" not in document:  # another tool's signals have any name
                yield from _limit_faults(record, limits, where)


def limits_of(document: Mapping[str, Any]) -> LimitTable:
    """The limits that a document's records are held against; of a campaign that did not save them the suite's."""
    return table_of(document["limits"]) if "limits" in document else shipped_limits()


def _limit_faults(record: Record, limits: LimitTable, where: str) -> Iterator[str]:
    """A quantity or a setting for which there is no limit."""
    try:
        limits.limit(record.quantity, record.setting, record.regime, record.mechanism)
    except LookupError:
        yield f"{where}: no limit of {record.quantity or 'a nameless quantity'} at {record.setting or 'no setting'}"
