"""The recorded deviations: a guard that notices when an engine's upgrade makes it worse, even within its limit."""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.judging.records import Record
from comparisons.runs.files import write_text

TABLE = Path(__file__).with_name("baseline.json")

# A deviation may grow to this multiple of its recorded value before the check fails.
GROWTH = 3.0
# Deviations below this share of their limit are round-off and are never judged by growth.
FLOOR_SHARE = 1e-3


def key(record: Record) -> str:
    """Under what name a record's deviation is kept; the regime's speed, times and angle belong to it."""
    return "/".join((record.mechanism, record.variant, record.regime, record.conditions, record.engine, record.setting))


@cache
def recorded() -> dict[str, dict[str, float]]:
    """Deviations by key and quantity; empty before the first recording. Raises LinkproofError if it cannot be read."""
    if not TABLE.is_file():
        return {}
    try:
        table = json.loads(TABLE.read_text(encoding="utf-8"))
        return {key: {name: float(value) for name, value in row.items()} for key, row in table.items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise LinkproofError(
            f"expected recorded deviations in '{TABLE}', got a damaged file ({error}); restore it, or delete it to "
            "judge by the limits alone"
        ) from error


def allowed(record: Record) -> float | None:
    """The largest deviation the baseline lets pass, None where none was recorded."""
    value = recorded().get(key(record), {}).get(record.quantity)
    if value is None or record.limit is None:
        return None
    return max(GROWTH * value, FLOOR_SHARE * record.limit)


def record_all(records: Iterable[Record]) -> int:
    """Write the deviations of these records over the old ones; returns how many."""
    table = {name: dict(values) for name, values in recorded().items()}
    count = 0
    for record in records:
        if record.error_max is not None:
            table.setdefault(key(record), {})[record.quantity] = float(f"{record.error_max:.3e}")
            count += 1
    ordered = {name: dict(sorted(table[name].items())) for name in sorted(table)}
    write_text(TABLE, json.dumps(ordered, indent=1) + "\n")
    recorded.cache_clear()
    return count
