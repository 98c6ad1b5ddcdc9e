"""Where figures come from: those of a run in words, those of an engine in the table of its read-outs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from comparisons.judging.records import CONTROL, IMPORTED, Record
from engines.contract import Origin
from reports.document.numbers import ABSENT
from reports.document.parts import Table
from reports.document.templates import plain

READOUTS = ("channel", "in the engine", "frame", "instant", "drive's share")


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
    """The quantities computed by the adapter or shared with the reference, in words; empty without any."""
    families = {
        origin: _families(record.quantity for record in records if record.origin == origin)
        for origin in (Origin.COMPUTED, Origin.PARTLY)
    }
    shared = dict.fromkeys(f"{r.shared} of {r.quantity.replace('_', ' ')}" for r in records if r.shared)
    words = [f"{origin} by its adapter: {names}" for origin, names in families.items() if names]
    return "; ".join([*words, *([f"shared with the reference: {', '.join(shared)}"] if shared else [])])


def _families(quantities: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(name.partition(":")[0] for name in quantities))


def readout_table(name: str, groups: Mapping[str, Mapping[str, str]]) -> Table:
    """The read-outs of an engine, as ``Abilities.as_dict`` has them."""
    rows = tuple(
        (plain(channel), names["source"], names["frame"], names["instant"], names["drive"] or ABSENT)
        for channel, names in groups.items()
    )
    return Table(f"{name}: where its figures come from.", READOUTS, rows, align="l")
