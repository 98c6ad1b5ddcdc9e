"""Where the figures of a run come from, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from comparisons.judging.records import CONTROL, IMPORTED, Record
from engines.contract import Origin


def origin_words(records: Sequence[Record]) -> str:
    """Of the records of one run: "1 run, read", "read in part", "4 runs, extrapolated", "control", "imported"."""
    words = [record for record in records if record.origin]
    if not words:
        return ""
    if words[0].origin in (CONTROL, IMPORTED):
        return words[0].origin
    runs = max(record.runs for record in words)
    if runs > 1:
        return f"{runs} runs, {Origin.EXTRAPOLATED}"
    return "read in part" if any(r.origin != Origin.READ for r in words) else f"1 run, {Origin.READ}"


def exceptions(records: Sequence[Record]) -> str:
    """What of these records is computed by the adapter, or shared with the reference; empty if nothing is."""
    families = {
        origin: _families(record.quantity for record in records if record.origin == origin)
        for origin in (Origin.COMPUTED, Origin.PARTLY)
    }
    shared = dict.fromkeys(f"{r.shared} of {r.quantity.replace('_', ' ')}" for r in records if r.shared)
    words = [f"{origin} by its adapter: {names}" for origin, names in families.items() if names]
    return "; ".join([*words, *([f"shared with the reference: {', '.join(shared)}"] if shared else [])])


def _families(quantities: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(name.partition(":")[0] for name in quantities))
