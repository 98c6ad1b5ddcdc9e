"""What the figures of each engine are in the engine: its name for them, their frame and their instant."""

from __future__ import annotations

from collections.abc import Mapping

from reports.document.numbers import ABSENT
from reports.document.parts import Table
from reports.document.templates import plain

HEAD = ("channel", "in the engine", "frame", "instant", "drive's share")


def readout_table(name: str, groups: Mapping[str, Mapping[str, str]]) -> Table:
    """The read-outs of an engine, as ``Abilities.as_dict`` has them."""
    rows = tuple(
        (plain(channel), names["source"], names["frame"], names["instant"], names["drive"] or ABSENT)
        for channel, names in groups.items()
    )
    return Table(f"{name}: where its figures come from.", HEAD, rows, align="l")
