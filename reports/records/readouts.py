"""What each engine offers, and what its figures are in the engine: its name for them, their frame and their instant."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from engines.contract import Engine
from reports.document.numbers import ABSENT
from reports.document.parts import Table
from reports.document.templates import plain

HEAD = ("channel", "in the engine", "frame", "instant", "drive's share")


def readout_table(name: str, told: Mapping[str, Mapping[str, str]]) -> Table:
    """The read-outs of an engine, as ``Abilities.told`` has them."""
    rows = tuple(
        (plain(channel), one["source"], one["frame"], one["instant"], one["drive"] or ABSENT)
        for channel, one in told.items()
    )
    return Table(f"{name}: where its figures come from.", HEAD, rows, align="l")


def abilities_told(adapter: Engine) -> Mapping[str, Any]:
    """What an engine takes and offers, JSON-ready."""
    able = adapter.abilities
    return {
        "engine": adapter.name,
        "version": adapter.version(),
        "control": adapter.is_control,
        "drives": _names(able.drives),
        "joints": ["PinJoint", *_names(able.joints)],
        "loads": ["gravity", *_names(able.loads)],
        "varying_loads": able.varying_loads,
        "massless_bodies": able.massless,
        "settings": [setting.value for setting in able.settings],
        "readouts": able.told(),
    }


def _names(types: Iterable[type]) -> list[str]:
    return sorted(one.__name__ for one in types)
