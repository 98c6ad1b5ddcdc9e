"""One run, judged: its records and the curves behind them, and the same as bytes, bit for bit."""

from __future__ import annotations

import io
import json
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np

from comparisons.judging.deviations import Deviation
from comparisons.judging.records import Record, from_rows

ARRAYS = ("time", "angle", "observed", "reference")


@dataclass(frozen=True)
class RunResult:
    """One run, judged: its records, its invariants, and the curves behind them by quantity."""

    records: tuple[Record, ...]
    invariants: tuple[Record, ...]
    deviations: dict[str, Deviation] = field(default_factory=dict)
    details: dict[str, str | int | float] = field(default_factory=dict)


def to_bytes(result: RunResult) -> bytes:
    """An ``npz`` of every curve's arrays and of a JSON text that holds all else; neither loses a bit of a float."""
    told = {
        "records": [asdict(record) for record in result.records],
        "invariants": [asdict(record) for record in result.invariants],
        "deviations": {name: _numbers(found) for name, found in result.deviations.items()},
        "details": result.details,
    }
    curves = {
        f"{number}.{array}": getattr(found, array)
        for number, found in enumerate(result.deviations.values())
        for array in ARRAYS
    }
    target = io.BytesIO()
    np.savez(target, document=np.frombuffer(json.dumps(told).encode(), dtype=np.uint8), **curves)
    return target.getvalue()


def from_bytes(content: bytes) -> RunResult:
    """The result that ``to_bytes`` wrote."""
    with np.load(io.BytesIO(content), allow_pickle=False) as stored:
        told = json.loads(stored["document"].tobytes())
        deviations = {
            name: Deviation(**{array: stored[f"{number}.{array}"] for array in ARRAYS}, **numbers)
            for number, (name, numbers) in enumerate(told["deviations"].items())
        }
    return RunResult(from_rows(told["records"]), from_rows(told["invariants"]), deviations, told["details"])


def _numbers(found: Deviation) -> dict[str, Any]:
    """What a deviation holds besides its arrays."""
    return {one.name: getattr(found, one.name) for one in fields(found) if one.name not in ARRAYS}
