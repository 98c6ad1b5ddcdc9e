"""Where the figures of a run come from, in words."""

from __future__ import annotations

from collections.abc import Iterable

from comparisons.judging.records import CONTROL, Record
from engines.contract import Origin

CONTROL_WORDS = "the reference's control"


def origin_words(records: Iterable[Record]) -> str:
    """Of the records of one run: "1 run, read"; "4 runs, extrapolated"; what is computed or shared besides."""
    told = [record for record in records if record.origin]
    if not told:
        return ""
    if told[0].origin == CONTROL:
        return CONTROL_WORDS
    runs = max(record.runs for record in told)
    origin = Origin.EXTRAPOLATED if runs > 1 else Origin.READ
    words = [f"{runs} run{'s' if runs > 1 else ''}, {origin}"]
    computed = _families(record.quantity for record in told if record.origin == Origin.COMPUTED)
    words += [f"computed: {computed}"] if computed else []
    words += list(dict.fromkeys(f"shared: {r.shared} of {r.quantity}" for r in told if r.shared))
    return "; ".join(words)


def _families(quantities: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(name.partition(":")[0] for name in quantities))
