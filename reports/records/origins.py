"""Where the figures of a run come from, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from comparisons.judging.records import CONTROL, IMPORTED, Record
from engines.contract import Origin


def origin_words(records: Sequence[Record]) -> str:
    """Of the records of one run: "1 run, read", "4 runs, extrapolated", "control", "imported"."""
    told = [record for record in records if record.origin]
    if not told:
        return ""
    if told[0].origin in (CONTROL, IMPORTED):
        return told[0].origin
    runs = max(record.runs for record in told)
    return f"{runs} runs, {Origin.EXTRAPOLATED}" if runs > 1 else f"1 run, {Origin.READ}"


def exceptions(records: Sequence[Record]) -> str:
    """What of these records is computed by the adapter, or shared with the reference; empty if nothing is."""
    computed = _families(record.quantity for record in records if record.origin == Origin.COMPUTED)
    shared = dict.fromkeys(f"{r.shared} of {r.quantity.replace('_', ' ')}" for r in records if r.shared)
    words = [f"computed by its adapter: {computed}"] if computed else []
    return "; ".join([*words, *([f"shared with the reference: {', '.join(shared)}"] if shared else [])])


def _families(quantities: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(name.partition(":")[0] for name in quantities))
